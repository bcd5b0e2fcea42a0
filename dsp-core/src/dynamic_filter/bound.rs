//! Upper bounds, in `f32`, of the gains of loops and filter. Each is within 1e-4 of a bound that
//! holds, and mostly within some percent of the gain.
//!
//! `|a + b w|²` is `(a + b)² - 4 a b sin²(ω/2)`, or `(a - b)² + 4 a b cos²(ω/2)`. One of the two is
//! a sum of two squares, in which nothing cancels. So few bits suffice, even close to a pole.

use super::path::Form;
use super::point::Point;
use crate::sine;
use crate::square_root::square_root;
use crate::waveguide::Tuned;

/// An angle on the unit circle, at `w = cos - i sin`.
#[derive(Clone, Copy)]
pub(super) struct Angle {
    /// Cosine of the angle.
    cosine: f32,
    /// Sine of the angle.
    sine: f32,
    /// Square of the sine of half the angle.
    sine_square: f32,
    /// Square of the cosine of half the angle.
    cosine_square: f32,
}

impl Angle {
    pub(super) fn new(omega: f64) -> Self {
        let (sine, cosine) = (sine::sin(0.5 * omega), sine::cos(0.5 * omega));
        Self {
            cosine: (cosine * cosine - sine * sine) as f32,
            sine: (2.0 * sine * cosine) as f32,
            sine_square: (sine * sine) as f32,
            cosine_square: (cosine * cosine) as f32,
        }
    }
}

/// `|a + b w|²` as a sum of two squares.
#[derive(Clone, Copy)]
struct Pair {
    /// The square that does not depend on the angle.
    square: f32,
    /// Factor of the squared sine, or cosine, of half the angle.
    rest: f32,
    /// True if `rest` is the cosine's factor, false if it is the sine's.
    of_cosine: bool,
}

impl Pair {
    fn new(a: f64, b: f64) -> Self {
        let product = a * b;
        let of_cosine = product > 0.0;
        let sum = if of_cosine { a - b } else { a + b };
        Self { square: (sum * sum) as f32, rest: (4.0 * product.abs()) as f32, of_cosine }
    }

    /// `|a + b w|²` at an angle.
    fn at(&self, sine_square: f32, cosine_square: f32) -> f32 {
        self.square + self.rest * if self.of_cosine { cosine_square } else { sine_square }
    }
}

/// A loop whose gain is to be bounded at many angles.
#[derive(Clone, Copy)]
pub(super) struct Loop {
    /// Numerator of the band-pass.
    above: Pair,
    /// Angle of the pole.
    angle: f64,
    /// Square of the pole's distance from the unit circle.
    distance_square: f32,
    /// 4 times the pole's radius.
    radius_4: f32,
}

impl Loop {
    pub(super) fn new(tuned: &Tuned) -> Self {
        let (a, c) = tuned.zero();
        let (angle, distance) = tuned.pole();
        let radius_4 = (4.0 * (1.0 - distance)) as f32;
        Self { above: Pair::new(a, c), angle, distance_square: (distance * distance) as f32, radius_4 }
    }

    /// Upper bound of |B| at an angle.
    pub(super) fn at_most(&self, omega: f64) -> f32 {
        let [least, most] = sine_bounds((0.5 * omega) as f32);
        let above = self.above.at(most * most, 1.0 - least * least);
        let below = self.pole_distance_square(omega - self.angle) * self.pole_distance_square(omega + self.angle);
        square_root(above) / square_root(below)
    }

    /// Lower bound of the squared distance from the pole, seen at `angle` from the pole's own.
    fn pole_distance_square(&self, angle: f64) -> f32 {
        let half = (0.5 * angle.abs()) as f32;
        let [least, _] = sine_bounds(if half > FRAC_PI_2 { 2.0 * FRAC_PI_2 - half } else { half });
        self.distance_square + self.radius_4 * least * least
    }
}

const FRAC_PI_2: f32 = core::f32::consts::FRAC_PI_2;

/// Lower and upper bound of sin x, for x from 0 to half of π.
fn sine_bounds(x: f32) -> [f32; 2] {
    let square = x * x;
    let least = x * (1.0 - square * (1.0 / 6.0));
    [least, least + x * square * square * (1.0 / 120.0)]
}

/// Upper bound of |F| at a point of the path.
pub(super) fn of_filter(point: &Point, angle: &Angle) -> f32 {
    let Angle { sine_square, cosine_square, .. } = *angle;
    let [p0, p1, p2, ..] = point.at;
    match point.form {
        Form::EqualZeros | Form::OnePole => {
            // 1 - (1 + p0) w.
            let below = Pair::new(1.0, -1.0 - p0).at(sine_square, cosine_square);
            square_root(Pair::new(p1, p2).at(sine_square, cosine_square)) / square_root(below)
        }
        Form::Conjugate | Form::Real => of_two_poles(point, angle),
    }
}

/// Largest rounding error of a number near 1.
const ROUNDING: f32 = 1e-6;

/// |F| of a second-order filter in `f32`, plus a bound of its rounding error.
fn of_two_poles(point: &Point, angle: &Angle) -> f32 {
    let w = (angle.cosine, -angle.sine);
    let [p0, p1, p2, p3, p4] = point.at.map(|parameter| parameter as f32);
    // Gives w g / (1 - p w), and a bound of its error in units of ROUNDING.
    let ring = |p: (f32, f32), g: (f32, f32)| {
        let (turned, gained) = (times(p, w), times(g, w));
        let below = (1.0 - turned.0, -turned.1);
        let square = below.0 * below.0 + below.1 * below.1;
        let ratio = times(gained, (below.0 / square, -below.1 / square));
        let (distance, gain) = (square_root(square), size(g));
        // Close to the pole rounding may decide the distance: then the bound is infinite.
        let distance = if distance > 10.0 * ROUNDING { distance } else { 0.0 };
        (ratio, gain / distance * (2.0 + 2.0 / distance))
    };
    let (sum, off) = match point.form {
        Form::Conjugate => {
            let (one, off) = ring((p0, p1), (0.5 * p2, 0.5 * p3));
            let (other, _) = ring((p0, -p1), (0.5 * p2, -0.5 * p3));
            ((one.0 + other.0 + p4, one.1 + other.1), 2.0 * off + p4.abs())
        }
        _ => {
            let (second, off_second) = ring((p1, 0.0), (p3, 0.0));
            let inner = (p2 + second.0, second.1);
            let (first, off_first) = ring((p0, 0.0), (1.0, 0.0));
            let both = times(first, inner);
            let off = off_first * (size(inner) + off_second * ROUNDING) + size(first) * (off_second + p2.abs());
            ((both.0 + p4, both.1), off + p4.abs())
        }
    };
    size(sum) + ROUNDING * off
}

fn times(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn size(a: (f32, f32)) -> f32 {
    square_root(a.0 * a.0 + a.1 * a.1)
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use proptest::prelude::*;

    use super::*;
    use crate::SampleRate;
    use crate::dynamic_filter::Breakpoint;

    /// True if the bound is below the truth by less than [`super::super::stability`] allows for.
    fn is_bound(bound: f32, truth: f64) -> bool {
        bound.is_nan() || f64::from(bound) >= truth * (1.0 - 3e-4) - 1e-12
    }

    proptest! {
        #[test]
        fn no_loop_passes_more_than_its_bound(
            frequency in 1e-4f64..0.499, narrow in 1e-5f64..0.9, gain in -2.0f64..2.0, delay_s in 1e-4f64..0.01, at in 0.0f64..1.0,
        ) {
            let rate = SampleRate::HZ_48000;
            let frequency_hz = frequency * rate.hz();
            let own = crate::waveguide::Loop { frequency_hz, bandwidth_hz: narrow * frequency_hz, gain, delay_s };
            prop_assume!(Tuned::new(&own, 0, 1024, rate).is_ok());
            let tuned = Tuned::new(&own, 0, 1024, rate).unwrap();
            let bound = Loop::new(&tuned);
            let (angle, distance) = tuned.pole();
            for omega in [at * PI, (angle + (at - 0.5) * distance).clamp(0.0, PI), angle, 0.0, PI] {
                let truth = tuned.magnitude((libm::cos(omega), libm::sin(omega)));
                prop_assert!(is_bound(bound.at_most(omega), truth), "{} for {truth} at {omega}", bound.at_most(omega));
            }
        }

        #[test]
        fn no_filter_passes_more_than_its_bound(
            radius in 0.0f64..0.9999, turn in 0.0f64..1.0, other in -0.89f64..0.9999, b in prop::array::uniform3(-2.0f64..2.0), at in 0.0f64..1.0,
            kind in 0..3,
        ) {
            let [b0, b1, b2] = b;
            let (order, a1, a2) = match kind {
                0 => (1, -radius * (2.0 * turn - 1.0), 0.0),
                1 => (2, -2.0 * radius * libm::cos(PI * turn), radius * radius),
                _ => (2, -(radius * turn + other), radius * turn * other),
            };
            let one = Breakpoint { time_s: 0.0, noise: 1.0, a1, a2, b0, b1, b2 };
            let Some(point) = Point::between(order, &one, &one, 0.0) else { return Ok(()) };
            let (angle, distance) = point.poles()[0];
            for omega in [at * PI, (angle + (at - 0.5) * distance).clamp(0.0, PI), angle, 0.0, PI] {
                let truth = point.magnitude((libm::cos(omega), libm::sin(omega)));
                let bound = of_filter(&point, &Angle::new(omega));
                prop_assert!(is_bound(bound, truth), "{bound} for {truth} at {omega}: {point:?}");
            }
        }
    }
}
