//! The piezos: ADC1 scans their channels each time timer 3 says so, 48 000 times a second, and DMA2 writes the counts round a ring.
//!
//! There is no interrupt: whoever takes the frames looks how far the DMA has come.

use core::cell::UnsafeCell;
use core::sync::atomic::{Ordering, compiler_fence};

use embassy_stm32::gpio::Flex;
use embassy_stm32::pac::adc::vals::{Dds, Exten, SampleTime};
use embassy_stm32::pac::adccommon::vals::Adcpre;
use embassy_stm32::pac::dma::vals::{Dir, Pl, Size};
use embassy_stm32::pac::timer::vals::Mms;
use embassy_stm32::pac::{ADC1, DMA2, TIM3};
use embassy_stm32::{peripherals, rcc};

use crate::board::{ADC_COMMON, CLOCKS, PIEZO_CHANNELS};

/// Piezos.
pub const CHANNELS: usize = PIEZO_CHANNELS.len();
/// One 12-bit count a piezo.
pub type Frame = [u16; CHANNELS];

/// Frames of the ring: four halves of the audio buffer.
pub const RING_FRAMES: usize = 128;
const COUNTS: usize = RING_FRAMES * CHANNELS;
/// What the ADC needs from being switched on to its first conversion, us.
const ADC_WAKES_US: u32 = 4;
/// DMA2's stream 0, channel 0 serves ADC1.
const STREAM: usize = 0;
const DMA_CHANNEL: u8 = 0;
/// Timer 3's trigger output among ADC1's external triggers.
const TRIGGER: u8 = 8;

struct Ring(UnsafeCell<[Frame; RING_FRAMES]>);

// SAFETY: written by the DMA; read by the one `Piezos`, where the DMA is not.
unsafe impl Sync for Ring {}

static RING: Ring = Ring(UnsafeCell::new([[0; CHANNELS]; RING_FRAMES]));

/// The sampler. There is one.
pub struct Piezos {
    /// The next frame of the ring that has not been taken.
    next: usize,
    _pins: [Flex<'static>; CHANNELS],
}

/// Why there are no frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopped;

impl Piezos {
    /// Sets up timer, ADC and DMA; nothing runs yet. Each channel is held for 28 ADC clocks and converted in 12: at 21 and 24 MHz the four of them
    /// take 7.6 and 6.7 us of the 20.8 between two frames.
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
        ADC1.cr2().modify(|w| w.set_adon(true));
        cortex_m::asm::delay(CLOCKS.core_hz() / 1_000_000 * ADC_WAKES_US);
        TIM3.arr().write(|w| w.set_arr(CLOCKS.adc_period() as u16 - 1));
        TIM3.cr2().modify(|w| w.set_mms(Mms::UPDATE));
        Self { next: 0, _pins: pins }
    }

    /// Starts, or starts anew: the first frame is sampled now.
    pub fn start(&mut self) {
        TIM3.cr1().modify(|w| w.set_cen(false));
        ADC1.cr2().modify(|w| {
            w.set_dma(false);
            w.set_exten(Exten::DISABLED);
        });
        let registers = DMA2.st(STREAM);
        registers.cr().modify(|w| w.set_en(false));
        // A transfer of two bytes ends within a few cycles.
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
        // Flags are cleared by writing zeros; the overrun's among them.
        ADC1.sr().write(|w| w.0 = 0);
        ADC1.cr2().modify(|w| {
            w.set_dma(true);
            w.set_dds(Dds::CONTINUOUS);
            w.set_extsel(TRIGGER);
            w.set_exten(Exten::RISING_EDGE);
        });
        self.next = 0;
        TIM3.cnt().write(|w| w.set_cnt(0));
        TIM3.cr1().modify(|w| w.set_cen(true));
        // An update by hand: it triggers the first scan.
        TIM3.egr().write(|w| w.set_ug(true));
    }

    /// The frames that have come since the last call, in order: those up to the ring's end, and those from its beginning. They stay as they are
    /// until the DMA comes round again, three halves later.
    ///
    /// # Errors
    /// [`Stopped`] where the ADC has been overrun or its DMA has failed: it must be started anew.
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
        // SAFETY: both parts lie inside the ring, and the DMA writes elsewhere: from `end` on, less than a round further.
        let part = |begin: usize, end: usize| unsafe {
            core::slice::from_raw_parts(first.add(begin.min(end)), end.saturating_sub(begin))
        };
        Ok(match begin <= end {
            true => [part(begin, end), &[]],
            false => [part(begin, RING_FRAMES), part(0, end)],
        })
    }
}
