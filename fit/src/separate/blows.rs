//! Blows of a recording: rises of its differentiated sound within a millisecond.

/// Length of a frame in seconds.
const FRAME_S: f64 = 0.001;
/// Number of frames that a rise is compared with. They end one frame before it, because a soft
/// contact rises over two frames.
const BEFORE: usize = 8;
/// Least rise over the loudest of the frames before, as a power ratio: 9 dB.
const RISE: f64 = 8.0;
/// Least power over that of the quietest tenth of the frames: 12 dB.
const ABOVE_NOISE: f64 = 16.0;
/// Least power relative to the loudest frame: -50 dB.
const BELOW_LOUDEST: f64 = 1e-5;
/// Least time in seconds from one blow to the next; of nearer ones the louder counts.
const APART_S: f64 = 0.015;
/// Share of the loudest value within a blow's first milliseconds at which it begins.
const BEGINS: f64 = 0.15;

/// Samples near which blows begin, in order of time, to about a millisecond.
///
/// A recording without a rise has one blow, at its loudest frame.
pub(super) fn blows(samples: &[f64], rate_hz: f64) -> Vec<usize> {
    let size = ((FRAME_S * rate_hz) as usize).max(4);
    let sharp: Vec<f64> = samples.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let power: Vec<f64> = sharp.chunks(size).map(|frame| frame.iter().map(|x| x * x).sum()).collect();
    let mut sorted = power.clone();
    sorted.sort_by(f64::total_cmp);
    let floor = sorted.get(sorted.len() / 10).copied().unwrap_or(0.0);
    let loudest = sorted.last().copied().unwrap_or(0.0);
    let apart = (APART_S / FRAME_S) as usize;
    // First frame of each rise, and the power that it rises to.
    let mut rises: Vec<(usize, f64)> = Vec::new();
    for (index, &now) in power.iter().enumerate() {
        let earlier = index.saturating_sub(BEFORE + 1)..index.saturating_sub(1);
        let before = power[earlier].iter().copied().fold(floor, f64::max);
        if now < RISE * before || now < ABOVE_NOISE * floor || now < BELOW_LOUDEST * loudest {
            continue;
        }
        let reached = power[index..power.len().min(index + 4)].iter().copied().fold(now, f64::max);
        match rises.last_mut() {
            Some(last) if index - last.0 < apart => {
                if reached > 4.0 * last.1 {
                    *last = (index, reached);
                }
            }
            _ => rises.push((index, reached)),
        }
    }
    if rises.is_empty() {
        rises.extend(power.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)));
    }
    rises.into_iter().map(|(frame, _)| begin(&sharp, frame.saturating_sub(1) * size, 4 * size)).collect()
}

/// First sample from `from` on that reaches a share of the loudest of `length` samples.
fn begin(sharp: &[f64], from: usize, length: usize) -> usize {
    let here = &sharp[from..sharp.len().min(from + length)];
    let loudest = here.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    from + here.iter().position(|x| x.abs() >= BEGINS * loudest).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::separate::synthetic::{RATE_HZ, set};

    #[test]
    fn all_blows_and_most_touches_are_found_and_nothing_else() {
        let set = set(1, 2, 2, 4);
        let (mut near, mut found, mut all) = (0, 0, 0);
        for blow in &set {
            let blows = blows(&blow.samples, RATE_HZ);
            near += usize::from(blows.iter().any(|at| (*at as f64 / RATE_HZ - blow.at_s).abs() < 1e-3));
            found += blows.len();
            all += 1 + usize::from(blow.has_touch);
        }
        assert!(near == set.len() && found <= all && found + 4 >= all, "{near} of {}, {found} of {all}", set.len());
    }
}
