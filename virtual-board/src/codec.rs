//! Codec CS43L22 of the STM32F407G-DISC1, as far as a driver can be wrong about it.
//!
//! It has the reset pin, the identity, the start-up sequence of the data sheet (sections 4.9 and
//! 4.11), interface format, clocks, and power and mute bits.

/// Address of the codec on the I2C bus, 7 bits.
pub(crate) const ADDRESS: u8 = 0x4a;

const ID: u8 = 0x01;
const POWER_1: u8 = 0x02;
const POWER_2: u8 = 0x04;
const INTERFACE: u8 = 0x06;
/// Register without a name in the data sheet: the initialisation sets and clears bit 7.
const UNNAMED: u8 = 0x32;
const REGISTERS: usize = 0x48;

/// Value of register 0x02 that powers the codec up.
const POWERED_UP: u8 = 0x9e;

/// Writes that the data sheet requires before power-up: register, mask, value.
const INITIALISATION: [(u8, u8, u8); 5] =
    [(0x00, 0xff, 0x99), (0x47, 0x80, 0x80), (0x32, 0x80, 0x80), (0x32, 0x80, 0x00), (0x00, 0xff, 0x00)];

/// Codec behind its bus and its reset pin.
#[derive(Debug)]
pub(crate) struct Codec {
    registers: [u8; REGISTERS],
    out_of_reset: bool,
    /// True if the codec acknowledges anything.
    answering: bool,
    /// Number of steps of [`INITIALISATION`] that have been done.
    initialised: usize,
    /// Register that is accessed next, with the increment bit, or `None` before it is written.
    pointer: Option<u8>,
    /// Faults of the driver, as sentences.
    pub(crate) complaints: Vec<String>,
}

impl Codec {
    /// Makes a codec in reset. A codec that is not `answering` acknowledges nothing.
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

    /// Sets the level of the reset pin, which is active low.
    pub(crate) fn set_reset_pin(&mut self, high: bool) {
        if !high && self.out_of_reset {
            self.reset();
        }
        self.out_of_reset = high;
    }

    /// Takes a start condition with the codec's address; returns true if the codec acknowledges it.
    pub(crate) fn addressed(&mut self, reading: bool) -> bool {
        if !reading {
            self.pointer = None;
        }
        self.answering && self.out_of_reset
    }

    /// Takes a byte from the driver; returns true if the codec acknowledges it.
    ///
    /// `master_clock_runs` is true if MCLK is on its pin.
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
        if usize::from(register) >= REGISTERS {
            self.complain(format!("the codec has no register {register:#04x}"));
            return true;
        }
        if register == ID {
            self.complain("the codec's identity register is written".to_owned());
            return true;
        }
        let before = std::mem::replace(&mut self.registers[usize::from(register)], byte);
        if register == UNNAMED && (before ^ byte) & 0x7f != 0 {
            self.complain(format!(
                "register {register:#04x} of the codec becomes {byte:#04x} from {before:#04x}; only bit 7 is to change \
                 (CS43L22 data sheet 4.11)"
            ));
        }
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

    /// Returns the next byte for the driver.
    pub(crate) fn read(&mut self) -> u8 {
        let pointer = self.pointer.unwrap_or(0);
        let value = self.registers.get(usize::from(pointer & 0x7f)).copied().unwrap_or(0);
        if pointer & 0x80 != 0 {
            self.pointer = Some(0x80 | (pointer + 1) & 0x7f);
        }
        value
    }

    fn complain(&mut self, complaint: String) {
        if !self.complaints.contains(&complaint) {
            self.complaints.push(complaint);
        }
    }

    fn check_power_up(&mut self, master_clock_runs: bool) {
        if self.initialised < INITIALISATION.len() {
            let (register, _, value) = INITIALISATION[self.initialised];
            self.complain(format!(
                "the codec is powered up before its initialisation is complete: next is {value:#04x} to register {register:#04x} \
                 (CS43L22 data sheet 4.11)"
            ));
        }
        if !master_clock_runs {
            self.complain("the codec is powered up without MCLK (CS43L22 data sheet 4.9)".to_owned());
        }
        let interface = self.registers[usize::from(INTERFACE)];
        if interface & 0x80 != 0 {
            self.complain("the codec is told to be the master of the I2S, which the chip already is".to_owned());
        }
        if interface & 0x0c != 0x04 {
            self.complain(format!(
                "the codec's interface register {interface:#04x} does not select I2S (bits 3:2 must be 01)"
            ));
        }
    }

    /// Returns true if the codec is powered up and an output is on.
    pub(crate) fn sounds(&self) -> bool {
        let headphone_or_speaker_on = self.registers[usize::from(POWER_2)] != 0xff;
        self.out_of_reset && self.registers[usize::from(POWER_1)] == POWERED_UP && headphone_or_speaker_on
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn send(codec: &mut Codec, register: u8, byte: u8, master_clock_runs: bool) {
        assert!(codec.addressed(false));
        assert!(codec.write(register, master_clock_runs) && codec.write(byte, master_clock_runs));
    }

    fn started(skip: Option<usize>, master_clock_runs: bool) -> Codec {
        let mut codec = Codec::new(true);
        codec.set_reset_pin(true);
        let sequence = [(0x00, 0x99), (0x47, 0x80), (0x32, 0xbb), (0x32, 0x3b), (0x00, 0x00), (0x06, 0x04)];
        for (index, (register, byte)) in sequence.into_iter().enumerate() {
            if Some(index) != skip {
                send(&mut codec, register, byte, master_clock_runs);
            }
        }
        send(&mut codec, POWER_1, POWERED_UP, master_clock_runs);
        codec
    }

    #[test]
    fn the_start_up_sequence_of_the_data_sheet_is_accepted() {
        let codec = started(None, true);
        assert!(codec.complaints.is_empty() && codec.sounds(), "{:?}", codec.complaints);
    }

    #[test]
    fn each_step_that_is_left_out_is_named() {
        for skip in 0..6 {
            let codec = started(Some(skip), true);
            assert_eq!(codec.complaints.len(), 1, "step {skip}: {:?}", codec.complaints);
        }
        assert!(started(None, false).complaints[0].contains("without MCLK"));
    }

    #[test]
    fn a_write_to_register_0x32_that_changes_more_than_bit_7_is_named() {
        let mut codec = Codec::new(true);
        codec.set_reset_pin(true);
        send(&mut codec, UNNAMED, 0xbb, true);
        assert!(codec.complaints.is_empty());
        send(&mut codec, UNNAMED, 0x80, true);
        assert!(codec.complaints[0].contains("only bit 7"), "{:?}", codec.complaints);
    }

    #[test]
    fn a_codec_in_reset_is_mute_and_does_not_answer() {
        let mut codec = started(None, true);
        codec.set_reset_pin(false);
        assert!(!codec.sounds() && !codec.addressed(false) && !codec.write(2, true));
        codec.set_reset_pin(true);
        assert!(codec.addressed(true) && !codec.sounds());
    }

    #[test]
    fn the_identity_can_be_read_in_a_row_of_registers() {
        let mut codec = Codec::new(true);
        codec.set_reset_pin(true);
        assert!(codec.addressed(false) && codec.write(0x80 | ID, true) && codec.addressed(true));
        assert_eq!([codec.read(), codec.read()], [0xe3, 0x01]);
    }
}
