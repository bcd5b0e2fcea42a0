//! Fit of strikes from sound alone, without a measured force.

use nalgebra::Complex;

use super::fit::{Estimator, Fit, Mode, Settings, Strike, table_acceleration, table_gain};
use super::near::{Heard, Near};
use crate::bins;
use crate::contact::{contact_time_s, force};
use crate::distance::Background;
use crate::distance::{RecordedLevels, lsd_window};
use crate::error::FitError;
use crate::modes::{Ending, Gains, Group, Model, Pole, Stretch, estimate_poles, polish, refine};
use crate::segment::Hit;

/// Contact time in seconds that is assumed if the sound does not tell.
const USUAL_CONTACT_S: f64 = 5e-4;
/// Maximum length of a strike that is fitted, in seconds.
const LONGEST_S: f64 = 12.0;

/// Fits the strikes of a recording from sound alone.
///
/// The modes come from the loudest strike's free ringing after its contact. Their poles are then
/// refined over all strikes together, each driven by a force of peak 1 with the contact time that
/// its sound shows, and with gains of its own. So gains contain the size of the force, as with the
/// normalisation of diffimpact eq. 9.
///
/// # Errors
/// [`FitError::NoModes`] if no mode is found.
pub fn fit_sound(samples: &[f64], rate_hz: f64, hits: &[Hit], settings: Settings) -> Result<Fit, FitError> {
    let heard: Vec<&[f64]> = hits.iter().map(|hit| heard(samples, hit, rate_hz)).collect();
    let peak = |sound: &[f64]| sound.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let loudest = (0..hits.len()).max_by(|&a, &b| peak(heard[a]).total_cmp(&peak(heard[b]))).unwrap_or(0);
    let at_s = hits.get(loudest).map_or(0.0, |hit| hit.onset as f64 / rate_hz);
    let contacts_s: Vec<f64> =
        heard.iter().map(|sound| contact_time_s(sound, rate_hz).unwrap_or(USUAL_CONTACT_S)).collect();
    let forces: Vec<Vec<f64>> = contacts_s.iter().map(|&time_s| force(time_s, rate_hz)).collect();
    if settings.estimator == Estimator::Bins {
        let (Some(hit), Some(sound), Some(contact_s)) =
            (hits.get(loudest), heard.get(loudest), contacts_s.get(loudest))
        else {
            return Err(FitError::NoModes { at_s });
        };
        return of_bins(samples, sound, rate_hz, hit, *contact_s, settings).ok_or(FitError::NoModes { at_s });
    }
    if let (true, Some(hit), Some(force)) = (settings.polish, hits.get(loudest), forces.get(loudest)) {
        let end = hit.onset + heard.get(loudest).map_or(0, |sound| sound.len());
        let (before, strike) = samples[..hit.end.min(samples.len())].split_at(hit.onset);
        let background = Background::under(before, strike, rate_hz);
        let background = background.as_ref();
        let near = Heard { samples, onset: hit.onset, end, last: hit.end, rate_hz, force, background };
        if let Some(near) = near.near(settings.modes) {
            let is_exact = matches!(near, Near::Exact(_));
            let (poles, gains, noise) = match near {
                Near::Exact((poles, gains)) => (poles, gains, Vec::new()),
                Near::Approached(sounding) => (sounding.poles, sounding.gains, sounding.bands),
            };
            let model = with_loudest(poles, gains, &groups(&heard, &forces), loudest);
            let fit = described(samples, &model, &groups(&heard, &forces), hits, &contacts_s, loudest, rate_hz);
            return Ok(Fit { noise, is_exact, ..fit });
        }
    }
    let behind = forces.get(loudest).map_or(0, Vec::len);
    let ringing = heard.get(loudest).and_then(|sound| sound.get(behind..)).unwrap_or(&[]);
    let poles = estimate_poles(ringing, rate_hz, settings.modes);
    if poles.is_empty() {
        return Err(FitError::NoModes { at_s });
    }
    let groups = groups(&heard, &forces);
    let ending = if groups.len() > 1 { Ending::COARSE } else { Ending { steps: 0, ..Ending::COARSE } };
    let mut model = refine(&groups, &poles, ending).ok_or(FitError::NoModes { at_s })?;
    if settings.polish {
        polished(&mut model, &groups, loudest, rate_hz);
    }
    Ok(described(samples, &model, &groups, hits, &contacts_s, loudest, rate_hz))
}

fn groups<'a>(heard: &[&'a [f64]], forces: &'a [Vec<f64>]) -> Vec<Group<'a>> {
    let group = |(samples, force): (&&'a [f64], &'a Vec<f64>)| {
        let force = Some(&force[..force.len().min(samples.len())]);
        Group { stretches: vec![Stretch { samples, force }] }
    };
    heard.iter().zip(forces).map(group).collect()
}

/// A model with the given gains of the loudest strike; the gains of the others are solved for.
fn with_loudest(poles: Vec<Pole>, gains: Gains, groups: &[Group<'_>], loudest: usize) -> Model {
    let none = || Gains { modes: vec![Complex::new(0.0, 0.0); poles.len()], force: 0.0 };
    let every = groups.iter().enumerate().map(|(index, group)| {
        if index == loudest {
            return gains.clone();
        }
        let solved = refine(std::slice::from_ref(group), &poles, Ending { steps: 0, ..Ending::COARSE });
        solved.and_then(|model| model.gains.into_iter().next()).unwrap_or_else(none)
    });
    Model { gains: every.collect(), worth_by_group: vec![Vec::new(); poles.len()], poles }
}

fn heard<'a>(samples: &'a [f64], hit: &Hit, rate_hz: f64) -> &'a [f64] {
    let end = hit.end.min(hit.onset + (LONGEST_S * rate_hz) as usize).min(samples.len());
    samples.get(hit.onset..end).unwrap_or(&[])
}

/// The strongest modes of the bins estimator, as the response to a force of the contact time.
///
/// Each gain is divided by the contact's spectrum, which has no zeros, so that the mode rings as it
/// was measured. Phases are 0 or π by turns: with 0 alone, as in physics-diffusion §3.1, a thousand
/// modes begin in a click far above their ring.
fn of_bins(
    samples: &[f64],
    sound: &[f64],
    rate_hz: f64,
    hit: &Hit,
    contact_time_s: f64,
    settings: Settings,
) -> Option<Fit> {
    let sines = bins::strongest(bins::estimate(sound, rate_hz), settings.modes.most_modes);
    if sines.is_empty() {
        return None;
    }
    let force = force(contact_time_s, rate_hz);
    let force = &force[..force.len().min(sound.len())];
    let poles: Vec<Pole> = sines.iter().map(|sine| Pole::new(sine.frequency_hz, sine.decay_per_s, rate_hz)).collect();
    let gains = sines.iter().zip(&poles).zip(rudin_shapiro()).map(|((sine, pole), sign)| {
        let contact: Complex<f64> = force.iter().enumerate().map(|(m, x)| pole.power(-(m as f64)) * *x).sum();
        sign * Complex::from_polar(sine.amplitude, sine.phase) / contact
    });
    let gains = Gains { modes: gains.collect(), force: 0.0 };
    let worth_by_group = vec![Vec::new(); poles.len()];
    let model = Model { poles, gains: vec![gains], worth_by_group };
    let groups = [Group { stretches: vec![Stretch { samples: sound, force: Some(force) }] }];
    Some(described(samples, &model, &groups, &[*hit], &[contact_time_s], 0, rate_hz))
}

/// Signs of the Rudin-Shapiro sequence.
///
/// A sum of n sines a step of frequency apart with these signs never exceeds `√(2n)` times their
/// amplitude; with equal signs they begin in a click of up to n times their amplitude.
fn rudin_shapiro() -> impl Iterator<Item = f64> {
    (0u32..).map(|index| if (index & (index >> 1)).count_ones() % 2 == 0 { 1.0 } else { -1.0 })
}

/// Polishes the loudest strike; the gains of the others are then solved for anew.
fn polished(model: &mut Model, groups: &[Group<'_>], loudest: usize, rate_hz: f64) {
    let stretch = groups[loudest].stretches[0];
    // The comparison begins at the onset, not at the peak: otherwise fast modes would go astray
    // before it.
    let wanted = &stretch.samples[..lsd_window(stretch.samples, rate_hz).end];
    let (poles, gains) = polish(&stretch, wanted, &model.poles, &model.gains[loudest]);
    if let Some(solved) = refine(groups, &poles, Ending { steps: 0, ..Ending::COARSE }) {
        *model = solved;
        model.gains[loudest] = gains;
    }
}

fn described(
    samples: &[f64],
    model: &Model,
    groups: &[Group<'_>],
    hits: &[Hit],
    contacts_s: &[f64],
    loudest: usize,
    rate_hz: f64,
) -> Fit {
    let strikes =
        groups.iter().zip(hits).zip(contacts_s).enumerate().map(|(index, ((group, hit), &contact_time_s))| {
            let stretch = group.stretches[0];
            let left = model.residual(index, &stretch);
            let rendering: Vec<f64> = stretch.samples.iter().zip(&left).map(|(x, left)| x - left).collect();
            let recorded = RecordedLevels::new(&samples[..hit.onset.min(samples.len())], stretch.samples, rate_hz);
            let energy_left: f64 = left.iter().map(|x| x * x).sum();
            Strike {
                hit: *hit,
                contact_time_s,
                peak_force: 1.0,
                position: 0.0,
                acceleration: table_acceleration(&model.gains[index]),
                lsd_db: recorded.lsd_db(&rendering),
                residual_db: 10.0 * (energy_left / stretch.energy()).log10(),
            }
        });
    let mut modes: Vec<Mode> = model
        .poles
        .iter()
        .enumerate()
        .map(|(k, pole)| Mode {
            frequency_hz: pole.frequency_hz(rate_hz),
            decay_per_s: pole.decay_per_s(rate_hz),
            gains: model.gains.iter().map(|gains| table_gain(gains.modes[k], rate_hz)).collect(),
        })
        .collect();
    modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    Fit { rate_hz, modes, strikes: strikes.collect(), measured: false, noise: Vec::new(), is_exact: false, loudest }
}
