//! The pads that a run must look at.

use crate::memory::{Memory, OutOfMemory, Region};

/// Set of pads that are awake: a bit for each pad.
///
/// A pad sleeps while nothing of it sounds and no force acts on it. Most pads of a kit sleep most
/// of the time, and none of them takes a cycle.
#[derive(Debug)]
pub(super) struct Awake<'m> {
    words: &'m mut [u32],
}

impl<'m> Awake<'m> {
    /// Takes memory for a number of pads, none of which is awake.
    pub(super) fn take(memory: &mut Memory<'m>, pads: usize) -> Result<Self, OutOfMemory> {
        Ok(Self { words: memory.take(Region::Fast, pads.div_ceil(32), || 0)? })
    }

    /// Wakes a pad; true if it slept.
    pub(super) fn wake(&mut self, pad: u8) -> bool {
        let Some(word) = self.words.get_mut(usize::from(pad / 32)) else { return false };
        let slept = *word & bit(pad) == 0;
        *word |= bit(pad);
        slept
    }

    /// Keeps those pads awake for which `stays_awake` is true, and lays the others to sleep.
    #[inline(always)]
    pub(super) fn retain(&mut self, mut stays_awake: impl FnMut(u8) -> bool) {
        for (word, first) in self.words.iter_mut().zip((0u8..).step_by(32)) {
            let mut left = *word;
            while left != 0 {
                let place = left.trailing_zeros() as u8;
                left &= left - 1;
                if !stays_awake(first + place) {
                    *word &= !bit(place);
                }
            }
        }
    }

    /// Pads that are awake, in order.
    #[inline(always)]
    pub(super) fn pads(&self) -> Pads<'_> {
        Pads { words: self.words, index: 0, left: self.words.first().copied().unwrap_or(0) }
    }
}

const fn bit(pad: u8) -> u32 {
    1 << (pad % 32)
}

/// Iterator over the pads that are awake.
pub(super) struct Pads<'a> {
    words: &'a [u32],
    /// Index of the word that is being read.
    index: u8,
    /// Bits of it that are left.
    left: u32,
}

impl Iterator for Pads<'_> {
    type Item = u8;

    #[inline(always)]
    fn next(&mut self) -> Option<u8> {
        while self.left == 0 {
            self.index += 1; // at most 8
            self.left = *self.words.get(usize::from(self.index))?;
        }
        let place = self.left.trailing_zeros() as u8;
        self.left &= self.left - 1;
        Some(self.index * 32 + place) // a word's pads are below 256
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pads_are_told_in_order_in_every_word() {
        let mut words = [0; 8];
        let mut awake = Awake { words: &mut words };
        for pad in [200, 255, 0, 31, 32, 64, 33] {
            assert!(awake.wake(pad));
            assert!(!awake.wake(pad));
        }
        awake.retain(|pad| pad != 32);
        assert!(awake.pads().eq([0, 31, 33, 64, 200, 255]));
        assert_eq!(Awake { words: &mut [] }.pads().next(), None);
    }
}
