//! The waveguide way: loops round the filter that favour a few modes (dynamic-filter §III-B, §IV-B2, eq. 8 to 13 and 22 to 24).

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::additive::{MOST_MODES, misfit};
use super::guide::{Guide, crowding};
use super::heard::{descend, hear, mend};
use super::joint::{Joint, Sought};
use super::lattice::Lattice;
use super::path::{path_of_filters, starts, times_s};
use super::response::{heard_in_band, response};
use super::ringing::{self, Ringing};
use super::stability::{MOST_LOOP_GAIN, filters_of, stabilise};
use super::{Form, Loop, Model, Path, RATE_HZ};
use crate::bark::DampingLaw;
use crate::modes::DampedSine;

/// A loop's delay is at least so many samples, so that a board computes it a tick at a time.
pub const SHORTEST_DELAY: f64 = 32.0;
/// Width of a loop's band-pass in Hz where nothing asks for more: the paper sets 1 to 5.
pub const USUAL_BANDWIDTH_HZ: f64 = 3.0;
/// Emergence that a loop is asked for at most, as a ratio.
const MOST_EMERGENCE: f64 = 50.0;
/// Ends of the noise that are tried, as parts of the time until the slowest band has died away.
const ENDS: [f64; 4] = [0.02, 0.06, 0.15, 0.35];
/// Widths of a loop's band-pass that are tried, Hz a 1/s of its mode's decay.
const WIDTHS: [f64; 4] = [1.0, 3.0, 10.0, 30.0];
/// So many of what the descents find are mended.
const MENDED: usize = 2;
/// Rounds of choosing loops for a filter, and a filter for loops.
const ROUNDS: usize = 2;

/// The average filter `F~(ω)` of a path: its magnitude squared is the power spectral density of noise filtered along the path (over the time in
/// which there is noise), its phase that of the filter while it is loud.
pub fn average(path: &Path, angular: f64) -> Complex<f64> {
    let weighed = path.points.windows(2).filter_map(|pair| {
        let &[from, to] = pair else { return None };
        let middle = response(&from.coefficients.towards(&to.coefficients, 0.5), angular);
        Some((middle, to.time_s - from.time_s))
    });
    average_of(weighed)
}

/// The same of responses and the seconds that they last.
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

/// The loops that make a path's noise emerge at modes as the recording does, at most [`MOST_MODES`], the most prominent first.
///
/// `d_s` by eq. 22 with the smallest p that leaves [`SHORTEST_DELAY`]; γ_s so that criterion 23 is zero with H of eq. 24, each loop's own gain
/// found while the others stand still, until all agree. Then the stability condition: each γ_s is lowered until `|F| Σ|B_s|` is at most
/// [`MOST_LOOP_GAIN`] at every frequency and breakpoint. The filter is loudest at the strike and `F~` an average, so it lowers most of them: criterion
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
            let others: Complex<f64> = others.map(|(_, guide)| through(guide, frequency)).sum();
            let filter = average(path, TAU * frequency / RATE_HZ);
            let own = Complex::from_polar(1.0, -TAU * frequency * loops[index].delay_s);
            // 1 - F~ (γ D + others) = 1/E.
            let gain = ((1.0 - ratios[index].recip()) / filter - others) / own;
            loops[index].gain = if gain.re.is_finite() { gain.re.max(0.0) } else { 0.0 };
        }
    }
    stabilise(path, &mut loops);
    loops
}

/// Delay in seconds that brings a wave round a loop back in phase (eq. 22).
pub(crate) fn delay_s(frequency_hz: f64, filter_phase: f64) -> f64 {
    let period = RATE_HZ / frequency_hz;
    let first = filter_phase / TAU * period;
    let turns = ((SHORTEST_DELAY - first) / period).ceil();
    (first + turns * period) / RATE_HZ
}

/// `B_s D_s` at a frequency in Hz.
fn through(guide: &Loop, frequency_hz: f64) -> Complex<f64> {
    band_pass(guide, frequency_hz) * Complex::from_polar(1.0, -TAU * frequency_hz * guide.delay_s)
}

/// `B_s` (eq. 9 to 11) at a frequency in Hz.
fn band_pass(guide: &Loop, frequency_hz: f64) -> Complex<f64> {
    let (angular, centre) = (TAU * frequency_hz / RATE_HZ, TAU * guide.frequency_hz / RATE_HZ);
    let tau = centre.sin() * guide.bandwidth_hz / (2.0 * guide.frequency_hz);
    // The numerator τ(1 - z^-2) and the denominator, both times z: real and imaginary parts apart.
    let wide = Complex::new(0.0, 2.0 * tau * angular.sin());
    let apart = Complex::new(2.0 * (angular.cos() - centre.cos()), 0.0);
    if wide.norm() + apart.norm() <= 0.0 { Complex::new(0.0, 0.0) } else { wide / (wide + apart) * guide.gain }
}

/// Chooses at most [`MOST_MODES`] loops at modes of the recording, and path, gains and widths so that each band decays by the law.
///
/// While noise goes on, a loop's mode lives on what the filter lets through: where that falls, the mode falls faster. So the noise may end early: the
/// burst is a strike, and what it has set ringing in the loops goes on round a filter that stands still, at `πΔf (1 - |F| γ_s)`. Bands that are gone by
/// then are the filter's, those that last are the loops'. Several ends are tried, and none; what is heard to be off in the best of them is asked for anew.
pub fn waveguide(law: &DampingLaw, modes: &[DampedSine], emergence_db: &[f64], form: Form) -> Model {
    let times_s = times_s(law);
    let joint = Joint::new(law, &times_s);
    let last_s = times_s.last().copied().unwrap_or(0.0);
    let ends = ENDS.iter().map(|part| Some(times_s.partition_point(|time_s| *time_s < part * last_s)));
    let off = |sought: &Sought| misfit(law, &times_s, &joint.powers(sought));
    let mut found: Vec<(Model, Option<Sought>)> = Vec::new();
    let starts = starts(law, &joint, form);
    let first_filters: Vec<Lattice> = starts.iter().filter_map(|start| start.filters.first().cloned()).collect();
    for start in starts {
        for end in ends.clone().chain([None]) {
            let mut sought = start.clone();
            sought.freeze_after(end);
            let mut tried = Vec::new();
            for _ in 0..ROUNDS {
                sought.guides = choose(law, &joint, modes, emergence_db, &sought);
                let found = joint.descend(&sought);
                sought.filters.clone_from(&found.filters);
                tried.push(found);
            }
            let best = tried.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
            found.extend(best.map(|best| (model_of(law, &best), Some(best))));
        }
        let path = path_of_filters(law, &start);
        let loops = by_average_filter(&path, modes, emergence_db, USUAL_BANDWIDTH_HZ);
        found.push((Model { path, modes: Vec::new(), loops }, None));
    }
    // The descent takes each loop for itself and the filter for slow: what sounds best decides, and is mended.
    let mut ranked: Vec<_> =
        found.into_iter().map(|(model, sought)| (hear(law, &model).missed, model, sought)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    ranked.truncate(MENDED);
    let followed: Vec<Ringing> =
        ranked.iter().filter_map(|(_, _, sought)| ringing::of_sought(&joint, sought.as_ref()?)).collect();
    let mended = ranked.into_iter().map(|(missed, model, sought)| {
        let mended = sought.map(|sought| mend(law, &sought, |sought| model_of(law, sought), descend(law)));
        mended.map_or((missed, model), |mended| (mended.heard.missed, mended.model))
    });
    let ringing = ringing::search(law, &joint, modes, followed, &first_filters);
    let all = mended.chain(ringing.into_iter().map(|mended| (mended.heard.missed, mended.model)));
    all.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(Model::default, |(_, model)| model)
}

/// The loops' gains and delays for the path that their filters make.
fn model_of(law: &DampingLaw, sought: &Sought) -> Model {
    let path = path_of_filters(law, sought);
    let filters = filters_of(&path);
    let last = path.points.last().map(|point| point.coefficients).unwrap_or_default();
    let loops = sought.guides.iter().map(|guide| {
        let angular = TAU * guide.frequency_hz / RATE_HZ;
        let loudest = filters.iter().map(|filter| response(filter, angular).norm()).fold(f64::MIN_POSITIVE, f64::max);
        let tuned = if sought.end.is_some() { response(&last, angular) } else { average(&path, angular) };
        Loop {
            frequency_hz: guide.frequency_hz,
            bandwidth_hz: guide.bandwidth_hz,
            gain: guide.loop_gain / loudest,
            delay_s: delay_s(guide.frequency_hz, tuned.arg()),
        }
    });
    let mut loops: Vec<Loop> = loops.collect();
    stabilise(&path, &mut loops);
    Model { path, modes: Vec::new(), loops }
}

/// Loops that bring the decays of bands nearest to the law, one after the other.
fn choose(law: &DampingLaw, joint: &Joint, modes: &[DampedSine], emergence_db: &[f64], sought: &Sought) -> Vec<Guide> {
    let times_s = times_s(law);
    let noise = joint.powers(&Sought { guides: Vec::new(), ..sought.clone() });
    let with = |powers: &[Vec<f64>], guide: &Guide| -> Vec<Vec<f64>> {
        let heard: Vec<f64> = law.bands.iter().map(|band| heard_in_band(guide.frequency_hz, band.bark)).collect();
        let own = guide.powers(&times_s, &sought.filters, sought.end);
        let bands =
            |powers: &Vec<f64>, own: f64| powers.iter().zip(&heard).map(|(power, heard)| power + heard * own).collect();
        powers.iter().zip(own).map(|(powers, own)| bands(powers, own)).collect()
    };
    let candidates: Vec<Guide> = modes
        .iter()
        .zip(emergence_db)
        .filter(|(mode, _)| mode.frequency_hz < 0.45 * RATE_HZ)
        .flat_map(|(mode, emergence_db)| {
            let angular = TAU * mode.frequency_hz / RATE_HZ;
            let magnitude = |filter: &Lattice| response(&filter.coefficients(), angular).norm();
            let loudest = sought.filters.iter().map(magnitude).fold(f64::MIN_POSITIVE, f64::max);
            let last = sought.filters.last().map_or(loudest, magnitude);
            WIDTHS.map(|times| {
                let bandwidth_hz = (times * mode.decay_per_s).clamp(1.0, 0.2 * mode.frequency_hz);
                let loop_gain = match sought.end {
                    // Left to itself, it decays as its mode does.
                    Some(_) => (1.0 - mode.decay_per_s / (std::f64::consts::PI * bandwidth_hz)) * loudest / last,
                    None => 1.0 - 10f64.powf(-emergence_db / 20.0),
                };
                Guide { frequency_hz: mode.frequency_hz, bandwidth_hz, loop_gain }
            })
        })
        .filter(|guide| (0.0..MOST_LOOP_GAIN).contains(&guide.loop_gain))
        .collect();
    let mut chosen: Vec<Guide> = Vec::new();
    let mut powers = noise;
    let mut best = misfit(law, &times_s, &powers);
    while chosen.len() < MOST_MODES {
        let stable = |guide: &&Guide| {
            let more: Vec<Guide> = chosen.iter().copied().chain([**guide]).collect();
            crowding(&more).all(|gain| gain < MOST_LOOP_GAIN)
        };
        let tried =
            candidates.iter().filter(stable).map(|guide| (misfit(law, &times_s, &with(&powers, guide)), *guide));
        let Some((now, guide)) = tried.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        if now >= best {
            break;
        }
        best = now;
        powers = with(&powers, &guide);
        chosen.push(guide);
    }
    chosen
}
