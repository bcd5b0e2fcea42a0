//! Biquads, the dynamic filter and waveguides on the virtual core.

use dsp_core::biquad::Biquad;
use dsp_core::dynamic_filter::Breakpoint;
use dsp_core::waveguide::Band;
use virtual_core::{Cost, Image, Machine};

use super::{HOST_MEMORY, OnChipError, accept, bytes_of, manifest, words_of};

const INPUT: u32 = HOST_MEMORY;
const OUT: u32 = HOST_MEMORY + 0x4000;

/// `host-tests/images/filters`: a bank of at most 64 biquads, a dynamic filter of 16 breakpoints, and 10 waveguides.
#[derive(Debug)]
pub struct FiltersOnChip {
    machine: Machine,
}

impl FiltersOnChip {
    /// Builds the image (once a process) and starts a machine with it.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn new() -> Result<Self, OnChipError> {
        let image = Image::from_elf(&virtual_core::build(&manifest("filters"))?)?;
        Ok(Self { machine: Machine::new(&image)? })
    }

    /// Loads a bank of biquads.
    ///
    /// # Errors
    /// [`OnChipError::Refused`] where it is no bank.
    pub fn load_biquads(&mut self, biquads: &[Biquad], depth: usize) -> Result<(), OnChipError> {
        let numbers = |biquad: &Biquad| {
            let [b0, b1, b2] = biquad.numerator;
            [biquad.pole.real, biquad.pole.imaginary, b0, b1, b2]
        };
        let bytes: Vec<u8> = biquads.iter().flat_map(numbers).flat_map(f64::to_le_bytes).collect();
        self.machine.write(INPUT, &bytes)?;
        let call = self.machine.call("biquads_load", &[INPUT, biquads.len() as u32, depth as u32])?;
        accept("biquads_load", call.value)
    }

    /// A block of at most 4096 frames from a bus of zeros: its sound, and what it cost.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn render_biquads(&mut self, input: Option<&[i32]>, frames: usize) -> Result<(Vec<i32>, Cost), OnChipError> {
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

    /// Makes a dynamic filter, and waveguides round another of its kind.
    ///
    /// # Errors
    /// [`OnChipError::Refused`] where they are none.
    pub fn load_filter(&mut self, points: &[Breakpoint], bands: &[Band]) -> Result<(), OnChipError> {
        let point = |p: &Breakpoint| [p.time_s, p.b0, p.b1, p.a1];
        let band = |b: &Band| [b.frequency_hz, b.bandwidth_hz, b.gain];
        let bytes: Vec<u8> = points.iter().flat_map(point).flat_map(f64::to_le_bytes).collect();
        self.machine.write(INPUT, &bytes)?;
        let bytes: Vec<u8> = bands.iter().flat_map(band).flat_map(f64::to_le_bytes).collect();
        self.machine.write(OUT, &bytes)?;
        let call = self.machine.call("filter_load", &[INPUT, points.len() as u32, OUT, bands.len() as u32])?;
        accept("filter_load", call.value)
    }

    /// Strikes the filter, or the waveguides.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn strike(&mut self, guides: bool) -> Result<(), OnChipError> {
        self.machine.call("filter_strike", &[u32::from(guides)])?;
        Ok(())
    }

    /// A block of at most 4096 frames of the filter, or the waveguides, and what it cost.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn render(&mut self, guides: bool, frames: usize) -> Result<(Vec<i32>, Cost), OnChipError> {
        self.machine.write(OUT, &vec![0; frames * 4])?;
        let call = self.machine.call("filter_render", &[u32::from(guides), OUT, frames as u32])?;
        let mut out = vec![0; frames * 4];
        self.machine.read(OUT, &mut out)?;
        Ok((words_of(&out), call.cost))
    }

    /// The machine, for its profile and its loops.
    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }
}
