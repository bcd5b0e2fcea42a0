//! The kernel for a Cortex-M4F: `cortex_m4.s`, bit for bit what [`super::portable`] does.
#![allow(unsafe_code)] // assembly

use core::mem::offset_of;

use super::super::section::{Role, Section};
use super::{Signals, portable};
use crate::resonator::TICK_FRAMES;

core::arch::global_asm!(".equ BIQUAD_SECTION, {section}", section = const size_of::<Section>());
core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

/// What the assembly takes.
#[repr(C)]
struct Call {
    section: *mut Section,
    end: *mut Section,
    frames: u32,
    sources: [*const i32; 2],
    mixes: [*mut i32; 2],
}

// The offsets that cortex_m4.s uses.
const _: () = {
    assert!(offset_of!(Section, u) == 0 && offset_of!(Section, v) == 4 && offset_of!(Section, gain_v) == 20);
    assert!(offset_of!(Section, scale) == 28 && offset_of!(Section, low) == 32 && offset_of!(Section, span) == 36);
    assert!(offset_of!(Section, kind) == 40 && offset_of!(Section, source) == 41);
    assert!(offset_of!(Call, frames) == 8 && offset_of!(Call, sources) == 12 && offset_of!(Call, mixes) == 20);
};

unsafe extern "C" {
    fn malleus_biquads(call: *const Call) -> u32;
}

/// As [`portable::run`]. Sections that follow one another in a chain are run by that.
pub fn run(sections: &mut [Section], signals: &mut Signals, frames: usize, odd: bool) -> bool {
    if frames == 0 || frames > TICK_FRAMES {
        return false;
    }
    let mut asks = false;
    for same in sections.chunk_by_mut(|a, b| (a.role() == Role::Only) == (b.role() == Role::Only)) {
        let alone = same.first().is_some_and(|section| section.role() == Role::Only);
        if !alone {
            asks |= portable::run(same, signals, frames, odd);
            continue;
        }
        let ends = same.as_mut_ptr_range();
        let call = Call {
            section: ends.start,
            end: ends.end,
            frames: frames as u32,
            sources: [signals.input.as_ptr(), signals.alternating.as_ptr()],
            mixes: [signals.mix.as_mut_ptr(), signals.alternating_mix.as_mut_ptr()],
        };
        // SAFETY: the sections and the signals are borrowed mutably for the call; frames are 1 to 32, so that the assembly stays within the
        // signals; a section alone has a source of 0 or 1 (its only writer, `Section::place`, is given nothing else for this role).
        asks |= unsafe { malleus_biquads(&call) } != 0;
    }
    asks
}
