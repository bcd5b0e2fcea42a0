//! A chain of biquads approximated by modes and a direct term, by least squares over its impulse
//! response.
//!
//! With λ_j = (-d_j + iω_j)/fs for mode j, the modes ring as
//! `h'[n] = Σ_j 2 Re(c_j e^{λ_j n}) + c_0 [n = 0]`. The fit minimises
//! `Σ (h - h')² + ρ² Σ_j Σ_n (2 Re(c_j e^{λ_j n}))²`. The second term is the noise of a bank whose
//! modes have an SNR of 1/ρ each, so modes that cancel one another cost something. Inner products
//! of exponentials are geometric series. Inner products of exponentials with h are values of H.

use std::f64::consts::{PI, TAU};

use dsp_core::SampleRate;
use dsp_core::table::range::DECAY_PER_S;
use fourier::Complex;

type Number = Complex<f64>;

/// Complex logarithm of a root; `None` for a root at 0.
type Log = Option<Number>;

/// Chain of biquads, given by the logarithms of its roots.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    /// Poles, one of each conjugate pair.
    pub(crate) poles: Vec<Log>,
    /// Zeros, one of each conjugate pair.
    pub(crate) zeros: Vec<Log>,
    /// Product of the gains of all sections.
    pub(crate) gain: f64,
}

/// Logarithm of a root with a magnitude and an angle.
pub(crate) fn log_of(radius: f64, angle: f64) -> Log {
    (radius > 0.0).then(|| Complex::new(radius.ln(), angle))
}

/// Value of `1 - e^z`, exact to the last digits for small z too.
fn one_minus_exp(z: Number) -> Number {
    let half = (z.im / 2.0).sin();
    let re = z.re.exp_m1() * z.im.cos() - 2.0 * half * half;
    Complex::new(-re, -z.re.exp() * z.im.sin())
}

impl Chain {
    /// Value of H at `z = e^log`, outside the circle on which the poles lie.
    fn at(&self, log: Number) -> Number {
        let factors = |roots: &[Log]| {
            roots.iter().flatten().fold(Complex::new(1.0, 0.0), |product, &root| {
                product * one_minus_exp(root - log) * one_minus_exp(root.conj() - log)
            })
        };
        Complex::new(self.gain, 0.0) * factors(&self.zeros) / factors(&self.poles)
    }

    /// Angles and weights of a quadrature over the upper half circle.
    ///
    /// It is Gauss-Legendre quadrature on panels that halve towards each pole.
    pub(crate) fn grid(&self) -> Vec<(f64, f64)> {
        let mut edges = vec![0.0, PI];
        for pole in self.poles.iter().flatten() {
            let width = -pole.re;
            let near = |k: i32| width * 2f64.powi(k) / 4.0;
            let all = (0..40).map(near).take_while(|&step| step < 4.0);
            edges.extend(all.flat_map(|step| [pole.im - step, pole.im + step]).chain([pole.im]));
        }
        edges.retain(|edge| (0.0..=PI).contains(edge));
        edges.sort_by(f64::total_cmp);
        let mut grid = Vec::new();
        for pair in edges.windows(2) {
            let (middle, half) = ((pair[0] + pair[1]) / 2.0, (pair[1] - pair[0]) / 2.0);
            if half > 0.0 {
                for (x, weight) in GAUSS {
                    grid.extend([-x, x].map(|x| (middle + x * half, weight * half / PI)));
                }
            }
        }
        grid
    }
}

/// Abscissas and weights of Gauss-Legendre of order 8.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_47),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];

/// Modes that stand for a chain.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fit {
    /// λ and c of each mode.
    pub(crate) modes: Vec<(Number, Number)>,
    /// Direct term c_0.
    pub(crate) direct: f64,
    /// Energy of h - h' over the energy of h.
    pub(crate) missed: f64,
    /// Energy of the noise of a bank whose modes have an SNR of 1/ρ each, over the energy of h.
    pub(crate) noise: f64,
}

impl Fit {
    /// SNR in dB to be expected of a bank that plays these modes.
    pub(crate) fn expected_db(&self) -> f64 {
        -10.0 * (self.missed + self.noise).log10()
    }
}

/// Fits modes with given poles to a chain.
pub(crate) fn fit(chain: &Chain, grid: &[(f64, f64)], poles: &[Number], rho: f64) -> Fit {
    let all: Vec<Log> =
        poles.iter().map(|&pole| Some(pole)).chain(poles.iter().map(|p| Some(p.conj()))).chain([None]).collect();
    let product = |one: &Log, other: &Log| match (one, other) {
        (Some(one), Some(other)) => Complex::new(1.0, 0.0) / one_minus_exp(*other + one.conj()),
        _ => Complex::new(1.0, 0.0),
    };
    // Scaled so that every exponential has the energy 1.
    let scale: Vec<f64> = all.iter().map(|log| product(log, log).re.sqrt().recip()).collect();
    let count = all.len();
    let mut matrix = vec![vec![Number::default(); count + 1]; count];
    for (row, log) in all.iter().enumerate() {
        for (column, other) in all.iter().enumerate() {
            matrix[row][column] = product(log, other) * Complex::new(scale[row] * scale[column], 0.0);
        }
        // A mode's noise follows the energy of its sound, which both conjugates make together.
        if row + 1 < count {
            for at in [row, (row + poles.len()) % (count - 1)] {
                matrix[row][at] *= 1.0 + rho * rho;
            }
        }
        let value = log.map_or(Complex::new(chain.gain, 0.0), |log| chain.at(-log.conj()));
        matrix[row][count] = value * Complex::new(scale[row], 0.0);
    }
    let solution = solve(matrix);
    let coefficients: Vec<Number> =
        solution.iter().zip(&scale).map(|(&x, &scale)| x * Complex::new(scale, 0.0)).collect();
    let (mut energy, mut missed) = (0.0, 0.0);
    for &(angle, weight) in grid {
        let at = Complex::new(0.0, angle);
        let exact = chain.at(at);
        let sum = all
            .iter()
            .zip(&coefficients)
            .fold(Number::default(), |sum, (log, &c)| sum + log.map_or(c, |log| c / one_minus_exp(log - at)));
        energy += weight * exact.norm_sqr();
        missed += weight * (exact - sum).norm_sqr();
    }
    let energy_of = |index: usize| {
        let pole = all[index];
        let pair = [(pole, coefficients[index]), (pole.map(|pole| pole.conj()), coefficients[index].conj())];
        let products = pair.iter().flat_map(|one| pair.iter().map(move |other| (one, other)));
        products.map(|((a, ca), (b, cb))| (ca.conj() * cb * product(a, b)).re).sum::<f64>()
    };
    let noise = (0..poles.len()).map(energy_of).sum::<f64>() * rho * rho;
    Fit {
        modes: poles.iter().copied().zip(coefficients.iter().copied()).collect(),
        direct: coefficients[count - 1].re,
        missed: missed / energy,
        noise: noise / energy,
    }
}

/// Solves a Hermitian system by elimination with pivots. Its right side is the last column.
fn solve(mut rows: Vec<Vec<Number>>) -> Vec<Number> {
    let count = rows.len();
    for column in 0..count {
        let pivot = (column..count).max_by(|&a, &b| rows[a][column].norm_sqr().total_cmp(&rows[b][column].norm_sqr()));
        rows.swap(column, pivot.unwrap_or(column));
        let (above, below) = rows.split_at_mut(column + 1);
        let pivot = &above[column];
        for row in below {
            let factor = row[column] / pivot[column];
            for (x, &y) in row.iter_mut().zip(pivot).skip(column) {
                *x -= factor * y;
            }
        }
    }
    let mut solution = vec![Number::default(); count];
    for row in (0..count).rev() {
        let known = (row + 1..count).fold(rows[row][count], |rest, at| rest - rows[row][at] * solution[at]);
        solution[row] = known / rows[row][row];
    }
    solution
}

/// Fastest decay in 1/s of a mode at 48 kHz that both the modal bank and a kit allow.
pub(crate) fn fastest_decay_per_s() -> f64 {
    dsp_core::resonator::max_decay_per_s(SampleRate::HZ_48000).min(f64::from(DECAY_PER_S.max))
}

/// Nearest pole that a table of modes can hold.
///
/// It is rounded to `f32` in Hz and 1/s, within the frequencies and decays that a kit and the modal
/// bank allow.
pub(crate) fn on_grid(pole: Number, fs: f64) -> Number {
    let decay = (-pole.re * fs).clamp(0.01, fastest_decay_per_s()) as f32;
    let hz = (pole.im.abs() * fs / TAU).clamp(0.1, fs / 2.0 - 0.1) as f32;
    Complex::new(-f64::from(decay) / fs, f64::from(hz) * TAU / fs)
}
