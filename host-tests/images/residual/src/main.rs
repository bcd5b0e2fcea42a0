//! The residual stage alone on a bare Cortex-M4F, without a board.
//!
//! Nothing starts by itself: the virtual core writes bands into memory and calls the exported
//! functions. The code on the host is `host-tests/src/on_chip/residual.rs`.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;
use core::panic::PanicInfo;

use dsp_core::SampleRate;
use dsp_core::memory::{Memory, Word};
use dsp_core::noise::Sfc32;
use dsp_core::residual::{MAX_BANDS, ResidualBand, Shaper};
use dsp_core::resonator::TICK_FRAMES;

struct Global<T>(UnsafeCell<T>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl<T> Sync for Global<T> {}

static SHAPER: Global<Shaper<'static>> = Global(UnsafeCell::new(Shaper::none()));
/// Memory of [`MAX_BANDS`] bands.
static WORDS: Global<[Word; 3_000]> = Global(UnsafeCell::new([Word::uninit(); 3_000]));

fn shaper() -> &'static mut Shaper<'static> {
    // SAFETY: see `Sync` for `Global`: this is the running call's only reference.
    unsafe { &mut *SHAPER.0.get() }
}

/// Derives the stage at 48 kHz. -1: too many bands.
///
/// A band has four numbers: lower edge, upper edge, weight, decay.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn residual_load(bands: *const [f32; 4], count: usize, seed: u32, silence: u32) -> i32 {
    if count > MAX_BANDS {
        return -1;
    }
    // SAFETY: the host has written `count` bands there, and nothing else uses them during the call.
    let bands = unsafe { core::slice::from_raw_parts(bands, count) };
    let bands = bands.iter().map(|&[low, high, weight, decay_db_per_s]| ResidualBand {
        edges_hz: [low, high],
        weight,
        decay_db_per_s,
    });
    // SAFETY: see `Sync` for `Global`; the stage that had the words before is replaced.
    let words = unsafe { &mut *WORDS.0.get() };
    let Ok(taken) = Shaper::take(&mut Memory::new(&mut [], words), count) else { return -1 };
    *shaper() = taken;
    shaper().load(bands, SampleRate::HZ_48000, Sfc32::new(seed, 0), f32::from_bits(silence));
    0
}

/// Adds the sound of a tick to `out`. -1: `offset` is beyond the tick.
///
/// If `strength` (the bits of an `f32`) is above 0, a strike falls at frame `offset`.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn residual_tick(strength: u32, offset: usize, out: *mut [i32; TICK_FRAMES]) -> i32 {
    // SAFETY: the host leaves a tick of output there.
    let out = unsafe { &mut *out };
    let strength = f32::from_bits(strength);
    let Some((before, after)) = out.split_at_mut_checked(offset) else { return -1 };
    if !before.is_empty() {
        shaper().render(before);
    }
    if strength > 0.0 {
        shaper().strike(strength, offset);
    }
    shaper().render(after);
    shaper().end_tick(0);
    0
}

/// Entry that a linker needs; the virtual core never starts here.
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
