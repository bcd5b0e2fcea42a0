//! Memory that the caller lends: words, cut into the typed slices that the stages keep.
//!
//! Nothing here allocates. A chip lends statics, a PC lends vectors:
//!
//! ```text
//! Plan::of(kit, rate, limits)        counts words with a Memory that only counts
//! Engine::new(kit, plan, memory)     takes the same slices in the same order from one with words
//! ```
//!
//! Both go through [`Memory::take`], so that a plan's words are those that the engine then takes.
//! Slices lie in one of two memories ([`Region`]): a chip has a fast one beside the core and a
//! large one, a PC has one of both.

use core::fmt;
use core::mem::MaybeUninit;

use zerocopy::FromZeros;

/// Unit of lent memory: 8 bytes.
pub type Word = MaybeUninit<u64>;

/// Bytes of a [`Word`].
pub const WORD_BYTES: usize = size_of::<Word>();

/// Memory in which a slice lies if there is room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// The fast memory: modes, contacts and what each tick asks for.
    Fast,
    /// The large memory: waves and delay lines.
    Bulk,
}

/// Number of words in each memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Words {
    /// Words of the fast memory.
    pub fast: usize,
    /// Words of the large memory.
    pub bulk: usize,
}

impl Words {
    /// Largest possible number of words.
    pub const MAX: Self = Self { fast: usize::MAX / WORD_BYTES, bulk: usize::MAX / WORD_BYTES };

    /// Bytes of both memories together.
    pub const fn bytes(self) -> usize {
        (self.fast + self.bulk) * WORD_BYTES
    }

    fn of(&mut self, region: Region) -> &mut usize {
        match region {
            Region::Fast => &mut self.fast,
            Region::Bulk => &mut self.bulk,
        }
    }
}

/// A slice that neither memory has room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OutOfMemory {
    /// Words of the slice.
    pub needed: usize,
    /// Words that are left in the memory with more of them.
    pub left: usize,
}

impl OutOfMemory {
    /// Number of words that are missing.
    pub const fn missing(self) -> usize {
        self.needed.saturating_sub(self.left)
    }
}

impl fmt::Display for OutOfMemory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} more words of memory are needed, {WORD_BYTES} bytes each", self.missing())
    }
}

impl core::error::Error for OutOfMemory {}

/// Number of words of a slice, wherever it begins.
///
/// If the product overflows it is `usize::MAX`, so that every memory refuses.
fn words_of<T>(count: usize) -> usize {
    let to_align = align_of::<T>().saturating_sub(align_of::<Word>());
    let bytes = count.checked_mul(size_of::<T>()).and_then(|bytes| bytes.checked_add(to_align));
    bytes.map_or(usize::MAX, |bytes| bytes.div_ceil(WORD_BYTES))
}

/// Words that a caller lends for the life of an engine, or a count of words without any.
#[derive(Debug)]
pub struct Memory<'m> {
    fast: &'m mut [Word],
    bulk: &'m mut [Word],
    left: Words,
    used: Words,
    /// True if there are no words: slices are counted, and empty.
    only_counts: bool,
}

impl<'m> Memory<'m> {
    /// Makes a memory of words that may hold anything. Either slice may be empty.
    pub fn new(fast: &'m mut [Word], bulk: &'m mut [Word]) -> Self {
        let left = Words { fast: fast.len(), bulk: bulk.len() };
        Self { fast, bulk, left, used: Words::default(), only_counts: false }
    }

    /// Makes a count of words up to a limit. It gives empty slices, and takes as many words for
    /// each as a memory does.
    pub const fn count(limit: Words) -> Self {
        Self { fast: &mut [], bulk: &mut [], left: limit, used: Words { fast: 0, bulk: 0 }, only_counts: true }
    }

    /// Count of the words that are left, to try if slices fit before they are taken.
    pub const fn rest(&self) -> Self {
        Self::count(self.left)
    }

    /// Number of words that have been taken.
    pub const fn used(&self) -> Words {
        self.used
    }

    /// Takes a slice of `count` items, each made by `make`, from the memory of `region`. The other
    /// memory serves if that one is full.
    ///
    /// # Errors
    /// [`OutOfMemory`]; nothing is taken then.
    #[allow(unsafe_code)]
    #[inline(always)] // so that large items are made in their place
    pub fn take<T>(&mut self, region: Region, count: usize, make: impl Fn() -> T) -> Result<&'m mut [T], OutOfMemory> {
        let items = self.take_places(region, count)?;
        for item in &mut *items {
            item.write(make());
        }
        // SAFETY: all items have just been set.
        Ok(unsafe { items.assume_init_mut() })
    }

    /// Takes a slice of `count` items of zeros, as [`take`](Self::take) does.
    ///
    /// An item never lies on the stack, which has no room for one of many kilobytes.
    ///
    /// # Errors
    /// [`OutOfMemory`]; nothing is taken then.
    #[allow(unsafe_code)]
    pub fn take_zeros<T: FromZeros>(&mut self, region: Region, count: usize) -> Result<&'m mut [T], OutOfMemory> {
        let items = self.take_places(region, count)?;
        // SAFETY: the slice is that long, and zeros are a valid T.
        Ok(unsafe {
            items.as_mut_ptr().write_bytes(0, items.len());
            items.assume_init_mut()
        })
    }

    /// Takes places for `count` items from the memory of `region`.
    fn take_places<T>(&mut self, region: Region, count: usize) -> Result<&'m mut [MaybeUninit<T>], OutOfMemory> {
        Ok(places(self.take_words(region, words_of::<T>(count))?, count))
    }

    /// Takes words; none from a memory that only counts.
    #[inline(never)] // one for items of all types
    fn take_words(&mut self, region: Region, words: usize) -> Result<&'m mut [Word], OutOfMemory> {
        let region = self.book(region, words)?;
        if self.only_counts {
            return Ok(&mut []);
        }
        let memory = if region == Region::Fast { &mut self.fast } else { &mut self.bulk };
        // No more has been booked than there is.
        Ok(memory.split_off_mut(..words).unwrap_or(&mut []))
    }

    /// Books words, and returns the memory that has them.
    fn book(&mut self, region: Region, words: usize) -> Result<Region, OutOfMemory> {
        let other = if region == Region::Fast { Region::Bulk } else { Region::Fast };
        let fits = |region: &Region| *self.left.clone().of(*region) >= words;
        let Some(region) = [region, other].into_iter().find(fits) else {
            return Err(OutOfMemory { needed: words, left: self.left.fast.max(self.left.bulk) });
        };
        *self.left.of(region) -= words;
        *self.used.of(region) += words;
        Ok(region)
    }
}

/// The words as places for `count` items, which they have room for.
#[allow(unsafe_code)]
fn places<T>(words: &mut [Word], count: usize) -> &mut [MaybeUninit<T>] {
    // Most items are aligned where words are.
    let is_aligned = align_of::<T>() <= align_of::<Word>();
    let start = if is_aligned { 0 } else { words.as_ptr().align_offset(align_of::<T>()) };
    let Some(words) = words.get_mut(start..).filter(|words| size_of_val(*words) >= count * size_of::<T>()) else {
        return &mut [];
    };
    // SAFETY: the words begin at an address that is aligned for T and are as long as `count` items,
    // by the check above; they are borrowed for 'm by nobody else, and a place may hold anything.
    unsafe { core::slice::from_raw_parts_mut(words.as_mut_ptr().cast::<MaybeUninit<T>>(), count) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn count_and_memory_take_the_same_words() {
        let mut words = [Word::uninit(); 40];
        let (fast, bulk) = words.split_at_mut(10);
        let mut account = Memory::count(Words { fast: 10, bulk: 30 });
        let mut memory = Memory::new(fast, bulk);
        // Fits the fast memory; is too large for it; fills it; finds nothing.
        for (count, fits) in [(9, true), (20, true), (11, true), (200, false), (3, true)] {
            let counted: Result<&mut [u32], _> = account.take(Region::Fast, count, || 7);
            let taken: Result<&mut [u32], _> = memory.take(Region::Fast, count, || 7);
            assert_eq!(counted.is_ok(), fits);
            match taken {
                Ok(items) => assert!(fits && items == std::vec![7; count]),
                Err(error) => assert!(!fits && counted.unwrap_err() == error),
            }
        }
        assert_eq!(account.used(), memory.used());
        assert_eq!(memory.used(), Words { fast: 5 + 2, bulk: 10 + 6 });
    }

    #[test]
    fn missing_words_are_told() {
        let mut account = Memory::count(Words { fast: 3, bulk: 1 });
        let error = account.take::<u64>(Region::Bulk, 5, || 0).unwrap_err();
        assert_eq!((error.missing(), account.used()), (2, Words::default()));
    }
}
