//! Interrupt of the stream: renders a half in time, and counts those that were missed.

use boards::Board;
use dsp_core::event::Event;
use dsp_core::trigger;
use embassy_stm32::interrupt;

use super::fade::{Fade, Holder};
use super::i2s::{self, I2s, Told};
use super::instrument::Instrument;
use super::midi::Midi;
use crate::board::{CLOCKS, Memory};
use crate::half::HALF_FRAMES;
use crate::input::{self, Inputs};
use crate::owned::Owned;
use crate::queue::{Queue, Receiver, Sender};
use crate::{counters, cycles, volume, watchdog};

/// Number of frames from the interrupt that renders a tick to the tick's first frame, at most a
/// half.
const LEAD_FRAMES: usize = <Memory as Board>::LEAD_FRAMES;
/// Core cycles that a tick may take by the engine's prediction.
pub const BUDGET_CYCLES: u32 = <Memory as Board>::BUDGET_CYCLES;
const _: () = assert!(LEAD_FRAMES <= HALF_FRAMES, "a tick is rendered at most a half ahead");
/// Core cycles in which a half plays.
pub const CYCLES_PER_HALF: u32 = CLOCKS.cycles_per_frames(HALF_FRAMES as u32);

const SILENCE: [[i32; 2]; HALF_FRAMES] = [[0; 2]; HALF_FRAMES];

/// Maximum number of lines that wait for the log task.
const LINES: usize = 64;

/// Line of the log.
#[derive(Clone, Copy, Debug)]
pub enum Line {
    /// An event was played, or modes were left out.
    Event(Event),
    /// The channel of a piezo fails.
    PiezoFault {
        /// Number of the channel, from 0.
        channel: u8,
        /// Fault of the channel.
        fault: trigger::Fault,
    },
    /// The channel of a piezo works again.
    PiezoRecovered {
        /// Number of the channel, from 0.
        channel: u8,
    },
    /// Halves were not filled in time.
    Missed {
        /// Number of these halves.
        halves: u32,
    },
    /// The I2S stream was restarted after a DMA error.
    StreamRestarted,
    /// The ADC was restarted after an overrun or a DMA error.
    AdcRestarted,
}

/// State of the audio interrupt.
pub(super) struct Audio {
    pub(super) i2s: I2s,
    pub(super) inputs: &'static mut Inputs,
    pub(super) instrument: &'static mut Instrument,
    pub(super) midi: Midi,
    lines: Lines,
    /// Time at which the last half was found played, in core cycles.
    pub(super) last: u32,
    /// Half that was found played last, 0 or 1.
    pub(super) played: usize,
    /// Number of halves of zeros that were rendered in a row, at most 255.
    pub(super) silent_halves: u8,
    /// Way to silence, while a task waits for it.
    pub(super) fade: Fade,
}

static LOG: Queue<Line, LINES> = Queue::new();

/// Lines of the log, as the interrupt appends them.
struct Lines(Sender<Line, LINES>);

impl Lines {
    /// Appends a line to the log, or counts it as lost if the queue is full.
    fn push(&mut self, line: Line) {
        if !self.0.push(line) {
            counters::UNLOGGED_LINES.add(1);
        }
    }
}

/// Lines of the log, as the log task takes them.
pub type Log = Receiver<Line, LINES>;

pub(super) static AUDIO: Owned<Audio> = Owned::empty();

/// Lets the I2S stream, which runs and is silent, play the instrument. Returns the log's lines, or
/// `None` if it has been called before.
pub fn start(
    mut i2s: I2s,
    inputs: &'static mut Inputs,
    instrument: &'static mut Instrument,
    midi: Midi,
) -> Option<Log> {
    let (lines, log) = LOG.split()?;
    if i2s.take() == Told::TransferError {
        // The stream has stopped while nobody served its interrupt, and no more would come.
        i2s.start();
    }
    let (played, lines) = (i2s.half_played(), Lines(lines));
    let audio =
        Audio { i2s, inputs, instrument, midi, lines, last: cycles::now(), played, silent_halves: 0, fade: Fade::NONE };
    // SAFETY: the log is split once, and the interrupt does not look before it holds the sound.
    unsafe { AUDIO.fill(audio) };
    Holder::Interrupt.set();
    Some(log)
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
    if Holder::get() != Holder::Interrupt {
        return i2s::acknowledge();
    }
    // SAFETY: `start` has filled `AUDIO`, the interrupt holds it, and does not interrupt itself.
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
        let is_fading = self.fade.step(self.instrument);
        if !is_fading {
            self.instrument.keep_time(missed > 0);
            self.take_inputs(missed);
            self.midi.take(now, self.instrument);
        }

        let (inputs, lines) = (&mut self.inputs, &mut self.lines);
        let direct = if is_fading { None } else { inputs.direct() };
        let half = self.instrument.render(direct, |event| lines.push(Line::Event(*event)));
        self.silent_halves = if half.is_none() { self.silent_halves.saturating_add(1) } else { 0 };
        // If both halves hold zeros already there is nothing to write.
        if self.silent_halves <= 2 {
            // The half that begins LEAD_FRAMES after the one that has just been played.
            let frames = half.as_ref().map_or(&SILENCE, |half| half.frames);
            self.i2s.fill(played * HALF_FRAMES + HALF_FRAMES + LEAD_FRAMES, frames);
        }
        if let Some(half) = half {
            counters::PEAK.keep_bits(half.peak_bits);
        }
        counters::HALVES.add(1);
        // Sound is what the watchdog waits for, late or not: a restart would silence the board for
        // longer. Tasks may wait while the sound and a host take all the time.
        watchdog::feed();
        if self.i2s.frames_since(played) >= LEAD_FRAMES {
            // The DMA read a part of these frames before they were written: old frames were heard.
            self.miss(1);
            self.instrument.keep_time(true);
        }
        if self.fade.is_over() {
            i2s::silence_now();
            Holder::Task.set();
        }
    }

    /// Passes the events of the inputs to the instrument, and their faults to the log.
    // Not inlined, so that profiles tell it apart, and its stack and that of the renderer share
    // their place.
    #[inline(never)]
    fn take_inputs(&mut self, missed: u32) {
        let (instrument, lines, midi) = (&mut self.instrument, &mut self.lines, &mut self.midi);
        let restarts = counters::ADC_RESTARTS.get();
        self.inputs.take(instrument.now(), missed, |told| match told {
            input::Told::Event(event) => {
                midi.tell(&event);
                instrument.expect(event);
            }
            input::Told::Fault { channel, fault } => lines.push(Line::PiezoFault { channel, fault }),
            input::Told::Recovered { channel } => lines.push(Line::PiezoRecovered { channel }),
        });
        if let Some(event) = volume::take_event(instrument.now()) {
            instrument.expect(event);
        }
        if counters::ADC_RESTARTS.get() != restarts {
            lines.push(Line::AdcRestarted);
        }
    }

    /// Counts and logs halves that were not filled in time.
    fn miss(&mut self, halves: u32) {
        if halves > 0 {
            counters::MISSED_HALVES.add(halves);
            self.lines.push(Line::Missed { halves });
        }
    }

    /// Returns the number of halves played since the last interrupt that rendered one.
    ///
    /// The time tells the number roughly. The half that has just been played tells if it is odd.
    fn halves_since_last(&self, now: u32, played: usize) -> u32 {
        let time = now.wrapping_sub(self.last);
        let odd = u32::from(played != self.played);
        // Rounds to the nearest number of that parity.
        let pairs = time.saturating_add((1 - odd) * CYCLES_PER_HALF) / (2 * CYCLES_PER_HALF);
        2 * pairs + odd
    }
}
