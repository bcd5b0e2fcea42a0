//! Hann spectra of struck modes in closed form, and the slope of a distance by their numbers.
//!
//! A mode driven by the force F responds by `u[n] = Σ F[m] z^(n-m)`. With
//! `D(k) = 1/(1 - z e^(-2πjk/N))` the spectrum of a frame of N samples from `s` on is
//!
//! ```text
//! X(k) = H{ (P(k) + b) D(k) },   P(k) = Σ F[m] e^(-2πjk(m-s)/N) over the force within the frame,
//!                                b    = z (u[s-1] - u[s+N-1])
//! H{Y}(k) = Y(k)/2 - Y(k-1)/4 - Y(k+1)/4
//! ```
//!
//! Behind the force P is 0, and all frames share the shape H{D}, which is narrow. A frame with the
//! onset needs all bins, but P does not depend on the mode. `dD/d(ln z) = D² - D`.
//!
//! The real sound `Re(g u)` adds the conjugate at the mirrored bin: spectra are summed over bins
//! from below 0 on and folded.

use fourier::Complex;

use super::grid::Grid;
use super::response::{Powers, Response};
use super::split::{C32, Split, Wide, hann_of, windowed};
use crate::vectors::vectorized;

/// Bins below 0 and above half the rate that are kept of modes behind the force.
const MARGIN: usize = 24;
/// Value of a shape relative to its maximum below which it is left out: 80 dB.
const NEGLIGIBLE: f64 = 1e-4;

type C64 = Complex<f64>;

/// Spectra of a grid's frames.
pub(super) struct Spectra {
    size: usize,
    /// Spectrum of each frame, with the margin.
    ringing: Vec<Split>,
    onsets: Vec<Split>,
    /// Sum of all modes' `g D / 2`, for the force within the frames.
    common: Split,
    frames: Vec<Place>,
    force: Vec<Split>,
    twiddles: Wide,
}

#[derive(Clone, Copy, Debug)]
enum Place {
    /// Index among the frames behind the force, and the frame's first sample.
    Ringing(usize, i64),
    /// Index among the frames with the onset, and the frame's first sample.
    Onset(usize, i64),
}

/// Shapes of one mode in one grid.
pub(super) struct Shape {
    first: usize,
    hann: Split,
    hann_slope: Split,
    /// `D` and its derivative at all bins, for frames with the onset.
    full: Split,
    full_slope: Split,
    /// Amplitude of each frame per unit of gain, and its derivative.
    amplitudes: Vec<[C32; 2]>,
}

/// Derivatives of a distance by a mode's numbers, by the rules `Re(conj(d gain) · …)`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slopes {
    /// By the real and imaginary part of the gain.
    pub(super) gain: [f64; 2],
    /// By the decay and the angular frequency per sample.
    pub(super) pole: [f64; 2],
}

impl Spectra {
    pub(super) fn new(grid: &Grid, force: &[f64]) -> Self {
        let size = grid.size;
        let angles = (0..size).map(|k| -std::f64::consts::TAU * k as f64 / size as f64);
        let twiddles = Wide { re: angles.clone().map(f64::cos).collect(), im: angles.map(f64::sin).collect() };
        let (mut ringing, mut onsets) = (0, Vec::new());
        let frames: Vec<Place> = grid
            .frames
            .iter()
            .map(|frame| {
                // A window is nearly 0 at its beginning, where the force needs no care.
                if force.len() as i64 - frame.start <= size as i64 / 12 {
                    ringing += 1;
                    Place::Ringing(ringing - 1, frame.start)
                } else {
                    onsets.push(frame.start);
                    Place::Onset(onsets.len() - 1, frame.start)
                }
            })
            .collect();
        // One bin more on either side, which the window needs.
        let extent = 2 * grid.bins() + 1;
        let spectrum_of_force = |start: &i64| {
            let mut spectrum = Split::default();
            for index in 0..extent {
                let bin = index as i64 - grid.bins() as i64;
                let mut sum = C64::new(0.0, 0.0);
                for (m, force) in force.iter().enumerate() {
                    let at = m as i64 - start;
                    if (0..size as i64).contains(&at) {
                        sum += twiddles.at((bin * at).rem_euclid(size as i64) as usize) * *force;
                    }
                }
                spectrum.push(sum);
            }
            spectrum
        };
        Self {
            size,
            ringing: vec![Split::zeros(grid.bins() + 2 * MARGIN); ringing],
            onsets: vec![Split::zeros(extent); onsets.len()],
            common: Split::zeros(if onsets.is_empty() { 0 } else { extent }),
            force: onsets.iter().map(spectrum_of_force).collect(),
            frames,
            twiddles,
        }
    }

    fn bins(&self) -> usize {
        self.size / 2 + 1
    }

    /// `D` at a bin of any sign.
    fn pole_response(&self, z: C64, bin: i64) -> C64 {
        (C64::new(1.0, 0.0) - z * self.twiddles.at(bin.rem_euclid(self.size as i64) as usize)).inv()
    }

    /// `D` at the bins from `from` to `to`.
    #[inline(always)]
    fn pole_responses(&self, z: C64, from: i64, to: i64) -> Wide {
        let count = usize::try_from(to - from + 1).unwrap_or(0);
        let mut responses = Wide { re: vec![0.0; count], im: vec![0.0; count] };
        let (mut first, mut done) = (from.rem_euclid(self.size as i64) as usize, 0);
        while done < count {
            let length = (self.size - first).min(count - done);
            let twiddles = self.twiddles.re[first..first + length].iter().zip(&self.twiddles.im[first..first + length]);
            let re = responses.re[done..done + length].iter_mut();
            for ((re, im), (cos, sin)) in re.zip(&mut responses.im[done..done + length]).zip(twiddles) {
                let (x, y) = (1.0 - (z.re * cos - z.im * sin), z.re * sin + z.im * cos);
                let scale = 1.0 / (x * x + y * y);
                (*re, *im) = (x * scale, y * scale);
            }
            (first, done) = (0, done + length);
        }
        responses
    }

    /// Shapes of a mode.
    pub(super) fn shape(&self, response: &Response) -> Shape {
        let z = response.log_pole.exp();
        let size = self.size as i64;
        let centre = (response.log_pole.im / std::f64::consts::TAU * size as f64).round() as i64;
        let margin = MARGIN as i64;
        let (lowest, highest) = (-margin, self.bins() as i64 - 1 + margin);
        let peak = {
            let [a, b, c] = [-1, 0, 1].map(|offset| self.pole_response(z, centre + offset));
            (b * 0.5 - (a + c) * 0.25).norm()
        };
        // x bins from the centre the shape is at most N/(4πx³): the window's second difference of
        // D, which is N/(2πx) there.
        let skirt = size as f64 / (2.0 * std::f64::consts::TAU);
        let reach = (1.5 + (skirt / (peak * NEGLIGIBLE)).cbrt()).ceil().min(size as f64) as i64;
        let (from, to) = ((centre - reach).max(lowest), (centre + reach).min(highest));
        let [hann, hann_slope] = vectorized(
            #[inline(always)]
            || {
                let values = self.pole_responses(z, from - 1, to + 1);
                [windowed(&values), windowed(&values.bent())]
            },
        );
        let (mut full, mut full_slope) = (Split::default(), Split::default());
        if !self.onsets.is_empty() {
            let edge = self.bins() as i64;
            [full, full_slope] = vectorized(
                #[inline(always)]
                || {
                    let values = self.pole_responses(z, -edge, edge);
                    [values.narrow(), values.bent().narrow()]
                },
            );
        }
        let since = |start: i64| (start - (response.head.len() as i64 - 1)) as f64;
        let mut powers = Powers::of(response.log_pole);
        let frame_power = (response.log_pole * self.size as f64).exp();
        let mut ends = Vec::with_capacity(self.frames.len());
        let state_at = |place: &Place| match *place {
            Place::Ringing(_, start) => {
                let power = powers.at(since(start));
                ends.push(response.ringing(since(start) + self.size as f64, power * frame_power));
                response.ringing(since(start), power)
            }
            Place::Onset(_, start) => {
                ends.push(response.state(start + size));
                response.state(start)
            }
        };
        let begins: Vec<[C64; 2]> = self.frames.iter().map(state_at).collect();
        let amplitude = |([begin, begin_slope], [end, end_slope]): (&[C64; 2], &[C64; 2])| {
            [begin - end, begin_slope - end_slope].map(|value| C32::new(value.re as f32, value.im as f32))
        };
        Shape {
            first: (from + margin) as usize,
            hann,
            hann_slope,
            full,
            full_slope,
            amplitudes: begins.iter().zip(&ends).map(amplitude).collect(),
        }
    }

    /// Sets all spectra to the sum of modes and of the force itself.
    pub(super) fn sum(&mut self, shapes: &[Shape], gains: &[C64], force_gain: f64) {
        self.ringing.iter_mut().chain(&mut self.onsets).for_each(Split::clear);
        self.common.clear();
        vectorized(
            #[inline(always)]
            || self.add_modes(shapes, gains),
        );
        let half = 0.5 * force_gain as f32;
        for (spectrum, force) in self.onsets.iter_mut().zip(&self.force) {
            for index in 0..spectrum.re.len() {
                let value = force.at(index) * (self.common.at(index) + half);
                spectrum.re[index] += value.re;
                spectrum.im[index] += value.im;
            }
        }
    }

    /// Adds all modes, but for the force within the frames.
    #[inline(always)]
    fn add_modes(&mut self, shapes: &[Shape], gains: &[C64]) {
        for (shape, gain) in shapes.iter().zip(gains) {
            let half = C32::new(0.5 * gain.re as f32, 0.5 * gain.im as f32);
            for (place, [amplitude, _]) in self.frames.iter().zip(&shape.amplitudes) {
                match *place {
                    Place::Ringing(index, _) => {
                        self.ringing[index].add(half * amplitude, &shape.hann, shape.first);
                    }
                    Place::Onset(index, _) => self.onsets[index].add(half * amplitude, &shape.full, 0),
                }
            }
            if !shape.full.re.is_empty() {
                self.common.add(half, &shape.full, 0);
            }
        }
    }

    /// Folded spectrum of a frame.
    pub(super) fn folded(&self, frame: usize) -> Split {
        let bins = self.bins();
        match self.frames[frame] {
            Place::Ringing(index, _) => {
                let spectrum = &self.ringing[index];
                let inner = MARGIN..MARGIN + bins;
                let mut folded = Split { re: spectrum.re[inner.clone()].to_vec(), im: spectrum.im[inner].to_vec() };
                for bin in 0..bins.min(MARGIN + 1) {
                    folded.re[bin] += spectrum.re[MARGIN - bin];
                    folded.im[bin] -= spectrum.im[MARGIN - bin];
                }
                // Bins above half the rate are those below it, mirrored.
                for bin in (bins - 1).saturating_sub(MARGIN)..bins {
                    let beyond = 2 * (bins - 1) - bin + MARGIN;
                    folded.re[bin] += spectrum.re[beyond];
                    folded.im[bin] -= spectrum.im[beyond];
                }
                folded
            }
            Place::Onset(index, _) => {
                let spectrum = hann_of(&self.onsets[index]);
                let mut folded = Split { re: spectrum.re[bins..].to_vec(), im: spectrum.im[bins..].to_vec() };
                folded.re.truncate(bins);
                folded.im.truncate(bins);
                for bin in 0..bins {
                    folded.re[bin] += spectrum.re[bins - bin];
                    folded.im[bin] -= spectrum.im[bins - bin];
                }
                folded
            }
        }
    }

    /// Replaces the spectrum of a frame by the slope of a distance by its bins.
    pub(super) fn put_slope(&mut self, frame: usize, slope: &Split) {
        let bins = self.bins();
        match self.frames[frame] {
            Place::Ringing(index, _) => {
                let spectrum = &mut self.ringing[index];
                let inner = MARGIN..MARGIN + bins;
                spectrum.re[inner.clone()].copy_from_slice(&slope.re);
                spectrum.im[inner].copy_from_slice(&slope.im);
                let highest = bins - 1;
                for bin in [0, highest] {
                    spectrum.re[MARGIN + bin] = 2.0 * slope.re[bin];
                    spectrum.im[MARGIN + bin] = 0.0;
                }
                for beyond in 1..=MARGIN {
                    let mirrored = [(MARGIN - beyond, beyond), (MARGIN + highest + beyond, highest - beyond)];
                    for (place, bin) in mirrored {
                        spectrum.re[place] = slope.re[bin];
                        spectrum.im[place] = -slope.im[bin];
                    }
                }
            }
            Place::Onset(index, _) => {
                let mut unfolded = Split::zeros(2 * bins + 1);
                for bin in 0..bins {
                    let value = slope.at(bin);
                    for (place, im) in [(bins - bin, -value.im), (bins + bin, value.im)] {
                        unfolded.re[place] += value.re;
                        unfolded.im[place] += im;
                    }
                }
                self.onsets[index] = hann_of(&unfolded);
            }
        }
    }

    /// Prepares the slopes that [`Self::put_slope`] has set for [`Self::slopes`]; returns the
    /// derivative by the gain of the force.
    pub(super) fn gather(&mut self) -> f64 {
        self.common.clear();
        let mut along = 0.0;
        for (slope, force) in self.onsets.iter().zip(&self.force) {
            for index in 0..slope.re.len() {
                // `common` holds conjugates, as the slopes of frames do.
                let value = slope.at(index) * force.at(index).conj();
                self.common.re[index] += value.re;
                self.common.im[index] += value.im;
                along += 0.5 * f64::from(value.re);
            }
        }
        along
    }

    /// Adds the derivatives by a mode's numbers.
    pub(super) fn slopes(&self, shape: &Shape, gain: C64, slopes: &mut Slopes) {
        let [plain, bent] = vectorized(
            #[inline(always)]
            || self.along(shape),
        );
        // dJ = Re(plain dg)/2, dJ = Re(bent g d(ln z))/2 with d(ln z) = -d(decay) + j d(angular).
        slopes.gain[0] += 0.5 * plain.re;
        slopes.gain[1] -= 0.5 * plain.im;
        let turned = bent * gain;
        slopes.pole[0] -= 0.5 * turned.re;
        slopes.pole[1] -= 0.5 * turned.im;
    }

    /// Sums of the frames' slopes along a mode's spectrum, and along its derivative by `ln z`.
    #[inline(always)]
    fn along(&self, shape: &Shape) -> [C64; 2] {
        let (mut plain, mut bent) = (C64::new(0.0, 0.0), C64::new(0.0, 0.0));
        let wide = |value: C32| C64::new(f64::from(value.re), f64::from(value.im));
        for (place, [amplitude, amplitude_slope]) in self.frames.iter().zip(&shape.amplitudes) {
            let (slope, shapes, first) = match *place {
                Place::Ringing(index, _) => (&self.ringing[index], [&shape.hann, &shape.hann_slope], shape.first),
                Place::Onset(index, _) => (&self.onsets[index], [&shape.full, &shape.full_slope], 0),
            };
            let (along, along_slope) = (slope.dot(shapes[0], first), slope.dot(shapes[1], first));
            plain += wide(along * amplitude);
            bent += wide(along * amplitude_slope + along_slope * amplitude);
        }
        if !shape.full.re.is_empty() {
            plain += wide(self.common.dot(&shape.full, 0));
            bent += wide(self.common.dot(&shape.full_slope, 0));
        }
        [plain, bent]
    }
}

#[cfg(test)]
mod tests;
