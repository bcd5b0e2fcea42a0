//! The trigger on a bare Cortex-M4F, without a board.
//!
//! Nothing starts by itself: the virtual core writes ADC frames into memory and calls the exported
//! functions. The code on the host is `host-tests/src/trigger/on_chip.rs`.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;
use core::panic::PanicInfo;

use dsp_core::SampleRate;
use dsp_core::trigger::{Mode, Report, Resampler, Settings, Trigger};

/// Number of channels, that of a board.
const CHANNELS: usize = 4;
/// Maximum number of strikes that one call reports.
const STRIKES: usize = 64;

/// Strike as the host reads it.
#[derive(Clone, Copy)]
#[repr(C)]
struct Strike {
    frame: u64,
    pad: u32,
    velocity_bits: u32,
}

struct State {
    trigger: Option<Trigger<CHANNELS>>,
    resampler: Option<Resampler>,
    strikes: [Strike; STRIKES],
}

struct Global(UnsafeCell<State>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl Sync for Global {}

static STATE: Global = Global(UnsafeCell::new(State {
    trigger: None,
    resampler: None,
    strikes: [Strike { frame: 0, pad: 0, velocity_bits: 0 }; STRIKES],
}));

fn state() -> &'static mut State {
    // SAFETY: see `Sync` for `Global`: this is the running call's only reference.
    unsafe { &mut *STATE.0.get() }
}

/// Sets up four pads at 48 kHz with their defaults. -1: refused.
///
/// The last pad is in direct mode unless `direct` is 0.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn trigger_new(direct: u32) -> i32 {
    let pads = (0..CHANNELS as u8).map(|pad| {
        let usual = Settings::of_unset_pad(pad);
        if direct != 0 && usize::from(pad) + 1 == CHANNELS { Settings { mode: Mode::Direct, ..usual } } else { usual }
    });
    let output = SampleRate::new(86_000_000, 1792);
    state().trigger = Trigger::new(pads, SampleRate::HZ_48000).ok();
    state().resampler = output.and_then(|output| Resampler::new(SampleRate::HZ_48000, output, 64).ok());
    if state().trigger.is_some() && state().resampler.is_some() { 0 } else { -1 }
}

/// Takes ADC frames. Gives the number of strikes, or -1 if nothing was set up.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn trigger_process(frames: *const [u16; CHANNELS], count: usize) -> i32 {
    // SAFETY: the host has written `count` frames there.
    let frames = unsafe { core::slice::from_raw_parts(frames, count) };
    let State { trigger: Some(trigger), resampler: Some(resampler), strikes } = state() else { return -1 };
    let mut found = 0;
    trigger.process(frames, |report| match report {
        Report::Strike(strike) => {
            if let Some(place) = strikes.get_mut(found) {
                let velocity_bits = strike.velocity.to_bits();
                *place = Strike { frame: strike.frame, pad: strike.pad.into(), velocity_bits };
                found += 1;
            }
        }
        Report::Force { samples, .. } => resampler.push(samples),
        Report::Fault { .. } | Report::Recovered { .. } => {}
    });
    found as i32
}

/// Address of the strikes of the last call, 16 bytes each.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn trigger_strikes() -> u32 {
    state().strikes.as_ptr() as u32
}

/// Gives the next samples of the direct pad's force. -1: nothing was set up.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn trigger_force(out: *mut i32, count: usize) -> i32 {
    // SAFETY: the host leaves room for `count` samples there.
    let out = unsafe { core::slice::from_raw_parts_mut(out, count) };
    match &mut state().resampler {
        Some(resampler) => {
            resampler.pull(out);
            0
        }
        None => -1,
    }
}

/// Bytes of the trigger's state.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn trigger_bytes() -> u32 {
    size_of::<Trigger<CHANNELS>>() as u32
}

/// The virtual core never starts here; a linker needs an entry.
#[unsafe(no_mangle)]
pub extern "C" fn _start() -> ! {
    loop {}
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // An undefined instruction: the virtual core stops and names the function.
    // SAFETY: never returns.
    unsafe { core::arch::asm!("udf #0", options(noreturn)) }
}
