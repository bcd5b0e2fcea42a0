//! Slots: which sector holds the kit of which slot.

use cable::Refusal;

use super::flash::{Flash, FlashError};
use super::settings;
use crate::board::sector::Sector;
use crate::board::{KIT_SECTORS, SLOTS};

/// True if an upload goes to a sector of its own, and not over the kit of its slot.
const HAS_SPARE: bool = KIT_SECTORS.len() > SLOTS as usize;
const _: () = {
    let mut sector = 0;
    while sector < KIT_SECTORS.len() {
        assert!(KIT_SECTORS[sector].bytes as usize == boards::SLOT_BYTES);
        sector += 1;
    }
};
const _: () = assert!(KIT_SECTORS.len() <= SLOTS as usize + 1, "at most one sector belongs to no slot");

/// Sectors of all slots.
pub struct Slots {
    /// Place in [`KIT_SECTORS`] of each slot's kit, and behind them that of the sector that belongs
    /// to no slot.
    places: [usize; KIT_SECTORS.len()],
}

impl Slots {
    /// Reads the places of the slots. Slots whose kit has never moved have the sectors of their
    /// numbers.
    pub(super) fn read(flash: &mut Flash) -> Self {
        let mut places = core::array::from_fn(|place| place);
        for slot in (0..SLOTS).filter(|_| HAS_SPARE) {
            if let Some(place) = settings::place_of(flash, slot) {
                swap(&mut places, slot, place as usize);
            }
        }
        Self { places }
    }

    /// Sector of a slot's kit; `None` if there is no such slot.
    pub fn sector(&self, slot: u8) -> Option<Sector> {
        let place = self.places.get(usize::from(slot)).filter(|_| slot < SLOTS)?;
        KIT_SECTORS.get(*place).copied()
    }

    /// Sector that an upload to a slot writes; `None` if there is no such slot.
    pub(super) fn upload_sector(&self, slot: u8) -> Option<Sector> {
        let own = self.sector(slot)?;
        let spare = self.places.get(usize::from(SLOTS)).and_then(|&place| KIT_SECTORS.get(place));
        Some(spare.copied().unwrap_or(own))
    }

    /// Makes the sector of an upload that of its slot, for all starts.
    ///
    /// # Errors
    /// [`Refusal::Flash`] if the flash fails. The slot then keeps its sector.
    pub(super) fn commit(&mut self, flash: &mut Flash, slot: u8) -> Result<(), Refusal> {
        if let (true, Some(&spare)) = (HAS_SPARE, self.places.get(usize::from(SLOTS))) {
            settings::set_place(flash, slot, spare as u32)?;
            swap(&mut self.places, slot, spare);
        }
        Ok(())
    }
}

/// Gives a slot a place; the slot that had it gets the other one.
fn swap(places: &mut [usize], slot: u8, place: usize) {
    if let Some(other) = places.iter().position(|&taken| taken == place) {
        places.swap(usize::from(slot), other);
    }
}

/// Returns the refusal of an operation that failed in a sector.
pub(super) fn refusal(error: FlashError, sector: Sector) -> Refusal {
    Refusal::Flash { offset: error.address.wrapping_sub(sector.address) }
}
