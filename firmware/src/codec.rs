//! The CS43L22 headphone codec over I2C (datasheet DS792, sections 4.9 to 4.11 and 7).

use embassy_stm32::gpio::Output;
use embassy_stm32::i2c::{self, I2c, Master};
use embassy_stm32::mode::Blocking;
use embassy_time::{Duration, block_for};

/// I2C address of the codec, 7 bits.
const ADDRESS: u8 = 0x4A;

/// Number of the register that holds the chip id in bits 7 to 3.
const ID: u8 = 0x01;
/// Chip id of a CS43L22.
const CHIP_ID: u8 = 0b11100 << 3;

/// Registers, bits and their values that are written before power-up, in this order. Other bits
/// keep what the reset left there.
///
/// First come the initialisation settings that the datasheet requires (section 4.11), of which two
/// concern bit 7 of a register alone. Then the headphones are switched on by their pin and the
/// speakers off. The codec detects its clock, takes I2S of up to 24 bits, and plays the headphones
/// 12 dB down.
const BEFORE_POWER_UP: [(u8, u8, u8); 11] = [
    (0x02, ALL, 0x01),
    (0x00, ALL, 0x99),
    (0x47, ALL, 0x80),
    (0x32, 0x80, 0x80),
    (0x32, 0x80, 0x00),
    (0x00, ALL, 0x00),
    (0x04, ALL, 0xAF),
    (0x05, ALL, 0x81),
    (0x06, ALL, 0x04),
    (0x22, ALL, 0xE8),
    (0x23, ALL, 0xE8),
];
/// All bits of a register.
const ALL: u8 = 0xFF;
/// Register, bits and value that power the codec up.
const POWER_UP: (u8, u8, u8) = (0x02, ALL, 0x9E);

/// Reason for which the codec does not play.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum Error {
    /// The codec did not acknowledge an access: it may lack power or a wire.
    NotAnswering {
        /// Register that was accessed.
        register: u8,
        /// Error of the bus.
        bus: i2c::Error,
    },
    /// Another chip answers at the codec's address.
    WrongChip {
        /// Content of register 0x01.
        id: u8,
    },
}

/// Starts the codec: releases its reset, writes its settings and powers it up.
///
/// # Errors
/// [`Error`] if the codec does not answer as a CS43L22. It is then held in reset, silent.
pub fn start(mut bus: I2c<'static, Blocking, Master>, mut reset: Output<'static>) -> Result<(), Error> {
    reset.set_low();
    block_for(Duration::from_millis(1));
    reset.set_high();
    block_for(Duration::from_millis(1));
    let started = write_settings(&mut bus);
    if started.is_err() {
        reset.set_low();
    }
    // Dropping the pin would let it float.
    core::mem::forget(reset);
    started
}

fn write_settings(bus: &mut I2c<'static, Blocking, Master>) -> Result<(), Error> {
    let id = read(bus, ID)?;
    if id & 0xF8 != CHIP_ID {
        return Err(Error::WrongChip { id });
    }
    for (register, bits, value) in BEFORE_POWER_UP.into_iter().chain([POWER_UP]) {
        let others = if bits == ALL { 0 } else { read(bus, register)? & !bits };
        let written = bus.blocking_write(ADDRESS, &[register, others | value]);
        written.map_err(|bus| Error::NotAnswering { register, bus })?;
    }
    Ok(())
}

/// Reads a register of the codec.
fn read(bus: &mut I2c<'static, Blocking, Master>, register: u8) -> Result<u8, Error> {
    let mut content = [0];
    let read = bus.blocking_write_read(ADDRESS, &[register], &mut content);
    read.map_err(|bus| Error::NotAnswering { register, bus })?;
    let [content] = content;
    Ok(content)
}
