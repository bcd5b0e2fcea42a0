//! Transactions: a token, data, an acknowledgement, at the times of the bits on the bus.

use super::control::{ADDRESS, Enumeration, Stage};
use super::{FRAME_S, Host, UsbTransfer};
use crate::devices::usb::{Answer, Usb};
use crate::devices::{Access, Context};

/// Time of a bit.
const BIT_S: f64 = 1.0 / 12e6;
/// Bits of a token: synchronisation, identifier, address, endpoint, check, end.
const TOKEN_BITS: usize = 35;
/// Bits of a data packet besides its bytes.
const DATA_BITS: usize = 35;
/// Bits of an acknowledgement.
const HANDSHAKE_BITS: usize = 19;
/// Pause before an answer, and between two packets of the host.
const TURN_BITS: usize = 5;
/// Pause between two transactions.
const GAP_BITS: usize = 8;
/// Bits at the end of a frame in which nothing begins that would not end.
const GUARD_BITS: usize = 40;
/// Pause before a refused packet of a control transfer is sent again.
const RETRY_S: f64 = 50e-6;
/// Number of packets in a row without an answer after which a request fails.
const TRIES: u32 = 3;
/// Number of the MIDI endpoint in each direction.
const MIDI: usize = 1;

/// Toggle bits of the MIDI endpoints: true if the next packet is DATA1.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Toggles {
    output: bool,
    input: bool,
}

/// Part of a transaction that comes next.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Phase {
    /// Nothing goes on; the bus is free from this time on.
    Idle { from_s: f64 },
    /// The data of the host, or its IN token, end at this time.
    Asked { job: Job, at_s: f64 },
    /// The transaction ends at this time with this answer of the board.
    Answered { job: Job, answer: Answer, at_s: f64 },
}

/// Transaction.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Job {
    /// Stage of the control transfer.
    Control(Stage),
    /// MIDI to the board, with the time at which it was asked for.
    Send(f64, Vec<u8>),
    /// MIDI from the board.
    Fetch,
}

fn bits_s(bits: usize) -> f64 {
    bits as f64 * BIT_S
}

impl Host {
    /// Returns the time of the next step of a transaction.
    pub(super) fn next_transaction_s(&self) -> f64 {
        match &self.phase {
            Phase::Asked { at_s, .. } | Phase::Answered { at_s, .. } => *at_s,
            Phase::Idle { from_s } => {
                if self.control.is_some() || self.is_configured && (!self.to_send.is_empty() || self.storm.is_some()) {
                    *from_s
                } else if self.is_configured && self.listens {
                    from_s.max(self.next_poll_s)
                } else {
                    f64::INFINITY
                }
            }
        }
    }

    /// Does the next step of a transaction.
    pub(super) fn step(&mut self, core: &mut Usb, context: &Context<'_>, now_s: f64) -> Access<()> {
        match std::mem::replace(&mut self.phase, Phase::Idle { from_s: now_s }) {
            Phase::Idle { .. } => self.begin(now_s),
            Phase::Asked { job, at_s } => {
                let answer = self.ask(&job, core, context)?;
                let bits = match &answer {
                    Answer::Data(data, _) => TURN_BITS + DATA_BITS + 8 * data.len() + TURN_BITS + HANDSHAKE_BITS,
                    // A host waits for an answer for 18 bits.
                    Answer::Silence => 18,
                    _ => TURN_BITS + HANDSHAKE_BITS,
                };
                self.phase = Phase::Answered { job, answer, at_s: at_s + bits_s(bits) };
            }
            Phase::Answered { job, answer, at_s } => {
                self.phase = Phase::Idle { from_s: at_s + bits_s(GAP_BITS) };
                self.end(job, answer, core, at_s);
            }
        }
        Ok(())
    }

    /// Begins a transaction: one of the control transfer, else one that sends, else one that
    /// fetches. A poll that is due comes before a transfer to send.
    fn begin(&mut self, now_s: f64) {
        let polls = self.is_configured && self.listens && now_s >= self.next_poll_s;
        let job = if let Some(control) = &self.control {
            Job::Control(control.stage)
        } else if polls {
            Job::Fetch
        } else if let Some((asked_s, transfer)) = self.is_configured.then(|| self.next_transfer(now_s)).flatten() {
            Job::Send(asked_s, transfer)
        } else {
            return;
        };
        let (bits, longest) = match &job {
            Job::Control(Stage::Setup) => (TOKEN_BITS + TURN_BITS + DATA_BITS + 64, 0),
            Job::Control(Stage::Status) if self.data_comes() => (TOKEN_BITS + TURN_BITS + DATA_BITS, 0),
            Job::Send(_, data) => (TOKEN_BITS + TURN_BITS + DATA_BITS + 8 * data.len(), 0),
            Job::Control(_) | Job::Fetch => (TOKEN_BITS, DATA_BITS + 8 * super::TRANSFER_BYTES),
        };
        let needed_s = bits_s(bits + longest + 2 * TURN_BITS + HANDSHAKE_BITS + GUARD_BITS);
        if now_s + needed_s > self.frame_s {
            // The frame's first packet takes the place of a token.
            self.phase = Phase::Idle { from_s: self.frame_s + bits_s(TOKEN_BITS + GAP_BITS) };
            return;
        }
        if job == Job::Fetch {
            self.next_poll_s = now_s + self.setup.poll_s;
        }
        self.phase = Phase::Asked { job, at_s: now_s + bits_s(bits) };
    }

    /// Returns true if the control transfer is one in which the board sends data.
    fn data_comes(&self) -> bool {
        self.control.as_ref().is_some_and(|control| control.setup[0] & 0x80 != 0)
    }

    /// Gives the board a packet, and returns its answer.
    fn ask(&mut self, job: &Job, core: &mut Usb, context: &Context<'_>) -> Access<Answer> {
        let address = self.address;
        match job {
            Job::Send(_, data) => core.output(address, MIDI, self.toggles.output, data, context),
            Job::Fetch => core.input(address, MIDI, context),
            Job::Control(stage) => match (&self.control, stage) {
                (Some(control), Stage::Setup) => core.setup(address, control.setup, context),
                (Some(_), Stage::Status) if self.data_comes() => core.output(address, 0, true, &[], context),
                _ => core.input(address, 0, context),
            },
        }
    }

    /// Ends a transaction.
    fn end(&mut self, job: Job, answer: Answer, core: &mut Usb, now_s: f64) {
        match (job, answer) {
            (Job::Control(stage), answer) => self.control_answered(stage, answer, core, now_s),
            (Job::Send(asked_s, bytes), Answer::Ack) => {
                self.toggles.output ^= true;
                self.to_send.pop_front();
                self.report.sent.push(UsbTransfer { asked_s, ended_s: now_s, bytes });
            }
            (Job::Send(..), Answer::Nak) => self.report.refused += 1,
            (Job::Fetch, Answer::Data(bytes, odd)) => {
                core.acknowledge(MIDI, bytes.len());
                if odd == self.toggles.input {
                    self.toggles.input ^= true;
                    let asked_s = self.next_poll_s - self.setup.poll_s;
                    self.report.received.push(UsbTransfer { asked_s, ended_s: now_s, bytes });
                    // There may be more.
                    self.next_poll_s = now_s;
                } else {
                    self.fail(now_s, "the board sent a packet again that had been acknowledged");
                }
            }
            (Job::Fetch, Answer::Nak) => self.report.empty_polls += 1,
            (Job::Send(..), answer) => {
                self.to_send.pop_front();
                self.fail(now_s, &format!("the board answered {answer:?} to a transfer"));
            }
            (Job::Fetch, answer) => self.fail(now_s, &format!("the board answered {answer:?} to a poll")),
        }
    }

    fn control_answered(&mut self, stage: Stage, answer: Answer, core: &mut Usb, now_s: f64) {
        let data_comes = self.data_comes();
        let Some(control) = &mut self.control else { return };
        if answer != Answer::Silence {
            control.unanswered = 0;
        }
        match (stage, answer) {
            (Stage::Setup, Answer::Ack) => control.stage = if data_comes { Stage::Data } else { Stage::Status },
            (Stage::Data, Answer::Data(data, odd)) => {
                core.acknowledge(0, data.len());
                if odd == control.odd {
                    control.odd ^= true;
                    control.data.extend(&data);
                    if data.len() < 64 || control.data.len() >= control.wanted() {
                        control.stage = Stage::Status;
                    }
                }
                if self.breaks_off {
                    self.reset(core, now_s);
                }
            }
            (Stage::Status, Answer::Data(data, _)) => {
                core.acknowledge(0, data.len());
                self.control_ends(now_s);
            }
            (Stage::Status, Answer::Ack) => self.control_ends(now_s),
            (_, Answer::Nak) => self.phase = Phase::Idle { from_s: now_s + RETRY_S },
            (_, Answer::Silence) => {
                control.unanswered += 1;
                if control.unanswered == TRIES {
                    let setup = control.setup;
                    self.fail(now_s, &format!("the board did not answer the request {setup:02x?}"));
                    self.reset(core, now_s);
                } else {
                    self.phase = Phase::Idle { from_s: now_s + FRAME_S };
                }
            }
            (_, answer) => {
                let setup = control.setup;
                self.report.stalls += u64::from(answer == Answer::Stall);
                self.fail(now_s, &format!("the board answered {answer:?} to the request {setup:02x?}"));
                self.control = None;
            }
        }
    }

    /// Ends a control transfer, and begins the next one of the enumeration.
    fn control_ends(&mut self, now_s: f64) {
        let Some((control, enumeration)) = self.control.take().zip(self.enumeration) else { return };
        match enumeration {
            Enumeration::Address => self.address = ADDRESS,
            Enumeration::Configure => {
                self.is_configured = true;
                self.next_poll_s = now_s;
                self.toggles = Toggles::default();
                self.report.configured_s.push(now_s);
            }
            _ => {}
        }
        match enumeration.next(&control.data, self.setup.configures, &mut self.report) {
            Some((place, control)) => {
                self.enumeration = Some(place);
                self.control = Some(control);
                if enumeration == Enumeration::Address {
                    // A board has 2 ms to take its address.
                    self.phase = Phase::Idle { from_s: now_s + 2.0 * FRAME_S };
                }
            }
            None => self.enumeration = None,
        }
    }

    fn fail(&mut self, now_s: f64, reason: &str) {
        self.report.failures.push(format!("{now_s:.6} s: {reason}"));
    }
}
