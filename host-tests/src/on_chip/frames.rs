//! A bank in frames alone on the virtual core.

use dsp_core::SampleRate;
use virtual_core::{Cost, Machine};
use zerocopy::IntoBytes;

use super::loaded::load_once;
use super::{HOST_MEMORY, OnChipError, accept, bytes_of, image, words_of};
use crate::frames::HeardMode;

const MODES: u32 = HOST_MEMORY;
const GAINS: u32 = HOST_MEMORY + 0x4000;
const FORCE: u32 = HOST_MEMORY + 0x8000;
const OUT: u32 = HOST_MEMORY + 0x8100;

/// A bank in frames on the virtual core (`host-tests/images/frames`): at most 1150 modes.
#[derive(Debug)]
pub struct FramesOnChip {
    machine: Machine,
}

impl FramesOnChip {
    /// Builds the image (once a process) and starts a machine with it.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn new() -> Result<Self, OnChipError> {
        let image = image("frames-image")?;
        Ok(Self { machine: Machine::new(&image)? })
    }

    /// Derives the bank of modes at a rate in whole Hz; gives the cost of the load.
    ///
    /// # Errors
    /// [`OnChipError::Refused`] if it does not fit.
    pub fn load(&mut self, modes: &[HeardMode], rate: SampleRate) -> Result<Cost, OnChipError> {
        let (modes, gains): (Vec<_>, Vec<_>) = modes.iter().map(|mode| mode.records(rate)).unzip();
        let (rate_hz, _) = rate.ratio();
        let key = [b"frames", &rate_hz.to_le_bytes()[..], modes.as_bytes(), gains.as_bytes()].concat();
        let call = load_once(&mut self.machine, key, |machine| {
            machine.write(MODES, modes.as_bytes())?;
            machine.write(GAINS, gains.as_bytes())?;
            let call = machine.call("frames_load", &[MODES, GAINS, modes.len() as u32, rate_hz])?;
            accept("frames_load", call.value)?;
            Ok(call)
        })?;
        Ok(call.cost)
    }

    /// Renders a run within a tick from a bus of zeros; gives the left side and the cost.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn render(&mut self, force: Option<&[i32]>, frames: usize) -> Result<(Vec<i32>, Cost), OnChipError> {
        let force = match force {
            Some(force) => {
                self.machine.write(FORCE, &bytes_of(force))?;
                FORCE
            }
            None => 0,
        };
        let mut out = vec![0; frames * 8];
        self.machine.write(OUT, &out)?;
        let call = self.machine.call("frames_render", &[force, OUT, frames as u32])?;
        accept("frames_render", call.value)?;
        self.machine.read(OUT, &mut out)?;
        Ok((words_of(&out).into_iter().step_by(2).collect(), call.cost))
    }

    /// Number of modes that ring in frames.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn ringing(&mut self) -> Result<u32, OnChipError> {
        Ok(self.machine.call("frames_ringing", &[])?.value)
    }

    /// Bytes of RAM that the bank and its mixer take.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn bytes(&mut self) -> Result<u32, OnChipError> {
        Ok(self.machine.call("frames_bytes", &[])?.value)
    }

    /// Machine of the image, for its profile.
    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }
}
