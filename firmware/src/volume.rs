//! Volume of the headphones: the kit sets it, and holding the button changes it.
//!
//! ```text
//! press            0.6 s     0.9 s     1.2 s     release
//!   | strikes, as ever |-3 dB    |-3 dB    |-3 dB    |     the next hold: +3 dB each
//! ```
//!
//! A hold goes the other way than the one before it and stops at the ends of the range, so that no
//! step is louder by more than 3 dB.

use core::sync::atomic::{AtomicI32, AtomicU32, Ordering};

use dsp_core::event::{Action, Event, Time};
use embassy_time::Timer;

use crate::board;
use crate::codec::{Codec, START_VOLUME};
use crate::faults::{self, Fault};
use crate::input::button;

/// Time between two looks at the button, in ms.
const LOOK_MS: u64 = 20;
/// Looks for which the button is held before the first step: 0.6 s.
const FIRST_STEP: u32 = 31;
/// Looks from one step to the next: 0.3 s.
const STEP_EVERY: u32 = 15;
/// Change of the volume by a step, in half decibels.
const STEP: i32 = 6;
/// Lowest volume of the button, in half decibels.
const LOWEST: i32 = -120;
/// Gain of a step down: 10^(-3/20).
const STEP_GAIN: f32 = 0.707_945_8;
/// Value that stands for no number.
const NONE: i32 = i32::MIN;

/// Volume in half decibels that a kit has asked for, or [`NONE`].
static OF_KIT: AtomicI32 = AtomicI32::new(NONE);
/// Bits of the level that the engine is to take, or those of a NaN.
static LEVEL: AtomicU32 = AtomicU32::new(u32::MAX);

/// Lets the headphones play at the volume of a kit, in dB. A board whose converter has no volume
/// stays at its full level.
pub fn set_db(headphone_db: f32) {
    OF_KIT.store((2.0 * headphone_db) as i32, Ordering::Relaxed);
}

/// Returns the event that brings the engine to the level of the button, if the level has changed.
/// `now` is the frame that is rendered next.
pub(crate) fn take_event(now: u64) -> Option<Event> {
    let level = f32::from_bits(LEVEL.load(Ordering::Relaxed));
    if level.is_nan() {
        return None;
    }
    LEVEL.store(u32::MAX, Ordering::Relaxed);
    Some(Event { time: Time::at_frame(now), velocity: level, action: Action::Level, ..Event::NOTHING })
}

/// Follows kits and the button. Without a codec the engine's level is turned.
#[embassy_executor::task]
pub async fn follow(codec: Option<Codec>) {
    // Where the board has none, its code is left out.
    let mut codec = codec.filter(|_| board::HAS_CODEC);
    let mut volume = codec.as_ref().map_or(0, |_| START_VOLUME);
    let (mut is_rising, mut looks) = (true, 0u32);
    loop {
        let before = volume;
        let of_kit = OF_KIT.swap(NONE, Ordering::Relaxed);
        if of_kit != NONE && codec.is_some() {
            volume = of_kit;
        }
        looks = if button::is_down() { looks + 1 } else { 0 };
        if let Some(held) = looks.checked_sub(FIRST_STEP).filter(|held| held % STEP_EVERY == 0) {
            is_rising ^= held == 0;
            volume = (volume + if is_rising { STEP } else { -STEP }).clamp(LOWEST, 0);
        }
        if volume != before {
            set(&mut codec, volume);
        }
        Timer::after_millis(LOOK_MS).await;
    }
}

/// Sets the volume in half decibels.
fn set(codec: &mut Option<Codec>, volume: i32) {
    defmt::info!("volume: {=f32} dB", 0.5 * volume as f32);
    match codec {
        Some(codec) => {
            if let Err(error) = codec.set_volume(volume) {
                faults::set(Fault::Codec, true);
                defmt::error!("codec: {}", error);
            }
        }
        None => {
            let level = (0..-volume / STEP).fold(1.0, |level, _| level * STEP_GAIN);
            LEVEL.store(f32::to_bits(level), Ordering::Relaxed);
        }
    }
}
