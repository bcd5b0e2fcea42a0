//! Passing of time: the events of the devices in the order of their times, and the DMA transfers
//! that they request.

use virtual_core::{CCM_ADDRESS, CCM_BYTES, Machine};

use super::dma::{COMPLETE, HALF, Item};
use super::gpio::Mode;
use super::pins::SUPPLY;
use super::recording::AudioHalf;
use super::{Context, Devices, Problem};

/// Code of the 12-bit ADC at half the supply.
const MIDDLE: f32 = 2048.0;
/// Volts of a code of the 12-bit ADC.
const VOLTS_A_COUNT: f64 = SUPPLY / 4095.0;
/// Codes of the 12-bit ADC from the middle to full scale.
const SCALE: f32 = 2047.0;

/// Source of DMA requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Request {
    Adc,
    /// The I2S of SPI2 (0) or SPI3 (1).
    I2s(u8),
}

impl Request {
    /// Returns the streams that can serve the source, as controller (0 is DMA1), stream and channel
    /// (RM0090 tables 42 and 43).
    fn streams(self) -> &'static [(u8, u8, u32)] {
        match self {
            Request::Adc => &[(1, 0, 0), (1, 4, 0)],
            Request::I2s(0) => &[(0, 4, 0)],
            Request::I2s(_) => &[(0, 5, 0), (0, 7, 0)],
        }
    }
}

impl Devices {
    /// Returns the cycle of the next event of any device.
    pub(crate) fn next_event(&self) -> u64 {
        let timers = self.timers.iter().map(|timer| timer.next_event());
        let i2s = self.i2s.iter().map(|i2s| i2s.next_event());
        let others = [self.adc.next_event(), self.i2c.next_event(), self.next_usb_event(), self.flash.next_event()];
        timers.chain(i2s).chain(others).min().unwrap_or(u64::MAX)
    }

    /// Returns the cycle at which the watchdog resets the chip.
    pub(crate) fn watchdog_due(&self) -> u64 {
        self.watchdog.next_event()
    }

    /// Lets all events up to `now` happen and serves the DMA.
    pub(crate) fn advance(&mut self, now: u64, machine: &mut Machine) -> Result<(), (&'static str, Problem)> {
        self.serve_dma(now, machine)?;
        loop {
            let due = self.next_event();
            if due > now {
                return Ok(());
            }
            self.fire(due)?;
            self.end_flash_operation(due, machine);
            self.serve_dma(due, machine)?;
        }
    }

    /// Lets all events at the cycle `due` happen.
    fn fire(&mut self, due: u64) -> Result<(), (&'static str, Problem)> {
        let clocks = self.clocks;
        let context = Context { now: due, seconds: self.seconds(due), clocks: &clocks };
        for index in 0..self.timers.len() {
            if self.timers[index].next_event() <= due {
                let mut outputs = Vec::new();
                self.timers[index].fire(&context, |output| outputs.push(output));
                for output in outputs {
                    self.adc.triggered(index as u8 + 2, output, &context).map_err(|problem| ("ADC1", problem))?;
                }
            }
        }
        if self.adc.next_event() <= due {
            let mut adc = std::mem::take(&mut self.adc);
            let mut warning = None;
            adc.fire(|channel| self.code(channel, context.seconds, &mut warning));
            self.adc = adc;
            if let Some(warning) = warning {
                self.recording.warn(&warning);
            }
        }
        for index in 0..self.i2s.len() {
            if self.i2s[index].next_event() <= due {
                let wired = index + 2 == usize::from(self.wiring.i2s);
                let connected = wired && self.audio_is_connected();
                self.i2s[index].fire(|| connected);
                if !connected {
                    self.recording.warn(
                        "the I2S runs, its pins do not have its alternate function or are not those of the board",
                    );
                }
            }
        }
        if self.i2c.next_event() <= due {
            self.fire_i2c(&context);
        }
        if self.next_usb_event() <= due {
            self.fire_usb(&context)?;
        }
        Ok(())
    }

    fn fire_i2c(&mut self, context: &Context<'_>) {
        let pins = self.wiring.codec;
        let connected = pins.is_some_and(|pins| self.is_alternate(pins.clock, 4) && self.is_alternate(pins.data, 4));
        let master_clock_runs = self.master_clock_runs();
        let codec = self.codec.as_mut().filter(|_| connected);
        self.i2c.fire(codec, master_clock_runs, context);
        self.mute_changed(context.now);
    }

    /// Returns the 12-bit code of a channel of the ADC.
    ///
    /// It is 0, with a warning, if no piezo is wired to the channel or its pin is not analog.
    fn code(&mut self, channel: u8, seconds: f64, warning: &mut Option<String>) -> u16 {
        let Some(piezo) = self.wiring.piezos.iter().position(|piezo| piezo.0 == channel) else {
            *warning = Some(format!("ADC1 converts channel {channel}, to which nothing is wired"));
            return 0;
        };
        let (_, pin) = self.wiring.piezos[piezo];
        let mode = self.ports[usize::from(pin.port)].mode(pin.number);
        if mode != Mode::Analog {
            *warning =
                Some(format!("ADC1 converts {pin}, a piezo's pin, while it is {mode} and not analog; it reads 0"));
            return 0;
        }
        if self.armed.piezos_at_rail & 1 << piezo != 0 {
            return 0xfff;
        }
        let level: f32 =
            self.piezos.iter().filter(|signal| signal.piezo == piezo).map(|signal| signal.at(seconds)).sum();
        self.pins.sample(piezo, f64::from(MIDDLE + level * SCALE) * VOLTS_A_COUNT, seconds)
    }

    /// Returns the controller and stream that serve the board's I2S, if one is enabled.
    pub(crate) fn audio_stream(&self) -> Option<(u8, u8)> {
        self.stream(Request::I2s(self.wiring.i2s - 2))
    }

    /// Returns the controller and stream that serve a source, if one is enabled.
    fn stream(&self, request: Request) -> Option<(u8, u8)> {
        let to_peripheral = request != Request::Adc;
        let serving = request.streams().iter().find(|&&(controller, stream, channel)| {
            let stream = &self.dma[usize::from(controller)].streams[usize::from(stream)];
            stream.is_enabled() && stream.channel() == channel && stream.is_to_peripheral() == to_peripheral
        });
        serving.map(|&(controller, stream, _)| (controller, stream))
    }

    fn serve_dma(&mut self, now: u64, machine: &mut Machine) -> Result<(), (&'static str, Problem)> {
        for request in [Request::Adc, Request::I2s(0), Request::I2s(1)] {
            loop {
                let asks = match request {
                    Request::Adc => self.adc.requests_dma(),
                    Request::I2s(index) => self.i2s[usize::from(index)].requests_dma(),
                };
                if !asks {
                    break;
                }
                let Some((controller, stream)) = self.stream(request) else { break };
                self.transfer(request, usize::from(controller), usize::from(stream), now, machine)
                    .map_err(|problem| (if controller == 0 { "DMA1" } else { "DMA2" }, problem))?;
            }
        }
        Ok(())
    }

    fn transfer(
        &mut self,
        request: Request,
        controller: usize,
        stream: usize,
        now: u64,
        machine: &mut Machine,
    ) -> Result<(), Problem> {
        let is_audio = request == Request::I2s(self.wiring.i2s - 2);
        if request == Request::Adc && std::mem::take(&mut self.armed.adc_overrun) {
            self.adc.overrun();
            return Ok(());
        }
        let fails = match request {
            Request::Adc => std::mem::take(&mut self.armed.adc_dma_error),
            _ => is_audio && std::mem::take(&mut self.armed.audio_dma_error),
        };
        let item = self.dma[controller].streams[stream].item();
        // DMA does not reach the core-coupled memory.
        let unreachable = item.memory.wrapping_sub(CCM_ADDRESS) < CCM_BYTES;
        if unreachable {
            self.recording.warn(&format!("a DMA stream reaches for {:#010x}, in the core-coupled memory", item.memory));
        }
        // An error of the item after this one: the stream fetches ahead.
        let moved = !unreachable && self.move_item(item, machine)?;
        if fails || !moved {
            self.dma[controller].streams[stream].fail();
            return Ok(());
        }
        let pending = self.dma[controller].streams[stream].flags & (HALF | COMPLETE) != 0;
        let raised = self.dma[controller].streams[stream].moved();
        if is_audio && raised != 0 {
            self.recording.audio_halves.push(AudioHalf { cycle: now, late: pending });
        }
        if request == Request::Adc && raised & COMPLETE != 0 {
            self.adc.dma_complete();
        }
        Ok(())
    }

    /// Moves an item; returns false if no memory is at its address.
    fn move_item(&mut self, item: Item, machine: &mut Machine) -> Result<bool, Problem> {
        let mut bytes = [0; 4];
        let width = item.bytes as usize;
        if item.to_peripheral {
            if machine.read(item.memory, &mut bytes[..width]).is_err() {
                return Ok(false);
            }
            self.write(item.peripheral, u32::from_le_bytes(bytes))?;
            return Ok(true);
        }
        let value = self.read(item.peripheral)?;
        bytes.copy_from_slice(&value.to_le_bytes());
        Ok(machine.write(item.memory, &bytes[..width]).is_ok())
    }

    /// Passes the levels of the pins to EXTI, the LEDs, the codec's reset and the mute pin.
    pub(crate) fn pins_changed(&mut self, now: u64) {
        let at_s = self.seconds(now);
        for (piezo, (_, pin)) in self.wiring.piezos.iter().enumerate() {
            let port = &self.ports[usize::from(pin.port)];
            self.pins.set_pull(piezo, port.mode(pin.number), port.pull(pin.number), at_s);
        }
        let levels = self.exti_levels();
        self.exti.edges(self.watched_levels, levels);
        self.watched_levels = levels;
        let lit = self.wiring.leds.iter().map(|led| {
            let port = &self.ports[usize::from(led.pin.port)];
            port.mode(led.pin.number) == Mode::Output && port.is_driven_high(led.pin.number) == led.lit_by_high
        });
        self.recording.leds_changed(at_s, lit);
        if let (Some(pins), Some(codec)) = (self.wiring.codec, &mut self.codec) {
            codec.set_reset_pin(self.ports[usize::from(pins.reset.port)].is_driven_high(pins.reset.number));
        }
        self.mute_changed(now);
        self.usb_pins_changed(now);
    }

    /// Returns the levels of the pins that the lines of EXTI watch, as bits.
    pub(super) fn exti_levels(&self) -> u32 {
        let level = |line: u8| self.ports[usize::from(self.syscfg.port(line)).min(8)].levels() & 1 << line;
        (0..16).map(level).sum()
    }

    /// Records if the converter is mute now, and how loud its headphones are.
    fn mute_changed(&mut self, now: u64) {
        let pin_is_low = |pin: super::Pin| !self.ports[usize::from(pin.port)].is_driven_high(pin.number);
        let mute = self.codec.as_ref().is_some_and(|codec| !codec.sounds()) || self.wiring.mute.is_some_and(pin_is_low);
        let at_s = self.seconds(now);
        self.recording.mute_changed(at_s, mute);
        if let Some(codec) = &self.codec {
            self.recording.volume_changed(at_s, codec.headphones_db());
        }
    }
}
