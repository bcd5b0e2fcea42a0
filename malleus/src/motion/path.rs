//! Path of a motion: smooth between the lines of its file.
//!
//! Within a contact the path is a cubic Hermite spline through the lines' places: place and
//! velocity are continuous. The velocity at a line is that of the parabola through it and its
//! neighbours (finite differences for uneven steps); at touch and lift, of the parabola through the
//! first or last three places, and with two places of the straight line. Both are exact for a
//! constant acceleration.
//!
//! The spline's own acceleration jumps at each line by about the step times the third derivative.
//! [`State::acceleration_m_per_s2`] is the mean of both sides at the lines and straight between
//! them: continuous, and with steps h of a sine of angular frequency ω within 0.6 (ωh)² of it at
//! the sine's extremes.

use std::fmt;
use std::ops::Range;

/// Kind of a tool's contact with a pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Slides over the pad's surface.
    Scrape,
    /// Rolls over it without sliding.
    Roll,
}

impl fmt::Display for Action {
    fn fmt(&self, text: &mut fmt::Formatter<'_>) -> fmt::Result {
        text.write_str(match self {
            Self::Scrape => "scrape",
            Self::Roll => "roll",
        })
    }
}

/// Touch of a pad from one touch to the lift that follows.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// Number of the pad, counted from 0.
    pub pad: u8,
    /// Number of the pad's striker that touches, counted from 0.
    pub striker: u8,
    /// Kind of the contact, from touch to lift.
    pub action: Action,
    /// Time of the touch in seconds.
    pub touch_s: f64,
    /// Time of the lift in seconds, later than the touch. The striker still touches then.
    pub lift_s: f64,
    /// Indices of the contact's knots; at least two.
    pub(super) knots: Range<usize>,
}

/// Place, velocity and acceleration of a striker that touches a pad at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Number of the contact in [`Motion::contacts`].
    pub contact: usize,
    /// Number of the pad, counted from 0.
    pub pad: u8,
    /// Number of the pad's striker, counted from 0.
    pub striker: u8,
    /// Kind of the contact.
    pub action: Action,
    /// Place on the pad in metres, along x and y, each from -1e6 to 1e6.
    pub position_m: [f64; 2],
    /// Velocity in metres per second: the derivative of the place.
    pub velocity_m_per_s: [f64; 2],
    /// Acceleration in metres per second squared, continuous within a contact.
    pub acceleration_m_per_s2: [f64; 2],
    /// Normal force in newtons that the file gives: straight between two lines that both have one.
    /// `None` where it follows from the motion ([`super::normal`]).
    pub normal_n: Option<f64>,
}

/// Line of the file as a knot of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Knot {
    pub(super) contact: usize,
    pub(super) time_s: f64,
    pub(super) position_m: [f64; 2],
    pub(super) velocity_m_per_s: [f64; 2],
    pub(super) acceleration_m_per_s2: [f64; 2],
    pub(super) normal_n: Option<f64>,
}

/// Cubic piece of the path between two knots, in u from 0 to 1:
/// `p0 + h v0 u + square u² + cube u³`, and so for each axis.
pub(super) struct Piece {
    h: f64,
    square: [f64; 2],
    cube: [f64; 2],
}

impl Piece {
    pub(super) fn between(from: &Knot, to: &Knot) -> Self {
        let h = to.time_s - from.time_s;
        let (v0, v1) = (from.velocity_m_per_s, to.velocity_m_per_s);
        let way = |axis: usize| to.position_m[axis] - from.position_m[axis];
        Self {
            h,
            square: [0, 1].map(|axis| 3.0 * way(axis) - h * (2.0 * v0[axis] + v1[axis])),
            cube: [0, 1].map(|axis| h * (v0[axis] + v1[axis]) - 2.0 * way(axis)),
        }
    }

    /// Control points of the velocity, a parabola in Bernstein form.
    pub(super) fn velocity_controls(&self, from: &Knot, to: &Knot) -> [[f64; 2]; 3] {
        let middle = [0, 1].map(|axis| from.velocity_m_per_s[axis] + self.square[axis] / self.h);
        [from.velocity_m_per_s, middle, to.velocity_m_per_s]
    }

    /// Second derivative of the spline at the beginning and at the end.
    fn accelerations(&self) -> [[f64; 2]; 2] {
        let at = |u: f64| [0, 1].map(|axis| (2.0 * self.square[axis] + 6.0 * u * self.cube[axis]) / (self.h * self.h));
        [at(0.0), at(1.0)]
    }
}

/// Motion of a striker over pads: contacts one after the other, one at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    pub(super) contacts: Vec<Contact>,
    pub(super) knots: Vec<Knot>,
    pub(super) remarks: Vec<String>,
}

impl Motion {
    /// Contacts in order of time; at least one. Each begins after the one before it is lifted.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Remarks for the user, such as a last contact that the file does not lift.
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }

    /// Time of the last lift in seconds.
    pub fn end_s(&self) -> f64 {
        self.contacts.last().map_or(0.0, |contact| contact.lift_s)
    }

    /// State at a time in seconds, by a search; `None` while nothing is touched.
    ///
    /// Touch and lift themselves belong to their contact. For many times in order,
    /// [`reader`](Self::reader) takes constant time for each.
    pub fn at(&self, time_s: f64) -> Option<State> {
        let behind = self.knots.partition_point(|knot| knot.time_s <= time_s);
        self.behind(behind.checked_sub(1)?, time_s)
    }

    /// Length of the path in metres over all contacts, and its highest speed in metres per second,
    /// both read at the lines and in the middles between them.
    pub fn way(&self) -> (f64, f64) {
        let speed = |state: State| state.velocity_m_per_s[0].hypot(state.velocity_m_per_s[1]);
        let pieces = (0..self.contacts.len()).flat_map(|contact| self.pieces(contact));
        pieces.fold((0.0, 0.0), |(length, fastest), index| {
            let h = self.knots[index + 1].time_s - self.knots[index].time_s;
            let [begin, middle, end] = [0.0, 0.5, 1.0].map(|u| speed(self.state(index, u)));
            (length + h * (begin + 4.0 * middle + end) / 6.0, begin.max(middle).max(end).max(fastest))
        })
    }

    /// Indices of a contact's pieces: piece `i` lies between knots `i` and `i + 1`.
    pub(super) fn pieces(&self, contact: usize) -> Range<usize> {
        let knots = &self.contacts[contact].knots;
        knots.start..knots.end - 1
    }

    /// State at a time that is not before knot `index` and before the next one.
    pub(super) fn behind(&self, index: usize, time_s: f64) -> Option<State> {
        let knot = self.knots.get(index)?;
        match self.knots.get(index + 1) {
            Some(next) if next.contact == knot.contact => {
                Some(self.state(index, (time_s - knot.time_s) / (next.time_s - knot.time_s)))
            }
            // The last knot of a contact is its lift: the end of the piece before.
            _ => (time_s == knot.time_s).then(|| self.state(index - 1, 1.0)),
        }
    }

    /// State in a piece at u from 0 to 1.
    pub(super) fn state(&self, piece: usize, u: f64) -> State {
        let (from, to) = (&self.knots[piece], &self.knots[piece + 1]);
        let Piece { h, square, cube } = Piece::between(from, to);
        let Contact { pad, striker, action, .. } = self.contacts[from.contact];
        let straight = |a: f64, b: f64| (1.0 - u) * a + u * b;
        let place = |axis: usize| {
            from.position_m[axis] + u * (h * from.velocity_m_per_s[axis] + u * (square[axis] + u * cube[axis]))
        };
        let velocity = |axis: usize| from.velocity_m_per_s[axis] + u * (2.0 * square[axis] + 3.0 * u * cube[axis]) / h;
        State {
            contact: from.contact,
            pad,
            striker,
            action,
            position_m: if u == 1.0 { to.position_m } else { [0, 1].map(place) },
            velocity_m_per_s: if u == 1.0 { to.velocity_m_per_s } else { [0, 1].map(velocity) },
            acceleration_m_per_s2: [0, 1]
                .map(|axis| straight(from.acceleration_m_per_s2[axis], to.acceleration_m_per_s2[axis])),
            normal_n: from.normal_n.zip(to.normal_n).map(|(from, to)| straight(from, to)),
        }
    }
}

/// Fills in velocities and accelerations of a contact's knots, of which there are at least two.
pub(super) fn smooth(knots: &mut [Knot]) {
    let slope = |from: &Knot, to: &Knot| {
        let h = to.time_s - from.time_s;
        [0, 1].map(|axis| (to.position_m[axis] - from.position_m[axis]) / h)
    };
    let last = knots.len() - 1;
    for index in 0..=last {
        // The parabola through three knots: the first, the last, or one with its neighbours.
        let middle = index.clamp(1, last.max(2) - 1);
        let [before, here] = [&knots[middle - 1], &knots[middle]];
        let first = slope(before, here);
        knots[index].velocity_m_per_s = match knots.get(middle + 1) {
            None => first,
            Some(behind) => {
                let (h0, h1) = (here.time_s - before.time_s, behind.time_s - here.time_s);
                let second = slope(here, behind);
                let from_middle = knots[index].time_s - here.time_s;
                [0, 1].map(|axis| {
                    let at_middle = (h1 * first[axis] + h0 * second[axis]) / (h0 + h1);
                    at_middle + 2.0 * from_middle * (second[axis] - first[axis]) / (h0 + h1)
                })
            }
        };
    }
    let ends: Vec<_> = knots.windows(2).map(|pair| Piece::between(&pair[0], &pair[1]).accelerations()).collect();
    for (index, knot) in knots.iter_mut().enumerate() {
        let left = index.checked_sub(1).map(|piece| ends[piece][1]);
        let right = ends.get(index).map(|piece| piece[0]);
        let (left, right) = (left.or(right).unwrap_or_default(), right.or(left).unwrap_or_default());
        knot.acceleration_m_per_s2 = [0, 1].map(|axis| 0.5 * (left[axis] + right[axis]));
    }
}
