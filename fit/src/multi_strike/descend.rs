//! Maximum likelihood of all parameters together, by Gauss-Newton steps with Levenberg's damping.

use nalgebra::{Complex, DMatrix, DVector};

use super::arrow::Arrow;
use super::equations::{energy, equations, residual};
use super::model::{Model, Segment, segments};
use super::real_shapes::{directions, stepped};
use super::whitening::Whitening;
use crate::modes::Pole;

/// Condition under which a descent ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ending {
    /// Maximum number of steps tried.
    pub(crate) steps: usize,
    /// Least promised gain of a step, as a share of one sample's noise power.
    pub(crate) gain: f64,
}

impl Ending {
    /// Descent good enough to search the residual.
    pub(crate) const COARSE: Self = Self { steps: 14, gain: 3.0 };
    /// Descent of a model with positions, which starts farther off than one without, good enough to
    /// search the residual.
    pub(crate) const COARSE_AT_PLACES: Self = Self { steps: 28, ..Self::COARSE };
    /// Descent good enough to see which modes and strikes explain something.
    pub(crate) const COMPLETION: Self = Self { steps: 14, gain: 0.1 };
    /// Descent to a tenth of the statistical error of any parameter.
    pub(crate) const FINE: Self = Self { steps: 30, gain: 1e-2 };
}

/// Time in seconds behind a contact in which its fit is looked at.
const LOOKED_AT_S: f64 = 0.03;

/// A model with what it leaves of the recording.
#[derive(Clone, Debug)]
pub(crate) struct Fitted {
    pub(crate) model: Model,
    pub(crate) residual: Vec<f64>,
    /// Energy of the whitened residual.
    pub(crate) energy: f64,
}

impl Fitted {
    /// A model beside a recording.
    pub(crate) fn new(model: Model, samples: &[f64], whitening: &Whitening) -> Self {
        let residual = residual(&model, samples);
        let energy = energy(&residual, whitening);
        Self { model, residual, energy }
    }

    /// Rms of the whitened residual.
    pub(crate) fn noise_rms(&self) -> f64 {
        (self.energy / self.residual.len().max(1) as f64).sqrt()
    }

    /// Power of all that is left.
    pub(super) fn mean_power(&self) -> f64 {
        self.residual.iter().map(|x| x * x).sum::<f64>() / self.residual.len().max(1) as f64
    }

    /// Power that is left within the contacts.
    pub(super) fn left_in_contacts(&self) -> f64 {
        let segments = segments(&self.model.strikes, self.residual.len(), 0);
        let within = || segments.iter().flat_map(|segment| &self.residual[segment.start..segment.free]);
        within().map(|x| x * x).sum::<f64>() / within().count().max(1) as f64
    }

    /// Power that is left behind each strike, and the median of all strikes.
    pub(crate) fn left_behind(&self, rate_hz: f64) -> (Vec<f64>, f64) {
        let length = (LOOKED_AT_S * rate_hz) as usize;
        let of_segment = |segment: &Segment| {
            let behind = &self.residual[segment.start..segment.end.min(segment.free + length)];
            let power = behind.iter().map(|x| x * x).sum::<f64>() / behind.len().max(1) as f64;
            segment.strikes.clone().map(move |_| power.max(1e-30))
        };
        let segments = segments(&self.model.strikes, self.residual.len(), 0);
        let powers: Vec<f64> = segments.iter().flat_map(of_segment).collect();
        let mut sorted = powers.clone();
        sorted.sort_by(f64::total_cmp);
        let median = sorted.get(sorted.len() / 2).copied().unwrap_or(1e-30);
        (powers, median)
    }

    /// Normal equations at the model, with the unit of force held.
    pub(crate) fn equations(&self, whitening: &Whitening) -> Arrow {
        let mut arrow = equations(&self.model, &self.residual, whitening, self.noise_rms());
        if !self.model.strikes.is_empty() {
            arrow.hold(self.model.strike_size() * self.model.strongest() + 2);
        }
        if self.model.contact_times_are_held {
            (0..self.model.strikes.len()).for_each(|index| arrow.hold(self.model.strike_size() * index + 1));
        }
        for end in self.model.ends().into_iter().flatten() {
            arrow.hold(self.model.strike_size() * end + 3);
        }
        if self.model.acceleration == 0.0 {
            arrow.hold_shared(self.model.shared_size() - 1);
        }
        if self.model.shapes_are_real { arrow.along(directions(&self.model)) } else { arrow }
    }
}

/// Descends from a model to the nearest maximum of the likelihood.
pub(crate) fn descend(from: Fitted, samples: &[f64], whitening: &Whitening, ending: Ending) -> Fitted {
    let mut best = from;
    let (mut damping, mut tried) = (1e-3, 0);
    while tried < ending.steps && !best.model.strikes.is_empty() && !best.model.poles.is_empty() {
        let arrow = best.equations(whitening);
        // Largest damping at which a step from here was no better.
        let (mut accepted, mut refused) = (false, 0.0f64);
        while tried < ending.steps && !accepted {
            tried += 1;
            let Some(factor) = arrow.factor(damping) else {
                damping = (damping * 10.0f64).max(1e-6);
                if damping > MOST_DAMPING {
                    return best;
                }
                continue;
            };
            let step = arrow.solve(&factor);
            if arrow.promise(&step) < ending.gain * best.energy / samples.len() as f64 {
                // Damping hides what a direction promises that the sound hardly tells.
                damping *= 0.01;
                if damping <= refused.max(LEAST_DAMPING) {
                    return best;
                }
                continue;
            }
            let next = Fitted::new(moved(&best.model, &step.0, &arrow.step_of_all_shared(&step.1)), samples, whitening);
            if next.energy < best.energy {
                best = next;
                damping = (damping * 0.1).max(LEAST_DAMPING);
                accepted = true;
            } else {
                refused = refused.max(damping);
                damping = (damping * 10.0).max(1e-6);
            }
            if damping > MOST_DAMPING {
                return best;
            }
        }
    }
    best
}

/// Damping that changes no step, but keeps the equations definite.
const LEAST_DAMPING: f64 = 1e-12;
/// Damping at which no step helps any more.
const MOST_DAMPING: f64 = 1e6;
/// Largest change of a contact's middle in a step, relative to its contact time.
const MOST_SHIFT: f64 = 0.3;
/// Largest change of ln τ and of ln m in a step.
const MOST_GROWTH: [f64; 2] = [0.4, 0.7];
/// Largest change of a gain, relative to it, that turns and scales it.
const MOST_TURN: f64 = 1.5;
/// Contact times in samples that a step may reach.
const CONTACT_TIMES: [f64; 2] = [2.0, 2_000.0];
/// Decays in 1/sample that a step may reach.
const DECAYS: [f64; 2] = [3e-6, 0.3];

fn moved(model: &Model, along: &DVector<f64>, shared: &DVector<f64>) -> Model {
    let mut next = model.clone();
    let size = model.strike_size();
    for (index, strike) in next.strikes.iter_mut().enumerate() {
        let step = along.rows(index * size, size);
        let contact = &mut strike.contact;
        let reach = MOST_SHIFT * contact.time;
        contact.middle += step[0].clamp(-reach, reach);
        let grown = contact.time * step[1].clamp(-MOST_GROWTH[0], MOST_GROWTH[0]).exp();
        contact.time = grown.clamp(CONTACT_TIMES[0], CONTACT_TIMES[1]);
        contact.peak *= step[2].clamp(-MOST_GROWTH[1], MOST_GROWTH[1]).exp();
        if size > 3 {
            strike.position = (strike.position + step[3].clamp(-0.2, 0.2)).clamp(0.0, 1.0);
        }
    }
    next.strikes.sort_by(|a, b| a.contact.middle.total_cmp(&b.contact.middle));
    for (mode, pole) in next.poles.iter_mut().enumerate() {
        let reach = 3.0 * pole.decay + 1e-4;
        *pole = Pole {
            decay: (pole.decay + shared[2 * mode])
                .clamp(pole.decay / 4.0, pole.decay * 4.0)
                .clamp(DECAYS[0], DECAYS[1]),
            angular: (pole.angular + shared[2 * mode + 1].clamp(-reach, reach))
                .clamp(1e-4, std::f64::consts::PI - 1e-4),
        };
        let first = model.gain_column(mode);
        if model.shapes_are_real && model.gains[mode].len() > 1 {
            let step: Vec<Complex<f64>> = (0..model.gains[mode].len())
                .map(|place| Complex::new(shared[first + 2 * place], shared[first + 2 * place + 1]))
                .collect();
            next.gains[mode] = stepped(&model.gains[mode], &step);
            continue;
        }
        for (place, gain) in next.gains[mode].iter_mut().enumerate() {
            let step = Complex::new(shared[first + 2 * place], shared[first + 2 * place + 1]);
            // All contacts may be late by one time; the gains then turn by large angles.
            *gain = if step.norm() < MOST_TURN * gain.norm() { *gain * (step / *gain).exp() } else { *gain + step };
        }
    }
    next.acceleration += shared[shared.len() - 1];
    next
}

/// Damping under which equations are definite in spite of rounding.
const UNTOLD: f64 = 1e-9;

/// Standard deviations of all parameters in the noise that a model leaves.
#[derive(Clone, Debug)]
pub(crate) struct Deviations {
    /// Standard deviations of decay and angular frequency of each mode, per sample.
    pub(crate) poles: Vec<[f64; 2]>,
    /// Standard deviation of ln |g| of each gain, mode by mode and place by place.
    pub(crate) gains: Vec<Vec<f64>>,
    /// Standard deviation of the factor from force to acceleration sound.
    pub(crate) acceleration: f64,
    /// Covariance of middle, ln τ and ln m (and position) of each strike.
    pub(crate) strikes: Vec<DMatrix<f64>>,
    /// Standard deviation of ln m of each strike with modes and gains held.
    ///
    /// Peaks of all strikes together may be uncertain, as they are up to a function of the
    /// position, while each strike stands out.
    pub(crate) held_peaks: Vec<f64>,
    /// Standard deviation of ln |g| of each gain with all strikes held.
    ///
    /// Gains of all modes together may be uncertain where peaks are, while each mode stands out.
    pub(crate) held_gains: Vec<Vec<f64>>,
}

/// Cramer-Rao bounds of a model in its whitened residual, with that noise's rms.
///
/// `None` if two modes or two strikes cannot be told apart.
pub(crate) fn deviations(fitted: &Fitted, whitening: &Whitening) -> Option<Deviations> {
    let arrow = fitted.equations(whitening);
    // A number that the sound does not determine gets a large deviation.
    let factor = arrow.factor(0.0).or_else(|| arrow.factor(UNTOLD))?;
    let variance = fitted.noise_rms().powi(2);
    let shared = arrow.of_all_shared(factor.shared_covariance()) * variance;
    let model = &fitted.model;
    let mut strikes: Vec<DMatrix<f64>> =
        factor.covariances(model.strike_size()).into_iter().map(|block| block * variance).collect();
    let held = factor.held_variances(model.strike_size(), 2);
    // The strongest strike fixes the unit of force.
    if let Some(held) = strikes.get_mut(model.strongest()) {
        held.row_mut(2).fill(0.0);
        held.column_mut(2).fill(0.0);
    }
    let acceleration =
        if model.acceleration == 0.0 { 0.0 } else { shared[(shared.nrows() - 1, shared.nrows() - 1)].sqrt() };
    let held_shared = arrow.held_shared_covariance(UNTOLD).map_or_else(|| shared.clone(), |held| held * variance);
    Some(Deviations {
        poles: (0..model.poles.len()).map(|mode| [2 * mode, 2 * mode + 1].map(|at| shared[(at, at)].sqrt())).collect(),
        gains: gain_spreads(model, &shared),
        held_gains: gain_spreads(model, &held_shared),
        acceleration,
        strikes,
        held_peaks: held.into_iter().map(|held| (held * variance).sqrt()).collect(),
    })
}

/// Standard deviations of ln |g| of all gains for a covariance of the shared parameters.
fn gain_spreads(model: &Model, shared: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let of_gain = |mode: usize, place: usize| {
        let (gain, first) = (model.gains[mode][place], model.gain_column(mode) + 2 * place);
        let direction = [gain.re / gain.norm_sqr(), gain.im / gain.norm_sqr()];
        let along = |a: usize, b: usize| direction[a] * direction[b] * shared[(first + a, first + b)];
        (along(0, 0) + 2.0 * along(0, 1) + along(1, 1)).sqrt()
    };
    let of_mode = |mode: usize| (0..model.gains[mode].len()).map(|place| of_gain(mode, place)).collect();
    (0..model.poles.len()).map(of_mode).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::contact::Contact;
    use crate::multi_strike::model::Strike;
    use crate::multi_strike::synthetic::plain;
    use crate::multi_strike::truth::model_of;
    use crate::random::SplitMix64;

    fn random_model(random: &mut SplitMix64, places: usize, strikers: usize) -> Model {
        let mut poles: Vec<Pole> = Vec::new();
        for index in 0..4 {
            let angular = 0.1 + 0.31 * f64::from(index) + 0.05 * random.uniform();
            poles.push(Pole { decay: 2e-3 * (1.0 + f64::from(index)), angular });
        }
        let own = poles.split_off(3)[0];
        let mut gains = vec![Vec::new(); 3];
        for gains in &mut gains {
            gains.extend((0..places).map(|_| Complex::new(random.normal(), random.normal())));
        }
        let strikes = [100.3, 420.7, 450.1, 800.2].map(|middle| Strike {
            contact: Contact {
                middle: middle + random.uniform(),
                time: 20.0 + 15.0 * random.uniform(),
                peak: 0.2 + random.uniform(),
            },
            position: 0.1 + 0.8 * random.uniform(),
            striker: 0,
        });
        let owners = vec![None; 3];
        let mut model = Model {
            poles,
            gains,
            owners,
            acceleration: 0.7,
            contact_times_are_held: false,
            shapes_are_real: false,
            strikes: strikes.to_vec(),
        };
        if strikers > 1 {
            model.strikes[1].striker = 1;
            model.push(own, Complex::new(0.6, -0.8), Some(1));
        }
        model
    }

    #[test]
    fn gradient_of_the_energy_agrees_with_central_differences() {
        for (seed, places, strikers) in [(1, 1, 1), (2, 1, 2), (3, 3, 1), (4, 6, 2)] {
            let mut random = SplitMix64(seed);
            let model = random_model(&mut random, places, strikers);
            let samples: Vec<f64> = (0..1200).map(|_| random.normal()).collect();
            let whitening = Whitening::of_residual(&samples, 5);
            let fitted = Fitted::new(model.clone(), &samples, &whitening);
            let arrow = equations(&model, &fitted.residual, &whitening, 0.0);
            let (along, shared) = arrow.right_sides();
            let (count, all) = (along.len(), along.len() + shared.len());
            for index in 0..all {
                let size = 1e-6;
                let at = |size: f64| {
                    let mut step = DVector::zeros(all);
                    step[index] = size;
                    let (along, shared) =
                        (step.rows(0, count).into_owned(), step.rows(count, all - count).into_owned());
                    Fitted::new(moved(&model, &along, &shared), &samples, &whitening).energy
                };
                let slope = (at(-size) - at(size)) / (4.0 * size);
                let given = if index < count { along[index] } else { shared[index - count] };
                assert!((given - slope).abs() < 1e-6 * (given.abs() + 300.0), "{places} {index}: {given} {slope}");
            }
        }
    }

    #[test]
    fn descent_from_nearby_reaches_the_truth_within_its_deviations() {
        let sound = plain(3, 4.0, 6, -60.0);
        let rate = sound.rate_hz;
        let truth = model_of(&sound);
        let mut start = truth.clone();
        for (index, strike) in start.strikes.iter_mut().enumerate() {
            strike.contact.middle += 0.8 - index as f64 * 0.3;
            strike.contact.time *= 1.05 - 0.02 * index as f64;
            strike.contact.peak *= 0.95 + 0.02 * index as f64;
        }
        start.poles.iter_mut().for_each(|pole| pole.decay *= 1.05);
        let whitening = Whitening::none();
        let fitted = descend(Fitted::new(start, &sound.samples, &whitening), &sound.samples, &whitening, Ending::FINE);
        assert!((fitted.noise_rms() / sound.noise_rms - 1.0).abs() < 0.01, "{}", fitted.noise_rms());
        let bounds = deviations(&fitted, &whitening).expect("modes and strikes differ");
        let mut errors = Vec::new();
        for ((found, truth), deviation) in fitted.model.strikes.iter().zip(&truth.strikes).zip(&bounds.strikes) {
            errors.push((found.contact.middle - truth.contact.middle) / deviation[(0, 0)].sqrt());
            errors.push((found.contact.time / truth.contact.time).ln() / deviation[(1, 1)].sqrt());
        }
        for ((found, truth), deviation) in fitted.model.poles.iter().zip(&truth.poles).zip(&bounds.poles) {
            errors.push((found.decay - truth.decay) / deviation[0]);
            errors.push(
                (found.frequency_hz(rate) - truth.frequency_hz(rate)) * std::f64::consts::TAU / rate / deviation[1],
            );
        }
        let within = errors.iter().filter(|error| error.abs() < 1.0).count() as f64 / errors.len() as f64;
        assert!((0.5..0.9).contains(&within), "{within}: {errors:?}");
    }
}
