//! The whole engine: load a kit, render blocks.

use core::cell::UnsafeCell;

use dsp_core::SampleRate;
use dsp_core::engine::{Direct, Engine, STANDARD_CONTACTS, Skipping, TickReport};
#[cfg(feature = "stages")]
use dsp_core::engine::{Filters, Residuals};
use dsp_core::event::Event;
#[cfg(feature = "stages")]
use dsp_core::room::Room;
use dsp_core::table::Kit;

use crate::wire::{WireEvent, slice, slice_mut};

/// Room for the storm's kit: sixteen pads, 1024 modes.
#[cfg(not(feature = "stages"))]
type Instrument = Engine<'static, 16, 32, 1024, 256, 1024, STANDARD_CONTACTS>;

/// Room for every stage of the kit of `host-tests/src/rolls.toml`; the same type as the engine of `host-tests/src/rolls.rs`.
#[cfg(feature = "stages")]
type Instrument = Engine<'static, 4, 16, 128, 64, 128, STANDARD_CONTACTS, Stages>;
#[cfg(feature = "stages")]
type Stages = (Residuals<3>, Room<i16, 4_096>, Filters<2, 32, 16, 256, 8>);

/// What a board for 512 modes needs: eight pads that cannot be choked.
type Instrument512 = Engine<'static, 8, 8, 512, 96, 0, 16>;

struct Global(UnsafeCell<Instrument>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl Sync for Global {}

static ENGINE: Global = Global(UnsafeCell::new(Instrument::new()));

/// Most events of one block. They lie beside the engine: a board's queue is no part of the audio path's stack.
const EVENTS: usize = 64;
static PLAYED: Played = Played(UnsafeCell::new([Event::NOTHING; EVENTS]));

struct Played(UnsafeCell<[Event; EVENTS]>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl Sync for Played {}

fn engine() -> &'static mut Instrument {
    // SAFETY: as for `Sync`: the one reference of the call that runs.
    unsafe { &mut *ENGINE.0.get() }
}

/// Reads the kit at an address and derives it for a rate (a ratio). -1: not a kit, -2: does not fit, -3: not a rate.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn engine_load(kit: *const u8, bytes: usize, numerator: u32, denominator: u32) -> i32 {
    // SAFETY: the host's word.
    let bytes = unsafe { slice(kit, bytes) };
    let Some(rate) = SampleRate::new(numerator, denominator) else { return -3 };
    let Ok(kit) = Kit::parse(bytes) else { return -1 };
    match engine().load(&kit, rate, Skipping::On) {
        Ok(()) => 0,
        Err(_) => -2,
    }
}

/// What a block is made of.
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

/// Renders a block of 24-bit stereo samples. -1: an event cannot be, -2: too many events; the host says -3 for too many frames.
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

/// What the last call told: the last tick's predicted cycles, groups and modes that were shed and the bits of the amplitude that is missing by
/// it; and all decisions.
#[repr(C)]
struct Told {
    report: [u32; 4],
    decision_count: usize,
    decisions: [WireEvent; EVENTS],
}

struct GlobalTold(UnsafeCell<Told>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl Sync for GlobalTold {}

static TOLD: GlobalTold =
    GlobalTold(UnsafeCell::new(Told { report: [0; 4], decision_count: 0, decisions: [WireEvent::NOTHING; EVENTS] }));

/// Where the last call's report lies: four words, then the number of decisions, then (8-byte aligned) the decisions.
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

/// Bytes of an engine with 512 modes on eight pads.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn engine_512_bytes() -> u32 {
    size_of::<Instrument512>() as u32
}
