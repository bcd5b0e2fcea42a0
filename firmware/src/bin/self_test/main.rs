//! Self-test of a board: all that can be checked without ears, as one table in the log.
//!
//! ```text
//! cargo run --release --bin self-test
//! ```
//!
//! The last line says `self-test: passed`, or how many checks failed. Each line above it says what
//! one check found, and what is right.

#![no_std]
#![no_main]

mod clocks;
mod failures;
mod kernels;
mod memory;
mod piezos;

use dsp_core::table::Kit;
use embassy_executor::Spawner;
use embassy_time::Timer;
use firmware::audio::BUDGET_CYCLES;
use firmware::audio::instrument::Instrument;
use firmware::input::piezo::Piezos;
use firmware::input::{Overrides, Settings};
use firmware::refusal::Refusal;
use firmware::restart::{self, Cause};
use firmware::{board, cycles, hardware, kits, watchdog};

use crate::failures::Failures;

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    watchdog::start();
    let mut devices = hardware::init(hardware::start_clocks());
    if let Some(mut core) = cortex_m::Peripherals::take() {
        restart::watch_faults(&mut core);
        cycles::start(&mut core);
    }
    let mut failures = Failures::default();
    defmt::info!("self-test on {=str}, started by {}", board::NAME, Cause::take());
    match &devices.codec {
        Ok(_) => defmt::info!("codec: {=str}", failures.check(true)),
        Err(error) => defmt::error!("codec: {}: {=str}", error, failures.check(false)),
    }
    // This check comes first, because it writes to memory that later checks use.
    memory::check(&mut failures);
    check_kits(&mut failures);
    kernels::check(&mut failures);
    clocks::check(&mut devices.i2s, &mut failures);
    piezos::check(&mut Piezos::new(devices.piezos), &mut failures);
    match failures.count() {
        0 => defmt::info!("self-test: passed"),
        count => defmt::error!("self-test: {=u32} checks failed", count),
    }
    loop {
        watchdog::feed();
        Timer::after_millis(50).await;
    }
}

/// Checks that the built-in kit and the kits of the slots load.
fn check_kits(failures: &mut Failures) {
    // SAFETY: main runs once.
    let instrument = unsafe { Instrument::place() };
    let mut load = |kit: &Kit<'static>| -> Result<(), Refusal> {
        Settings::check(kit, &Overrides::default())?;
        instrument.load(kit, BUDGET_CYCLES, |error| defmt::warn!("kit, left out: {}", Refusal::Load(error)))?;
        Ok(())
    };
    match Kit::parse(kits::BUILT_IN).map_err(Refusal::from).and_then(|kit| load(&kit)) {
        Ok(()) => defmt::info!("built-in kit, {=usize} bytes: {=str}", kits::BUILT_IN.len(), failures.check(true)),
        Err(refusal) => defmt::error!("built-in kit: {}: {=str}", refusal, failures.check(false)),
    }
    watchdog::feed();
    for (slot, sector) in board::KIT_SECTORS.iter().enumerate().take(board::SLOTS.into()) {
        match kits::read(sector.read()) {
            Ok(None) => defmt::info!("slot {=usize}: empty", slot),
            Ok(Some(kit)) => match load(&kit) {
                Ok(()) => defmt::info!("slot {=usize}: {=str}: {=str}", slot, kit.name(), failures.check(true)),
                Err(refusal) => defmt::error!("slot {=usize}: {}: {=str}", slot, refusal, failures.check(false)),
            },
            Err(error) => defmt::error!("slot {=usize}: {}: {=str}", slot, Refusal::from(error), failures.check(false)),
        }
        watchdog::feed();
    }
}
