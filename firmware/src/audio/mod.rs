//! Sound: in the DMA's interrupt, while one half of the buffer plays, the other is rendered.
//!
//! ```text
//! DMA reads    |------- half 0 -------|------- half 1 -------|
//! interrupt                           ^ inputs up to now are taken, a tick is rendered ...
//! tick         |--- ... ---|---- rendered before ----|---- ... to be heard from here
//!                                     |LEAD_FRAMES-->|
//! ```
//!
//! A tick of the engine lies across the halves: it is heard [`LEAD_FRAMES`] after the interrupt that renders it, which is the deadline. A
//! lead of less than a half shortens the way from a strike to its sound; the engine's budget leaves the rest of the time to others anyway.

pub mod i2s;
pub mod instrument;
mod waiting;

use core::sync::atomic::{AtomicBool, Ordering};

use boards::Board;
use dsp_core::event::Event;
use dsp_core::trigger;
use embassy_stm32::interrupt;

use self::i2s::{HALF_FRAMES, I2s, Told};
use self::instrument::Instrument;
use crate::board::{CLOCKS, Memory};
use crate::input::{self, Inputs};
use crate::owned::Owned;
use crate::queue::Queue;
use crate::{counters, cycles};

/// Frames from the interrupt that renders a tick to the tick's first frame, at most a half.
const LEAD_FRAMES: usize = <Memory as Board>::LEAD_FRAMES;
/// Cycles that a tick may take, as the engine predicts them.
pub const BUDGET_CYCLES: u32 = <Memory as Board>::BUDGET_CYCLES;
const _: () = assert!(LEAD_FRAMES <= HALF_FRAMES, "a tick is rendered at most a half ahead");
/// Cycles in which a half plays.
pub const CYCLES_PER_HALF: u32 = CLOCKS.cycles_per_frames(HALF_FRAMES as u32);

const SILENCE: [[i32; 2]; HALF_FRAMES] = [[0; 2]; HALF_FRAMES];

/// Lines on their way to the log.
const LINES: usize = 64;

/// What the log is told.
#[derive(Clone, Copy, Debug)]
pub enum Line {
    /// What was played, and what was left out.
    Event(Event),
    /// A piezo's channel fails.
    PiezoFault {
        /// Which channel, counted from 0.
        channel: u8,
        /// What is wrong.
        fault: trigger::Fault,
    },
    /// It is well again.
    PiezoRecovered {
        /// Which channel, counted from 0.
        channel: u8,
    },
    /// Halves were not filled in time.
    Missed {
        /// How many.
        halves: u32,
    },
    /// The I2S stream was started anew after a DMA error.
    StreamRestarted,
    /// The ADC was started anew after an overrun or a DMA error.
    AdcRestarted,
}

/// Everything that belongs to the audio interrupt.
struct Audio {
    i2s: I2s,
    inputs: &'static mut Inputs,
    instrument: &'static mut Instrument,
    lines: Lines,
    /// When the last half was found played, cycles.
    last: u32,
    /// Which half that was.
    played: usize,
    /// Halves of zeros up to now.
    silent_halves: u8,
}

static LOG: Queue<Line, LINES> = Queue::new();

/// The log's end in the interrupt; there is one.
struct Lines(());

impl Lines {
    /// What finds no room is counted.
    fn push(&mut self, line: Line) {
        // SAFETY: the one end.
        if !unsafe { LOG.push(line) } {
            counters::UNLOGGED_LINES.add(1);
        }
    }
}

/// The other end: what the interrupt has to tell, in order.
pub struct Log(());

impl Log {
    /// The next line, where there is one.
    pub fn take(&mut self) -> Option<Line> {
        // SAFETY: the one end.
        unsafe { LOG.take() }
    }
}

static AUDIO: Owned<Audio> = Owned::empty();
/// Whether `AUDIO` has been filled.
static READY: AtomicBool = AtomicBool::new(false);

/// From now on the stream, which runs already and is silent, plays the instrument. Gives the end of the log where lines come out.
///
/// # Safety
/// Called once.
pub unsafe fn start(i2s: I2s, inputs: &'static mut Inputs, instrument: &'static mut Instrument) -> Log {
    let played = i2s.half_played();
    let audio = Audio { i2s, inputs, instrument, lines: Lines(()), last: cycles::now(), played, silent_halves: 0 };
    // SAFETY: the caller's word; the interrupt does not look before it is told.
    unsafe { AUDIO.fill(audio) };
    READY.store(true, Ordering::Release);
    Log(())
}

#[cfg(feature = "blackpill-f411")]
#[interrupt]
fn DMA1_STREAM4() {
    on_half();
}

#[cfg(not(feature = "blackpill-f411"))]
#[interrupt]
fn DMA1_STREAM5() {
    on_half();
}

fn on_half() {
    let begun = cycles::now();
    if !READY.load(Ordering::Acquire) {
        return i2s::acknowledge();
    }
    // SAFETY: `start` has filled it, and an interrupt does not interrupt itself.
    let audio = unsafe { AUDIO.get() };
    audio.on_interrupt(begun);
    let spent = cycles::now().wrapping_sub(begun);
    counters::AUDIO_CYCLES.add(spent);
    counters::WORST_HALF_CYCLES.keep_larger(spent);
}

impl Audio {
    fn on_interrupt(&mut self, now: u32) {
        match self.i2s.take() {
            Told::Nothing => return,
            Told::TransferError => {
                counters::STREAM_ERRORS.add(1);
                self.lines.push(Line::StreamRestarted);
                self.i2s.start();
                self.inputs.forget_anchor();
                (self.last, self.played, self.silent_halves) = (now, 1, 0);
                return;
            }
            Told::HalfPlayed => {}
        }
        let played = self.i2s.half_played();
        let Some(missed) = self.halves_since_last(now, played).checked_sub(1) else { return };
        (self.last, self.played) = (now, played);
        self.miss(missed);
        self.take_inputs(missed);

        let (inputs, lines) = (&mut self.inputs, &mut self.lines);
        let half = self.instrument.render(inputs.direct(), |event| lines.push(Line::Event(*event)));
        self.silent_halves = if half.is_none() { self.silent_halves.saturating_add(1) } else { 0 };
        // Where both halves hold zeros already there is nothing to write.
        if self.silent_halves <= 2 {
            // The half that begins LEAD_FRAMES after the one that has just been played.
            let frames = half.as_ref().map_or(&SILENCE, |half| half.frames);
            self.i2s.fill(played * HALF_FRAMES + HALF_FRAMES + LEAD_FRAMES, frames);
        }
        if let Some(half) = half {
            counters::PEAK.keep_bits(half.peak_bits);
        }
        counters::HALVES.add(1);
        if self.i2s.frames_since(played) >= LEAD_FRAMES {
            // The DMA came here before all was written: part of what was there before has been heard again.
            self.miss(1);
        }
    }

    #[inline(never)] // told apart in profiles; its stack and the renderer's share their place
    fn take_inputs(&mut self, missed: u32) {
        let (instrument, lines) = (&mut self.instrument, &mut self.lines);
        let restarts = counters::ADC_RESTARTS.get();
        self.inputs.take(instrument.now(), missed, |told| match told {
            input::Told::Event(event) => instrument.expect(event),
            input::Told::Fault { channel, fault } => lines.push(Line::PiezoFault { channel, fault }),
            input::Told::Recovered { channel } => lines.push(Line::PiezoRecovered { channel }),
        });
        if counters::ADC_RESTARTS.get() != restarts {
            lines.push(Line::AdcRestarted);
        }
    }

    fn miss(&mut self, halves: u32) {
        if halves > 0 {
            counters::MISSED_HALVES.add(halves);
            self.lines.push(Line::Missed { halves });
        }
    }

    /// Halves that have been played since the last interrupt that rendered one: the time says about how many, the half that has just been played
    /// whether the number is odd.
    fn halves_since_last(&self, now: u32, played: usize) -> u32 {
        let time = now.wrapping_sub(self.last);
        let odd = u32::from(played != self.played);
        // The nearest number of that parity.
        let pairs = time.saturating_add((1 - odd) * CYCLES_PER_HALF) / (2 * CYCLES_PER_HALF);
        2 * pairs + odd
    }
}
