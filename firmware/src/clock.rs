//! A board's clocks: all rates, derived from the numbers in the clock-tree registers.
//!
//! ```text
//! crystal ─┬─ /M ─ ×N ─┬─ /P ── core, AHB ─┬─ /APB1 ── I2C, SPI; timers ×2 ── ADC trigger
//!          │           └─ /Q ── USB         └─ /APB2 ── ADC /4
//!          └─ /M ─ ×N ─── /R ── I2S ── /(256 or 64) ── /prescaler ── sample rate
//! ```

use dsp_core::SampleRate;
use embassy_stm32::rcc;
use embassy_stm32::time::Hertz;

/// Numbers in the clock tree of one board.
#[derive(Clone, Copy, Debug)]
pub struct ClockPlan {
    /// Frequency of the crystal in Hz.
    pub crystal_hz: u32,
    /// PLL input divider M.
    pub divider: u8,
    /// PLL multiplier N.
    pub multiplier: u16,
    /// PLL output divider P, which makes the core clock.
    pub core_divider: rcc::PllPDiv,
    /// PLL output divider Q, which makes the 48 MHz of USB.
    pub usb_divider: u8,
    /// Divider of the bus APB1.
    pub apb1: rcc::APBPrescaler,
    /// Divider of the bus APB2.
    pub apb2: rcc::APBPrescaler,
    /// Numbers behind the I2S clock.
    pub audio: AudioClock,
}

/// Numbers behind the sample rate on the I2S pins.
#[derive(Clone, Copy, Debug)]
pub struct AudioClock {
    /// PLLI2S input divider M.
    ///
    /// It must equal [`ClockPlan::divider`] if the chip has one divider for both PLLs.
    pub divider: u8,
    /// PLLI2S multiplier N.
    pub multiplier: u16,
    /// PLLI2S output divider R.
    pub output_divider: u8,
    /// Prescaler of the I2S peripheral, 2 I2SDIV + ODD.
    pub prescaler: u16,
    /// True if a master clock of 256 times the sample rate leaves the chip.
    pub master_clock: bool,
}

/// Bits of one frame on the I2S wire: two slots of 32.
const FRAME_BITS: u32 = 64;
/// Periods of the master clock in one frame.
const MASTER_CLOCKS_PER_FRAME: u32 = 256;
/// Frequency of the chip's own oscillator HSI in Hz.
const HSI_HZ: u32 = 16_000_000;
/// Rate at which the piezos are sampled, in Hz.
pub const ADC_RATE_HZ: u32 = 48_000;

impl ClockPlan {
    /// Returns the divider M with which the chip's own oscillator makes the input of the PLLs.
    const fn hsi_divider(&self) -> u8 {
        let input_hz = self.crystal_hz / self.divider as u32;
        assert!(HSI_HZ.is_multiple_of(input_hz), "HSI must divide to the input of the PLLs");
        (HSI_HZ / input_hz) as u8
    }

    /// Returns the core clock in Hz.
    pub const fn core_hz(&self) -> u32 {
        self.crystal_hz / self.divider as u32 * self.multiplier as u32 / (2 * (self.core_divider as u32 + 1))
    }

    /// Returns the clock of the timers on APB1 in Hz.
    ///
    /// It is twice the bus clock if the bus clock is divided.
    pub const fn timer_hz(&self) -> u32 {
        match self.apb1 {
            rcc::APBPrescaler::DIV1 => self.core_hz(),
            rcc::APBPrescaler::DIV2 => self.core_hz(),
            rcc::APBPrescaler::DIV4 => self.core_hz() / 2,
            rcc::APBPrescaler::DIV8 => self.core_hz() / 4,
            _ => self.core_hz() / 8,
        }
    }

    /// Returns the number of timer periods between two samples of the ADC.
    pub const fn adc_period(&self) -> u32 {
        assert!(self.timer_hz().is_multiple_of(ADC_RATE_HZ), "the timer must divide to the ADC's rate");
        self.timer_hz() / ADC_RATE_HZ
    }

    /// Returns the sample rate on the I2S pins in Hz, as numerator and denominator.
    // Inlined, it leaves no division that could panic.
    #[inline(always)]
    pub const fn sample_rate_ratio(&self) -> (u32, u32) {
        let AudioClock { divider, multiplier, output_divider, prescaler, master_clock } = self.audio;
        let clock_hz = self.crystal_hz / divider as u32 * multiplier as u32 / output_divider as u32;
        (clock_hz, if master_clock { MASTER_CLOCKS_PER_FRAME } else { FRAME_BITS } * prescaler as u32)
    }

    /// Returns the sample rate on the I2S pins.
    #[inline(always)]
    pub fn sample_rate(&self) -> SampleRate {
        let (numerator, denominator) = self.sample_rate_ratio();
        SampleRate::new(numerator, denominator).unwrap_or(SampleRate::HZ_48000)
    }

    /// Returns the number of core cycles in which `frames` frames leave, rounded down.
    pub const fn cycles_per_frames(&self, frames: u32) -> u32 {
        let (numerator, denominator) = self.sample_rate_ratio();
        (self.core_hz() as u64 * frames as u64 * denominator as u64 / numerator as u64) as u32
    }

    /// Returns these clocks in the form that the hardware library takes.
    ///
    /// Without the crystal the chip's own oscillator makes the same input of the PLLs, and so all
    /// rates, with its error of up to 1 % at room temperature.
    pub fn rcc(&self, has_crystal: bool) -> rcc::Config {
        let mut config = rcc::Config::new();
        let divider =
            |of_crystal: u8| rcc::PllPreDiv::from_bits(if has_crystal { of_crystal } else { self.hsi_divider() });
        config.hsi = !has_crystal;
        // Neither the low-speed crystal nor the real-time clock is used.
        config.ls = rcc::LsConfig::off();
        config.hse = has_crystal.then_some(rcc::Hse { freq: Hertz(self.crystal_hz), mode: rcc::HseMode::Oscillator });
        config.pll_src = if has_crystal { rcc::PllSource::HSE } else { rcc::PllSource::HSI };
        config.pll = Some(rcc::Pll {
            prediv: divider(self.divider),
            mul: rcc::PllMul::from_bits(self.multiplier),
            divp: Some(self.core_divider),
            divq: Some(rcc::PllQDiv::from_bits(self.usb_divider)),
            divr: None,
        });
        config.plli2s = Some(rcc::Pll {
            prediv: divider(self.audio.divider),
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
