//! RCC: oscillators, PLLs, bus prescalers, enable and reset bits (RM0090 section 7, RM0383 section
//! 6).
//!
//! All rates on the board derive from the [`ClockTree`] that these registers make. Oscillators
//! become ready after their start-up time: the HSE after 2 ms, a PLL after 0.2 ms (datasheets,
//! typical and maximum), LSI and HSI at once.

use super::{Access, Context, Problem, Unmodelled};
use crate::chip::Chip;
use crate::frequency::Frequency;

const HSI: Frequency = Frequency::hz(16_000_000);
const HSE_START_S: f64 = 2e-3;
const PLL_LOCK_S: f64 = 0.2e-3;

const HSION: u32 = 1 << 0;
const HSEON: u32 = 1 << 16;
const PLLON: u32 = 1 << 24;
const PLLI2SON: u32 = 1 << 26;

/// Flag of RCC_CSR: the program reset the chip.
const CSR_SOFTWARE: u32 = 1 << 28;
/// Flag of RCC_CSR: the independent watchdog reset the chip.
const CSR_WATCHDOG: u32 = 1 << 29;
/// Flag of RCC_CSR: the reset pin was low, as in every reset.
const CSR_PIN: u32 = 1 << 26;
/// Flags of RCC_CSR after power-on.
const CSR_POWER: u32 = 0b11 << 25 | 1 << 27;
/// Bit of RCC_CSR that clears the flags.
const CSR_REMOVE: u32 = 1 << 24;

/// Frequencies that the registers make.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ClockTree {
    /// Clock of the core and the AHB (HCLK).
    pub(crate) core: Frequency,
    /// Clock of APB1 (PCLK1).
    pub(crate) apb1: Frequency,
    /// Clock of the timers on APB1.
    pub(crate) apb1_timers: Frequency,
    /// Clock of APB2 (PCLK2).
    pub(crate) apb2: Frequency,
    /// Clock of the I2S, if PLLI2S runs.
    pub(crate) i2s: Option<Frequency>,
    /// Clock of USB (PLL48CK), if the PLL runs.
    pub(crate) usb: Option<Frequency>,
}

/// Cause of a reset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum ResetCause {
    /// Power was switched on.
    Power,
    /// The program requested the reset (AIRCR.SYSRESETREQ).
    Software,
    /// The independent watchdog ran out.
    Watchdog,
}

#[derive(Debug)]
pub(crate) struct Rcc {
    chip: Chip,
    hse: Frequency,
    /// True if the crystal starts when the HSE is switched on.
    crystal_starts: bool,
    registers: [u32; 0x94 / 4],
    /// Cycle at which the HSE is ready.
    hse_ready: u64,
    /// Cycle at which the PLL is ready.
    pll_ready: u64,
    /// Cycle at which PLLI2S is ready.
    plli2s_ready: u64,
}

// Indices of registers are their offsets divided by 4.
const CR: usize = 0;
const PLLCFGR: usize = 1;
const CFGR: usize = 2;
const BDCR: usize = 0x70 / 4;
const CSR: usize = 0x74 / 4;
const PLLI2SCFGR: usize = 0x84 / 4;
const DCKCFGR: usize = 0x8c / 4;

impl Rcc {
    /// Makes the RCC after a reset.
    pub(crate) fn new(chip: Chip, hse: Frequency, cause: ResetCause) -> Rcc {
        let mut registers = [0; 0x94 / 4];
        registers[CR] = HSION;
        registers[PLLCFGR] = 0x2400_3010;
        registers[0x30 / 4] = if chip == Chip::Stm32F407 { 0x0010_0000 } else { 0 };
        registers[PLLI2SCFGR] = if chip == Chip::Stm32F407 { 0x2000_3000 } else { 0x2400_3000 };
        registers[CSR] = CSR_PIN
            | match cause {
                ResetCause::Power => CSR_POWER,
                ResetCause::Software => CSR_SOFTWARE,
                ResetCause::Watchdog => CSR_WATCHDOG,
            };
        let (hse_ready, pll_ready, plli2s_ready) = (u64::MAX, u64::MAX, u64::MAX);
        Rcc { chip, hse, crystal_starts: true, registers, hse_ready, pll_ready, plli2s_ready }
    }

    /// Resets the registers. The crystal stays as it is.
    pub(crate) fn reset(&mut self, cause: ResetCause) {
        *self = Rcc { crystal_starts: self.crystal_starts, ..Rcc::new(self.chip, self.hse, cause) };
    }

    /// Lets the crystal never start again.
    pub(crate) fn kill_crystal(&mut self) {
        self.crystal_starts = false;
    }

    pub(crate) fn read(&self, offset: u32, context: &Context<'_>) -> Access<u32> {
        let index = self.index(offset)?;
        let value = self.registers[index];
        Ok(match index {
            CR => {
                let on = |bit: u32, ready: u64| if value & bit != 0 && context.now >= ready { bit << 1 } else { 0 };
                let hsi = (value & HSION) << 1;
                value | hsi | on(HSEON, self.hse_ready) | on(PLLON, self.pll_ready) | on(PLLI2SON, self.plli2s_ready)
            }
            CFGR => value & !0xc | (value & 3) << 2,
            CSR => value | (value & 1) << 1,
            _ => value,
        })
    }

    /// Writes a register and checks that the selected clock runs.
    pub(crate) fn write(&mut self, offset: u32, value: u32, context: &Context<'_>) -> Access<()> {
        let index = self.index(offset)?;
        let before = self.registers[index];
        self.registers[index] = value;
        match index {
            CR => {
                let after = |seconds: f64| context.now + (seconds * context.clocks.core.as_f64()) as u64;
                let started = |bit: u32| value & !before & bit != 0;
                if started(HSEON) && self.crystal_starts {
                    self.hse_ready = after(HSE_START_S);
                }
                if started(PLLON) {
                    self.pll_ready = after(PLL_LOCK_S);
                }
                if started(PLLI2SON) {
                    self.plli2s_ready = after(PLL_LOCK_S);
                }
                self.check_running(context.now)
            }
            PLLCFGR if self.registers[CR] & PLLON != 0 && value != before => Err(Problem::ClockTree {
                reason: "RCC_PLLCFGR is written while the PLL is on; switch it off first".to_owned(),
            }),
            PLLI2SCFGR if self.registers[CR] & PLLI2SON != 0 && value != before => Err(Problem::ClockTree {
                reason: "RCC_PLLI2SCFGR is written while PLLI2S is on; switch it off first".to_owned(),
            }),
            CFGR => self.check_running(context.now),
            CSR if value & CSR_REMOVE != 0 => {
                self.registers[CSR] = value & 1;
                Ok(())
            }
            CSR => {
                self.registers[CSR] = before & !1 | value & 1;
                Ok(())
            }
            DCKCFGR if value != 0 => Err(Unmodelled::new("a dedicated clock (RCC_DCKCFGR)").into()),
            BDCR if value & 1 != 0 => Err(Unmodelled::new("the 32 kHz crystal (RCC_BDCR.LSEON)").into()),
            _ => Ok(()),
        }
    }

    fn index(&self, offset: u32) -> Access<usize> {
        let known = matches!(
            offset,
            0x00..=0x10
                | 0x14
                | 0x18
                | 0x20
                | 0x24
                | 0x30
                | 0x34
                | 0x38
                | 0x40
                | 0x44
                | 0x50
                | 0x54
                | 0x58
                | 0x60
                | 0x64
                | 0x70
                | 0x74
                | 0x80
                | 0x84
                | 0x8c
        );
        if known { Ok((offset / 4) as usize) } else { Err(Problem::register()) }
    }

    /// Returns true if the enable bit of a device is set. `register` is the offset of the register
    /// with the bit, such as RCC_AHB1ENR.
    pub(crate) fn is_enabled(&self, register: u32, bit: u32) -> bool {
        self.registers[(register / 4) as usize] & 1 << bit != 0
    }

    /// Returns true if the reset bit that belongs to an enable bit is set.
    pub(crate) fn is_held_in_reset(&self, register: u32, bit: u32) -> bool {
        self.registers[((register - 0x20) / 4) as usize] & 1 << bit != 0
    }

    /// Returns true if a device is held in reset.
    pub(crate) fn holds_resets(&self) -> bool {
        [0x10, 0x14, 0x20, 0x24].into_iter().any(|offset: usize| self.registers[offset / 4] != 0)
    }

    /// Checks that the selected system clock runs.
    fn check_running(&self, now: u64) -> Access<()> {
        let cr = self.registers[CR];
        let runs = match self.registers[CFGR] & 3 {
            0 => cr & HSION != 0,
            1 => cr & HSEON != 0 && now >= self.hse_ready,
            2 => cr & PLLON != 0 && now >= self.pll_ready,
            _ => false,
        };
        if runs {
            return Ok(());
        }
        let reason = "RCC_CFGR.SW selects a clock that is not running; wait for its ready flag in RCC_CR".to_owned();
        Err(Problem::ClockTree { reason })
    }

    /// Returns the input frequency of a PLL, if the PLL supports it.
    fn pll_input(&self, divider: u32) -> Access<Frequency> {
        let source = if self.registers[PLLCFGR] & 1 << 22 != 0 { self.hse } else { HSI };
        let input = source.scaled(1, u64::from(divider));
        if divider < 2 || input < Frequency::hz(950_000) || input > Frequency::hz(2_100_000) {
            let reason = format!("a PLL's input is {input} ({source} / {divider}); it must be 0.95 to 2.1 MHz");
            return Err(Problem::ClockTree { reason });
        }
        Ok(input)
    }

    /// Returns the frequency of a PLL's oscillator, if the PLL supports it.
    fn oscillator(input: Frequency, multiplier: u32) -> Access<Frequency> {
        let output = input.scaled(u64::from(multiplier), 1);
        if !(50..=432).contains(&multiplier)
            || !(Frequency::hz(100_000_000)..=Frequency::hz(432_000_000)).contains(&output)
        {
            let reason =
                format!("a PLL's oscillator makes {output} ({input} x {multiplier}); it must be 100 to 432 MHz");
            return Err(Problem::ClockTree { reason });
        }
        Ok(output)
    }

    /// Returns the frequencies that the registers make, if the chip supports them.
    pub(crate) fn tree(&self) -> Access<ClockTree> {
        let pllcfgr = self.registers[PLLCFGR];
        let cfgr = self.registers[CFGR];
        let system = match cfgr & 3 {
            0 => HSI,
            1 => self.hse,
            _ => {
                let oscillator = Rcc::oscillator(self.pll_input(pllcfgr & 0x3f)?, pllcfgr >> 6 & 0x1ff)?;
                oscillator.scaled(1, u64::from((pllcfgr >> 16 & 3) * 2 + 2))
            }
        };
        let ahb = [1, 2, 4, 8, 16, 64, 128, 256, 512];
        let hpre = cfgr >> 4 & 0xf;
        let core = system.scaled(1, ahb[if hpre < 8 { 0 } else { hpre as usize - 7 }]);
        let apb = |field: u32| if field < 4 { 1 } else { 2 << (field - 4) };
        let (ppre1, ppre2) = (apb(cfgr >> 10 & 7), apb(cfgr >> 13 & 7));
        let apb1 = core.scaled(1, ppre1);
        let tree = ClockTree {
            core,
            apb1,
            apb1_timers: if ppre1 == 1 { apb1 } else { apb1.scaled(2, 1) },
            apb2: core.scaled(1, ppre2),
            i2s: self.i2s_clock()?,
            usb: self.usb_clock(),
        };
        let limits = self.chip.limits();
        for (name, frequency, limit) in
            [("HCLK", core, limits.hclk), ("PCLK1", apb1, limits.pclk1), ("PCLK2", tree.apb2, limits.pclk2)]
        {
            if frequency > limit {
                let reason = format!("{name} is {frequency}; the {} allows {limit}", self.chip.name());
                return Err(Problem::ClockTree { reason });
            }
        }
        Ok(tree)
    }

    /// Returns the clock of USB, or `None` if the PLL is off or makes none.
    fn usb_clock(&self) -> Option<Frequency> {
        let pllcfgr = self.registers[PLLCFGR];
        let divider = pllcfgr >> 24 & 0xf;
        if self.registers[CR] & PLLON == 0 || divider < 2 {
            return None;
        }
        let oscillator = Rcc::oscillator(self.pll_input(pllcfgr & 0x3f).ok()?, pllcfgr >> 6 & 0x1ff).ok()?;
        Some(oscillator.scaled(1, u64::from(divider)))
    }

    /// Returns the clock of the I2S, or `None` if PLLI2S is off.
    fn i2s_clock(&self) -> Access<Option<Frequency>> {
        if self.registers[CFGR] & 1 << 23 != 0 {
            return Err(Unmodelled::new("the external I2S clock (RCC_CFGR.I2SSRC)").into());
        }
        if self.registers[CR] & PLLI2SON == 0 {
            return Ok(None);
        }
        let plli2s = self.registers[PLLI2SCFGR];
        let divider = match self.chip {
            Chip::Stm32F407 => self.registers[PLLCFGR] & 0x3f,
            Chip::Stm32F411 => plli2s & 0x3f,
        };
        let oscillator = Rcc::oscillator(self.pll_input(divider)?, plli2s >> 6 & 0x1ff)?;
        let output = plli2s >> 28 & 7;
        if output < 2 || oscillator.scaled(1, u64::from(output)) > Frequency::hz(192_000_000) {
            let reason =
                format!("PLLI2S divides {oscillator} by {output}; R must be at least 2, its output at most 192 MHz");
            return Err(Problem::ClockTree { reason });
        }
        Ok(Some(oscillator.scaled(1, u64::from(output))))
    }
}
