//! Where the cycles went: by what was executed, and how long interrupts waited and took.

use std::collections::BTreeMap;

use virtual_core::ExceptionChange;

use crate::devices::map::interrupt_name;

/// What one interrupt, or another exception, took.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Activity {
    pub(super) count: u64,
    /// Without what preempted it.
    pub(super) cycles: u64,
    pub(super) worst_cycles: u64,
    /// From entry to return, preemptions included.
    pub(super) worst_span: u64,
    /// From the line's assertion until the first instruction of the handler.
    pub(super) latencies: u64,
    pub(super) latency_sum: u64,
    pub(super) worst_latency: u64,
}

/// Cycles from recognising an interrupt to its handler's first instruction.
const ENTRY_CYCLES: u64 = 12;

#[derive(Debug, Clone, Copy)]
struct Active {
    number: u16,
    entered: u64,
    cycles: u64,
}

#[derive(Debug, Default)]
pub(super) struct Account {
    stack: Vec<Active>,
    since: u64,
    pub(super) thread_cycles: u64,
    pub(super) idle_cycles: u64,
    pub(super) by_number: BTreeMap<u16, Activity>,
    asserted_at: BTreeMap<u16, u64>,
    /// Entry and return of the audio interrupt, as they are finished.
    pub(super) audio_spans: Vec<(u64, u64)>,
    pub(super) audio_number: Option<u16>,
}

/// The name of an exception number, as reports show it.
pub(super) fn exception_name(number: u16) -> String {
    match number {
        3 => "HardFault".to_owned(),
        11 => "SVCall".to_owned(),
        14 => "PendSV".to_owned(),
        15 => "SysTick".to_owned(),
        16.. => interrupt_name(number - 16).map_or_else(|| format!("interrupt {}", number - 16), str::to_owned),
        _ => format!("exception {number}"),
    }
}

impl Account {
    fn charge(&mut self, until: u64) {
        let cycles = until.saturating_sub(self.since);
        match self.stack.last_mut() {
            Some(active) => active.cycles += cycles,
            None => self.thread_cycles += cycles,
        }
        self.since = until;
    }

    /// The core slept for so many cycles, up to `until`.
    pub(super) fn slept(&mut self, from: u64, until: u64) {
        self.charge(from);
        self.since = until;
        self.idle_cycles += until - from;
    }

    /// An interrupt line was asserted.
    pub(super) fn asserted(&mut self, line: u16, cycle: u64) {
        self.asserted_at.insert(line + 16, cycle);
    }

    pub(super) fn changed(&mut self, change: ExceptionChange) {
        self.charge(change.cycle);
        let depth = change.depth as usize;
        let enters = depth > self.stack.len() || depth == self.stack.len() && change.running != 0;
        // Left: all that are deeper than now, and with a tail-chained one the last.
        let keep = if enters { depth.saturating_sub(1) } else { depth };
        while self.stack.len() > keep {
            let Some(left) = self.stack.pop() else { break };
            self.finish(left, change.cycle);
        }
        if enters {
            let activity = self.by_number.entry(change.running).or_default();
            if let Some(asserted) = self.asserted_at.remove(&change.running) {
                let latency = change.cycle.saturating_sub(asserted) + ENTRY_CYCLES;
                activity.latencies += 1;
                activity.latency_sum += latency;
                activity.worst_latency = activity.worst_latency.max(latency);
            }
            self.stack.push(Active { number: change.running, entered: change.cycle, cycles: 0 });
        }
    }

    fn finish(&mut self, left: Active, cycle: u64) {
        let activity = self.by_number.entry(left.number).or_default();
        activity.count += 1;
        activity.cycles += left.cycles;
        activity.worst_cycles = activity.worst_cycles.max(left.cycles);
        activity.worst_span = activity.worst_span.max(cycle - left.entered);
        if self.audio_number == Some(left.number) {
            self.audio_spans.push((left.entered, cycle));
        }
    }

    /// The chip was reset: nothing is active any more.
    pub(super) fn reset(&mut self, cycle: u64) {
        self.charge(cycle);
        while let Some(left) = self.stack.pop() {
            self.finish(left, cycle);
        }
        self.asserted_at.clear();
    }

    /// Ends the account for a report.
    pub(super) fn settle(&mut self, cycle: u64) {
        self.charge(cycle);
    }
}
