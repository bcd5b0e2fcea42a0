//! From a kit's tables to those of a pad's banks.

use crate::resonator::BankTable;
use crate::table::{Kit, Object, Pad as PadTable, Striker};

/// The tables behind a pad, for what is derived anew while it plays.
#[derive(Clone, Copy, Debug)]
pub struct PadTables<'a> {
    kit: Kit<'a>,
    pad: PadTable<'a>,
    object: Object<'a>,
}

impl<'a> PadTables<'a> {
    /// The tables of a pad of a kit. `None` only for a pad of another kit.
    pub fn new(kit: Kit<'a>, pad: PadTable<'a>) -> Option<Self> {
        Some(Self { kit, pad, object: kit.object_of(pad)? })
    }

    /// The pad's object.
    pub fn object(&self) -> Object<'a> {
        self.object
    }

    /// The pad's record.
    pub fn pad(&self) -> PadTable<'a> {
        self.pad
    }

    pub(super) fn object_table(&self) -> BankTable<'a> {
        object_table(&self.object, self.pad, (0.0, 0.0))
    }

    pub(super) fn striker_table(&self, index: usize) -> Option<BankTable<'a>> {
        let striker = self.kit.strikers_of(self.pad).nth(index)?;
        Some(striker_table(&striker, self.pad, self.object.reference_force(), (0.0, 0.0)))
    }
}

pub(super) fn object_table<'a>(object: &Object<'a>, pad: PadTable<'_>, typical_contact: (f32, f32)) -> BankTable<'a> {
    BankTable {
        modes: object.modes(),
        gains: object.gains(),
        positions: object.position_count(),
        weight: f64::from(object.reference_force()),
        choke_t60_s: f64::from(pad.choke_t60_s()),
        typical_contact,
    }
}

pub(super) fn striker_table<'a>(
    striker: &Striker<'a>,
    pad: PadTable<'_>,
    reference_force: f32,
    typical_contact: (f32, f32),
) -> BankTable<'a> {
    // A pad with η = 0 has no use for its strikers' banks: nothing is built.
    let used = pad.striker_weight() != 0.0;
    BankTable {
        modes: if used { striker.modes() } else { &[] },
        gains: if used { striker.gains() } else { &[] },
        positions: 1,
        weight: f64::from(pad.striker_weight()) * f64::from(reference_force),
        choke_t60_s: f64::from(pad.choke_t60_s()),
        typical_contact,
    }
}
