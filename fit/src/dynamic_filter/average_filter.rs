//! The average filter of a path, and the loops that follow from it (dynamic-filter eq. 22 to 24).

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::delay::delay_s;
use super::model::{Loop, MOST_MODES, Path, RATE_HZ};
use super::response::response;
use super::stability::stabilise;
use crate::modes::DampedSine;

/// Usual width of a loop's band-pass in Hz: the paper sets 1 to 5.
pub const USUAL_BANDWIDTH_HZ: f64 = 3.0;
/// Maximum emergence that a loop is designed for, as a ratio of amplitudes.
const MOST_EMERGENCE: f64 = 50.0;

/// Response `F~(ω)` of the average filter of a path, ω in radians a sample.
///
/// Its squared magnitude is the power spectral density of noise filtered along the path, over the
/// time in which there is noise. Its phase is that of the filter while it is loud.
pub fn average(path: &Path, angular: f64) -> Complex<f64> {
    let weighed = path.points.windows(2).filter_map(|pair| {
        let &[from, to] = pair else { return None };
        let middle = response(&from.coefficients.towards(&to.coefficients, 0.5), angular);
        Some((middle, to.time_s - from.time_s))
    });
    average_of(weighed)
}

/// Average of responses, each with the seconds for which it lasts.
pub(crate) fn average_of(responses: impl Iterator<Item = (Complex<f64>, f64)>) -> Complex<f64> {
    let (mut power, mut turned, mut length) = (0.0, Complex::new(0.0, 0.0), 0.0);
    for (response, lasts_s) in responses {
        power += response.norm_sqr() * lasts_s;
        turned += response * response.norm() * lasts_s;
        length += lasts_s;
    }
    if length <= 0.0 || turned.norm() <= 0.0 {
        return Complex::new(0.0, 0.0);
    }
    turned / turned.norm() * (power / length).sqrt()
}

/// The loops that make a path's noise emerge at modes as in the recording, at most [`MOST_MODES`],
/// the most prominent first.
///
/// `d_s` follows from eq. 22 with the smallest p that leaves
/// [`SHORTEST_DELAY`](super::delay::SHORTEST_DELAY). γ_s makes criterion 23 zero with H of eq. 24;
/// each loop's gain is found while the others stay, until all agree. Then each γ_s is lowered until
/// `|F| Σ|B_s|` is at most [`MOST_LOOP_GAIN`](super::stability::MOST_LOOP_GAIN) at every frequency
/// and breakpoint. The filter is loudest at the strike and `F~` is an average, so the condition
/// lowers most gains. Criterion 23 alone would let a mode grow without bound while the filter is
/// still open.
pub fn by_average_filter(path: &Path, modes: &[DampedSine], emergence_db: &[f64], bandwidth_hz: f64) -> Vec<Loop> {
    let mut wanted: Vec<(&DampedSine, f64)> = modes.iter().zip(emergence_db.iter().copied()).collect();
    wanted.retain(|(mode, emergence_db)| *emergence_db > 0.0 && mode.frequency_hz < 0.45 * RATE_HZ);
    wanted.sort_by(|a, b| b.1.total_cmp(&a.1));
    wanted.truncate(MOST_MODES);
    let ratios: Vec<f64> = wanted.iter().map(|(_, db)| 10f64.powf(db / 20.0).min(MOST_EMERGENCE)).collect();
    let mut loops: Vec<Loop> = wanted
        .iter()
        .map(|(mode, _)| Loop {
            frequency_hz: mode.frequency_hz,
            bandwidth_hz,
            gain: 0.0,
            delay_s: delay_s(mode.frequency_hz, average(path, TAU * mode.frequency_hz / RATE_HZ).arg()),
        })
        .collect();
    for _ in 0..20 {
        for index in 0..loops.len() {
            let frequency = loops[index].frequency_hz;
            let others = loops.iter().enumerate().filter(|(other, _)| *other != index);
            let others: Complex<f64> = others.map(|(_, guide)| through(guide, frequency)).sum();
            let filter = average(path, TAU * frequency / RATE_HZ);
            let own = Complex::from_polar(1.0, -TAU * frequency * loops[index].delay_s);
            // Solves 1 - F~ (γ D + others) = 1/E for γ.
            let gain = ((1.0 - ratios[index].recip()) / filter - others) / own;
            loops[index].gain = if gain.re.is_finite() { gain.re.max(0.0) } else { 0.0 };
        }
    }
    stabilise(path, &mut loops);
    loops
}

/// Response `B_s D_s` of a loop at a frequency in Hz.
fn through(guide: &Loop, frequency_hz: f64) -> Complex<f64> {
    band_pass(guide, frequency_hz) * Complex::from_polar(1.0, -TAU * frequency_hz * guide.delay_s)
}

/// Response `B_s` (eq. 9 to 11) of a loop's band-pass at a frequency in Hz.
fn band_pass(guide: &Loop, frequency_hz: f64) -> Complex<f64> {
    let (angular, centre) = (TAU * frequency_hz / RATE_HZ, TAU * guide.frequency_hz / RATE_HZ);
    let tau = centre.sin() * guide.bandwidth_hz / (2.0 * guide.frequency_hz);
    // The numerator τ(1 - z^-2) and the denominator, both times z, split into real and imaginary
    // parts.
    let wide = Complex::new(0.0, 2.0 * tau * angular.sin());
    let apart = Complex::new(2.0 * (angular.cos() - centre.cos()), 0.0);
    if wide.norm() + apart.norm() <= 0.0 { Complex::new(0.0, 0.0) } else { wide / (wide + apart) * guide.gain }
}
