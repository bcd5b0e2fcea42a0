//! Schedule of the events that come to the board from outside.

use crate::input::{Fault, Press};

/// Event that comes to the board from outside.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Action {
    Button(bool),
    AdcOverrun,
    AudioDmaError,
    AdcDmaError,
    AudioInterrupt { lost: bool },
    PiezoAtRail(usize),
    Stall { for_s: f64, by_debugger: bool },
    PowerLost { seed: u64 },
    Probe { away: bool },
    StackUsedUp { left_bytes: u32 },
    Panic,
    HardFault,
}

/// Actions with their times in seconds from power-on, the next one last.
#[derive(Debug, Default)]
pub(super) struct Schedule(Vec<(f64, Action)>);

impl Schedule {
    /// Makes the schedule of presses and faults.
    pub(super) fn new(presses: &[Press], faults: &[Fault]) -> Schedule {
        let mut actions: Vec<(f64, Action)> = Vec::new();
        for press in presses {
            actions.extend(press.changes().into_iter().map(|(time, closed)| (time, Action::Button(closed))));
        }
        for fault in faults {
            match fault {
                Fault::CodecSilent | Fault::CrystalDead | Fault::FlashError { .. } | Fault::PowerLostInFlash { .. } => {
                }
                Fault::PowerLost { at_s, seed } => actions.push((*at_s, Action::PowerLost { seed: *seed })),
                Fault::ProbeAway { at_s, for_s } => {
                    actions.push((*at_s, Action::Probe { away: true }));
                    actions.push((at_s + for_s, Action::Probe { away: false }));
                }
                Fault::StackUsedUp { at_s, left_bytes } => {
                    actions.push((*at_s, Action::StackUsedUp { left_bytes: *left_bytes }));
                }
                Fault::AdcOverrun { at_s } => actions.push((*at_s, Action::AdcOverrun)),
                Fault::AudioDmaError { at_s } => actions.push((*at_s, Action::AudioDmaError)),
                Fault::AdcDmaError { at_s } => actions.push((*at_s, Action::AdcDmaError)),
                Fault::CoreStalled { at_s, for_s } => {
                    actions.push((*at_s, Action::Stall { for_s: *for_s, by_debugger: false }));
                }
                Fault::Halted { at_s, for_s } => {
                    actions.push((*at_s, Action::Stall { for_s: *for_s, by_debugger: true }));
                }
                Fault::AudioInterruptLost { at_s, for_s } => {
                    actions.push((*at_s, Action::AudioInterrupt { lost: true }));
                    actions.push((at_s + for_s, Action::AudioInterrupt { lost: false }));
                }
                Fault::PiezoAtRail { piezo, at_s } => actions.push((*at_s, Action::PiezoAtRail(*piezo))),
                Fault::Panic { at_s } => actions.push((*at_s, Action::Panic)),
                Fault::HardFault { at_s } => actions.push((*at_s, Action::HardFault)),
            }
        }
        actions.sort_by(|a, b| b.0.total_cmp(&a.0));
        Schedule(actions)
    }

    /// Returns the time of the next action in seconds, infinity if there is none.
    pub(super) fn next_s(&self) -> f64 {
        self.0.last().map_or(f64::INFINITY, |action| action.0)
    }

    /// Removes and returns the next action.
    pub(super) fn take(&mut self) -> Option<Action> {
        self.0.pop().map(|action| action.1)
    }
}
