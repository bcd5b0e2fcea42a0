//! Loops by the average filter, as the paper has them (dynamic-filter §IV-B2, eq. 22 to 24).

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::additive::MOST_MODES;
use super::response::response;
use super::sound::RATE;
use super::stability::{stabilise, through};
use super::waveguide::delay_s;
use super::{Loop, Path, RATE_HZ};
use crate::modes::DampedSine;

/// Width of a loop's band-pass in Hz where nothing asks for more: the paper sets 1 to 5.
pub const USUAL_BANDWIDTH_HZ: f64 = 3.0;
/// Emergence that a loop is asked for at most, as a ratio.
const MOST_EMERGENCE: f64 = 50.0;

/// The average filter `F~(ω)` of a path: its magnitude squared is the power spectral density of noise filtered along the path (over the time in
/// which there is noise), its phase that of the filter while it is loud.
pub fn average(path: &Path, angular: f64) -> Complex<f64> {
    let (mut power, mut turned, mut length) = (0.0, Complex::new(0.0, 0.0), 0.0);
    for pair in path.points.windows(2) {
        let &[from, to] = pair else { continue };
        let lasts_s = to.time_s - from.time_s;
        let middle =
            response(&from.coefficients.towards(&to.coefficients, 0.5), angular) * (0.5 * (from.noise + to.noise));
        power += middle.norm_sqr() * lasts_s;
        turned += middle * middle.norm() * lasts_s;
        length += lasts_s;
    }
    if length <= 0.0 || turned.norm() <= 0.0 {
        return Complex::new(0.0, 0.0);
    }
    turned / turned.norm() * (power / length).sqrt()
}

/// The loops that make a path's noise emerge at modes as the recording does, at most [`MOST_MODES`], the most prominent first.
///
/// `d_s` by eq. 22 with the smallest p that leaves [`super::SHORTEST_DELAY`]; γ_s so that criterion 23 is zero with H of eq. 24, each loop's own gain
/// found while the others stand still, until all agree. Then the stability condition: each γ_s is lowered until `|F| Σ|B_s|` is at most
/// [`super::MOST_LOOP_GAIN`] at every frequency and breakpoint. The filter is loudest at the strike and `F~` an average, so it lowers most of them: criterion
/// 23 alone would let a mode grow without bound while the filter is still open.
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
            let angular = TAU * frequency / RATE_HZ;
            let others: Complex<f64> = others.map(|(_, guide)| through(&guide.exact().tuned(RATE), angular)).sum();
            let filter = average(path, angular);
            let own = Complex::from_polar(1.0, -TAU * frequency * loops[index].delay_s);
            // 1 - F~ (γ D + others) = 1/E.
            let gain = ((1.0 - ratios[index].recip()) / filter - others) / own;
            loops[index].gain = if gain.re.is_finite() { gain.re.max(0.0) } else { 0.0 };
        }
    }
    stabilise(path, &mut loops);
    loops
}
