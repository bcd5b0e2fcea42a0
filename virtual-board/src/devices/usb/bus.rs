//! Bus side of the USB core: what the host sends, and what the core answers.

use super::endpoint::{ITTXFE, STUP, XFRC};
use super::fifo::Status;
use super::{ENDPOINTS, IDLE_S, Usb, flag};
use crate::devices::{Access, Context, Problem};
use crate::frequency::Frequency;

/// Answer of the core to a packet of the host.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Answer {
    Ack,
    Nak,
    Stall,
    /// Packet of an IN endpoint; true if it is DATA1.
    Data(Vec<u8>, bool),
    /// No answer: another address, or an endpoint that does not exist.
    Silence,
}

impl Usb {
    /// Returns true if the pull-up of D+ is on.
    pub(crate) fn is_attached(&self) -> bool {
        self.general & 1 << 16 != 0 && self.control & 1 << 1 == 0
    }

    /// Returns the time in seconds at which an idle bus suspends the core.
    pub(crate) fn next_s(&self) -> f64 {
        if self.is_attached() && !self.suspended { self.active_s + IDLE_S } else { f64::INFINITY }
    }

    /// Suspends the core, if the bus has been idle for 3 ms.
    pub(crate) fn look_for_suspend(&mut self, now_s: f64) {
        if now_s >= self.next_s() {
            self.suspended = true;
            self.flags |= flag::ESUSP | flag::USBSUSP;
        }
    }

    /// Notes that the bus is active until `until_s`.
    fn active(&mut self, until_s: f64) {
        if std::mem::take(&mut self.suspended) {
            self.flags |= flag::WKUPINT;
        }
        self.active_s = self.active_s.max(until_s);
    }

    /// Begins a reset of the bus that ends at `until_s`.
    pub(crate) fn begin_reset(&mut self, until_s: f64) {
        self.suspended = false;
        self.active_s = until_s;
        self.flags |= flag::USBRST;
        self.address = 0;
        self.device_config &= !(0x7f << 4);
        self.setup_is_open = false;
        self.inputs.iter_mut().for_each(super::In::bus_reset);
        self.outputs.iter_mut().for_each(super::Out::bus_reset);
    }

    /// Ends a reset of the bus: the speed is known.
    pub(crate) fn end_reset(&mut self) {
        self.flags |= flag::ENUMDNE;
    }

    /// Wakes the core by a signal on the bus that ends at `until_s`.
    pub(crate) fn resume(&mut self, until_s: f64) {
        self.active(until_s);
    }

    /// Takes the start of a frame.
    pub(crate) fn start_frame(&mut self, frame: u16, now_s: f64) {
        self.active(now_s);
        self.frame = frame;
        self.flags |= flag::SOF;
    }

    /// Checks what every packet to the core asks of the program: a turnaround time for its clock.
    fn check(&self, context: &Context<'_>) -> Access<()> {
        let turnaround = self.config >> 10 & 0xf;
        // RM0090 table 204: 6 for an AHB clock of 32 MHz and more.
        if context.clocks.core >= Frequency::hz(32_000_000) && turnaround < 6 {
            let reason = format!("GUSBCFG.TRDT is {turnaround}; an AHB clock of {} needs 6", context.clocks.core);
            return Err(Problem::Misuse { reason });
        }
        Ok(())
    }

    fn is_addressed(&self, address: u8, endpoint: usize) -> bool {
        self.address == address && endpoint < ENDPOINTS
    }

    /// Takes a SETUP packet for endpoint 0.
    pub(crate) fn setup(&mut self, address: u8, data: [u8; 8], context: &Context<'_>) -> Access<Answer> {
        self.active(context.seconds);
        if !self.is_addressed(address, 0) || !self.received.has_room(8) {
            return Ok(Answer::Silence);
        }
        self.check(context)?;
        self.inputs[0].setup();
        self.outputs[0].setup();
        self.received.push(0, Status::Setup, false, &data);
        self.setup_is_open = true;
        Ok(Answer::Ack)
    }

    /// Tells the program of the end of a SETUP phase, at the first packet behind it.
    fn end_setup(&mut self, endpoint: usize) {
        if endpoint == 0 && std::mem::take(&mut self.setup_is_open) {
            self.received.push(0, Status::SetupDone, false, &[]);
        }
    }

    /// Takes an OUT packet. `odd` is true for DATA1.
    pub(crate) fn output(
        &mut self,
        address: u8,
        endpoint: usize,
        odd: bool,
        data: &[u8],
        context: &Context<'_>,
    ) -> Access<Answer> {
        self.active(context.seconds);
        if !self.is_addressed(address, endpoint) || !self.outputs[endpoint].is_active() {
            return Ok(Answer::Silence);
        }
        self.check(context)?;
        self.end_setup(endpoint);
        if self.outputs[endpoint].is_stalled() {
            return Ok(Answer::Stall);
        }
        let (takes, expected) = self.outputs[endpoint].takes();
        if !takes || !self.received.has_room(data.len()) {
            return Ok(Answer::Nak);
        }
        if odd != expected {
            // A packet that came before: its acknowledgement was lost.
            return Ok(Answer::Ack);
        }
        self.received.push(endpoint, Status::OutData, odd, data);
        if self.outputs[endpoint].take(data.len()) {
            self.received.push(endpoint, Status::OutDone, odd, &[]);
        }
        Ok(Answer::Ack)
    }

    /// Answers an IN token.
    pub(crate) fn input(&mut self, address: u8, endpoint: usize, context: &Context<'_>) -> Access<Answer> {
        self.active(context.seconds);
        if !self.is_addressed(address, endpoint) || !self.inputs[endpoint].is_active() {
            return Ok(Answer::Silence);
        }
        self.check(context)?;
        self.end_setup(endpoint);
        let input = &mut self.inputs[endpoint];
        if input.is_stalled() {
            return Ok(Answer::Stall);
        }
        let fifo = input.fifo();
        let data = input.next_bytes().and_then(|bytes| self.transmit[fifo].peek(bytes));
        if data.is_none() {
            input.interrupts |= ITTXFE;
        }
        Ok(data.map_or(Answer::Nak, |data| Answer::Data(data, input.is_odd())))
    }

    /// Takes the host's acknowledgement of a packet of `bytes` bytes.
    pub(crate) fn acknowledge(&mut self, endpoint: usize, bytes: usize) {
        let input = &mut self.inputs[endpoint];
        input.sent(bytes);
        self.transmit[input.fifo()].remove(bytes);
        if endpoint == 0 {
            self.address = (self.device_config >> 4 & 0x7f) as u8;
        }
    }

    /// Notes that the program has read a status of the receive FIFO.
    pub(super) fn status_read(&mut self, endpoint: usize, status: Status) {
        match status {
            Status::OutDone => self.outputs[endpoint].interrupts |= XFRC,
            Status::SetupDone => self.outputs[endpoint].interrupts |= STUP,
            Status::OutData | Status::Setup => {}
        }
    }
}
