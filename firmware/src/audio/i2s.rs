//! I2S output by circular DMA over a buffer of two halves.
//!
//! ```text
//! frame            0                      32                     64 = 0
//! buffer           |------ half 0 --------|------ half 1 --------|
//! DMA reads        ----------> interrupt: half 0 is free
//!                                         ----------> interrupt: half 1 is free
//! ```
//!
//! The DMA goes round whatever the program does. A half that is not filled in time is heard again,
//! and the stream keeps its place: a frame of the buffer always holds the same four half-words, so
//! left and right, high and low cannot change places.

use core::cell::UnsafeCell;
use core::sync::atomic::{Ordering, compiler_fence};

use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac::RCC;
use embassy_stm32::pac::dma::vals::{Dir, Pl, Size};
use embassy_stm32::pac::spi::vals::{Chlen, Ckpol, Datlen, I2scfg, I2sstd, Odd};

use crate::board::wiring::Wiring;
use crate::board::{CLOCKS, I2S};
use crate::half::HALF_FRAMES;

/// Priority of the stream's interrupt, next below those that only note the time. A half is due
/// after 667 us, and all other work can wait for it.
const PRIORITY: Priority = Priority::P1;
/// Number of frames of the buffer.
const FRAMES: usize = 2 * HALF_FRAMES;
/// Number of DMA transfers per frame: two slots of 32 bits, in half-words.
const HALF_WORDS_PER_FRAME: usize = 4;
/// Number of DMA transfers per round of the buffer.
const HALF_WORDS: usize = FRAMES * HALF_WORDS_PER_FRAME;

/// Buffer that the DMA reads: slots of 32 bits with their half-words swapped, since the peripheral
/// takes the high half-word first.
#[repr(align(4))]
struct Buffer(UnsafeCell<[[u32; 2]; FRAMES]>);

// SAFETY: the buffer is written by volatile stores alone, and nothing but the DMA reads it.
unsafe impl Sync for Buffer {}

static BUFFER: Buffer = Buffer(UnsafeCell::new([[0; 2]; FRAMES]));

/// Event of the DMA stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    /// A half has been played.
    HalfPlayed,
    /// The DMA could not read or write, and the stream has stopped.
    TransferError,
    /// Nothing has happened.
    Nothing,
}

/// I2S output. There is one: it owns the buffer and the peripherals that [`I2S`] names.
pub struct I2s(());

impl I2s {
    /// Takes the peripheral without starting it. Its bus clock must be on.
    pub fn take_over() -> Self {
        // The hardware library has enabled all DMA interrupts. Until there is something to play
        // their handler only acknowledges them.
        I2S.interrupt.set_priority(PRIORITY);
        Self(())
    }

    /// Starts or restarts the stream with two silent halves, at the left slot of frame 0.
    pub fn start(&mut self) {
        let Wiring { spi, dma, stream, channel, .. } = I2S;
        reset();
        let registers = dma.st(stream);
        registers.cr().modify(|w| w.set_en(false));
        // This ends: a transfer of two bytes takes a few cycles.
        while registers.cr().read().en() {}
        acknowledge();
        silence_now();
        registers.par().write_value(spi.dr().as_ptr() as u32);
        registers.m0ar().write_value(BUFFER.0.get() as u32);
        registers.ndtr().write(|w| w.set_ndt(HALF_WORDS as u16));
        // In direct mode, without the FIFO, a half-word is fetched when the peripheral asks for it.
        registers.cr().write(|w| {
            w.set_chsel(channel);
            w.set_pl(Pl::VERY_HIGH);
            w.set_dir(Dir::MEMORY_TO_PERIPHERAL);
            w.set_msize(Size::BITS16);
            w.set_psize(Size::BITS16);
            w.set_minc(true);
            w.set_circ(true);
            w.set_htie(true);
            w.set_tcie(true);
            w.set_teie(true);
            w.set_dmeie(true);
        });
        registers.cr().modify(|w| w.set_en(true));
        spi.cr2().modify(|w| w.set_txdmaen(true));
        spi.i2scfgr().modify(|w| w.set_i2se(true));
    }

    /// Returns the event that brought the interrupt and acknowledges it. An error comes first.
    pub fn take(&mut self) -> Told {
        let Wiring { dma, stream, .. } = I2S;
        let flags = dma.isr(stream / 4).read();
        acknowledge();
        let place = stream % 4;
        if flags.teif(place) || flags.dmeif(place) || !dma.st(stream).cr().read().en() {
            Told::TransferError
        } else if flags.htif(place) || flags.tcif(place) {
            Told::HalfPlayed
        } else {
            Told::Nothing
        }
    }

    /// Returns the half that the DMA has read last, 0 or 1.
    pub fn half_played(&self) -> usize {
        1 - position() / HALF_FRAMES
    }

    /// Returns the number of frames that the DMA has read since it finished the half `half`.
    pub fn frames_since(&self, half: usize) -> usize {
        (position() + FRAMES - (half + 1) * HALF_FRAMES % FRAMES) % FRAMES
    }

    /// Writes samples of 24 bits to the 32 frames of the buffer from `first` on, round its end.
    pub fn fill(&mut self, first: usize, frames: &[[i32; 2]; HALF_FRAMES]) {
        let first = first % FRAMES;
        let (to_end, from_start) = frames.split_at((FRAMES - first).min(HALF_FRAMES));
        store(first, to_end);
        store(0, from_start);
        compiler_fence(Ordering::SeqCst);
    }
}

/// Returns the frame of the buffer that the DMA reads next, 0 to 63; 0 before the stream starts.
pub fn position() -> usize {
    let left = usize::from(I2S.dma.st(I2S.stream).ndtr().read().ndt());
    (HALF_WORDS - left.clamp(1, HALF_WORDS)) / HALF_WORDS_PER_FRAME
}

/// Resets the peripheral and sets it up.
///
/// Switched off alone, it keeps a half-word that was not sent. That one would lead the next stream,
/// and all others would leave a slot too late: left and right would change places.
fn reset() {
    RCC.apb1rstr().modify(|w| w.0 |= 1 << I2S.reset_bit);
    RCC.apb1rstr().modify(|w| w.0 &= !(1 << I2S.reset_bit));
    let clock = CLOCKS.audio;
    I2S.spi.i2spr().write(|w| {
        w.set_i2sdiv((clock.prescaler / 2) as u8);
        w.set_odd(if clock.prescaler % 2 == 1 { Odd::ODD } else { Odd::EVEN });
        w.set_mckoe(clock.master_clock);
    });
    I2S.spi.i2scfgr().write(|w| {
        w.set_i2smod(true);
        w.set_i2scfg(I2scfg::MASTER_TX);
        w.set_i2sstd(I2sstd::PHILIPS);
        w.set_ckpol(Ckpol::IDLE_LOW);
        w.set_datlen(Datlen::BITS24);
        w.set_chlen(Chlen::BITS32);
    });
}

/// Clears the interrupt flags of the stream.
pub fn acknowledge() {
    let place = I2S.stream % 4;
    I2S.dma.ifcr(I2S.stream / 4).write(|w| {
        w.set_feif(place, true);
        w.set_dmeif(place, true);
        w.set_teif(place, true);
        w.set_htif(place, true);
        w.set_tcif(place, true);
    });
}

/// Writes zeros to both halves. It may be called from anywhere.
pub fn silence_now() {
    store(0, &[[0; 2]; FRAMES]);
    compiler_fence(Ordering::SeqCst);
}

/// Writes frames from `first` on, as far as the buffer goes.
#[inline(never)]
fn store(first: usize, frames: &[[i32; 2]]) {
    for (frame, &[left, right]) in (first..FRAMES).zip(frames) {
        // SAFETY: the frame lies inside the buffer; the DMA only reads it.
        unsafe { BUFFER.0.get().cast::<[u32; 2]>().add(frame).write_volatile([slot(left), slot(right)]) };
    }
}

/// Returns a sample of 24 bits at the top of a slot of 32, with the half-words swapped.
fn slot(sample: i32) -> u32 {
    ((sample << 8) as u32).rotate_left(16)
}
