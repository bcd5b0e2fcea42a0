//! Time as a board needs it: which column of the cost it is, shared with the devices, and where to pause.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::cycle::Cost;

/// A column of [`Cost`], without the waits of flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum CycleCase {
    /// The least that Arm's tables permit.
    Best,
    /// What the published figures of this project use.
    #[default]
    Nominal,
    /// The most that the tables permit.
    Worst,
}

/// What a machine's time is: one column, and what a refill of the flash accelerator adds to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Pace {
    /// The column.
    pub case: CycleCase,
    /// Cycles of a refill; 0 leaves flash without waits.
    pub refill_cycles: u64,
}

impl Pace {
    /// The cycles that this cost takes.
    #[inline]
    pub fn cycles(&self, cost: &Cost) -> u64 {
        let column = match self.case {
            CycleCase::Best => cost.best,
            CycleCase::Nominal => cost.nominal,
            CycleCase::Worst => cost.worst,
        };
        column + cost.refills * self.refill_cycles
    }
}

/// The time of a machine, in cycles since it was made, for devices that are asked in the middle of an instruction; and the time at which
/// the machine pauses ([`crate::Machine::resume_until_due`]). A device whose next event has moved calls [`Clock::pause_now`].
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
    /// Cycles at the start of the instruction that is being executed, or of the next one.
    #[inline]
    pub fn now(&self) -> u64 {
        self.now.load(Ordering::Relaxed)
    }

    /// When the machine pauses next.
    #[inline]
    pub fn due(&self) -> u64 {
        self.due.load(Ordering::Relaxed)
    }

    /// Lets the machine pause before the first instruction that starts at or after that time.
    pub fn set_due(&self, cycle: u64) {
        self.due.store(cycle, Ordering::Relaxed);
    }

    /// Lets the machine pause after the instruction that is being executed.
    pub fn pause_now(&self) {
        self.set_due(0);
    }

    #[inline]
    pub(crate) fn set_now(&self, cycle: u64) {
        self.now.store(cycle, Ordering::Relaxed);
    }
}

/// A change of what the core executes: an exception entered, left, or followed by another without a return between.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExceptionChange {
    /// The machine's time when the entry began, or the instruction that returned.
    pub cycle: u64,
    /// Instructions executed so far.
    pub instructions: u64,
    /// The number of the exception that is handled from here on, 0 for none.
    pub running: u16,
    /// How many exceptions are active, preempted ones included.
    pub depth: u32,
}
