//! The codec CS43L22 of the STM32F407G-DISC1 at I2C address 0x4A, as far as a driver can be wrong about it: reset pin, identity, the
//! start-up sequence of its data sheet (sections 4.9 and 4.11), interface format, clocks, power and mute bits.

/// Its 7-bit address on the bus.
pub(crate) const ADDRESS: u8 = 0x4a;

const ID: u8 = 0x01;
const POWER_1: u8 = 0x02;
const POWER_2: u8 = 0x04;
const INTERFACE: u8 = 0x06;
const REGISTERS: usize = 0x48;

/// Powered up, for register 0x02.
const POWERED_UP: u8 = 0x9e;

/// The writes that the data sheet asks for before power-up: register, mask, value.
const INITIALISATION: [(u8, u8, u8); 5] =
    [(0x00, 0xff, 0x99), (0x47, 0x80, 0x80), (0x32, 0x80, 0x80), (0x32, 0x80, 0x00), (0x00, 0xff, 0x00)];

/// The codec behind its bus and its reset pin.
#[derive(Debug)]
pub(crate) struct Codec {
    registers: [u8; REGISTERS],
    out_of_reset: bool,
    answering: bool,
    initialised: usize,
    pointer: Option<u8>,
    /// What the driver did wrong, in words.
    pub(crate) complaints: Vec<String>,
}

impl Codec {
    pub(crate) fn new(answering: bool) -> Codec {
        let mut codec = Codec {
            registers: [0; REGISTERS],
            out_of_reset: false,
            answering,
            initialised: 0,
            pointer: None,
            complaints: Vec::new(),
        };
        codec.reset();
        codec
    }

    fn reset(&mut self) {
        self.registers = [0; REGISTERS];
        for (register, value) in [
            (ID, 0xe3),
            (POWER_1, 0x01),
            (POWER_2, 0x05),
            (0x05, 0xa0),
            (0x0a, 0xa5),
            (0x0d, 0x60),
            (0x0e, 0x02),
            (0x1f, 0x88),
            (0x27, 0x00),
            (0x32, 0x3b),
        ] {
            self.registers[usize::from(register)] = value;
        }
        self.initialised = 0;
        self.pointer = None;
    }

    /// The level of its reset pin (active low).
    pub(crate) fn set_reset_pin(&mut self, high: bool) {
        if !high && self.out_of_reset {
            self.reset();
        }
        self.out_of_reset = high;
    }

    /// A start condition with its address was seen; whether it acknowledges.
    pub(crate) fn addressed(&mut self, reading: bool) -> bool {
        if !reading {
            self.pointer = None;
        }
        self.answering && self.out_of_reset
    }

    /// A byte from the driver; whether it acknowledges. `master_clock_runs`: MCLK is on its pin.
    pub(crate) fn write(&mut self, byte: u8, master_clock_runs: bool) -> bool {
        if !self.answering || !self.out_of_reset {
            return false;
        }
        let Some(register) = self.pointer else {
            self.pointer = Some(byte);
            return true;
        };
        self.pointer = if register & 0x80 != 0 { Some(0x80 | (register + 1) & 0x7f) } else { Some(register) };
        let register = register & 0x7f;
        let Some(place) = self.registers.get_mut(usize::from(register)) else {
            self.complaints.push(format!("the codec has no register {register:#04x}"));
            return true;
        };
        if register == ID {
            self.complaints.push("the codec's identity register is written".to_owned());
            return true;
        }
        *place = byte;
        if let Some(&(expected, mask, value)) = INITIALISATION.get(self.initialised)
            && (expected, value) == (register, byte & mask)
        {
            self.initialised += 1;
        }
        if register == POWER_1 && byte == POWERED_UP {
            self.check_power_up(master_clock_runs);
        }
        true
    }

    /// The next byte for the driver.
    pub(crate) fn read(&mut self) -> u8 {
        let pointer = self.pointer.unwrap_or(0);
        let value = self.registers.get(usize::from(pointer & 0x7f)).copied().unwrap_or(0);
        if pointer & 0x80 != 0 {
            self.pointer = Some(0x80 | (pointer + 1) & 0x7f);
        }
        value
    }

    fn check_power_up(&mut self, master_clock_runs: bool) {
        if self.initialised < INITIALISATION.len() {
            let (register, _, value) = INITIALISATION[self.initialised];
            self.complaints.push(format!(
                "the codec is powered up before its initialisation is complete: next is {value:#04x} to register {register:#04x} \
                 (CS43L22 data sheet 4.11)"
            ));
        }
        if !master_clock_runs {
            self.complaints.push("the codec is powered up without MCLK (CS43L22 data sheet 4.9)".to_owned());
        }
        let interface = self.registers[usize::from(INTERFACE)];
        if interface & 0x80 != 0 {
            self.complaints.push("the codec is told to be the master of the I2S, which the chip already is".to_owned());
        }
        if interface & 0x0c != 0x04 {
            self.complaints.push(format!(
                "the codec's interface register {interface:#04x} does not select I2S (bits 3:2 must be 01)"
            ));
        }
    }

    /// Whether it is powered up and some output is on.
    pub(crate) fn sounds(&self) -> bool {
        let headphone_or_speaker_on = self.registers[usize::from(POWER_2)] != 0xff;
        self.out_of_reset && self.registers[usize::from(POWER_1)] == POWERED_UP && headphone_or_speaker_on
    }
}
