//! The cycle model: what each instruction costs, and why.
//!
//! Three numbers, never one, because the model has not been compared with silicon: the *best* and the *worst* that Arm's tables
//! permit, and a *nominal* one between them. The rules are those of Arm's Cortex-M4 timing tables, TI's SWCU185G and GCC's
//! `cortex-m4-fpu` description: costs by kind in [`rules`], what an instruction pays for following another in [`hazard`],
//! and the wait states of flash, as two further columns, in [`flash`].
//!
//! Not modelled: contention on the bus (DMA, two masters in one RAM), the write buffer, alignment of 32-bit instructions in the
//! prefetch queue, unaligned data, speculative fetches past a branch, and what [`flash`] lists.

pub mod flash;
pub mod hazard;
pub mod rules;

use std::ops::{Add, AddAssign, Sub};

use flash::{REFILL_CYCLES_96_MHZ, REFILL_CYCLES_168_MHZ};

/// The three-way cost of one instruction, in cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Band {
    /// The least that the tables permit.
    pub best: u8,
    /// What the published figures of this project use.
    pub nominal: u8,
    /// The most that the tables permit.
    pub worst: u8,
}

impl Band {
    /// The same in all three columns.
    pub const fn exactly(cycles: u8) -> Band {
        Band { best: cycles, nominal: cycles, worst: cycles }
    }

    /// From the least to the most.
    pub const fn new(best: u8, nominal: u8, worst: u8) -> Band {
        Band { best, nominal, worst }
    }
}

impl Add for Band {
    type Output = Band;

    fn add(self, other: Band) -> Band {
        Band::new(self.best + other.best, self.nominal + other.nominal, self.worst + other.worst)
    }
}

/// What a run cost. Instructions are exact; cycles are the model's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Cost {
    /// Instructions executed, skipped conditional ones and IT included.
    pub instructions: u64,
    /// Cycles at best, memory without wait states.
    pub best: u64,
    /// Cycles, nominal, memory without wait states.
    pub nominal: u64,
    /// Cycles at worst, memory without wait states.
    pub worst: u64,
    /// Refills of the flash accelerator; each waits as long as the flash's wait states say ([`flash`]).
    pub refills: u64,
    /// Nominal cycles and the waits of flash at 168 MHz.
    pub flash_168: u64,
    /// Nominal cycles and the waits of flash at 96 MHz.
    pub flash_96: u64,
}

impl Cost {
    /// Adds one instruction.
    #[inline]
    pub(crate) fn charge(&mut self, band: Band, refills: u64) {
        self.instructions += 1;
        self.wait(band, refills);
    }

    /// Adds cycles that belong to no instruction.
    #[inline]
    pub(crate) fn wait(&mut self, band: Band, refills: u64) {
        self.best += u64::from(band.best);
        self.nominal += u64::from(band.nominal);
        self.worst += u64::from(band.worst);
        self.refills += refills;
        self.flash_168 += u64::from(band.nominal) + refills * REFILL_CYCLES_168_MHZ;
        self.flash_96 += u64::from(band.nominal) + refills * REFILL_CYCLES_96_MHZ;
    }
}

impl Add for Cost {
    type Output = Cost;

    fn add(self, other: Cost) -> Cost {
        Cost {
            instructions: self.instructions + other.instructions,
            best: self.best + other.best,
            nominal: self.nominal + other.nominal,
            worst: self.worst + other.worst,
            refills: self.refills + other.refills,
            flash_168: self.flash_168 + other.flash_168,
            flash_96: self.flash_96 + other.flash_96,
        }
    }
}

impl AddAssign for Cost {
    fn add_assign(&mut self, other: Cost) {
        *self = *self + other;
    }
}

impl Sub for Cost {
    type Output = Cost;

    /// The difference of two readings, column by column; a column that would be negative is 0.
    fn sub(self, other: Cost) -> Cost {
        Cost {
            instructions: self.instructions.saturating_sub(other.instructions),
            best: self.best.saturating_sub(other.best),
            nominal: self.nominal.saturating_sub(other.nominal),
            worst: self.worst.saturating_sub(other.worst),
            refills: self.refills.saturating_sub(other.refills),
            flash_168: self.flash_168.saturating_sub(other.flash_168),
            flash_96: self.flash_96.saturating_sub(other.flash_96),
        }
    }
}
