//! The estimation of coefficients over time from a damping law.

use super::additive::misfit;
use super::joint::{Joint, Sought};
use super::lattice::Lattice;
use super::levels::{Target, follow};
use super::response::BandHearing;
use super::thin::thin;
use super::three_bands::keep_three;
use super::{Coefficients, Form, Path};
use crate::bark::DampingLaw;

/// By what the coefficients are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// Eq. 19 to 21: first order, the damping kept in the bands of three spectral centroids.
    ThreeBands,
    /// Least squares over the levels of all bands, in dB.
    AllBands(Form),
}

/// Times at which coefficients are estimated before they are thinned.
const TIMES: usize = 97;
/// The slowest band is followed until it has fallen so far, dB.
const FOLLOWED_DB: f64 = 60.0;
/// In the fastest band the first step is so much of a decay.
const FIRST_STEP_DB: f64 = 1.0;

/// dB/s of a decay in 1/s.
pub(crate) fn db_per_s(decay_per_s: f64) -> f64 {
    20.0 / std::f64::consts::LN_10 * decay_per_s
}

/// The path that makes white noise alone decay by the law.
pub fn noise_alone(law: &DampingLaw, criterion: Criterion) -> Path {
    match criterion {
        Criterion::ThreeBands => {
            let times_s = times_s(law);
            path_of(law, &times_s, &keep_three(law, &times_s))
        }
        Criterion::AllBands(form) => {
            let times_s = times_s(law);
            let joint = Joint::new(law, &times_s);
            let off = |sought: &Sought| misfit(law, &times_s, &joint.powers(sought));
            let best = starts(law, &joint, form).into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
            best.map_or_else(Path::default, |best| path_of_filters(law, &best))
        }
    }
}

/// Filters for noise alone from which a fit with modes or loops begins: those of the form itself, and those of each form within it, which are its
/// own too and often lead to better ones.
pub(crate) fn starts(law: &DampingLaw, joint: &Joint, form: Form) -> Vec<Sought> {
    let forms: &[Form] = match form {
        Form::FirstOrder => &[Form::FirstOrder],
        Form::OnePoleOneZero => &[Form::FirstOrder, Form::OnePoleOneZero],
        Form::SecondOrder => &[Form::FirstOrder, Form::SecondOrder],
    };
    let start = |narrow: &Form| {
        let mut found = joint.descend(&first_guess(law, *narrow));
        if *narrow != form {
            found.filters = found.filters.iter().map(|filter| filter.within(form)).collect();
            found = joint.descend(&found);
        }
        found
    };
    forms.iter().map(start).collect()
}

/// The filters that follow the law time by time, without modes.
fn first_guess(law: &DampingLaw, form: Form) -> Sought {
    let target = |band: &crate::bark::DampingBand| Target {
        hearing: BandHearing::new(band.bark),
        level_db: 20.0 * band.gain.log10(),
        decay_db_per_s: db_per_s(band.decay_per_s),
    };
    let targets: Vec<Target> = law.bands.iter().map(target).collect();
    Sought { filters: follow(form, &targets, &times_s(law)), modes: Vec::new(), guides: Vec::new(), end: None }
}

/// Filters at the times of [`times_s`] as breakpoints, up to where the noise ends.
pub(crate) fn path_of_filters(law: &DampingLaw, sought: &Sought) -> Path {
    let filters: Vec<Coefficients> = sought.filters.iter().map(Lattice::coefficients).collect();
    let count = sought.end.map_or(filters.len(), |end| filters.len().min(end + 1));
    path_of(law, &times_s(law), filters.get(..count).unwrap_or(&filters))
}

fn path_of(law: &DampingLaw, times_s: &[f64], filters: &[Coefficients]) -> Path {
    let bands: Vec<BandHearing> = law.bands.iter().map(|band| BandHearing::new(band.bark)).collect();
    thin(times_s, filters, &bands)
}

/// From the strike until the slowest band has died away, the closer together the earlier.
pub(crate) fn times_s(law: &DampingLaw) -> Vec<f64> {
    let rates = || law.bands.iter().map(|band| db_per_s(band.decay_per_s));
    let end_s = FOLLOWED_DB / rates().fold(f64::INFINITY, f64::min);
    let first_s = (FIRST_STEP_DB / rates().fold(0.0, f64::max)).min(end_s / TIMES as f64);
    // Steps grow by a factor that makes the last end where it should: found by halving.
    let last = (TIMES - 1) as f64;
    let length = |growth: f64| first_s * (growth * last).exp_m1() / growth.exp_m1();
    let (mut low, mut high) = (1e-9, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if length(middle) < end_s { low = middle } else { high = middle }
    }
    (0..TIMES).map(|index| first_s * (low * index as f64).exp_m1() / low.exp_m1()).collect()
}
