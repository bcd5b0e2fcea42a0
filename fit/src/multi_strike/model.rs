//! The model of a recording of many strikes: modes, gains along the object, and contacts.
//!
//! ```text
//! y(t) = Σ_i m_i [ Σ_k Re(g_k(x_i) R(t; s_k, τ_i)) + α F(t; τ_i) ]
//! ```
//!
//! R is the response of a mode to a half-sine ([`super::contact`]), F the half-sine itself
//! (diffimpact eq. 1 and 3 without room). Gains between two places are interpolated linearly.

use std::ops::Range;

use nalgebra::Complex;

use super::contact::Contact;
use crate::modes::Pole;

type C64 = Complex<f64>;

/// A strike: its contact, and its position from 0 to 1 along the places with gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strike {
    pub(crate) contact: Contact,
    pub(crate) position: f64,
}

/// Modes, gains, acceleration sound and strikes of a recording; the unit of time is the sample.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Model {
    pub(crate) poles: Vec<Pole>,
    /// Gains of each mode at each place: mode by mode.
    pub(crate) gains: Vec<Vec<C64>>,
    /// Factor from force to acceleration sound; a fit holds it while it is exactly 0.
    pub(crate) acceleration: f64,
    /// Strikes in order of the middles of their contacts.
    pub(crate) strikes: Vec<Strike>,
}

/// Places between which a strike lies: the index of the lower one, and the share of the upper one.
pub(crate) fn between(position: f64, places: usize) -> (usize, f64) {
    if places < 2 {
        return (0, 0.0);
    }
    let along = position.clamp(0.0, 1.0) * (places - 1) as f64;
    let lower = (along as usize).min(places - 2);
    (lower, along - lower as f64)
}

impl Model {
    /// Number of places with gains.
    pub(crate) fn places(&self) -> usize {
        self.gains.first().map_or(1, Vec::len)
    }

    /// Pole of a mode as `s = -d + jω`.
    pub(crate) fn exponent(&self, mode: usize) -> C64 {
        C64::new(-self.poles[mode].decay, self.poles[mode].angular)
    }

    /// Gain of a mode at a position.
    pub(crate) fn gain(&self, mode: usize, position: f64) -> C64 {
        let gains = &self.gains[mode];
        let (lower, share) = between(position, gains.len());
        gains.get(lower + 1).map_or(gains[lower], |upper| gains[lower] * (1.0 - share) + upper * share)
    }

    /// Number of parameters of a strike: middle, ln τ, ln m, and the position if there are places.
    pub(crate) fn strike_size(&self) -> usize {
        if self.places() > 1 { 4 } else { 3 }
    }

    /// Number of parameters that all strikes share: poles, gains and acceleration.
    pub(crate) fn shared_size(&self) -> usize {
        self.poles.len() * (2 + 2 * self.places()) + 1
    }

    /// Index of the first gain of a mode among the shared parameters.
    pub(crate) fn gain_column(&self, mode: usize) -> usize {
        2 * self.poles.len() + 2 * mode * self.places()
    }

    /// Index of the strike with the largest peak, which fixes the unit of force.
    pub(crate) fn strongest(&self) -> usize {
        let peak = |index: &usize| self.strikes[*index].contact.peak;
        (0..self.strikes.len()).max_by(|a, b| peak(a).total_cmp(&peak(b))).unwrap_or(0)
    }

    /// Scales forces and gains so that the strongest strike has a peak of 1.
    pub(crate) fn normalise(&mut self) {
        let Some(strongest) = self.strikes.get(self.strongest()) else { return };
        let unit = strongest.contact.peak;
        self.strikes.iter_mut().for_each(|strike| strike.contact.peak /= unit);
        self.gains.iter_mut().flatten().for_each(|gain| *gain *= unit);
        self.acceleration *= unit;
    }
}

/// Part of a recording from one attack to the next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Segment {
    /// Strikes whose contacts lie in the attack.
    pub(crate) strikes: Range<usize>,
    /// First sample of the attack.
    pub(crate) start: usize,
    /// First sample in which the modes ring freely.
    pub(crate) free: usize,
    /// First sample of the next attack, or the end of the recording.
    pub(crate) end: usize,
}

/// Segments of a recording of `length` samples, from the first attack on.
///
/// An attack lasts until `behind` samples after the contact's end, as a whitening filter of that
/// order asks. Contacts with less between them share an attack.
pub(crate) fn segments(strikes: &[Strike], length: usize, behind: usize) -> Vec<Segment> {
    let mut segments: Vec<Segment> = Vec::new();
    for (index, strike) in strikes.iter().enumerate() {
        let start = (strike.contact.first_sample().max(0.0) as usize).min(length);
        let free = (strike.contact.end_sample().max(0.0) as usize + behind).min(length);
        match segments.last_mut() {
            Some(last) if start < last.free + behind + 1 => {
                last.free = last.free.max(free);
                last.strikes.end = index + 1;
            }
            last => {
                if let Some(last) = last {
                    last.end = start;
                }
                segments.push(Segment { strikes: index..index + 1, start, free, end: length });
            }
        }
    }
    segments
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strike(middle: f64) -> Strike {
        Strike { contact: Contact { middle, time: 20.0, peak: 1.0 }, position: 0.0 }
    }

    #[test]
    fn segments_cover_the_recording_and_join_contacts_that_touch() {
        let strikes = [strike(100.0), strike(500.0), strike(512.0), strike(900.0)];
        let found = segments(&strikes, 1000, 4);
        let expected = [(0..1, 90, 115, 490), (1..3, 490, 527, 890), (3..4, 890, 915, 1000)];
        let expected: Vec<Segment> =
            expected.into_iter().map(|(strikes, start, free, end)| Segment { strikes, start, free, end }).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn gain_between_two_places_is_interpolated() {
        let model = Model {
            poles: vec![Pole { decay: 1e-3, angular: 0.1 }],
            gains: vec![vec![C64::new(1.0, 0.0), C64::new(3.0, 2.0), C64::new(0.0, 0.0)]],
            acceleration: 0.0,
            strikes: Vec::new(),
        };
        assert!((model.gain(0, 0.25) - C64::new(2.0, 1.0)).norm() < 1e-12);
        assert!((model.gain(0, 1.0) - C64::new(0.0, 0.0)).norm() < 1e-12);
    }
}
