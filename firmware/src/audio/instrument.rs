//! The engine with its kit and the events that wait for their frame.

pub use boards::PADS;
use boards::{Board, BoardEngine};
use dsp_core::engine::{Apart, Direct, FilterPlace, LoadError, ResidualPlace, RoomStage, Skipping};
use dsp_core::event::{Action, Event, Time};
use dsp_core::table::Kit;

use super::i2s::HALF_FRAMES;
use super::waiting::Waiting;
use crate::board::{CLOCKS, Memory};
use crate::counters;
use crate::owned::Owned;

type Residuals = <Memory as Board>::Residuals;
type Room = <Memory as Board>::Room;
type Filters = <Memory as Board>::Filters;

/// The board's engine (`boards`, told where), its stages in the memories that have room for them.
type PlacedEngine = BoardEngine<'static, (Apart<'static, Residuals>, Apart<'static, Room>, Apart<'static, Filters>)>;

/// What turns events into sound.
pub struct Instrument {
    engine: PlacedEngine,
    /// How many strikers each pad has.
    strikers: [u8; PADS],
    waiting: Waiting,
    block: [[i32; 2]; HALF_FRAMES],
}

/// A half as it will be heard.
pub struct Half<'a> {
    /// Samples of 24 bits, left and right.
    pub frames: &'a [[i32; 2]; HALF_FRAMES],
    /// The bits that any of their magnitudes has.
    pub peak_bits: u32,
}

#[unsafe(link_section = ".hot.instrument")]
static INSTRUMENT: Owned<Instrument> = Owned::empty();
#[unsafe(link_section = ".stages.filters")]
static FILTERS: Owned<Filters> = Owned::empty();
#[unsafe(link_section = ".stages.residuals")]
static RESIDUALS: Owned<Residuals> = Owned::empty();
#[unsafe(link_section = ".hot.room")]
static ROOM: Owned<Room> = Owned::empty();

impl Instrument {
    /// The one instrument, without a kit.
    ///
    /// # Safety
    /// Called once.
    pub unsafe fn place() -> &'static mut Self {
        // One after the other, each copied to its place from flash: they are larger than the stack.
        // SAFETY: the caller's word.
        let residuals = unsafe { RESIDUALS.fill_each(|| ResidualPlace::FREE) };
        // SAFETY: likewise.
        let room = unsafe { ROOM.fill(Room::EMPTY) };
        // SAFETY: likewise.
        let filters = unsafe { FILTERS.fill_each(|| FilterPlace::FREE) };
        let empty = Self {
            engine: PlacedEngine::with_stages(Apart::new(residuals), Apart::new(room), Apart::new(filters)),
            strikers: [0; PADS],
            waiting: Waiting::NONE,
            block: [[0; 2]; HALF_FRAMES],
        };
        // SAFETY: the caller's word.
        unsafe { INSTRUMENT.fill(empty) }
    }

    /// Loads a kit for the board's sample rate. `tell` is told what is left out of it for want of memory or time.
    ///
    /// # Errors
    /// [`LoadError`]; the instrument is then silent.
    #[inline(never)] // only at the start: its stack is not the program's
    pub fn load(
        &mut self,
        kit: &Kit<'static>,
        budget_cycles_per_tick: u32,
        tell: impl FnMut(LoadError),
    ) -> Result<(), LoadError> {
        self.waiting = Waiting::NONE;
        self.engine.load_what_fits(kit, CLOCKS.sample_rate(), Skipping::On, Memory::STAGE_CYCLES, tell)?;
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
    /// `direct` drives its pad for the whole half. `None` is silence: nothing sounds and nothing happens.
    #[inline(never)] // as the inputs
    pub fn render(&mut self, direct: Option<Direct<'_>>, mut log: impl FnMut(&Event)) -> Option<Half<'_>> {
        let end = self.engine.now() + HALF_FRAMES as u64;
        let events = self.waiting.before(end);
        if events.is_empty() && direct.is_none() && self.engine.pass_silent_tick() {
            return None;
        }
        let (due, mut told) = (events.len(), 0);
        let rendered = self.engine.render_logged(
            events,
            direct,
            &mut self.block,
            |tick| counters::REFUSED_STAGES.add(tick.refused_stages),
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
