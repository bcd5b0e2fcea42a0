//! The bank of modes alone on the virtual core.

use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::layout::{GainRecord, ModeRecord};
use virtual_core::{Cost, Image, Machine};
use zerocopy::IntoBytes;

use super::loaded::load_once;
use super::{HOST_MEMORY, OnChipError, accept, bytes_of, image, words_of};

const MODES: u32 = HOST_MEMORY;
const GAINS: u32 = HOST_MEMORY + 0x4000;
const FORCE: u32 = HOST_MEMORY + 0x8000;
const OUT: u32 = HOST_MEMORY + 0x8100;

/// A bank on the virtual core (`host-tests/images/kernels`): at most 1024 modes.
#[derive(Debug)]
pub struct BankOnChip {
    machine: Machine,
    image: Image,
}

impl BankOnChip {
    /// Builds the image (once a process) and starts a machine with it.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn new() -> Result<Self, OnChipError> {
        let image = image("kernels-image")?;
        Ok(Self { machine: Machine::new(&image)?, image })
    }

    /// Derives the bank from a table of one position at a rate in whole Hz.
    ///
    /// # Errors
    /// [`OnChipError::Refused`] if it does not fit.
    pub fn load(&mut self, modes: &[ModeRecord], gains: &[GainRecord], rate_hz: u32) -> Result<(), OnChipError> {
        let key = [b"bank", &rate_hz.to_le_bytes()[..], modes.as_bytes(), gains.as_bytes()].concat();
        load_once(&mut self.machine, key, |machine| {
            machine.write(MODES, modes.as_bytes())?;
            machine.write(GAINS, gains.as_bytes())?;
            let call = machine.call("bank_load", &[MODES, GAINS, modes.len() as u32, rate_hz])?;
            accept("bank_load", call.value)?;
            Ok(call)
        })?;
        Ok(())
    }

    /// Does the bookkeeping of a tick; gives the number of modes that still ring, and the cost.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn tick(&mut self, retire: bool) -> Result<(u32, Cost), OnChipError> {
        let call = self.machine.call("bank_tick", &[u32::from(retire)])?;
        Ok((call.value, call.cost))
    }

    /// Renders a run of at most a tick's frames from a bus of zeros; gives its sound and cost.
    ///
    /// `force` has the length of the run.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn render(&mut self, force: Option<&[i32]>, frames: usize) -> Result<(Vec<i32>, Cost), OnChipError> {
        self.machine.write(OUT, &[0; TICK_FRAMES * 4])?;
        let force = match force {
            Some(force) => {
                self.machine.write(FORCE, &bytes_of(force))?;
                FORCE
            }
            None => 0,
        };
        let call = self.machine.call("bank_render", &[force, OUT, frames as u32])?;
        accept("bank_render", call.value)?;
        let mut out = vec![0; frames * 4];
        self.machine.read(OUT, &mut out)?;
        Ok((words_of(&out), call.cost))
    }

    /// Machine of the image: its profile, its loops, and the other functions of the image.
    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }

    /// Image that the machine runs.
    pub fn image(&self) -> &Image {
        &self.image
    }
}
