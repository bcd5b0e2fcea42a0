//! I2S out by circular DMA over two halves.
//!
//! ```text
//! frame            0                      32                     64 = 0
//! buffer           |------ half 0 --------|------ half 1 --------|
//! DMA reads        ----------> interrupt: half 0 is free
//!                                         ----------> interrupt: half 1 is free
//! ```
//!
//! Whatever the program does, the DMA goes round; a half that is not filled in time is heard again, and the stream keeps its place: a frame is
//! always the same four half-words of the buffer, so left and right, high and low cannot change places.

use core::cell::UnsafeCell;
use core::sync::atomic::{Ordering, compiler_fence};

use embassy_stm32::interrupt::{Interrupt, InterruptExt, Priority};
use embassy_stm32::pac::dma::vals::{Dir, Pl, Size};
use embassy_stm32::pac::spi::vals::{Chlen, Ckpol, Datlen, I2scfg, I2sstd, Odd};
use embassy_stm32::pac::{dma::Dma, spi::Spi};

use crate::board::{CLOCKS, I2S};

/// Above everything: a half is due after 667 us, and what would come between it and its deadline can wait for it.
const PRIORITY: Priority = Priority::P0;
/// Frames of a half: one tick of the engine.
pub const HALF_FRAMES: usize = 32;
const FRAMES: usize = 2 * HALF_FRAMES;
const HALF_WORDS_PER_FRAME: usize = 4;
const HALF_WORDS: usize = FRAMES * HALF_WORDS_PER_FRAME;

/// Which peripherals a board's I2S uses.
#[derive(Clone, Copy)]
pub struct Wiring {
    /// The SPI in I2S mode; its clock and pins are the board's business.
    pub spi: Spi,
    /// The DMA that serves it.
    pub dma: Dma,
    /// Its stream.
    pub stream: usize,
    /// Its request channel.
    pub channel: u8,
    /// The stream's interrupt.
    pub interrupt: Interrupt,
}

/// What the DMA reads: words of a slot with their halves swapped, since the peripheral takes the high half first.
#[repr(align(4))]
struct Buffer(UnsafeCell<[[u32; 2]; FRAMES]>);

// SAFETY: written by volatile stores only, of the one `I2s`; beside it only the DMA reads.
unsafe impl Sync for Buffer {}

static BUFFER: Buffer = Buffer(UnsafeCell::new([[0; 2]; FRAMES]));

/// What the DMA stream has to tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    /// A half has been played.
    HalfPlayed,
    /// The DMA could not read or write: the stream has stopped.
    TransferError,
    /// Nothing.
    Nothing,
}

/// The I2S output. There is one: it owns the buffer, and what [`I2S`] names.
pub struct I2s(());

impl I2s {
    /// Sets up the peripheral, still silent. It must have been reset, and its bus clock be on.
    pub fn set_up() -> Self {
        // The hardware library lets all DMA interrupts come; until there is something to play they are only acknowledged.
        I2S.interrupt.set_priority(PRIORITY);
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
        Self(())
    }

    /// Starts with two silent halves, or starts anew after an error: from the first half-word of the left slot of frame 0.
    pub fn start(&mut self) {
        let Wiring { spi, dma, stream, channel, .. } = I2S;
        spi.i2scfgr().modify(|w| w.set_i2se(false));
        spi.cr2().modify(|w| w.set_txdmaen(false));
        let registers = dma.st(stream);
        registers.cr().modify(|w| w.set_en(false));
        // A transfer of two bytes ends within a few cycles.
        while registers.cr().read().en() {}
        acknowledge();
        silence_now();
        registers.par().write_value(spi.dr().as_ptr() as u32);
        registers.m0ar().write_value(BUFFER.0.get() as u32);
        registers.ndtr().write(|w| w.set_ndt(HALF_WORDS as u16));
        // Direct mode, no FIFO: a half-word is fetched when the peripheral asks for it.
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

    /// Takes what the stream has to tell; an error comes first.
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

    /// The frame of the buffer that the DMA reads next, 0 to 63.
    pub fn position(&self) -> usize {
        let left = usize::from(I2S.dma.st(I2S.stream).ndtr().read().ndt());
        (HALF_WORDS - left.clamp(1, HALF_WORDS)) / HALF_WORDS_PER_FRAME
    }

    /// The half that the DMA has read last.
    pub fn half_played(&self) -> usize {
        1 - self.position() / HALF_FRAMES
    }

    /// Frames that the DMA has read since it finished a half.
    pub fn frames_since(&self, half: usize) -> usize {
        (self.position() + FRAMES - (half + 1) * HALF_FRAMES % FRAMES) % FRAMES
    }

    /// Fills the 32 frames of the buffer that begin at `first`, round its end, with samples of 24 bits.
    pub fn fill(&mut self, first: usize, frames: &[[i32; 2]; HALF_FRAMES]) {
        let first = first % FRAMES;
        let (to_end, from_start) = frames.split_at((FRAMES - first).min(HALF_FRAMES));
        store(first, to_end);
        store(0, from_start);
        compiler_fence(Ordering::SeqCst);
    }
}

/// Clears the flags that brought an interrupt.
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

/// Zeros to both halves from anywhere: at a start, and for a program that is about to end.
pub fn silence_now() {
    store(0, &[[0; 2]; FRAMES]);
    compiler_fence(Ordering::SeqCst);
}

/// Frames in a row, as far as the buffer goes.
#[inline(never)]
fn store(first: usize, frames: &[[i32; 2]]) {
    for (frame, &[left, right]) in (first..FRAMES).zip(frames) {
        // SAFETY: inside the buffer; whole words, of which the DMA reads halves.
        unsafe { BUFFER.0.get().cast::<[u32; 2]>().add(frame).write_volatile([slot(left), slot(right)]) };
    }
}

/// 24 bits to the top of a slot of 32, halves swapped.
fn slot(sample: i32) -> u32 {
    ((sample << 8) as u32).rotate_left(16)
}
