//! Estimation of the filter's path from a damping law, for noise without modes.

use super::lattice::Lattice;
use super::levels::{Target, follow};
use super::misfit::{db_per_s, misfit};
use super::model::{Coefficients, Form, Path};
use super::objective::{Candidate, Objective};
use super::response::NoiseBand;
use super::thin::thin;
use super::three_bands::keep_three;
use super::times::times_s;
use crate::bark::DampingLaw;

/// Criterion by which the coefficients are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// Damping kept in the bands of three spectral centroids, with a first-order filter (eq. 19 to
    /// 21).
    ThreeBands,
    /// Least squares of the levels of all bands, in dB.
    AllBands(Form),
}

/// The path along which white noise alone decays by the law.
pub fn noise_alone(law: &DampingLaw, criterion: Criterion) -> Path {
    match criterion {
        Criterion::ThreeBands => {
            let times_s = times_s(law);
            path_of(law, &times_s, &keep_three(law, &times_s))
        }
        Criterion::AllBands(form) => {
            let times_s = times_s(law);
            let objective = Objective::new(law, &times_s);
            let off = |candidate: &Candidate| misfit(law, &times_s, &objective.powers(candidate));
            let best = starts(law, &objective, form).into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
            best.map_or_else(Path::default, |best| path_of_filters(law, &best))
        }
    }
}

/// Filters for noise alone from which a fit with modes or loops begins.
///
/// They are fitted in the form itself and in each form that it contains, because the latter often
/// lead to better fits.
pub(crate) fn starts(law: &DampingLaw, objective: &Objective, form: Form) -> Vec<Candidate> {
    let forms: &[Form] = match form {
        Form::FirstOrder => &[Form::FirstOrder],
        Form::OnePoleOneZero => &[Form::FirstOrder, Form::OnePoleOneZero],
        Form::SecondOrder => &[Form::FirstOrder, Form::SecondOrder],
    };
    let start = |narrow: &Form| {
        let mut found = objective.descend(&first_guess(law, *narrow));
        if *narrow != form {
            found.filters = found.filters.iter().map(|filter| filter.within(form)).collect();
            found = objective.descend(&found);
        }
        found
    };
    forms.iter().map(start).collect()
}

/// Filters that follow the law time by time, without modes.
fn first_guess(law: &DampingLaw, form: Form) -> Candidate {
    let target = |band: &crate::bark::DampingBand| Target {
        noise_band: NoiseBand::new(band.bark),
        level_db: 20.0 * band.gain.log10(),
        decay_db_per_s: db_per_s(band.decay_per_s),
    };
    let targets: Vec<Target> = law.bands.iter().map(target).collect();
    Candidate { filters: follow(form, &targets, &times_s(law)), modes: Vec::new(), guides: Vec::new(), end: None }
}

/// Breakpoints of a candidate's filters, up to the end of its noise.
pub(crate) fn path_of_filters(law: &DampingLaw, candidate: &Candidate) -> Path {
    let filters: Vec<Coefficients> = candidate.filters.iter().map(Lattice::coefficients).collect();
    let count = candidate.end.map_or(filters.len(), |end| filters.len().min(end + 1));
    path_of(law, &times_s(law), filters.get(..count).unwrap_or(&filters))
}

fn path_of(law: &DampingLaw, times_s: &[f64], filters: &[Coefficients]) -> Path {
    let bands: Vec<NoiseBand> = law.bands.iter().map(|band| NoiseBand::new(band.bark)).collect();
    thin(times_s, filters, &bands)
}
