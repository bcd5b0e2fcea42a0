//! Tasks that can wait for the sound: log, report, level meter.

use embassy_stm32::gpio::Output;
use embassy_time::Timer;

use crate::audio::{CYCLES_PER_HALF, take_program};
use crate::board::LEDS;
use crate::{counters, faults, journal, sysex};

/// Time between two looks for lines of the log, in ms.
const LOG_EVERY_MS: u64 = 8;
/// Time between two updates of the level meter, in ms.
const METER_EVERY_MS: u64 = 20;

/// Logs the lines of the audio interrupt, and carries the programs that it was asked for to the
/// task that changes kits.
///
/// An event is logged as `event ` and a line of an events file: sample, pad, velocity, position,
/// striker and action.
#[embassy_executor::task]
pub async fn log() {
    loop {
        journal::pass_on(None);
        if let Some(slot) = take_program() {
            sysex::change_kit(slot);
        }
        Timer::after_millis(LOG_EVERY_MS).await;
    }
}

/// Logs the counters once a second.
#[embassy_executor::task]
pub async fn report() {
    let mut halves_before = 0;
    loop {
        Timer::after_secs(1).await;
        let halves = counters::HALVES.get();
        let busy = u64::from(counters::AUDIO_CYCLES.take()) * 1000;
        let time = u64::from(CYCLES_PER_HALF) * u64::from(halves.wrapping_sub(halves_before)).max(1);
        halves_before = halves;
        defmt::info!(
            "second: halves {=u32}, missed {=u32}, worst {=u32} of {=u32} cycles, load {=u32}/1000, strikes {=u32}, put off {=u32}, sheds {=u32}, refused stages {=u32}",
            halves,
            counters::MISSED_HALVES.get(),
            counters::WORST_HALF_CYCLES.take(),
            CYCLES_PER_HALF,
            (busy / time) as u32,
            counters::STRIKES.get(),
            counters::DELAYED_STRIKES.get(),
            counters::SHEDS.get(),
            counters::REFUSED_STAGES.get(),
        );
        defmt::info!(
            "faults: stream restarts {=u32}, ADC restarts {=u32}, lost ADC frames {=u32}, late events {=u32}, refused events {=u32}, unlogged lines {=u32}",
            counters::STREAM_ERRORS.get(),
            counters::ADC_RESTARTS.get(),
            counters::LOST_ADC_FRAMES.get(),
            counters::LATE_EVENTS.get(),
            counters::REFUSED_EVENTS.get(),
            counters::UNLOGGED_LINES.get(),
        );
        defmt::info!(
            "USB: transfers {=u32}, messages {=u32}, unknown {=u32}, lost {=u32}, unsent {=u32}",
            counters::USB_TRANSFERS.get(),
            counters::MIDI_MESSAGES.get(),
            counters::MIDI_UNKNOWN.get(),
            counters::USB_LOST.get(),
            counters::USB_UNSENT.get(),
        );
    }
}

/// Shows the level on the LEDs, 12 dB each. If a fault is present the last LED flashes its number.
#[embassy_executor::task]
pub async fn meter(mut leds: [Output<'static>; LEDS], light_high: bool) {
    let mut step = 0;
    loop {
        // Full scale is 2^23, and 12 dB are two bits.
        let bits = u32::BITS - counters::PEAK.take().leading_zeros();
        let flashes = faults::flashes();
        step = if flashes == 0 { 0 } else { (step + 1) % ((flashes + PAUSE_FLASHES) * FLASH_STEPS) };
        for (index, led) in (1u32..).zip(leds.iter_mut()) {
            let is_lit = match flashes > 0 && index == LEDS as u32 {
                true => step / FLASH_STEPS < flashes && step % FLASH_STEPS < FLASH_STEPS / 2,
                false => bits + 2 * (LEDS as u32 - index) >= 22,
            };
            led.set_level((is_lit == light_high).into());
        }
        Timer::after_millis(METER_EVERY_MS).await;
    }
}

/// Number of updates of the meter from one flash to the next, 400 ms.
const FLASH_STEPS: u32 = 20;
/// Pause after a number, in flashes.
const PAUSE_FLASHES: u32 = 3;
