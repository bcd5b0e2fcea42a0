//! Tasks that can wait for the sound: log, report, level meter.

use core::cell::RefCell;

use dsp_core::event::{Action, Event};
use dsp_core::table::Kit;
use embassy_stm32::gpio::Output;
use embassy_sync::blocking_mutex::ThreadModeMutex;
use embassy_time::{Instant, Timer};

use crate::audio::{CYCLES_PER_HALF, Line, Log, take_program};
use crate::board::LEDS;
use crate::faults::{self, Fault};
use crate::{counters, sysex};

/// Time between two looks for lines of the log, in ms.
const LOG_EVERY_MS: u64 = 8;
/// Time between two updates of the level meter, in ms.
const METER_EVERY_MS: u64 = 20;
/// Time for which a passing fault is shown, in s.
const SHOW_S: u64 = 5;

/// Log of the audio interrupt, with what its lines say of faults.
struct Journal {
    lines: Log,
    /// Kit whose pads the lines name.
    kit: Kit<'static>,
    sound_until: Instant,
    adc_until: Instant,
    /// Bit n is set while piezo n fails.
    failing_piezos: u32,
}

static JOURNAL: ThreadModeMutex<RefCell<Option<Journal>>> = ThreadModeMutex::new(RefCell::new(None));

/// Begins the log with the kit that plays.
pub fn begin_log(lines: Log, kit: Kit<'static>) {
    let journal = Journal { lines, kit, sound_until: Instant::MIN, adc_until: Instant::MIN, failing_piezos: 0 };
    JOURNAL.lock(|place| *place.borrow_mut() = Some(journal));
}

/// Logs the lines of the audio interrupt that wait. Later lines name the pads of `next`, if there is
/// one.
pub fn pass_on_log(next: Option<Kit<'static>>) {
    JOURNAL.lock(|journal| {
        let Ok(mut journal) = journal.try_borrow_mut() else { return };
        if let Some(journal) = journal.as_mut() {
            journal.pass_on();
            journal.kit = next.unwrap_or(journal.kit);
        }
    });
}

/// Logs the lines of the audio interrupt, and carries the programs that it was asked for to the
/// task that changes kits.
///
/// An event is logged as `event ` and a line of an events file: sample, pad, velocity, position,
/// striker and action.
#[embassy_executor::task]
pub async fn log() {
    loop {
        pass_on_log(None);
        if let Some(slot) = take_program() {
            sysex::change_kit(slot);
        }
        Timer::after_millis(LOG_EVERY_MS).await;
    }
}

impl Journal {
    fn pass_on(&mut self) {
        while let Some(line) = self.lines.take() {
            let shown_until = Instant::now() + embassy_time::Duration::from_secs(SHOW_S);
            match line {
                Line::Event(event) => tell(&event, &self.kit),
                Line::PiezoFault { channel, fault } => {
                    self.failing_piezos |= 1 << (channel % 32);
                    defmt::error!("piezo {=u8}: {}", channel, defmt::Display2Format(&fault));
                }
                Line::PiezoRecovered { channel } => {
                    self.failing_piezos &= !(1 << (channel % 32));
                    defmt::info!("piezo {=u8}: well again", channel);
                }
                Line::Missed { halves } => {
                    self.sound_until = shown_until;
                    defmt::warn!("audio: {=u32} halves missed", halves);
                }
                Line::StreamRestarted => {
                    self.sound_until = shown_until;
                    defmt::error!("I2S: DMA transfer error, stream started anew");
                }
                Line::AdcRestarted => {
                    self.adc_until = shown_until;
                    defmt::error!("ADC: overrun or DMA error, sampling started anew");
                }
            }
        }
        let now = Instant::now();
        faults::set(Fault::Piezo, self.failing_piezos != 0);
        faults::set(Fault::Sound, now < self.sound_until);
        faults::set(Fault::Adc, now < self.adc_until);
    }
}

/// Logs an event as a line of an events file.
fn tell(event: &Event, kit: &Kit<'static>) {
    let sample = event.time.first_frame();
    let pad = kit.pads().nth(usize::from(event.pad));
    let name = pad.map_or("", |pad| pad.name());
    match event.action {
        Action::Strike => {
            let striker = pad.and_then(|pad| kit.strikers_of(pad).nth(usize::from(event.striker)));
            let striker = striker.map_or("", |striker| striker.name());
            defmt::info!(
                "event {=u64},{=str},{=f32},{=f32},{=str},strike",
                sample,
                name,
                event.velocity,
                event.position,
                striker
            );
        }
        Action::Choke => defmt::info!("event {=u64},{=str},,,,choke", sample, name),
        Action::Release => defmt::info!("event {=u64},{=str},,,,release", sample, name),
        Action::Level => defmt::info!("event {=u64},,{=f32},,,level", sample, event.velocity),
        Action::Silence => defmt::info!("event {=u64},,,,,silence", sample),
        Action::Shed(groups) => defmt::info!("event {=u64},,,,,shed {=u16}", sample, groups),
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
