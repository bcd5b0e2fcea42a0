//! The residual stage alone on the virtual core.

use dsp_core::residual::ResidualBand;
use dsp_core::resonator::TICK_FRAMES;
use virtual_core::{Cost, Machine};

use super::{HOST_MEMORY, OnChipError, accept, image, words_of};

const BANDS: u32 = HOST_MEMORY;
const OUT: u32 = HOST_MEMORY + 0x1000;

/// A residual stage on the virtual core (`host-tests/images/residual`), at 48 kHz.
#[derive(Debug)]
pub struct ResidualOnChip {
    machine: Machine,
}

impl ResidualOnChip {
    /// Builds the image (once a process) and starts a machine with it.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn new() -> Result<Self, OnChipError> {
        let image = image("residual-image")?;
        Ok(Self { machine: Machine::new(&image)? })
    }

    /// Derives the stage from bands; it is silent until the first strike.
    ///
    /// # Errors
    /// [`OnChipError::Refused`] if there are too many bands.
    pub fn load(&mut self, bands: &[ResidualBand], seed: u32, silence: f32) -> Result<(), OnChipError> {
        let numbers =
            bands.iter().flat_map(|band| [band.edges_hz[0], band.edges_hz[1], band.weight, band.decay_db_per_s]);
        let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
        self.machine.write(BANDS, &bytes)?;
        let arguments = [BANDS, bands.len() as u32, seed, silence.to_bits()];
        accept("residual_load", self.machine.call("residual_load", &arguments)?.value)
    }

    /// Renders a tick from a bus of zeros; gives its sound and cost.
    ///
    /// `strike` is a strike (frame within the tick, strength) or none.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn tick(&mut self, strike: Option<(usize, f32)>) -> Result<(Vec<i32>, Cost), OnChipError> {
        self.machine.write(OUT, &[0; TICK_FRAMES * 4])?;
        let (offset, strength) = strike.unwrap_or((0, 0.0));
        let call = self.machine.call("residual_tick", &[strength.to_bits(), offset as u32, OUT])?;
        accept("residual_tick", call.value)?;
        let mut out = vec![0; TICK_FRAMES * 4];
        self.machine.read(OUT, &mut out)?;
        Ok((words_of(&out), call.cost))
    }

    /// Machine of the image, for its profile.
    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }
}
