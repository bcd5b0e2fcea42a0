//! Banks of biquads on a bare Cortex-M4F, without a board.
//!
//! Nothing starts by itself: the virtual core writes numbers into memory and calls the exported
//! functions. They return 0, or a negative number that gives the reason for a failure. The code on
//! the host is `host-tests/src/on_chip/biquads.rs`.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;
use core::panic::PanicInfo;

use dsp_core::biquad::{Bank, Biquad, BiquadError, Root};
use dsp_core::memory::{Memory, Word};
use float_forms::biquads::FloatBank;

struct Global<T>(UnsafeCell<T>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl<T> Sync for Global<T> {}

static BANK: Global<Bank<'static>> = Global(UnsafeCell::new(Bank::empty()));
/// Memory of 64 pairs.
static WORDS: Global<[Word; 2_200]> = Global(UnsafeCell::new([Word::uninit(); 2_200]));

fn biquad(&[real, imaginary, b0, b1, b2]: &[f64; 5]) -> Result<Biquad, BiquadError> {
    Ok(Biquad { pole: Root { real, imaginary }, numerator: [b0, b1, b2] })
}

/// Loads `count` biquads of five numbers each (pole, numerator) in chains of `depth`. -1: refused.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn biquads_load(numbers: *const [f64; 5], count: usize, depth: usize) -> i32 {
    // SAFETY: the host has written `count` biquads there.
    let numbers = unsafe { core::slice::from_raw_parts(numbers, count) };
    // SAFETY: see `Sync` for `Global`; the bank that had the words before is replaced.
    let (bank, words) = unsafe { (&mut *BANK.0.get(), &mut *WORDS.0.get()) };
    let Ok(taken) = Bank::take(&mut Memory::new(&mut [], words), 64) else { return -1 };
    *bank = taken;
    if bank.load_each(numbers.iter().map(biquad), depth, 1.0).is_ok() { 0 } else { -1 }
}

/// Adds the sound of a block to `out`. `input` may be null.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn biquads_render(input: *const i32, out: *mut i32, frames: usize) {
    // SAFETY: the host leaves `frames` samples at each address that is not null.
    let (input, out) = unsafe {
        let input = (!input.is_null()).then(|| core::slice::from_raw_parts(input, frames));
        (input, core::slice::from_raw_parts_mut(out, frames))
    };
    // SAFETY: see `Sync` for `Global`.
    unsafe { &mut *BANK.0.get() }.render(input, out);
}

static FLOATS: Global<FloatBank<20>> = Global(UnsafeCell::new(FloatBank::EMPTY));

/// Loads biquads as `biquads_load` does, into a bank in single precision. -1: refused.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn float_biquads_load(numbers: *const [f64; 5], count: usize, depth: usize) -> i32 {
    // SAFETY: the host has written `count` biquads there.
    let numbers = unsafe { core::slice::from_raw_parts(numbers, count) };
    let mut biquads = [Biquad { pole: Root { real: 0.0, imaginary: 0.0 }, numerator: [0.0; 3] }; 64];
    for (slot, &[real, imaginary, b0, b1, b2]) in biquads.iter_mut().zip(numbers) {
        *slot = Biquad { pole: Root { real, imaginary }, numerator: [b0, b1, b2] };
    }
    // SAFETY: see `Sync` for `Global`.
    let bank = unsafe { &mut *FLOATS.0.get() };
    match biquads.get(..count).map(|biquads| bank.load(biquads, depth)) {
        Some(Ok(())) => 0,
        _ => -1,
    }
}

/// Adds a block as `biquads_render` does, from the bank in single precision.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn float_biquads_render(input: *const f32, out: *mut f32, frames: usize) {
    // SAFETY: the host leaves `frames` samples at each address that is not null.
    let (input, out) = unsafe {
        let input = (!input.is_null()).then(|| core::slice::from_raw_parts(input, frames));
        (input, core::slice::from_raw_parts_mut(out, frames))
    };
    // SAFETY: see `Sync` for `Global`.
    unsafe { &mut *FLOATS.0.get() }.render(input, out);
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
