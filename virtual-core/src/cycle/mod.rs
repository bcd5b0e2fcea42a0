//! Cycle model: the cost of each instruction.
//!
//! A cost has three numbers, because the model has not been compared with silicon: the *best* and
//! the *worst* that Arm's tables permit, and a *nominal* one between them. The rules are those of
//! Arm's Cortex-M4 timing tables, TI's SWCU185G and GCC's `cortex-m4-fpu` description. [`rules`]
//! has the costs by kind, [`hazard`] those of following another instruction, and [`flash`] the wait
//! states of flash, which are counted apart.
//!
//! The model leaves out contention on the bus (DMA, two masters in one RAM), the write buffer,
//! alignment of 32-bit instructions in the prefetch queue, unaligned data, speculative fetches past
//! a branch, and the list in [`flash`].

pub mod flash;
pub mod hazard;
pub mod rules;

use std::ops::{Add, AddAssign, Sub};

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
    /// Cycles of waiting for flash, which no column above includes ([`flash`]).
    pub flash_waits: u64,
}

impl Cost {
    /// Returns the nominal cycles with the waits of flash.
    #[inline]
    pub fn with_flash(&self) -> u64 {
        self.nominal + self.flash_waits
    }

    /// Adds one instruction.
    #[inline]
    pub(crate) fn charge(&mut self, band: Band, flash_waits: u64) {
        self.instructions += 1;
        self.wait(band, flash_waits);
    }

    /// Adds cycles that belong to no instruction.
    #[inline]
    pub(crate) fn wait(&mut self, band: Band, flash_waits: u64) {
        self.best += u64::from(band.best);
        self.nominal += u64::from(band.nominal);
        self.worst += u64::from(band.worst);
        self.flash_waits += flash_waits;
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
            flash_waits: self.flash_waits + other.flash_waits,
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
            flash_waits: self.flash_waits.saturating_sub(other.flash_waits),
        }
    }
}
