//! The hot loops: one register group of modes over a run of frames.
//!
//! Each sample of each mode is: step, inject, mix. A `kernel` function takes modes that share a form and a block exponent, so that the mix
//! scale is one number, and adds their sound to `mix`. The plain Rust here is the definition of the bits; it is written a mode at a
//! time, because the sum of rounded integers does not depend on the order.
//!
//! States never wrap: [`super::headroom`] bounds them before a kernel is called, and in builds with debug assertions each
//! addition is checked.

use super::coefficient::Form;
use super::mode::Mode;
use crate::fixed;

/// Modes that ring on without input: `step; mix`.
pub fn free(form: Form, modes: &mut [Mode], mix_scale: i32, mix: &mut [i32]) {
    match form {
        Form::Coupled => each(modes, |mode| ring(mode, step_coupled, mix_scale, mix)),
        Form::Shifted0 => each(modes, |mode| ring(mode, step_shifted::<0>, mix_scale, mix)),
        Form::Shifted1 => each(modes, |mode| ring(mode, step_shifted::<1>, mix_scale, mix)),
        Form::Shifted2 => each(modes, |mode| ring(mode, step_shifted::<2>, mix_scale, mix)),
    }
}

/// Modes under a force: `step; inject; mix`. The gains are shifted right by `gain_shift` (rounded) into the group's exponent.
pub fn driven(form: Form, modes: &mut [Mode], gain_shift: u32, force: &[i32], mix_scale: i32, mix: &mut [i32]) {
    match form {
        Form::Coupled => each(modes, |mode| drive(mode, step_coupled, gain_shift, force, mix_scale, mix)),
        Form::Shifted0 => each(modes, |mode| drive(mode, step_shifted::<0>, gain_shift, force, mix_scale, mix)),
        Form::Shifted1 => each(modes, |mode| drive(mode, step_shifted::<1>, gain_shift, force, mix_scale, mix)),
        Form::Shifted2 => each(modes, |mode| drive(mode, step_shifted::<2>, gain_shift, force, mix_scale, mix)),
    }
}

fn each(modes: &mut [Mode], mut run: impl FnMut(&mut Mode)) {
    modes.iter_mut().for_each(&mut run);
}

#[inline(always)]
fn ring(mode: &mut Mode, step: impl Fn(&mut Mode), mix_scale: i32, mix: &mut [i32]) {
    for sum in mix {
        step(mode);
        *sum = accumulate(*sum, mode.state.v, mix_scale);
    }
}

#[inline(always)]
fn drive(mode: &mut Mode, step: impl Fn(&mut Mode), gain_shift: u32, force: &[i32], mix_scale: i32, mix: &mut [i32]) {
    let gain_u = fixed::rounding_shift_right(mode.gain.u, gain_shift);
    let gain_v = fixed::rounding_shift_right(mode.gain.v, gain_shift);
    for (sum, &force) in mix.iter_mut().zip(force) {
        step(mode);
        mode.state.u = accumulate(mode.state.u, gain_u, force);
        mode.state.v = accumulate(mode.state.v, gain_v, force);
        *sum = accumulate(*sum, mode.state.v, mix_scale);
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

/// SMMLAR, with a check in debug builds that the headroom proof holds.
#[inline(always)]
fn accumulate(sum: i32, a: i32, b: i32) -> i32 {
    debug_assert!(sum.checked_add(fixed::smmulr(a, b)).is_some(), "headroom: {sum} + {a} x {b} wraps");
    fixed::smmlar(sum, a, b)
}

/// SMMLSR, with the same check.
#[inline(always)]
fn diminish(sum: i32, a: i32, b: i32) -> i32 {
    debug_assert!(sum.checked_sub(fixed::smmulr(a, b)).is_some(), "headroom: {sum} - {a} x {b} wraps");
    fixed::smmlsr(sum, a, b)
}
