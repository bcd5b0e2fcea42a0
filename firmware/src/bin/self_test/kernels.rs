//! Cycles of every kernel of the modal bank by the core's counter, beside those of the cycle model.

use dsp_core::memory::{Memory, Word};
use dsp_core::resonator::{Bank, BankTable, TICK_FRAMES};
use dsp_core::table::{Kit, Object};
use firmware::board::CLOCKS;
use firmware::owned::Owned;
use firmware::{cycles, watchdog};

use crate::failures::Failures;

/// Kit of one object for each form of the bank and each number of gains, made by the build script.
const KIT: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/self-test-kit.bin"));

/// Number of modes of each object.
const MODES: usize = 240;
/// Number of ticks that are timed. The same number before them warms the flash accelerator up.
const TICKS: u32 = 32;
/// Steady force that drives the bank, in bus steps: -60 dB.
const FORCE: i32 = 1 << 17;
/// Largest excess of the measured cycles over the model's, in percent.
const TOLERANCE_PERCENT: u32 = 15;

/// Cycles of a ringing bank by the cycle model, in thousandths per mode and sample.
///
/// The three models are nominal, with the waits of flash (`cargo bench -p host-tests --bench
/// run_time_vs_error`). The mirrored form costs up to 0.16 cycles more.
const MODEL_FREE: u32 = 5_520;
/// Cycles of a driven bank with one gain by the cycle model, in thousandths per mode and sample.
const MODEL_GAIN: u32 = 7_780;
/// Cycles of a driven bank with two gains by the cycle model, in thousandths per mode and sample.
const MODEL_GAIN_AND_PHASE: u32 = 9_490;

/// Words of the bank of one object: its modes and a quarter as many groups, 24 bytes each.
const WORDS: usize = MODES * 3 + MODES / 4 * 3;

static WORDS_OF_BANK: Owned<[Word; WORDS]> = Owned::empty();

/// Checks the cycles of each form, ringing, and under a force with one gain and with two.
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

/// Checks and logs one measurement.
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

/// Returns the cycles of an object's bank, ringing and under a force, in thousandths per mode and
/// sample.
fn time(object: &Object<'_>) -> (u32, u32) {
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
    // SAFETY: main calls this for one object after the other, whose bank is gone before the next,
    // and no interrupt does.
    let words = unsafe { WORDS_OF_BANK.lend() };
    let mut memory = Memory::new(words, &mut []);
    let rate = CLOCKS.sample_rate();
    let bank = Bank::size(&table, rate).ok().and_then(|size| Bank::take(&mut memory, size).ok());
    let Some(mut bank) = bank else { return (u32::MAX, u32::MAX) };
    if bank.load(&table, rate).is_err() {
        return (u32::MAX, u32::MAX);
    }
    let force = [FORCE; TICK_FRAMES];
    let driven = ticks(&mut bank, Some(&force));
    let free = ticks(&mut bank, None);
    (free, driven)
}

/// Returns the cycles of a bank, driven by `force` or ringing, in thousandths per mode and sample.
fn ticks(bank: &mut Bank<'_>, force: Option<&[i32]>) -> u32 {
    let mut spent = 0;
    for tick in 0..2 * TICKS {
        watchdog::feed();
        bank.tick(None);
        let mut out = [0; TICK_FRAMES];
        let begun = cycles::now();
        bank.render(force, false, true, &mut out);
        if tick >= TICKS {
            spent += u64::from(cycles::now().wrapping_sub(begun));
        }
    }
    (spent * 1000 / (u64::from(TICKS) * TICK_FRAMES as u64 * MODES as u64)) as u32
}
