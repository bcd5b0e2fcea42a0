//! The whole engine: loads a kit and renders blocks.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use dsp_core::SampleRate;
use dsp_core::engine::{Direct, Engine, Setup, TickReport};
use dsp_core::event::Event;
use dsp_core::memory::{Memory, WORD_BYTES, Word, Words};
use dsp_core::table::Kit;

use crate::wire::{WireEvent, slice, slice_mut};

/// Maximum number of samples in the room's delay lines, as in `host-tests/src/lent.rs`.
const ROOM_SAMPLES: usize = 4_096;

/// Number of words that the image lends: enough for the kit of `host-tests/src/rolls.toml`, for
/// 1024 modes on 16 pads, and with the large memory for 1025 modes in frames with 100 bands.
const WORDS: usize = 14_500;
/// Number of words of large memory, beside the core.
const BULK_WORDS: usize = 3_584;

/// Static that only the running call reads and writes.
struct Global<T>(UnsafeCell<T>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl<T> Sync for Global<T> {}

/// Engine, from the first `engine_load` on.
///
/// It has a static of its own. Beside the words, its fields would be out of a load instruction's
/// reach, which cost a tick of silence 60 cycles.
static ENGINE: Global<MaybeUninit<Engine<'static, 'static>>> = Global(UnsafeCell::new(MaybeUninit::uninit()));
/// Number of words that the engine has taken.
static USED: Global<Words> = Global(UnsafeCell::new(Words { fast: 0, bulk: 0 }));
/// Memory that the image lends to the engine.
static LENT: Global<[Word; WORDS]> = Global(UnsafeCell::new([Word::uninit(); WORDS]));

/// Large memory that the image lends to the engine.
#[unsafe(link_section = ".ccm.lent")]
static BULK: Global<[Word; BULK_WORDS]> = Global(UnsafeCell::new([Word::uninit(); BULK_WORDS]));

/// Limiter ceiling in dB of full scale, for engines loaded from now on; `None` for no limiter.
static CEILING_DB: Global<Option<f32>> = Global(UnsafeCell::new(None));

/// Sets the ceiling for engines loaded from now on, as the bits of an `f32`. A NaN means no
/// limiter.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn engine_limit(ceiling_db_bits: u32) {
    let ceiling_db = f32::from_bits(ceiling_db_bits);
    // SAFETY: see `Sync` for `Global`.
    unsafe { *CEILING_DB.0.get() = (!ceiling_db.is_nan()).then_some(ceiling_db) };
}

/// Limit to the cycles of pads in frames, for engines loaded from now on; at first as in
/// `host-tests/src/lent.rs`.
static FRAME_CYCLES: Global<Option<u32>> = Global(UnsafeCell::new(Some(2_800)));

/// Takes the limit to the cycles of pads in frames away, for engines loaded from now on.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn engine_unlimited() {
    // SAFETY: see `Sync` for `Global`.
    unsafe { *FRAME_CYCLES.0.get() = None };
}

/// Maximum number of events of a block. They lie beside the engine, because a board's queue is not
/// on the stack of the audio path either.
const EVENTS: usize = 64;
static PLAYED: Global<[Event; EVENTS]> = Global(UnsafeCell::new([Event::NOTHING; EVENTS]));

fn engine() -> &'static mut Engine<'static, 'static> {
    // SAFETY: see `Sync` for `Global`: this is the running call's only reference. The host loads a
    // kit first.
    unsafe { (*ENGINE.0.get()).assume_init_mut() }
}

/// Reads the kit at an address and derives it for a rate (a ratio). -1: not a kit, -2: does not
/// fit, -3: not a rate.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn engine_load(kit: *const u8, bytes: usize, numerator: u32, denominator: u32) -> i32 {
    // SAFETY: the host has written the kit there.
    let bytes = unsafe { slice(kit, bytes) };
    let Some(rate) = SampleRate::new(numerator, denominator) else { return -3 };
    let Ok(kit) = Kit::parse(bytes) else { return -1 };
    // SAFETY: see `Sync` for `Global`; an engine that was there before is not used again.
    let (slot, used) = unsafe { (&mut *ENGINE.0.get(), &mut *USED.0.get()) };
    // SAFETY: as above.
    let (lent, bulk) = unsafe { (&mut *LENT.0.get(), &mut *BULK.0.get()) };
    // SAFETY: see `Sync` for `Global`.
    let (ceiling_db, frame_cycles) = unsafe { (*CEILING_DB.0.get(), *FRAME_CYCLES.0.get()) };
    let setup = Setup { room_samples: ROOM_SAMPLES, ceiling_db, frame_cycles, ..Setup::new(rate) };
    match Engine::new(&kit, setup, Memory::new(lent, bulk)) {
        Ok(engine) => {
            *used = engine.words();
            slot.write(engine);
            0
        }
        Err(_) => -2,
    }
}

/// Arguments of `engine_render`.
#[repr(C)]
pub struct Block {
    events: *const WireEvent,
    event_count: usize,
    /// Direct force of `frames` samples; null if there is none.
    direct: *const i32,
    direct_pad: u32,
    out: *mut [i32; 2],
    frames: usize,
}

/// Renders a block of 24-bit stereo samples. -1: an event is invalid, -2: too many events. The host
/// itself gives -3 for too many frames.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn engine_render(block: *const Block) -> i32 {
    // SAFETY: the host has written the block and all that it points to.
    let (block, events, out) = unsafe {
        let block = &*block;
        (block, slice(block.events, block.event_count), slice_mut(block.out, block.frames))
    };
    // SAFETY: see `Sync` for `Global`: this is the running call's only reference.
    let played = unsafe { &mut *PLAYED.0.get() };
    let Some(played) = played.get_mut(..events.len()) else { return -2 };
    played.iter_mut().zip(events).for_each(|(played, wire)| *played = wire.event());
    let direct = (!block.direct.is_null()).then(|| {
        // SAFETY: the host has written `frames` samples of force there.
        Direct { pad: block.direct_pad as u8, force: unsafe { slice(block.direct, block.frames) } }
    });
    // SAFETY: see `Sync` for `Global`: this is the running call's only reference.
    let told = unsafe { &mut *TOLD.0.get() };
    told.decision_count = 0;
    let Told { report, decision_count, decisions } = told;
    let keep = |tick: &TickReport| {
        // Without a budget there are no counts, and the host does not ask for a prediction.
        let predicted = if tick.counts.is_any() { tick.predicted_cycles() } else { 0 };
        *report = [predicted, tick.shed.groups, tick.shed.modes];
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

/// Report of the last call, and all its shed decisions.
///
/// The report's words are the last tick's predicted cycles, the groups and modes that it shed, and
/// the bits of the amplitude that is missing because of them.
#[repr(C)]
struct Told {
    report: [u32; 3],
    decision_count: usize,
    decisions: [WireEvent; EVENTS],
}

static TOLD: Global<Told> =
    Global(UnsafeCell::new(Told { report: [0; 3], decision_count: 0, decisions: [WireEvent::NOTHING; EVENTS] }));

/// Address of the last call's report: three words, then the number of decisions, then (8-byte
/// aligned) the decisions.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn engine_told() -> u32 {
    TOLD.0.get() as u32
}

/// Sets the cycles that a tick may take; 0 for no limit.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn engine_budget(cycles_per_tick: u32) {
    engine().set_budget((cycles_per_tick > 0).then_some(cycles_per_tick));
}

/// Bytes of RAM of the engine that was loaded last: its own size and the memory that it took.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn engine_bytes() -> u32 {
    // SAFETY: see `Sync` for `Global`.
    let used = unsafe { &*USED.0.get() };
    ((used.fast + used.bulk) * WORD_BYTES + size_of::<Engine<'static, 'static>>()) as u32
}
