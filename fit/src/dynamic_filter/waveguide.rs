//! The waveguide method: loops round the filter that favour a few modes (dynamic-filter §III-B,
//! §IV-B2, eq. 8 to 13 and 22 to 24).

use std::f64::consts::TAU;

use super::average_filter::{USUAL_BANDWIDTH_HZ, average, by_average_filter};
use super::delay::delay_s;
use super::evaluation::{correct, descend, evaluate};
use super::guide::{Guide, crowding};
use super::lattice::Lattice;
use super::misfit::misfit;
use super::model::{Form, Loop, MOST_MODES, Model, RATE_HZ};
use super::objective::{Candidate, Objective};
use super::path::{path_of_filters, starts};
use super::response::{response, sine_power_in_band};
use super::ringing::{self, Ringing};
use super::stability::{MOST_LOOP_GAIN, filters_of, stabilise};
use super::times::times_s;
use crate::bark::DampingLaw;
use crate::modes::DampedSine;

/// Ends of the noise that are tried, as parts of the time until the slowest band has died away.
const ENDS: [f64; 4] = [0.02, 0.06, 0.15, 0.35];
/// Widths of a loop's band-pass that are tried, in Hz for a mode's decay of 1/s.
const WIDTHS: [f64; 4] = [1.0, 3.0, 10.0, 30.0];
/// Number of the descents' best results that are corrected.
const CORRECTED: usize = 2;
/// Share of the work that is done when loops are chosen for each end, for the progress bar.
const CHOSEN: f64 = 0.3;
/// Number of rounds in which loops are chosen for a filter, and a filter for the loops.
const ROUNDS: usize = 2;

/// Chooses at most [`MOST_MODES`] loops at modes of the recording, and path, gains and widths, so
/// that each band decays by the law.
///
/// While noise goes on, a loop's mode is fed by what passes the filter: where that falls, the mode
/// falls faster. So the noise may end early. The burst is a strike, and the modes that it has
/// excited in the loops go on round a filter that stands still, at `πΔf (1 - |F| γ_s)`. Bands that
/// are gone by then are the filter's, and those that last are the loops'. Noise with each of
/// several ends is tried, and noise that goes on. The best result is corrected by the errors
/// measured in its rendered sound.
///
/// `told` gets the share of the work that is done.
pub fn waveguide(
    law: &DampingLaw,
    modes: &[DampedSine],
    emergence_db: &[f64],
    form: Form,
    told: &(dyn Fn(f64) + Sync),
) -> Model {
    let times_s = times_s(law);
    let objective = Objective::new(law, &times_s);
    let last_s = times_s.last().copied().unwrap_or(0.0);
    let ends = ENDS.iter().map(|part| Some(times_s.partition_point(|time_s| *time_s < part * last_s)));
    let off = |candidate: &Candidate| misfit(law, &times_s, &objective.powers(candidate));
    let mut found: Vec<(Model, Option<Candidate>)> = Vec::new();
    let starts = starts(law, &objective, form);
    let first_filters: Vec<Lattice> = starts.iter().filter_map(|start| start.filters.first().cloned()).collect();
    let count = starts.len() as f64;
    for (index, start) in starts.into_iter().enumerate() {
        for (tried_ends, end) in ends.clone().chain([None]).enumerate() {
            told(CHOSEN * (index as f64 + tried_ends as f64 / (ENDS.len() + 1) as f64) / count);
            let mut candidate = start.clone();
            candidate.freeze_after(end);
            let mut tried = Vec::new();
            for _ in 0..ROUNDS {
                candidate.guides = choose(law, &objective, modes, emergence_db, &candidate);
                let found = objective.descend(&candidate);
                candidate.filters.clone_from(&found.filters);
                tried.push(found);
            }
            let best = tried.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
            found.extend(best.map(|best| (model_of(law, &best), Some(best))));
        }
        let path = path_of_filters(law, &start);
        let loops = by_average_filter(&path, modes, emergence_db, USUAL_BANDWIDTH_HZ);
        found.push((Model { path, modes: Vec::new(), loops }, None));
    }
    // The descent treats each loop alone and the filter as slow, so the rendered sound decides
    // which results are corrected.
    let mut ranked: Vec<_> =
        found.into_iter().map(|(model, candidate)| (evaluate(law, &model).missed, model, candidate)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    ranked.truncate(CORRECTED);
    let followed: Vec<Ringing> =
        ranked.iter().filter_map(|(_, _, candidate)| ringing::of_candidate(&objective, candidate.as_ref()?)).collect();
    let corrected = ranked.into_iter().map(|(missed, model, candidate)| {
        let corrected =
            candidate.map(|candidate| correct(law, &candidate, |candidate| model_of(law, candidate), descend(law)));
        corrected.map_or((missed, model), |corrected| (corrected.evaluation.missed, corrected.model))
    });
    let told = |share: f64| told(CHOSEN + (1.0 - CHOSEN) * share);
    let ringing = ringing::search(law, &objective, modes, followed, &first_filters, &told);
    let all = corrected.chain(ringing.into_iter().map(|corrected| (corrected.evaluation.missed, corrected.model)));
    all.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(Model::default, |(_, model)| model)
}

/// The model of a candidate, with the loops' gains and delays for its path.
fn model_of(law: &DampingLaw, candidate: &Candidate) -> Model {
    let path = path_of_filters(law, candidate);
    let filters = filters_of(&path);
    let last = path.points.last().map(|point| point.coefficients).unwrap_or_default();
    let loops = candidate.guides.iter().map(|guide| {
        let angular = TAU * guide.frequency_hz / RATE_HZ;
        let loudest = filters.iter().map(|filter| response(filter, angular).norm()).fold(f64::MIN_POSITIVE, f64::max);
        let tuned = if candidate.end.is_some() { response(&last, angular) } else { average(&path, angular) };
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

/// Loops that bring the bands' decays nearest to the law, chosen one after the other.
fn choose(
    law: &DampingLaw,
    objective: &Objective,
    modes: &[DampedSine],
    emergence_db: &[f64],
    candidate: &Candidate,
) -> Vec<Guide> {
    let times_s = times_s(law);
    let noise = objective.powers(&Candidate { guides: Vec::new(), ..candidate.clone() });
    let with = |powers: &[Vec<f64>], guide: &Guide| -> Vec<Vec<f64>> {
        let heard: Vec<f64> = law.bands.iter().map(|band| sine_power_in_band(guide.frequency_hz, band.bark)).collect();
        let own = guide.powers(&times_s, &candidate.filters, candidate.end);
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
            let loudest = candidate.filters.iter().map(magnitude).fold(f64::MIN_POSITIVE, f64::max);
            let last = candidate.filters.last().map_or(loudest, magnitude);
            WIDTHS.map(|times| {
                let bandwidth_hz = (times * mode.decay_per_s).clamp(1.0, 0.2 * mode.frequency_hz);
                let loop_gain = match candidate.end {
                    // Left to itself, the loop decays as its mode does.
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
