//! Buttons: strikes of one velocity, and chokes that last while the button is held.

use super::error::TriggerError;
use super::report::Detection;
use super::settings::Settings;
use crate::SampleRate;
use crate::event::Action;
use crate::table::Kit;

/// Time after an edge in which a button is not listened to, in seconds.
const DEBOUNCE_S: f64 = 0.01;

/// Edge of a button's level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// The button went down.
    Pressed,
    /// The button came up.
    Released,
}

/// Debounced button: its first contact counts at once, and its level in the 10 ms after that does
/// not count.
///
/// A bad button bounces for half that time.
///
/// ```
/// use dsp_core::{SampleRate, trigger::{Button, Edge}};
/// let mut button = Button::new(SampleRate::HZ_48000);
/// assert_eq!(button.sample(1000, true), Some(Edge::Pressed));
/// assert_eq!(button.sample(1100, false), None); // bounces
/// assert_eq!(button.sample(1200, true), None);
/// assert_eq!(button.sample(9000, false), Some(Edge::Released));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Button {
    is_down: bool,
    deaf_frames: u64,
    deaf_until: u64,
}

impl Button {
    /// Makes a button that is up, with times in frames of `rate`.
    pub fn new(rate: SampleRate) -> Self {
        Self { is_down: false, deaf_frames: (DEBOUNCE_S * rate.hz()) as u64, deaf_until: 0 }
    }

    /// Takes the button's level at a frame no earlier than the last one, and gives the edge if the
    /// level counts.
    ///
    /// Call it on every edge and once a block, so that the block makes up for an edge that was
    /// ignored.
    pub fn sample(&mut self, frame: u64, is_down: bool) -> Option<Edge> {
        if frame < self.deaf_until || is_down == self.is_down {
            return None;
        }
        self.is_down = is_down;
        self.deaf_until = frame.saturating_add(self.deaf_frames);
        Some(if is_down { Edge::Pressed } else { Edge::Released })
    }
}

/// Button and the pads that it plays.
#[derive(Clone, Copy, Debug)]
struct Duty {
    button: Button,
    /// Pad that the button strikes, and the strike's velocity.
    strikes: Option<(u8, f32)>,
    /// Bit for each pad, set if the button chokes it.
    chokes: [u32; 8],
}

/// Set of `BUTTONS` buttons and the pads that they play.
#[derive(Clone, Debug)]
pub struct Buttons<const BUTTONS: usize> {
    duties: [Duty; BUTTONS],
}

impl<const BUTTONS: usize> Buttons<BUTTONS> {
    /// Makes the buttons for pads of the given settings, pad 0 first. Times are frames of `rate`.
    ///
    /// # Errors
    /// [`TriggerError::SharedButton`] if one button strikes two pads.
    pub fn new(pads: impl IntoIterator<Item = Settings>, rate: SampleRate) -> Result<Self, TriggerError> {
        let mut duties = [Duty { button: Button::new(rate), strikes: None, chokes: [0; 8] }; BUTTONS];
        for (pad, settings) in (0..=u8::MAX).zip(pads) {
            if let Some(button) = settings.button
                && let Some(duty) = duties.get_mut(usize::from(button))
            {
                if duty.strikes.is_some() {
                    return Err(TriggerError::SharedButton { pad, button });
                }
                duty.strikes = Some((pad, settings.button_velocity));
            }
            if let Some(duty) = settings.choke_button.and_then(|button| duties.get_mut(usize::from(button)))
                && let Some(word) = duty.chokes.get_mut(usize::from(pad / 32))
            {
                *word |= 1 << (pad % 32);
            }
        }
        Ok(Self { duties })
    }

    /// Makes the buttons for the pads of a kit.
    ///
    /// # Errors
    /// [`TriggerError::SharedButton`] if one button strikes two pads.
    pub fn from_kit(kit: &Kit<'_>, rate: SampleRate) -> Result<Self, TriggerError> {
        Self::new(Settings::of_kit(kit), rate)
    }

    /// Takes the level of one button at a frame, and reports the strike and the chokes or releases
    /// that follow.
    ///
    /// Call it as often as [`Button::sample`]. A button that no pad names does nothing.
    pub fn sample(&mut self, button: usize, frame: u64, is_down: bool, mut report: impl FnMut(Detection)) {
        let Some(duty) = self.duties.get_mut(button) else { return };
        let Some(edge) = duty.button.sample(frame, is_down) else { return };
        let choke = match edge {
            Edge::Pressed => Action::Choke,
            Edge::Released => Action::Release,
        };
        for pad in 0..=u8::MAX {
            let word = duty.chokes.get(usize::from(pad / 32)).copied().unwrap_or(0);
            if word >> (pad % 32) & 1 == 1 {
                report(Detection { frame, pad, striker: 0, velocity: 0.0, action: choke });
            }
        }
        if let (Edge::Pressed, Some((pad, velocity))) = (edge, duty.strikes) {
            report(Detection { frame, pad, striker: 0, velocity, action: Action::Strike });
        }
    }
}
