//! Tasks that can wait for the sound: log, report, level meter, answers to SysEx.

use dsp_core::event::{Action, Event};
use dsp_core::midi::Packet;
use dsp_core::table::Kit;
use embassy_stm32::gpio::Output;
use embassy_time::{Instant, Timer};

use crate::audio::{CYCLES_PER_HALF, Line, Log};
use crate::board::{LEDS, MIDI_NUMBER};
use crate::counters;
use crate::faults::{self, Fault};
use crate::usb::{Replies, Sysex};

/// Time between two looks for lines of the log, in ms.
const LOG_EVERY_MS: u64 = 8;
/// Time between two updates of the level meter, in ms.
const METER_EVERY_MS: u64 = 20;
/// Time for which a passing fault is shown, in s.
const SHOW_S: u64 = 5;

/// Logs the lines of the audio interrupt.
///
/// An event is logged as `event ` and a line of an events file: sample, pad, velocity, position,
/// striker and action.
#[embassy_executor::task]
pub async fn log(mut lines: Log, kit: Kit<'static>) {
    let (mut sound_until, mut adc_until) = (Instant::MIN, Instant::MIN);
    // Bit n is set while piezo n fails.
    let mut failing_piezos = 0u32;
    loop {
        while let Some(line) = lines.take() {
            let shown_until = Instant::now() + embassy_time::Duration::from_secs(SHOW_S);
            match line {
                Line::Event(event) => tell(&event, &kit),
                Line::PiezoFault { channel, fault } => {
                    failing_piezos |= 1 << (channel % 32);
                    defmt::error!("piezo {=u8}: {}", channel, defmt::Display2Format(&fault));
                }
                Line::PiezoRecovered { channel } => {
                    failing_piezos &= !(1 << (channel % 32));
                    defmt::info!("piezo {=u8}: well again", channel);
                }
                Line::Missed { halves } => {
                    sound_until = shown_until;
                    defmt::warn!("audio: {=u32} halves missed", halves);
                }
                Line::StreamRestarted => {
                    sound_until = shown_until;
                    defmt::error!("I2S: DMA transfer error, stream started anew");
                }
                Line::AdcRestarted => {
                    adc_until = shown_until;
                    defmt::error!("ADC: overrun or DMA error, sampling started anew");
                }
            }
        }
        let now = Instant::now();
        faults::set(Fault::Piezo, failing_piezos != 0);
        faults::set(Fault::Sound, now < sound_until);
        faults::set(Fault::Adc, now < adc_until);
        Timer::after_millis(LOG_EVERY_MS).await;
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

/// Answers the identity request of MIDI (universal SysEx 06 01). Other SysEx is left unanswered.
#[embassy_executor::task]
pub async fn sysex(mut sysex: Sysex, mut replies: Replies) {
    const REQUEST: [u8; 6] = [0xF0, 0x7E, 0x7F, 0x06, 0x01, 0xF7];
    let mut matched = 0;
    loop {
        let packet = sysex.next().await;
        for &byte in Packet(packet).bytes() {
            // The request goes to all devices, or to one by its number.
            let is_next = REQUEST.get(matched).is_some_and(|&next| byte == next || matched == 2 && byte < 0x80);
            matched = if is_next { matched + 1 } else { usize::from(byte == REQUEST[0]) };
            if matched == REQUEST.len() {
                matched = 0;
                for packet in IDENTITY {
                    replies.push(packet).await;
                }
            }
        }
    }
}

/// Identity reply in packets: manufacturer 7D (not for sale), family 1, number of the board,
/// version of the firmware.
const IDENTITY: [[u8; 4]; 5] = [
    [0x04, 0xF0, 0x7E, 0x7F],
    [0x04, 0x06, 0x02, 0x7D],
    [0x04, 1, 0, MIDI_NUMBER],
    [0x04, 0, VERSION[0], VERSION[1]],
    [0x07, VERSION[2], 0, 0xF7],
];

/// Version of the firmware, a number of 7 bits each.
const VERSION: [u8; 3] = {
    let text = env!("CARGO_PKG_VERSION").as_bytes();
    let (mut version, mut part, mut at) = ([0; 3], 0, 0);
    while at < text.len() && part < 3 {
        match text[at] {
            digit @ b'0'..=b'9' => version[part] = version[part] * 10 + (digit - b'0'),
            _ => part += 1,
        }
        at += 1;
    }
    version
};

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
