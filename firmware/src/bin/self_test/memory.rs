//! Check of the RAM that is not in use yet, which is written and read back.

use core::ptr::{read_volatile, write_volatile};

use firmware::watchdog;

use crate::failures::Failures;

const PATTERNS: [u32; 4] = [0x5555_5555, 0xAAAA_AAAA, 0x0F1E_2D3C, 0];
/// Bytes below the stack pointer that are left to the check itself.
const STACK_MARGIN: usize = 2048;

unsafe extern "C" {
    static _stack_end: u32;
    static _hot_start: u32;
    static _hot_end: u32;
    static _stages_start: u32;
    static _stages_end: u32;
}

/// Checks the memory between the statics and the stack, and that of the instrument and its stages.
///
/// The instrument must not have been placed yet.
pub(crate) fn check(failures: &mut Failures) {
    let here = 0u32;
    let stack = (&raw const here) as usize - STACK_MARGIN;
    for (name, start, end) in [
        ("stack", (&raw const _stack_end) as usize, stack),
        ("hot", (&raw const _hot_start) as usize, (&raw const _hot_end) as usize),
        ("stages", (&raw const _stages_start) as usize, (&raw const _stages_end) as usize),
    ] {
        let words = (end.saturating_sub(start)) / 4;
        let wrong = (0..words).filter(|word| !holds(start + 4 * word, *word as u32)).count();
        watchdog::feed();
        let verdict = failures.check(wrong == 0);
        defmt::info!(
            "RAM, {=str}, {=usize} bytes at {=usize:#010x}: {=usize} wrong: {=str}",
            name,
            4 * words,
            start,
            wrong,
            verdict
        );
    }
}

/// Returns true if a word keeps each pattern, mixed with the number of the word.
fn holds(address: usize, number: u32) -> bool {
    let word = address as *mut u32;
    PATTERNS.iter().all(|pattern| {
        let value = pattern ^ number;
        // SAFETY: nothing uses the memory between the statics and the stack, nor that of the
        // instrument and its stages before they are placed.
        unsafe {
            write_volatile(word, value);
            read_volatile(word) == value
        }
    })
}
