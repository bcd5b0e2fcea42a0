//! The application: pads.

#![no_std]
#![no_main]

use defmt_rtt as _;
use dsp_core::table::Kit;
use embassy_executor::{SpawnError, SpawnToken, Spawner};
use firmware::audio::instrument::Instrument;
use firmware::restart::Cause;
use firmware::{audio, board, cycles, kits, tasks, watchdog};

/// Of a half, what the engine may use; the rest is for what surrounds it.
const ENGINE_SHARE_PERCENT: u32 = 75;

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    watchdog::start();
    let board = board::start();
    if let Some(mut core) = cortex_m::Peripherals::take() {
        cycles::start(&mut core);
    }
    defmt::info!("malleus on {=str}, started by {}", board::NAME, Cause::take());
    if let Err(error) = board.codec {
        defmt::error!("codec: {}", error);
    }
    watchdog::feed();
    // SAFETY: main runs once.
    let instrument = unsafe { Instrument::place() };
    let budget = audio::CYCLES_PER_HALF / 100 * ENGINE_SHARE_PERCENT;
    let Some(kit) = choose_kit(instrument, budget) else {
        defmt::error!("no kit plays");
        return;
    };
    watchdog::feed();
    // SAFETY: main runs once.
    let ends = unsafe { audio::start(board.i2s, instrument) };
    spawn(&spawner, tasks::feed());
    spawn(&spawner, tasks::button(board.button, ends.presses));
    spawn(&spawner, tasks::log(ends.log, kit));
    spawn(&spawner, tasks::report());
    spawn(&spawner, tasks::meter(board.leds, board.leds_light_high));
}

/// A task of which there is one cannot be refused; should it be, the watchdog notices that nobody feeds it.
fn spawn<T>(spawner: &Spawner, task: Result<SpawnToken<T>, SpawnError>) {
    match task {
        Ok(task) => spawner.spawn(task),
        Err(_) => defmt::error!("a task could not start"),
    }
}

fn choose_kit(instrument: &mut Instrument, budget: u32) -> Option<Kit<'static>> {
    match kits::in_sector() {
        Ok(None) => defmt::info!("kit sector is empty: the built-in kit plays"),
        Err(error) => defmt::error!("kit in flash: {}; the built-in kit plays", defmt::Display2Format(&error)),
        Ok(Some(kit)) => match instrument.load(kit, budget) {
            Ok(()) => {
                defmt::info!("kit in flash plays: {=str}", kit.name());
                return Some(kit);
            }
            Err(error) => defmt::error!("kit in flash: {}; the built-in kit plays", defmt::Display2Format(&error)),
        },
    }
    let kit = Kit::parse(kits::BUILT_IN).ok()?;
    instrument.load(kit, budget).ok()?;
    Some(kit)
}
