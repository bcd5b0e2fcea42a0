//! The engine with its kit and the events that wait for their frame.

use dsp_core::engine::{Engine, LoadError, STANDARD_CONTACTS, Skipping};
use dsp_core::event::{Action, Event, Time};
use dsp_core::table::Kit;
use heapless::Vec;

use super::i2s::HALF_FRAMES;
use crate::board::CLOCKS;
use crate::counters;
use crate::owned::Owned;

/// Pads of an engine of the boards.
pub const PADS: usize = 16;
/// Modes, all pads together.
const MODES: usize = 768;
/// Register groups: a sixth of the modes, and up to eight more a bank.
const GROUPS: usize = 256;
/// Modes that can be choked or have several positions.
const ORIGINS: usize = 640;

type BoardEngine = Engine<'static, PADS, MODES, GROUPS, ORIGINS, STANDARD_CONTACTS>;

/// Events that may wait for the next half at once.
const WAITING: usize = 32;

/// What turns events into sound.
pub struct Instrument {
    engine: BoardEngine,
    kit: Option<Kit<'static>>,
    waiting: Vec<Event, WAITING>,
    block: [[i32; 2]; HALF_FRAMES],
}

#[unsafe(link_section = ".hot")]
static INSTRUMENT: Owned<Instrument> = Owned::empty();

impl Instrument {
    /// The one instrument, without a kit.
    ///
    /// # Safety
    /// Called once.
    pub unsafe fn place() -> &'static mut Self {
        let empty = Self { engine: BoardEngine::new(), kit: None, waiting: Vec::new(), block: [[0; 2]; HALF_FRAMES] };
        // SAFETY: the caller's word.
        unsafe { INSTRUMENT.fill(empty) }
    }

    /// Loads a kit for the board's sample rate.
    ///
    /// # Errors
    /// [`LoadError`]; the instrument is then silent.
    pub fn load(&mut self, kit: Kit<'static>, budget_cycles_per_tick: u32) -> Result<(), LoadError> {
        self.waiting.clear();
        self.engine.load(&kit, CLOCKS.sample_rate(), Skipping::On)?;
        self.engine.set_budget(Some(budget_cycles_per_tick));
        self.kit = Some(kit);
        Ok(())
    }

    /// The frame that the next half begins with.
    pub fn now(&self) -> u64 {
        self.engine.now()
    }

    /// Lets an event wait for its frame; one that comes too late happens at the next half's first, and is counted.
    pub fn expect(&mut self, event: Event) {
        let frame = event.time.first_frame();
        let event = Event { time: Time::at_frame(frame.max(self.now())), ..event };
        if frame < self.now() {
            counters::LATE_EVENTS.add(1);
        }
        if usize::from(event.pad) >= self.engine.pad_count() {
            return counters::REFUSED_EVENTS.add(1);
        }
        let place = self.waiting.iter().position(|waiting| waiting.time > event.time).unwrap_or(self.waiting.len());
        if self.waiting.insert(place, event).is_err() {
            counters::REFUSED_EVENTS.add(1);
        }
    }

    /// Renders the next half. `log` is told every event that happened, decisions to leave something out among them, in order.
    pub fn render(&mut self, mut log: impl FnMut(&Event)) -> &[[i32; 2]; HALF_FRAMES] {
        let end = self.engine.now() + HALF_FRAMES as u64;
        let due = self.waiting.iter().take_while(|event| event.time.first_frame() < end).count();
        let mut told = 0;
        let events = self.waiting.get(..due).unwrap_or(&[]);
        let rendered = self.engine.render_logged(
            events,
            None,
            &mut self.block,
            |_| {},
            |decision| {
                counters::SHEDS.add(1);
                // A decision stands behind the events of its frame.
                for event in events.iter().skip(told).take_while(|event| event.time <= decision.time) {
                    log(event);
                    told += 1;
                }
                log(decision);
            },
        );
        match rendered {
            Ok(()) => events.iter().skip(told).for_each(log),
            // Nothing has been rendered: the same half without its events.
            Err(_) => {
                counters::REFUSED_EVENTS.add(due as u32);
                if self.engine.render(&[], None, &mut self.block).is_err() {
                    self.block = [[0; 2]; HALF_FRAMES];
                }
            }
        }
        let strikes = events.iter().filter(|event| event.action == Action::Strike).count();
        counters::STRIKES.add(strikes as u32);
        self.waiting.drain(..due.min(self.waiting.len()));
        &self.block
    }
}
