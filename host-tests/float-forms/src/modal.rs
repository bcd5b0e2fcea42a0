//! Modes in the modified coupled form in single precision, as the field ships it, for comparison
//! with the fixed-point forms.
//!
//! Not used by the engine: worst SNR against `f64` 39 dB (near Nyquist), median 103 dB, where the
//! fixed-point forms keep 101 dB and 120 dB (`cargo bench -p host-tests --bench accuracy`), at
//! three multiplies and three additions a sample.
//!
//! # Optimisation log
//!
//! Nominal cycles a mode and sample on a Cortex-M4F, free and driven by one gain, in blocks of 32
//! frames mixed to memory (`cargo bench -p host-tests --bench run_time_vs_error`):
//!
//! - 12.6, 15.9: four modes in registers, the plain loop. LLVM unrolls four frames and fuses each
//!   product with its sum (VMLA, 3 cycles).
//! - 12.1, not measured: two of the three products are taken in the pass before. Unrolled, they are
//!   fused all the same.
//! - **10.6, 14.4**: that, with something opaque in each pass that keeps LLVM from unrolling. Two
//!   products are VMUL and VSUB, 2 cycles.
//! - 11.6, 15.7: three modes, more loop for each.
//! - 10.9, not measured: five modes, four temporaries short of registers.
//!
//! `target-cpu=cortex-m4` stops the fusion too, but schedules sums right behind their products:
//! 12.8 and 17.1 for the plain loop.

/// One mode, `u -= δu; u -= e v; v += e u`: δ apart, because 1 - δ would round away most of a slow
/// decay.
#[derive(Clone, Copy, Debug, Default)]
pub struct FloatMode {
    /// The quadrature component.
    pub u: f32,
    /// The component that sounds.
    pub v: f32,
    /// Gain of the force into u.
    pub gain: f32,
    delta: f32,
    epsilon: f32,
}

impl FloatMode {
    /// A mode of a frequency in Hz and a decay in 1/s at a sample rate in Hz, at rest and with gain
    /// 0; its coefficients are derived in `f64` and rounded once. Frequencies from 0 to below fs/2.
    pub fn new(frequency_hz: f64, decay_per_s: f64, rate_hz: f64) -> Self {
        let radius = libm::exp(-decay_per_s / rate_hz);
        let sine = libm::sin(core::f64::consts::PI * frequency_hz / rate_hz);
        let step_squared = (1.0 - radius) * (1.0 - radius) + 4.0 * radius * sine * sine;
        Self {
            delta: -libm::expm1(-2.0 * decay_per_s / rate_hz) as f32,
            epsilon: libm::sqrt(step_squared) as f32,
            ..Self::default()
        }
    }

    /// Advances one sample and gives v.
    #[inline]
    pub fn step(&mut self) -> f32 {
        self.u -= self.delta * self.u;
        self.u -= self.epsilon * self.v;
        self.v += self.epsilon * self.u;
        self.v
    }

    /// Advances one sample under a force, and gives v: the force is heard a sample later.
    #[inline]
    pub fn step_driven(&mut self, force: f32) -> f32 {
        let v = self.step();
        self.u += self.gain * force;
        v
    }
}

/// Modes held in registers at once.
const TOGETHER: usize = 4;

/// Adds the sound of modes that ring freely to `out`: the bits of [`FloatMode::step`], modes summed
/// in their order.
///
/// 10.6 cycles a mode and sample on a Cortex-M4F.
pub fn free(modes: &mut [FloatMode], out: &mut [f32]) {
    let (fours, rest) = modes.as_chunks_mut::<TOGETHER>();
    fours.iter_mut().for_each(|four| free_together(four, out));
    rest.as_chunks_mut::<1>().0.iter_mut().for_each(|one| free_together(one, out));
}

/// Adds the sound of modes under a force to `out`: the bits of [`FloatMode::step_driven`], modes
/// summed in their order. Frames beyond the shorter of `force` and `out` are left alone.
///
/// 14.4 cycles a mode and sample on a Cortex-M4F.
pub fn driven(modes: &mut [FloatMode], force: &[f32], out: &mut [f32]) {
    let (fours, rest) = modes.as_chunks_mut::<TOGETHER>();
    fours.iter_mut().for_each(|four| driven_together(four, force, out));
    rest.as_chunks_mut::<1>().0.iter_mut().for_each(|one| driven_together(one, force, out));
}

/// Modes in registers, with the two products that their next step begins with.
struct Together<const N: usize> {
    u: [f32; N],
    v: [f32; N],
    delta: [f32; N],
    epsilon: [f32; N],
    damped: [f32; N],
    turned: [f32; N],
}

impl<const N: usize> Together<N> {
    #[inline(always)]
    fn load(modes: &[FloatMode; N]) -> Self {
        Self {
            u: modes.map(|mode| mode.u),
            v: modes.map(|mode| mode.v),
            delta: modes.map(|mode| mode.delta),
            epsilon: modes.map(|mode| mode.epsilon),
            damped: modes.map(|mode| mode.delta * mode.u),
            turned: modes.map(|mode| mode.epsilon * mode.v),
        }
    }

    #[inline(always)]
    fn store(&self, modes: &mut [FloatMode; N]) {
        for (mode, (&u, &v)) in modes.iter_mut().zip(self.u.iter().zip(&self.v)) {
            (mode.u, mode.v) = (u, v);
        }
    }

    /// The products of the next step.
    #[inline(always)]
    fn prepare(&mut self) {
        for m in 0..N {
            self.damped[m] = self.delta[m] * self.u[m];
        }
        for m in 0..N {
            self.turned[m] = self.epsilon[m] * self.v[m];
        }
    }

    #[inline(always)]
    fn step(&mut self) {
        for m in 0..N {
            self.u[m] -= self.damped[m];
        }
        for m in 0..N {
            self.u[m] -= self.turned[m];
        }
        for m in 0..N {
            self.v[m] += self.epsilon[m] * self.u[m];
        }
    }
}

#[inline(always)]
fn free_together<const N: usize>(modes: &mut [FloatMode; N], out: &mut [f32]) {
    let mut together = Together::load(modes);
    for sum in out {
        together.step();
        *sum = together.v.iter().fold(*sum, |sum, v| sum + v);
        together.prepare();
        keep_apart();
    }
    together.store(modes);
}

#[inline(always)]
fn driven_together<const N: usize>(modes: &mut [FloatMode; N], force: &[f32], out: &mut [f32]) {
    let mut together = Together::load(modes);
    let gain = modes.map(|mode| mode.gain);
    for (sum, &force) in out.iter_mut().zip(force) {
        together.step();
        *sum = together.v.iter().fold(*sum, |sum, v| sum + v);
        for (u, gain) in together.u.iter_mut().zip(gain) {
            *u += gain * force;
        }
        together.prepare();
        keep_apart();
    }
    together.store(modes);
}

/// Keeps frames in passes of their own; no instruction by itself.
#[inline(always)]
fn keep_apart() {
    core::hint::black_box(());
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use super::*;

    fn modes(count: usize) -> Vec<FloatMode> {
        let mode = |index: usize| FloatMode {
            v: 0.3 / (index + 1) as f32,
            gain: 0.01 * (index + 1) as f32,
            ..FloatMode::new(110.0 * (index + 1) as f64, 3.0, 48_000.0)
        };
        (0..count).map(mode).collect()
    }

    fn bits(modes: &[FloatMode], out: &[f32]) -> Vec<u32> {
        let states = modes.iter().flat_map(|mode| [mode.u, mode.v]);
        states.chain(out.iter().copied()).map(f32::to_bits).collect()
    }

    #[test]
    fn a_block_has_the_bits_of_single_steps() {
        for (count, frames) in [(0, 5), (1, 32), (3, 7), (4, 32), (4, 0), (6, 1), (13, 32)] {
            let force: Vec<f32> = (0..frames).map(|frame| (frame as f32 * 0.7).sin()).collect();
            let (mut block, mut single) = (modes(count), modes(count));
            let (mut out, mut expected) = (vec![0.25; frames], vec![0.25; frames]);
            driven(&mut block, &force, &mut out);
            free(&mut block, &mut out);
            for (sum, &force) in expected.iter_mut().zip(&force) {
                single.iter_mut().for_each(|mode| *sum += mode.step_driven(force));
            }
            for sum in &mut expected {
                single.iter_mut().for_each(|mode| *sum += mode.step());
            }
            assert_eq!(bits(&block, &out), bits(&single, &expected), "{count} modes, {frames} frames");
        }
    }
}
