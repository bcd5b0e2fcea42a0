//! IWDG, which counts down from 32 kHz and resets the chip at zero (RM0090 section 21, RM0383
//! section 15).

use super::{Access, Context, Problem};
use crate::frequency::Frequency;

/// Typical frequency of the LSI. On silicon it is 17 to 47 kHz.
const LSI: Frequency = Frequency::hz(32_000);

#[derive(Debug)]
pub(crate) struct Watchdog {
    prescaler: u32,
    reload: u32,
    unlocked: bool,
    on: bool,
    deadline: u64,
}

impl Default for Watchdog {
    fn default() -> Watchdog {
        Watchdog { prescaler: 0, reload: 0xfff, unlocked: false, on: false, deadline: u64::MAX }
    }
}

impl Watchdog {
    pub(crate) fn read(&self, offset: u32) -> Access<u32> {
        Ok(match offset {
            0x00 | 0x0c => 0,
            0x04 => self.prescaler,
            0x08 => self.reload,
            _ => return Err(Problem::register()),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, context: &Context<'_>) -> Access<()> {
        match offset {
            0x00 => match value & 0xffff {
                0xcccc => {
                    self.on = true;
                    self.feed(context);
                }
                0xaaaa => {
                    self.unlocked = false;
                    self.feed(context);
                }
                key => self.unlocked = key == 0x5555,
            },
            0x04 | 0x08 if !self.unlocked => {
                let reason = "IWDG_PR and IWDG_RLR are written without the key 0x5555".to_owned();
                return Err(Problem::Misuse { reason });
            }
            0x04 => self.prescaler = value & 7,
            0x08 => self.reload = value & 0xfff,
            0x0c => {}
            _ => return Err(Problem::register()),
        }
        Ok(())
    }

    fn feed(&mut self, context: &Context<'_>) {
        if self.on {
            let ticks = u64::from(self.reload) + 1;
            let divider = 4 << self.prescaler.min(6);
            self.deadline = context.now + LSI.scaled(1, divider).for_each(context.clocks.core).cycle_of(ticks);
        }
    }

    /// Puts the reset off by some cycles in which the watchdog does not count.
    pub(crate) fn delay(&mut self, cycles: u64) {
        self.deadline = self.deadline.saturating_add(cycles);
    }

    /// Returns the cycle at which the watchdog resets the chip.
    pub(crate) fn next_event(&self) -> u64 {
        self.deadline
    }

    /// Takes a change of the core's clock. The time that is left stays.
    pub(crate) fn clock_changed(&mut self, now: u64, before: Frequency, after: Frequency) {
        if self.on {
            let left = self.deadline.saturating_sub(now) as f64 / before.as_f64();
            self.deadline = now + (left * after.as_f64()) as u64;
        }
    }
}
