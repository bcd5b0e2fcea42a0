//! A set of pads.

/// Pads that have something which most have not: asked for several times a tick, without a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PadSet(u64);

impl PadSet {
    pub(super) const NONE: Self = Self(0);

    /// Pads from 63 on are one.
    #[inline(always)]
    fn bit(pad: u8) -> u64 {
        1 << pad.min(63)
    }

    pub(super) fn insert(&mut self, pad: u8) {
        self.0 |= Self::bit(pad);
    }

    #[inline(always)]
    pub(super) fn may_have(self, pad: u8) -> bool {
        self.0 & Self::bit(pad) != 0
    }

    #[inline(always)]
    pub(super) fn is_empty(self) -> bool {
        self.0 == 0
    }
}
