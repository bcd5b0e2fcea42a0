//! The coefficients over time: breakpoints, what is refused, and what a rate makes of them.

use core::fmt;

use crate::SampleRate;

/// The coefficients at a time after the strike; between breakpoints they are interpolated linearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakpoint {
    /// Seconds after the strike; the first one's is 0.
    pub time_s: f64,
    /// Coefficient of -s(n-1).
    pub a1: f64,
    /// Coefficient of -s(n-2): second order only.
    pub a2: f64,
    /// Coefficient of e(n).
    pub b0: f64,
    /// Coefficient of e(n-1); eq. 17 has b1 = b0.
    pub b1: f64,
    /// Coefficient of e(n-2): second order only.
    pub b2: f64,
}

/// Why breakpoints are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathError {
    /// None, or more than fit.
    Count {
        /// Breakpoints given.
        given: usize,
        /// Breakpoints that fit.
        room: usize,
    },
    /// The first is not at 0, or one is not behind the one before it, or beyond a day.
    Order {
        /// The breakpoint, counted from 0.
        breakpoint: usize,
        /// Its time in seconds.
        time_s: f64,
    },
    /// |a1| is not below 1 (eq. 21), or so near that the state would not fit.
    Unstable {
        /// The breakpoint, counted from 0.
        breakpoint: usize,
        /// Its a1.
        a1: f64,
    },
    /// b0 or b1 is not finite, or the gain `(|b0| + |b1|) / (1 - |a1|)` above [`Path::MAX_GAIN`].
    Gain {
        /// The breakpoint, counted from 0.
        breakpoint: usize,
        /// That gain.
        gain: f64,
    },
}

impl fmt::Display for PathError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Count { given, room } => write!(f, "{given} breakpoints: give 1 to {room}"),
            Self::Order { breakpoint, time_s } => {
                write!(
                    f,
                    "breakpoint {breakpoint} at {time_s} s: begin at 0 and give each time after the one before, up to a day"
                )
            }
            Self::Unstable { breakpoint, a1 } => {
                write!(f, "breakpoint {breakpoint}: a1 = {a1} does not decay: give one within ±{}", Path::<1>::MAX_A1)
            }
            Self::Gain { breakpoint, gain } => {
                write!(
                    f,
                    "breakpoint {breakpoint}: a gain of {gain}: lower b0 and b1 to at most {}",
                    Path::<1>::MAX_GAIN
                )
            }
        }
    }
}

impl core::error::Error for PathError {}

/// A piece of the path, from a frame on: coefficients there and their change a frame, each with 32 bits more than the filter takes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Piece {
    /// First frame after the strike.
    pub(super) start: u32,
    /// b0, b1 (Q(31 + h)), 1 + a1 (Q30), times 2^32.
    pub(super) value: [i64; 3],
    /// Their change a frame.
    pub(super) slope: [i64; 3],
}

/// Coefficients over time for a sample rate: at most `N` breakpoints.
#[derive(Clone, Copy, Debug)]
pub struct Path<const N: usize> {
    pieces: [Piece; N],
    count: usize,
    /// h: the state is larger than the bus by 2^h.
    scale: i32,
}

impl<const N: usize> Path<N> {
    /// The largest |a1|.
    pub const MAX_A1: f64 = 0.99999;
    /// The largest `(|b0| + |b1|) / (1 - |a1|)`.
    pub const MAX_GAIN: f64 = 8_388_608.0;
    /// A path that gives nothing.
    pub const EMPTY: Self = Self { pieces: [Piece { start: 0, value: [0; 3], slope: [0; 3] }; N], count: 0, scale: 0 };

    /// Derives the path for a rate. Breakpoints keep their time to a fraction of a frame.
    ///
    /// # Errors
    /// [`PathError`].
    pub fn new(breakpoints: impl Iterator<Item = Breakpoint> + Clone, rate: SampleRate) -> Result<Self, PathError> {
        let given = breakpoints.clone().count();
        if given == 0 || given > N {
            return Err(PathError::Count { given, room: N });
        }
        let (mut before, mut largest) = (-1.0, 0.0f64);
        for (breakpoint, Breakpoint { time_s, b0, b1, a1, .. }) in breakpoints.clone().enumerate() {
            let starts = breakpoint > 0 || time_s == 0.0;
            if !(time_s > before && time_s <= 86_400.0 && starts) {
                return Err(PathError::Order { breakpoint, time_s });
            }
            if !(0.0..=Self::MAX_A1).contains(&a1.abs()) {
                return Err(PathError::Unstable { breakpoint, a1 });
            }
            let gain = (b0.abs() + b1.abs()) / (1.0 - a1.abs());
            if !(0.0..=Self::MAX_GAIN).contains(&gain) {
                return Err(PathError::Gain { breakpoint, gain });
            }
            (before, largest) = (time_s, largest.max(gain));
        }
        // largest · 2^h < 1, with a little to spare for the rounding of coefficients.
        let scale = (-libm::frexp(largest * 1.0001).1).clamp(-24, 16);
        let units = [libm::scalbn(1.0, 31 + scale), libm::scalbn(1.0, 31 + scale), libm::scalbn(1.0, 30)];
        let mut path = Self { scale, count: given, ..Self::EMPTY };
        let mut following = breakpoints.clone().skip(1);
        for (piece, here) in path.pieces.iter_mut().zip(breakpoints) {
            let next = following.next().unwrap_or(here);
            let frame = here.time_s * rate.hz();
            let start = libm::ceil(frame);
            let frames = next.time_s * rate.hz() - frame;
            let pairs = [(here.b0, next.b0), (here.b1, next.b1), (1.0 + here.a1, 1.0 + next.a1)];
            piece.start = start as u32;
            for (((value, slope), (from, to)), unit) in
                piece.value.iter_mut().zip(&mut piece.slope).zip(pairs).zip(units)
            {
                let change = if frames > 0.0 { (to - from) / frames } else { 0.0 };
                // |a coefficient| · unit < 2^31, and pieces shorter than a frame, whose slope could be anything, are never stepped.
                let change = if frames >= 1.0 { change } else { 0.0 };
                let at_start = if frames >= 1.0 { from + change * (start - frame) } else { from };
                *value = libm::rint(at_start * unit * 4294967296.0) as i64;
                *slope = libm::rint(change * unit * 4294967296.0) as i64;
            }
        }
        Ok(path)
    }

    pub(super) fn scale(&self) -> i32 {
        self.scale
    }

    /// The frame at which the last breakpoint is reached.
    pub fn last_frame(&self) -> u32 {
        self.pieces().last().map_or(0, |piece| piece.start)
    }

    pub(super) fn pieces(&self) -> &[Piece] {
        self.pieces.get(..self.count).unwrap_or(&[])
    }
}
