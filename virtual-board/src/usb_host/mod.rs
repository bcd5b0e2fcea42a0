//! Host at the USB cable of a board: it enumerates the board, sends and fetches MIDI, and does what
//! users and computers do to a cable.
//!
//! Times on the bus are those of full speed, 12 Mbit/s, without stuffed bits. Frames are 1 ms long.
//! A refused transfer is tried again at once, as often as the frame allows.

mod control;
mod report;
mod transaction;

use std::collections::VecDeque;

use crate::devices::usb::Usb;
use crate::devices::{Access, Context};
use control::{Control, Enumeration};
pub use report::{UsbReport, UsbTransfer};
use transaction::{Phase, Toggles};

/// Longest transfer of the MIDI endpoints, in bytes.
const TRANSFER_BYTES: usize = 64;
/// Time from the plug to the first reset of the bus (USB 2.0, table 7-14).
const DEBOUNCE_S: f64 = 0.1;
/// Length of a reset of the bus.
const RESET_S: f64 = 0.015;
/// Pause between a reset and the first request.
const RECOVERY_S: f64 = 0.01;
/// Length of the signal that ends a suspension.
const RESUME_S: f64 = 0.02;
/// Length of a frame.
pub(crate) const FRAME_S: f64 = 1e-3;

/// Action of the host or of the person who holds the cable.
#[derive(Debug, Clone, PartialEq)]
pub enum UsbAction {
    /// Plugs the cable in; the host finds the board and enumerates it.
    Plug,
    /// Pulls the cable out. What has not been sent is lost.
    Unplug,
    /// Stops all traffic, frames included.
    Suspend,
    /// Wakes a suspended bus.
    Resume,
    /// Resets the bus and enumerates the board anew.
    Reset,
    /// Asks for the device descriptor, resets the bus before the end of the request, and enumerates
    /// the board anew.
    BreakOff,
    /// Sends USB-MIDI event packets of 4 bytes, up to 16 in each transfer.
    Send(Vec<u8>),
    /// Sends these packets again and again, as fast as the bus goes.
    Storm {
        /// Packets of 4 bytes each.
        packets: Vec<u8>,
        /// Length of the storm in seconds.
        for_s: f64,
    },
    /// Fetches what the board sends, as at the start.
    Listen,
    /// Fetches nothing from the board.
    Ignore,
}

/// Host at the USB cable of a board. Without actions no cable is plugged in.
#[derive(Debug, Clone, PartialEq)]
pub struct UsbHost {
    /// Actions with their times in seconds from power-on.
    pub actions: Vec<(f64, UsbAction)>,
    /// Time between two attempts to fetch something from the board, in seconds.
    pub poll_s: f64,
    /// True if the host configures the board after it has read the descriptors.
    pub configures: bool,
}

impl Default for UsbHost {
    fn default() -> UsbHost {
        UsbHost { actions: Vec::new(), poll_s: 0.25e-3, configures: true }
    }
}

/// State of the cable and the bus. Times are in seconds from power-on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    Unplugged,
    /// Plugged in; the board has not pulled D+ up.
    Waiting,
    Debouncing {
        until_s: f64,
    },
    Resetting {
        until_s: f64,
    },
    Recovering {
        until_s: f64,
    },
    Running,
    Suspended,
    Resuming {
        until_s: f64,
    },
}

/// Storm that goes on.
#[derive(Debug)]
struct Storm {
    packets: Vec<u8>,
    next: usize,
    until_s: f64,
}

/// Host with its state.
#[derive(Debug)]
pub(crate) struct Host {
    setup: UsbHost,
    /// Actions, the next one last.
    actions: Vec<(f64, UsbAction)>,
    state: State,
    /// Time of the next start of a frame.
    frame_s: f64,
    frame: u16,
    phase: Phase,
    address: u8,
    control: Option<Control>,
    enumeration: Option<Enumeration>,
    /// True once the board is configured, until it is reset.
    is_configured: bool,
    listens: bool,
    breaks_off: bool,
    /// Transfers to send, with the times at which they were asked for.
    to_send: VecDeque<(f64, Vec<u8>)>,
    storm: Option<Storm>,
    toggles: Toggles,
    next_poll_s: f64,
    /// Time of the last event.
    now_s: f64,
    report: UsbReport,
}

impl Host {
    pub(crate) fn new(setup: &UsbHost) -> Host {
        let mut actions = setup.actions.clone();
        // Stable, so that actions of one time keep their order.
        actions.sort_by(|a, b| a.0.total_cmp(&b.0));
        actions.reverse();
        Host {
            setup: setup.clone(),
            actions,
            state: State::Unplugged,
            frame_s: f64::INFINITY,
            frame: 0,
            phase: Phase::Idle { from_s: 0.0 },
            address: 0,
            control: None,
            enumeration: None,
            is_configured: false,
            listens: true,
            breaks_off: false,
            to_send: VecDeque::new(),
            storm: None,
            toggles: Toggles::default(),
            next_poll_s: 0.0,
            now_s: 0.0,
            report: UsbReport::default(),
        }
    }

    /// Adds an action at a time in seconds from power-on.
    pub(crate) fn add(&mut self, at_s: f64, action: UsbAction) {
        let place = self.actions.partition_point(|later| later.0 > at_s);
        self.actions.insert(place, (at_s, action));
    }

    /// Returns the report so far, in which what still waits to be sent is unsent.
    pub(crate) fn report(&self) -> UsbReport {
        let later = self.actions.iter().map(|(_, action)| match action {
            UsbAction::Send(packets) => packets.len().div_ceil(TRANSFER_BYTES),
            _ => 0,
        });
        let waiting = self.to_send.len() + later.sum::<usize>();
        UsbReport { unsent: self.report.unsent + waiting as u64, ..self.report.clone() }
    }

    /// Returns the transfers that the board has sent so far.
    pub(crate) fn received(&self) -> &[UsbTransfer] {
        &self.report.received
    }

    /// Returns the time of the next event in seconds from power-on.
    pub(crate) fn next_s(&self) -> f64 {
        let action_s = self.actions.last().map_or(f64::INFINITY, |action| action.0);
        let state_s = match self.state {
            State::Unplugged | State::Waiting | State::Suspended => f64::INFINITY,
            State::Debouncing { until_s }
            | State::Resetting { until_s }
            | State::Recovering { until_s }
            | State::Resuming { until_s } => until_s,
            State::Running => self.next_transaction_s(),
        };
        action_s.min(state_s).min(self.frame_s)
    }

    /// Takes that the board pulls D+ up, or that it does so no more.
    pub(crate) fn attached(&mut self, attached: bool, now_s: f64) {
        match (self.state, attached) {
            (State::Waiting, true) => self.state = State::Debouncing { until_s: now_s + DEBOUNCE_S },
            (State::Unplugged | State::Waiting, _) | (_, true) => {}
            (_, false) => {
                self.forget();
                self.state = State::Waiting;
            }
        }
    }

    /// Lets the events up to `context.seconds` happen.
    pub(crate) fn fire(&mut self, core: &mut Usb, context: &Context<'_>) -> Access<()> {
        while self.next_s() <= context.seconds {
            // The bus may have been free before there was something to do.
            let now_s = self.next_s().max(self.now_s);
            self.now_s = now_s;
            if self.actions.last().is_some_and(|action| action.0 <= now_s) {
                if let Some((_, action)) = self.actions.pop() {
                    self.act(action, core, now_s);
                }
            } else if self.frame_s <= now_s {
                self.frame = (self.frame + 1) & 0x7ff;
                self.frame_s += FRAME_S;
                core.start_frame(self.frame, now_s);
            } else if self.state == State::Running {
                self.step(core, context, now_s)?;
            } else {
                self.state_ends(core, now_s);
            }
        }
        Ok(())
    }

    fn act(&mut self, action: UsbAction, core: &mut Usb, now_s: f64) {
        let is_on_bus = matches!(self.state, State::Running | State::Suspended | State::Resuming { .. });
        match action {
            UsbAction::Plug if self.state == State::Unplugged => {
                self.state = State::Waiting;
                self.attached(core.is_attached(), now_s);
            }
            UsbAction::Unplug => {
                self.forget();
                self.state = State::Unplugged;
            }
            UsbAction::Suspend if self.state == State::Running => {
                self.state = State::Suspended;
                self.frame_s = f64::INFINITY;
                self.phase = Phase::Idle { from_s: now_s };
            }
            UsbAction::Resume if self.state == State::Suspended => {
                core.resume(now_s + RESUME_S);
                self.state = State::Resuming { until_s: now_s + RESUME_S };
            }
            UsbAction::Reset if is_on_bus => self.reset(core, now_s),
            UsbAction::BreakOff if self.state == State::Running => {
                self.control = Some(Control::get_descriptor(1, 0, 18));
                self.breaks_off = true;
            }
            UsbAction::Send(packets) => {
                self.to_send.extend(packets.chunks(TRANSFER_BYTES).map(|transfer| (now_s, transfer.to_vec())));
            }
            UsbAction::Storm { packets, for_s } => {
                self.storm = Some(Storm { packets, next: 0, until_s: now_s + for_s });
            }
            UsbAction::Listen => self.listens = true,
            UsbAction::Ignore => self.listens = false,
            action => self.report.failures.push(format!("{now_s:.6} s: {action:?} does not fit {:?}", self.state)),
        }
    }

    /// Forgets all of the bus.
    fn forget(&mut self) {
        self.frame_s = f64::INFINITY;
        self.control = None;
        self.enumeration = None;
        self.is_configured = false;
        self.breaks_off = false;
        self.report.unsent += self.to_send.len() as u64;
        self.to_send.clear();
        self.storm = None;
    }

    /// Begins a reset of the bus.
    fn reset(&mut self, core: &mut Usb, now_s: f64) {
        self.frame_s = f64::INFINITY;
        self.control = None;
        self.is_configured = false;
        self.breaks_off = false;
        core.begin_reset(now_s + RESET_S);
        self.report.resets += 1;
        self.state = State::Resetting { until_s: now_s + RESET_S };
    }

    /// Goes on from a state whose time is over.
    fn state_ends(&mut self, core: &mut Usb, now_s: f64) {
        match self.state {
            State::Debouncing { .. } => self.reset(core, now_s),
            State::Resetting { .. } => {
                core.end_reset();
                self.frame_s = now_s;
                self.state = State::Recovering { until_s: now_s + RECOVERY_S };
            }
            State::Recovering { .. } => {
                self.address = 0;
                self.toggles = Toggles::default();
                self.phase = Phase::Idle { from_s: now_s };
                self.enumeration = Some(Enumeration::default());
                self.control = Enumeration::first();
                self.state = State::Running;
            }
            State::Resuming { .. } => {
                self.frame_s = now_s;
                self.phase = Phase::Idle { from_s: now_s };
                self.state = State::Running;
            }
            State::Unplugged | State::Waiting | State::Running | State::Suspended => {}
        }
    }

    /// Returns the next transfer to send without removing it; the time is that at which it was
    /// asked for.
    fn next_transfer(&mut self, now_s: f64) -> Option<(f64, Vec<u8>)> {
        if let Some(transfer) = self.to_send.front() {
            return Some(transfer.clone());
        }
        let storm = self.storm.as_mut()?;
        if now_s >= storm.until_s || storm.packets.is_empty() {
            self.storm = None;
            return None;
        }
        let bytes = (0..TRANSFER_BYTES).map(|index| storm.packets[(storm.next + index) % storm.packets.len()]);
        let transfer = (now_s, bytes.collect());
        storm.next = (storm.next + TRANSFER_BYTES) % storm.packets.len();
        self.to_send.push_back(transfer);
        self.to_send.front().cloned()
    }
}
