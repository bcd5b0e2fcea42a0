//! A bank's memory, and its derivation from biquads.

use super::bank::Bank;
use super::design::{Biquad, BiquadError};
use super::fractions::parts;
use super::gain::Gain;
use super::pair::Pair;
use super::placement::Placement;
use super::pole::Pole;
use crate::memory::{Memory, OutOfMemory, Region};

impl<'m> Bank<'m> {
    /// Takes memory for `sections` pairs, which suffice for that number of sections.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(memory: &mut Memory<'m>, sections: usize) -> Result<Self, OutOfMemory> {
        Ok(Self { pairs: memory.take(Region::Bulk, sections, || Pair::EMPTY)?, ..Self::empty() })
    }

    /// Loads chains of `depth` sections in a row, and leaves the bank at rest.
    ///
    /// After an error the bank is empty.
    ///
    /// # Errors
    /// [`BiquadError`].
    pub fn load(&mut self, biquads: &[Biquad], depth: usize) -> Result<(), BiquadError> {
        self.load_each(biquads.iter().map(|&biquad| Ok(biquad)), depth, 1.0)
    }

    /// Loads chains of `depth` sections from biquads that come one at a time, each with its own
    /// error.
    ///
    /// `hand` is the factor by which a hand lowers the amplitude in each frame
    /// ([`set_choked`](Self::set_choked)): above 0, and 1 without a hand.
    ///
    /// # Errors
    /// [`BiquadError`], and the errors of the biquads.
    pub fn load_each<E: From<BiquadError>>(
        &mut self,
        biquads: impl IntoIterator<Item = Result<Biquad, E>>,
        depth: usize,
        hand: f64,
    ) -> Result<(), E> {
        self.clear();
        let result = self.place_all(biquads, depth, hand);
        if result.is_err() {
            self.clear();
        }
        result
    }

    /// Removes all chains and keeps the memory.
    pub fn unload(&mut self) {
        self.clear();
    }

    /// Clears field by field, because a bank is too large for a small stack.
    fn clear(&mut self) {
        self.pairs.fill(Pair::EMPTY);
        (self.count, self.sections, self.depth) = (0, 0, 1);
        (self.direct, self.direct_size) = (Gain::ZERO, 0.0);
        (self.recent, self.recent_ticks, self.room) = (0, 0, 0);
        self.choked = false;
        self.rest();
    }

    fn place_all<E: From<BiquadError>>(
        &mut self,
        biquads: impl IntoIterator<Item = Result<Biquad, E>>,
        depth: usize,
        hand: f64,
    ) -> Result<(), E> {
        let mut direct = 0.0;
        let mut sections = 0;
        let mut placement = Placement::new(&mut *self.pairs);
        let mut biquads = biquads.into_iter();
        if !(1..=4).contains(&depth) {
            return Err(BiquadError::Depth { depth, sections: biquads.count() }.into());
        }
        while let Some(first) = biquads.next() {
            let mut chain = [first?; 4];
            let mut length = 1;
            for slot in chain.iter_mut().take(depth).skip(1) {
                let Some(next) = biquads.next() else { break };
                (*slot, length) = (next?, length + 1);
            }
            sections += length;
            if length != depth {
                return Err(BiquadError::Depth { depth, sections }.into());
            }
            let chain = chain.get(..depth).unwrap_or(&[]);
            let start = sections - depth;
            for (index, biquad) in chain.iter().enumerate() {
                biquad.check(start + index)?;
            }
            direct += chain.iter().map(|biquad| biquad.numerator[0]).product::<f64>();
            // The slowest pole then decays as the hand wants. The hand changes no chain that decays
            // faster.
            let slowest = chain.iter().map(|biquad| biquad.pole.square()).fold(0.0, f64::max);
            let slowest = libm::sqrt(slowest);
            let kept = if hand < slowest { hand / slowest } else { 1.0 };
            let all = parts::<Pole>(chain);
            for cluster in all.get(..depth).unwrap_or(&[]).chunk_by(|_, next| next.handed != 0.0) {
                let (head, tail) = Pair::of(cluster, kept, start)?;
                let full = BiquadError::Full { sections, room: placement.room() };
                placement.place(head, tail).ok_or(full)?;
            }
        }
        (self.count, self.sections, self.depth) = (placement.finish(), sections, depth);
        (self.direct, self.direct_size) = (Gain::new(direct), direct.abs() as f32);
        Ok(())
    }
}
