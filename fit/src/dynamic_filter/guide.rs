//! What loops round a filter add to the noise that feeds them.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;
use reference::waveguide::Tuned;

use super::lattice::squared;
use super::response::{NOISE_DENSITY, response};
use super::sound::RATE;
use super::stability::through as through_loop;
use super::waveguide::delay_s;
use super::{Coefficients, Loop, RATE_HZ};

/// Steps of the search for a mode's pole.
const POLE_STEPS: usize = 2;
/// Stability is looked at every so many times.
const CROWDING_EVERY: usize = 3;
/// Stability is looked at, beside the loops' own, at these frequencies in Hz.
const PLACES_HZ: [f64; 28] = [
    0.5, 10.0, 40.0, 100.0, 160.0, 250.0, 400.0, 630.0, 800.0, 1000.0, 1250.0, 1600.0, 2000.0, 2500.0, 3150.0, 4000.0,
    5000.0, 6300.0, 8000.0, 9500.0, 11_000.0, 13_000.0, 15_000.0, 17_000.0, 19_000.0, 21_000.0, 22_500.0, 23_900.0,
];

/// A delay may be longer than the shortest by so much, seconds.
const LONGER_S: f64 = 2e-3;
/// Beyond this ratio of frequencies, as a logarithm, a loop is not wanted.
const ELSEWHERE: f64 = 0.2;

/// A loop as the descent sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Guide {
    /// f_c in Hz.
    pub(crate) frequency_hz: f64,
    /// Δf in Hz.
    pub(crate) bandwidth_hz: f64,
    /// γ_s times the usual `|F|` there, its mean over times.
    pub(crate) loop_gain: f64,
    /// d_s in seconds.
    pub(crate) delay_s: f64,
}

impl Guide {
    /// Half the width of its band in radians a second: by eq. 10 and 11 it shrinks by sin ω/ω towards half the rate.
    pub(crate) fn beta_per_s(&self) -> f64 {
        let angular = TAU * self.frequency_hz / RATE_HZ;
        PI * self.bandwidth_hz * angular.sin() / angular
    }

    fn of_unit_gain(&self) -> Tuned {
        let Self { frequency_hz, bandwidth_hz, delay_s, .. } = *self;
        Loop { frequency_hz, bandwidth_hz, gain: 1.0, delay_s }.exact().tuned(RATE)
    }
}

/// The mean of `|F|` over times: unlike the largest one it changes smoothly.
fn usual(filter: &[Complex<f64>]) -> f64 {
    (filter.iter().map(|filter| filter.norm()).sum::<f64>() / filter.len().max(1) as f64).max(f64::MIN_POSITIVE)
}

/// How much larger the usual `|F|` is at a frequency in Hz than the last.
pub(crate) fn usual_over_last(frequency_hz: f64, filters: &[Coefficients]) -> f64 {
    let over_time: Vec<_> = filters.iter().map(|filter| response(filter, TAU * frequency_hz / RATE_HZ)).collect();
    usual(&over_time) / over_time.last().map_or(1.0, |last| last.norm().max(f64::MIN_POSITIVE))
}

/// What all loops do along a path.
pub(crate) struct Guided {
    /// `[loop][time]`: what each adds to the noise's power in a band that hears all of it.
    pub(crate) powers: Vec<Vec<f64>>,
    /// `|F| Σ|B_s|` at the centre of each loop and all over the spectrum, at every third time: what has to stay below 1.
    pub(crate) crowding: Vec<f64>,
}

/// Loops along filters.
pub(crate) struct Guides<'a> {
    guides: &'a [Guide],
    /// `[loop][other]`: `B D` of the other, of unit gain, at the loop's frequency.
    through: Vec<Vec<Complex<f64>>>,
    /// `[loop][time]`: F at the loop's frequency.
    filter: Vec<Vec<Complex<f64>>>,
    /// γ of each.
    gains: Vec<f64>,
    /// At frequencies all over the spectrum: `|B|` of each loop, of unit gain, and `|F|` at every third time.
    places: Vec<(Vec<f64>, Vec<f64>)>,
}

impl<'a> Guides<'a> {
    pub(crate) fn new(guides: &'a [Guide], filters: &[Coefficients]) -> Self {
        let tuned: Vec<Tuned> = guides.iter().map(Guide::of_unit_gain).collect();
        let angular = |guide: &Guide| TAU * guide.frequency_hz / RATE_HZ;
        let through = guides
            .iter()
            .map(|guide| tuned.iter().map(|other| through_loop(other, angular(guide))).collect())
            .collect();
        let filter: Vec<Vec<Complex<f64>>> = guides
            .iter()
            .map(|guide| filters.iter().map(|filter| response(filter, angular(guide))).collect())
            .collect();
        let gains = guides.iter().zip(&filter).map(|(guide, filter)| guide.loop_gain / usual(filter)).collect();
        let place = |frequency_hz: f64| {
            let angular = TAU * frequency_hz / RATE_HZ;
            let of_loops = tuned.iter().map(|tuned| through_loop(tuned, angular).norm()).collect();
            let few = filters.iter().step_by(CROWDING_EVERY);
            (of_loops, few.map(|filter| squared(filter)(angular.cos()).sqrt()).collect())
        };
        let places = if guides.is_empty() { Vec::new() } else { PLACES_HZ.into_iter().map(place).collect() };
        Self { guides, through, filter, gains, places }
    }

    /// F at a loop's frequency with all other loops round it.
    fn with_others(&self, index: usize, filter: Complex<f64>) -> Complex<f64> {
        let others = self.through[index].iter().zip(&self.gains).enumerate().filter(|(other, _)| *other != index);
        let others: Complex<f64> = others.map(|(_, (through, gain))| through * *gain).sum();
        filter / (Complex::new(1.0, 0.0) - filter * others)
    }

    /// Powers at `times_s` for noise whose power is `noise` times the full one.
    ///
    /// Each loop's mode is a pole s of the filter with all loops round it: `β + s = β q e^{-s d}` with β = πΔf, q = γ B D F~, F~ the filter with the
    /// other loops round it, d the delay. Its envelope y in noise e of density S obeys `y' = s y + R e`, `R = (β + s)/(1 + d(β + s))`, so
    /// `P = E|y|²` obeys `P' = 2 Re s P + |R|² S`. What is heard is `|F~|²(P + Re R S)`: the mode, and what it has in common with the noise that
    /// feeds it.
    pub(crate) fn along(&self, times_s: &[f64], noise: &[f64]) -> Guided {
        let powers = (0..self.guides.len()).map(|index| self.one(index, times_s, noise)).collect();
        let crowding = self.through.iter().zip(&self.filter).flat_map(|(through, filter)| {
            let of_loops: f64 = through.iter().zip(&self.gains).map(|(through, gain)| through.norm() * gain).sum();
            filter.iter().step_by(CROWDING_EVERY).map(move |filter| filter.norm() * of_loops)
        });
        let elsewhere = self.places.iter().flat_map(|(through, filter)| {
            let of_loops: f64 = through.iter().zip(&self.gains).map(|(through, gain)| through * gain).sum();
            filter.iter().map(move |filter| filter * of_loops)
        });
        let crowding = crowding.chain(elsewhere);
        Guided { powers, crowding: crowding.collect() }
    }

    fn one(&self, index: usize, times_s: &[f64], noise: &[f64]) -> Vec<f64> {
        let guide = &self.guides[index];
        let beta = guide.beta_per_s();
        let own = self.through[index][index] * self.gains[index];
        let delay_s = (guide.delay_s * RATE_HZ).floor() / RATE_HZ;
        let (mut power, mut before) = (0.0, None);
        let mut powers = Vec::with_capacity(times_s.len());
        for ((time_s, filter), noise) in times_s.iter().zip(&self.filter[index]).zip(noise) {
            let filter = self.with_others(index, *filter);
            let q = own * filter;
            let mut pole = -(Complex::new(1.0, 0.0) - q) * beta / (q * (beta * delay_s) + 1.0);
            for _ in 0..POLE_STEPS {
                let back = q * beta * (-pole * delay_s).exp();
                pole -= (pole + beta - back) / (back * delay_s + 1.0);
            }
            let fed = (pole + beta) / ((pole + beta) * delay_s + 1.0);
            let density = NOISE_DENSITY * noise;
            let now = (-2.0 * pole.re, fed.norm_sqr() * density);
            if let Some((before_s, (rate, source))) = before {
                let (rate, source): (f64, f64) = (0.5 * (rate + now.0), 0.5 * (source + now.1));
                let lasts_s = time_s - before_s;
                // (1 - e^{-x})/x, which is 1 where x is small.
                let x: f64 = rate * lasts_s;
                let gathered = if x.abs() < 1e-6 { 1.0 } else { -(-x).exp_m1() / x };
                power = power * (-x).exp() + source * lasts_s * gathered;
            }
            before = Some((*time_s, now));
            powers.push(filter.norm_sqr() * (power + fed.re * density).max(0.0));
        }
        powers
    }

    /// γ_s of each loop.
    pub(crate) fn gains(&self) -> &[f64] {
        &self.gains
    }

    /// The delays by which each loop is in phase with the filter as it is while its mode, of decays `decays_per_s`, is heard (eq. 22).
    pub(crate) fn tuned_delays_s(&self, times_s: &[f64], decays_per_s: &[f64]) -> Vec<f64> {
        let tuned = self.guides.iter().zip(decays_per_s).enumerate().map(|(index, (guide, decay))| {
            let mut turned = Complex::new(0.0, 0.0);
            for (filter, times) in self.filter[index].iter().zip(times_s.windows(2)) {
                let heard = (-decay * times[0]).exp() * (times[1] - times[0]);
                turned += self.with_others(index, *filter) * heard;
            }
            self.quietest(guide, delay_s(guide.frequency_hz, turned.arg()))
        });
        tuned.collect()
    }

    /// The delay, of those with a few turns more, with which a loop gains least where the filter is loud and the loop is not wanted.
    ///
    /// The fraction of a delay is in the numerator of the band-pass, `c0 + c1 z^-1`: it decides where that has its zero. Round a low-pass a loop of a
    /// high frequency has hardly any gain to itself unless the zero is near 0 Hz.
    fn quietest(&self, guide: &Guide, shortest_s: f64) -> f64 {
        let unwanted = |delay_s: f64| {
            let tuned = Guide { delay_s, ..*guide }.of_unit_gain();
            let elsewhere = PLACES_HZ.iter().zip(&self.places);
            let elsewhere = elsewhere.filter(|(place_hz, _)| (*place_hz / guide.frequency_hz).ln().abs() > ELSEWHERE);
            let gain = |(place_hz, (_, filter)): (&f64, &(Vec<f64>, Vec<f64>))| {
                let loudest = filter.iter().copied().fold(0.0, f64::max);
                loudest * through_loop(&tuned, TAU * place_hz / RATE_HZ).norm()
            };
            elsewhere.map(gain).fold(0.0, f64::max)
        };
        let turns = (LONGER_S * guide.frequency_hz).clamp(0.0, 16.0) as i32;
        let delays_s = (0..=turns).map(|turn| shortest_s + f64::from(turn) / guide.frequency_hz);
        delays_s.min_by(|a, b| unwanted(*a).total_cmp(&unwanted(*b))).unwrap_or(shortest_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bark::{damping_law, frequency_hz};
    use crate::dynamic_filter::{Breakpoint, Model, Path, render};

    #[test]
    fn loops_that_turn_each_other_s_phase_ring_as_their_poles_say() {
        let filter = Coefficients { a: [-0.3, 0.0], b: [0.2, 0.1, 0.0] };
        let guide = |rate: f64, bandwidth_hz: f64, loop_gain: f64| {
            let frequency_hz = frequency_hz(rate);
            Guide { frequency_hz, bandwidth_hz, loop_gain, delay_s: delay_s(frequency_hz, -0.1) }
        };
        let mut guides = vec![guide(5.0, 40.0, 0.82), guide(7.0, 60.0, 0.75), guide(13.0, 30.0, 0.7)];
        let times_s: Vec<f64> = (0..400).map(|step| 1e-3 * f64::from(step)).collect();
        let filters = vec![filter; times_s.len()];
        let delays_s = Guides::new(&guides, &filters).tuned_delays_s(&times_s, &[10.0; 3]);
        guides.iter_mut().zip(delays_s).for_each(|(guide, delay_s)| guide.delay_s = delay_s);
        let noise: Vec<f64> = times_s.iter().map(|time_s| if *time_s < 0.02 { 1.0 } else { 0.0 }).collect();
        let all = Guides::new(&guides, &filters);
        let powers = all.along(&times_s, &noise).powers;
        let point = |time_s| Breakpoint { time_s, coefficients: filter, noise: 1.0 };
        let loops = guides.iter().zip(all.gains()).map(|(guide, gain)| Loop {
            frequency_hz: guide.frequency_hz,
            bandwidth_hz: guide.bandwidth_hz,
            gain: *gain,
            delay_s: guide.delay_s,
        });
        let model = Model { path: Path { points: vec![point(0.0), point(0.02)] }, loops: loops.collect(), modes: vec![] };
        let sound = render(&model, 48_000, 3);
        let law = damping_law(&sound[2400..], RATE_HZ).expect("it decays");
        for (guide, powers) in guides.iter().zip(&powers) {
            let expected = 0.5 * (powers[100] / powers[200]).ln() / 0.1;
            let alone = guide.beta_per_s() * (1.0 - guide.loop_gain);
            let found = law.decay_per_s(guide.frequency_hz);
            println!("{:.0} Hz: {found:.2} for {expected:.2} 1/s, alone {alone:.2}", guide.frequency_hz);
            assert!((found / expected - 1.0).abs() < 0.03, "{:.0} Hz: {found} for {expected}", guide.frequency_hz);
        }
    }
}
