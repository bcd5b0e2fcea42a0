//! Application of the board: pads that play a kit.

#![no_std]
#![no_main]

use dsp_core::table::range::DEFAULT_HEADPHONE_DB;
use embassy_executor::{SpawnError, SpawnToken, Spawner};
use embassy_stm32::Peripherals;
use firmware::audio::instrument::Instrument;
use firmware::audio::midi::Midi;
use firmware::faults::{self, Fault};
use firmware::input::Inputs;
use firmware::input::piezo::Piezos;
use firmware::restart::{self, Cause};
use firmware::storage::{Started, Storage};
use firmware::{audio, board, cycles, dfu, hardware, journal, last_words, sysex, tasks, usb, volume, watchdog};

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    dfu::go_if_asked();
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
    let (instrument, mut storage) = unsafe { (Instrument::place(), Storage::open()) };
    let Some(started) = storage.load_first(instrument) else {
        // The watchdog is not fed any more, so the board restarts.
        return defmt::error!("the built-in kit does not play: flash this image again");
    };
    play(&spawner, peripherals, instrument, storage, started);
}

/// Starts sound, inputs, USB and the tasks.
// Not inlined: its stack must not add to that of loading a kit.
#[inline(never)]
fn play(
    spawner: &Spawner,
    peripherals: Peripherals,
    instrument: &'static mut Instrument,
    storage: Storage,
    Started { kit, overrides, channel }: Started,
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
    let inputs = unsafe { Inputs::place(Piezos::new(devices.piezos), devices.button, &kit, &overrides) };
    // The settings have been checked with the kit.
    let Ok(inputs) = inputs else { return };
    if let Some(usb) = usb::start(devices.usb) {
        let midi = Midi::new((usb.incoming, usb.outgoing), kit, channel);
        if let Some(log) = audio::start(devices.i2s, inputs, instrument, midi) {
            journal::begin(log, kit);
            spawn(spawner, tasks::log());
        }
        spawn(spawner, sysex::serve(usb.sysex, usb.replies, storage));
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
