//! The trigger on the virtual core (`host-tests/images/trigger`).

use virtual_core::{CCM_ADDRESS, Call, Image, Machine};

use super::Found;
use super::set::CHANNELS;
use crate::on_chip::{OnChipError, image};

/// Maximum number of frames in a call: they lie in the core-coupled memory.
pub const CALL_FRAMES: usize = 1024;

/// Trigger of four pads with their defaults on a Cortex-M4F.
#[derive(Debug)]
pub struct TriggerOnChip {
    machine: Machine,
    image: Image,
}

impl TriggerOnChip {
    /// Builds the image (once a process) and sets up four pads. If `direct`, the last of them is in
    /// direct mode.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn new(direct: bool) -> Result<Self, OnChipError> {
        let image = image("trigger-image")?;
        let mut machine = Machine::new(&image)?;
        let call = machine.call("trigger_new", &[direct.into()])?;
        match call.value as i32 {
            0 => Ok(Self { machine, image }),
            code => Err(OnChipError::Refused { function: "trigger_new", code }),
        }
    }

    /// Takes at most [`CALL_FRAMES`] frames; gives the strikes that are found, and the call with
    /// its cost.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn process(&mut self, frames: &[[u16; CHANNELS]]) -> Result<(Vec<Found>, Call), OnChipError> {
        let frames = frames.get(..CALL_FRAMES.min(frames.len())).unwrap_or_default();
        let bytes: Vec<u8> = frames.iter().flatten().flat_map(|count| count.to_le_bytes()).collect();
        self.machine.write(CCM_ADDRESS, &bytes)?;
        let call = self.machine.call("trigger_process", &[CCM_ADDRESS, frames.len() as u32])?;
        let address = self.machine.call("trigger_strikes", &[])?.value;
        let mut strikes = vec![0; call.value as usize * 16];
        self.machine.read(address, &mut strikes)?;
        let word = |strike: &[u8; 16], at: usize| {
            u32::from_le_bytes([strike[at], strike[at + 1], strike[at + 2], strike[at + 3]])
        };
        let found = strikes.as_chunks::<16>().0.iter().map(|strike| Found {
            frame: u64::from(word(strike, 0)) | u64::from(word(strike, 4)) << 32,
            pad: word(strike, 8) as usize,
            velocity: f32::from_bits(word(strike, 12)).into(),
        });
        Ok((found.collect(), call))
    }

    /// Gives the direct pad's next samples at the output's rate, at most [`CALL_FRAMES`], and the
    /// call.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn force(&mut self, frames: usize) -> Result<(Vec<i32>, Call), OnChipError> {
        let frames = frames.min(CALL_FRAMES);
        let call = self.machine.call("trigger_force", &[CCM_ADDRESS, frames as u32])?;
        let mut bytes = vec![0; frames * 4];
        self.machine.read(CCM_ADDRESS, &mut bytes)?;
        Ok((bytes.as_chunks().0.iter().map(|&word| i32::from_le_bytes(word)).collect(), call))
    }

    /// Bytes of the trigger's state.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn state_bytes(&mut self) -> Result<u32, OnChipError> {
        Ok(self.machine.call("trigger_bytes", &[])?.value)
    }

    /// Machine of the image, for its profile.
    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }

    /// Names of all functions of the image.
    pub fn function_names(&self) -> Vec<String> {
        self.image.symbols().iter().map(|symbol| symbol.name.clone()).collect()
    }
}
