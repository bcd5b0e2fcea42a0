//! Contact force: Gaussian pulses at the peaks of a coarse series (eq. 2 to 7, algorithm 1).

use std::f64::consts::FRAC_PI_2;

use super::scale::ExpSigmoid;

/// Rate of the nodes of magnitude and contact time in Hz.
///
/// The paper asks for far fewer nodes than samples and names no number. This is the frame rate of
/// DDSP, on which the paper's modules are built.
const NODES_PER_S: f64 = 250.0;
/// Number of pulses a second, more than strikes are expected (`max_impact_frequency` of the
/// released notebook).
const PULSES_PER_S: f64 = 20.0;
/// Scaling of magnitudes (eq. 4): the bounds are printed, and the bias makes the sound of a random
/// start about as loud as a recording.
const MAGNITUDE: ExpSigmoid = ExpSigmoid { upper: 2.0, lower: 1e-7, bias: -2.0 };
/// Upper bound of contact times in seconds (A.1).
const LONGEST_S: f64 = 3e-3;
/// Lower bound l_τ of contact times in samples, as in the released notebook.
const SHORTEST_SAMPLES: f64 = 3.0;
/// Exponent of a Gaussian from which on it is silent.
const SILENT: f64 = 40.0;

/// Shape of the force: nodes and windows in a recording.
#[derive(Clone, Copy, Debug)]
pub(super) struct ForceShape {
    length: usize,
    rate_hz: f64,
    /// Distance of two nodes in samples.
    hop: usize,
}

/// Normalised numbers of the force, and the random numbers of one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct ForceInputs<'a> {
    pub(super) magnitudes: &'a [f64],
    pub(super) spreads: &'a [f64],
    pub(super) contact_times: &'a [f64],
    pub(super) bias: f64,
    /// Normal number for each node, by which the spread is multiplied.
    pub(super) noise: &'a [f64],
}

/// One pulse of the force. All times are in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pulse {
    /// Sample at which the resampled magnitude peaks in the pulse's window.
    peak_at: i64,
    /// Onset t of the unsmoothed contact.
    pub(super) onset: f64,
    /// Time scale τ.
    pub(super) contact_time: f64,
    /// Magnitude m.
    pub(super) magnitude: f64,
}

impl Pulse {
    /// Middle `t + τ/2` of the pulse.
    pub(super) fn middle(&self) -> f64 {
        self.onset + 0.5 * self.contact_time
    }

    /// Samples in which the pulse is not silent, each with its distance from the middle and C of
    /// eq. 2.
    fn samples(&self, length: usize) -> impl Iterator<Item = (usize, f64, f64)> + use<> {
        let (middle, sharpness) = (self.middle(), 6.0 / self.contact_time.powi(2));
        let reach = self.contact_time * (SILENT / 6.0).sqrt();
        let first = (middle - reach).ceil().max(0.0) as usize;
        let end = ((middle + reach).floor() + 1.0).clamp(0.0, length as f64) as usize;
        (first..end).map(move |n| {
            let from = n as f64 - middle;
            (n, from, (-sharpness * from * from).exp())
        })
    }
}

/// Gradient by the normalised numbers of the force.
#[derive(Clone, Debug)]
pub(super) struct ForceGradient {
    pub(super) magnitudes: Vec<f64>,
    pub(super) spreads: Vec<f64>,
    pub(super) contact_times: Vec<f64>,
    pub(super) bias: f64,
}

impl ForceShape {
    pub(super) fn new(length: usize, rate_hz: f64) -> Self {
        Self { length, rate_hz, hop: ((rate_hz / NODES_PER_S) as usize).max(2) }
    }

    /// Number of nodes T_in.
    pub(super) fn nodes(&self) -> usize {
        self.length.div_ceil(self.hop) + 1
    }

    /// Number of pulses M.
    fn pulses_in(&self) -> usize {
        ((PULSES_PER_S * self.length as f64 / self.rate_hz) as usize).max(1)
    }

    /// Scaled magnitudes of the nodes, and their derivatives (eq. 5).
    fn magnitudes(&self, inputs: &ForceInputs<'_>) -> (Vec<f64>, Vec<f64>) {
        let noisy = inputs.spreads.iter().zip(inputs.noise).zip(inputs.magnitudes);
        noisy.map(|((spread, noise), x)| MAGNITUDE.at(x + spread * noise)).unzip()
    }

    /// Scaled contact times of the nodes in samples, and their derivatives (eq. 7).
    fn contact_times(&self, inputs: &ForceInputs<'_>) -> (Vec<f64>, Vec<f64>) {
        let scale = ExpSigmoid { upper: LONGEST_S * self.rate_hz, lower: SHORTEST_SAMPLES, bias: inputs.bias };
        inputs.contact_times.iter().map(|x| scale.at(*x)).unzip()
    }

    /// Nodes on either side of a sample with their weights in the resampling by Hann windows.
    fn weights(&self, at: i64) -> [(Option<usize>, f64); 2] {
        let before = at.div_euclid(self.hop as i64);
        let (sine, cosine) = (FRAC_PI_2 * at.rem_euclid(self.hop as i64) as f64 / self.hop as f64).sin_cos();
        let node = |index: i64| usize::try_from(index).ok().filter(|index| *index < self.nodes());
        [(node(before), cosine * cosine), (node(before + 1), sine * sine)]
    }

    /// Resampled series at a sample; 0 beyond the nodes.
    fn resampled(&self, nodes: &[f64], at: i64) -> f64 {
        self.weights(at).iter().filter_map(|(node, weight)| Some(nodes.get((*node)?)? * weight)).sum()
    }

    /// Adds a gradient by the resampled series at a sample to that by its nodes.
    fn spread_back(&self, gradient: f64, at: i64, nodes: &mut [f64]) {
        for (node, weight) in self.weights(at) {
            if let Some(slot) = node.and_then(|node| nodes.get_mut(node)) {
                *slot += gradient * weight;
            }
        }
    }

    /// Pulses of the force, one in each window (algorithm 1).
    ///
    /// The moment is the mean of the peak and of the two samples one node away, weighted by their
    /// magnitudes. Algorithm 1 divides by 3, where a weighted mean divides by the weights' sum.
    pub(super) fn pulses(&self, inputs: &ForceInputs<'_>) -> Vec<Pulse> {
        let (magnitudes, contact_times) = (self.magnitudes(inputs).0, self.contact_times(inputs).0);
        let count = self.pulses_in();
        let width = self.length / count;
        let of_window = |window: usize| {
            let end = if window + 1 == count { self.length } else { (window + 1) * width };
            let mut peak = (window * width, f64::NEG_INFINITY);
            for at in window * width..end {
                let magnitude = self.resampled(&magnitudes, at as i64);
                if magnitude > peak.1 {
                    peak = (at, magnitude);
                }
            }
            let (at, hop) = (peak.0 as i64, self.hop as i64);
            let [before, behind] = [at - hop, at + hop].map(|at| self.resampled(&magnitudes, at));
            Pulse {
                peak_at: at,
                onset: at as f64 + hop as f64 * (behind - before) / (before + peak.1 + behind),
                contact_time: self.resampled(&contact_times, at),
                magnitude: peak.1,
            }
        };
        (0..count).map(of_window).collect()
    }

    /// Samples of the force (eq. 3).
    pub(super) fn force(&self, pulses: &[Pulse]) -> Vec<f64> {
        let mut force = vec![0.0; self.length];
        for pulse in pulses {
            pulse.samples(self.length).for_each(|(n, _, shape)| force[n] += pulse.magnitude * shape);
        }
        force
    }

    /// Gradient by the normalised numbers, from that by the samples of the force.
    pub(super) fn gradient(&self, inputs: &ForceInputs<'_>, pulses: &[Pulse], by_force: &[f64]) -> ForceGradient {
        let (magnitudes, magnitude_slopes) = self.magnitudes(inputs);
        let (_, time_slopes) = self.contact_times(inputs);
        let (mut by_magnitude, mut by_time) = (vec![0.0; self.nodes()], vec![0.0; self.nodes()]);
        for pulse in pulses {
            let time = pulse.contact_time;
            let (mut by_peak, mut by_middle, mut by_width) = (0.0, 0.0, 0.0);
            for (n, from, shape) in pulse.samples(self.length) {
                by_peak += by_force[n] * shape;
                let slope = by_force[n] * pulse.magnitude * shape * 12.0 / (time * time);
                by_middle += slope * from;
                by_width += slope * from * from / time;
            }
            // The middle is t + τ/2.
            self.spread_back(by_width + 0.5 * by_middle, pulse.peak_at, &mut by_time);
            self.spread_back(by_peak, pulse.peak_at, &mut by_magnitude);
            let hop = self.hop as i64;
            let places = [pulse.peak_at - hop, pulse.peak_at, pulse.peak_at + hop];
            let sum: f64 = places.iter().map(|at| self.resampled(&magnitudes, *at)).sum();
            let shift = pulse.onset - pulse.peak_at as f64;
            for (at, offset) in places.into_iter().zip([-1.0, 0.0, 1.0]) {
                self.spread_back(by_middle * (offset * self.hop as f64 - shift) / sum, at, &mut by_magnitude);
            }
        }
        let scaled = |gradient: Vec<f64>, slopes: &[f64]| gradient.iter().zip(slopes).map(|(g, s)| g * s).collect();
        let (magnitudes, contact_times): (Vec<f64>, Vec<f64>) =
            (scaled(by_magnitude, &magnitude_slopes), scaled(by_time, &time_slopes));
        ForceGradient {
            spreads: magnitudes.iter().zip(inputs.noise).map(|(gradient, noise)| gradient * noise).collect(),
            magnitudes,
            bias: contact_times.iter().sum(),
            contact_times,
        }
    }
}
