//! The dynamic filter and waveguides on the virtual core.

use dsp_core::dynamic_filter::{Breakpoint, Exciter};
use dsp_core::waveguide::Loop;
use virtual_core::{Cost, Machine};

use super::{HOST_MEMORY, OnChipError, accept, bytes_of, image, words_of};

const INPUT: u32 = HOST_MEMORY;
const OUT: u32 = HOST_MEMORY + 0x4000;
const BAND: u32 = HOST_MEMORY + 0x8000;

/// Dynamic filter of at most 16 breakpoints and 10 loops of up to 2048 frames, on the virtual core
/// (`host-tests/images/filters`).
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
        let image = image("filters-image")?;
        Ok(Self { machine: Machine::new(&image)? })
    }

    /// Loads a dynamic filter at 48 kHz with seed and stream 9; gives the cost of the load.
    ///
    /// # Errors
    /// [`OnChipError::Refused`] if the filter is invalid.
    pub fn load_filter(
        &mut self,
        order: u8,
        points: &[Breakpoint],
        loops: &[Loop],
        exciter: Option<Exciter>,
    ) -> Result<Cost, OnChipError> {
        let point = |p: &Breakpoint| [p.time_s, p.a1, p.a2, p.b0, p.b1, p.b2, p.noise];
        let one = |l: &Loop| [l.frequency_hz, l.bandwidth_hz, l.gain, l.delay_s];
        let bytes: Vec<u8> = points.iter().flat_map(point).flat_map(f64::to_le_bytes).collect();
        self.machine.write(INPUT, &bytes)?;
        let bytes: Vec<u8> = loops.iter().flat_map(one).flat_map(f64::to_le_bytes).collect();
        self.machine.write(OUT, &bytes)?;
        let band = exciter.map(|e| [e.low_hz, e.high_hz, e.exponent].map(f64::to_le_bytes));
        self.machine.write(BAND, band.unwrap_or_default().as_flattened())?;
        let band = if band.is_some() { BAND } else { 0 };
        let arguments = [INPUT, points.len() as u32, OUT, loops.len() as u32, u32::from(order), band];
        let call = self.machine.call("filter_load", &arguments)?;
        accept("filter_load", call.value)?;
        Ok(call.cost)
    }

    /// Strikes the filter; gives the cost.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn strike(&mut self, level: f32) -> Result<Cost, OnChipError> {
        Ok(self.machine.call("filter_strike", &[level.to_bits()])?.cost)
    }

    /// Renders a block of at most 4096 frames from a bus of zeros; gives its sound and cost.
    ///
    /// `modes` is the sound of the modes that go through the filter.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn render(&mut self, modes: Option<&[i32]>, frames: usize) -> Result<(Vec<i32>, Cost), OnChipError> {
        self.machine.write(OUT, &vec![0; frames * 4])?;
        if let Some(modes) = modes {
            self.machine.write(INPUT, &bytes_of(modes))?;
        }
        let address = if modes.is_some() { INPUT } else { 0 };
        let call = self.machine.call("filter_render", &[address, OUT, frames as u32])?;
        let mut out = vec![0; frames * 4];
        self.machine.read(OUT, &mut out)?;
        Ok((words_of(&out), call.cost))
    }

    /// Machine of the image, for its profile and its loops.
    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }
}
