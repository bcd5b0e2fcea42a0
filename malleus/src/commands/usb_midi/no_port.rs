//! A malleus without USB-MIDI, which needs no library of the system.

use std::convert::Infallible;

use cable::Link;

use crate::commands::error::CommandError;

/// Link that cannot be there.
pub(super) struct NoLink(Infallible);

/// Tells how to get a malleus that connects to boards.
///
/// # Errors
/// [`CommandError::NoUsbMidi`], always.
pub(super) fn connect(_port: &str) -> Result<NoLink, CommandError> {
    Err(CommandError::NoUsbMidi)
}

impl Link for NoLink {
    type Error = CommandError;

    fn send(&mut self, _message: &[u8]) -> Result<(), CommandError> {
        match self.0 {}
    }

    fn receive(&mut self, _until_ms: u64) -> Result<Option<u8>, CommandError> {
        match self.0 {}
    }

    fn now_ms(&mut self) -> u64 {
        match self.0 {}
    }
}
