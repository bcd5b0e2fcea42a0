//! Joint refinement of all modes by variable projection: the maximum-likelihood estimate under
//! white noise.
//!
//! Gains enter linearly: for given poles they are solved for exactly. The remaining least-squares
//! problem in the poles is solved by Gauss-Newton steps (Kaufman's form) with Levenberg's damping.
//! All groups share the poles, or each has some of them. Each group has its own gains, which hold
//! for all stretches of the group.

use nalgebra::{Cholesky, Complex, DMatrix, DVector, Dyn};
use rayon::prelude::*;

use super::basis::{Basis, Stretch};
use super::pole::Pole;

/// Stretches of sound with common gains.
#[derive(Clone, Debug)]
pub(crate) struct Group<'a> {
    pub(crate) stretches: Vec<Stretch<'a>>,
}

impl<'a> Group<'a> {
    pub(crate) fn ringing(samples: &'a [f64]) -> Self {
        Self { stretches: vec![Stretch::ringing(samples)] }
    }

    pub(crate) fn sample_count(&self) -> usize {
        self.stretches.iter().map(|stretch| stretch.samples.len()).sum()
    }

    fn driven(&self) -> bool {
        self.stretches.iter().any(|stretch| stretch.force.is_some())
    }
}

/// Gains of one group.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gains {
    /// Gain of each pole: the sound is `Σ Re(gain u)`. The gain of a pole that a group lacks is 0.
    pub(crate) modes: Vec<Complex<f64>>,
    /// Gain of the force itself (acceleration sound); 0 if the modes ring freely.
    pub(crate) force: f64,
}

/// Poles, and the gains of each group.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    pub(crate) poles: Vec<Pole>,
    pub(crate) gains: Vec<Gains>,
    /// Growth of each group's residual energy without each pole, with the gains of the others
    /// refitted: pole by pole.
    pub(crate) worth_by_group: Vec<Vec<f64>>,
}

impl Model {
    /// Residual of the model in one stretch.
    pub(crate) fn residual(&self, group: usize, stretch: &Stretch<'_>) -> Vec<f64> {
        let mut left = stretch.samples.to_vec();
        let gains = &self.gains[group];
        for (&pole, gain) in self.poles.iter().zip(&gains.modes).filter(|(_, gain)| gain.norm_sqr() > 0.0) {
            Basis::new(pole, stretch).add(-gain, &mut left);
        }
        for (left, force) in left.iter_mut().zip(stretch.force.unwrap_or(&[])) {
            *left -= gains.force * force;
        }
        left
    }

    /// Growth of the residual energy of all groups without a pole.
    pub(crate) fn worth(&self, pole: usize) -> f64 {
        self.worth_by_group[pole].iter().sum()
    }

    /// Poles without those whose index is listed; gains and worth have to be found anew.
    pub(crate) fn without(&self, dropped: &[usize]) -> Vec<Pole> {
        let kept = self.poles.iter().enumerate().filter(|(index, _)| !dropped.contains(index));
        kept.map(|(_, pole)| *pole).collect()
    }
}

const ONE: Complex<f64> = Complex::new(1.0, 0.0);
const TURN: Complex<f64> = Complex::new(0.0, 1.0);

/// Normal equations of one group, solved for its gains at given poles.
struct Solved {
    bases: Vec<Vec<Basis>>,
    /// Inner products `Σ x v` of each stretch and pole.
    ramps: Vec<Vec<Complex<f64>>>,
    gains: Gains,
    factor: Cholesky<f64, Dyn>,
    residual_energy: f64,
}

/// Solves for the gains of a group: pairs of columns `Re u`, `-Im u` for the modes, then the force.
fn solve(group: &Group<'_>, poles: &[Pole], ridge: f64) -> Option<Solved> {
    let bases: Vec<Vec<Basis>> =
        group.stretches.iter().map(|stretch| poles.iter().map(|&pole| Basis::new(pole, stretch)).collect()).collect();
    let with_force = usize::from(group.driven());
    let size = 2 * poles.len() + with_force;
    let (mut normal, mut right) = (DMatrix::<f64>::zeros(size, size), DVector::<f64>::zeros(size));
    let mut energy: f64 = 0.0;
    let mut ramps = Vec::with_capacity(bases.len());
    for (stretch, bases) in group.stretches.iter().zip(&bases) {
        energy += stretch.energy();
        let mut ramps_here = Vec::with_capacity(bases.len());
        for (k, a) in bases.iter().enumerate() {
            let [along, ramp] = a.project(stretch.samples);
            ramps_here.push(ramp);
            right[2 * k] += along.re;
            right[2 * k + 1] -= along.im;
            for (l, b) in bases.iter().enumerate().take(k + 1) {
                let uu = a.products(b).uu;
                for (i, alpha) in [ONE, TURN].into_iter().enumerate() {
                    for (j, beta) in [ONE, TURN].into_iter().enumerate() {
                        normal[(2 * k + i, 2 * l + j)] += uu.real(alpha, beta);
                    }
                }
            }
            if let Some(force) = stretch.force {
                let [along, _] = a.along_force(force);
                normal[(size - 1, 2 * k)] += along.re;
                normal[(size - 1, 2 * k + 1)] -= along.im;
            }
        }
        if let Some(force) = stretch.force {
            right[size - 1] += force.iter().zip(stretch.samples).map(|(f, x)| f * x).sum::<f64>();
            normal[(size - 1, size - 1)] += force.iter().map(|f| f * f).sum::<f64>();
        }
        ramps.push(ramps_here);
    }
    for row in 0..size {
        for column in row + 1..size {
            normal[(row, column)] = normal[(column, row)];
        }
        normal[(row, row)] *= 1.0 + ridge;
    }
    // Two poles in one place must not fail: the diagonal is raised slightly until the matrix is
    // definite.
    let factor = [1e-13, 1e-10, 1e-7, 1e-4].into_iter().find_map(|hair| {
        let mut normal = normal.clone();
        (0..size).for_each(|row| normal[(row, row)] = normal[(row, row)] * (1.0 + hair) + f64::MIN_POSITIVE);
        Cholesky::new(normal)
    })?;
    let solution = factor.solve(&right);
    let residual_energy = (energy - solution.dot(&right)).max(energy * 1e-15);
    let modes = (0..poles.len()).map(|k| Complex::new(solution[2 * k], solution[2 * k + 1])).collect();
    let force = if with_force == 1 { solution[size - 1] } else { 0.0 };
    Some(Solved { bases, ramps, gains: Gains { modes, force }, factor, residual_energy })
}

/// Adds a group's share to the normal equations in `d` and `ω` of each pole, with gains projected
/// out.
fn add_pole_equations(group: &Group<'_>, solved: &Solved, normal: &mut DMatrix<f64>, right: &mut DVector<f64>) {
    let count = solved.gains.modes.len();
    let size = solved.factor.l_dirty().nrows();
    // ∂x/∂d = Re(-c v), ∂x/∂ω = Re(j c v).
    let slopes: Vec<[Complex<f64>; 2]> = solved.gains.modes.iter().map(|&c| [-c, TURN * c]).collect();
    let mut cross = DMatrix::zeros(size, 2 * count);
    let mut along = DVector::zeros(2 * count);
    for ((stretch, bases), ramps) in group.stretches.iter().zip(&solved.bases).zip(&solved.ramps) {
        for (k, (a, ramp)) in bases.iter().zip(ramps).enumerate() {
            for (i, alpha) in slopes[k].into_iter().enumerate() {
                along[2 * k + i] += (alpha * ramp).re;
            }
            if let Some(force) = stretch.force {
                let [_, ramp] = a.along_force(force);
                for (i, alpha) in slopes[k].into_iter().enumerate() {
                    cross[(size - 1, 2 * k + i)] += (alpha * ramp).re;
                }
            }
            for (l, b) in bases.iter().enumerate().take(k + 1) {
                let products = a.products(b);
                for (i, alpha) in slopes[k].into_iter().enumerate() {
                    for (j, beta) in slopes[l].into_iter().enumerate() {
                        let value = products.vv.real(alpha, beta);
                        normal[(2 * k + i, 2 * l + j)] += value;
                        if k != l {
                            normal[(2 * l + j, 2 * k + i)] += value;
                        }
                    }
                }
                for (i, unit) in [ONE, TURN].into_iter().enumerate() {
                    for (j, slope) in slopes[l].into_iter().enumerate() {
                        cross[(2 * k + i, 2 * l + j)] += products.uv.real(unit, slope);
                    }
                    if k != l {
                        for (j, slope) in slopes[k].into_iter().enumerate() {
                            cross[(2 * l + i, 2 * k + j)] += products.vu.real(slope, unit);
                        }
                    }
                }
            }
        }
    }
    let mut gains = DVector::zeros(size);
    for (k, gain) in solved.gains.modes.iter().enumerate() {
        (gains[2 * k], gains[2 * k + 1]) = (gain.re, gain.im);
    }
    if group.driven() {
        gains[size - 1] = solved.gains.force;
    }
    *right += along - cross.tr_mul(&gains);
    let lower = solved.factor.l_dirty();
    if lower.solve_lower_triangular_mut(&mut cross) {
        normal.gemm_tr(-1.0, &cross, &cross, 1.0);
    }
}

/// Condition under which a refinement ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ending {
    /// Maximum number of steps tried.
    pub(crate) steps: usize,
    /// Least promised gain of a step, as a share of one sample's noise power.
    pub(crate) gain: f64,
    /// Share of each mode's own energy that is added to the diagonal of the normal equations.
    ///
    /// 0 gives least squares. A share r bounds the gains of modes that are nearly alike, and lowers
    /// those of others by r.
    pub(crate) ridge: f64,
}

impl Ending {
    /// Refinement to a thousandth of the statistical error.
    pub(crate) const FINE: Self = Self { steps: 60, gain: 1e-6, ridge: 0.0 };
    /// Refinement good enough to search the residual for more modes.
    pub(crate) const COARSE: Self = Self { steps: 12, gain: 1e-2, ridge: 0.0 };
}

/// Refines poles that all groups have, and finds the gains of every group.
///
/// `None` if not even the given poles can be solved for.
pub(crate) fn refine(groups: &[Group<'_>], poles: &[Pole], ending: Ending) -> Option<Model> {
    let all: Vec<usize> = (0..poles.len()).collect();
    refine_shared(groups, &vec![all; groups.len()], poles, 0, ending)
}

/// Refines poles of which each group has some, and finds the gains of every group.
///
/// `members` lists the indices of the poles of each group. The first `known` poles do not move.
/// `None` if not even the given poles can be solved for.
pub(crate) fn refine_shared(
    groups: &[Group<'_>],
    members: &[Vec<usize>],
    poles: &[Pole],
    known: usize,
    ending: Ending,
) -> Option<Model> {
    let sample_count: usize = groups.iter().map(Group::sample_count).sum();
    let solve_all = |poles: &[Pole]| {
        let of_group = |(group, members): (&Group<'_>, &Vec<usize>)| {
            let own: Vec<Pole> = members.iter().map(|&member| poles[member]).collect();
            solve(group, &own, ending.ridge)
        };
        groups.par_iter().zip(members).map(of_group).collect::<Option<Vec<_>>>()
    };
    let energy_of = |solved: &[Solved]| solved.iter().map(|solved| solved.residual_energy).sum::<f64>();
    let mut poles = poles.to_vec();
    let mut solved = solve_all(&poles)?;
    let mut energy = energy_of(&solved);
    let (mut damping, mut tried) = (1e-3, 0);
    while tried < ending.steps && known < poles.len() {
        let (mut normal, mut right) = pole_equations(groups, members, &solved, poles.len());
        for index in 0..2 * known {
            normal.row_mut(index).fill(0.0);
            normal.column_mut(index).fill(0.0);
            (normal[(index, index)], right[index]) = (1.0, 0.0);
        }
        let mut accepted = false;
        while tried < ending.steps && !accepted {
            tried += 1;
            let mut damped = normal.clone();
            for index in 0..damped.nrows() {
                damped[(index, index)] *= 1.0 + damping;
                damped[(index, index)] += f64::MIN_POSITIVE;
            }
            let Some(factor) = Cholesky::new(damped) else {
                damping = (damping * 10.0).max(1e-6);
                continue;
            };
            let step = factor.solve(&right);
            if step.dot(&right) < ending.gain * energy / sample_count as f64 {
                break;
            }
            let moved = moved(&poles, &step);
            match solve_all(&moved) {
                Some(next) if energy_of(&next) < energy => {
                    energy = energy_of(&next);
                    (poles, solved) = (moved, next);
                    damping *= 0.1;
                    accepted = true;
                }
                _ => damping = (damping * 10.0).max(1e-6),
            }
        }
        if !accepted {
            break;
        }
    }
    let mut worth_by_group = vec![vec![0.0; groups.len()]; poles.len()];
    for (group, (solved, members)) in solved.iter().zip(members).enumerate() {
        let inverse = solved.factor.inverse();
        for (k, (&member, gain)) in members.iter().zip(&solved.gains.modes).enumerate() {
            let block = inverse.fixed_view::<2, 2>(2 * k, 2 * k).into_owned();
            let gain = nalgebra::Vector2::new(gain.re, gain.im);
            worth_by_group[member][group] = block.try_inverse().map_or(0.0, |block| gain.dot(&(block * gain)));
        }
    }
    let gains = solved.into_iter().zip(members).map(|(solved, members)| {
        let mut modes = vec![Complex::new(0.0, 0.0); poles.len()];
        members.iter().zip(&solved.gains.modes).for_each(|(&member, gain)| modes[member] = *gain);
        Gains { modes, force: solved.gains.force }
    });
    let gains = gains.collect();
    Some(Model { poles, gains, worth_by_group })
}

/// Normal equations of all groups in `d` and `ω` of each pole.
fn pole_equations(
    groups: &[Group<'_>],
    members: &[Vec<usize>],
    solved: &[Solved],
    count: usize,
) -> (DMatrix<f64>, DVector<f64>) {
    let of_group = |((group, members), solved): ((&Group<'_>, &Vec<usize>), &Solved)| {
        let size = 2 * members.len();
        let (mut normal, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
        add_pole_equations(group, solved, &mut normal, &mut right);
        (normal, right)
    };
    let parts: Vec<(DMatrix<f64>, DVector<f64>)> = groups.par_iter().zip(members).zip(solved).map(of_group).collect();
    let (mut normal, mut right) = (DMatrix::zeros(2 * count, 2 * count), DVector::zeros(2 * count));
    for ((own_normal, own_right), members) in parts.iter().zip(members) {
        let place = |index: usize| 2 * members[index / 2] + index % 2;
        for row in 0..own_right.len() {
            right[place(row)] += own_right[row];
            for column in 0..own_right.len() {
                normal[(place(row), place(column))] += own_normal[(row, column)];
            }
        }
    }
    (normal, right)
}

/// Poles after a step, kept inside the unit circle and between 0 and Nyquist.
///
/// No decay changes more than fourfold in a step.
fn moved(poles: &[Pole], step: &DVector<f64>) -> Vec<Pole> {
    let moved = poles.iter().enumerate().map(|(k, pole)| {
        let reach = 3.0 * pole.decay + 1e-4;
        Pole {
            decay: (pole.decay + step[2 * k]).clamp(pole.decay / 4.0, pole.decay * 4.0).clamp(LEAST_DECAY, MOST_DECAY),
            angular: (pole.angular + step[2 * k + 1].clamp(-reach, reach)).clamp(1e-4, std::f64::consts::PI - 1e-4),
        }
    });
    moved.collect()
}

/// Slowest decay in 1/sample, a T60 of 48 s at 48 kHz: recordings of some seconds cannot show a
/// slower one.
const LEAST_DECAY: f64 = 3e-6;
/// Fastest decay in 1/sample, just below the fastest that the instrument plays, 0.34.
pub(crate) const MOST_DECAY: f64 = 0.3;
