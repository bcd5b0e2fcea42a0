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

/// Volume at which the headphones start, in half decibels, which the codec counts.
pub const START_VOLUME: i32 = -24;
/// Registers of the volume of the headphones, left and right.
const HEADPHONES: [u8; 2] = [0x22, 0x23];

/// Registers, bits and their values that are written before power-up, in this order. Other bits
/// keep what the reset left there.
///
/// The first rows are the initialisation settings that the datasheet requires (section 4.11); two
/// of them change only bit 7 of their register. The next rows switch the headphones on and the
/// speakers off. The last ones let the codec detect its clock, choose I2S of up to 24 bits, and
/// turn the headphones down by 12 dB.
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
    (HEADPHONES[0], ALL, START_VOLUME as u8),
    (HEADPHONES[1], ALL, START_VOLUME as u8),
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

/// Codec that plays.
pub struct Codec {
    bus: I2c<'static, Blocking, Master>,
}

impl Codec {
    /// Sets the volume of the headphones in half decibels, -204 to 0. The codec goes there by soft
    /// ramps.
    ///
    /// # Errors
    /// [`Error`] if the codec does not answer.
    pub fn set_volume(&mut self, half_db: i32) -> Result<(), Error> {
        HEADPHONES.into_iter().try_for_each(|register| write(&mut self.bus, register, half_db as u8))
    }
}

/// Starts the codec: releases its reset, writes its settings and powers it up.
///
/// # Errors
/// [`Error`] if the codec does not answer as a CS43L22. It is then held in reset, silent.
pub fn start(mut bus: I2c<'static, Blocking, Master>, mut reset: Output<'static>) -> Result<Codec, Error> {
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
    started.map(|()| Codec { bus })
}

fn write_settings(bus: &mut I2c<'static, Blocking, Master>) -> Result<(), Error> {
    let id = read(bus, ID)?;
    if id & 0xF8 != CHIP_ID {
        return Err(Error::WrongChip { id });
    }
    for (register, bits, value) in BEFORE_POWER_UP.into_iter().chain([POWER_UP]) {
        let others = if bits == ALL { 0 } else { read(bus, register)? & !bits };
        write(bus, register, others | value)?;
    }
    Ok(())
}

/// Writes a register of the codec.
fn write(bus: &mut I2c<'static, Blocking, Master>, register: u8, content: u8) -> Result<(), Error> {
    let written = bus.blocking_write(ADDRESS, &[register, content]);
    written.map_err(|bus| Error::NotAnswering { register, bus })
}

/// Reads a register of the codec.
fn read(bus: &mut I2c<'static, Blocking, Master>, register: u8) -> Result<u8, Error> {
    let mut content = [0];
    let read = bus.blocking_write_read(ADDRESS, &[register], &mut content);
    read.map_err(|bus| Error::NotAnswering { register, bus })?;
    let [content] = content;
    Ok(content)
}
