//! Tables of models, and how much of a recording's damping the instrument keeps when it plays them.

use std::sync::{Mutex, PoisonError};

use nalgebra::Complex;

use super::damping::{Comparison, compare, mean_law};
use super::model::{Breakpoint, Coefficients, Form, Loop, Model, RATE_HZ};
use super::study::{Heard, Way};
use crate::error::FitError;
use crate::modes::DampedSine;
use crate::strike::Fit;
use crate::table::{self, Provenance};
use crate::{contact, render};

/// Seeds of the noise with which the instrument plays a table.
const SEEDS: std::ops::RangeInclusive<u32> = 1..=4;
/// Shortest contact in seconds (three samples at 48 kHz), and longest, if no mode needs a shorter
/// one.
const CONTACT_S: [f64; 2] = [6.25e-5, 2e-4];

/// Largest radius of a pole that the instrument plays, with room for the table's rounding.
const MOST_POLE: f64 = 0.999_88;
/// Least real pole of a second-order filter that the instrument plays.
const LEAST_REAL_POLE: f64 = -0.89;

/// Companions of the filter in a fitted table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beside {
    /// At most ten modes beside the filter.
    Modes,
    /// At most ten loops round the filter.
    Loops,
}

/// A recording's strike as a table with a dynamic filter.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The table.
    pub table: kit::Kit,
    /// Model from which the table is made.
    pub model: Model,
    /// Bark bands of the recording beside those of the table.
    ///
    /// The table is played by the instrument at 48 kHz; the decays are the mean of four seeds.
    pub bands: Vec<Comparison>,
}

impl Fitted {
    /// Number of bands whose α is within 15 %.
    pub fn bands_within(&self) -> usize {
        self.bands.iter().filter(|band| band.error() <= 0.15).count()
    }
}

/// Fits filters of second and of first order, and keeps the one whose table keeps more bands within
/// 15 %.
///
/// Both are fitted at the same time. The instrument plays both tables, and refuses paths on which
/// complex poles become real ones. `told` gets the share of the work that is done, from either.
///
/// # Errors
/// [`FitError::Render`] if the instrument plays neither.
pub fn fitted(
    heard: &Heard,
    beside: Beside,
    provenance: &Provenance,
    told: &(dyn Fn(f64) + Sync),
) -> Result<Fitted, FitError> {
    let way = |form| match beside {
        Beside::Modes => Way::Additive(form),
        Beside::Loops => Way::Waveguide(form),
    };
    let done = Mutex::new([0.0; 2]);
    let of_form = |order: usize, form: Form| {
        let told = |share: f64| {
            let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
            done[order] = share;
            told(done.iter().sum::<f64>() / done.len() as f64);
        };
        heard_in_instrument(heard, &way(form).model(heard, &told), provenance)
    };
    let (second, first) = rayon::join(|| of_form(1, Form::SecondOrder), || of_form(0, Form::FirstOrder));
    match (second, first) {
        (Ok(second), Ok(first)) if first.bands_within() > second.bands_within() => Ok(first),
        (Ok(second), _) => Ok(second),
        (Err(_), first) => first,
    }
}

fn heard_in_instrument(heard: &Heard, model: &Model, provenance: &Provenance) -> Result<Fitted, FitError> {
    let length = (heard.length_s * RATE_HZ) as usize;
    let play = |seed| render::by_instrument(&of_model(model, provenance, seed), 0.0, RATE_HZ, length);
    let sounds = SEEDS.map(play).collect::<Result<Vec<_>, FitError>>()?;
    let bands = compare(&heard.law, mean_law(&sounds).as_ref());
    Ok(Fitted { table: of_model(model, provenance, *SEEDS.start()), model: model.clone(), bands })
}

/// The table of a model: the model's sound at velocity 1, and softer strikes by Hertz's law.
pub fn of_model(model: &Model, provenance: &Provenance, seed: u32) -> kit::Kit {
    let silent = Fit::silent(RATE_HZ);
    let mut table = table::of_fit(&silent, provenance);
    let highest_hz = model.modes.iter().map(|mode| mode.frequency_hz).fold(1.0, f64::max);
    let contact_s = (1.0 / highest_hz).clamp(CONTACT_S[0], CONTACT_S[1]);
    if let Some(striker) = table.strikers.first_mut() {
        striker.contact_time_s = contact_s as f32;
    }
    if let Some(object) = table.objects.first_mut() {
        object.modes = model.modes.iter().map(|mode| driven(mode, contact_s)).collect();
        object.dynamic_filter = Some(filter(model, seed));
    }
    table
}

/// The mode that a contact of 1 N and `contact_s` seconds excites as `mode`.
///
/// Its gain is the residue of `mode`, divided by the transform of the force as the instrument plays
/// it, at the mode's pole.
fn driven(mode: &DampedSine, contact_s: f64) -> kit::Mode {
    let pole = Complex::new(-mode.decay_per_s, std::f64::consts::TAU * mode.frequency_hz) / RATE_HZ;
    let force = contact::force(contact_s, RATE_HZ);
    let pulse: Complex<f64> = force.iter().enumerate().map(|(n, x)| (-pole * n as f64).exp() * *x / RATE_HZ).sum();
    let gain = Complex::from_polar(mode.amplitude, mode.phase) / pulse;
    kit::Mode {
        frequency_hz: mode.frequency_hz as f32,
        decay_per_s: mode.decay_per_s as f32,
        gains: vec![kit::Gain { sine: -gain.im as f32, cosine: gain.re as f32 }],
    }
}

fn filter(model: &Model, seed: u32) -> kit::DynamicFilter {
    let points = &model.path.points;
    let second = points.iter().any(|point| point.coefficients.a[1] != 0.0 || point.coefficients.b[2] != 0.0);
    let breakpoint = |point: &Breakpoint| {
        let Coefficients { a, b: [b0, b1, b2] } = point.coefficients;
        let [a1, a2] = played(a, if second { LEAST_REAL_POLE } else { -MOST_POLE });
        let [a1, a2, b0, b1, b2] = [a1, a2, b0, b1, b2].map(|value| value as f32);
        kit::Breakpoint { time_s: point.time_s as f32, noise: point.noise as f32, a1, a2, b0, b1, b2 }
    };
    let round = |one: &Loop| kit::Loop {
        frequency_hz: one.frequency_hz as f32,
        bandwidth_hz: one.bandwidth_hz as f32,
        gain: one.gain as f32,
        delay_s: one.delay_s as f32,
    };
    kit::DynamicFilter {
        seed,
        modes: kit::ModesGo::Beside,
        rate_hz: RATE_HZ as f32,
        exciter: None,
        order: if second { kit::Order::Second } else { kit::Order::First },
        path: points.iter().map(breakpoint).collect(),
        loops: model.loops.iter().map(round).collect(),
    }
}

/// Coefficients a1, a2 with poles clamped to those that the instrument plays.
///
/// A pole that rings longer than a T60 of 1.2 s is moved to that T60.
fn played([a1, a2]: [f64; 2], least: f64) -> [f64; 2] {
    let discriminant = a1 * a1 - 4.0 * a2;
    if discriminant < 0.0 {
        let smaller = (MOST_POLE / a2.sqrt()).min(1.0);
        return [a1 * smaller, a2 * smaller * smaller];
    }
    let [p, q] = [1.0, -1.0].map(|sign| ((-a1 + sign * discriminant.sqrt()) / 2.0).clamp(least, MOST_POLE));
    // The sum keeps -0.0 out: a table of the first order has no a2.
    [-(p + q), p * q + 0.0]
}
