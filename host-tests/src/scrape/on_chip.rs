//! Scraping and rolling on the virtual core (`host-tests/images/scrape`).

use dsp_core::scrape::Motion;
use dsp_core::time::TICK_FRAMES;
use virtual_core::{CCM_ADDRESS, Call, Image, Machine};

use crate::on_chip::{KIT_FLASH, OnChipError, image};

/// Contact on a Cortex-M4F.
#[derive(Debug)]
pub struct ScraperOnChip {
    machine: Machine,
    image: Image,
}

impl ScraperOnChip {
    /// Builds the image (once a process), writes a kit, and begins a contact between two normal
    /// forces.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn new(
        kit: &[u8],
        (pad, striker, rolls): (usize, usize, bool),
        normal_n: [f32; 2],
    ) -> Result<Self, OnChipError> {
        let image = image("scrape-image")?;
        let mut machine = Machine::new(&image)?;
        machine.write(KIT_FLASH, kit)?;
        let [least, most] = normal_n.map(f32::to_bits);
        let request = [KIT_FLASH, kit.len() as u32, pad as u32, striker as u32, rolls.into(), least, most];
        let bytes: Vec<u8> = request.iter().flat_map(|word| word.to_le_bytes()).collect();
        machine.write(CCM_ADDRESS, &bytes)?;
        match machine.call("scrape_new", &[CCM_ADDRESS])?.value as i32 {
            0 => Ok(Self { machine, image }),
            code => Err(OnChipError::Refused { function: "scrape_new", code }),
        }
    }

    /// Goes on over a tick; gives its force, and the call with its cost.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn render(&mut self, motion: Motion) -> Result<([i32; TICK_FRAMES], Call), OnChipError> {
        let [x, y] = motion.velocity_m_per_s.map(f32::to_bits);
        let call = self.machine.call("scrape_render", &[x, y, motion.normal_n.to_bits(), CCM_ADDRESS])?;
        if call.value != 0 {
            return Err(OnChipError::Refused { function: "scrape_render", code: call.value as i32 });
        }
        let mut bytes = [0; 4 * TICK_FRAMES];
        self.machine.read(CCM_ADDRESS, &mut bytes)?;
        let mut force = [0; TICK_FRAMES];
        let words = bytes.as_chunks().0.iter().map(|&word| i32::from_le_bytes(word));
        force.iter_mut().zip(words).for_each(|(force, word)| *force = word);
        Ok((force, call))
    }

    /// Bytes of a contact's state.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn state_bytes(&mut self) -> Result<u32, OnChipError> {
        Ok(self.machine.call("scrape_bytes", &[])?.value)
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
