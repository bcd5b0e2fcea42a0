//! Application of the board: pads that play a kit.

#![no_std]
#![no_main]

use dsp_core::table::Kit;
use dsp_core::table::range::DEFAULT_HEADPHONE_DB;
use embassy_executor::{SpawnError, SpawnToken, Spawner};
use embassy_stm32::Peripherals;
use firmware::audio::instrument::Instrument;
use firmware::audio::midi::Midi;
use firmware::faults::{self, Fault};
use firmware::input::piezo::Piezos;
use firmware::input::{self, Inputs};
use firmware::refusal::Refusal;
use firmware::restart::{self, Cause};
use firmware::{audio, board, cycles, hardware, kits, last_words, tasks, usb, volume, watchdog};

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    watchdog::start();
    let peripherals = hardware::start_clocks();
    if let Some(mut core) = cortex_m::Peripherals::take() {
        restart::watch_faults(&mut core);
        cycles::start(&mut core);
    }
    let (version, revision) = (env!("CARGO_PKG_VERSION"), env!("GIT_REVISION"));
    defmt::info!("malleus {=str} ({=str}) on {=str}, started by {}", version, revision, board::NAME, Cause::take());
    last_words::take(|words| defmt::error!("last time: {=str}", words));
    watchdog::feed();
    // The kit is loaded before the stream runs, so that no interrupt slows it down.
    // SAFETY: main runs once.
    let instrument = unsafe { Instrument::place() };
    let Some((kit, settings)) = choose_kit(instrument) else {
        // The watchdog is not fed any more, so the board restarts.
        return defmt::error!("the built-in kit does not play: flash this image again");
    };
    play(&spawner, peripherals, instrument, kit, settings);
}

/// Starts sound, inputs, USB and the tasks.
// Not inlined: its stack must not add to that of loading a kit.
#[inline(never)]
fn play(
    spawner: &Spawner,
    peripherals: Peripherals,
    instrument: &'static mut Instrument,
    kit: Kit<'static>,
    settings: input::Settings,
) {
    watchdog::expect_sound();
    let devices = hardware::init(peripherals);
    let codec = devices.codec.unwrap_or_else(|error| {
        faults::set(Fault::Codec, true);
        defmt::error!("codec: {}", error);
        None
    });
    volume::set_db(kit.headphone_db().unwrap_or(DEFAULT_HEADPHONE_DB));
    watchdog::feed();
    // SAFETY: main runs once.
    let inputs = unsafe { Inputs::place(Piezos::new(devices.piezos), devices.button, settings) };
    if let Some(usb) = usb::start(devices.usb) {
        spawn(spawner, tasks::sysex(usb.sysex, usb.replies));
        let midi = Midi::new((usb.incoming, usb.outgoing), kit);
        if let Some(log) = audio::start(devices.i2s, inputs, instrument, midi) {
            spawn(spawner, tasks::log(log, kit));
        }
    }
    spawn(spawner, volume::follow(codec));
    spawn(spawner, tasks::report());
    spawn(spawner, tasks::meter(devices.leds, devices.leds_light_high));
}

/// Spawns a task. A task that is spawned once cannot be refused; if one were, the error is logged.
fn spawn<T>(spawner: &Spawner, task: Result<SpawnToken<T>, SpawnError>) {
    match task {
        Ok(task) => spawner.spawn(task),
        Err(_) => defmt::error!("a task could not start"),
    }
}

/// Loads the kit of the kit sector if it is good, else the built-in one.
///
/// Returns `None` if neither plays.
fn choose_kit(instrument: &mut Instrument) -> Option<(Kit<'static>, input::Settings)> {
    match kit_in_sector(instrument) {
        Ok(Some(chosen)) => return Some(chosen),
        Ok(None) => defmt::info!("kit sector: empty, the built-in kit plays"),
        Err(refusal) => {
            faults::set(Fault::Kit, true);
            defmt::error!("kit sector: {}; the built-in kit plays", refusal);
        }
    }
    let kit = Kit::parse(kits::BUILT_IN).ok()?;
    instrument.load(&kit, audio::BUDGET_CYCLES, |_| {}).ok()?;
    Some((kit, input::Settings::of(&kit).ok()?))
}

/// Loads the kit of the kit sector, or returns `None` if the sector is erased.
fn kit_in_sector(instrument: &mut Instrument) -> Result<Option<(Kit<'static>, input::Settings)>, Refusal> {
    let Some(kit) = kits::in_sector()? else { return Ok(None) };
    let settings = input::Settings::of(&kit)?;
    let tell = |error| {
        defmt::warn!("kit sector, left out: {}", Refusal::Load(error));
        // A large kit of which much is left out takes long to load.
        watchdog::feed();
    };
    instrument.load(&kit, audio::BUDGET_CYCLES, tell)?;
    defmt::info!("kit sector: {=str} plays", kit.name());
    Ok(Some((kit, settings)))
}
