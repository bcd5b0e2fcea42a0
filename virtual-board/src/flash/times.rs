//! Times of operations (data sheets of the STM32F407, DS8626, table "Flash memory programming", and
//! of the STM32F411, DS10314, which has the same times). They hold for 2.7 to 3.6 V.

use std::time::Duration;

/// Column of the data sheet's times.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum FlashTimes {
    /// Typical times.
    #[default]
    Typical,
    /// Maximum times.
    Maximum,
}

/// Number of bits that are programmed or erased at once (FLASH_CR.PSIZE).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Parallelism {
    Byte,
    HalfWord,
    Word,
}

impl Parallelism {
    /// Returns the parallelism of a field PSIZE, or `None` for 64 bits, which take a supply of
    /// their own.
    pub(crate) fn of(psize: u32) -> Option<Parallelism> {
        [Parallelism::Byte, Parallelism::HalfWord, Parallelism::Word].get(psize as usize).copied()
    }

    /// Returns the number of bytes that a store of this parallelism has.
    pub(crate) fn bytes(self) -> u32 {
        1 << self as u32
    }
}

impl FlashTimes {
    fn column(self, typical: Duration, maximum: Duration) -> Duration {
        match self {
            FlashTimes::Typical => typical,
            FlashTimes::Maximum => maximum,
        }
    }

    /// Returns the time in which a byte, half-word or word is programmed.
    pub(crate) fn program(self) -> Duration {
        self.column(Duration::from_micros(16), Duration::from_micros(100))
    }

    /// Returns the time in which a sector of 16, 64 or 128 KB is erased.
    pub(crate) fn erase(self, sector_bytes: u32, parallelism: Parallelism) -> Duration {
        let row = match sector_bytes >> 10 {
            16 => [(400, 800), (300, 600), (250, 500)],
            64 => [(1200, 2400), (700, 1400), (550, 1100)],
            _ => [(2000, 4000), (1300, 2600), (1000, 2000)],
        };
        let (typical, maximum) = row[parallelism as usize];
        self.column(Duration::from_millis(typical), Duration::from_millis(maximum))
    }

    /// Returns the time in which the option bytes are written, which the data sheets do not give.
    /// They lie in a sector of their own, so the time of the smallest sector is assumed.
    pub(crate) fn options(self) -> Duration {
        self.erase(16 << 10, Parallelism::Word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_erases_take_less_time_and_larger_sectors_more() {
        for times in [FlashTimes::Typical, FlashTimes::Maximum] {
            for bytes in [16 << 10, 64 << 10, 128 << 10] {
                let [byte, half, word] = [Parallelism::Byte, Parallelism::HalfWord, Parallelism::Word]
                    .map(|parallelism| times.erase(bytes, parallelism));
                assert!(byte > half && half > word && word > times.program());
            }
        }
        assert_eq!(FlashTimes::Typical.erase(128 << 10, Parallelism::Word), Duration::from_secs(1));
        assert_eq!(FlashTimes::Maximum.erase(128 << 10, Parallelism::Byte), Duration::from_secs(4));
    }
}
