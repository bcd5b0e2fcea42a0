//! A bank in frames on a bare Cortex-M4F, without an engine.
//!
//! Nothing starts by itself: the virtual core writes tables and forces into memory and calls the
//! exported functions. The code on the host is in `host-tests/src/on_chip/frames.rs`.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;
use core::panic::PanicInfo;

use dsp_core::SampleRate;
use dsp_core::frames::{BLOCK_FRAMES, FrameBank, FrameMixer};
use dsp_core::memory::{Memory, Word};
use dsp_core::output::Panner;
use dsp_core::resonator::{BankTable, TICK_FRAMES};
use dsp_core::table::layout::{GainRecord, ModeRecord};

/// Entry that a linker needs; the virtual core never starts here.
#[unsafe(no_mangle)]
pub extern "C" fn _start() -> ! {
    loop {}
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // An undefined instruction: the virtual core stops and names the function.
    // SAFETY: never returns.
    unsafe { core::arch::asm!("udf #0", options(noreturn)) }
}

struct Global<T>(UnsafeCell<T>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl<T> Sync for Global<T> {}

/// Memory of one bank and the mixer: 116 KB.
static WORDS: Global<[Word; 14_500]> = Global(UnsafeCell::new([Word::uninit(); 14_500]));
static STAGE: Global<Option<Stage>> = Global(UnsafeCell::new(None));

struct Stage {
    banks: [FrameBank<'static>; 1],
    mixer: FrameMixer<'static>,
    panner: Panner,
    now: usize,
    bytes: usize,
}

fn stage() -> Option<&'static mut Stage> {
    // SAFETY: see `Sync` for `Global`: this is the running call's only reference.
    unsafe { &mut *STAGE.0.get() }.as_mut()
}

/// Slice that the host has laid at an address.
///
/// # Safety
/// `count` valid and aligned values lie there, and nothing else uses them during the call.
unsafe fn slice<'a, T>(address: *const T, count: usize) -> &'a [T] {
    // SAFETY: the caller keeps the rule above.
    unsafe { core::slice::from_raw_parts(address, count) }
}

fn loaded(table: &BankTable<'static>, rate: SampleRate, retires: bool) -> Option<Stage> {
    // SAFETY: see `Sync` for `Global`; the bank that had the words before is replaced.
    let words = unsafe { &mut *WORDS.0.get() };
    let mut memory = Memory::new(words, &mut []);
    let mut mixer = FrameMixer::take(&mut memory, retires).ok()?;
    let mut bank = FrameBank::take(&mut memory, FrameBank::size(table, rate).ok()?).ok()?;
    // 1 on the left side as exactly as the panner has it.
    bank.load(table, rate, [1.0, 0.0], &mut mixer).ok()?;
    let bytes = memory.used().bytes();
    Some(Stage { banks: [bank], mixer, panner: Panner::new(0.0, -1.0), now: 0, bytes })
}

/// Loads modes of one position at a rate in whole Hz, with weight 1. -1: they do not fit.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn frames_load(
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
        typical_contact: (0.0, 0.0),
    };
    // SAFETY: see `Sync` for `Global`.
    let slot = unsafe { &mut *STAGE.0.get() };
    *slot = loaded(&table, rate, true);
    if slot.is_some() { 0 } else { -1 }
}

/// Adds a run within a tick to the stereo bus; `force` is null without a force.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn frames_render(force: *const i32, out: *mut [i32; 2], frames: usize) -> i32 {
    let Some(stage) = stage() else { return -1 };
    // SAFETY: the host has written `frames` frames there, and as much force.
    let (out, force) = unsafe {
        let force = if force.is_null() { None } else { Some(slice(force, frames)) };
        (core::slice::from_raw_parts_mut(out, frames), force)
    };
    let frame = stage.now % BLOCK_FRAMES;
    if frame == 0 {
        stage.mixer.begin_block(&mut stage.banks);
    }
    let [bank] = &mut stage.banks;
    if force.is_some() || bank.is_head_active() {
        let mut sound = [0; TICK_FRAMES];
        let Some(sound) = sound.get_mut(..frames) else { return -1 };
        bank.begin_run(frame);
        bank.render([force, None], sound);
        stage.panner.render(sound, out);
    }
    stage.mixer.render(frame, out);
    stage.now += frames;
    if stage.now.is_multiple_of(TICK_FRAMES) {
        stage.mixer.end_tick((stage.now - 1) % BLOCK_FRAMES / TICK_FRAMES, 0.0, &mut stage.banks);
    }
    0
}

/// Number of modes that ring in frames.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn frames_ringing() -> u32 {
    stage().map_or(0, |stage| stage.banks[0].running_modes())
}

/// Bytes of the memory that bank and mixer have taken.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn frames_bytes() -> u32 {
    stage().map_or(0, |stage| stage.bytes as u32)
}
