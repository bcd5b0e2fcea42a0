//! Words of a panic or a fault, which outlive the restart.
//!
//! A log that nobody read is lost at a reset. These words lie in memory that no start clears, and
//! are told at the next one.

use core::cell::UnsafeCell;
use core::fmt::{self, Write};
use core::mem::MaybeUninit;

/// Most bytes of words that are kept.
const BYTES: usize = 240;
/// Mark of kept words. Memory holds other bits after power-on.
const MARK: u32 = 0x4C61_7374;

#[derive(Clone, Copy)]
#[repr(C)]
struct Kept {
    mark: u32,
    length: u32,
    /// Complement of the length, by which bits at random are told apart.
    check: u32,
    text: [u8; BYTES],
}

struct Place(UnsafeCell<MaybeUninit<Kept>>);

// SAFETY: `keep` runs with interrupts disabled before a restart, `take` once at the start.
unsafe impl Sync for Place {}

#[unsafe(link_section = ".uninit.last_words")]
static PLACE: Place = Place(UnsafeCell::new(MaybeUninit::uninit()));

/// Buffer that takes words up to its end, and drops the rest.
struct Words {
    text: [u8; BYTES],
    length: usize,
}

impl Write for Words {
    fn write_str(&mut self, words: &str) -> fmt::Result {
        for (place, &byte) in self.text.iter_mut().skip(self.length).zip(words.as_bytes()) {
            *place = byte;
            self.length += 1;
        }
        Ok(())
    }
}

/// Keeps words for the next start, as many as there is room for.
pub fn keep(words: fmt::Arguments<'_>) {
    let mut written = Words { text: [0; BYTES], length: 0 };
    // Words that cannot be formatted are cut.
    let _ = written.write_fmt(words);
    let length = written.length as u32;
    let kept = Kept { mark: MARK, length, check: !length, text: written.text };
    // SAFETY: interrupts are disabled, and nothing else uses the place but `take` at the start.
    unsafe { PLACE.0.get().cast::<Kept>().write_volatile(kept) };
}

/// Passes the words of the last run to `tell`, if it left any, and forgets them.
pub fn take(tell: impl FnOnce(&str)) {
    let place = PLACE.0.get().cast::<Kept>();
    // SAFETY: all bits are a valid `Kept`, and only `keep` uses the place at other times. The read
    // is volatile since a run before this one wrote the bits.
    let kept = unsafe { place.read_volatile() };
    if kept.mark == MARK && kept.check == !kept.length {
        // SAFETY: as above.
        unsafe { place.cast::<u32>().write_volatile(0) };
        let text = kept.text.get(..kept.length as usize).unwrap_or(&[]);
        // Words may be cut within a letter.
        tell(core::str::from_utf8(text).unwrap_or("(no text)"));
    }
}
