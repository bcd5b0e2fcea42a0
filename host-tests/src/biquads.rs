//! Random chains of biquads, as `dsp-core` and as the `f64` reference take them.

use dsp_core::biquad::{Bank, Biquad, BiquadError, Root};

use crate::lent;
use crate::snr::Random;

/// 1.0 on the bus.
pub const FULL_SCALE: f64 = 134_217_728.0;

/// Roots of a bank, each as (radius, angle): one for each section.
pub type Roots = Vec<(f64, f64)>;

/// A bank, as both crates take it.
#[derive(Clone, Debug)]
pub struct Chains {
    /// Sections for `dsp-core`, chain by chain.
    pub ours: Vec<Biquad>,
    /// Chains for the reference.
    pub theirs: Vec<Vec<reference::biquad::Biquad>>,
    /// Number of sections in a chain.
    pub depth: usize,
}

/// Draws a root: its radius, then its angle in radians.
///
/// The radius is from 0 to `1 - 10^-largest`, evenly in the logarithm of its distance from 1. The
/// angle is that of 20 Hz to 23 kHz at 48 kHz, evenly in the logarithm.
pub fn root(random: &mut Random, largest: f64) -> (f64, f64) {
    let radius = 1.0 - 10f64.powf(-random.between(0.0, largest));
    let hz = 20.0 * 1150f64.powf(random.between(0.0, 1.0));
    (radius, hz * std::f64::consts::TAU / 48_000.0)
}

/// Draws white noise from -0.9 to 0.9 of full scale.
pub fn noise(random: &mut Random, frames: usize) -> Vec<i32> {
    (0..frames).map(|_| (random.between(-0.9, 0.9) * FULL_SCALE) as i32).collect()
}

fn section(pole: Root, zero: Root, gain: f64) -> reference::biquad::Biquad {
    reference::biquad::Biquad::from_roots((pole.real, pole.imaginary), (zero.real, zero.imaginary), gain)
}

impl Chains {
    /// Builds chains from poles and zeros, each chain with a gain of 1 at its loudest place.
    ///
    /// The loudest place is the angle of one of its poles, 0, or half the rate.
    pub fn bounded(poles: &[(f64, f64)], zeros: &[(f64, f64)], depth: usize) -> Self {
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        for (poles, zeros) in poles.chunks(depth).zip(zeros.chunks(depth)) {
            let roots =
                poles.iter().zip(zeros).map(|(&(r, angle), &(q, zero))| (Root::polar(r, angle), Root::polar(q, zero)));
            let plain: Vec<_> = roots.clone().map(|(pole, zero)| section(pole, zero, 1.0)).collect();
            let gain_at = |angle: f64| plain.iter().map(|section| section.magnitude(angle)).product::<f64>();
            let angles = poles.iter().map(|&(_, angle)| angle).chain([0.0, std::f64::consts::PI]);
            let gain = angles.map(gain_at).fold(0.0, f64::max).powf(-1.0 / depth as f64);
            theirs.push(roots.clone().map(|(pole, zero)| section(pole, zero, gain)).collect());
            ours.extend(roots.map(|(pole, zero)| Biquad::from_roots(pole, zero, gain)));
        }
        Self { ours, theirs, depth }
    }

    /// Builds chains from poles and zeros, in which every section's output peaks at -8 dBFS for
    /// `input`.
    ///
    /// Without such gains, poles and zeros that are far apart would leave next to nothing at the
    /// end of a chain.
    pub fn loud(poles: &[(f64, f64)], zeros: &[(f64, f64)], depth: usize, input: &[i32]) -> Self {
        let input: Vec<f64> = input.iter().map(|&x| f64::from(x)).collect();
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        for (poles, zeros) in poles.chunks(depth).zip(zeros.chunks(depth)) {
            let (mut signal, mut chain) = (input.clone(), Vec::new());
            for (&(radius, angle), &(zero_radius, zero_angle)) in poles.iter().zip(zeros) {
                let (pole, zero) = (Root::polar(radius, angle), Root::polar(zero_radius, zero_angle));
                let plain = section(pole, zero, 1.0).filter(&signal);
                let peak = plain.iter().fold(0.0f64, |peak, y| peak.max(y.abs()));
                let gain = 0.4 * FULL_SCALE / peak;
                signal = plain.iter().map(|y| y * gain).collect();
                chain.push(section(pole, zero, gain));
                ours.push(Biquad::from_roots(pole, zero, gain));
            }
            theirs.push(chain);
        }
        Self { ours, theirs, depth }
    }

    /// Output of the `f64` reference for an input.
    pub fn exact(&self, input: &[i32]) -> Vec<f64> {
        reference::biquad::filter(&self.theirs, &input.iter().map(|&x| f64::from(x)).collect::<Vec<_>>())
    }
}

/// Smallest SNR in dB of 50 random banks of chains of `depth` sections, under noise.
///
/// `place` draws poles and zeros for a number of sections. `snr` measures one bank for one input.
pub fn worst_of_depth(
    depth: usize,
    seed: u64,
    place: impl Fn(&mut Random, usize) -> (Roots, Roots),
    snr: impl Fn(&Chains, &[i32]) -> f64,
) -> f64 {
    let mut random = Random::new(seed);
    let mut one = |case: usize| {
        let (poles, zeros) = place(&mut random, depth * (1 + case % 3));
        let input = noise(&mut random, 48_000);
        snr(&Chains::loud(&poles, &zeros, depth, &input), &input)
    };
    (0..50).map(&mut one).fold(f64::INFINITY, f64::min)
}

/// Draws zeros anywhere inside the unit circle, and every fourth on the circle itself.
fn zeros(random: &mut Random, count: usize) -> Roots {
    let zero = |index: usize| {
        let (radius, angle) = root(random, 5.0);
        (if index % 4 == 3 { 1.0 } else { radius }, angle)
    };
    (0..count).map(zero).collect()
}

/// Draws poles anywhere up to a radius of 0.99999, and zeros anywhere, some on the unit circle.
pub fn anywhere(random: &mut Random, count: usize) -> (Roots, Roots) {
    ((0..count).map(|_| root(random, 5.0)).collect(), zeros(random, count))
}

/// Draws chains whose `depth` poles lie within `nearness` of their own widths of each other.
pub fn near(random: &mut Random, count: usize, depth: usize, nearness: f64) -> (Roots, Roots) {
    let mut poles = Vec::new();
    for _ in 0..count / depth {
        let (radius, angle) = root(random, 5.0);
        let width = (1.0 - radius) * nearness;
        for _ in 0..depth {
            let radius = (radius + width * random.between(-0.2, 0.2)).clamp(0.0, 0.999_99);
            poles.push((radius, (angle + width * random.between(-1.0, 1.0)).clamp(0.0, std::f64::consts::PI)));
        }
    }
    (poles, zeros(random, count))
}

/// Bank of `dsp-core` for chains of `depth` biquads, in memory for `pairs` pairs of sections.
///
/// # Errors
/// [`BiquadError`].
pub fn bank(biquads: &[Biquad], depth: usize, pairs: usize) -> Result<Bank<'static>, BiquadError> {
    let mut bank = lent!(lender => Bank::take(lender, pairs));
    bank.load(biquads, depth).map(|()| bank)
}
