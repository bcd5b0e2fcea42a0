//! Banks of biquads on the virtual core.

use dsp_core::biquad::Biquad;
use virtual_core::{Cost, Machine};

use super::{HOST_MEMORY, OnChipError, accept, bytes_of, image, words_of};

const INPUT: u32 = HOST_MEMORY;
const OUT: u32 = HOST_MEMORY + 0x4000;

/// Bank of at most 64 pairs of biquads on the virtual core (`host-tests/images/biquads`).
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
        let image = image("biquads-image")?;
        Ok(Self { machine: Machine::new(&image)? })
    }

    /// Loads a bank; gives the cost of the load.
    ///
    /// # Errors
    /// [`OnChipError::Refused`] if the bank is invalid.
    pub fn load(&mut self, biquads: &[Biquad], depth: usize) -> Result<Cost, OnChipError> {
        self.load_as("biquads_load", biquads, depth)
    }

    /// Loads a bank in single precision; gives the cost of the load.
    ///
    /// # Errors
    /// [`OnChipError::Refused`] if the bank is invalid.
    pub fn load_float(&mut self, biquads: &[Biquad], depth: usize) -> Result<Cost, OnChipError> {
        self.load_as("float_biquads_load", biquads, depth)
    }

    fn load_as(&mut self, function: &'static str, biquads: &[Biquad], depth: usize) -> Result<Cost, OnChipError> {
        let numbers = |biquad: &Biquad| {
            let [b0, b1, b2] = biquad.numerator;
            [biquad.pole.real, biquad.pole.imaginary, b0, b1, b2]
        };
        let bytes: Vec<u8> = biquads.iter().flat_map(numbers).flat_map(f64::to_le_bytes).collect();
        self.machine.write(INPUT, &bytes)?;
        let call = self.machine.call(function, &[INPUT, biquads.len() as u32, depth as u32])?;
        accept(function, call.value)?;
        Ok(call.cost)
    }

    /// Renders a block of at most 4096 frames from a bus of zeros; gives its sound and cost.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn render(&mut self, input: Option<&[i32]>, frames: usize) -> Result<(Vec<i32>, Cost), OnChipError> {
        let (out, cost) = self.render_as("biquads_render", input.map(bytes_of), frames)?;
        Ok((words_of(&out), cost))
    }

    /// Renders a block of at most 4096 frames in single precision; gives its sound and cost.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn render_float(&mut self, input: Option<&[f32]>, frames: usize) -> Result<(Vec<f32>, Cost), OnChipError> {
        let input = input.map(|input| input.iter().flat_map(|x| x.to_le_bytes()).collect());
        let (out, cost) = self.render_as("float_biquads_render", input, frames)?;
        Ok((out.as_chunks().0.iter().map(|&word| f32::from_le_bytes(word)).collect(), cost))
    }

    fn render_as(
        &mut self,
        function: &'static str,
        input: Option<Vec<u8>>,
        frames: usize,
    ) -> Result<(Vec<u8>, Cost), OnChipError> {
        self.machine.write(OUT, &vec![0; frames * 4])?;
        if let Some(input) = &input {
            self.machine.write(INPUT, input)?;
        }
        let address = if input.is_some() { INPUT } else { 0 };
        let call = self.machine.call(function, &[address, OUT, frames as u32])?;
        let mut out = vec![0; frames * 4];
        self.machine.read(OUT, &mut out)?;
        Ok((out, call.cost))
    }

    /// Machine of the image, for its profile and its loops.
    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }
}
