//! The estimation of coefficients over time from a damping law.

use super::levels::{Target, follow};
use super::response::{BandHearing, heard_in_band};
use super::thin::thin;
use super::three_bands::keep_three;
use super::{Coefficients, Form, Path, RATE_HZ};
use crate::bark::{DampingLaw, HIGHEST_BARK, frequency_hz};
use crate::modes::DampedSine;

/// By what the coefficients are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// Eq. 19 to 21: first order, the damping kept in the bands of three spectral centroids.
    ThreeBands,
    /// Least squares over the levels of all bands, in dB.
    AllBands(Form),
}

/// Times at which coefficients are estimated before they are thinned.
const TIMES: usize = 96;
/// The slowest band is followed until it has fallen so far, dB.
const FOLLOWED_DB: f64 = 60.0;
/// In the fastest band the first step is so much of a decay.
const FIRST_STEP_DB: f64 = 1.0;
/// Modes that hold more than this share of a band's power at the strike make it: noise has to stay below.
const MODES_MAKE: f64 = 0.5;
/// Below them by so much, as a power ratio: 12 dB.
const BELOW_MODES: f64 = 0.063;
/// What bands without a law count: they are held at their nearest neighbour's level, or below.
const NEIGHBOUR_WEIGHT: f64 = 0.2;
/// Neighbours of the law that are held so.
const NEIGHBOURS: usize = 4;

/// dB/s of a decay in 1/s.
pub(crate) fn db_per_s(decay_per_s: f64) -> f64 {
    20.0 / std::f64::consts::LN_10 * decay_per_s
}

/// The path that makes white noise alone decay by the law.
pub fn noise_alone(law: &DampingLaw, criterion: Criterion) -> Path {
    beside(law, &[], criterion)
}

/// The path whose noise makes, together with modes beside the filter, each band decay by the law.
pub(crate) fn beside(law: &DampingLaw, modes: &[DampedSine], criterion: Criterion) -> Path {
    let times_s = times_s(law);
    let filters: Vec<Coefficients> = match criterion {
        Criterion::ThreeBands => keep_three(law, RATE_HZ, &times_s),
        Criterion::AllBands(form) => {
            follow(form, &targets(law, modes), &times_s).iter().map(super::lattice::Lattice::coefficients).collect()
        }
    };
    let bands: Vec<BandHearing> = law.bands.iter().map(|band| BandHearing::new(band.bark, RATE_HZ)).collect();
    thin(&times_s, &filters, &bands)
}

/// From the strike until the slowest band has died away, the closer together the earlier.
pub(crate) fn times_s(law: &DampingLaw) -> Vec<f64> {
    let rates = || law.bands.iter().map(|band| db_per_s(band.decay_per_s));
    let end_s = FOLLOWED_DB / rates().fold(f64::INFINITY, f64::min);
    let first_s = (FIRST_STEP_DB / rates().fold(0.0, f64::max)).min(end_s / TIMES as f64);
    // Steps grow by a factor that makes the last end where it should: found by halving.
    let last = (TIMES - 1) as f64;
    let length = |growth: f64| {
        if growth > 1e-9 { first_s * ((growth * last).exp_m1()) / growth.exp_m1() } else { first_s * last }
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if length(middle) < end_s { low = middle } else { high = middle }
    }
    let growth = low.max(1e-9);
    (0..TIMES).map(|index| first_s * (growth * index as f64).exp_m1() / growth.exp_m1()).collect()
}

/// Share of a band's power at the strike that modes hold.
pub(crate) fn share_of_modes(law: &DampingLaw, band: usize, modes: &[DampedSine]) -> f64 {
    let Some(band) = law.bands.get(band) else { return 0.0 };
    let held: f64 = modes.iter().map(|mode| mode.amplitude.powi(2) * heard_in_band(mode.frequency_hz, band.bark)).sum();
    held / band.gain.powi(2)
}

fn targets(law: &DampingLaw, modes: &[DampedSine]) -> Vec<Target> {
    let mut targets: Vec<Target> = law
        .bands
        .iter()
        .enumerate()
        .map(|(index, band)| {
            let share = share_of_modes(law, index, modes);
            let ceiling = share > MODES_MAKE;
            let left = if ceiling { BELOW_MODES * share.min(1.0) } else { 1.0 - share };
            Target {
                hearing: BandHearing::new(band.bark, RATE_HZ),
                level_db: 20.0 * band.gain.log10() + 10.0 * left.log10(),
                decay_db_per_s: db_per_s(band.decay_per_s),
                weight: 1.0,
                ceiling,
            }
        })
        .collect();
    // What the law says nothing of must not stand out.
    let known = |rate: f64| law.bands.iter().any(|band| (band.bark - rate).abs() < 0.5);
    let unknown =
        (1..=HIGHEST_BARK as u32).map(f64::from).filter(|rate| !known(*rate) && frequency_hz(*rate) < 0.45 * RATE_HZ);
    for rate in unknown {
        let nearest = law.bands.iter().min_by(|a, b| (a.bark - rate).abs().total_cmp(&(b.bark - rate).abs()));
        if let Some(band) = nearest.filter(|band| (band.bark - rate).abs() <= NEIGHBOURS as f64) {
            targets.push(Target {
                hearing: BandHearing::new(rate, RATE_HZ),
                level_db: 20.0 * band.gain.log10(),
                decay_db_per_s: db_per_s(band.decay_per_s),
                weight: NEIGHBOUR_WEIGHT,
                ceiling: true,
            });
        }
    }
    targets
}
