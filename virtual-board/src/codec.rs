//! Codec CS43L22 of the STM32F407G-DISC1, as far as a driver can be wrong about it.
//!
//! It has the reset pin, the registers with their reset values and reserved bits (data sheet,
//! sections 6 and 7), the start-up sequence (sections 4.9 and 4.11), interface format, clocks, and
//! what decides how loud the headphones are: power states, mute bits and volumes.

/// Address of the codec on the I2C bus, 7 bits.
pub(crate) const ADDRESS: u8 = 0x4a;

const ID: u8 = 0x01;
const POWER_1: u8 = 0x02;
const POWER_2: u8 = 0x04;
const INTERFACE: u8 = 0x06;
const PLAYBACK_1: u8 = 0x0d;
const MISCELLANEOUS: u8 = 0x0e;
const PLAYBACK_2: u8 = 0x0f;
const PCM_VOLUME: u8 = 0x1a;
const MASTER_VOLUME: u8 = 0x20;
const HEADPHONE_VOLUME: u8 = 0x22;
const REGISTERS: usize = 0x48;

/// Registers: number, reset value, and bits that a driver may change. The others are read-only or
/// reserved. Registers 0x00, 0x32 and 0x47 are for the initialisation alone.
const MAP: [(u8, u8, u8); 39] = [
    (0x00, 0x00, 0xff),
    (ID, 0xe3, 0x00),
    (POWER_1, 0x01, 0xff),
    (POWER_2, 0x05, 0xff),
    (0x05, 0xa0, 0xff),
    (INTERFACE, 0x00, 0xdf),
    (0x07, 0x00, 0x40),
    (0x08, 0x81, 0x0f),
    (0x09, 0x81, 0x0f),
    (0x0a, 0xa5, 0x0f),
    (0x0c, 0x00, 0x80),
    (PLAYBACK_1, 0x60, 0xff),
    (MISCELLANEOUS, 0x02, 0xff),
    (PLAYBACK_2, 0x00, 0xff),
    (0x14, 0x00, 0xff),
    (0x15, 0x00, 0xff),
    (PCM_VOLUME, 0x00, 0xff),
    (PCM_VOLUME + 1, 0x00, 0xff),
    (0x1c, 0x00, 0xff),
    (0x1d, 0x00, 0xff),
    (0x1e, 0x00, 0xdf),
    (0x1f, 0x88, 0xff),
    (MASTER_VOLUME, 0x00, 0xff),
    (MASTER_VOLUME + 1, 0x00, 0xff),
    (HEADPHONE_VOLUME, 0x00, 0xff),
    (HEADPHONE_VOLUME + 1, 0x00, 0xff),
    (0x24, 0x00, 0xff),
    (0x25, 0x00, 0xff),
    (0x26, 0x00, 0xff),
    (0x27, 0x00, 0xff),
    (0x28, 0x7f, 0xff),
    (0x29, 0xc0, 0x3f),
    (0x2e, 0x00, 0x00),
    (0x2f, 0x00, 0xcf),
    (0x30, 0x00, 0x00),
    (0x31, 0x00, 0x00),
    (0x32, 0x3b, 0x80),
    (0x34, 0x5f, 0xf0),
    (0x47, 0x00, 0x80),
];

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
        for (register, value, _) in MAP {
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
        let known = MAP.iter().find(|known| known.0 == register);
        let Some(&(_, _, changeable)) = known.filter(|known| known.2 != 0) else {
            self.complain(format!("register {register:#04x} of the codec is read-only or reserved, and is written"));
            return true;
        };
        let before = self.registers[usize::from(register)];
        self.registers[usize::from(register)] = before & !changeable | byte & changeable;
        if (before ^ byte) & !changeable != 0 {
            self.complain(format!(
                "register {register:#04x} of the codec, {before:#04x}, is written with {byte:#04x}; only the bits \
                 {changeable:#04x} may change"
            ));
        }
        self.check_volume(register, byte);
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

    /// Complains of a code of a volume that the data sheet does not define.
    fn check_volume(&mut self, register: u8, byte: u8) {
        // Half decibels: of the headphones down to -102 dB, and 0x01 for mute.
        if matches!(register, HEADPHONE_VOLUME..=0x25) && matches!(byte, 0x02..0x34) {
            self.complain(format!("the codec's volume register {register:#04x} has no code {byte:#04x}"));
        }
    }

    /// Returns the level in dB at which the headphones play full scale, left and right; `None` for
    /// a side that is mute.
    pub(crate) fn headphones_db(&self) -> [Option<f64>; 2] {
        [0, 1].map(|side| self.headphone_db(side))
    }

    /// Returns the level of the left (0) or right (1) headphone.
    fn headphone_db(&self, side: u8) -> Option<f64> {
        let register = |first: u8| self.registers[usize::from(first + side)];
        let bit = |at: u8, bit: u8| self.registers[usize::from(at)] >> (bit + side) & 1 != 0;
        let powered = self.out_of_reset && self.registers[usize::from(POWER_1)] == POWERED_UP;
        // 10 is on, 11 off; by 00 and 01 a pin decides, which the board does not use.
        let on = self.registers[usize::from(POWER_2)] >> (4 + 2 * side) & 3 == 2;
        let pcm = register(PCM_VOLUME);
        let muted = bit(PLAYBACK_1, 0) || bit(PLAYBACK_2, 6) || pcm & 0x80 != 0 || register(HEADPHONE_VOLUME) == 0x01;
        if !powered || !on || muted {
            return None;
        }
        // Half decibels; codes of the PCM volume have 7 bits. Up to 0x18 they raise the level.
        let halves = |code: u8, bits: u32| {
            let code = i32::from(code);
            if code <= 0x18 { code } else { code - (1 << bits) }
        };
        let all = halves(pcm & 0x7f, 7) + halves(register(MASTER_VOLUME), 8) + halves(register(HEADPHONE_VOLUME), 8);
        Some(0.5 * f64::from(all))
    }

    /// Returns true if a headphone can be heard.
    pub(crate) fn sounds(&self) -> bool {
        self.headphones_db().iter().any(Option::is_some)
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
        send(&mut codec, POWER_2, 0xaf, master_clock_runs);
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
    fn each_write_is_judged_by_the_bits_that_a_driver_may_change() {
        for (register, good, bad) in
            [(0x32, 0xbb, 0x80), (INTERFACE, 0x04, 0x24), (0x29, 0xc5, 0x05), (0x34, 0x6f, 0x60)]
        {
            let mut codec = Codec::new(true);
            codec.set_reset_pin(true);
            send(&mut codec, register, good, true);
            assert!(codec.complaints.is_empty(), "{:?}", codec.complaints);
            send(&mut codec, register, bad, true);
            assert!(codec.complaints[0].contains("may change"), "{:?}", codec.complaints);
        }
        for register in [ID, 0x0b, 0x2e, 0x33, 0x60] {
            let mut codec = Codec::new(true);
            codec.set_reset_pin(true);
            send(&mut codec, register, 0, true);
            assert!(codec.complaints[0].contains("read-only or reserved"), "{:?}", codec.complaints);
        }
    }

    #[test]
    fn the_level_of_the_headphones_follows_power_mutes_and_volumes() {
        let mut codec = started(None, true);
        assert_eq!(codec.headphones_db(), [Some(0.0); 2]);
        for (register, byte, levels) in [
            (HEADPHONE_VOLUME, 0xe8, [Some(-12.0), Some(0.0)]),
            (HEADPHONE_VOLUME + 1, 0x34, [Some(-12.0), Some(-102.0)]),
            (MASTER_VOLUME + 1, 0x18, [Some(-12.0), Some(-90.0)]),
            (PCM_VOLUME, 0x7f, [Some(-12.5), Some(-90.0)]),
            (PCM_VOLUME, 0x80, [None, Some(-90.0)]),
            (PCM_VOLUME, 0x00, [Some(-12.0), Some(-90.0)]),
            (HEADPHONE_VOLUME + 1, 0x01, [Some(-12.0), None]),
            (HEADPHONE_VOLUME + 1, 0x00, [Some(-12.0), Some(12.0)]),
            (PLAYBACK_1, 0x62, [Some(-12.0), None]),
            (PLAYBACK_1, 0x60, [Some(-12.0), Some(12.0)]),
            (PLAYBACK_2, 0x40, [None, Some(12.0)]),
            (PLAYBACK_2, 0x00, [Some(-12.0), Some(12.0)]),
            (POWER_2, 0xef, [Some(-12.0), None]),
            (POWER_1, 0x9f, [None; 2]),
        ] {
            send(&mut codec, register, byte, true);
            assert_eq!(codec.headphones_db(), levels, "{byte:#04x} to {register:#04x}");
        }
        assert!(codec.complaints.is_empty(), "{:?}", codec.complaints);
        send(&mut codec, HEADPHONE_VOLUME, 0x20, true);
        assert!(codec.complaints[0].contains("no code 0x20"), "{:?}", codec.complaints);
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
