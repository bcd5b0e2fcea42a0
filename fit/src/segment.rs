//! Segmentation of a recording into strikes that are heard alone.

use crate::audio::{Note, Recording};
use crate::clipping::Limits;
use crate::error::FitError;

/// One strike in a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hit {
    /// First sample of the strike.
    pub onset: usize,
    /// Sample before which the strike is heard alone.
    pub end: usize,
}

/// Length of a frame in which the level is measured, in seconds.
const FRAME_S: f64 = 0.002;
/// Least rise of a strike over the loudest frame just before it, as a power ratio: 12 dB.
const RISE: f64 = 16.0;
/// Number of frames that count as just before.
const BEFORE: usize = 10;
/// Least level of a strike over the quietest tenth of the recording, as a power ratio: 20 dB.
const ABOVE_NOISE: f64 = 100.0;
/// Least level of a strike relative to the loudest frame, as a power ratio: -30 dB.
const BELOW_LOUDEST: f64 = 1e-3;
/// Least ratio of a pulse of the measured force to the median of its magnitude.
const OVER_FORCE_NOISE: f64 = 10.0;
/// Time in seconds after a strike in which another is taken for its bounce.
const BOUNCE_S: f64 = 0.06;
/// Length in seconds up to which a recording may end before its strike has died away.
const CUT_S: f64 = 0.12;
/// Length in seconds up to which a recording may end soon behind the peak of a strike that swells.
const SWELL_S: f64 = 1.0;
/// Time in seconds before such a strike that is silent.
const QUIET_S: f64 = 0.02;
/// Peak of that silence relative to the strike's: -30 dB.
const OVER_SILENCE: f64 = 0.03;
/// Power of a strike's end relative to its beginning below which it dies away: -6 dB.
const FADED: f64 = 0.25;
/// Power of a strike's end relative to its beginning below which it has died away: -30 dB.
const SILENT: f64 = 1e-3;
/// Least length of a strike in seconds.
const SHORTEST_S: f64 = 0.015;

/// Finds the strikes of a recording.
///
/// With a measured force, each of its pulses is a strike. Without one the sound decides: a strike
/// is a rise by 12 dB over the 20 ms before it. Rises within 60 ms of a strike are its bounces,
/// which a note reports. A recording that begins at its loudest, and dies away, begins with a
/// strike. Without any rise of 12 dB, a recording that dies away by 12 dB is one strike.
///
/// # Errors
/// [`FitError::Silence`] or [`FitError::NoOnset`].
pub fn hits(recording: &Recording) -> Result<(Vec<Hit>, Vec<Note>), FitError> {
    let samples = &recording.samples;
    let peak = samples.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    if peak < 1e-6 {
        return Err(FitError::Silence);
    }
    let size = ((FRAME_S * recording.rate_hz) as usize).max(8);
    let power: Vec<f64> =
        samples.chunks(size).map(|frame| frame.iter().map(|x| x * x).sum::<f64>() / frame.len() as f64).collect();
    let mut sorted: Vec<f64> = power.iter().copied().filter(|power| *power > 0.0).collect();
    sorted.sort_by(f64::total_cmp);
    let floor = sorted.get(sorted.len() / 10).copied().unwrap_or(0.0);
    let loudest = sorted.last().copied().unwrap_or(0.0);
    let mut onsets: Vec<usize> = Vec::new();
    let mut bounces = Vec::new();
    let mut notes = Vec::new();
    if let Some(force) = &recording.force
        && let Some((hits, bounces)) = of_force(samples, force, recording.rate_hz)
    {
        notes.extend((!bounces.is_empty()).then_some(Note::Bounces { at_s: bounces }));
        return Ok((hits, notes));
    }
    let mut has_risen = false;
    for (index, &now) in power.iter().enumerate() {
        // A rise may lie across two frames, unless the frame before has risen already.
        let until = if has_risen { index } else { index.saturating_sub(1).max(index.min(1)) };
        let before = power[index.saturating_sub(BEFORE + 1)..until].iter().copied().fold(0.0, f64::max);
        let at_start = index == 0;
        let rises = if at_start {
            now > loudest * 0.01
        } else {
            now > RISE * before && now > ABOVE_NOISE * floor.min(loudest * 1e-4)
        };
        has_risen = rises;
        if !rises || now < loudest * BELOW_LOUDEST {
            continue;
        }
        let onset = onset_sample(samples, index * size, size);
        match onsets.last() {
            Some(last) if (onset.saturating_sub(*last) as f64) < BOUNCE_S * recording.rate_hz => {
                // The frame after a rise often rises further; only a second rise after a fall is a
                // bounce.
                if power[(last / size).min(index)..index].iter().any(|power| *power > now)
                    || onset.saturating_sub(*last) > 6 * size
                {
                    bounces.push(onset as f64 / recording.rate_hz);
                }
            }
            _ => onsets.push(onset),
        }
    }
    // Power of the end of a stretch relative to that of its beginning.
    let left = |from: usize, to: usize| {
        let level = |range: std::ops::Range<usize>| {
            let slice = &samples[range.start.min(samples.len())..range.end.min(samples.len())];
            slice.iter().map(|x| x * x).sum::<f64>() / slice.len().max(1) as f64
        };
        let part = ((to - from) / 8).max(1);
        let first = level(from..from + part).max(level(from + part..from + 2 * part));
        level(to.saturating_sub(part)..to) / first
    };
    let mut hits: Vec<Hit> = Vec::new();
    for (index, &onset) in onsets.iter().enumerate() {
        let end = onsets.get(index + 1).map_or(samples.len(), |next| next.saturating_sub(size));
        if end <= onset {
            continue;
        }
        // Noise that does not decay is no strike; a sound that is cut soon after has no time to.
        let is_cut = end == samples.len() && ends_soon(samples, onset, recording.rate_hz);
        let left = left(onset, end);
        if left < FADED || is_cut {
            hits.push(Hit { onset, end });
        }
        if is_cut && left > SILENT {
            notes.push(Note::EndsRinging { after_s: (end - onset) as f64 / recording.rate_hz });
        }
    }
    if hits.is_empty()
        && let Some(hit) = without_onset(&power, floor, loudest, size, samples.len())
    {
        notes.push(Note::NoOnset { at_s: hit.onset as f64 / recording.rate_hz });
        hits.push(hit);
    }
    let Some(first) = hits.first() else { return Err(FitError::NoOnset) };
    if first.onset < size {
        notes.push(Note::StartsRinging);
    }
    if !bounces.is_empty() {
        notes.push(Note::Bounces { at_s: bounces });
    }
    Ok((hits, notes))
}

/// Strikes by the pulses of a measured force, and the times of bounces in seconds.
///
/// A pulse stands ten times over the median of the force's magnitude and at most 30 dB below its
/// largest one. The sound's onset is looked for from 2 ms before the pulse on. `None` without
/// pulses: the sound then tells.
fn of_force(samples: &[f64], force: &[f64], rate_hz: f64) -> Option<(Vec<Hit>, Vec<f64>)> {
    let mut levels: Vec<f64> = force.iter().map(|x| x.abs()).collect();
    levels.sort_by(f64::total_cmp);
    let (noise, loudest) = (*levels.get(levels.len() / 2)?, *levels.last()?);
    let least = (OVER_FORCE_NOISE * noise).max(loudest * BELOW_LOUDEST.sqrt());
    let (size, apart) = (((FRAME_S * rate_hz) as usize).max(8), (BOUNCE_S * rate_hz) as usize);
    let (mut onsets, mut bounces): (Vec<usize>, Vec<f64>) = (Vec::new(), Vec::new());
    let (mut last, mut is_over) = (None, false);
    let mut over = 0;
    for (at, x) in force.iter().enumerate() {
        if *x <= least {
            is_over &= at < over + size;
            continue;
        }
        over = at;
        if std::mem::replace(&mut is_over, true) {
            continue;
        }
        if last.is_some_and(|last| at - last < apart) {
            bounces.push(at as f64 / rate_hz);
        } else {
            last = Some(at);
            onsets.push(onset_sample(samples, at, size).clamp(at.saturating_sub(size), at + 2 * size));
        }
    }
    let ends = onsets.iter().skip(1).map(|next| next.saturating_sub(size)).chain([samples.len()]);
    let hits: Vec<Hit> = onsets.iter().zip(ends).map(|(&onset, end)| Hit { onset, end }).collect();
    let hits: Vec<Hit> = hits.into_iter().filter(|hit| hit.end > hit.onset).collect();
    (!hits.is_empty()).then_some((hits, bounces))
}

/// Selects hits, counted from 1; all if none is named.
///
/// # Errors
/// [`FitError::NoSuchHit`] for a hit that does not exist, [`FitError::TooShort`] for one shorter
/// than 15 ms, [`FitError::Clipped`] for one with a flat top, or with more than a tenth
/// of its first 20 ms at its largest value.
pub fn select(recording: &Recording, hits: &[Hit], wanted: &[usize]) -> Result<Vec<Hit>, FitError> {
    let rate_hz = recording.rate_hz;
    let chosen = if wanted.is_empty() {
        hits.to_vec()
    } else {
        let pick = |&hit: &usize| {
            hit.checked_sub(1)
                .and_then(|index| hits.get(index))
                .copied()
                .ok_or(FitError::NoSuchHit { hit, found: hits.len() })
        };
        wanted.iter().map(pick).collect::<Result<Vec<_>, _>>()?
    };
    let is_short = |hit: &&Hit| ((hit.end - hit.onset) as f64) < SHORTEST_S * rate_hz;
    let chosen: Vec<Hit> = match chosen.iter().find(is_short) {
        Some(hit) if !wanted.is_empty() || chosen.iter().all(|hit| is_short(&hit)) => {
            let length_ms = (hit.end - hit.onset) as f64 / rate_hz * 1e3;
            return Err(FitError::TooShort { at_s: hit.onset as f64 / rate_hz, length_ms });
        }
        _ => chosen.into_iter().filter(|hit| !is_short(&hit)).collect(),
    };
    check_clipping(recording, &chosen)?;
    Ok(chosen)
}

/// True if a recording ends soon behind a strike's beginning, or behind its peak, where the strike
/// rises out of silence and swells.
fn ends_soon(samples: &[f64], onset: usize, rate_hz: f64) -> bool {
    let count = |seconds: f64| (seconds * rate_hz) as usize;
    let length = samples.len() - onset;
    if length < count(CUT_S) {
        return true;
    }
    let loudest = |part: &[f64]| part.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let quiet = &samples[onset.saturating_sub(count(QUIET_S))..onset.saturating_sub(count(FRAME_S))];
    let swell = &samples[onset..samples.len() - count(CUT_S)];
    let is_silent_before = !quiet.is_empty() && loudest(quiet) < OVER_SILENCE * loudest(&samples[onset..]);
    length < count(SWELL_S) && is_silent_before && loudest(swell) < loudest(&samples[onset + swell.len()..])
}

/// The strike of a recording that rises slowly, if it dies away by 12 dB.
///
/// It begins with the first frame that stands 6 dB over the quietest tenth and is at most 30 dB
/// below the loudest.
fn without_onset(power: &[f64], floor: f64, loudest: f64, size: usize, length: usize) -> Option<Hit> {
    let part = (power.len() / 8).max(1);
    let mean = |powers: &[f64]| powers.iter().sum::<f64>() / powers.len().max(1) as f64;
    let most = power.chunks(part).map(mean).fold(0.0, f64::max);
    let last = mean(&power[power.len().saturating_sub(part)..]);
    let begins = |&now: &f64| now > (4.0 * floor.min(loudest * 1e-2)).max(loudest * BELOW_LOUDEST);
    let first = power.iter().position(begins)?;
    (last < most / RISE).then_some(Hit { onset: first * size, end: length })
}

/// First sample in or just before a frame that rises above the sound before it, by about a tenth of
/// the following peak.
pub(crate) fn onset_sample(samples: &[f64], frame: usize, size: usize) -> usize {
    let ahead = &samples[frame..samples.len().min(frame + 3 * size)];
    let peak = ahead.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let start = frame.saturating_sub(size);
    let quiet = &samples[start.saturating_sub(4 * size)..start];
    let noise = quiet.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let threshold = (0.08 * peak).max(1.5 * noise).min(0.5 * peak);
    let first = samples[start..].iter().position(|x| x.abs() > threshold).unwrap_or(0);
    // The rise began a little earlier.
    (start + first).saturating_sub(2)
}

fn check_clipping(recording: &Recording, hits: &[Hit]) -> Result<(), FitError> {
    for hit in hits {
        let length = ((0.02 * recording.rate_hz) as usize).min(hit.end - hit.onset);
        let attack = &recording.samples[hit.onset..hit.onset + length];
        let limits = Limits::of(attack);
        let stands = |pair: &[f64]| limits.are_reached(pair[0], 0.9999) && pair[0] == pair[1];
        let clipped = attack.windows(2).filter(|pair| stands(pair)).count();
        let tops = recording.flat_tops.iter().filter(|top| (hit.onset..hit.end).contains(&top.start));
        let first = tops.clone().next().map(|top| if top.start < hit.onset + length { hit.onset } else { top.start });
        let flat: usize = match first {
            Some(first) => tops.filter(|top| top.start < first + length).map(ExactSizeIterator::len).sum(),
            None => 0,
        };
        if flat > 0 || clipped * 10 > attack.len() {
            let percent = 100.0 * flat.max(clipped).min(attack.len()) as f64 / attack.len() as f64;
            return Err(FitError::Clipped { at_s: hit.onset as f64 / recording.rate_hz, percent });
        }
    }
    Ok(())
}
