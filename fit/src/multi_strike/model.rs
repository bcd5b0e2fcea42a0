//! The model of a recording of many strikes: modes, gains along the object, and contacts.
//!
//! ```text
//! y(t) = Σ_i m_i [ Σ_k Re(g_k(x_i) R(t; s_k, τ_i)) + α F(t; τ_i) ]
//! ```
//!
//! R is the response of a mode to a half-sine ([`super::contact`]), F the half-sine itself
//! (diffimpact eq. 1 and 3 without room). Gains along the object are splines
//! ([`super::spline`]). A striker's own mode rings under that striker only, wherever it strikes.

use std::ops::Range;

use nalgebra::{Complex, DVector};

use super::contact::Contact;
use super::spline::Weights;
use crate::modes::Pole;

type C64 = Complex<f64>;

/// A strike: its contact, its position from 0 to 1 along the object, and its striker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strike {
    pub(crate) contact: Contact,
    pub(crate) position: f64,
    /// Number of the striker, counted from 0.
    pub(crate) striker: usize,
}

impl Strike {
    /// The strike at a time later by a number of samples.
    pub(crate) fn later_by(self, samples: f64) -> Self {
        Self { contact: Contact { middle: self.contact.middle + samples, ..self.contact }, ..self }
    }
}

/// Modes, gains, acceleration sound and strikes of a recording; the unit of time is the sample.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Model {
    pub(crate) poles: Vec<Pole>,
    /// Coefficients of each mode's gains along the object: mode by mode.
    ///
    /// A striker's own mode has one.
    pub(crate) gains: Vec<Vec<C64>>,
    /// Striker whose own mode each mode is; `None` for a mode of the object.
    pub(crate) owners: Vec<Option<usize>>,
    /// Factor from force to acceleration sound; a fit holds it while it is exactly 0.
    pub(crate) acceleration: f64,
    /// True if contact times are those heard of each strike alone ([`super::heard`]), and no fit
    /// changes them.
    pub(crate) contact_times_are_held: bool,
    /// True if all gains of a mode along the object have one phase, or its opposite, and a fit
    /// keeps them so ([`super::real_shapes`]).
    pub(crate) shapes_are_real: bool,
    /// Strikes in order of the middles of their contacts.
    pub(crate) strikes: Vec<Strike>,
}

impl Model {
    /// Number of coefficients of the gains along the object.
    pub(crate) fn places(&self) -> usize {
        self.gains.iter().map(Vec::len).max().unwrap_or(1)
    }

    /// Pole of a mode as `s = -d + jω`.
    pub(crate) fn exponent(&self, mode: usize) -> C64 {
        C64::new(-self.poles[mode].decay, self.poles[mode].angular)
    }

    /// True if a strike rings a mode: the object's own, or one of the striker that strikes.
    pub(crate) fn rings(&self, mode: usize, strike: &Strike) -> bool {
        self.owners[mode].is_none_or(|owner| owner == strike.striker)
    }

    /// Gain of a mode at a position.
    pub(crate) fn gain(&self, mode: usize, position: f64) -> C64 {
        Weights::at(position, self.gains[mode].len()).sum(&self.gains[mode])
    }

    /// Adds a mode with one gain for all positions.
    pub(crate) fn push(&mut self, pole: Pole, gain: C64, owner: Option<usize>) {
        let places = if owner.is_some() { 1 } else { self.places() };
        self.poles.push(pole);
        self.gains.push(vec![gain; places]);
        self.owners.push(owner);
    }

    /// Drops the modes whose index is listed.
    pub(crate) fn drop_modes(&mut self, dropped: &[usize]) {
        let is_kept = |index: usize| !dropped.contains(&index);
        let mut index = (0.., 0.., 0..);
        self.poles.retain(|_| index.0.next().is_some_and(is_kept));
        self.gains.retain(|_| index.1.next().is_some_and(is_kept));
        self.owners.retain(|_| index.2.next().is_some_and(is_kept));
    }

    /// Number of parameters of a strike: middle, ln τ, ln m, and the position if there are places.
    pub(crate) fn strike_size(&self) -> usize {
        if self.places() > 1 { 4 } else { 3 }
    }

    /// Number of parameters that all strikes share: poles, gains and acceleration.
    pub(crate) fn shared_size(&self) -> usize {
        2 * self.poles.len() + 2 * self.gains.iter().map(Vec::len).sum::<usize>() + 1
    }

    /// Number of shared parameters that change on their own: those of a real shape are its
    /// coefficients and one phase.
    pub(crate) fn shared_freedom(&self) -> usize {
        let held = |gains: &Vec<C64>| if self.shapes_are_real { gains.len() - 1 } else { 0 };
        self.shared_size() - self.gains.iter().map(held).sum::<usize>()
    }

    /// Index of the first gain of a mode among the shared parameters.
    pub(crate) fn gain_column(&self, mode: usize) -> usize {
        2 * self.poles.len() + 2 * self.gains[..mode].iter().map(Vec::len).sum::<usize>()
    }

    /// Indices of a mode's decay, angular frequency and gains among the shared parameters.
    pub(crate) fn columns_of(&self, mode: usize) -> impl Iterator<Item = usize> + use<> {
        let first = self.gain_column(mode);
        [2 * mode, 2 * mode + 1].into_iter().chain(first..first + 2 * self.gains[mode].len())
    }

    /// Steps poles and gains of a model with one place along given shared parameters.
    ///
    /// A step changes a decay by a factor of 2 at most, and a frequency by the decay.
    pub(crate) fn step_shared(&mut self, step: &DVector<f64>) {
        for mode in 0..self.poles.len() {
            let column = self.gain_column(mode);
            let pole = &mut self.poles[mode];
            pole.angular += step[2 * mode + 1].clamp(-pole.decay, pole.decay);
            pole.decay = (pole.decay + step[2 * mode]).clamp(0.5 * pole.decay, 2.0 * pole.decay);
            self.gains[mode][0] += C64::new(step[column], step[column + 1]);
        }
    }

    /// Index of the strike with the largest peak, which fixes the unit of force.
    pub(crate) fn strongest(&self) -> usize {
        let peak = |index: &usize| self.strikes[*index].contact.peak;
        (0..self.strikes.len()).max_by(|a, b| peak(a).total_cmp(&peak(b))).unwrap_or(0)
    }

    /// Indices of the strikes at the ends of the object, which fix the scale of positions.
    ///
    /// Both are among the stronger half of all strikes. `None` if there is one place.
    pub(crate) fn ends(&self) -> Option<[usize; 2]> {
        if self.places() < 2 {
            return None;
        }
        let mut order: Vec<usize> = (0..self.strikes.len()).collect();
        order.sort_by(|a, b| self.strikes[*b].contact.peak.total_cmp(&self.strikes[*a].contact.peak));
        order.truncate(order.len().div_ceil(2));
        let position = |index: &usize| self.strikes[*index].position;
        let first = order.iter().copied().min_by(|a, b| position(a).total_cmp(&position(b)))?;
        let last = order.iter().copied().max_by(|a, b| position(a).total_cmp(&position(b)))?;
        Some([first, last])
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
        Strike { contact: Contact { middle, time: 20.0, peak: 1.0 }, position: 0.0, striker: 0 }
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
    fn own_mode_of_a_striker_rings_under_that_striker_alone() {
        let mut model = Model {
            poles: vec![Pole { decay: 1e-3, angular: 0.1 }],
            gains: vec![vec![C64::new(1.0, 0.0); 5]],
            owners: vec![None],
            acceleration: 0.0,
            contact_times_are_held: false,
            shapes_are_real: false,
            strikes: vec![strike(100.0)],
        };
        model.push(Pole { decay: 1e-3, angular: 0.3 }, C64::new(2.0, 0.0), Some(1));
        let other = Strike { striker: 1, ..model.strikes[0] };
        let rings = |mode: usize, strike: &Strike| model.rings(mode, strike);
        assert!(rings(0, &model.strikes[0]) && rings(0, &other) && rings(1, &other) && !rings(1, &model.strikes[0]));
        assert_eq!((model.shared_size(), model.gain_column(1), model.strike_size()), (17, 14, 4));
        assert!((model.gain(0, 0.3) - C64::new(1.0, 0.0)).norm() < 1e-12);
        model.drop_modes(&[0]);
        assert_eq!((model.owners.as_slice(), model.gains.len(), model.poles.len()), (&[Some(1)][..], 1, 1));
    }
}
