//! The whole engine on the virtual core.

use dsp_core::SampleRate;
use dsp_core::engine::Direct;
use dsp_core::event::{Action, Event, Shedding, Time};
use dsp_core::scrape::Motion;
use virtual_core::{Call, Image, Machine};

use super::loaded::load_once;
use super::{HOST_MEMORY, KIT_FLASH, OnChipError, accept, bytes_of, image, words_of};

const BLOCK: u32 = HOST_MEMORY;
const EVENTS: u32 = HOST_MEMORY + 0x40;
const FORCE: u32 = HOST_MEMORY + 0x1000;
const OUT: u32 = HOST_MEMORY + 0x3000;

/// Maximum number of frames in a block.
pub const BLOCK_FRAMES: usize = 1024;

/// Memory of the engine on a chip, in bytes.
#[derive(Clone, Copy, Debug)]
pub struct Footprint {
    /// Code and constants, without a kit.
    pub flash: u32,
    /// Static RAM of the image, the memory that it lends included.
    pub static_ram: u32,
    /// RAM of the engine that was loaded last, its memory included.
    pub ram: u32,
}

/// Report of the engine's last block.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// Predicted cycles of the block's last tick.
    pub predicted_cycles: u32,
    /// Number of register groups that the last tick left out.
    pub shed_groups: u32,
    /// Number of modes in the groups that were left out.
    pub shed_modes: u32,
    /// Shed decisions of the whole block, as events.
    pub decisions: Vec<Event>,
}

/// An engine on the virtual core (`host-tests/images/engine`).
#[derive(Debug)]
pub struct EngineOnChip {
    machine: Machine,
    image: Image,
    /// Bits of the limiter's ceiling in dB; bits of a NaN if there is no limiter.
    ceiling_db_bits: u32,
    /// True if pads in frames have no limit.
    is_unlimited: bool,
}

impl EngineOnChip {
    /// Builds the image (once a process) and starts a machine with it.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn new() -> Result<Self, OnChipError> {
        let image = image("engine-image")?;
        Ok(Self { machine: Machine::new(&image)?, image, ceiling_db_bits: f32::NAN.to_bits(), is_unlimited: false })
    }

    /// Loads a kit in its binary form; gives the call with its cost.
    ///
    /// # Errors
    /// [`OnChipError::Refused`] if the bytes are no kit, or if the kit does not fit.
    pub fn load(&mut self, kit: &[u8], rate: SampleRate) -> Result<Call, OnChipError> {
        // The engine reads its kit in place.
        self.machine.write(KIT_FLASH, kit)?;
        let (numerator, denominator) = rate.ratio();
        let numbers = [numerator, denominator, self.ceiling_db_bits, self.is_unlimited.into()].map(u32::to_le_bytes);
        let key = [b"engine", numbers.as_flattened(), kit].concat();
        load_once(&mut self.machine, key, |machine| {
            let call = machine.call("engine_load", &[KIT_FLASH, kit.len() as u32, numerator, denominator])?;
            accept("engine_load", call.value)?;
            Ok(call)
        })
    }

    /// Renders a block of at most [`BLOCK_FRAMES`]; gives its samples, and the call with its cost
    /// and peak stack.
    ///
    /// # Errors
    /// [`OnChipError::Refused`] for too many frames or an invalid event.
    pub fn render(
        &mut self,
        events: &[Event],
        direct: Option<Direct<'_>>,
        frames: usize,
    ) -> Result<(Vec<[i32; 2]>, Call), OnChipError> {
        if frames > BLOCK_FRAMES {
            return Err(OnChipError::Refused { function: "engine_render", code: -3 });
        }
        let wire: Vec<u8> = events.iter().flat_map(wire).collect();
        self.machine.write(EVENTS, &wire)?;
        let (force, pad) = match direct {
            Some(direct) => {
                self.machine.write(FORCE, &bytes_of(direct.force))?;
                (FORCE, u32::from(direct.pad))
            }
            None => (0, 0),
        };
        let block = [EVENTS, events.len() as u32, force, pad, OUT, frames as u32];
        self.machine.write(BLOCK, &bytes_of(&block.map(|word| word as i32)))?;
        let call = self.machine.call("engine_render", &[BLOCK])?;
        accept("engine_render", call.value)?;
        let mut out = vec![0; frames * 8];
        self.machine.read(OUT, &mut out)?;
        let samples = words_of(&out).as_chunks().0.to_vec();
        Ok((samples, call))
    }

    /// Sets the limiter's ceiling in dB of full scale, for kits that are loaded from now on.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn set_ceiling(&mut self, ceiling_db: f32) -> Result<(), OnChipError> {
        self.ceiling_db_bits = ceiling_db.to_bits();
        self.machine.call("engine_limit", &[self.ceiling_db_bits])?;
        Ok(())
    }

    /// Takes the limit to the cycles of pads in frames away, for kits that are loaded from now on.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn unlimit_frames(&mut self) -> Result<(), OnChipError> {
        self.is_unlimited = true;
        self.machine.call("engine_unlimited", &[])?;
        Ok(())
    }

    /// Sets the budget in cycles a tick.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn set_budget(&mut self, cycles_per_tick: u32) -> Result<(), OnChipError> {
        self.machine.call("engine_budget", &[cycles_per_tick])?;
        Ok(())
    }

    /// Report of the last block: prediction and omissions of its last tick, decisions of all ticks.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn told(&mut self) -> Result<Told, OnChipError> {
        let address = self.machine.call("engine_told", &[])?.value;
        let mut head = [0; 16];
        self.machine.read(address, &mut head)?;
        let words: Vec<u32> = words_of(&head).iter().map(|&word| word as u32).collect();
        let mut decisions = Vec::new();
        for index in 0..words[3] {
            let mut event = [0; EVENT_BYTES];
            self.machine.read(address + 16 + EVENT_BYTES as u32 * index, &mut event)?;
            let frame = u64::from_le_bytes(*event.first_chunk().unwrap_or(&[0; 8]));
            let groups = u32::from_le_bytes(*event[24..].first_chunk().unwrap_or(&[0; 4]));
            // The image's `ALL_BUT_FIRST` is no number of groups.
            let shedding = u16::try_from(groups).map_or(Shedding::AllButFirst, Shedding::Quietest);
            decisions.push(Event { time: Time::at_frame(frame), action: Action::Shed(shedding), ..Event::NOTHING });
        }
        Ok(Told { predicted_cycles: words[0], shed_groups: words[1], shed_modes: words[2], decisions })
    }

    /// Memory of the engine on a chip.
    ///
    /// # Errors
    /// [`OnChipError::Run`].
    pub fn footprint(&mut self) -> Result<Footprint, OnChipError> {
        Ok(Footprint {
            flash: self.image.flash_bytes(),
            static_ram: self.image.static_ram_bytes(),
            ram: self.machine.call("engine_bytes", &[])?.value,
        })
    }

    /// Machine of the image, for its profile.
    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }
}

/// Bytes of an event on the wire.
const EVENT_BYTES: usize = 40;

/// Bytes of an event as the image's `WireEvent` has them.
fn wire(event: &Event) -> [u8; EVENT_BYTES] {
    let mut bytes = [0; EVENT_BYTES];
    let mut numbers = [0.0; 3];
    bytes[..8].copy_from_slice(&event.time.frame.to_le_bytes());
    bytes[8..12].copy_from_slice(&event.time.fraction.to_le_bytes());
    bytes[12] = event.pad;
    bytes[13] = event.striker;
    bytes[14] = match event.action {
        Action::Strike => 0,
        Action::Choke => 1,
        Action::Release => 2,
        Action::Shed(shedding) => {
            let groups = match shedding {
                Shedding::Quietest(groups) => groups.into(),
                Shedding::AllButFirst => u32::MAX,
            };
            bytes[24..28].copy_from_slice(&groups.to_le_bytes());
            3
        }
        Action::Level => 4,
        Action::Silence => 5,
        Action::Touch { rolls, normal_n: [least_n, most_n] } => {
            numbers = [least_n, most_n, 0.0];
            if rolls { 7 } else { 6 }
        }
        Action::Move(Motion { velocity_m_per_s: [x, y], normal_n }) => {
            numbers = [x, y, normal_n];
            8
        }
        Action::Lift => 9,
    };
    bytes[28..].copy_from_slice(numbers.map(f32::to_le_bytes).as_flattened());
    bytes[16..20].copy_from_slice(&event.velocity.to_le_bytes());
    bytes[20..24].copy_from_slice(&event.position.to_le_bytes());
    bytes
}
