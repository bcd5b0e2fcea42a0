//! The room alone on the virtual core.

use dsp_core::resonator::TICK_FRAMES;
use virtual_core::{Cost, Machine};
use zerocopy::IntoBytes;

use super::{HOST_MEMORY, OnChipError, accept, bytes_of, image, words_of};
use crate::room::Table;

const BANDS: u32 = HOST_MEMORY;
const OUT: u32 = HOST_MEMORY + 0x1000;

/// A room of 48 KB on the virtual core (`host-tests/images/kernels`).
#[derive(Debug)]
pub struct RoomOnChip {
    machine: Machine,
}

impl RoomOnChip {
    /// Builds the image (once a process) and starts a machine with it.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn new() -> Result<Self, OnChipError> {
        let image = image("kernels-image")?;
        Ok(Self { machine: Machine::new(&image)? })
    }

    /// Loads a table at a rate in whole Hz; gives the cost of the load.
    ///
    /// # Errors
    /// [`OnChipError::Refused`] if the table cannot be played.
    pub fn load(&mut self, table: &Table, rate_hz: u32) -> Result<Cost, OnChipError> {
        let records = table.records();
        self.machine.write(BANDS, records.as_bytes())?;
        let call = self.machine.call("room_load", &[BANDS, records.len() as u32, rate_hz])?;
        accept("room_load", call.value)?;
        Ok(call.cost)
    }

    /// Adds the room's answer to a run of at most a tick's frames; gives the cost.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn render(&mut self, out: &mut [[i32; 2]]) -> Result<Cost, OnChipError> {
        assert!(out.len() <= TICK_FRAMES);
        self.machine.write(OUT, &bytes_of(out.as_flattened()))?;
        let call = self.machine.call("room_render", &[OUT, out.len() as u32])?;
        accept("room_render", call.value)?;
        let mut bytes = vec![0; out.len() * 8];
        self.machine.read(OUT, &mut bytes)?;
        out.as_flattened_mut().copy_from_slice(&words_of(&bytes));
        Ok(call.cost)
    }

    /// Bytes of RAM that the room takes.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn bytes(&mut self) -> Result<u32, OnChipError> {
        Ok(self.machine.call("room_bytes", &[])?.value)
    }

    /// Machine of the image, for its profile.
    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }
}
