//! The board as the protocol sees it: slots of flash with kits, settings, and a few deeds.

use dsp_core::SampleRate;
use dsp_core::engine::LoadError;
use dsp_core::table::Kit;

use crate::left_out::LeftOut;
use crate::refusal::Refusal;
use crate::setting::{Key, Value};
use crate::text::Text;

/// Bytes of a kit's header, which an upload writes last (`docs/kit-format.md`).
pub const HEADER_BYTES: usize = 16;

/// Names and rate of a board, as it tells them to the computer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Identity {
    /// Version of the firmware, such as `0.1.0`.
    pub firmware: Text,
    /// Git revision of the firmware.
    pub revision: Text,
    /// Name of the board, such as `stm32f407g-disc1`.
    pub board: Text,
    /// Sample rate on the I2S pins.
    pub rate: SampleRate,
}

/// Content of a slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Content {
    /// Erased flash.
    Empty,
    /// Bytes without a header, because an upload or an erase was interrupted.
    Unfinished,
    /// Kit that the board can play.
    Kit {
        /// Name of the kit.
        name: Text,
        /// Length of the kit in bytes.
        length: u32,
        /// CRC-32 in the kit's header.
        crc: u32,
    },
    /// Bytes that the board does not play, and the reason.
    Refused(Refusal),
}

impl Content {
    /// Reads the content of a slot from all bytes of its flash.
    ///
    /// `plan` is the board's plan of a kit (`boards::Board::plan`); it calls the closure that it is
    /// given for each stage that the board leaves out, and `tell` gets them.
    ///
    /// Cost: [`Kit::parse`] and the plan, some 0.1 s for 128 KB on a board.
    pub fn of(
        bytes: &[u8],
        plan: impl FnOnce(&Kit<'_>, &mut dyn FnMut(LoadError)) -> Result<(), LoadError>,
        tell: &mut dyn FnMut(LeftOut),
    ) -> Self {
        if bytes.first_chunk() == Some(&[0xFF; 4]) {
            return match bytes.iter().all(|&byte| byte == 0xFF) {
                true => Self::Empty,
                false => Self::Unfinished,
            };
        }
        let kit = match Kit::parse(bytes) {
            Ok(kit) => kit,
            Err(error) => return Self::Refused(error.into()),
        };
        match plan(&kit, &mut |error| tell(LeftOut::from(error))) {
            Ok(()) => {
                let crc = bytes.get(12..).and_then(<[u8]>::first_chunk).copied().map_or(0, u32::from_le_bytes);
                Self::Kit { name: Text::new(kit.name()), length: kit.len_bytes() as u32, crc }
            }
            Err(error) => Self::Refused(error.into()),
        }
    }
}

/// Work that takes a board long, and stops its sound or makes it restart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Job {
    /// Erases a slot before an upload.
    Prepare(u8),
    /// Checks an uploaded kit, writes its header, and checks it as a whole.
    Finish(u8),
    /// Erases a slot.
    Erase(u8),
    /// Writes a setting.
    Set(Key),
    /// Plays the kit of a slot, or the built-in kit.
    Start(Option<u8>),
    /// Restarts the board in the bootloader of its ROM.
    EnterDfu,
}

/// Flash, settings and engine of a board, which [`Device`](crate::Device) serves to the computer.
///
/// [`Device`](crate::Device) checks all that comes over the wire: slots exist, offsets lie in them,
/// values are in range. It calls [`erase`](Store::erase), [`prepare`](Store::prepare),
/// [`commit`](Store::commit), [`set`](Store::set), [`start`](Store::start) and
/// [`enter_dfu`](Store::enter_dfu) within [`Device::work`](crate::Device::work) alone, behind a
/// message that tells the computer to wait.
/// Every call may block; audio goes on in its interrupt, unless the flash stalls the core.
pub trait Store {
    /// Names and rate of the board.
    fn identity(&self) -> Identity;

    /// Slot whose kit plays; `None` for the built-in kit.
    fn playing(&self) -> Option<u8>;

    /// Number of slots.
    fn slots(&self) -> u8;

    /// All bytes of a slot's flash, erased or not; `None` if there is no such slot.
    ///
    /// Their number is the slot's capacity.
    fn bytes(&self, slot: u8) -> Option<&[u8]>;

    /// All bytes of the flash that an upload to a slot writes; `None` if there is no such slot.
    ///
    /// They are those of [`bytes`](Store::bytes) on a board that has one place a slot.
    fn uploaded(&self, slot: u8) -> Option<&[u8]>;

    /// Content of the bytes of a slot; [`Content::of`] with the board's plan.
    fn content(&self, bytes: &[u8], tell: &mut dyn FnMut(LeftOut)) -> Content;

    /// Longest time that a job takes, in milliseconds, by the chip's data sheet.
    fn longest_ms(&self, job: Job) -> u16;

    /// Erases a slot. If its kit plays, the built-in kit plays from then on.
    ///
    /// # Errors
    /// [`Refusal::Flash`] if the slot is not erased.
    fn erase(&mut self, slot: u8) -> Result<(), Refusal>;

    /// Erases the flash that an upload to a slot writes. A board with one place a slot plays the
    /// built-in kit from then on, if the slot's kit played.
    ///
    /// # Errors
    /// [`Refusal::Flash`] if the flash is not erased.
    fn prepare(&mut self, slot: u8) -> Result<(), Refusal>;

    /// Makes the uploaded kit that of its slot, for all starts.
    ///
    /// # Errors
    /// [`Refusal::Flash`] if the board cannot note it. The old kit then stays that of the slot.
    fn commit(&mut self, slot: u8) -> Result<(), Refusal>;

    /// Writes bytes to the erased flash of an upload to a slot, and compares what it then reads.
    ///
    /// `offset` and the number of bytes are multiples of 4, but for the end of a kit. Each byte is
    /// written once after an erase.
    ///
    /// # Errors
    /// [`Refusal::Flash`] if the flash reports an error or reads back otherwise.
    fn write(&mut self, slot: u8, offset: usize, bytes: &[u8]) -> Result<(), Refusal>;

    /// Value of a setting; `None` if it is not set, so that the kit's or the firmware's holds.
    ///
    /// # Errors
    /// [`Refusal::SettingRange`] if the board does not have the setting's input.
    fn setting(&self, key: Key) -> Result<Option<Value>, Refusal>;

    /// Sets a setting, at once and for all starts; `None` removes it.
    ///
    /// # Errors
    /// [`Refusal::SettingRange`] if the board does not have the setting's input or slot,
    /// [`Refusal::Flash`] if it cannot be written. The old value then holds.
    fn set(&mut self, key: Key, value: Option<Value>) -> Result<(), Refusal>;

    /// Plays the kit of a slot, which [`content`](Store::content) accepts, after a fade; `None`
    /// plays the built-in kit.
    ///
    /// # Errors
    /// [`Refusal::NotLoadable`] if the engine refuses the kit. The kit that played goes on.
    fn start(&mut self, slot: Option<u8>) -> Result<(), Refusal>;

    /// Restarts the board in the bootloader of its ROM. On a board it does not return.
    fn enter_dfu(&mut self);
}
