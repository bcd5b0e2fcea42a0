//! Maximum-likelihood fit of exponentials and a floor.

use nalgebra::{DMatrix, DVector};

use super::blocks::Block;

/// A sum of exponentials and a floor: `p(t) = Σ a_k e^{-r_k t} + floor`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Decay {
    /// Power at t = 0 and decay of the power in 1/s (twice the amplitude's) of each exponential,
    /// fastest first.
    pub(crate) parts: Vec<(f64, f64)>,
    /// Power that does not decay.
    pub(crate) floor: f64,
    /// Mean over time of `ln m + p/m`; less is better.
    pub(crate) misfit: f64,
}

/// Power, relative to the loudest block, that counts as nothing: -140 dB.
const NOTHING: f64 = 1e-14;
/// Range of decay rates of the power in 1/s: T60 from 138 s to 1.4 ms.
const RATES_PER_S: (f64, f64) = (0.1, 1e4);
/// Number of rates at which the search starts.
const STARTS: usize = 6;
/// Maximum number of exponentials.
const MOST_PARTS: usize = 2;
/// Maximum number of steps.
const STEPS: usize = 60;

/// Fits `parts` exponentials and a floor.
///
/// `None` if there are fewer than three blocks for each number sought, or no power, or if `parts`
/// is not 1 or 2.
pub(crate) fn fit(blocks: &[Block], parts: usize) -> Option<Decay> {
    let loudest = blocks.iter().map(|block| block.power).fold(0.0, f64::max);
    let span_s = blocks.last()?.time_s - blocks.first()?.time_s;
    let is_known = (1..=MOST_PARTS).contains(&parts);
    if !is_known || blocks.len() < 3 * (2 * parts + 1) || loudest <= 0.0 || span_s <= 0.0 {
        return None;
    }
    let problem = Problem { blocks, nothing: loudest * NOTHING };
    let last = blocks.len() - (blocks.len() / 10).max(1);
    let tail = blocks[last..].iter().map(|block| block.power * block.length_s).sum::<f64>()
        / blocks[last..].iter().map(|block| block.length_s).sum::<f64>();
    // The slowest decays by about 1 dB over the whole time, the fastest over the whole range in a
    // fiftieth of it.
    let slowest = (0.3 / span_s).max(RATES_PER_S.0);
    let fastest = (600.0 / span_s).clamp(2.0 * slowest, RATES_PER_S.1);
    let rates: Vec<f64> =
        (0..STARTS).map(|step| slowest * (fastest / slowest).powf(step as f64 / (STARTS - 1) as f64)).collect();
    let starts: Vec<Vec<f64>> = match parts {
        1 => rates.iter().map(|rate| vec![*rate]).collect(),
        _ => {
            let pairs = rates
                .iter()
                .enumerate()
                .flat_map(|(index, slow)| rates[index + 1..].iter().map(|fast| vec![*fast, *slow]));
            pairs.collect()
        }
    };
    let mut best: Option<(f64, DVector<f64>)> = None;
    for rates in starts {
        for floor in [tail, tail * 1e-3] {
            let found = problem.descend(&problem.start(&rates, floor.max(problem.nothing), span_s));
            if best.as_ref().is_none_or(|best| found.0 < best.0) {
                best = Some(found);
            }
        }
    }
    let (misfit, numbers) = best?;
    let mut found: Vec<(f64, f64)> = (0..parts).map(|k| (numbers[2 * k].exp(), numbers[2 * k + 1].exp())).collect();
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    Some(Decay { parts: found, floor: numbers[2 * parts].exp(), misfit })
}

/// Misfit of the best constant, in the units of [`Decay::misfit`]; infinite without blocks.
pub(crate) fn constant_misfit(blocks: &[Block]) -> f64 {
    let length_s: f64 = blocks.iter().map(|block| block.length_s).sum();
    let mean = blocks.iter().map(|block| block.power * block.length_s).sum::<f64>() / length_s;
    if mean > 0.0 { mean.ln() + 1.0 } else { f64::INFINITY }
}

struct Problem<'a> {
    blocks: &'a [Block],
    nothing: f64,
}

impl Problem<'_> {
    /// Logarithms of powers, rates and floor from which the descent starts.
    ///
    /// The first part meets the first block. Each slower one meets the power at a time that follows
    /// from the rates.
    fn start(&self, rates: &[f64], floor: f64, span_s: f64) -> DVector<f64> {
        let mut numbers = Vec::with_capacity(2 * rates.len() + 1);
        for (k, rate) in rates.iter().enumerate() {
            let time_s = if k == 0 { 0.0 } else { (8.0 / rates[k - 1]).min(0.5 * span_s) };
            let from = self.blocks.partition_point(|block| block.time_s < time_s).min(self.blocks.len() - 1);
            let near = &self.blocks[from..self.blocks.len().min(from + 8)];
            let power = near.iter().map(|block| block.power * (rate * block.time_s).min(100.0).exp()).sum::<f64>()
                / near.len() as f64;
            numbers.extend([power.max(self.nothing).ln(), rate.ln()]);
        }
        numbers.push(floor.ln());
        DVector::from_vec(numbers)
    }

    /// Misfit, with gradient and expected curvature in the logarithms.
    fn look(&self, numbers: &DVector<f64>) -> (f64, DVector<f64>, DMatrix<f64>) {
        match numbers.as_slice().try_into() {
            Ok(numbers) => self.look_at::<3>(numbers),
            Err(_) => self.look_at::<{ 2 * MOST_PARTS + 1 }>(&std::array::from_fn(|k| numbers[k])),
        }
    }

    /// [`Self::look`] with a number of numbers that the compiler knows: it unrolls the loops.
    fn look_at<const COUNT: usize>(&self, numbers: &[f64; COUNT]) -> (f64, DVector<f64>, DMatrix<f64>) {
        let floor = numbers[COUNT - 1].exp();
        let mut rates = [0.0; MOST_PARTS];
        rates.iter_mut().zip(numbers.iter().skip(1).step_by(2)).for_each(|(rate, number)| *rate = number.exp());
        let (mut misfit, mut weights) = (0.0, 0.0);
        let (mut gradient, mut curvature, mut slope) = ([0.0; COUNT], [[0.0; COUNT]; COUNT], [0.0; COUNT]);
        for block in self.blocks {
            let mut mean = self.nothing + floor;
            slope[COUNT - 1] = floor;
            for k in 0..COUNT / 2 {
                let part = (numbers[2 * k] - rates[k] * block.time_s).exp();
                mean += part;
                slope[2 * k] = part;
                slope[2 * k + 1] = -part * rates[k] * block.time_s;
            }
            slope.iter_mut().for_each(|slope| *slope /= mean);
            let ratio = block.power / mean;
            misfit += block.length_s * (mean.ln() + ratio);
            weights += block.length_s;
            for column in 0..COUNT {
                gradient[column] += block.length_s * (1.0 - ratio) * slope[column];
                for row in 0..COUNT {
                    curvature[column][row] += block.length_s * slope[column] * slope[row];
                }
            }
        }
        let gradient = DVector::from_fn(COUNT, |k, _| gradient[k] / weights);
        (misfit / weights, gradient, DMatrix::from_fn(COUNT, COUNT, |row, column| curvature[column][row] / weights))
    }

    /// Fisher scoring with Levenberg's damping; returns the misfit and the numbers.
    fn descend(&self, start: &DVector<f64>) -> (f64, DVector<f64>) {
        let mut numbers = start.clone();
        let (mut misfit, mut gradient, mut curvature) = self.look(&numbers);
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let mut damped = curvature.clone();
            for k in 0..numbers.len() {
                damped[(k, k)] += damping * curvature[(k, k)] + 1e-12;
            }
            let Some(step) = damped.cholesky().map(|factors| factors.solve(&gradient)) else { break };
            let mut tried = &numbers - step.map(|x| x.clamp(-1.0, 1.0));
            for k in 0..numbers.len() / 2 {
                tried[2 * k + 1] = tried[2 * k + 1].clamp(RATES_PER_S.0.ln(), RATES_PER_S.1.ln());
            }
            let least = self.nothing.ln();
            let last = numbers.len() - 1;
            tried[last] = tried[last].max(least);
            let looked = self.look(&tried);
            if looked.0.is_finite() && looked.0 < misfit {
                let gained = misfit - looked.0;
                numbers = tried;
                (misfit, gradient, curvature) = looked;
                damping = (damping * 0.2).max(1e-9);
                if gained < 1e-10 {
                    break;
                }
            } else {
                damping *= 8.0;
                if damping > 1e8 {
                    break;
                }
            }
        }
        (misfit, numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::super::blocks::blocks;
    use super::*;
    use crate::random::SplitMix64;

    fn noise_power(length: usize, rate_hz: f64, seed: u64, mean: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut random = SplitMix64(seed);
        (0..length).map(|n| -mean(n as f64 / rate_hz) * (1.0 - random.uniform()).ln()).collect()
    }

    #[test]
    fn one_exponential_without_noise_is_found_exactly() {
        let power: Vec<f64> = (0..4000).map(|n| 0.04 * (-24.0 * f64::from(n) / 1000.0).exp()).collect();
        let decay = fit(&blocks(&power, 1000.0, 0.0, 4.0), 1).expect("enough blocks");
        assert!(
            (decay.parts[0].0 / 0.04 - 1.0).abs() < 0.01 && (decay.parts[0].1 / 24.0 - 1.0).abs() < 0.005,
            "{decay:?}"
        );
    }

    #[test]
    fn two_slopes_over_a_floor_are_told_apart() {
        for seed in 1..5 {
            let power = noise_power(6000, 2000.0, seed, |t| (-60.0 * t).exp() + 0.01 * (-9.0 * t).exp() + 1e-7);
            let decay = fit(&blocks(&power, 2000.0, 0.0, 3.0), 2).expect("enough blocks");
            let [fast, slow] = [decay.parts[0], decay.parts[1]];
            assert!((fast.1 / 60.0 - 1.0).abs() < 0.25 && (slow.1 / 9.0 - 1.0).abs() < 0.08, "{decay:?}");
            assert!(
                10.0 * (slow.0 / 0.01).log10().abs() < 1.0 && 10.0 * (decay.floor / 1e-7).log10().abs() < 1.0,
                "{decay:?}"
            );
        }
    }
}
