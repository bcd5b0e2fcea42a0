//! Settings of the board and the places of its slots, in two sectors that take turns.
//!
//! `sequential-storage` appends each value to a sector with a checksum. When the sector is full it
//! moves the newest values to the other one and erases the full one: a setting wears the flash by
//! an erase in some 1000 writes (16 KB by 16 bytes, counted and not measured). A loss of power
//! leaves the old value or the new one.

use cable::{Key, Refusal, Value};
use dsp_core::fixed;
use embassy_futures::block_on;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use sequential_storage::cache::key_pointers::ArrayKeyPointers;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};

use super::flash::{Flash, FlashError};
use crate::audio;
use crate::board::sector::Sector;
use crate::board::{SETTINGS_SECTORS, SLOTS};
use crate::input::Overrides;
use crate::input::piezo::CHANNELS;

/// Length of a sector in bytes.
const SECTOR_BYTES: u32 = SETTINGS_SECTORS[0].bytes;
/// Bytes of the longest item: key, mark of a value, value, in whole words.
const ITEM_BYTES: usize = 8;
/// Key of the place of slot 0; that of slot n is n above it. Keys of settings are below it.
const PLACE: u16 = 0xFF00;
/// Number of settings of a board.
const COUNT: usize = 2 * CHANNELS + 3;
/// All settings of a board.
const KEYS: [Key; COUNT] = {
    let mut keys = [Key::Channel; COUNT];
    let mut piezo = 0;
    while piezo < CHANNELS {
        keys[piezo] = Key::Threshold { piezo: piezo as u8 };
        keys[CHANNELS + piezo] = Key::Curve { piezo: piezo as u8 };
        piezo += 1;
    }
    (keys[2 * CHANNELS + 1], keys[2 * CHANNELS + 2]) = (Key::Level, Key::StartSlot);
    keys
};

/// Settings of the board, as they stand in the flash.
pub struct Settings {
    /// Bits of each value in the order of [`KEYS`]; `None` for a setting that is not set.
    values: [Option<u32>; COUNT],
}

impl Settings {
    /// Reads all settings. Sectors that hold something else are erased.
    pub fn read(flash: &mut Flash) -> Self {
        let mut values = [None; COUNT];
        for (value, key) in values.iter_mut().zip(KEYS) {
            *value = fetch(flash, number(key)).filter(|&bits| key.value(bits).is_some());
        }
        Self { values }
    }

    /// Value of a setting; `None` if it is not set.
    ///
    /// # Errors
    /// [`Refusal::SettingRange`] if the board does not have the setting's input.
    pub fn get(&self, key: Key) -> Result<Option<Value>, Refusal> {
        let value = self.values.get(index(key)?).copied().flatten();
        Ok(value.and_then(|bits| key.value(bits)))
    }

    /// Sets a setting in the flash; `None` removes it.
    ///
    /// # Errors
    /// [`Refusal::SettingRange`] if the board does not have the setting's input,
    /// [`Refusal::Flash`] if the flash fails.
    pub fn set(&mut self, flash: &mut Flash, key: Key, value: Option<Value>) -> Result<(), Refusal> {
        let (index, bits) = (index(key)?, value.map(Value::bits));
        store(flash, number(key), bits)?;
        if let Some(place) = self.values.get_mut(index) {
            *place = bits;
        }
        Ok(())
    }

    /// Number of a count's setting; `None` if it is not set.
    fn count(&self, key: Key) -> Option<u8> {
        match self.get(key) {
            Ok(Some(Value::Count(count))) => Some(count),
            _ => None,
        }
    }

    fn number(&self, key: Key) -> Option<f32> {
        match self.get(key) {
            Ok(Some(Value::Number(number))) => Some(number),
            _ => None,
        }
    }

    /// Settings that go before those of the kit's triggers.
    pub fn overrides(&self) -> Overrides {
        let each = |key: fn(u8) -> Key| core::array::from_fn(|piezo| self.number(key(piezo as u8)));
        Overrides { thresholds: each(|piezo| Key::Threshold { piezo }), exponents: each(|piezo| Key::Curve { piezo }) }
    }

    /// MIDI channel, counted from 0; `None` for all channels in, and channel 10 out.
    pub fn channel(&self) -> Option<u8> {
        self.count(Key::Channel).map(|channel| channel.saturating_sub(1))
    }

    /// Gain of the whole sound, 0 to 1.
    pub fn gain(&self) -> f32 {
        self.number(Key::Level).map_or(1.0, |level_db| fixed::power(0.1, -level_db / 20.0))
    }

    /// Slot whose kit plays after a start.
    pub fn start_slot(&self) -> u8 {
        self.count(Key::StartSlot).unwrap_or(0)
    }
}

/// Place of a slot's kit; `None` if it has never moved.
pub(super) fn place_of(flash: &mut Flash, slot: u8) -> Option<u32> {
    fetch(flash, PLACE + u16::from(slot))
}

/// Notes the place of a slot's kit.
///
/// # Errors
/// [`Refusal::Flash`] if the flash fails.
pub(super) fn set_place(flash: &mut Flash, slot: u8, place: u32) -> Result<(), Refusal> {
    store(flash, PLACE + u16::from(slot), Some(place))
}

/// Place of a setting in [`KEYS`].
///
/// # Errors
/// [`Refusal::SettingRange`] if the board does not have the setting's input.
fn index(key: Key) -> Result<usize, Refusal> {
    KEYS.iter().position(|&own| own == key).ok_or(Refusal::SettingRange { key: key.parts().0 })
}

/// Number of a setting in the flash: that on the wire, and the piezo.
fn number(key: Key) -> u16 {
    u16::from_be_bytes(key.parts().into())
}

/// Address of the newest value of each number, kept during one operation.
///
/// A full sector holds some 1160 values, and its move to the other sector asks for each whether it
/// is the newest of its number. A search through the sector for each answer took 8 s on the
/// BlackPill; with the addresses an answer comes within 1 s
/// (`cargo test -p virtual-board --test boards -- --ignored storage::settings`).
type Places = ArrayKeyPointers<u16, { COUNT + SLOTS as usize }>;

type Map<'f> = MapStorage<u16, Area<'f>, Cache<Uncached, Uncached, Places, u16>>;

fn map(flash: &mut Flash) -> Map<'_> {
    let cache = Cache::new(Uncached, Uncached, Places::new());
    MapStorage::new(Area(flash), const { MapConfig::new(0..BOTH.bytes) }, cache)
}

/// Fetches the newest value of a number. Sectors that cannot be read are erased.
fn fetch(flash: &mut Flash, number: u16) -> Option<u32> {
    let fetched = block_on(map(flash).fetch_item::<Option<u32>>(&mut [0; ITEM_BYTES], &number));
    match fetched {
        Ok(value) => value.flatten(),
        Err(_) => {
            defmt::warn!("settings: the flash holds something else, and is erased");
            if block_on(map(flash).erase_all()).is_err() {
                defmt::error!("settings: the flash cannot be erased");
            }
            None
        }
    }
}

fn store(flash: &mut Flash, number: u16, value: Option<u32>) -> Result<(), Refusal> {
    let stored = block_on(map(flash).store_item(&mut [0; ITEM_BYTES], &number, &value));
    stored.map_err(|_| Refusal::Flash { offset: 0 })
}

/// Both sectors as `sequential-storage` sees them, addressed from 0.
struct Area<'f>(&'f mut Flash);

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for Area<'_> {
    type Error = FlashError;
}

/// Both sectors as one, which follow one another. The number is that of the first.
const BOTH: Sector = {
    let [first, second] = SETTINGS_SECTORS;
    assert!(first.address + first.bytes == second.address && first.bytes == second.bytes);
    Sector { bytes: first.bytes + second.bytes, ..first }
};

impl ReadNorFlash for Area<'_> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let from = BOTH.read().get(offset as usize..).and_then(|from| from.get(..bytes.len()));
        bytes.copy_from_slice(from.ok_or(FlashError { address: BOTH.address + offset })?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        BOTH.bytes as usize
    }
}

impl NorFlash for Area<'_> {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR_BYTES as usize;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        // The core stands still for up to 0.5 s a sector.
        let _hushed = audio::hush();
        for (start, sector) in (0..).step_by(SECTOR_BYTES as usize).zip(SETTINGS_SECTORS) {
            if (from..to).contains(&start) {
                self.0.erase(sector)?;
            }
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let address = BOTH.address + offset;
        match bytes.len() <= BOTH.bytes.saturating_sub(offset) as usize {
            true => self.0.program(address, bytes),
            false => Err(FlashError { address }),
        }
    }
}
