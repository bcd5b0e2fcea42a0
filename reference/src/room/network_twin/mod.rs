//! The instrument's network in double precision: a twin that proves its arithmetic.
//!
//! It shares everything with `dsp-core`'s room but rounding and bounds: the feed's chains, the splits,
//! the delays, the angles, and the cycles that the number of sections follows from. So it says
//! whether the instrument computes what it means to, sample by sample, and nothing about whether
//! that is the law: [`super::room`] renders the law itself.

mod feed;
mod lean;
mod network;
mod split;

use super::RoomBand;
use crate::SampleRate;

/// Frames of a block: the wet sound begins two blocks after the dry one.
const BLOCK_FRAMES: usize = 128;
/// Lines of a network; each holds pairs.
const LINES: usize = 4;

/// One band's network.
pub(crate) struct Plan {
    division: usize,
    /// Where the band ends, in Hz.
    to_hz: f64,
    /// At the lower edge; none for the lowest band.
    split: Option<lean::Leaning>,
    /// Of pairs.
    delays: Vec<usize>,
    gains: Vec<f64>,
    /// Samples that are mixed by one angle.
    held: usize,
    output: f64,
}

/// The network's answer to both sides of a sound, without that sound: left and right. Delays take at
/// most `samples` in all.
///
/// Bands are trusted: rising from 0, below 0.49 of the rate.
pub fn network_twin(bands: &[RoomBand], dry: [&[f64]; 2], rate: SampleRate, samples: usize) -> [Vec<f64>; 2] {
    let hz = rate.hz();
    let plans = plans(bands, hz, samples);
    let frames = dry[0].len();
    let blocks = frames.div_ceil(BLOCK_FRAMES);
    let mut low = feed::feed(dry);
    low.resize(blocks * BLOCK_FRAMES, 0.0);
    let (mut division, mut answers) = (1, Vec::new());
    for plan in plans.iter().rev() {
        low = low.into_iter().step_by(plan.division / division).collect();
        division = plan.division;
        let high = match &plan.split {
            None => std::mem::take(&mut low),
            Some(lean::Leaning { low_pass, tangent }) => {
                let (below, above) = split::split(&low, low_pass, *tangent);
                low = below;
                above
            }
        };
        answers.push((division, network::render(plan, &high, hz)));
    }
    // From the rate over `division` to twice it.
    let double = |signal: &[f64], division: usize| {
        let slow = plans.iter().filter(|plan| plan.division >= division);
        let highest_hz = slow.map(|plan| plan.to_hz).fold(0.0, f64::max);
        split::double(signal, highest_hz * division as f64 / hz)
    };
    let mut sum = [Vec::new(), Vec::new()];
    for (own, answer) in answers.into_iter().rev() {
        for (sum, answer) in sum.iter_mut().zip(answer) {
            let mut slower = division;
            while slower > own {
                *sum = double(sum, slower);
                slower /= 2;
            }
            sum.resize(answer.len(), 0.0);
            sum.iter_mut().zip(answer).for_each(|(sum, answer)| *sum += answer);
        }
        division = own;
    }
    while division > 1 {
        sum = sum.map(|side| double(&side, division));
        division /= 2;
    }
    sum.map(|side| std::iter::repeat_n(0.0, 2 * BLOCK_FRAMES).chain(side).take(frames).collect())
}

fn plans(bands: &[RoomBand], hz: f64, samples: usize) -> Vec<Plan> {
    let to_hz = |band: usize| bands.get(band + 1).map_or(hz / 2.0, |next| next.from_hz);
    let (slowest, edge) = if bands.len() <= 4 { (8, 0.42) } else { (32, 0.35) };
    let divisions: Vec<usize> = (0..bands.len())
        .map(|band| {
            let fits = |division: usize| to_hz(band) * division as f64 <= edge * hz;
            [32, 16, 8, 4, 2].into_iter().find(|&division| division <= slowest && fits(division)).unwrap_or(1)
        })
        .collect();
    // Seconds of delay: 0.15 of T60 or a hundred resonances in the band, within the memory and 47 blocks for the longest line.
    let wishes: Vec<f64> = bands
        .iter()
        .enumerate()
        .map(|(band, law)| {
            let wish = (0.15 * 1000f64.ln() / law.decay_per_s).max(100.0 / (to_hz(band) - law.from_hz));
            // Dense enough in the highest band.
            if band + 1 == bands.len() { wish.min(0.16) } else { wish }
        })
        .collect();
    let parts: Vec<f64> = {
        let sum: f64 = (0..LINES as i32).map(|line| 1.4f64.powi(line)).sum();
        (0..LINES as i32).map(|line| 1.4f64.powi(line) / sum).collect()
    };
    let needed = |limit: f64| -> f64 {
        wishes.iter().zip(&divisions).map(|(wish, &division)| wish.min(limit) * hz / division as f64).sum()
    };
    let (mut limit, mut high) = (0.0, 2.0 * 47.0 * BLOCK_FRAMES as f64 / hz / parts[LINES - 1]);
    if needed(high) <= samples as f64 {
        limit = high;
    }
    for _ in 0..30 {
        let middle = 0.5 * (limit + high);
        if needed(middle) <= samples as f64 { limit = middle } else { high = middle }
    }
    let (splits, factors) = lean::leanings(bands, &divisions, hz);
    let splits = std::iter::once(None).chain(splits.into_iter().map(Some));
    let band = |(band, split): (usize, Option<lean::Leaning>)| {
        let own_hz = hz / divisions[band] as f64;
        let delays = delays(0.5 * wishes[band].min(limit) * own_hz, BLOCK_FRAMES / divisions[band], &parts);
        let law = bands[band];
        let gains: Vec<f64> = delays.iter().map(|&delay| (-law.decay_per_s * delay as f64 / own_hz).exp()).collect();
        // Energy as in a network of pipes: each value's output is spread evenly over all. Outputs are differences of lines 2 and 3.
        let passed: Vec<f64> = gains.iter().map(|gain| gain * gain).collect();
        let given = 1.0 / 16.0 / (1.0 - passed.iter().sum::<f64>() / LINES as f64);
        let output = law.gain * (factors[band] / (2.0 * law.decay_per_s * given * (passed[2] + passed[3]))).sqrt();
        let held_frames = if bands.len() <= 4 && divisions[band] > 1 { 32 } else { 16 };
        let held = (held_frames / divisions[band]).max(1);
        Plan { held, division: divisions[band], to_hz: to_hz(band), split, delays, gains, output }
    };
    (0..bands.len()).zip(splits).map(band).collect()
}

/// Distinct primes, each at most its part of `total` unless the block is longer.
fn delays(total: f64, block: usize, parts: &[f64]) -> Vec<usize> {
    let is_prime = |n: usize| n > 1 && (2..).take_while(|d| d * d <= n).all(|d| !n.is_multiple_of(d));
    let mut delays = Vec::new();
    for part in parts {
        let least = block.max(delays.last().map_or(2, |last| last + 1));
        let wanted = ((part * total) as usize).max(least);
        let below = (least..=wanted).rev().find(|&n| is_prime(n));
        delays.push(below.unwrap_or_else(|| (wanted..).find(|&n| is_prime(n)).unwrap_or(wanted)));
    }
    delays
}
