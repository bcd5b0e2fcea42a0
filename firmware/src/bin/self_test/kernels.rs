//! DWT cycles of every kernel of the bank, beside the cycle model's.

use dsp_core::resonator::{Bank, BankTable, Group, Memory, Mode, TICK_FRAMES, Used};
use dsp_core::table::{Kit, Object};
use firmware::board::CLOCKS;
use firmware::owned::Owned;
use firmware::{cycles, watchdog};

use crate::Failures;

/// Modes of each form, made by the build script.
const KIT: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/self-test-kit.bin"));

const MODES: usize = 240;
/// Ticks that are timed; as many before them warm the flash accelerator up.
const TICKS: u32 = 32;
/// A steady force, in bus steps: -60 dB.
const FORCE: i32 = 1 << 17;
/// How much the chip may be dearer than the model, in percent.
const TOLERANCE_PERCENT: u32 = 15;

/// What the cycle model says of any form but the mirrored, which costs up to 0.16 more: thousandths of a cycle a mode and sample, nominal, with the
/// flash's waits (`cargo bench -p host-tests --bench run_time_vs_error`).
const MODEL_FREE: u32 = 5_520;
const MODEL_GAIN: u32 = 7_780;
const MODEL_GAIN_AND_PHASE: u32 = 9_490;

/// Room for one form's bank.
struct Room {
    modes: [Mode; MODES],
    groups: [Group; MODES / 4],
}

static ROOM: Owned<Room> = Owned::empty();

/// Each form ringing, and under a force with one gain and with two.
pub(crate) fn check(failures: &mut Failures) {
    let Ok(kit) = Kit::parse(KIT) else {
        return defmt::error!(
            "the self-test's own kit is damaged: flash this image again: {=str}",
            failures.check(false)
        );
    };
    for object in kit.objects() {
        let has_phase = object.gains().iter().any(|gain| gain.cosine.get() != 0.0);
        let (free, driven) = time(&object);
        let model = if has_phase { MODEL_GAIN_AND_PHASE } else { MODEL_GAIN };
        if !has_phase {
            tell(&object, "ringing", free, MODEL_FREE, failures);
        }
        tell(&object, "driven", driven, model, failures);
    }
}

fn tell(object: &Object<'_>, input: &str, measured: u32, model: u32, failures: &mut Failures) {
    let verdict = failures.check(measured <= model / 100 * (100 + TOLERANCE_PERCENT));
    defmt::info!(
        "kernel {=str}, {=str}: {=u32}/1000 cycles a mode and sample, by the model {=u32}: {=str}",
        object.name(),
        input,
        measured,
        model,
        verdict
    );
}

/// Thousandths of a cycle a mode and sample: ringing, and under a force.
fn time(object: &Object<'_>) -> (u32, u32) {
    // SAFETY: main calls this, for one object after the other; no interrupt does.
    let room = unsafe { ROOM.fill(Room { modes: [Mode::SILENT; MODES], groups: [Group::EMPTY; MODES / 4] }) };
    let mut memory = Memory { modes: &mut room.modes, groups: &mut room.groups, origins: &mut [] };
    let table = BankTable {
        modes: object.modes(),
        gains: object.gains(),
        positions: object.position_count(),
        weight: 1.0,
        choke_t60_s: 0.0,
        is_balanced: false,
        typical_contact: (1e-3, 1e-3),
    };
    watchdog::feed();
    let Ok(mut bank) = Bank::load(&table, CLOCKS.sample_rate(), &mut memory, &mut Used::default()) else {
        return (u32::MAX, u32::MAX);
    };
    let force = [FORCE; TICK_FRAMES];
    let driven = ticks(&mut bank, &mut memory, Some(&force));
    let free = ticks(&mut bank, &mut memory, None);
    (free, driven)
}

fn ticks(bank: &mut Bank, memory: &mut Memory<'_>, force: Option<&[i32]>) -> u32 {
    let mut spent = 0;
    for tick in 0..2 * TICKS {
        watchdog::feed();
        bank.tick(memory, None);
        let mut out = [0; TICK_FRAMES];
        let begun = cycles::now();
        bank.render(memory, force, false, true, &mut out);
        if tick >= TICKS {
            spent += u64::from(cycles::now().wrapping_sub(begun));
        }
    }
    (spent * 1000 / (u64::from(TICKS) * TICK_FRAMES as u64 * MODES as u64)) as u32
}
