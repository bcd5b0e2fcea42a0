//! Banks of biquads on the virtual core.

use dsp_core::biquad::Biquad;
use virtual_core::{Cost, Image, Machine};

use super::{HOST_MEMORY, OnChipError, accept, bytes_of, manifest, words_of};

const INPUT: u32 = HOST_MEMORY;
const OUT: u32 = HOST_MEMORY + 0x4000;

/// `host-tests/images/biquads`: a bank of at most 64 pairs.
#[derive(Debug)]
pub struct BiquadsOnChip {
    machine: Machine,
}

impl BiquadsOnChip {
    /// Builds the image (once a process) and starts a machine with it.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn new() -> Result<Self, OnChipError> {
        let image = Image::from_elf(&virtual_core::build(&manifest("biquads"))?)?;
        Ok(Self { machine: Machine::new(&image)? })
    }

    /// Loads a bank, and says what that cost.
    ///
    /// # Errors
    /// [`OnChipError::Refused`] where it is no bank.
    pub fn load(&mut self, biquads: &[Biquad], depth: usize) -> Result<Cost, OnChipError> {
        let numbers = |biquad: &Biquad| {
            let [b0, b1, b2] = biquad.numerator;
            [biquad.pole.real, biquad.pole.imaginary, b0, b1, b2]
        };
        let bytes: Vec<u8> = biquads.iter().flat_map(numbers).flat_map(f64::to_le_bytes).collect();
        self.machine.write(INPUT, &bytes)?;
        let call = self.machine.call("biquads_load", &[INPUT, biquads.len() as u32, depth as u32])?;
        accept("biquads_load", call.value)?;
        Ok(call.cost)
    }

    /// A block of at most 4096 frames from a bus of zeros: its sound, and what it cost.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn render(&mut self, input: Option<&[i32]>, frames: usize) -> Result<(Vec<i32>, Cost), OnChipError> {
        self.machine.write(OUT, &vec![0; frames * 4])?;
        if let Some(input) = input {
            self.machine.write(INPUT, &bytes_of(input))?;
        }
        let address = if input.is_some() { INPUT } else { 0 };
        let call = self.machine.call("biquads_render", &[address, OUT, frames as u32])?;
        let mut out = vec![0; frames * 4];
        self.machine.read(OUT, &mut out)?;
        Ok((words_of(&out), call.cost))
    }

    /// The machine, for its profile and its loops.
    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }
}
