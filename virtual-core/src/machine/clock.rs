//! Time of a machine: the column of the cost that it follows, and the time at which to pause.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::cycle::Cost;

/// Column of [`Cost`] without the waits of flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum CycleCase {
    /// Fewest cycles that Arm's tables permit.
    Best,
    /// Cycles that the published figures of this project use.
    #[default]
    Nominal,
    /// Most cycles that Arm's tables permit.
    Worst,
}

/// Pace of a machine's time: a column of the cost, and the waits of flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Pace {
    /// Column of the cost.
    pub case: CycleCase,
    /// True if the waits of flash are added to the column.
    pub flash_waits: bool,
}

impl Pace {
    /// Returns the cycles that a cost takes at this pace.
    #[inline]
    pub fn cycles(&self, cost: &Cost) -> u64 {
        let column = match self.case {
            CycleCase::Best => cost.best,
            CycleCase::Nominal => cost.nominal,
            CycleCase::Worst => cost.worst,
        };
        column + if self.flash_waits { cost.flash_waits } else { 0 }
    }
}

/// Clock of a machine, in cycles since the machine was made, which it shares with its devices.
///
/// It also holds the time at which the machine pauses ([`crate::Machine::resume_until_due`]). A
/// device whose next event has moved calls [`Clock::pause_now`].
#[derive(Debug)]
pub struct Clock {
    now: AtomicU64,
    due: AtomicU64,
}

impl Default for Clock {
    fn default() -> Clock {
        Clock { now: AtomicU64::new(0), due: AtomicU64::new(u64::MAX) }
    }
}

impl Clock {
    /// Returns the cycles at the start of the current instruction, or of the next one in a pause.
    #[inline]
    pub fn now(&self) -> u64 {
        self.now.load(Ordering::Relaxed)
    }

    /// Returns the time at which the machine pauses next, in cycles.
    #[inline]
    pub fn due(&self) -> u64 {
        self.due.load(Ordering::Relaxed)
    }

    /// Lets the machine pause before the first instruction that starts at `cycle` or later.
    pub fn set_due(&self, cycle: u64) {
        self.due.store(cycle, Ordering::Relaxed);
    }

    /// Lets the machine pause after the current instruction.
    pub fn pause_now(&self) {
        self.set_due(0);
    }

    #[inline]
    pub(crate) fn set_now(&self, cycle: u64) {
        self.now.store(cycle, Ordering::Relaxed);
    }
}

/// Entry of an exception, return from one, or return into another exception.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExceptionChange {
    /// Time at which the entry, or the instruction that returned, began, in cycles.
    pub cycle: u64,
    /// Number of instructions executed up to then.
    pub instructions: u64,
    /// Number of the exception that is handled from then on, 0 for none.
    pub running: u16,
    /// Number of active exceptions from then on, preempted ones included.
    pub depth: u32,
}
