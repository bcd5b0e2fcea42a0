//! The kernels for a Cortex-M4F: `cortex_m4.s`, with the bits of [`super::portable`].
#![allow(unsafe_code)] // assembly; the only place of this crate

use core::mem::offset_of;

use super::super::group::{GROUP_MODES, Group, Plan};
use super::super::mode::Mode;
use super::{Backward, Run, Stereo};
use crate::time::TICK_FRAMES;

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

/// Arguments of the assembly.
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
    doublings: u32,
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
            && offset_of!(Call, doublings) == 48
    );
    assert!(TICK_FRAMES == 32);
};

unsafe extern "C" {
    fn malleus_kernel_free(call: *const Call);
    fn malleus_kernel_driven(call: *const Call);
}

/// Rings modes as [`super::portable::free`] does. 5.45 cycles a mode and sample (nominal, 240
/// modes: `cargo test -p host-tests --test on_chip costs -- --nocapture`).
pub fn free(groups: &[Group], modes: &mut [Mode], run: Run, mix: &mut Backward) {
    render(groups, modes, run, Sound { mix, ..Sound::NOWHERE }, malleus_kernel_free);
}

/// Rings modes to the stereo bus as [`super::portable::free_stereo`] does.
#[inline(always)]
pub fn free_stereo(groups: &[Group], modes: &mut [Mode], run: Run, more: Option<&Backward>, stereo: Stereo<'_>) {
    let Some(sound) = Sound::stereo(run, more, stereo) else { return };
    render(groups, modes, Run { add: more.is_some(), ..run }, sound, malleus_kernel_free);
}

/// Drives modes as [`super::portable::driven`] does. 7.65 cycles a mode and sample with one gain,
/// 9.21 with gain and phase (nominal, 240 modes).
pub fn driven(groups: &[Group], modes: &mut [Mode], run: Run, force: &Backward, mix: &mut Backward) {
    render(groups, modes, run, Sound { mix, force, ..Sound::NOWHERE }, malleus_kernel_driven);
}

/// Drives modes to the stereo bus as [`super::portable::driven_stereo`] does.
pub fn driven_stereo(
    groups: &[Group],
    modes: &mut [Mode],
    run: Run,
    force: &Backward,
    more: Option<&Backward>,
    stereo: Stereo<'_>,
) {
    let Some(sound) = Sound::stereo(run, more, stereo) else { return };
    render(groups, modes, Run { add: more.is_some(), ..run }, Sound { force, ..sound }, malleus_kernel_driven);
}

/// Source of the force and destination of the sound. The assembly reads `mix` if the run adds to
/// it, and writes it if `stereo` is null.
struct Sound {
    mix: *mut Backward,
    force: *const Backward,
    stereo: *mut [i32; 2],
    left: i32,
    right: i32,
    shift: u32,
    doublings: u32,
}

impl Sound {
    const NOWHERE: Self = Self {
        mix: core::ptr::null_mut(),
        force: core::ptr::null(),
        stereo: core::ptr::null_mut(),
        left: 0,
        right: 0,
        shift: 0,
        doublings: 0,
    };

    /// A sound on the stereo bus; `None` if the run does not fit.
    #[inline(always)]
    fn stereo(run: Run, more: Option<&Backward>, stereo: Stereo<'_>) -> Option<Self> {
        let fits = stereo.out.len() >= run.frames;
        let mix = more.map_or(core::ptr::null_mut(), |more| core::ptr::from_ref(more).cast_mut());
        let Stereo { out, left, right, shift, doublings } = stereo;
        let (shift, doublings) = (shift.min(31), doublings.min(31));
        fits.then_some(Self { mix, stereo: out.as_mut_ptr(), left, right, shift, doublings, ..Self::NOWHERE })
    }
}

#[inline(always)]
fn render(groups: &[Group], modes: &mut [Mode], run: Run, sound: Sound, kernel: unsafe extern "C" fn(*const Call)) {
    if run.frames == 0 || run.frames > TICK_FRAMES || !modes_suffice(groups, modes) {
        return;
    }
    let groups = groups.as_ptr_range();
    let call = Call {
        modes: modes.as_mut_ptr(),
        groups: groups.start,
        groups_end: groups.end,
        mix: sound.mix,
        force: sound.force,
        frames: run.frames as u32,
        skip: u32::from(run.skip),
        add: u32::from(run.add),
        stereo: sound.stereo,
        left: sound.left,
        right: sound.right,
        shift: sound.shift,
        doublings: sound.doublings,
    };
    // SAFETY: the groups' modes lie within `modes`, borrowed mutably for the call. Without stereo,
    // `mix` is borrowed mutably for the call; with it, the stereo frames are, which are at least as
    // many as the run's, and `mix` is only read, where the run adds to it, and then borrowed.
    // `force` is null for the free kernel, which does not read it, and borrowed for the driven one.
    // Frames are 1 to 32, so that the assembly stays within its buffers; it keeps the procedure
    // call standard and uses 320 bytes of stack.
    unsafe { kernel(&call) }
}

/// True if there are enough modes for the groups. The banks of this crate always have them; the
/// check here makes the call sound. If the modes suffice for full groups there is nothing to add
/// up.
#[inline(always)]
fn modes_suffice(groups: &[Group], modes: &[Mode]) -> bool {
    groups.len() * GROUP_MODES <= modes.len() || counted_modes(groups) <= modes.len()
}

#[cold]
#[inline(never)]
fn counted_modes(groups: &[Group]) -> usize {
    groups.iter().map(Group::count).sum()
}
