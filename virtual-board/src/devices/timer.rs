//! TIM2 to TIM5: up-counting, update and compare events, interrupts, trigger output (RM0090 section
//! 18, RM0383 section 13).

use super::{Access, Context, Problem, Unmodelled};
use crate::frequency::Pace;

const CEN: u32 = 1 << 0;
const UDIS: u32 = 1 << 1;
const URS: u32 = 1 << 2;
const OPM: u32 = 1 << 3;
const UP_AND_DOWN: u32 = 0b111 << 4;
const ARPE: u32 = 1 << 7;
const UPDATE: u32 = 1 << 0;

/// Output of a timer to other devices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum TimerOutput {
    /// Trigger output TRGO.
    Trigger,
    /// Compare match of this channel, 1 to 4, which is the rising edge of its output.
    Compare(u8),
}

#[derive(Debug)]
pub(crate) struct Timer {
    wide: bool,
    control: [u32; 2],
    interrupts: u32,
    status: u32,
    modes: [u32; 2],
    enables: u32,
    prescaler: u32,
    prescaler_in_use: u32,
    reload: u32,
    reload_in_use: u32,
    compare: [u32; 4],
    /// Value of the counter at the cycle `since`.
    counter: u32,
    /// Cycle from which the timer counts.
    since: u64,
    /// Number of counts since then whose events have happened.
    taken: u64,
    /// Pace of the counts, or `None` while the timer stands.
    pace: Option<Pace>,
    /// Cycle of the next update or compare event.
    due: u64,
}

impl Timer {
    /// Makes a timer after a reset, of 32 bits if it is `wide`, else of 16.
    pub(crate) fn new(wide: bool) -> Timer {
        let reload = if wide { u32::MAX } else { 0xffff };
        Timer {
            wide,
            control: [0; 2],
            interrupts: 0,
            status: 0,
            modes: [0; 2],
            enables: 0,
            prescaler: 0,
            prescaler_in_use: 0,
            reload,
            reload_in_use: reload,
            compare: [0; 4],
            counter: 0,
            since: 0,
            taken: 0,
            pace: None,
            due: u64::MAX,
        }
    }

    pub(crate) fn is_wide(&self) -> bool {
        self.wide
    }

    fn mask(&self) -> u32 {
        if self.wide { u32::MAX } else { 0xffff }
    }

    fn runs(&self) -> bool {
        self.control[0] & CEN != 0
    }

    fn pace_at(&self, context: &Context<'_>) -> Pace {
        let clock = context.clocks.apb1_timers;
        clock.scaled(1, u64::from(self.prescaler_in_use) + 1).for_each(context.clocks.core)
    }

    fn ticks(&self, now: u64) -> u64 {
        self.pace.map_or(0, |pace| pace.events_in(now.saturating_sub(self.since)))
    }

    fn period(&self) -> u64 {
        u64::from(self.reload_in_use) + 1
    }

    fn count(&self, now: u64) -> u32 {
        self.value_at(self.ticks(now))
    }

    fn value_at(&self, ticks: u64) -> u32 {
        ((u64::from(self.counter) + ticks) % self.period()) as u32
    }

    /// Lets the timer count from `counter` from now on.
    fn anchor(&mut self, counter: u32, context: &Context<'_>) {
        self.counter = counter;
        self.since = context.now;
        self.taken = 0;
        self.pace = self.runs().then(|| self.pace_at(context));
        self.due = self.find_due();
    }

    /// Takes a change of the bus clock. The counter keeps its value.
    pub(crate) fn clock_changed(&mut self, context: &Context<'_>) {
        let counter = self.count(context.now);
        self.anchor(counter, context);
    }

    /// Returns the next count since `since` at which the counter has a value, or `None` if it never
    /// has.
    fn next_tick(&self, value: u32) -> Option<u64> {
        let period = self.period();
        let after = (u64::from(self.counter) + self.taken) % period;
        let ahead = (u64::from(value) + period - after) % period;
        (u64::from(value) < period).then_some(self.taken + if ahead == 0 { period } else { ahead })
    }

    /// Returns the cycle of the next update or compare event.
    pub(crate) fn next_event(&self) -> u64 {
        self.due
    }

    /// Finds the cycle of the next update or compare event.
    fn find_due(&self) -> u64 {
        let Some(pace) = self.pace else { return u64::MAX };
        let ticks = self.watched().filter_map(|channel| self.next_tick(self.compare[channel]));
        let update = self.next_tick(0);
        ticks.chain(update).min().map_or(u64::MAX, |tick| self.since.saturating_add(pace.cycle_of(tick)))
    }

    /// Returns the channels whose compare event has an effect.
    ///
    /// A channel has one if its compare value is not 0, its interrupt is on, or its output is. With
    /// an interrupt or an output 0 is a compare value too.
    fn watched(&self) -> impl Iterator<Item = usize> {
        (0..4).filter(|&channel| {
            let interrupts = self.interrupts & UPDATE << (channel + 1) != 0;
            self.compare[channel] != 0 || interrupts || self.enables & 1 << (4 * channel) != 0
        })
    }

    /// Lets the event at `context.now` happen; `output` gets each output to other devices.
    pub(crate) fn fire(&mut self, context: &Context<'_>, mut output: impl FnMut(TimerOutput)) {
        self.taken = self.ticks(context.now);
        let value = self.value_at(self.taken);
        for channel in self.watched().collect::<Vec<_>>() {
            if self.compare[channel] == value {
                self.status |= UPDATE << (channel + 1);
                output(TimerOutput::Compare(channel as u8 + 1));
                if self.trigger_source() == channel as u32 + 4 {
                    output(TimerOutput::Trigger);
                }
            }
        }
        if value == 0 && self.control[0] & UDIS == 0 {
            self.status |= UPDATE;
            if self.trigger_source() == 2 {
                output(TimerOutput::Trigger);
            }
            if self.prescaler_in_use != self.prescaler || self.reload_in_use != self.reload {
                self.update();
                self.anchor(0, context);
            }
        }
        self.due = self.find_due();
    }

    fn update(&mut self) {
        self.prescaler_in_use = self.prescaler;
        self.reload_in_use = self.reload;
    }

    fn check_counter(&self, counter: u32) -> Access<()> {
        if counter <= self.reload_in_use {
            return Ok(());
        }
        Err(Unmodelled::new("a counter beyond its reload value").into())
    }

    fn trigger_source(&self) -> u32 {
        self.control[1] >> 4 & 7
    }

    /// Returns true if the interrupt is asserted.
    pub(crate) fn is_asserted(&self) -> bool {
        self.status & self.interrupts & 0x5f != 0
    }

    pub(crate) fn read(&self, offset: u32, context: &Context<'_>) -> Access<u32> {
        Ok(match offset {
            0x00 | 0x04 => self.control[(offset / 4) as usize],
            0x0c => self.interrupts,
            0x08 | 0x14 => 0,
            0x10 => self.status,
            0x18 | 0x1c => self.modes[(offset / 4 - 6) as usize],
            0x20 => self.enables,
            0x24 => self.count(context.now),
            0x28 => self.prescaler,
            0x2c => self.reload,
            0x34..=0x40 => self.compare[(offset / 4 - 13) as usize],
            _ => return Err(Problem::register()),
        })
    }

    pub(crate) fn write(
        &mut self,
        offset: u32,
        value: u32,
        context: &Context<'_>,
        output: impl FnMut(TimerOutput),
    ) -> Access<()> {
        self.write_register(offset, value, context, output)?;
        self.due = self.find_due();
        Ok(())
    }

    fn write_register(
        &mut self,
        offset: u32,
        value: u32,
        context: &Context<'_>,
        mut output: impl FnMut(TimerOutput),
    ) -> Access<()> {
        match offset {
            0x00 => {
                if value & (OPM | UP_AND_DOWN) != 0 {
                    return Err(Unmodelled::new("one-pulse mode and counting down").into());
                }
                let counter = self.count(context.now);
                let was_running = self.runs();
                self.control[0] = value;
                if self.runs() != was_running {
                    self.anchor(counter, context);
                }
            }
            0x04 => self.control[1] = value,
            0x08 if value & 7 != 0 => return Err(Unmodelled::new("a timer's slave mode").into()),
            0x08 => {}
            0x0c if value & 0x5f00 != 0 => return Err(Unmodelled::new("a timer's DMA requests").into()),
            0x0c => self.interrupts = value,
            0x10 => self.status &= value,
            0x14 => {
                self.status |= value & 0x1e;
                if value & UPDATE != 0 && self.control[0] & UDIS == 0 {
                    self.update();
                    self.anchor(0, context);
                    if self.control[0] & URS == 0 {
                        self.status |= UPDATE;
                    }
                    // With MMS 000 the reset is the trigger, with 010 the update.
                    if matches!(self.trigger_source(), 0 | 2) {
                        output(TimerOutput::Trigger);
                    }
                }
            }
            0x18 | 0x1c => self.modes[(offset / 4 - 6) as usize] = value,
            0x20 => self.enables = value,
            0x24 => {
                self.check_counter(value)?;
                self.anchor(value, context);
            }
            0x28 => self.prescaler = value & 0xffff,
            0x2c => {
                let counter = self.count(context.now);
                self.reload = value & self.mask();
                if self.control[0] & ARPE == 0 || !self.runs() {
                    self.reload_in_use = self.reload;
                    self.check_counter(counter)?;
                    self.anchor(counter, context);
                }
            }
            0x34..=0x40 => {
                // An event between the start and the end of the instruction must not be lost.
                if self.next_event() <= context.now {
                    self.fire(context, &mut output);
                }
                self.taken = self.ticks(context.now);
                self.compare[(offset / 4 - 13) as usize] = value & self.mask();
            }
            _ => return Err(Problem::register()),
        }
        Ok(())
    }
}
