//! From a table of bands to rates, delays and gains.

use super::dimensions::{BLOCK_FRAMES, LINES, MAX_BANDS, MAX_BLOCKS, SLOWEST, TICKS};
use super::error::RoomError;
use super::lean::{self, Edge, Leaning, Side};
use super::lines::INPUT_GAIN;
use super::split::{LEAST_SECTIONS, MOST_SECTIONS, Split};
use super::turn::TURN_FRAMES;
use crate::SampleRate;
use crate::exponential;
use crate::table::layout::RoomBandRecord;

/// Highest edge of a band that may run at a rate, of that rate, of few bands and of more. The lower
/// it is, the weaker are the images that doubling leaves.
const FEW_BANDS_EDGE: f64 = 0.42;
const EDGE: f64 = 0.35;
/// Number of bands up to which none is slower than [`FEW_BANDS_DIVISION`]: doublings cost more than
/// that saves.
const FEW_BANDS: usize = 4;
const FEW_BANDS_DIVISION: usize = 8;
/// Sum of a network's delays over its T60 ...
const DELAY_OF_T60: f64 = 0.15;
/// ... or number of resonances in its band, so that a narrow one does not beat, whichever takes
/// longer delays.
const RESONANCES: f64 = 100.0;
/// Longest delays of the highest band, in seconds: short enough for a thousand echoes a second
/// within 100 ms.
const DENSE_S: f64 = 0.16;
/// Ratio of neighbouring delays.
const RATIO: f64 = 1.4;
/// Plan of a band's network.
#[derive(Clone, Copy, Debug)]
pub(super) struct BandPlan {
    /// Division of the rate at which it runs: 1, 2, 4 ... 32.
    pub division: usize,
    /// Its upper edge, of its own rate.
    pub to: f64,
    /// Split at its lower edge; none for the lowest band.
    pub split: Split,
    /// Delays of its lines of pairs at its own rate, distinct primes, rising. The sound is read
    /// from the two longest. Read from the two shortest, it would begin 10 ms earlier, but late
    /// spectra would stand 2.5 dB further above their mean (16 KB), and 16-bit lines would keep 7
    /// dB less of a tail of 20 s.
    pub delays: [usize; LINES],
    /// Number of samples that are mixed by one angle.
    pub turn_samples: usize,
    /// Decay in nepers a sample at its own rate.
    pub decay_per_sample: f64,
    /// Gain of the output.
    pub output: f64,
}

impl BandPlan {
    pub(super) const NONE: Self = Self {
        division: 1,
        to: 0.0,
        split: Split::NONE,
        delays: [0; LINES],
        turn_samples: 1,
        decay_per_sample: 0.0,
        output: 0.0,
    };

    /// Number of samples of a block.
    pub(super) fn block(&self) -> usize {
        BLOCK_FRAMES / self.division
    }
}

/// Plans all bands for `words` samples of delay.
pub(super) fn plan(
    bands: &[RoomBandRecord],
    rate: SampleRate,
    words: usize,
) -> Result<[BandPlan; MAX_BANDS], RoomError> {
    if bands.len() > MAX_BANDS {
        return Err(RoomError::TooManyBands { bands: bands.len(), capacity: MAX_BANDS });
    }
    let hz = rate.hz();
    let mut lowest = 0.0;
    for (band, record) in bands.iter().enumerate() {
        let from_hz = f64::from(record.from_hz.get());
        let ordered = if band == 0 { from_hz == 0.0 } else { from_hz > lowest };
        if !ordered {
            return Err(RoomError::EdgesOutOfOrder { band, from_hz: record.from_hz.get() });
        }
        if from_hz >= MAX_EDGE * hz {
            return Err(RoomError::EdgeAboveNyquist { band, from_hz: record.from_hz.get(), rate });
        }
        let decay_per_s = record.decay_per_s.get();
        if !crate::table::range::ROOM_DECAY_PER_S.holds(decay_per_s) {
            return Err(RoomError::Decay { band, decay_per_s });
        }
        if !crate::table::range::ROOM_GAIN.holds(record.gain.get()) {
            return Err(RoomError::Gain { band, gain: record.gain.get() });
        }
        lowest = from_hz;
    }
    let mut plans = [BandPlan::NONE; MAX_BANDS];
    let mut delays_s = [0.0; MAX_BANDS];
    let (slowest, edge) = if bands.len() <= FEW_BANDS { (FEW_BANDS_DIVISION, FEW_BANDS_EDGE) } else { (SLOWEST, EDGE) };
    for (band, plan) in plans.iter_mut().enumerate().take(bands.len()) {
        let (from_hz, to_hz) = edges_hz(bands, band, hz);
        while plan.division < slowest && to_hz * (2 * plan.division) as f64 <= edge * hz {
            plan.division *= 2;
        }
        plan.to = to_hz * plan.division as f64 / hz;
        if let (Some(record), Some(delay_s)) = (bands.get(band), delays_s.get_mut(band)) {
            let t60_s = T60_PER_TIME_CONSTANT / f64::from(record.decay_per_s.get());
            *delay_s = (DELAY_OF_T60 * t60_s).max(RESONANCES / (to_hz - from_hz));
            if band + 1 == bands.len() {
                *delay_s = delay_s.min(DENSE_S);
            }
        }
    }
    share(&mut delays_s, &plans, hz, words);
    let energies = split(&mut plans, bands, hz);
    for (((plan, record), &delay_s), energy) in plans.iter_mut().zip(bands).zip(&delays_s).zip(energies) {
        let own_rate = hz / plan.division as f64;
        let decay_per_s = f64::from(record.decay_per_s.get());
        plan.delays = delays(0.5 * delay_s * own_rate, plan.block());
        // The slower ones of few bands have no cycles for finer steps.
        let coarse = bands.len() <= FEW_BANDS && plan.division > 1;
        plan.turn_samples = (if coarse { 2 * TURN_FRAMES } else { TURN_FRAMES } / plan.division).max(1);
        plan.decay_per_sample = decay_per_s / own_rate;
        plan.output = libm::sqrt(energy) * f64::from(record.gain.get()) * output_gain(plan, decay_per_s);
    }
    let needed = 2 * plans.iter().flat_map(|plan| plan.delays).sum::<usize>();
    if needed > words {
        return Err(RoomError::TooFewSamples { needed, capacity: words });
    }
    Ok(plans)
}

/// `ln 1000`.
const T60_PER_TIME_CONSTANT: f64 = 6.907_755_278_982_137;
/// Highest lower edge of a band, of the rate.
const MAX_EDGE: f64 = 0.49;

fn edges_hz(bands: &[RoomBandRecord], band: usize, hz: f64) -> (f64, f64) {
    let edge = |band: usize| bands.get(band).map_or(hz / 2.0, |record| f64::from(record.from_hz.get()));
    (edge(band), edge(band + 1))
}

/// Upper end of the highest of the bands that run at the rate over `division`, or slower, of that
/// rate. 0 if there is none.
pub(super) fn highest_end(plans: &[BandPlan; MAX_BANDS], division: usize) -> f64 {
    let slow = plans.iter().filter(|plan| plan.division >= division);
    slow.map(|plan| plan.to * division as f64 / plan.division as f64).fold(0.0, f64::max)
}

/// A band as its neighbours' splits see it.
fn side(record: &RoomBandRecord) -> Side {
    let (gain, decay_per_s) = (f64::from(record.gain.get()).max(LEAST_GAIN), f64::from(record.decay_per_s.get()));
    Side { decay_per_s, energy: gain * gain / (2.0 * decay_per_s) }
}

/// Plans the splits. Gives the factors of the bands' energies that make up for their losses beyond
/// their edges, and for their neighbours' additions within them.
fn split(plans: &mut [BandPlan; MAX_BANDS], bands: &[RoomBandRecord], hz: f64) -> [f64; MAX_BANDS] {
    let sections = sections(plans, bands);
    // Energy between a band's edges: its own, and its neighbours', times hertz.
    let (mut own, mut others) = ([0.0; MAX_BANDS], [0.0; MAX_BANDS]);
    for (band, own) in own.iter_mut().enumerate().take(bands.len()) {
        let (from_hz, to_hz) = edges_hz(bands, band, hz);
        *own = to_hz - from_hz;
    }
    for (band, (pair, &sections)) in bands.array_windows::<2>().zip(&sections).enumerate() {
        let [low, high] = pair.each_ref().map(side);
        let ((from_hz, edge_hz), (_, to_hz)) = (edges_hz(bands, band, hz), edges_hz(bands, band + 1, hz));
        let Some(plan) = plans.get_mut(band + 1) else { break };
        let own_hz = hz / plan.division as f64;
        let below = bands.iter().take(band + 1).map(|below| lean::drowning_db(&high, &side(below)));
        let by_high_db = below.fold(f64::MIN, f64::max);
        let at = Edge { from: from_hz / own_hz, edge: edge_hz / own_hz, to: to_hz / own_hz };
        let Leaning { split, lost_below, lost_above } =
            lean::leaning(lean::drowning_db(&low, &high), by_high_db, &at, sections);
        plan.split = split;
        if let (Some([own_low, own_high]), Some([others_low, others_high])) = (
            own.get_mut(band..).and_then(<[f64]>::first_chunk_mut),
            others.get_mut(band..).and_then(<[f64]>::first_chunk_mut),
        ) {
            *own_low -= lost_below * own_hz;
            *own_high -= lost_above * own_hz;
            *others_low += lost_below * own_hz * high.energy;
            *others_high += lost_above * own_hz * low.energy;
        }
    }
    let mut factors = [1.0; MAX_BANDS];
    for (band, (factor, record)) in factors.iter_mut().zip(bands).enumerate() {
        let (from_hz, to_hz) = edges_hz(bands, band, hz);
        let (own, others) = (own.get(band).copied().unwrap_or(1.0), others.get(band).copied().unwrap_or(0.0));
        let wanted = (to_hz - from_hz) - others / side(record).energy;
        *factor = (wanted / own.max(0.5 * (to_hz - from_hz))).clamp(LEAST_FACTOR, 1.0 / LEAST_FACTOR);
    }
    factors
}

/// Numbers of sections of the splits, from the lowest edge up: as wanted, as far as the cycles
/// reach; the lowest edges first, where a section costs least.
fn sections(plans: &[BandPlan; MAX_BANDS], bands: &[RoomBandRecord]) -> [usize; MAX_BANDS] {
    let mut sections = [LEAST_SECTIONS; MAX_BANDS];
    let limit = if bands.len() <= FEW_BANDS { FEW_BANDS_CYCLES } else { CYCLES };
    let mut left = limit.saturating_sub(cycles(plans, bands.len()));
    for count in LEAST_SECTIONS + 1..=MOST_SECTIONS {
        let splits = sections.iter_mut().zip(bands.array_windows::<2>()).zip(plans.iter().skip(1));
        for ((sections, [low, high]), plan) in splits {
            let cost = SECTION_CYCLES * PARTS / plan.division;
            if lean::sections_wanted(&side(low), &side(high)) >= count && *sections + 1 == count && cost <= left {
                (*sections, left) = (count, left - cost);
            }
        }
    }
    sections
}

/// Cycles a frame with splits of two sections, in parts.
fn cycles(plans: &[BandPlan; MAX_BANDS], bands: usize) -> usize {
    let networks = plans.iter().take(bands).map(|plan| NETWORK_CYCLES[0] * PARTS / plan.division);
    let splits = plans.iter().take(bands).skip(1).map(|plan| SPLIT_CYCLES[0] * PARTS / plan.division);
    let slow = plans.first().is_some_and(|plan| plan.division > 1);
    let ends = (FRAME_CYCLES + BAND_CYCLES * bands) * PARTS;
    networks.chain(splits).sum::<usize>() + ends + if slow { DOUBLING_CYCLES[0] * PARTS } else { 0 }
}

/// Cuts the wishes (seconds of delay, all lines of a band together) to the memory: the same limit
/// for all.
fn share(delays_s: &mut [f64; MAX_BANDS], plans: &[BandPlan; MAX_BANDS], hz: f64, words: usize) {
    let needed = |limit: f64| {
        let each = delays_s.iter().zip(plans).map(|(delay_s, plan)| delay_s.min(limit) * hz / plan.division as f64);
        each.sum::<f64>()
    };
    // The longest line must not outlast the history of exponents.
    let weights = weights();
    let longest_part = weights.iter().fold(0.0, |longest: f64, &weight| longest.max(weight));
    let (mut low, mut high) = (0.0, 2.0 * (MAX_BLOCKS * BLOCK_FRAMES) as f64 / hz / longest_part);
    if needed(high) > words as f64 {
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            match needed(middle) <= words as f64 {
                true => low = middle,
                false => high = middle,
            }
        }
        high = low;
    }
    for delay_s in delays_s {
        *delay_s = delay_s.min(high);
    }
}

/// Parts of all delays that each line has.
fn weights() -> [f64; LINES] {
    let (mut weight, mut sum) = (1.0, 0.0);
    let weights = [(); LINES].map(|()| {
        let this = weight;
        sum += this;
        weight *= RATIO;
        this
    });
    weights.map(|weight| weight / sum)
}

/// Distinct primes near the parts of `total`, not above them unless a block asks for it.
fn delays(total: f64, block: usize) -> [usize; LINES] {
    let mut last = 1;
    weights().map(|weight| {
        let wanted = ((weight * total) as usize).max(block).max(last + 1);
        let below = (block.max(last + 1)..=wanted).rev().find(|&n| is_prime(n));
        last = below.unwrap_or_else(|| (wanted..).find(|&n| is_prime(n)).unwrap_or(wanted));
        last
    })
}

fn is_prime(n: usize) -> bool {
    n > 1 && (2..).take_while(|d| d * d <= n).all(|d| !n.is_multiple_of(d))
}

/// Gain that makes the impulse response's energy the law's, `g²/(2 d)` for g = 1.
///
/// Energy flows as through a network of pipes: each value's output is spread evenly over all. With
/// an input that puts `INPUT²` into each value in the mean, each gets
/// `P = INPUT² / (1 - Σ 2 G_j / 8)` in all (G the lines' squared gains), and an output, the
/// difference of a value of line 2 and one of line 3, is `(G_2 + G_3) P`. The feed gives half the
/// energy of both sides together, the law the share of one side of `(L² + R²)/2`. A quarter of left
/// and right, added up by [chains](super::feed), is `√(L² + R²)/4`, where splits take half of
/// `√((L² + R²)/2)`: less by √2.
fn output_gain(plan: &BandPlan, decay_per_s: f64) -> f64 {
    let [a, b, c, d] = plan.delays.map(|delay| exponential::exp(-2.0 * plan.decay_per_sample * delay as f64));
    let given = INPUT_GAIN * INPUT_GAIN / (1.0 - (a + b + c + d) / LINES as f64);
    libm::sqrt(2.0 / (2.0 * decay_per_s * (c + d) * given))
}

/// Cycles of a split of two sections, of a network, and of doubling to the full rate: a sample, and
/// beginnings and ends.
const SPLIT_CYCLES: [usize; 2] = [34, 300];
const NETWORK_CYCLES: [usize; 2] = [56, 900];
const DOUBLING_CYCLES: [usize; 2] = [28, 500];
/// Cycles of a further section a sample; of the exchange with the bus a frame; and of all work that
/// is done once a block, a band and frame.
const SECTION_CYCLES: usize = 10;
const FRAME_CYCLES: usize = 61;
const BAND_CYCLES: usize = 12;
/// Parts of a cycle that are counted: a slow band's share is not whole.
const PARTS: usize = SLOWEST;
/// Largest cycles of a room of few bands with its splits, and of more bands.
const FEW_BANDS_CYCLES: usize = 285 * PARTS;
const CYCLES: usize = 715 * PARTS;
/// Gain, as splits see it, of a band whose gain is 0.
const LEAST_GAIN: f64 = 1e-4;
/// Least factor of a band's energy: within its edges by a sixth of an octave, a band is as loud as
/// the table says.
const LEAST_FACTOR: f64 = 0.9;

/// Best cuts of the work on a block into a part a tick: for each band from the highest down its
/// split and its answer, and then the doublings.
pub(super) fn part_ends(plans: &[BandPlan; MAX_BANDS], count: usize) -> [u8; TICKS] {
    let cost = |item: usize| {
        let plan = plans.get(count.wrapping_sub(1 + item / 2));
        let (samples, [a_sample, a_block]) = match plan {
            Some(plan) if item.is_multiple_of(2) => {
                let more = (plan.split.sections as usize).saturating_sub(LEAST_SECTIONS);
                let [a_sample, a_block] = SPLIT_CYCLES;
                (plan.block(), [a_sample + more * SECTION_CYCLES, a_block])
            }
            Some(plan) => (plan.block(), NETWORK_CYCLES),
            None => (BLOCK_FRAMES, DOUBLING_CYCLES),
        };
        samples * a_sample + a_block
    };
    let items = 2 * count + 1;
    let cut = |most: usize| {
        let (mut ends, mut item) = ([0; TICKS], 0);
        for end in &mut ends {
            let mut sum = 0;
            while item < items && sum + cost(item) <= most {
                sum += cost(item);
                item += 1;
            }
            *end = item as u8;
        }
        (item == items).then_some(ends)
    };
    // The least cost that every part keeps within, in steps of a few cycles a frame.
    let all = (0..items).map(cost).sum::<usize>();
    (0..=all / 64).find_map(|step| cut(step * 64 + 64)).unwrap_or([items as u8; TICKS])
}
