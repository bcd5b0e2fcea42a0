//! Differences between the two microcontrollers.

use virtual_core::FLASH_ADDRESS;

use crate::frequency::Frequency;

/// Microcontroller of the STM32F4 family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Chip {
    /// STM32F407VG (reference manual RM0090).
    Stm32F407,
    /// STM32F411CE (reference manual RM0383).
    Stm32F411,
}

/// Highest frequencies of the core's bus and of the two peripheral buses.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    pub(crate) hclk: Frequency,
    pub(crate) pclk1: Frequency,
    pub(crate) pclk2: Frequency,
}

/// Sector of a chip's flash: the smallest part that can be erased.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sector {
    /// Address of its first byte.
    pub address: u32,
    /// Length in bytes.
    pub bytes: u32,
}

/// Sectors of the STM32F407VG, of which the STM32F411CE has the first eight: four of 16 KB, one of
/// 64 KB, the others of 128 KB (RM0090 table 5, RM0383 table 4).
const SECTORS: [Sector; 12] = {
    let mut sectors = [Sector { address: FLASH_ADDRESS, bytes: 16 << 10 }; 12];
    let mut number = 1;
    while number < 12 {
        let before = sectors[number - 1];
        let kilobytes = if number < 4 {
            16
        } else if number == 4 {
            64
        } else {
            128
        };
        sectors[number] = Sector { address: before.address + before.bytes, bytes: kilobytes << 10 };
        number += 1;
    }
    sectors
};

impl Chip {
    /// Returns the name of the chip.
    pub fn name(self) -> &'static str {
        match self {
            Chip::Stm32F407 => "STM32F407VG",
            Chip::Stm32F411 => "STM32F411CE",
        }
    }

    /// Returns the first address and the length in bytes of the flash sector for a kit, 128 KB.
    pub fn kit_sector(self) -> (u32, u32) {
        match self {
            Chip::Stm32F407 => (0x080e_0000, 128 << 10),
            Chip::Stm32F411 => (0x0806_0000, 128 << 10),
        }
    }

    /// Returns the sectors of flash, sector 0 first.
    pub fn sectors(self) -> &'static [Sector] {
        match self {
            Chip::Stm32F407 => &SECTORS,
            Chip::Stm32F411 => &SECTORS[..8],
        }
    }

    /// Returns the number of the sector that contains an address, or `None` outside flash.
    pub fn sector_at(self, address: u32) -> Option<u8> {
        let found = self.sectors().iter().position(|sector| address.wrapping_sub(sector.address) < sector.bytes);
        found.map(|number| number as u8)
    }

    /// Returns the number of bytes of flash.
    pub fn flash_bytes(self) -> u32 {
        match self {
            Chip::Stm32F407 => 1 << 20,
            Chip::Stm32F411 => 512 << 10,
        }
    }

    /// Returns the number of bytes of RAM that DMA reaches.
    pub fn ram_bytes(self) -> u32 {
        128 << 10
    }

    /// Returns the number of bytes of core-coupled memory.
    pub fn ccm_bytes(self) -> u32 {
        match self {
            Chip::Stm32F407 => 64 << 10,
            Chip::Stm32F411 => 0,
        }
    }

    /// Returns the value of DBGMCU_IDCODE.
    pub(crate) fn identity(self) -> u32 {
        match self {
            Chip::Stm32F407 => 0x1007_6413,
            Chip::Stm32F411 => 0x1000_6431,
        }
    }

    /// Returns the highest frequencies of the buses.
    pub(crate) fn limits(self) -> Limits {
        let mhz = |mhz: u64| Frequency::hz(mhz * 1_000_000);
        match self {
            Chip::Stm32F407 => Limits { hclk: mhz(168), pclk1: mhz(42), pclk2: mhz(84) },
            Chip::Stm32F411 => Limits { hclk: mhz(100), pclk1: mhz(50), pclk2: mhz(100) },
        }
    }

    /// Returns the number of wait states that flash needs at a core clock, for a supply of 2.7 to
    /// 3.6 V (RM0090 table 10, RM0383 table 5).
    pub(crate) fn wait_states(self, hclk: Frequency) -> u32 {
        let above = match self {
            Chip::Stm32F407 => &[30, 60, 90, 120, 150][..],
            Chip::Stm32F411 => &[30, 64, 90][..],
        };
        above.iter().filter(|&&mhz| hclk > Frequency::hz(mhz * 1_000_000)).count() as u32
    }

    /// Returns the highest core clock that a scale of the regulator (PWR_CR.VOS) supports.
    pub(crate) fn hclk_at_scale(self, vos: u32) -> Frequency {
        let mhz = match (self, vos) {
            (Chip::Stm32F407, 0) => 144,
            (Chip::Stm32F407, _) => 168,
            (Chip::Stm32F411, 3) => 100,
            (Chip::Stm32F411, 2) => 84,
            (Chip::Stm32F411, _) => 64,
        };
        Frequency::hz(mhz * 1_000_000)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sectors_of_each_chip_fill_its_flash_and_the_kit_has_the_last() {
        for chip in [Chip::Stm32F407, Chip::Stm32F411] {
            let sectors = chip.sectors();
            assert_eq!(sectors.iter().map(|sector| sector.bytes).sum::<u32>(), chip.flash_bytes());
            assert!(sectors.windows(2).all(|pair| pair[0].address + pair[0].bytes == pair[1].address));
            let last = sectors[sectors.len() - 1];
            assert_eq!((last.address, last.bytes), chip.kit_sector());
            assert_eq!(chip.sector_at(last.address - 1), Some(sectors.len() as u8 - 2));
            assert_eq!(chip.sector_at(FLASH_ADDRESS + chip.flash_bytes()), None);
        }
    }
}
