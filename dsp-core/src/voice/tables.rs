//! From a kit's tables to those of a pad's banks.

use crate::resonator::BankTable;
use crate::table::{Kit, Object, Pad as PadTable, Striker};

/// The tables behind a pad: for the load, and for what is derived anew while it plays.
#[derive(Clone, Copy, Debug)]
pub struct PadTables<'a> {
    kit: Kit<'a>,
    pad: PadTable<'a>,
    object: Object<'a>,
    is_balanced: bool,
}

/// Where a bank's order, which a typical contact decides, is settled already.
pub(super) const NO_CONTACT: (f32, f32) = (0.0, 0.0);

impl<'a> PadTables<'a> {
    /// The tables of a kit's pad, counted from 0. `None` where the kit has no such pad.
    pub fn new(kit: Kit<'a>, pad: usize) -> Option<Self> {
        let pad = kit.pads().nth(pad)?;
        Some(Self { kit, pad, object: kit.object_of(pad)?, is_balanced: kit.is_balanced(pad.object_index()) })
    }

    /// True if the banks of object and strikers are balanced, and the object's α is not a number.
    pub fn is_balanced(&self) -> bool {
        self.is_balanced
    }

    /// The pad's object.
    pub fn object(&self) -> Object<'a> {
        self.object
    }

    /// The pad's record.
    pub fn pad(&self) -> PadTable<'a> {
        self.pad
    }

    pub(super) fn strikers(&self) -> impl Iterator<Item = Striker<'a>> + use<'a> {
        self.kit.strikers_of(self.pad)
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
