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

/// Mark, length, its complement by which bits at random are told apart, and the text.
///
/// Words of memory, which are copied one by one: a volatile copy of bytes takes 2.8 KB of code.
type Kept = [u32; 3 + BYTES / 4];

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
    let text = written.text.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes));
    let place = PLACE.0.get().cast::<u32>();
    for (index, word) in [MARK, length, !length].into_iter().chain(text).enumerate() {
        // SAFETY: the place has a word for each number and each four bytes of the text. Interrupts
        // are disabled, and nothing else uses it but `take` at the start.
        unsafe { place.add(index).write_volatile(word) };
    }
}

/// Passes the words of the last run to `tell`, if it left any, and forgets them.
pub fn take(tell: impl FnOnce(&str)) {
    let place = PLACE.0.get().cast::<u32>();
    let mut kept: Kept = [0; 3 + BYTES / 4];
    for (index, word) in kept.iter_mut().enumerate() {
        // SAFETY: all bits are a valid word, and only `keep` uses the place at other times. The
        // read is volatile since a run before this one wrote the bits.
        *word = unsafe { place.add(index).read_volatile() };
    }
    let [mark, length, check, text @ ..] = kept;
    if mark == MARK && check == !length {
        // SAFETY: as above.
        unsafe { place.write_volatile(0) };
        let text = text.map(u32::to_le_bytes);
        let text = text.as_flattened().get(..length as usize).unwrap_or(&[]);
        // Words may be cut within a letter.
        tell(core::str::from_utf8(text).unwrap_or("(no text)"));
    }
}
