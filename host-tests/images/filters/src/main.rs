//! The dynamic filter and waveguides on a bare Cortex-M4F, without a board.
//!
//! Nothing starts by itself: the virtual core writes numbers into memory and calls the exported
//! functions. They return 0, or a negative number that gives the reason for a failure. The code on
//! the host is `host-tests/src/on_chip/filters.rs`.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;
use core::panic::PanicInfo;

use dsp_core::SampleRate;
use dsp_core::dynamic_filter::{Breakpoint, DynamicFilter, Exciter, Settings};
use dsp_core::memory::{Memory, Word};
use dsp_core::waveguide::Loop;

struct Global<T>(UnsafeCell<T>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl<T> Sync for Global<T> {}

static FILTER: Global<DynamicFilter<'static>> = Global(UnsafeCell::new(DynamicFilter::empty()));
/// Memory of 16 breakpoints, 10 loops and 2048 frames of delay.
static WORDS: Global<[Word; 1_500]> = Global(UnsafeCell::new([Word::uninit(); 1_500]));

/// Loads a dynamic filter at 48 kHz with seed and stream 9. -1: refused.
///
/// A breakpoint has seven numbers (time, a1, a2, b0, b1, b2, noise), a loop four (frequency,
/// bandwidth, gain, delay). `exciter` has three (low edge, high edge, exponent) or is null.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn filter_load(
    points: *const [f64; 7],
    count: usize,
    loops: *const [f64; 4],
    bands: usize,
    order: u8,
    exciter: *const [f64; 3],
) -> i32 {
    // SAFETY: the host has written as many numbers there.
    let (points, loops, exciter) = unsafe {
        let exciter = (!exciter.is_null()).then(|| *exciter);
        (core::slice::from_raw_parts(points, count), core::slice::from_raw_parts(loops, bands), exciter)
    };
    let point = |&[time_s, a1, a2, b0, b1, b2, noise]: &[f64; 7]| Breakpoint { time_s, a1, a2, b0, b1, b2, noise };
    let one =
        |&[frequency_hz, bandwidth_hz, gain, delay_s]: &[f64; 4]| Loop { frequency_hz, bandwidth_hz, gain, delay_s };
    let settings = Settings {
        seed: 9,
        rate_hz: 48_000.0,
        order,
        modes_through: false,
        exciter: exciter.map(|[low_hz, high_hz, exponent]| Exciter { low_hz, high_hz, exponent }),
        path: points.iter().map(point),
        loops: loops.iter().map(one),
    };
    // SAFETY: see `Sync` for `Global`; the filter that had the words before is replaced.
    let (filter, words) = unsafe { (&mut *FILTER.0.get(), &mut *WORDS.0.get()) };
    let Ok(size) = DynamicFilter::size(&settings, SampleRate::HZ_48000) else { return -1 };
    let Ok(taken) = DynamicFilter::take(&mut Memory::new(&mut [], words), size) else { return -1 };
    *filter = taken;
    match filter.load(settings, SampleRate::HZ_48000, 9) {
        Ok(()) => 0,
        Err(_) => -1,
    }
}

/// Strikes the filter at a level, given as the bits of an f32.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn filter_strike(level_bits: u32) {
    // SAFETY: see `Sync` for `Global`.
    unsafe { &mut *FILTER.0.get() }.strike(f32::from_bits(level_bits));
}

/// Adds the sound of a block to `out`. `modes` may be null.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn filter_render(modes: *const i32, out: *mut i32, frames: usize) {
    // SAFETY: the host leaves `frames` samples at each address that is not null.
    let (modes, out) = unsafe {
        let modes = (!modes.is_null()).then(|| core::slice::from_raw_parts(modes, frames));
        (modes, core::slice::from_raw_parts_mut(out, frames))
    };
    // SAFETY: see `Sync` for `Global`.
    unsafe { &mut *FILTER.0.get() }.render(modes, out);
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
