//! Cycle model: the cost of each instruction.
//!
//! A cost has three numbers, because the model has not been compared with silicon: the *best* and
//! the *worst* that Arm's tables permit, and a *nominal* one between them. The rules are those of
//! Arm's Cortex-M4 timing tables, TI's SWCU185G and GCC's `cortex-m4-fpu` description. [`rules`]
//! has the costs by kind, [`hazard`] those of following another instruction, and [`flash`] the wait
//! states of flash, which make two further columns.
//!
//! The model leaves out contention on the bus (DMA, two masters in one RAM), the write buffer,
//! alignment of 32-bit instructions in the prefetch queue, unaligned data, speculative fetches past
//! a branch, and the list in [`flash`].

pub mod flash;
pub mod hazard;
pub mod rules;

use std::ops::{Add, AddAssign, Sub};

use flash::{REFILL_CYCLES_96_MHZ, REFILL_CYCLES_168_MHZ};

/// Best, nominal and worst cost of one instruction, in cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Band {
    /// Fewest cycles that the tables permit.
    pub best: u8,
    /// Cycles that the published figures of this project use.
    pub nominal: u8,
    /// Most cycles that the tables permit.
    pub worst: u8,
}

impl Band {
    /// Makes a cost of `cycles` in all three columns.
    pub const fn exactly(cycles: u8) -> Band {
        Band { best: cycles, nominal: cycles, worst: cycles }
    }

    /// Makes a cost from its three columns.
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

/// Cost of a run. The number of instructions is exact, and the cycles are those of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Cost {
    /// Number of instructions executed, skipped conditional ones and IT included.
    pub instructions: u64,
    /// Best cycles, with memory without wait states.
    pub best: u64,
    /// Nominal cycles, with memory without wait states.
    pub nominal: u64,
    /// Worst cycles, with memory without wait states.
    pub worst: u64,
    /// Number of refills of the flash accelerator, whose waits depend on the core clock
    /// ([`flash`]).
    pub refills: u64,
    /// Nominal cycles with the waits of flash at 168 MHz.
    pub flash_168: u64,
    /// Nominal cycles with the waits of flash at 96 MHz.
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

    /// Returns the difference of two readings, column by column. No column falls below 0.
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
