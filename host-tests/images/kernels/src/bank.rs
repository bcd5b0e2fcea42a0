//! The bank of modes alone: modes, guards and kernels, without pads or output.

use core::cell::UnsafeCell;

use dsp_core::SampleRate;
use dsp_core::memory::{Memory, Word};
use dsp_core::resonator::{Bank, BankTable, Retirement, TICK_FRAMES};
use dsp_core::table::layout::{GainRecord, ModeRecord};

use crate::wire::slice;

const MODES: usize = 1024;

struct Global<T>(UnsafeCell<T>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl<T> Sync for Global<T> {}

static BANK: Global<Bank<'static>> = Global(UnsafeCell::new(Bank::empty()));
/// Memory of the modes and of a quarter as many groups, 24 bytes each.
static WORDS: Global<[Word; MODES * 15 / 4]> = Global(UnsafeCell::new([Word::uninit(); MODES * 15 / 4]));

fn bank() -> &'static mut Bank<'static> {
    // SAFETY: see `Sync` for `Global`: this is the running call's only reference.
    unsafe { &mut *BANK.0.get() }
}

/// Loads modes at a rate in whole Hz. -1: they do not fit.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn bank_load(
    modes: *const ModeRecord,
    gains: *const GainRecord,
    count: usize,
    rate_hz: u32,
) -> i32 {
    // SAFETY: the host has written `count` modes and gains there.
    let (modes, gains) = unsafe { (slice(modes, count), slice(gains, count)) };
    let Some(rate) = SampleRate::new(rate_hz, 1) else { return -1 };
    let table = BankTable {
        modes,
        gains,
        positions: 1,
        weight: 1.0,
        choke_t60_s: 0.0,
        is_balanced: false,
        typical_contact: (1e-3, 1e-3),
    };
    // SAFETY: see `Sync` for `Global`; the bank that had the words before is replaced.
    let words = unsafe { &mut *WORDS.0.get() };
    let Ok(size) = Bank::size(&table, rate) else { return -1 };
    let Ok(taken) = Bank::take(&mut Memory::new(words, &mut []), size) else { return -1 };
    *bank() = taken;
    if bank().load(&table, rate).is_ok() { 0 } else { -1 }
}

/// Does the bookkeeping of a tick, with retirement unless `retire` is 0. Gives the number of modes
/// that still ring.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn bank_tick(retire: u32) -> u32 {
    let bank = bank();
    let mut retirement = Retirement::new(0.0, 1.0 / 134_217_728.0);
    bank.tick((retire != 0).then_some(&mut retirement));
    bank.ringing_modes()
}

/// Adds the sound of a tick or of a part of one to `out`. `force` may be null.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn bank_render(force: *const i32, out: *mut [i32; TICK_FRAMES], frames: usize) -> i32 {
    // SAFETY: the host leaves `frames` samples of force, if any, and a tick of output there.
    let (force, out) = unsafe { ((!force.is_null()).then(|| slice(force, frames)), &mut *out) };
    let Some(out) = out.get_mut(..frames) else { return -1 };
    bank().render(force, false, true, out);
    0
}
