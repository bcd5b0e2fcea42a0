//! The whole engine: load a kit, render blocks.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use dsp_core::SampleRate;
use dsp_core::engine::{Direct, Engine, Setup, TickReport};
use dsp_core::event::Event;
use dsp_core::memory::{Memory, WORD_BYTES, Word, Words};
use dsp_core::table::Kit;

use crate::wire::{WireEvent, slice, slice_mut};

/// Most samples in the delay lines of the room, as in `host-tests/src/lent.rs`.
const ROOM_SAMPLES: usize = 4_096;

/// Words of memory that the image lends: those of the kit of `host-tests/src/rolls.toml` and of
/// 1024 modes on 16 pads.
const WORDS: usize = 13_500;

/// A static that only the call that runs reads and writes.
struct Global<T>(UnsafeCell<T>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl<T> Sync for Global<T> {}

/// The engine, from the first `engine_load` on. A static of its own: beside the words its fields
/// would lie beyond what a load instruction reaches, which took a tick of silence 60 cycles.
static ENGINE: Global<MaybeUninit<Engine<'static, 'static>>> = Global(UnsafeCell::new(MaybeUninit::uninit()));
/// Words that the engine has taken.
static USED: Global<Words> = Global(UnsafeCell::new(Words { fast: 0, bulk: 0 }));
/// Memory that the image lends.
static LENT: Global<[Word; WORDS]> = Global(UnsafeCell::new([Word::uninit(); WORDS]));

/// Ceiling of the limiter of engines loaded from now on, in dB of full scale.
static CEILING_DB: Global<Option<f32>> = Global(UnsafeCell::new(None));

/// Sets the ceiling of engines loaded from now on, as the bits of an f32; a NaN for no limiter.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn engine_limit(ceiling_db_bits: u32) {
    let ceiling_db = f32::from_bits(ceiling_db_bits);
    // SAFETY: as for `Sync`.
    unsafe { *CEILING_DB.0.get() = (!ceiling_db.is_nan()).then_some(ceiling_db) };
}

/// Most events of one block. They lie beside the engine: a board's queue is no part of the audio
/// path's stack.
const EVENTS: usize = 64;
static PLAYED: Global<[Event; EVENTS]> = Global(UnsafeCell::new([Event::NOTHING; EVENTS]));

fn engine() -> &'static mut Engine<'static, 'static> {
    // SAFETY: as for `Sync`: the one reference of the call that runs; the host loads a kit first.
    unsafe { (*ENGINE.0.get()).assume_init_mut() }
}

/// Reads the kit at an address and derives it for a rate (a ratio). -1: not a kit, -2: does not
/// fit, -3: not a rate.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn engine_load(kit: *const u8, bytes: usize, numerator: u32, denominator: u32) -> i32 {
    // SAFETY: the host's word.
    let bytes = unsafe { slice(kit, bytes) };
    let Some(rate) = SampleRate::new(numerator, denominator) else { return -3 };
    let Ok(kit) = Kit::parse(bytes) else { return -1 };
    // SAFETY: as for `Sync`; an engine that was there before is not used again.
    let (slot, used, lent) = unsafe { (&mut *ENGINE.0.get(), &mut *USED.0.get(), &mut *LENT.0.get()) };
    // SAFETY: as for `Sync`.
    let ceiling_db = unsafe { *CEILING_DB.0.get() };
    let setup = Setup { room_samples: ROOM_SAMPLES, ceiling_db, ..Setup::new(rate) };
    match Engine::new(&kit, setup, Memory::new(lent, &mut [])) {
        Ok(engine) => {
            *used = engine.words();
            slot.write(engine);
            0
        }
        Err(_) => -2,
    }
}

/// Arguments of a block.
#[repr(C)]
pub struct Block {
    events: *const WireEvent,
    event_count: usize,
    /// Null where there is no direct force.
    direct: *const i32,
    direct_pad: u32,
    out: *mut [i32; 2],
    frames: usize,
}

/// Renders a block of 24-bit stereo samples. -1: an event cannot be, -2: too many events; the host
/// says -3 for too many frames.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn engine_render(block: *const Block) -> i32 {
    // SAFETY: the host's word, for the block and all that it points to.
    let (block, events, out) = unsafe {
        let block = &*block;
        (block, slice(block.events, block.event_count), slice_mut(block.out, block.frames))
    };
    // SAFETY: as for `Sync`: the one reference of the call that runs.
    let played = unsafe { &mut *PLAYED.0.get() };
    let Some(played) = played.get_mut(..events.len()) else { return -2 };
    played.iter_mut().zip(events).for_each(|(played, wire)| *played = wire.event());
    let direct = (!block.direct.is_null()).then(|| {
        // SAFETY: the host's word.
        Direct { pad: block.direct_pad as u8, force: unsafe { slice(block.direct, block.frames) } }
    });
    // SAFETY: as for `Sync`: the one reference of the call that runs.
    let told = unsafe { &mut *TOLD.0.get() };
    told.decision_count = 0;
    let Told { report, decision_count, decisions } = told;
    let keep = |tick: &TickReport| {
        // Without a budget nothing is counted, and nobody asks.
        let predicted = if tick.counts.is_any() { tick.predicted_cycles() } else { 0 };
        *report = [predicted, tick.shed.groups, tick.shed.modes, tick.shed.amplitude.to_bits()];
    };
    let log = |event: &Event| {
        if let Some(place) = decisions.get_mut(*decision_count) {
            *place = WireEvent::shedding(event);
            *decision_count += 1;
        }
    };
    match engine().render_logged(played, direct, out, keep, log) {
        Ok(()) => 0,
        Err(_) => -1,
    }
}

/// Report of the last call: the last tick's predicted cycles, groups and modes that were shed and
/// the bits of the amplitude that is missing by it; and all decisions.
#[repr(C)]
struct Told {
    report: [u32; 4],
    decision_count: usize,
    decisions: [WireEvent; EVENTS],
}

static TOLD: Global<Told> =
    Global(UnsafeCell::new(Told { report: [0; 4], decision_count: 0, decisions: [WireEvent::NOTHING; EVENTS] }));

/// Address of the last call's report: four words, then the number of decisions, then (8-byte
/// aligned) the decisions.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn engine_told() -> u32 {
    TOLD.0.get() as u32
}

/// Cycles a tick may take; 0: any.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn engine_budget(cycles_per_tick: u32) {
    engine().set_budget((cycles_per_tick > 0).then_some(cycles_per_tick));
}

/// Bytes of RAM of the engine that was loaded last: itself and the memory that it took.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn engine_bytes() -> u32 {
    // SAFETY: as for `Sync`.
    let used = unsafe { &*USED.0.get() };
    ((used.fast + used.bulk) * WORD_BYTES + size_of::<Engine<'static, 'static>>()) as u32
}
