//! Biquads, the dynamic filter and waveguides on a bare Cortex-M4F, without a board.
//!
//! Nothing starts by itself: the virtual core writes numbers into memory and calls the exported functions, which return 0 or a
//! negative number that says why not. The host's side of it is `host-tests/src/on_chip/filters.rs`.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;
use core::panic::PanicInfo;

use dsp_core::SampleRate;
use dsp_core::biquad::{Bank, Biquad, Root};
use dsp_core::dynamic_filter::{Breakpoint, DynamicFilter, Path};
use dsp_core::waveguide::{Band, Waveguides};

struct Global<T>(UnsafeCell<T>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl<T> Sync for Global<T> {}

static BIQUADS: Global<Bank<64>> = Global(UnsafeCell::new(Bank::EMPTY));

/// Loads `count` biquads of five words (pole, numerator) in chains of `depth`. -1: refused.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn biquads_load(numbers: *const [f64; 5], count: usize, depth: usize) -> i32 {
    // SAFETY: the host's word.
    let numbers = unsafe { core::slice::from_raw_parts(numbers, count) };
    let mut biquads = [Biquad { pole: Root::polar(0.0, 0.0), numerator: [0.0; 3] }; 64];
    for (biquad, &[real, imaginary, b0, b1, b2]) in biquads.iter_mut().zip(numbers) {
        *biquad = Biquad { pole: Root { real, imaginary }, numerator: [b0, b1, b2] };
    }
    // SAFETY: as for `Sync`.
    let bank = unsafe { &mut *BIQUADS.0.get() };
    match biquads.get(..count).map(|biquads| bank.load(biquads, depth)) {
        Some(Ok(())) => 0,
        _ => -1,
    }
}

/// Adds a block to `out`. `input` may be null.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn biquads_render(input: *const i32, out: *mut i32, frames: usize) {
    // SAFETY: the host's word.
    let (input, out) = unsafe {
        let input = (!input.is_null()).then(|| core::slice::from_raw_parts(input, frames));
        (input, core::slice::from_raw_parts_mut(out, frames))
    };
    // SAFETY: as for `Sync`.
    unsafe { &mut *BIQUADS.0.get() }.render(input, out);
}

static FILTER: Global<Option<DynamicFilter<16>>> = Global(UnsafeCell::new(None));
static GUIDES: Global<Option<Waveguides<16, 10, 2048>>> = Global(UnsafeCell::new(None));

/// Makes a filter of breakpoints of four words (time, b0, b1, a1) at 48 kHz, and, of loops of three (frequency, bandwidth, gain), waveguides round
/// another of them. -1: refused.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn filter_load(
    points: *const [f64; 4],
    count: usize,
    loops: *const [f64; 3],
    bands: usize,
) -> i32 {
    // SAFETY: the host's word.
    let (points, loops) =
        unsafe { (core::slice::from_raw_parts(points, count), core::slice::from_raw_parts(loops, bands)) };
    let mut path = [Breakpoint { time_s: 0.0, b0: 0.0, b1: 0.0, a1: 0.0 }; 16];
    for (point, &[time_s, b0, b1, a1]) in path.iter_mut().zip(points) {
        *point = Breakpoint { time_s, b0, b1, a1 };
    }
    let mut all = [Band { frequency_hz: 0.0, bandwidth_hz: 0.0, gain: 0.0 }; 10];
    for (band, &[frequency_hz, bandwidth_hz, gain]) in all.iter_mut().zip(loops) {
        *band = Band { frequency_hz, bandwidth_hz, gain };
    }
    let rate = SampleRate::HZ_48000;
    let (Some(path), Some(all)) = (path.get(..count), all.get(..bands)) else { return -1 };
    let (Ok(of_path), Some(last)) = (Path::new(path, rate), path.last()) else { return -1 };
    let Ok(guides) = Waveguides::new(DynamicFilter::new(of_path, 9, 9), path, last, all, rate) else { return -1 };
    // SAFETY: as for `Sync`.
    unsafe {
        *FILTER.0.get() = Some(DynamicFilter::new(of_path, 9, 9));
        *GUIDES.0.get() = Some(guides);
    }
    0
}

/// Strikes the filter (0) or the waveguides (1) at full strength.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn filter_strike(which: u32) {
    // SAFETY: as for `Sync`.
    let (filter, guides) = unsafe { (&mut *FILTER.0.get(), &mut *GUIDES.0.get()) };
    match (which, filter, guides) {
        (0, Some(filter), _) => filter.strike(1.0),
        (1, _, Some(guides)) => guides.strike(1.0),
        _ => (),
    }
}

/// Adds a block of the filter (0) or the waveguides (1) to `out`.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn filter_render(which: u32, out: *mut i32, frames: usize) {
    // SAFETY: the host's word.
    let out = unsafe { core::slice::from_raw_parts_mut(out, frames) };
    // SAFETY: as for `Sync`.
    let (filter, guides) = unsafe { (&mut *FILTER.0.get(), &mut *GUIDES.0.get()) };
    match (which, filter, guides) {
        (0, Some(filter), _) => filter.render(None, out),
        (1, _, Some(guides)) => guides.render(out),
        _ => (),
    }
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
