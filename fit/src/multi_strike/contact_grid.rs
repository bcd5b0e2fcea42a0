//! Contact of one strike, from the change of the modes' amplitudes and from their gains.
//!
//! Contact times and middles on a grid are tried, and Gauss-Newton steps improve the best ones.

use nalgebra::{Complex, Matrix3, Vector3};

use super::amplitudes::Change;
use super::contact::{Contact, Response, strength};
use crate::modes::Pole;
use crate::vectors::vectorized;

type C64 = Complex<f64>;

/// Shortest and longest contact time that is tried, in seconds.
const TIMES_S: [f64; 2] = [0.12e-3, 5e-3];
/// Number of contact times on a strike's own grid.
const GRID: usize = 28;
/// Reach of δ before and behind the moment, in seconds.
pub(super) const REACH_S: [f64; 2] = [3e-3, 4.5e-3];
/// Number of the best contact times of a strike's own grid that are improved.
const LOOKED_AT: usize = 5;
/// Number of times that each of them is improved.
const IMPROVED: usize = 3;
/// Maximum number of steps by which a contact is improved at a time.
const MOST_STEPS: usize = 4;
/// Change of what is left of a strike's amplitudes, in units of their variances, at which its
/// contact is improved no further.
const SETTLED: f64 = 0.01;
/// Step of δ in samples.
const STEP: f64 = 0.5;
/// Number of rounds of gains and contacts in turn, behind each look and each step from it.
const ROUNDS: usize = 8;

/// Contact times in samples that are tried.
pub(super) fn contact_times(count: usize, rate_hz: f64) -> Vec<f64> {
    let tried = |index: usize| rate_hz * TIMES_S[0] * (TIMES_S[1] / TIMES_S[0]).powf(index as f64 / (count - 1) as f64);
    (0..count).map(tried).collect()
}

/// Exponents `s = -d + jω` of poles.
pub(super) fn exponents_of(poles: &[Pole]) -> Vec<C64> {
    poles.iter().map(|pole| C64::new(-pole.decay, pole.angular)).collect()
}

/// Contact times that are tried for a strike, with the strength of each mode at each of them.
pub(super) struct Grid {
    pub(super) exponents: Vec<C64>,
    times: Vec<f64>,
    strengths: Vec<Vec<C64>>,
    /// Turn of each mode by a step of the middle, from the reach before the moment on.
    turnings: Vec<Turning>,
    /// Reach of the middle before and behind the moment, in samples.
    reach: [f64; 2],
}

impl Grid {
    pub(super) fn new(exponents: Vec<C64>, rate_hz: f64) -> Self {
        let times = contact_times(GRID, rate_hz);
        let strengths =
            times.iter().map(|time| exponents.iter().map(|s| strength(*s, *time).value).collect()).collect();
        let reach = REACH_S.map(|reach| reach * rate_hz);
        let turnings = exponents.iter().map(|s| Turning::new(s.im * STEP, s.im * -reach[0])).collect();
        Self { exponents, times, strengths, turnings, reach }
    }

    /// Contact that explains most of a change.
    pub(super) fn best(&self, change: &Change, gains: &[C64], spreads: &[f64]) -> Contact {
        let energy: f64 = change.amplitudes.iter().map(C64::norm_sqr).sum();
        let steps = ((self.reach[0] + self.reach[1]) / STEP) as usize;
        let mut sums = vec![[0.0; LANES]; steps.div_ceil(LANES)];
        let nothing = Contact { middle: 0.0, time: self.times[0], peak: 1e-9 };
        let mut best = vec![(0.0, nothing); self.times.len()];
        for ((&time, strengths), best) in self.times.iter().zip(&self.strengths).zip(&mut best) {
            let shapes: Vec<C64> = gains.iter().zip(strengths).map(|(gain, strength)| gain * strength).collect();
            let loudness = energy / shapes.iter().map(C64::norm_sqr).sum::<f64>().max(1e-300);
            let weights: Vec<f64> = (change.variances.iter().zip(spreads).zip(strengths))
                .map(|((variance, spread), strength)| 1.0 / (variance + loudness * spread * strength.norm_sqr()))
                .collect();
            let size: f64 = shapes.iter().zip(&weights).map(|(shape, weight)| shape.norm_sqr() * weight).sum();
            sums.fill([0.0; LANES]);
            vectorized(
                #[inline(always)]
                || {
                    for (((a, shape), weight), turning) in
                        change.amplitudes.iter().zip(&shapes).zip(&weights).zip(&self.turnings)
                    {
                        turning.add(a * shape.conj() * *weight, &mut sums);
                    }
                },
            );
            for (step, &sum) in sums.as_flattened()[..steps].iter().enumerate() {
                if sum > 0.0 && sum * sum / size > best.0 {
                    let middle = step as f64 * STEP - self.reach[0];
                    *best = (sum * sum / size, Contact { middle, time, peak: sum / size });
                }
            }
        }
        // The steps of the grid may be longer than the way from one minimum to the next.
        best.sort_by(|a, b| b.0.total_cmp(&a.0));
        let improved = |(_, mut contact): (f64, Contact)| {
            let left = (0..IMPROVED).fold(f64::INFINITY, |_, _| self.improve(&mut contact, change, gains).0);
            (left, contact)
        };
        let found = best.into_iter().take(LOOKED_AT).map(improved).min_by(|a, b| a.0.total_cmp(&b.0));
        found.map_or(nothing, |(_, contact)| contact)
    }

    /// Improves contacts and gains in turn; returns what is left of the changes, in units of their
    /// variances.
    pub(super) fn in_turn(&self, contacts: &mut [Contact], changes: &[Change], gains: &mut [C64]) -> f64 {
        let mut left = f64::INFINITY;
        for _ in 0..ROUNDS {
            let shapes: Vec<Shapes> = (contacts.iter_mut().zip(changes))
                .map(|(contact, change)| self.improve(contact, change, gains).1)
                .collect();
            left = fit_gains(&shapes, changes, gains);
        }
        left
    }

    /// Lengthens a contact by an amount of its squared time, with the ringing that it has.
    ///
    /// Slow modes tell the squares of contact times up to a constant.
    pub(super) fn lengthen(&self, contact: &mut Contact, by: f64) {
        let longest = self.times[self.times.len() - 1];
        let time = (contact.time * contact.time + by).max(0.0).sqrt().clamp(self.times[0], longest);
        contact.peak *= contact.time / time;
        contact.time = time;
    }

    /// Damped Gauss-Newton steps of a contact's middle, ln τ and ln m at given gains, within the
    /// grid's times; returns what is left of the change, in units of its variances, and the shapes.
    pub(super) fn improve(&self, contact: &mut Contact, change: &Change, gains: &[C64]) -> (f64, Shapes) {
        let mut shapes = self.shapes(contact);
        let mut now = misfit(&shapes, change, gains);
        let mut damping = 1e-3;
        for _ in 0..MOST_STEPS {
            let (mut normal, mut right) = (Matrix3::<f64>::zeros(), Vector3::<f64>::zeros());
            for ((((a, variance), (shape, strength)), s), gain) in
                change.amplitudes.iter().zip(&change.variances).zip(&shapes).zip(&self.exponents).zip(gains)
            {
                let value = gain * shape;
                let slopes = [-s * value, value * strength.by_time / strength.value * contact.time, value];
                let left = a - value;
                for (i, slope) in slopes.iter().enumerate() {
                    right[i] += (slope.conj() * left).re / variance;
                    for (j, other) in slopes.iter().enumerate() {
                        normal[(i, j)] += (slope.conj() * other).re / variance;
                    }
                }
            }
            (0..3).for_each(|index| normal[(index, index)] *= 1.0 + damping);
            let Some(step) = normal.cholesky().map(|factor| factor.solve(&right)) else { break };
            let reach = 0.2 * contact.time;
            let grown = contact.time * step[1].clamp(-0.3, 0.3).exp();
            let next = Contact {
                middle: contact.middle + step[0].clamp(-reach, reach),
                time: grown.clamp(self.times[0], self.times[self.times.len() - 1]),
                peak: contact.peak * step[2].clamp(-0.7, 0.7).exp(),
            };
            let moved = self.shapes(&next);
            let then = misfit(&moved, change, gains);
            let is_done = (now - then).abs() < SETTLED;
            if then < now {
                (*contact, shapes, now) = (next, moved, then);
                damping *= 0.1;
            } else {
                damping = (damping * 10.0).max(1e-3);
            }
            if is_done {
                break;
            }
        }
        (now, shapes)
    }

    /// Amplitudes of modes of gain 1 at the moment, by a contact whose middle counts from there.
    pub(super) fn shapes(&self, contact: &Contact) -> Shapes {
        let of_mode = |s: &C64| {
            let strength = strength(*s, contact.time);
            (strength.value * (-s * contact.middle).exp() * contact.peak, strength)
        };
        self.exponents.iter().map(of_mode).collect()
    }
}

/// Amplitude of each mode of gain 1 by a contact, and the contact's strength.
pub(super) type Shapes = Vec<(C64, Response)>;

/// Remainder of a change behind a contact's amplitudes, in units of the change's variances.
fn misfit(shapes: &Shapes, change: &Change, gains: &[C64]) -> f64 {
    (change.amplitudes.iter().zip(&change.variances).zip(shapes).zip(gains))
        .map(|(((a, variance), (shape, _)), gain)| (a - gain * shape).norm_sqr() / variance)
        .sum()
}

/// Fits gains to the changes of contacts; returns what is left of the changes.
pub(super) fn fit_gains(shapes: &[Shapes], changes: &[Change], gains: &mut [C64]) -> f64 {
    let mut left = 0.0;
    for (mode, gain) in gains.iter_mut().enumerate() {
        let (mut along, mut size, mut energy) = (C64::new(0.0, 0.0), 1e-300, 0.0);
        for (shapes, change) in shapes.iter().zip(changes) {
            let (shape, _) = shapes[mode];
            let weight = 1.0 / change.variances[mode];
            along += shape.conj() * change.amplitudes[mode] * weight;
            size += shape.norm_sqr() * weight;
            energy += change.amplitudes[mode].norm_sqr() * weight;
        }
        *gain = along / size;
        left += energy - along.norm_sqr() / size;
    }
    left
}

/// Number of steps that are taken side by side.
const LANES: usize = 8;

/// A complex value of size 1 that turns by an angle a step.
struct Turning {
    /// Values at the steps from -8 to 7.
    first: [C64; 2 * LANES],
    /// Twice the cosine of the turn of eight steps.
    twice_cosine: f64,
}

impl Turning {
    fn new(angle: f64, first: f64) -> Self {
        let at = |step: usize| C64::new(0.0, first + angle * (step as f64 - LANES as f64)).exp();
        Self { first: std::array::from_fn(at), twice_cosine: 2.0 * (angle * LANES as f64).cos() }
    }

    /// Adds the real parts of a value that turns to sums, one a step.
    ///
    /// `x[n+8] = 2 cos 8θ x[n] - x[n-8]`, within 1e-12 over 1500 steps.
    #[inline(always)]
    fn add(&self, value: C64, sums: &mut [[f64; LANES]]) {
        let (mut before, mut now) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            before[lane] = (self.first[lane] * value).re;
            now[lane] = (self.first[LANES + lane] * value).re;
        }
        for sums in sums {
            for lane in 0..LANES {
                sums[lane] += now[lane];
                let next = self.twice_cosine * now[lane] - before[lane];
                (before[lane], now[lane]) = (now[lane], next);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn values_turn_as_complex_ones_do() {
        let mut random = SplitMix64(5);
        let values: Vec<C64> = (0..7).map(|_| C64::new(random.uniform() - 0.5, random.uniform() - 0.5)).collect();
        let angles: Vec<f64> = (0..7).map(|_| 0.005 + random.uniform()).collect();
        let mut sums = vec![[0.0; LANES]; 1504 / LANES];
        values.iter().zip(&angles).for_each(|(value, angle)| Turning::new(*angle, 0.0).add(*value, &mut sums));
        for (step, sum) in sums.as_flattened().iter().enumerate() {
            let turned = |(value, angle): (&C64, &f64)| (value * C64::new(0.0, angle * step as f64).exp()).re;
            let exact: f64 = values.iter().zip(&angles).map(turned).sum();
            assert!((sum - exact).abs() < 1e-12, "step {step}: {sum} instead of {exact}");
        }
    }
}
