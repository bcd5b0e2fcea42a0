//! ADC1: regular conversions, scan mode, external trigger, DMA, overrun (RM0090 section 13, RM0383
//! section 11).
//!
//! A conversion samples its channel at the end of its sampling time and is done 12 ADC clocks later
//! (fewer at lower resolutions). Injected conversions, the analog watchdog and the internal
//! channels are not modelled.

use super::timer::TimerOutput;
use super::{Access, Context, Problem, Unmodelled};
use crate::frequency::{Frequency, Pace};

/// Bits of ADC_CR1 whose modes are not modelled: AWDIE, JEOCIE, JAUTO, DISCEN, JDISCEN, JAWDEN and
/// AWDEN.
const UNMODELLED_MODES: u32 = 1 << 6 | 1 << 7 | 1 << 10 | 1 << 11 | 1 << 12 | 1 << 22 | 1 << 23;
const SCAN: u32 = 1 << 8;
const ADON: u32 = 1 << 0;
const CONTINUOUS: u32 = 1 << 1;
const DMA: u32 = 1 << 8;
const DDS: u32 = 1 << 9;
const EOCS: u32 = 1 << 10;
const LEFT: u32 = 1 << 11;
const SWSTART: u32 = 1 << 30;
const EOC: u32 = 1 << 1;
const STRT: u32 = 1 << 4;
const OVR: u32 = 1 << 5;

/// Number of ADC clocks of a sampling time, by the field of ADC_SMPR.
const SAMPLING: [u64; 8] = [3, 15, 28, 56, 84, 112, 144, 480];

/// Time from ADON until conversions are right, in seconds (datasheets: t_STAB, 3 µs).
const START_S: f64 = 3e-6;

/// Returns the timer (2 to 5) and the output that trigger a conversion, by the field EXTSEL.
fn trigger(selection: u32) -> Option<(u8, TimerOutput)> {
    use TimerOutput::{Compare, Trigger};
    Some(match selection {
        3 => (2, Compare(2)),
        4 => (2, Compare(3)),
        5 => (2, Compare(4)),
        6 => (2, Trigger),
        7 => (3, Compare(1)),
        8 => (3, Trigger),
        9 => (4, Compare(4)),
        10 => (5, Compare(1)),
        11 => (5, Compare(2)),
        12 => (5, Compare(3)),
        _ => return None,
    })
}

#[derive(Debug, Clone, Copy)]
struct Conversion {
    index: usize,
    /// End of sampling, in ADC clocks from the start of the sequence.
    sample: u64,
    /// End of the conversion, in ADC clocks from the start of the sequence.
    done: u64,
    /// Sampled code, or `None` before the end of sampling.
    value: Option<u16>,
}

#[derive(Debug, Default)]
pub(crate) struct Adc {
    status: u32,
    control: [u32; 2],
    sampling: [u32; 2],
    other: [u32; 6],
    sequence: [u32; 3],
    common: u32,
    data: u32,
    on_since: u64,
    started: u64,
    /// Pace of the ADC's clock, or `None` before its first use.
    pace: Option<Pace>,
    conversion: Option<Conversion>,
    /// True if the DMA is requested to fetch the data register.
    request: bool,
    /// True if DMA must be switched on anew before the next request: after an overrun, or after the
    /// last transfer of the DMA with DDS off.
    requests_ended: bool,
    /// Number of triggers that were lost because they came while a sequence ran.
    pub(crate) lost_triggers: u64,
    /// Number of sequences that have begun.
    pub(crate) sequences: u64,
}

impl Adc {
    /// Resets the registers. The counts stay.
    pub(crate) fn reset(&mut self) {
        *self = Adc { lost_triggers: self.lost_triggers, sequences: self.sequences, ..Adc::default() };
    }

    pub(crate) fn read(&mut self, offset: u32) -> Access<u32> {
        Ok(match offset {
            0x00 => self.status,
            0x04 | 0x08 => self.control[(offset / 4 - 1) as usize],
            0x0c | 0x10 => self.sampling[(offset / 4 - 3) as usize],
            0x14..=0x28 => self.other[(offset / 4 - 5) as usize],
            0x2c..=0x34 => self.sequence[(offset / 4 - 11) as usize],
            0x4c => {
                self.status &= !EOC;
                self.request = false;
                self.data
            }
            0x300 => self.status & 0x3f,
            0x304 => self.common,
            _ => return Err(Problem::register()),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, context: &Context<'_>) -> Access<()> {
        match offset {
            0x00 => self.status &= value,
            0x04 if value & UNMODELLED_MODES != 0 => {
                return Err(Unmodelled::new("injected, discontinuous and watchdog modes of the ADC").into());
            }
            0x04 => self.control[0] = value,
            0x08 => self.write_control(value, context)?,
            0x0c | 0x10 => self.sampling[(offset / 4 - 3) as usize] = value,
            0x14..=0x28 => self.other[(offset / 4 - 5) as usize] = value,
            0x2c..=0x34 => self.sequence[(offset / 4 - 11) as usize] = value,
            0x304 if value & 0xdf1f != 0 => {
                return Err(Unmodelled::new("multi mode and internal channels of the ADC").into());
            }
            0x304 => {
                self.common = value;
                self.pace = self.pace.map(|_| self.pace_at(context));
            }
            _ => return Err(Problem::register()),
        }
        Ok(())
    }

    fn write_control(&mut self, value: u32, context: &Context<'_>) -> Access<()> {
        if value & 0x0070_0000 != 0 {
            return Err(Unmodelled::new("injected conversions").into());
        }
        let before = std::mem::replace(&mut self.control[1], value & !SWSTART);
        if value & !before & ADON != 0 {
            self.on_since = context.now;
        }
        if value & ADON == 0 {
            self.conversion = None;
            self.request = false;
        }
        if value & DMA == 0 {
            self.requests_ended = false;
            self.request = false;
        }
        let edge = value >> 28 & 3;
        if edge > 1 {
            return Err(Unmodelled::new("the falling edge of an ADC trigger").into());
        }
        if edge == 1 && trigger(value >> 24 & 0xf).is_none() {
            return Err(Unmodelled::new("that source of ADC triggers (ADC_CR2.EXTSEL)").into());
        }
        if value & SWSTART != 0 {
            self.start(context)?;
        }
        Ok(())
    }

    /// Starts a sequence if a timer's output, which has risen, is its trigger.
    pub(crate) fn triggered(&mut self, timer: u8, output: TimerOutput, context: &Context<'_>) -> Access<()> {
        let control = self.control[1];
        if control >> 28 & 3 != 1 || control & ADON == 0 || trigger(control >> 24 & 0xf) != Some((timer, output)) {
            return Ok(());
        }
        if self.conversion.is_some() {
            self.lost_triggers += 1;
            return Ok(());
        }
        self.start(context)
    }

    fn start(&mut self, context: &Context<'_>) -> Access<()> {
        if self.status & OVR != 0 || self.control[1] & ADON == 0 {
            return Ok(());
        }
        let core = context.clocks.core.as_f64();
        if ((context.now - self.on_since) as f64) < START_S * core {
            let reason = "a conversion starts less than 3 us after ADON; wait for the ADC to stabilise".to_owned();
            return Err(Problem::Misuse { reason });
        }
        if self.clock(context) > Frequency::hz(36_000_000) {
            let reason = format!("the ADC's clock is {}; at most 36 MHz (ADC_CCR.ADCPRE)", self.clock(context));
            return Err(Problem::Misuse { reason });
        }
        self.status |= STRT;
        self.started = context.now;
        self.pace = Some(self.pace_at(context));
        self.sequences += 1;
        self.convert(0, 0);
        Ok(())
    }

    fn clock(&self, context: &Context<'_>) -> Frequency {
        context.clocks.apb2.scaled(1, u64::from((self.common >> 16 & 3) * 2 + 2))
    }

    fn pace_at(&self, context: &Context<'_>) -> Pace {
        self.clock(context).for_each(context.clocks.core)
    }

    fn length(&self) -> usize {
        if self.control[0] & SCAN == 0 { 1 } else { (self.sequence[0] >> 20 & 0xf) as usize + 1 }
    }

    fn channel(&self, index: usize) -> u8 {
        let (register, place) = (2 - index / 6, index % 6);
        (self.sequence[register] >> (5 * place) & 0x1f) as u8
    }

    fn convert(&mut self, index: usize, from: u64) {
        let channel = u32::from(self.channel(index));
        let (register, place) = if channel >= 10 { (0, channel - 10) } else { (1, channel) };
        let sampling = SAMPLING[(self.sampling[register] >> (3 * place) & 7) as usize];
        let sample = from + sampling;
        let done = sample + u64::from(12 - 2 * (self.control[0] >> 24 & 3));
        self.conversion = Some(Conversion { index, sample, done, value: None });
    }

    /// Returns the cycle at which the next channel is sampled or its conversion ends.
    pub(crate) fn next_event(&self) -> u64 {
        let (Some(conversion), Some(pace)) = (self.conversion, self.pace) else { return u64::MAX };
        let clocks = if conversion.value.is_none() { conversion.sample } else { conversion.done };
        self.started + pace.cycle_of(clocks)
    }

    /// Samples a channel or ends its conversion. `level` returns the 12-bit code of a channel now.
    pub(crate) fn fire(&mut self, mut level: impl FnMut(u8) -> u16) {
        let Some(mut conversion) = self.conversion else { return };
        let Some(value) = conversion.value else {
            conversion.value = Some(level(self.channel(conversion.index)));
            self.conversion = Some(conversion);
            return;
        };
        self.conversion = None;
        let last = conversion.index + 1 == self.length();
        let with_dma = self.control[1] & DMA != 0;
        let waits = if with_dma { self.request } else { self.status & EOC != 0 && self.control[1] & EOCS != 0 };
        if waits {
            self.overrun();
            return;
        }
        let value = u32::from(value) >> (2 * (self.control[0] >> 24 & 3));
        self.data = if self.control[1] & LEFT != 0 { value << 4 } else { value };
        if self.control[1] & EOCS != 0 || last {
            self.status |= EOC;
        }
        self.request = with_dma && !self.requests_ended;
        if !last {
            self.convert(conversion.index + 1, conversion.done);
        } else if self.control[1] & CONTINUOUS != 0 {
            self.convert(0, conversion.done);
        }
    }

    /// Notes that data was not fetched in time.
    ///
    /// Conversions end until the flag is cleared, and DMA requests until the DMA bit is cleared.
    pub(crate) fn overrun(&mut self) {
        self.status |= OVR;
        self.conversion = None;
        self.request = false;
        self.requests_ended = true;
    }

    /// Returns true if the DMA is requested.
    pub(crate) fn requests_dma(&self) -> bool {
        self.request
    }

    /// Notes that the DMA has made the last transfer of its buffer.
    pub(crate) fn dma_complete(&mut self) {
        if self.control[1] & DDS == 0 {
            self.requests_ended = true;
        }
    }

    /// Returns true if a sequence runs or a trigger may start one.
    pub(crate) fn is_running(&self) -> bool {
        self.control[1] & ADON != 0 && (self.conversion.is_some() || self.control[1] >> 28 & 3 != 0)
    }

    /// Returns true if the interrupt is asserted.
    pub(crate) fn is_asserted(&self) -> bool {
        let eoc = self.status & EOC != 0 && self.control[0] & 1 << 5 != 0;
        eoc || self.status & OVR != 0 && self.control[0] & 1 << 26 != 0
    }
}
