//! The bank alone: modes, guards and kernels without pads or output.

use core::cell::UnsafeCell;

use dsp_core::SampleRate;
use dsp_core::resonator::{Bank, BankTable, Group, Memory, Mode, Origin, Retirement, TICK_FRAMES, Used};
use dsp_core::table::layout::{GainRecord, ModeRecord};

use crate::wire::slice;

const MODES: usize = 1024;

struct Alone {
    bank: Bank,
    modes: [Mode; MODES],
    groups: [Group; MODES / 4],
    origins: [Origin; 0],
}

struct Global(UnsafeCell<Alone>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl Sync for Global {}

static ALONE: Global = Global(UnsafeCell::new(Alone {
    bank: Bank::EMPTY,
    modes: [Mode::SILENT; MODES],
    groups: [Group::EMPTY; MODES / 4],
    origins: [],
}));

fn alone() -> (&'static mut Bank, Memory<'static>) {
    // SAFETY: as for `Sync`: the one reference of the call that runs.
    let alone = unsafe { &mut *ALONE.0.get() };
    let memory = Memory { modes: &mut alone.modes, groups: &mut alone.groups, origins: &mut alone.origins };
    (&mut alone.bank, memory)
}

/// Loads modes at 48 kHz, or at the rate given in Hz. -1: they do not fit.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn bank_load(
    modes: *const ModeRecord,
    gains: *const GainRecord,
    count: usize,
    rate_hz: u32,
) -> i32 {
    // SAFETY: the host's word.
    let (modes, gains) = unsafe { (slice(modes, count), slice(gains, count)) };
    let Some(rate) = SampleRate::new(rate_hz, 1) else { return -1 };
    let table = BankTable { modes, gains, positions: 1, weight: 1.0, choke_t60_s: 0.0, is_balanced: false, typical_contact: (1e-3, 1e-3) };
    let (bank, mut memory) = alone();
    match Bank::load(&table, rate, &mut memory, &mut Used::default()) {
        Ok(loaded) => {
            *bank = loaded;
            0
        }
        Err(_) => -1,
    }
}

/// The bookkeeping of a tick, with retirement where asked. Gives the modes that still ring.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn bank_tick(retire: u32) -> u32 {
    let (bank, mut memory) = alone();
    let mut retirement = Retirement::new(0.0, 1.0 / 134_217_728.0);
    bank.tick(&mut memory, (retire != 0).then_some(&mut retirement));
    bank.ringing_modes()
}

/// Adds a tick, or a part of one, to `out`. `force` may be null.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn bank_render(force: *const i32, out: *mut [i32; TICK_FRAMES], frames: usize) -> i32 {
    // SAFETY: the host's word.
    let (force, out) = unsafe { ((!force.is_null()).then(|| slice(force, frames)), &mut *out) };
    let Some(out) = out.get_mut(..frames) else { return -1 };
    let (bank, mut memory) = alone();
    bank.render(&mut memory, force, false, true, out);
    0
}
