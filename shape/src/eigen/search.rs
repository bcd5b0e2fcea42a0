//! Search for the lowest modes: choice of σ, number of steps, count of what is found.

use super::factor::{Cholesky, Plan};
use super::lanczos::{Basis, Ritz};
use super::mass::Mass;
use super::{EigenError, Modes};

/// Relative gap, (λ' − λ) / (λ' − σ), between two values that are not of one multiplet.
pub(super) const GAP: f64 = 1e-6;

/// Greatest width of a block.
pub(super) const WIDEST: usize = 24;

/// Width of the first block.
pub(super) const BLOCK: usize = 6;

/// Residual that a found eigenpair may leave, relative to its θ; the error of θ is its square.
const LEFT: f64 = 1e-9;

/// First shift without a guess, relative to the scale of high eigenvalues.
const FIRST_SHIFT: f64 = 1e-8;

/// Limit below which a value counts as zero, relative to the scale of high eigenvalues.
const ZERO: f64 = 1e-12;

/// Steps that tell the scale of the lowest eigenvalues.
const SCALE_STEPS: usize = 12;

/// Share of the greatest θ below which Rayleigh's quotient can be better than θ.
const FAR: f64 = 1e-5;

/// Inverse of K − σ M.
struct Inverse<'a> {
    shift: f64,
    /// Factor of K − σ M; `None` while its memory serves another one.
    factor: Option<Cholesky<'a>>,
}

/// Limit above the lowest values, and the number of eigenvalues below it.
struct Count {
    limit: f64,
    counted: usize,
}

/// Finds the lowest `number` modes and returns those up to `highest`.
///
/// `guess` is an estimate of the lowest value above zero.
pub(super) fn lowest(plan: &Plan<'_>, number: usize, highest: f64, guess: Option<f64>) -> Result<Modes, EigenError> {
    if number == 0 {
        let limit = if highest.is_finite() { highest } else { f64::NEG_INFINITY };
        return Ok(Modes { count_limit: limit, ..Modes::default() });
    }
    let size = plan.problem().size;
    let mass = Mass::of(plan.problem());
    let mut inverse = choose_shift(plan, &mass, guess)?;
    let mut basis = Basis::new(plan.problem(), &mass, BLOCK.min(size))?;
    let most = size.min(8 * number + 50 * BLOCK);
    // Most searches end about here.
    let mut goal = number + 3 * number / 2 + 4 * BLOCK;
    let mut count: Option<Count> = None;
    loop {
        while basis.len() < goal.min(size) && !basis.is_full() {
            basis.expand(inverse.factor(plan)?)?;
        }
        let ritz = basis.ritz()?;
        let found = ritz.found();
        if count.is_none()
            && let Some((below, limit)) = inverse.gap(&ritz, number, size)
        {
            // The factor for the count would be a second one; hardly any search goes on after it.
            inverse.factor = None;
            let counted = plan.count_below(limit)?;
            if counted > below {
                basis.widen((counted - below).min(WIDEST - basis.width()))?;
            }
            count = Some(Count { limit, counted });
        }
        let missed = |counted| EigenError::Missed { found, counted };
        if let Some(Count { limit, counted }) = count {
            let below = ritz.values.iter().take_while(|&&theta| theta > 0.0 && inverse.value(theta) < limit).count();
            if below > counted {
                return Err(EigenError::Missed { found: below, counted });
            }
            if below == counted && found >= below {
                return Ok(collect(plan, &inverse, &basis, &ritz, (number, highest), (limit, counted)));
            }
            if basis.is_full() || basis.len() >= most {
                return Err(missed(counted));
            }
        } else if basis.is_full() || basis.len() >= most {
            return Err(missed(number));
        }
        goal = basis.len() + (basis.len() / 8).max(basis.width());
    }
}

fn collect(
    plan: &Plan<'_>,
    inverse: &Inverse<'_>,
    basis: &Basis<'_>,
    ritz: &Ritz,
    (number, highest): (usize, f64),
    (count_limit, counted): (f64, usize),
) -> Modes {
    let mut pairs: Vec<(f64, Vec<f64>)> = basis
        .vectors(ritz, number.min(ritz.values.len()))
        .into_iter()
        .zip(&ritz.values)
        .map(|(vector, &theta)| (inverse.refined(plan, &vector, theta, ritz.values[0]), vector))
        .collect();
    pairs.sort_by(|one, other| one.0.total_cmp(&other.0));
    pairs.retain(|(value, _)| *value <= highest);
    let (values, vectors) = pairs.into_iter().unzip();
    let next = ritz.values.get(number).filter(|&&theta| theta > 0.0).map(|&theta| inverse.value(theta));
    Modes { values, vectors, counted, count_limit, next }
}

/// Chooses a shift below zero by about the lowest eigenvalue that is not zero.
fn choose_shift<'a>(plan: &'a Plan<'_>, mass: &Mass, guess: Option<f64>) -> Result<Inverse<'a>, EigenError> {
    let scale = plan.problem().scale();
    if scale <= 0.0 {
        return Ok(Inverse { shift: -1.0, factor: None });
    }
    let mut shift = -guess.unwrap_or(FIRST_SHIFT * scale);
    let mut factor = plan.cholesky(shift)?;
    for _ in 0..3 {
        let mut basis = Basis::new(plan.problem(), mass, 1)?;
        while basis.len() < SCALE_STEPS && !basis.is_full() {
            basis.expand(&mut factor)?;
        }
        let ritz = basis.ritz()?;
        let mut values = ritz.values.iter().filter(|&&theta| theta > 0.0).map(|theta| shift + 1.0 / theta);
        let Some(lowest) = values.find(|&value| value > ZERO * scale) else { break };
        if (1e-2..=4.0).contains(&(-shift / lowest)) {
            break;
        }
        let close = -shift < 100.0 * lowest;
        shift = -lowest;
        drop(factor);
        factor = plan.cholesky(shift)?;
        if close {
            break;
        }
    }
    Ok(Inverse { shift, factor: Some(factor) })
}

impl Ritz {
    /// Returns how many of the first eigenpairs are found.
    fn found(&self) -> usize {
        let pairs = self.values.iter().zip(&self.residuals);
        pairs.take_while(|&(&theta, &left)| theta > 0.0 && left <= LEFT * theta).count()
    }
}

impl<'a> Inverse<'a> {
    /// Returns the factor, made anew if it was given up.
    fn factor(&mut self, plan: &'a Plan<'_>) -> Result<&mut Cholesky<'a>, EigenError> {
        let factor = self.factor.take().map_or_else(|| plan.cholesky(self.shift), Ok)?;
        Ok(self.factor.insert(factor))
    }

    /// Returns λ of an eigenvalue θ = 1 / (λ − σ).
    fn value(&self, theta: f64) -> f64 {
        self.shift + 1.0 / theta
    }

    /// Returns λ from θ or by Rayleigh's quotient, whichever has less rounding.
    fn refined(&self, plan: &Plan<'_>, vector: &[f64], theta: f64, greatest: f64) -> f64 {
        let value = self.value(theta);
        let of_inverse = greatest / (theta * theta);
        let of_quotient = 10.0 * plan.problem().scale();
        if theta < FAR * greatest && of_quotient < of_inverse { plan.problem().energy(vector) } else { value }
    }

    /// Finds the first gap after `number` values: how many lie below, and a limit within.
    fn gap(&self, ritz: &Ritz, number: usize, size: usize) -> Option<(usize, f64)> {
        let found = ritz.found();
        for below in number..=found {
            let theta = ritz.values[below - 1];
            if below == size {
                return Some((below, self.value(theta) + 0.5 / theta));
            }
            let (next, left) = (ritz.values.get(below)?.max(0.0), ritz.residuals[below]);
            let gap = theta - next;
            let rounding = 1e-13 * ritz.values[0];
            if gap > GAP * theta + rounding && left < 0.05 * gap {
                return Some((below, self.value(0.5 * (theta + next))));
            }
        }
        None
    }
}
