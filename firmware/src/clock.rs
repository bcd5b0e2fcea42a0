//! A board's clocks: every rate that anything else uses is derived here, from the numbers that go into the clock-tree registers.
//!
//! ```text
//! crystal ─┬─ /M ─ ×N ─┬─ /P ── core, AHB ─┬─ /APB1 ── I2C, SPI; timers ×2 ── ADC trigger
//!          │           └─ /Q ── USB         └─ /APB2 ── ADC /4
//!          └─ /M ─ ×N ─── /R ── I2S ── /(256 or 64) ── /prescaler ── sample rate
//! ```

use dsp_core::SampleRate;
use embassy_stm32::rcc;
use embassy_stm32::time::Hertz;

/// The numbers in the clock tree of one board.
#[derive(Clone, Copy, Debug)]
pub struct ClockPlan {
    /// Crystal, Hz.
    pub crystal_hz: u32,
    /// PLL input divider M.
    pub divider: u8,
    /// PLL multiplier N.
    pub multiplier: u16,
    /// PLL output divider P of the core clock.
    pub core_divider: rcc::PllPDiv,
    /// PLL output divider Q of USB's 48 MHz.
    pub usb_divider: u8,
    /// APB1 divider.
    pub apb1: rcc::APBPrescaler,
    /// APB2 divider.
    pub apb2: rcc::APBPrescaler,
    /// The I2S clock.
    pub audio: AudioClock,
}

/// The numbers behind the sample rate.
#[derive(Clone, Copy, Debug)]
pub struct AudioClock {
    /// PLLI2S input divider M. Where a chip has only one for both PLLs it must be the same.
    pub divider: u8,
    /// PLLI2S multiplier N.
    pub multiplier: u16,
    /// PLLI2S output divider R.
    pub output_divider: u8,
    /// The peripheral's own prescaler, 2 I2SDIV + ODD.
    pub prescaler: u16,
    /// Whether a master clock of 256 times the rate leaves the chip.
    pub master_clock: bool,
}

/// Bits of one frame on the wire: two slots of 32.
const FRAME_BITS: u32 = 64;
/// Master clock periods in a frame.
const MASTER_CLOCKS_PER_FRAME: u32 = 256;
/// The piezos are sampled at this rate, Hz.
pub const ADC_RATE_HZ: u32 = 48_000;

impl ClockPlan {
    /// Core clock, Hz.
    pub const fn core_hz(&self) -> u32 {
        self.crystal_hz / self.divider as u32 * self.multiplier as u32 / (2 * (self.core_divider as u32 + 1))
    }

    /// Clock of the timers on APB1, Hz: twice the bus's where that is divided.
    pub const fn timer_hz(&self) -> u32 {
        match self.apb1 {
            rcc::APBPrescaler::DIV1 => self.core_hz(),
            rcc::APBPrescaler::DIV2 => self.core_hz(),
            rcc::APBPrescaler::DIV4 => self.core_hz() / 2,
            rcc::APBPrescaler::DIV8 => self.core_hz() / 4,
            _ => self.core_hz() / 8,
        }
    }

    /// Timer ticks between two samples of the ADC.
    pub const fn adc_period(&self) -> u32 {
        assert!(self.timer_hz().is_multiple_of(ADC_RATE_HZ), "the timer must divide to the ADC's rate");
        self.timer_hz() / ADC_RATE_HZ
    }

    /// The sample rate on the I2S pins as a ratio, Hz.
    #[inline(always)] // so that no division is left that could fail
    pub const fn sample_rate_ratio(&self) -> (u32, u32) {
        let AudioClock { divider, multiplier, output_divider, prescaler, master_clock } = self.audio;
        let clock_hz = self.crystal_hz / divider as u32 * multiplier as u32 / output_divider as u32;
        (clock_hz, if master_clock { MASTER_CLOCKS_PER_FRAME } else { FRAME_BITS } * prescaler as u32)
    }

    /// The sample rate on the I2S pins.
    #[inline(always)]
    pub fn sample_rate(&self) -> SampleRate {
        let (numerator, denominator) = self.sample_rate_ratio();
        SampleRate::new(numerator, denominator).unwrap_or(SampleRate::HZ_48000)
    }

    /// Core cycles in which so many frames leave, rounded down.
    pub const fn cycles_per_frames(&self, frames: u32) -> u32 {
        let (numerator, denominator) = self.sample_rate_ratio();
        (self.core_hz() as u64 * frames as u64 * denominator as u64 / numerator as u64) as u32
    }

    /// The same for the hardware library.
    pub fn rcc(&self) -> rcc::Config {
        let mut config = rcc::Config::new();
        config.hsi = false;
        // Neither the low-speed crystal nor the real-time clock is used.
        config.ls = rcc::LsConfig::off();
        config.hse = Some(rcc::Hse { freq: Hertz(self.crystal_hz), mode: rcc::HseMode::Oscillator });
        config.pll_src = rcc::PllSource::HSE;
        config.pll = Some(rcc::Pll {
            prediv: rcc::PllPreDiv::from_bits(self.divider),
            mul: rcc::PllMul::from_bits(self.multiplier),
            divp: Some(self.core_divider),
            divq: Some(rcc::PllQDiv::from_bits(self.usb_divider)),
            divr: None,
        });
        config.plli2s = Some(rcc::Pll {
            prediv: rcc::PllPreDiv::from_bits(self.audio.divider),
            mul: rcc::PllMul::from_bits(self.audio.multiplier),
            divp: None,
            divq: None,
            divr: Some(rcc::PllRDiv::from_bits(self.audio.output_divider)),
        });
        config.sys = rcc::Sysclk::PLL1_P;
        config.ahb_pre = rcc::AHBPrescaler::DIV1;
        config.apb1_pre = self.apb1;
        config.apb2_pre = self.apb2;
        config
    }
}
