//! Piezos: timer 3 triggers ADC1 48 000 times per second to scan their channels, and DMA2 writes
//! the counts to a ring.
//!
//! There is no interrupt: the reader of the frames looks how far the DMA has come.

use core::cell::UnsafeCell;
use core::sync::atomic::{Ordering, compiler_fence};

use embassy_stm32::gpio::{Flex, Pull};
use embassy_stm32::pac::adc::vals::{Dds, Exten, SampleTime};
use embassy_stm32::pac::adccommon::vals::Adcpre;
use embassy_stm32::pac::dma::vals::{Dir, Pl, Size};
use embassy_stm32::pac::timer::vals::Mms;
use embassy_stm32::pac::{ADC1, DMA2, TIM3};
use embassy_stm32::{peripherals, rcc};
use embassy_time::{Duration, block_for};

use crate::board::{ADC_COMMON, CLOCKS, PIEZO_CHANNELS};
use crate::cycles;

/// Number of piezos.
pub const CHANNELS: usize = PIEZO_CHANNELS.len();
/// Sample of every piezo, as counts of 12 bits.
pub type Frame = [u16; CHANNELS];

/// Number of frames of the ring: four halves of the audio buffer.
pub const RING_FRAMES: usize = 128;
/// Number of counts of the ring.
const COUNTS: usize = RING_FRAMES * CHANNELS;
/// Time from switching the ADC on to its first conversion, in microseconds.
const ADC_WAKES_US: u32 = 4;
/// Time by which the first frame comes later than a period of the timer after the start, in ticks
/// of the timer: 2.8 us, so that with its scan of 7.6 us it ends in the middle of a period.
const FIRST_FRAME_TICKS: u32 = (CLOCKS.timer_hz() as u64 * 28 / 10_000_000) as u32;
/// Stream of DMA2 that serves ADC1.
const STREAM: usize = 0;
/// Request channel of ADC1 on that stream.
const DMA_CHANNEL: u8 = 0;
/// Number of timer 3's trigger output among the external triggers of ADC1.
const TRIGGER: u8 = 8;

struct Ring(UnsafeCell<[Frame; RING_FRAMES]>);

// SAFETY: only the DMA writes the ring, and the one `Piezos` reads places that the DMA has left.
unsafe impl Sync for Ring {}

static RING: Ring = Ring(UnsafeCell::new([[0; CHANNELS]; RING_FRAMES]));

/// Time for which a pin is pulled to a rail: the bias charges the pin and the capacitor of the
/// piezo, 18 nF, in 0.9 ms, the pull beside it in 0.4 ms.
const PULLED: Duration = Duration::from_millis(2);
/// Time from letting a pin go to its sample.
const LET_GO: Duration = Duration::from_millis(4);
/// Counts of a pin with bias and a piezo at rest: half the supply, and a quarter of it to each
/// side.
const AT_REST: core::ops::RangeInclusive<u16> = 1024..=3071;
/// Largest difference of a wired pin's counts after pulls to the two rails. The pulls leave 25
/// counts; an open pin is off by 3000.
const BIASED_WITHIN: u16 = 200;

/// Sampler of the piezos. There is one.
pub struct Piezos {
    /// Place in the ring of the next frame that has not been taken.
    next: usize,
    pins: [Flex<'static>; CHANNELS],
}

/// Error of a sampler that has stopped, by an overrun of the ADC or an error of its DMA.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopped;

impl Piezos {
    /// Sets up timer and ADC without starting them.
    ///
    /// Each channel is sampled for 28 ADC clocks and converted in 12. At 21 and 24 MHz the four
    /// channels take 7.6 and 6.7 us of the 20.8 us between two frames.
    pub fn new(pins: [Flex<'static>; CHANNELS]) -> Self {
        rcc::enable_and_reset::<peripherals::ADC1>();
        rcc::enable_and_reset::<peripherals::TIM3>();
        ADC_COMMON.ccr().modify(|w| w.set_adcpre(Adcpre::DIV4));
        ADC1.cr1().modify(|w| w.set_scan(true));
        ADC1.sqr1().modify(|w| w.set_l(CHANNELS as u8 - 1));
        for (place, &channel) in PIEZO_CHANNELS.iter().enumerate() {
            ADC1.sqr3().modify(|w| w.set_sq(place, channel));
            ADC1.smpr2().modify(|w| w.set_smp(usize::from(channel), SampleTime::CYCLES28));
        }
        TIM3.arr().write(|w| w.set_arr(CLOCKS.adc_period() as u16 - 1));
        TIM3.cr2().modify(|w| w.set_mms(Mms::UPDATE));
        Self { next: 0, pins }
    }

    /// Returns true for each piezo that is wired: with its bias, its pin goes back to half the
    /// supply after a pull to either rail.
    ///
    /// An open pin keeps its charge, and would follow the channel that is sampled before it; a
    /// grounded one stays at its rail. A hit on a piezo hides its bias, so a pin is looked at up to
    /// four times. It takes 12 ms, or 48 if a pin is open.
    pub fn find(&mut self) -> [bool; CHANNELS] {
        ADC1.cr2().modify(|w| w.set_adon(true));
        let mut found = [false; CHANNELS];
        for _ in 0..4 {
            let [up, down] = [Pull::Up, Pull::Down].map(|pull| self.counts_after(pull));
            for (found, (up, down)) in found.iter_mut().zip(up.into_iter().zip(down)) {
                *found |= AT_REST.contains(&up) && AT_REST.contains(&down) && up.abs_diff(down) <= BIASED_WITHIN;
            }
            if found == [true; CHANNELS] {
                break;
            }
        }
        ADC1.cr1().modify(|w| w.set_scan(true));
        ADC1.sqr3().modify(|w| w.set_sq(0, PIEZO_CHANNELS[0]));
        found
    }

    /// Pulls all pins to a rail, lets them go, and returns their counts.
    fn counts_after(&mut self, pull: Pull) -> [u16; CHANNELS] {
        self.pins.iter_mut().for_each(|pin| pin.set_as_input(pull));
        block_for(PULLED);
        self.pins.iter_mut().for_each(Flex::set_as_analog);
        block_for(LET_GO);
        // One conversion each: more would draw an open pin to its neighbour.
        ADC1.cr1().modify(|w| w.set_scan(false));
        PIEZO_CHANNELS.map(|channel| {
            ADC1.sqr3().modify(|w| w.set_sq(0, channel));
            ADC1.cr2().modify(|w| w.set_swstart(true));
            // A conversion takes 2 us.
            block_for(Duration::from_micros(40));
            ADC1.dr().read().data()
        })
    }

    /// Starts or restarts the sampler. The first frame is sampled a little more than a frame after
    /// the time `now` in core cycles.
    ///
    /// So frames end midway between the times at which [`take`](Self::take) is called every 32
    /// frames, and each call finds as many.
    ///
    /// The ADC is switched off and on: a scan that went on would end in the new ring, and all later
    /// scans would lie some channels beside their places.
    pub fn start(&mut self, now: u32) {
        TIM3.cr1().modify(|w| w.set_cen(false));
        ADC1.cr2().modify(|w| {
            w.set_adon(false);
            w.set_dma(false);
            w.set_exten(Exten::DISABLED);
        });
        let registers = DMA2.st(STREAM);
        registers.cr().modify(|w| w.set_en(false));
        // This ends: a transfer of two bytes takes a few cycles.
        while registers.cr().read().en() {}
        DMA2.ifcr(STREAM / 4).write(|w| {
            w.set_feif(STREAM % 4, true);
            w.set_dmeif(STREAM % 4, true);
            w.set_teif(STREAM % 4, true);
            w.set_htif(STREAM % 4, true);
            w.set_tcif(STREAM % 4, true);
        });
        registers.par().write_value(ADC1.dr().as_ptr() as u32);
        registers.m0ar().write_value(RING.0.get() as u32);
        registers.ndtr().write(|w| w.set_ndt(COUNTS as u16));
        registers.cr().write(|w| {
            w.set_chsel(DMA_CHANNEL);
            w.set_pl(Pl::HIGH);
            w.set_dir(Dir::PERIPHERAL_TO_MEMORY);
            w.set_msize(Size::BITS16);
            w.set_psize(Size::BITS16);
            w.set_minc(true);
            w.set_circ(true);
        });
        registers.cr().modify(|w| w.set_en(true));
        // The ADC's flags, that of an overrun among them, are cleared by writing zeros.
        ADC1.sr().write(|w| w.0 = 0);
        ADC1.cr2().modify(|w| w.set_adon(true));
        cortex_m::asm::delay(CLOCKS.core_hz() / 1_000_000 * ADC_WAKES_US);
        ADC1.cr2().modify(|w| {
            w.set_dma(true);
            w.set_dds(Dds::CONTINUOUS);
            w.set_extsel(TRIGGER);
            w.set_exten(Exten::RISING_EDGE);
        });
        self.next = 0;
        let period = CLOCKS.adc_period();
        let passed = cycles::now().wrapping_sub(now) / (CLOCKS.core_hz() / CLOCKS.timer_hz());
        let left = (period + FIRST_FRAME_TICKS).saturating_sub(passed).clamp(1, period);
        TIM3.cnt().write(|w| w.set_cnt((period - left) as u16));
        TIM3.cr1().modify(|w| w.set_cen(true));
    }

    /// Returns the frames since the last call, in order: those up to the ring's end, and those from
    /// its beginning.
    ///
    /// The frames stay valid until the DMA comes round again, three halves later.
    ///
    /// # Errors
    /// [`Stopped`] if the ADC was overrun or its DMA has failed. The sampler must be restarted.
    pub fn take(&mut self) -> Result<[&[Frame]; 2], Stopped> {
        let registers = DMA2.st(STREAM);
        let overrun = ADC1.sr().read().ovr();
        let left = usize::from(registers.ndtr().read().ndt());
        if overrun || !registers.cr().read().en() {
            return Err(Stopped);
        }
        compiler_fence(Ordering::SeqCst);
        let end = (COUNTS - left.clamp(1, COUNTS)) / CHANNELS;
        let begin = core::mem::replace(&mut self.next, end);
        let first = RING.0.get().cast::<Frame>();
        // SAFETY: both parts lie inside the ring, and the DMA writes elsewhere: from `end` on, less
        // than a round further.
        let part = |begin: usize, end: usize| unsafe {
            core::slice::from_raw_parts(first.add(begin.min(end)), end.saturating_sub(begin))
        };
        Ok(match begin <= end {
            true => [part(begin, end), &[]],
            false => [part(begin, RING_FRAMES), part(0, end)],
        })
    }
}
