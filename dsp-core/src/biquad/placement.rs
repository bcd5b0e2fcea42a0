//! Places of a bank's pairs while it is loaded.

use super::pair::Pair;

/// Slice of pairs that fills from both ends.
///
/// Mirrored pairs gather at the far end and run last, so that signs change only once.
pub(super) struct Placement<'a> {
    pairs: &'a mut [Pair],
    plain: usize,
    mirrored: usize,
}

impl<'a> Placement<'a> {
    /// Begins with no pair placed.
    pub(super) fn new(pairs: &'a mut [Pair]) -> Self {
        Self { pairs, plain: 0, mirrored: 0 }
    }

    /// Number of pairs that fit.
    pub(super) fn room(&self) -> usize {
        self.pairs.len()
    }

    /// Places a unit: beside a lone section of the same arithmetic if there is one, else in pairs
    /// of its own. Returns `None` if they do not fit.
    pub(super) fn place(&mut self, head: Pair, tail: Option<Pair>) -> Option<()> {
        let room = self.pairs.len();
        let (plain, mirrored) = (self.plain, self.mirrored);
        let used = |index: usize| index < plain || index >= room - mirrored;
        let mut open = self.pairs.iter_mut().enumerate().filter(|(index, _)| used(*index));
        if let Some((_, pair)) = open.find(|(_, pair)| pair.takes(&head)) {
            pair.join(&head);
            return Some(());
        }
        let needed = 1 + usize::from(tail.is_some());
        if plain + mirrored + needed > room {
            return None;
        }
        let at = if head.is_mirrored() { room - mirrored - needed } else { plain };
        *if head.is_mirrored() { &mut self.mirrored } else { &mut self.plain } += needed;
        for (slot, pair) in self.pairs.iter_mut().skip(at).zip([Some(head), tail].into_iter().flatten()) {
            *slot = pair;
        }
        Some(())
    }

    /// Closes the gap between plain and mirrored pairs, and returns the number of pairs placed.
    pub(super) fn finish(self) -> usize {
        let gap = self.pairs.len() - self.plain - self.mirrored;
        if let Some(behind) = self.pairs.get_mut(self.plain..) {
            behind.rotate_left(gap);
        }
        self.plain + self.mirrored
    }
}
