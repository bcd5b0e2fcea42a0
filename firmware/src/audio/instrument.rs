//! Instrument: the engine with its kit, and the events that wait for their frame.

use boards::{Board, PADS};
use dsp_core::engine::{Direct, Engine, LoadError};
use dsp_core::event::{Action, Event, Time};
use dsp_core::memory::{Memory, Word};
use dsp_core::table::Kit;

use super::waiting::Waiting;
use crate::board::{Memory as Lent, STRIKES_PER_TICK};
use crate::counters;
use crate::half::HALF_FRAMES;
use crate::owned::Owned;

/// Engine with its kit, and the events that wait for their frame.
pub struct Instrument {
    /// Engine of the loaded kit, or `None` if no kit is loaded.
    engine: Option<Engine<'static, 'static>>,
    /// Number of strikers of each pad.
    strikers: [u8; PADS],
    waiting: Waiting,
    /// Work of the strikes that the last half began, in strikes.
    begun: usize,
    /// Cycles a tick that the engine may take now, and the number of halves in time since they
    /// changed.
    budget: u32,
    in_time: u32,
    /// Gain of the board's settings, and the level of the last event of one. The sound has their
    /// product.
    gain: f32,
    level: f32,
    /// Samples of the half that was rendered last.
    block: [[i32; 2]; HALF_FRAMES],
}

/// Rendered half of the DMA buffer.
pub struct Half<'a> {
    /// Samples of 24 bits, left and right.
    pub frames: &'a [[i32; 2]; HALF_FRAMES],
    /// Bits that are set in the magnitude of any sample.
    pub peak_bits: u32,
}

#[unsafe(link_section = ".hot.instrument")]
static INSTRUMENT: Owned<Instrument> = Owned::empty();
/// Fast memory that the board lends to its engine ([`Board::WORDS`]).
#[unsafe(link_section = ".hot.words")]
static FAST: Owned<[Word; Lent::WORDS.fast]> = Owned::empty();
/// Bulk memory that the board lends to its engine ([`Board::WORDS`]).
#[unsafe(link_section = ".stages.words")]
static BULK: Owned<[Word; Lent::WORDS.bulk]> = Owned::empty();

/// Number of halves in time after which the budget is raised: a second.
const HALVES_PER_RAISE: u32 = 1500;

/// Core cycles that a tick may take by the engine's prediction, if all halves are in time.
const BUDGET_CYCLES: u32 = Lent::BUDGET_CYCLES;

impl Instrument {
    /// Makes the one instrument, without a kit.
    ///
    /// # Safety
    /// This is called once.
    pub unsafe fn place() -> &'static mut Self {
        let empty = Self {
            engine: None,
            strikers: [0; PADS],
            waiting: Waiting::NONE,
            begun: 0,
            budget: 0,
            in_time: 0,
            gain: 1.0,
            level: 1.0,
            block: [[0; 2]; HALF_FRAMES],
        };
        // SAFETY: the caller promises to call this once, so nothing else uses the memory.
        unsafe { INSTRUMENT.fill(empty) }
    }

    /// Loads a kit for the board's sample rate.
    ///
    /// `tell` gets the reason for each stage that is left out for want of memory or time.
    ///
    /// # Errors
    /// [`LoadError`] if the board refuses the kit as a whole. The instrument is then silent.
    // Not inlined: it runs only at the start, and its stack must not add to that of its caller.
    #[inline(never)]
    pub fn load(
        &mut self,
        kit: &Kit<'static>,
        budget_cycles_per_tick: u32,
        mut tell: impl FnMut(LoadError),
    ) -> Result<(), LoadError> {
        self.waiting = Waiting::NONE;
        self.engine = None;
        // SAFETY: the engine that borrowed the words before is dropped, and only this function of
        // the one instrument lends them.
        let memory = unsafe { Memory::new(FAST.lend(), BULK.lend()) };
        // One copy of the engine on the stack: `?` within the argument makes two.
        match Lent::engine(kit, memory, &mut tell) {
            Ok(engine) => self.engine = Some(engine),
            Err(error) => return Err(error),
        }
        if let Some(engine) = &mut self.engine {
            engine.set_budget(Some(budget_cycles_per_tick));
        }
        (self.budget, self.in_time) = (budget_cycles_per_tick, 0);
        (self.begun, self.level) = (0, 1.0);
        self.strikers = [0; PADS];
        for (count, pad) in self.strikers.iter_mut().zip(kit.pads()) {
            *count = pad.striker_indices().count() as u8;
        }
        self.restore_level();
        Ok(())
    }

    /// Sets the gain of the board's settings, 0 to 1, which multiplies each level.
    pub fn set_gain(&mut self, gain: f32) {
        self.gain = gain;
    }

    /// Drops the events that wait.
    pub(super) fn forget_events(&mut self) {
        self.waiting = Waiting::NONE;
    }

    /// Lets the sound go to its level at the next half.
    pub(super) fn restore_level(&mut self) {
        let level = Event { velocity: self.level, action: Action::Level, ..Event::NOTHING };
        if self.gain * self.level < 1.0 || self.now() > 0 {
            self.expect(Event { time: Time::at_frame(self.now()), ..level });
        }
    }

    /// Lets the sound go to silence at the next half, whatever the level of the last event.
    pub(super) fn mute(&mut self) {
        self.wait_for(Event { time: Time::at_frame(self.now()), action: Action::Level, ..Event::NOTHING });
    }

    /// Lets all sound end at the next half.
    pub(super) fn end(&mut self) {
        self.wait_for(Event { time: Time::at_frame(self.now()), action: Action::Silence, ..Event::NOTHING });
    }

    /// Adapts the budget to the time that there is: a late half lowers it by an eighth, down to a
    /// quarter, and a second without one raises it again by a sixteenth of the whole.
    ///
    /// The log holds its decisions, as all those to leave modes out.
    pub fn keep_time(&mut self, is_late: bool) {
        self.in_time = if is_late { 0 } else { self.in_time + 1 };
        let budget = match (is_late, self.in_time) {
            (true, _) => (self.budget - self.budget / 8).max(BUDGET_CYCLES / 4),
            (false, HALVES_PER_RAISE) => {
                self.in_time = 0;
                (self.budget + BUDGET_CYCLES / 16).min(BUDGET_CYCLES)
            }
            _ => return,
        };
        if budget != self.budget {
            self.budget = budget;
            if let Some(engine) = &mut self.engine {
                engine.set_budget(Some(budget));
            }
        }
    }

    /// Returns the first frame of the next half.
    pub fn now(&self) -> u64 {
        self.engine.as_ref().map_or(0, Engine::now)
    }

    /// Lets an event wait for its frame.
    ///
    /// An event whose frame has passed is counted, and happens at the first frame of the next half.
    pub fn expect(&mut self, event: Event) {
        let frame = event.time.first_frame();
        let mut event = Event { time: Time::at_frame(frame.max(self.now())), ..event };
        if event.action == Action::Level {
            self.level = event.velocity;
            event.velocity *= self.gain;
        }
        if frame < self.now() {
            counters::LATE_EVENTS.add(1);
        }
        // A pad that does not exist has no strikers.
        if event.striker >= self.strikers.get(usize::from(event.pad)).copied().unwrap_or(0) {
            return counters::REFUSED_EVENTS.add(1);
        }
        self.wait_for(event);
    }

    /// Returns true if a message that concerns all pads would find room for its events.
    pub(super) fn has_room(&self) -> bool {
        self.waiting.room() >= PADS
    }

    fn wait_for(&mut self, event: Event) {
        if !self.waiting.insert(event) {
            counters::REFUSED_EVENTS.add(1);
        }
    }

    /// Renders the next half, or returns `None` if nothing sounds and nothing happens in it.
    ///
    /// `direct` drives its pad for the whole half. `log` gets each event that happened, in order,
    /// and each decision of the engine to leave modes out.
    // Not inlined, so that its stack and that of the inputs share their place.
    #[inline(never)]
    pub fn render(&mut self, direct: Option<Direct<'_>>, mut log: impl FnMut(&Event)) -> Option<Half<'_>> {
        let engine = self.engine.as_mut()?;
        let end = engine.now() + HALF_FRAMES as u64;
        // Contacts of the last half are still under way.
        let most = STRIKES_PER_TICK.saturating_sub(self.begun).max(STRIKES_PER_TICK.div_ceil(2));
        let moving = |pad, position| engine.moving_strikes(pad, position) as usize;
        let (delayed, work) = self.waiting.put_off(most, end, moving);
        let postponed = if work > 0 { engine.postpone(self.waiting.all_mut(), direct) } else { 0 };
        self.begun = work.saturating_sub(postponed as usize);
        counters::DELAYED_STRIKES.add(delayed + postponed);
        let events = self.waiting.before(end);
        if events.is_empty() && direct.is_none() && engine.pass_silent_tick() {
            return None;
        }
        let (due, mut told) = (events.len(), 0);
        let rendered = engine.render_logged(
            events,
            direct,
            &mut self.block,
            |tick| counters::REFUSED_STAGES.add(tick.refused_stages),
            |decision| {
                counters::SHEDS.add(1);
                // In the log a decision follows the events of its frame.
                for event in events.iter().skip(told).take_while(|event| event.time <= decision.time) {
                    log(event);
                    told += 1;
                }
                log(decision);
            },
        );
        match rendered {
            Ok(()) => events.iter().skip(told).for_each(log),
            // The engine has rendered nothing, so this half is rendered without its events.
            Err(_) => {
                counters::REFUSED_EVENTS.add(due as u32);
                if engine.render(&[], None, &mut self.block).is_err() {
                    self.block = [[0; 2]; HALF_FRAMES];
                }
            }
        }
        if due > 0 {
            let strikes = events.iter().filter(|event| event.action == Action::Strike).count();
            counters::STRIKES.add(strikes as u32);
            self.waiting.pass(due);
        }
        let bits = |[left, right]: &[i32; 2]| left.unsigned_abs() | right.unsigned_abs();
        let peak_bits = self.block.iter().map(bits).fold(0, |all, bits| all | bits);
        Some(Half { frames: &self.block, peak_bits })
    }
}
