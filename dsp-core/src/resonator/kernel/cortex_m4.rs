//! The kernels for a Cortex-M4F: `cortex_m4.s`, bit for bit what [`super::portable`] does.
#![allow(unsafe_code)] // assembly; the only place of this crate

use core::mem::offset_of;

use super::super::TICK_FRAMES;
use super::super::group::{GROUP_MODES, Group};
use super::super::mode::Mode;
use super::{Backward, Plan, Run, Stereo};

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

/// What the assembly takes.
#[repr(C)]
struct Call {
    modes: *mut Mode,
    groups: *const Group,
    groups_end: *const Group,
    mix: *mut Backward,
    force: *const Backward,
    frames: u32,
    skip: u32,
    add: u32,
    stereo: *mut [i32; 2],
    left: i32,
    right: i32,
    shift: u32,
}

// The offsets that cortex_m4.s uses.
const _: () = {
    assert!(size_of::<Mode>() == 24 && size_of::<Group>() == 24 && size_of::<Plan>() == 8);
    assert!(offset_of!(Mode, state) == 0 && offset_of!(Mode, coefficients) == 8 && offset_of!(Mode, gain) == 16);
    assert!(
        offset_of!(Call, groups_end) == 8
            && offset_of!(Call, force) == 16
            && offset_of!(Call, skip) == 24
            && offset_of!(Call, add) == 28
            && offset_of!(Call, shift) == 44
    );
    assert!(TICK_FRAMES == 32);
};

unsafe extern "C" {
    fn malleus_kernel_free(call: *const Call);
    fn malleus_kernel_driven(call: *const Call);
}

/// As [`super::portable::free`]. 5.45 cycles a mode and sample (nominal, 240 modes: `cargo test -p host-tests --test virtual_costs -- --nocapture`).
pub fn free(groups: &[Group], modes: &mut [Mode], run: Run, mix: &mut Backward) {
    render(groups, modes, run, core::ptr::null(), mix, None, malleus_kernel_free);
}

/// As [`super::portable::free_stereo`].
pub fn free_stereo(groups: &[Group], modes: &mut [Mode], run: Run, mix: &mut Backward, stereo: Stereo<'_>) {
    render(groups, modes, run, core::ptr::null(), mix, Some(stereo), malleus_kernel_free);
}

/// As [`super::portable::driven`]. 7.65 cycles a mode and sample with one gain, 9.21 with gain and phase (nominal, as above).
pub fn driven(groups: &[Group], modes: &mut [Mode], run: Run, force: &Backward, mix: &mut Backward) {
    render(groups, modes, run, force, mix, None, malleus_kernel_driven);
}

#[inline(always)]
fn render(
    groups: &[Group],
    modes: &mut [Mode],
    run: Run,
    force: *const Backward,
    mix: &mut Backward,
    stereo: Option<Stereo<'_>>,
    kernel: unsafe extern "C" fn(*const Call),
) {
    let stereo_fits = stereo.as_ref().is_none_or(|stereo| stereo.out.len() >= run.frames);
    if run.frames == 0 || run.frames > TICK_FRAMES || !modes_suffice(groups, modes) || !stereo_fits {
        return;
    }
    let (out, left, right, shift) = match stereo {
        Some(stereo) => (stereo.out.as_mut_ptr(), stereo.left, stereo.right, stereo.shift.min(31)),
        None => (core::ptr::null_mut(), 0, 0, 0),
    };
    let groups = groups.as_ptr_range();
    let call = Call {
        modes: modes.as_mut_ptr(),
        groups: groups.start,
        groups_end: groups.end,
        mix,
        force,
        frames: run.frames as u32,
        skip: u32::from(run.skip),
        add: u32::from(run.add),
        stereo: out,
        left,
        right,
        shift,
    };
    // SAFETY: the groups' modes lie within `modes`, borrowed mutably for the call as are `mix` and the stereo
    // frames, which are at least as many as the run's; `force` is null for the free kernel, which
    // does not read it, and borrowed for the call for the driven one; frames are 1 to 32, so that the assembly stays within its
    // buffers; it keeps the procedure call standard and uses 300 bytes of stack.
    unsafe { kernel(&call) }
}

/// The banks of this crate see to it; here it is what makes the call sound. Where many modes lie behind the groups' own there is nothing to add up.
#[inline(always)]
fn modes_suffice(groups: &[Group], modes: &[Mode]) -> bool {
    groups.len() * GROUP_MODES <= modes.len() || counted_modes(groups) <= modes.len()
}

#[cold]
#[inline(never)]
fn counted_modes(groups: &[Group]) -> usize {
    groups.iter().map(Group::count).sum()
}
