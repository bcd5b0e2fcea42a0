//! The noise of a voice or of the background, with the time that it takes.

use crate::memory::{Lender, OutOfMemory, Region};
use crate::residual::Shaper;

/// A residual, or the background.
#[derive(Debug)]
pub struct Residual<'m> {
    /// Worst cycles of a tick in which it sounds.
    pub(crate) cycles: u32,
    pub(crate) shaper: Shaper<'m>,
}

impl<'m> Residual<'m> {
    const fn none() -> Self {
        Self { cycles: 0, shaper: Shaper::none() }
    }

    /// Takes the memory of noise in `bands` bands; `None` from an account.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn place(lender: &mut impl Lender<'m>, bands: usize) -> Result<Option<&'m mut Self>, OutOfMemory> {
        let shaper = Shaper::take(lender, bands)?;
        let place = lender.take(Region::Bulk, 1, Self::none)?.first_mut();
        let Some(place) = place else { return Ok(None) };
        place.shaper = shaper;
        Ok(Some(place))
    }

    /// Sets the worst cycles of a tick in which it sounds.
    pub(crate) fn with_cycles(&mut self, cycles: u32) -> &mut Self {
        self.cycles = cycles;
        self
    }
}
