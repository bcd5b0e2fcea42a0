//! The engine with its kit and the events that wait for their frame.

use dsp_core::engine::{Direct, Engine, LoadError, STANDARD_CONTACTS, Skipping};
use dsp_core::event::{Action, Event, Time};
use dsp_core::table::Kit;

use super::i2s::HALF_FRAMES;
use super::waiting::Waiting;
use crate::board::CLOCKS;
use crate::counters;
use crate::owned::Owned;

/// Pads of an engine of the boards.
pub const PADS: usize = 16;
/// Banks: a pad's object, and its strikers up to the last one with modes.
const BANKS: usize = 32;
/// Modes, all pads together.
const MODES: usize = 640;
/// Register groups: a sixth of the modes, and up to six more a bank.
const GROUPS: usize = 224;
/// Modes that can be choked or have several positions.
const ORIGINS: usize = 512;

type BoardEngine = Engine<'static, PADS, BANKS, MODES, GROUPS, ORIGINS, STANDARD_CONTACTS>;

/// What turns events into sound.
pub struct Instrument {
    engine: BoardEngine,
    /// How many strikers each pad has.
    strikers: [u8; PADS],
    waiting: Waiting,
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
        let empty = Self {
            engine: BoardEngine::new(),
            strikers: [0; PADS],
            waiting: Waiting::NONE,
            block: [[0; 2]; HALF_FRAMES],
        };
        // SAFETY: the caller's word.
        unsafe { INSTRUMENT.fill(empty) }
    }

    /// Loads a kit for the board's sample rate.
    ///
    /// # Errors
    /// [`LoadError`]; the instrument is then silent.
    #[inline(never)] // only at the start: its stack is not the program's
    pub fn load(&mut self, kit: &Kit<'static>, budget_cycles_per_tick: u32) -> Result<(), LoadError> {
        self.waiting = Waiting::NONE;
        self.engine.load(kit, CLOCKS.sample_rate(), Skipping::On)?;
        self.engine.set_budget(Some(budget_cycles_per_tick));
        self.strikers = [0; PADS];
        for (count, pad) in self.strikers.iter_mut().zip(kit.pads()) {
            *count = pad.striker_indices().count() as u8;
        }
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
        // A pad that is not there has no strikers.
        if event.striker >= self.strikers.get(usize::from(event.pad)).copied().unwrap_or(0) {
            return counters::REFUSED_EVENTS.add(1);
        }
        if !self.waiting.insert(event) {
            counters::REFUSED_EVENTS.add(1);
        }
    }

    /// Renders the next half. `log` is told every event that happened, decisions to leave something out among them, in order.
    /// `direct` drives its pad for the whole half.
    #[inline(never)] // as the inputs
    pub fn render(&mut self, direct: Option<Direct<'_>>, mut log: impl FnMut(&Event)) -> &[[i32; 2]; HALF_FRAMES] {
        let end = self.engine.now() + HALF_FRAMES as u64;
        let events = self.waiting.before(end);
        let (due, mut told) = (events.len(), 0);
        let rendered = self.engine.render_logged(
            events,
            direct,
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
        self.waiting.pass(due);
        &self.block
    }
}
