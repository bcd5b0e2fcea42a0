//! Memory for the engines and stages of the tests, lent until the process ends.

use dsp_core::SampleRate;
use dsp_core::engine::{Engine, LoadError, Plan, Setup, Skipping};
use dsp_core::memory::{Memory, Word, Words};
use dsp_core::room::Sample;
use dsp_core::table::Kit;

/// Maximum number of samples in the delay lines of the room of [`engine`], on PC and chip
/// (`host-tests/images/engine`).
pub const ROOM_SAMPLES: usize = 4_096;

/// Limit to the cycles of pads in frames of [`engine`], on PC and chip: 80 % of 168 MHz at 48 kHz.
pub const FRAME_CYCLES: u32 = 2_800;

/// Memory of a given number of words.
pub fn memory(words: Words) -> Memory<'static> {
    let lend = |words: usize| Box::leak(vec![Word::uninit(); words].into_boxed_slice());
    Memory::new(lend(words.fast), lend(words.bulk))
}

/// Engine of a kit as the chip image builds it: 16-bit delay lines of [`ROOM_SAMPLES`] samples,
/// frames within [`FRAME_CYCLES`].
///
/// # Errors
/// [`LoadError`].
pub fn engine<'k>(kit: &Kit<'k>, rate: SampleRate, skipping: Skipping) -> Result<Engine<'k, 'k>, LoadError> {
    let setup = Setup { skipping, room_samples: ROOM_SAMPLES, frame_cycles: Some(FRAME_CYCLES), ..Setup::new(rate) };
    engine_of(kit, setup)
}

/// Engine of a kit for a setup and a type of room samples, in exactly the memory of its plan.
///
/// # Errors
/// [`LoadError`].
pub fn engine_of<'k, S: Sample>(kit: &Kit<'k>, setup: Setup) -> Result<Engine<'k, 'k, S>, LoadError> {
    Engine::new(kit, setup, memory(Plan::of::<S>(kit, setup)?.words))
}

/// Takes a stage from exactly the memory that it needs. `$take` is an expression that takes it from
/// a `Memory` named `$lender`.
#[macro_export]
macro_rules! lent {
    ($lender:ident => $take:expr) => {{
        let mut account = dsp_core::memory::Memory::count(dsp_core::memory::Words::MAX);
        {
            let $lender = &mut account;
            // An account only counts, so the stage taken from it has no memory and is dropped.
            let _ = $take.expect("an account has room for everything");
        }
        let mut memory = $crate::lent::memory(account.used());
        let $lender = &mut memory;
        $take.expect("the account has counted it")
    }};
}
