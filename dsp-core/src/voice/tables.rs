//! Tables of a pad's banks, from those of a kit.

use crate::contact::law::full_contact_s;
use crate::resonator::BankTable;
use crate::table::{Kit, Object, Pad as PadTable, Striker};

/// Tables of a pad: for the load, and for gains that are derived anew while it plays.
#[derive(Clone, Copy, Debug)]
pub struct PadTables<'a> {
    kit: Kit<'a>,
    pad: PadTable<'a>,
    object: Object<'a>,
    is_balanced: bool,
}

/// Typical contact for tables of a loaded bank, whose modes are in order already.
pub(super) const NO_CONTACT: (f32, f32) = (0.0, 0.0);

impl<'a> PadTables<'a> {
    /// Tables of a kit's pad, counted from 0; `None` if the kit has no such pad.
    pub fn new(kit: Kit<'a>, pad: usize) -> Option<Self> {
        let pad = kit.pads().nth(pad)?;
        Some(Self { kit, pad, object: kit.object_of(pad)?, is_balanced: kit.is_balanced(pad.object_index()) })
    }

    /// True if the banks of the object and its strikers hold a balance instead of a number `α`.
    pub fn is_balanced(&self) -> bool {
        self.is_balanced
    }

    /// Object of the pad.
    pub fn object(&self) -> Object<'a> {
        self.object
    }

    /// Record of the pad.
    pub fn pad(&self) -> PadTable<'a> {
        self.pad
    }

    /// True if the object's dynamic filter takes its modes, which then have to come sample by
    /// sample.
    pub(super) fn filter_takes_modes(&self) -> bool {
        let filter = self.kit.dynamic_filter_of(self.pad.object_index());
        filter.is_ok_and(|filter| filter.is_some_and(|filter| filter.takes_modes()))
    }

    /// True if a scraper changes its position on the object: it has several, and a surface.
    pub(super) fn is_scraped_along(&self) -> bool {
        let object = self.pad.object_index();
        let has_surface = || self.kit.object_surfaces().iter().any(|place| usize::from(place.object.get()) == object);
        self.object.position_count() > 1 && has_surface()
    }

    pub(super) fn strikers(&self) -> impl Iterator<Item = Striker<'a>> + use<'a> {
        self.kit.strikers_of(self.pad)
    }

    /// Length in seconds of the longest contact of the pad's strikers at velocity 1.
    pub(super) fn longest_contact_s(&self) -> f32 {
        self.strikers().map(|striker| full_contact_s(&striker.contact())).fold(0.0, f32::max)
    }

    pub(super) fn object_table(&self, typical_contact: (f32, f32)) -> BankTable<'a> {
        BankTable {
            modes: self.object.modes(),
            gains: self.object.gains(),
            positions: self.object.position_count(),
            weight: f64::from(self.object.reference_force()),
            choke_t60_s: f64::from(self.pad.choke_t60_s()),
            is_balanced: self.is_balanced,
            typical_contact,
        }
    }

    pub(super) fn striker_table(&self, index: usize, typical_contact: (f32, f32)) -> Option<BankTable<'a>> {
        let striker = self.strikers().nth(index)?;
        Some(BankTable {
            modes: striker.modes(),
            gains: striker.gains(),
            positions: 1,
            weight: f64::from(self.pad.striker_weight()) * f64::from(self.object.reference_force()),
            choke_t60_s: f64::from(self.pad.choke_t60_s()),
            is_balanced: self.is_balanced,
            typical_contact,
        })
    }
}
