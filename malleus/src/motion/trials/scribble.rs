//! Smooth random path of a scribble.

use std::f64::consts::TAU;

use dsp_core::noise::Sfc32;

/// Lowest and highest frequency of the hand's waves in Hz.
const FREQUENCIES_HZ: [f64; 2] = [0.5, 2.5];
/// Number of waves along each axis.
const WAVES: usize = 6;
/// Stream of the generator that draws the path; that of the variations is another one.
const STREAM: u32 = 0x5c21;

/// Wave along one axis, with an amplitude of speed 1.
#[derive(Clone, Copy, Debug)]
struct Wave {
    angular: f64,
    phase: f64,
}

/// Path whose place is a sum of waves along x and along y.
#[derive(Clone, Debug)]
pub(super) struct Path {
    waves: [[Wave; WAVES]; 2],
}

/// Random number from 0 to 1, 1 excluded.
pub(super) fn uniform(random: &mut Sfc32) -> f64 {
    f64::from(random.draw()) / 4_294_967_296.0
}

impl Path {
    /// Path of a seed. The frequencies are one in each of equal parts of the logarithmic range, so
    /// that no seed gives a path of slow waves or of quick ones alone.
    pub(super) fn new(seed: u32) -> Self {
        let mut random = Sfc32::new(seed, STREAM);
        let ratio = FREQUENCIES_HZ[1] / FREQUENCIES_HZ[0];
        let waves = [0, 1].map(|_| {
            std::array::from_fn(|index| {
                let part = (index as f64 + uniform(&mut random)) / WAVES as f64;
                let angular = TAU * FREQUENCIES_HZ[0] * ratio.powf(part);
                Wave { angular, phase: TAU * uniform(&mut random) }
            })
        });
        Self { waves }
    }

    /// Place at a time, from the place at time 0.
    pub(super) fn place(&self, time_s: f64) -> [f64; 2] {
        self.waves.map(|axis| {
            axis.iter().map(|wave| ((wave.angular * time_s + wave.phase).sin() - wave.phase.sin()) / wave.angular).sum()
        })
    }

    /// Length of the path from time 0 to `seconds`, by Simpson's rule in steps of at most 2 ms.
    pub(super) fn length(&self, seconds: f64) -> f64 {
        let steps = 2 * (seconds / 0.002).ceil().max(1.0) as u32;
        let h = seconds / f64::from(steps);
        let speed = |n: u32| {
            let time_s = f64::from(n) * h;
            let [x, y] =
                self.waves.map(|axis| axis.iter().map(|wave| (wave.angular * time_s + wave.phase).cos()).sum::<f64>());
            x.hypot(y)
        };
        let weight = |n: u32| if n == 0 || n == steps { 1.0 } else { f64::from(2 + 2 * (n % 2)) };
        (0..=steps).map(|n| weight(n) * speed(n)).sum::<f64>() * h / 3.0
    }
}
