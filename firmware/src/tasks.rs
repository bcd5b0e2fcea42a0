//! What can wait: the log, the report, the LEDs, the button, the watchdog's food.

use dsp_core::event::{Action, Event};
use dsp_core::table::Kit;
use embassy_stm32::gpio::Output;
use embassy_time::{Duration, Timer};
use heapless::spsc::{Consumer, Producer};

use crate::audio::{CYCLES_PER_HALF, Press};
use crate::board::{Button, LEDS};
use crate::{counters, watchdog};

/// Contacts of a button may bounce for so long.
const BOUNCE: Duration = Duration::from_millis(10);
/// Held for so long, a button chokes its pad.
const HOLD: Duration = Duration::from_millis(300);
/// Velocity of a strike by button.
const BUTTON_VELOCITY: f32 = 0.7;

/// Presses strike the first pad, holding chokes it.
#[embassy_executor::task]
pub async fn button(mut button: Button, mut presses: Producer<'static, Press>) {
    loop {
        match button.pressed_is_high {
            true => button.pin.wait_for_high().await,
            false => button.pin.wait_for_low().await,
        }
        let mut press = |action| {
            if presses.enqueue(Press { pad: 0, action, velocity: BUTTON_VELOCITY }).is_err() {
                counters::REFUSED_EVENTS.add(1);
            }
        };
        press(Action::Strike);
        Timer::after(BOUNCE).await;
        let mut held = BOUNCE;
        let mut choked = false;
        while button.is_pressed() {
            Timer::after(BOUNCE).await;
            held += BOUNCE;
            if held >= HOLD && !choked {
                choked = true;
                press(Action::Choke);
            }
        }
        if choked {
            press(Action::Release);
        }
        Timer::after(BOUNCE).await;
    }
}

/// Tells every event in the form of an events file: behind `event` stand sample, pad, velocity, position, striker and action.
#[embassy_executor::task]
pub async fn log(mut events: Consumer<'static, Event>, kit: Kit<'static>) {
    loop {
        while let Some(event) = events.dequeue() {
            tell(&event, &kit);
        }
        Timer::after_millis(2).await;
    }
}

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
        Action::Shed(groups) => defmt::info!("event {=u64},,,,,shed {=u16}", sample, groups),
    }
}

/// Once a second: how the sound fares.
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
            "second: halves {=u32}, missed {=u32}, worst {=u32} of {=u32} cycles, load {=u32}/1000, strikes {=u32}, sheds {=u32}, stream errors {=u32}, ADC overruns {=u32}, lost ADC frames {=u32}, late events {=u32}, refused {=u32}, unlogged {=u32}",
            halves,
            counters::MISSED_HALVES.get(),
            counters::WORST_HALF_CYCLES.take(),
            CYCLES_PER_HALF,
            (busy / time) as u32,
            counters::STRIKES.get(),
            counters::SHEDS.get(),
            counters::STREAM_ERRORS.get(),
            counters::ADC_OVERRUNS.get(),
            counters::LOST_ADC_FRAMES.get(),
            counters::LATE_EVENTS.get(),
            counters::REFUSED_EVENTS.get(),
            counters::UNLOGGED_EVENTS.get(),
        );
    }
}

/// Feeds the watchdog while halves are filled and none has been missed since it was last fed.
#[embassy_executor::task]
pub async fn feed() {
    let (mut halves_before, mut missed_before) = (counters::HALVES.get(), counters::MISSED_HALVES.get());
    loop {
        Timer::after_millis(20).await;
        let (halves, missed) = (counters::HALVES.get(), counters::MISSED_HALVES.get());
        if halves != halves_before && missed == missed_before {
            watchdog::feed();
        }
        (halves_before, missed_before) = (halves, missed);
    }
}

/// Shows the level: each LED stands for 12 dB below full scale.
#[embassy_executor::task]
pub async fn meter(mut leds: [Output<'static>; LEDS], light_high: bool) {
    loop {
        let peak = counters::PEAK.take();
        // 2^23 is full scale; 12 dB are two bits.
        let bits = 32 - peak.leading_zeros();
        for (index, led) in (0u32..).zip(leds.iter_mut()) {
            let lit = bits + 2 * (LEDS as u32 - index) > 23;
            led.set_level((lit == light_high).into());
        }
        Timer::after_millis(20).await;
    }
}
