//! The kernels in plain Rust: the definition of the bits.
//!
//! The loop takes a mode at a time, because the sum of rounded integers does not depend on the
//! order. On a Cortex-M4 LLVM makes 18.6 cycles a mode and sample of it (it spills the 64-bit
//! sums), which is why there is assembly.

use super::super::coefficient::Form;
use super::super::group::{Group, Plan};
use super::super::mode::{InputGain, Mode};
use super::{Backward, Run, Stereo, slot};
use crate::fixed;
use crate::time::TICK_FRAMES;

/// Rings modes without input, `step; mix`: writes, or adds, the sum of their sound. A mix that is
/// written is 0 beyond the run's frames.
///
/// `modes` begins with those of all `groups`, one group behind the other.
pub fn free(groups: &[Group], modes: &mut [Mode], run: Run, mix: &mut Backward) {
    each(groups, modes, run, mix, |plan, mode, mix| match plan.form() {
        Form::Coupled => ring(mode, step_coupled, plan, mix),
        Form::Shifted1 => ring(mode, step_shifted::<1>, plan, mix),
        Form::Shifted2 => ring(mode, step_shifted::<2>, plan, mix),
    });
}

/// Rings modes as [`free`] does; the mix, with `more` added, goes to the stereo bus.
pub fn free_stereo(groups: &[Group], modes: &mut [Mode], run: Run, more: Option<&Backward>, stereo: Stereo<'_>) {
    let mut mix = more.map_or([0; TICK_FRAMES], |more| *more);
    free(groups, modes, Run { add: true, ..run }, &mut mix);
    pan(&mix, run.frames, stereo);
}

/// Drives modes as [`driven`] does; the mix, with `more` added, goes to the stereo bus.
pub fn driven_stereo(
    groups: &[Group],
    modes: &mut [Mode],
    run: Run,
    force: &Backward,
    more: Option<&Backward>,
    stereo: Stereo<'_>,
) {
    let mut mix = more.map_or([0; TICK_FRAMES], |more| *more);
    driven(groups, modes, Run { add: true, ..run }, force, &mut mix);
    pan(&mix, run.frames, stereo);
}

fn pan(mix: &Backward, frames: usize, stereo: Stereo<'_>) {
    for ([left, right], &sum) in stereo.out.iter_mut().zip(mix.iter().rev().take(frames)) {
        let sample = fixed::saturating_shift_left(sum, stereo.doublings).wrapping_shl(stereo.shift);
        *left = fixed::qadd(*left, fixed::smmulr(sample, stereo.left));
        *right = fixed::qadd(*right, fixed::smmulr(sample, stereo.right));
    }
}

/// Drives modes by a force, `step; inject; mix`, with groups, modes and mix as in [`free`]. The
/// force is shifted as the groups' gains expect it.
pub fn driven(groups: &[Group], modes: &mut [Mode], run: Run, force: &Backward, mix: &mut Backward) {
    let force = force.get(slot(run.frames.saturating_sub(1))..).unwrap_or(&[]);
    each(groups, modes, run, mix, |plan, mode, mix| match plan.form() {
        Form::Coupled => drive(mode, step_coupled, plan, force, mix),
        Form::Shifted1 => drive(mode, step_shifted::<1>, plan, force, mix),
        Form::Shifted2 => drive(mode, step_shifted::<2>, plan, force, mix),
    });
}

/// Drives modes by two forces, and adds their sound to the mix: one by the modes' own gains, one by
/// those of a second position.
///
/// Not in assembly: strikes at two places of a pad within a contact time are rare
/// (`cargo test -p host-tests --test on_chip at_two_places` prints the cycles).
#[inline(never)]
pub fn driven_twice(
    groups: &[Group],
    (modes, seconds): (&mut [Mode], &[InputGain]),
    run: Run,
    [force, second]: &[Backward; 2],
    mix: &mut Backward,
) {
    let last = slot(run.frames.saturating_sub(1));
    let (Some(force), Some(second), Some(mix)) = (force.get(last..), second.get(last..), mix.get_mut(last..)) else {
        return;
    };
    let mut modes = modes.iter_mut().zip(seconds);
    for group in groups {
        let plan = group.plan();
        for (mode, second_gain) in modes.by_ref().take(plan.count()) {
            if run.skip && plan.is_at_rest() {
                continue;
            }
            let mut twice = |step: fn(&mut Mode)| {
                let (first, other, shift) = (mode.gain, *second_gain, plan.gain_shift());
                let (first_u, first_v) = (first.u >> shift, first.v >> shift);
                let (other_u, other_v) = (other.u >> shift, other.v >> shift);
                for ((sum, &x), &y) in mix.iter_mut().zip(force).zip(second).rev() {
                    step(mode);
                    mode.state.u = accumulate(accumulate(mode.state.u, first_u, x), other_u, y);
                    mode.state.v = accumulate(accumulate(mode.state.v, first_v, x), other_v, y);
                    *sum = accumulate(*sum, mode.state.v, plan.mix_scale());
                }
            };
            match plan.form() {
                Form::Coupled => twice(step_coupled),
                Form::Shifted1 => twice(step_shifted::<1>),
                Form::Shifted2 => twice(step_shifted::<2>),
            }
        }
    }
}

fn each(
    groups: &[Group],
    modes: &mut [Mode],
    run: Run,
    mix: &mut Backward,
    mut kernel: impl FnMut(&Plan, &mut Mode, &mut [i32]),
) {
    if !run.add {
        mix.fill(0);
    }
    let Some(frames) = run.frames.checked_sub(1).and_then(|last| mix.get_mut(slot(last)..)) else { return };
    let mut modes = modes.iter_mut();
    for group in groups {
        let plan = group.plan();
        for mode in modes.by_ref().take(plan.count()) {
            if !(run.skip && plan.is_at_rest()) {
                kernel(plan, mode, frames);
            }
        }
    }
}

#[inline(always)]
fn ring(mode: &mut Mode, step: impl Fn(&mut Mode), plan: &Plan, mix: &mut [i32]) {
    for sum in mix.iter_mut().rev() {
        step(mode);
        *sum = accumulate(*sum, mode.state.v, plan.mix_scale());
    }
}

#[inline(always)]
fn drive(mode: &mut Mode, step: impl Fn(&mut Mode), plan: &Plan, force: &[i32], mix: &mut [i32]) {
    let (gain_u, gain_v) = (mode.gain.u >> plan.gain_shift(), mode.gain.v >> plan.gain_shift());
    for (sum, &force) in mix.iter_mut().zip(force).rev() {
        step(mode);
        mode.state.u = accumulate(mode.state.u, gain_u, force);
        mode.state.v = accumulate(mode.state.v, gain_v, force);
        *sum = accumulate(*sum, mode.state.v, plan.mix_scale());
    }
}

#[inline(always)]
fn step_coupled(mode: &mut Mode) {
    let (state, coefficients) = (&mut mode.state, mode.coefficients);
    state.u = diminish(state.u, coefficients.delta, state.u);
    state.u = diminish(state.u, coefficients.epsilon, state.v);
    state.v = accumulate(state.v, coefficients.epsilon, state.u);
}

#[inline(always)]
fn step_shifted<const SHIFT: u32>(mode: &mut Mode) {
    let (state, coefficients) = (&mut mode.state, mode.coefficients);
    state.u = diminish(state.u, coefficients.delta, state.u);
    state.u = diminish(state.u, coefficients.epsilon, state.v);
    let step = state.u.wrapping_shl(SHIFT);
    debug_assert_eq!(step >> SHIFT, state.u, "headroom: u << {SHIFT} wraps");
    debug_assert!(state.v.checked_add(step).is_some(), "headroom: v wraps");
    state.v = state.v.wrapping_add(step);
}

/// SMMLAR, with a check of the headroom in debug builds.
#[inline(always)]
fn accumulate(sum: i32, a: i32, b: i32) -> i32 {
    debug_assert!(sum.checked_add(fixed::smmulr(a, b)).is_some(), "headroom: {sum} + {a} x {b} wraps");
    fixed::smmlar(sum, a, b)
}

/// SMMLSR, with a check of the headroom in debug builds.
#[inline(always)]
fn diminish(sum: i32, a: i32, b: i32) -> i32 {
    debug_assert!(sum.checked_sub(fixed::smmulr(a, b)).is_some(), "headroom: {sum} - {a} x {b} wraps");
    fixed::smmlsr(sum, a, b)
}
