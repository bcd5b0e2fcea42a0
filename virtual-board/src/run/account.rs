//! Account of the cycles by thread and interrupt, and of the latency of interrupts.

use std::collections::BTreeMap;

use virtual_core::ExceptionChange;

use crate::devices::map::interrupt_name;

/// Cycles of an interrupt or another exception.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Activity {
    /// Number of runs of the handler.
    pub(super) count: u64,
    /// Cycles of all runs, without those that preempted them.
    pub(super) cycles: u64,
    /// Most cycles of a run, without those that preempted it.
    pub(super) worst_cycles: u64,
    /// Most cycles from entry to return, preemptions included.
    pub(super) worst_span: u64,
    /// Number of latencies that were measured.
    pub(super) latencies: u64,
    /// Sum of the latencies: cycles from the assertion of the line to the handler's first
    /// instruction.
    pub(super) latency_sum: u64,
    /// Longest latency, in cycles.
    pub(super) worst_latency: u64,
}

/// Cycles from recognising an interrupt to its handler's first instruction.
const ENTRY_CYCLES: u64 = 12;

/// Run of a handler that has not returned.
#[derive(Debug, Clone, Copy)]
struct Active {
    /// Number of the exception.
    number: u16,
    /// Cycle of the entry.
    entered: u64,
    /// Cycles so far, without those that preempted it.
    cycles: u64,
}

/// Account of all cycles of a run.
#[derive(Debug, Default)]
pub(super) struct Account {
    /// Active handlers, the running one last.
    stack: Vec<Active>,
    /// Cycle up to which all cycles have been charged.
    since: u64,
    /// Cycles in thread mode, awake.
    pub(super) thread_cycles: u64,
    /// Cycles asleep.
    pub(super) idle_cycles: u64,
    /// Cycles of each exception, by its number.
    pub(super) by_number: BTreeMap<u16, Activity>,
    /// Cycle at which the line of an exception was asserted, by its number.
    asserted_at: BTreeMap<u16, u64>,
    /// Cycles of entry and return of each finished audio interrupt.
    pub(super) audio_spans: Vec<(u64, u64)>,
    /// Exception number of the audio interrupt, once it is known.
    pub(super) audio_number: Option<u16>,
}

/// Returns the name of an exception number in reports.
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
    /// Charges the cycles up to `until` to the running handler or the thread.
    fn charge(&mut self, until: u64) {
        let cycles = until.saturating_sub(self.since);
        match self.stack.last_mut() {
            Some(active) => active.cycles += cycles,
            None => self.thread_cycles += cycles,
        }
        self.since = until;
    }

    /// Notes that the core slept from the cycle `from` to the cycle `until`.
    pub(super) fn slept(&mut self, from: u64, until: u64) {
        self.charge(from);
        self.since = until;
        self.idle_cycles += until - from;
    }

    /// Notes that an interrupt line was asserted.
    pub(super) fn asserted(&mut self, line: u16, cycle: u64) {
        self.asserted_at.insert(line + 16, cycle);
    }

    /// Notes that an exception was entered or left.
    pub(super) fn changed(&mut self, change: ExceptionChange) {
        self.charge(change.cycle);
        let depth = change.depth as usize;
        let enters = depth > self.stack.len() || depth == self.stack.len() && change.running != 0;
        // All handlers deeper than now have been left, and that before a tail-chained one.
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

    /// Adds a handler that has returned to the activity of its exception.
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

    /// Finishes all active handlers, because the chip was reset.
    pub(super) fn reset(&mut self, cycle: u64) {
        self.charge(cycle);
        while let Some(left) = self.stack.pop() {
            self.finish(left, cycle);
        }
        self.asserted_at.clear();
    }

    /// Charges the cycles up to `cycle`, for a report.
    pub(super) fn settle(&mut self, cycle: u64) {
        self.charge(cycle);
    }
}
