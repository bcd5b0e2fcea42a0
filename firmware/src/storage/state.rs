//! Kits, settings and the kit that plays, as the board has them.

use dsp_core::table::Kit;

use super::flash::Flash;
use super::settings::Settings;
use super::slots::Slots;
use crate::board::sector::Sector;

/// Kits, settings and the kit that plays. There is one.
pub struct Storage {
    pub(super) flash: Flash,
    pub(super) settings: Settings,
    pub(super) slots: Slots,
    pub(super) playing: Playing,
}

/// Kit that plays, and where it is.
#[derive(Clone, Copy)]
pub(super) struct Playing {
    /// Kit; `None` before the start.
    pub(super) kit: Option<Kit<'static>>,
    /// Slot that the kit was started from; `None` for the built-in kit.
    pub(super) slot: Option<u8>,
    /// Sector that holds the kit; `None` for the built-in kit.
    pub(super) sector: Option<Sector>,
}
