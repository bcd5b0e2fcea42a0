//! Dynamic filters of both crates, from one table and one noise.

use dsp_core::SampleRate;
use dsp_core::dynamic_filter::{Breakpoint, DynamicFilter, DynamicFilterError, Exciter, Settings};
use dsp_core::noise::White;
use dsp_core::waveguide::Loop;

use crate::lent;

/// Filter of `dsp-core`, in memory of its own.
pub type Ours = DynamicFilter<'static>;

/// Seed and stream of the noise.
pub const SEED: (u32, u32) = (9, 4);

/// Table of a dynamic filter.
#[derive(Clone, Debug)]
pub struct Table {
    /// Order of the filter, 1 or 2.
    pub order: u8,
    /// Breakpoints of the filter's path.
    pub path: Vec<Breakpoint>,
    /// Loops behind the filter.
    pub loops: Vec<Loop>,
    /// Band of the noise; `None` for white noise.
    pub exciter: Option<Exciter>,
    /// True if the object's modes go through the filter.
    pub modes_through: bool,
    /// Sample rate in Hz for which the coefficients are given.
    pub rate_hz: f64,
}

impl Table {
    /// Table of order 1 at 48 kHz with a path and nothing else.
    pub fn of_path(path: Vec<Breakpoint>) -> Self {
        Self { order: 1, path, loops: Vec::new(), exciter: None, modes_through: false, rate_hz: 48_000.0 }
    }

    /// Filter of `dsp-core` for this table, with the seed [`SEED`].
    ///
    /// # Errors
    /// [`DynamicFilterError`].
    pub fn ours(&self, rate: SampleRate) -> Result<Box<Ours>, DynamicFilterError> {
        self.with_seed(SEED.0, rate)
    }

    /// Filter of `dsp-core` for this table, with another seed.
    ///
    /// # Errors
    /// [`DynamicFilterError`].
    pub fn with_seed(&self, seed: u32, rate: SampleRate) -> Result<Box<Ours>, DynamicFilterError> {
        let settings = Settings {
            seed,
            rate_hz: self.rate_hz,
            order: self.order,
            modes_through: self.modes_through,
            exciter: self.exciter,
            path: self.path.iter().copied(),
            loops: self.loops.iter().copied(),
        };
        let mut filter = Box::new(lent_filter(&settings, rate)?);
        filter.load(settings, rate, SEED.1).map(|()| filter)
    }

    /// Sound of the reference for strikes (sample, level) in order, in bus steps.
    ///
    /// `input_shift` is that of the filter of `dsp-core`, so that both draw one noise.
    pub fn exact(&self, strikes: &[(usize, f32)], input_shift: i32, frames: usize, rate: SampleRate) -> Vec<f64> {
        let theirs = reference::SampleRate { numerator: (rate.hz() * 64.0) as u32, denominator: 64 };
        let ratio = rate.hz() / self.rate_hz;
        let point = |p: &Breakpoint| {
            let Breakpoint { time_s, a1, a2, b0, b1, b2, noise } = *p;
            reference::dynamic_filter::Breakpoint { time_s, noise, a1, a2, b0, b1, b2 }.at_ratio(ratio)
        };
        let path: Vec<_> = self.path.iter().map(point).collect();
        let mut filter = reference::dynamic_filter::Filter::new(self.order, &path, theirs);
        let last = (path.last().map_or(0.0, |point| point.time_s) * rate.hz()).ceil() as usize;
        let mut generator = White::new(SEED.0, SEED.1);
        let unit = 268_435_456.0 * ratio.sqrt();
        let mut noise = |n: usize| {
            let Some(&(start, level)) = strikes.iter().rev().find(|(start, _)| *start <= n) else { return 0.0 };
            // Pieces of the path that are silent throughout draw no noise.
            let time_s = (n - start) as f64 / rate.hz();
            let within = |pair: &&[Breakpoint]| (pair[0].time_s..pair[1].time_s).contains(&time_s);
            let silent = |pair: &[Breakpoint]| pair[0].noise == 0.0 && pair[1].noise == 0.0;
            if n - start >= last || self.path.windows(2).find(within).is_some_and(silent) {
                return 0.0;
            }
            let words = (f64::from(level) * unit).min(1.99 * 268_435_456.0) as i32;
            let words = if input_shift >= 0 { words >> input_shift } else { words << -input_shift };
            let of_path = filter.noise(n - start);
            f64::from(generator.draw(words)) * f64::exp2(f64::from(input_shift)) * of_path
        };
        let mut input: Vec<f64> = (0..frames).map(&mut noise).collect();
        if let Some(Exciter { low_hz, high_hz, exponent }) = self.exciter {
            let level = strikes.first().map_or(1.0, |&(_, level)| f64::from(level));
            input = reference::dynamic_filter::Exciter { low_hz, high_hz, exponent }.filter(level, &input, theirs);
        }
        let starts: Vec<usize> = strikes.iter().map(|&(start, _)| start).collect();
        let one = |&Loop { frequency_hz, bandwidth_hz, gain, delay_s }: &Loop| reference::waveguide::Loop {
            frequency_hz,
            bandwidth_hz,
            gain,
            delay_s,
        };
        let loops: Vec<_> = self.loops.iter().map(one).collect();
        reference::waveguide::filter(&mut filter, &loops, &starts, &input, theirs)
    }
}

/// Filter of `dsp-core` in memory of its own, not loaded yet.
///
/// # Errors
/// [`DynamicFilterError`].
pub fn lent_filter<P, L>(settings: &Settings<P, L>, rate: SampleRate) -> Result<Ours, DynamicFilterError>
where
    P: Iterator<Item = Breakpoint> + Clone,
    L: Iterator<Item = Loop> + Clone,
{
    let size = DynamicFilter::size(settings, rate)?;
    Ok(lent!(lender => DynamicFilter::take(lender, size)))
}

/// Sound of the filter of `dsp-core` for strikes (sample, level) in order, in bus steps.
pub fn play(filter: &mut Ours, strikes: &[(usize, f32)], frames: usize) -> Vec<i32> {
    let mut out = vec![0; frames];
    let mut at = 0;
    for (index, &(start, level)) in strikes.iter().enumerate() {
        filter.render(None, &mut out[at..start]);
        filter.strike(level);
        at = start;
        if index + 1 == strikes.len() {
            filter.render(None, &mut out[at..]);
        }
    }
    out
}
