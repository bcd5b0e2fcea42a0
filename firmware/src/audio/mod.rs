//! Sound: in the DMA's interrupt, while one half of the buffer plays, the other is rendered.

pub mod i2s;
pub mod instrument;

use core::sync::atomic::{Ordering, compiler_fence};

use dsp_core::event::{Action, Event, Time};
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::Priority;
use heapless::spsc::{Consumer, Producer, Queue};

use self::i2s::{HALF_FRAMES, I2s, Told};
use self::instrument::Instrument;
use crate::board::CLOCKS;
use crate::owned::Owned;
use crate::{counters, cycles};

/// Above everything that can wait: a half is due after 667 us.
const PRIORITY: Priority = Priority::P2;
/// Cycles in which a half plays.
pub const CYCLES_PER_HALF: u32 = CLOCKS.cycles_per_frames(HALF_FRAMES as u32);

/// Events on their way to the log.
const LOGGED: usize = 64;
/// Presses on their way to the instrument.
const PRESSES: usize = 8;

/// An action of a button: on which pad.
#[derive(Clone, Copy, Debug)]
pub struct Press {
    /// Which pad.
    pub pad: u8,
    /// Strike, choke or release.
    pub action: Action,
    /// Velocity of a strike.
    pub velocity: f32,
}

/// Everything that belongs to the audio interrupt.
struct Audio {
    i2s: I2s,
    instrument: &'static mut Instrument,
    log: Producer<'static, Event>,
    presses: Consumer<'static, Press>,
    /// When the last half was found free, cycles.
    last: u32,
    /// The half that was filled last.
    filled: usize,
}

static AUDIO: Owned<Audio> = Owned::empty();
static LOG: Owned<Queue<Event, LOGGED>> = Owned::empty();
static PRESSED: Owned<Queue<Press, PRESSES>> = Owned::empty();

/// The ends of the audio interrupt's queues that belong to the tasks.
pub struct Ends {
    /// Every event that has been played, in order.
    pub log: Consumer<'static, Event>,
    /// What buttons want.
    pub presses: Producer<'static, Press>,
}

/// Starts the stream: from now on an instrument that has a kit is heard.
///
/// # Safety
/// Called once.
pub unsafe fn start(mut i2s: I2s, instrument: &'static mut Instrument) -> Ends {
    // SAFETY: the caller's word: this is the one place that fills them.
    let (log, presses) = unsafe { (LOG.fill(Queue::new()).split(), PRESSED.fill(Queue::new()).split()) };
    i2s.start();
    let audio = Audio { i2s, instrument, log: log.0, presses: presses.1, last: cycles::now(), filled: 1 };
    // SAFETY: as above; the interrupt comes after this.
    unsafe {
        let audio = AUDIO.fill(audio);
        compiler_fence(Ordering::SeqCst);
        audio.i2s.enable_interrupt(PRIORITY);
    }
    Ends { log: log.1, presses: presses.0 }
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
    // SAFETY: `start` filled it before it let this interrupt come, and an interrupt does not interrupt itself.
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
                self.i2s.start();
                (self.last, self.filled) = (now, 1);
                return;
            }
            Told::HalfPlayed => {}
        }
        let free = 1 - self.i2s.position() / HALF_FRAMES;
        let elapsed = self.halves_since_last(now, free);
        if elapsed == 0 {
            return;
        }
        counters::MISSED_HALVES.add(elapsed - 1);
        (self.last, self.filled) = (now, free);

        while let Some(press) = self.presses.dequeue() {
            let event = Event {
                time: Time::at_frame(self.instrument.now()),
                pad: press.pad,
                velocity: press.velocity,
                action: press.action,
                ..Event::NOTHING
            };
            self.instrument.expect(event);
        }
        let log = &mut self.log;
        let block = self.instrument.render(|event| {
            if log.enqueue(*event).is_err() {
                counters::UNLOGGED_EVENTS.add(1);
            }
        });
        self.i2s.fill(free, block);
        counters::HALVES.add(1);
        if self.i2s.position() / HALF_FRAMES == free {
            // The DMA came here before all was written: part of the half before was heard again.
            counters::MISSED_HALVES.add(1);
        }
        let peak = block.iter().flatten().map(|sample| sample.unsigned_abs()).max().unwrap_or(0);
        counters::PEAK.keep_larger(peak);
    }

    /// Halves that have been played since the last interrupt that filled one: the time says about how many, the half that is free says whether
    /// the number is odd.
    fn halves_since_last(&self, now: u32, free: usize) -> u32 {
        let time = now.wrapping_sub(self.last);
        let odd = u32::from(free != self.filled);
        // The nearest number of that parity.
        let pairs = (time + CYCLES_PER_HALF).saturating_sub(odd * CYCLES_PER_HALF) / (2 * CYCLES_PER_HALF);
        2 * pairs + odd
    }
}
