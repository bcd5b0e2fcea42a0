//! Spectra: of a block of force, and from the modes' lines to both sides of the output.

use core::ops::Range;

use super::hand::Decay;
use super::kernel;
use super::numbers::{HALF, NUMBERS_AT_LINE, WINDOW};
use super::samples::{self, rounded};
use super::{BLOCK_FRAMES, LINES, PADDED_LINES, POINTS, WIDTH};
use crate::fourier::{self, Complex, MAX_POINTS, TWIDDLES};
use crate::time::TICK_FRAMES;

/// Lines of a spectrum from -3 to N + 3, line k at place k + 3.
pub(super) type Lines = [Complex; PADDED_LINES];

/// Number of lines beyond either end.
const BEYOND: usize = WIDTH / 2;

/// Fills the input of a transform of N points with a block of force, windowed: an even frame as the
/// real part, an odd one as the imaginary part, the middle of the block first.
pub(super) fn fill(force: &[i32; BLOCK_FRAMES], transform: &mut [Complex; BLOCK_FRAMES]) {
    let (second, rest) = transform.split_at_mut(HALF / 2);
    let (zeros, first) = rest.split_at_mut(BLOCK_FRAMES - HALF);
    zeros.fill([0.0; 2]);
    let (force, _) = force.as_chunks::<2>();
    let (before, behind) = force.split_at(HALF / 2);
    // The window by its distance from the middle: first it falls, from the whole half on.
    let (fall, _) = WINDOW.get(1..).unwrap_or(&[]).as_chunks::<2>();
    for ((place, force), [near, far]) in first.iter_mut().zip(before).zip(fall.iter().rev()) {
        *place = [force[0] as f32 * far, force[1] as f32 * near];
    }
    for ((place, force), window) in second.iter_mut().zip(behind).zip(WINDOW.as_chunks::<2>().0) {
        *place = [force[0] as f32 * window[0], force[1] as f32 * window[1]];
    }
}

/// Fills the input of a transform of N points with 2N taps, an even one as the real part, an odd
/// one as the imaginary part.
pub(super) fn fill_taps(mut taps: impl Iterator<Item = f32>, transform: &mut [Complex; BLOCK_FRAMES]) {
    let mut next = || taps.next().unwrap_or(0.0);
    transform.iter_mut().for_each(|pair| *pair = [next(), next()]);
}

/// Lines 0 to N among all.
pub(super) fn inner(lines: &Lines) -> &[Complex] {
    lines.get(BEYOND..=BEYOND + BLOCK_FRAMES).unwrap_or(&[])
}

/// Takes the window away from a range of the lines 0 to N - 1 of a windowed force: seven lines make
/// one, as a mode gathers it.
pub(super) fn unwindow(lines: &Lines, range: Range<usize>, transform: &mut [Complex; BLOCK_FRAMES]) {
    let from = lines.get(range.start..).unwrap_or(&[]);
    kernel::unwindow(from, &NUMBERS_AT_LINE, transform.get_mut(range).unwrap_or(&mut []));
}

/// Spectrum of a tail, folded for a transform of N points to its even samples as real parts and its
/// odd ones as imaginary parts: the [lines without the window](unwindow) of a force times a
/// response (lines 0 to N, times 1/2N), for a range of the pairs k and N - k.
pub(super) fn combine(
    lines: &Lines,
    response: &[Complex],
    pairs: Range<usize>,
    transform: &mut [Complex; BLOCK_FRAMES],
) {
    let times = |[re, im]: Complex, [x, y]: Complex| [re * x - im * y, re * y + im * x];
    let Some(response) = response.first_chunk::<LINES>() else { return };
    if pairs.contains(&0) {
        let mut last = [0.0; 2];
        let end = lines.get(BLOCK_FRAMES..).unwrap_or(&[]);
        kernel::unwindow(end, &NUMBERS_AT_LINE, core::slice::from_mut(&mut last));
        let ends = [times(transform[0], response[0]), times(last, response[BLOCK_FRAMES])];
        [transform[0], _] = halve(ends, TWIDDLES[0]);
    }
    if pairs.contains(&HALF) {
        let middle = times(transform[HALF], response[HALF]);
        [_, transform[HALF]] = halve([middle; 2], TWIDDLES[HALF * (MAX_POINTS / BLOCK_FRAMES)]);
    }
    let (slots, [low, high], turns) = of_pairs(pairs, response, transform);
    for (((low, high), (of_low, of_high)), turn) in slots.zip(low.iter().zip(high.iter().rev())).zip(turns) {
        [*low, *high] = halve([times(*low, *of_low), times(*high, *of_high)], *turn);
    }
}

/// Points k and N - k of a transform, lines k and N - k from below and above, and the turns of a
/// range of the pairs that have two points and two lines.
#[inline(always)]
fn of_pairs<'a>(
    pairs: Range<usize>,
    lines: &'a [Complex; LINES],
    transform: &'a mut [Complex; BLOCK_FRAMES],
) -> (
    impl Iterator<Item = (&'a mut Complex, &'a mut Complex)>,
    [&'a [Complex]; 2],
    impl Iterator<Item = &'static Complex>,
) {
    let (start, end) = (pairs.start.max(1), pairs.end.min(HALF));
    let (below, above) = transform.split_at_mut(HALF);
    let mirrored = BLOCK_FRAMES + 1 - end..=BLOCK_FRAMES - start;
    let above = above.get_mut(mirrored.start() - HALF..=mirrored.end() - HALF).unwrap_or(&mut []);
    let slots = below.get_mut(start..end).unwrap_or(&mut []).iter_mut().zip(above.iter_mut().rev());
    let lines = [lines.get(start..end).unwrap_or(&[]), lines.get(mirrored).unwrap_or(&[])];
    let turns = TWIDDLES.get(start * (MAX_POINTS / BLOCK_FRAMES)..).unwrap_or(&[]);
    (slots, lines, turns.iter().step_by(MAX_POINTS / BLOCK_FRAMES))
}

/// Points k and N - k of a transform of N points that gives 2N real samples: even samples as real
/// parts, odd ones as imaginary parts.
///
/// The first argument holds the lines k and N - k of the samples, the second one `e^{πik/N}`.
#[inline(always)]
fn halve([[a, b], [c, d]]: [Complex; 2], [cos, sin]: Complex) -> [Complex; 2] {
    // Line k, and line N + k: the mirror image of N - k.
    let (even, odd) = ([a + c, b - d], [a - c, b + d]);
    let turned = [cos * odd[0] - sin * odd[1], cos * odd[1] + sin * odd[0]];
    [[even[0] - turned[1], even[1] + turned[0]], [even[0] + turned[1], turned[0] - even[1]]]
}

/// Prepares the transform of one bank's own block from its folded lines, for a range of the pairs k
/// and N - k. The transform then gives twice the block.
pub(super) fn alone(lines: &Lines, pairs: Range<usize>, transform: &mut [Complex; BLOCK_FRAMES]) {
    let Some(lines) = inner(lines).first_chunk::<LINES>() else { return };
    if pairs.contains(&0) {
        // The ends are their own mirror images; of all others each side has half.
        let ([x, _], [y, _]) = (lines[0], lines[BLOCK_FRAMES]);
        transform[0] = [2.0 * (x + y), 2.0 * (x - y)];
    }
    if pairs.contains(&HALF) {
        let [re, im] = lines[HALF];
        transform[HALF] = [2.0 * re, -2.0 * im];
    }
    let (slots, [low, high], turns) = of_pairs(pairs, lines, transform);
    for (((slot, mirrored), (x, y)), turn) in slots.zip(low.iter().zip(high.iter().rev())).zip(turns) {
        [*slot, *mirrored] = halve([*x, *y], *turn);
    }
}

/// Takes a hand's share of frames of one bank's block from its transform. The frames are whole
/// ticks.
pub(super) fn fade(transform: &mut [Complex; BLOCK_FRAMES], frames: Range<usize>, hand: &Decay) {
    for tick in frames.step_by(TICK_FRAMES) {
        let (of_tick, shares) = hand.in_tick(tick);
        for (shares, first) in shares.as_chunks::<2>().0.iter().zip((tick..).step_by(2)) {
            if let Some([even, odd]) = transform.get_mut(samples::place_of_pair(first)) {
                (*even, *odd) = (*even * of_tick * shares[0], *odd * of_tick * shares[1]);
            }
        }
    }
}

/// Adds one bank's own block to the block of all banks, with a hand's share and the gains of both
/// sides. The range consists of whole ticks; the transform is that of [`alone`].
pub(super) fn join(
    transform: &[Complex; BLOCK_FRAMES],
    frames: Range<usize>,
    hand: &Decay,
    gains: [f32; 2],
    stereo: &mut [Complex; POINTS],
) {
    for tick in frames.step_by(TICK_FRAMES) {
        let (of_tick, shares) = hand.in_tick(tick);
        let [left, right] = gains.map(|gain| 0.5 * gain * of_tick);
        for (shares, first) in shares.as_chunks::<2>().0.iter().zip((tick..).step_by(2)) {
            let sounds = transform.get(samples::place_of_pair(first)).copied().unwrap_or([0.0; 2]);
            for ((sound, share), frame) in sounds.into_iter().zip(shares).zip(first..) {
                if let Some(sides) = stereo.get_mut(samples::place(frame)) {
                    *sides = [sides[0] + left * (sound * share), sides[1] + right * (sound * share)];
                }
            }
        }
    }
}

/// Puts a tail from its transform, rounded to bus steps.
pub(super) fn put_tail(transform: &[Complex; BLOCK_FRAMES], tail: &mut [i32; BLOCK_FRAMES]) {
    // The force lies around sample 0, so that its next block begins half a block behind.
    for (samples, pair) in tail.as_chunks_mut::<2>().0.iter_mut().zip(HALF as u32 / 2..) {
        let place = fourier::place(pair, BLOCK_FRAMES.trailing_zeros());
        *samples = transform.get(place).copied().unwrap_or([0.0; 2]).map(rounded);
    }
}

/// Number of pairs of lines that are worked on in one piece.
pub(super) const PAIRS_AT_ONCE: usize = 24;

/// Number of pairs of lines k and N - k.
pub(super) const PAIRS: usize = HALF + 1;

/// Lines `Σ_μ F[μ] w[μ] e^{-2πi kμ/2N}` of a force, from its transform, for a range of the pairs k
/// and N - k. With the last pair come the lines beyond the ends.
pub(super) fn unfold(transform: &[Complex; BLOCK_FRAMES], pairs: Range<usize>, lines: &mut Lines) {
    let is_last = pairs.end == PAIRS;
    let at =
        |k: usize| transform.get(fourier::place(k as u32, BLOCK_FRAMES.trailing_zeros())).copied().unwrap_or([0.0; 2]);
    let twiddles = TWIDDLES.get(pairs.start * (MAX_POINTS / BLOCK_FRAMES)..).unwrap_or(&[]);
    for (k, &[cos, sin]) in pairs.zip(twiddles.iter().step_by(MAX_POINTS / BLOCK_FRAMES)) {
        let ([a, b], [c, d]) = (at(k), at(BLOCK_FRAMES - k));
        // Transforms of the even frames, and of the odd ones times a turn.
        let (even, odd) = ([0.5 * (a + c), 0.5 * (b - d)], [0.5 * (b + d), 0.5 * (c - a)]);
        let turned = [cos * odd[0] - sin * odd[1], cos * odd[1] + sin * odd[0]];
        if let Some(slot) = lines.get_mut(BEYOND + k) {
            *slot = [even[0] + turned[0], -(even[1] + turned[1])];
        }
        if let Some(slot) = lines.get_mut(BEYOND + BLOCK_FRAMES - k) {
            *slot = [even[0] - turned[0], even[1] - turned[1]];
        }
    }
    if is_last {
        for k in 1..=BEYOND {
            mirror(lines, BEYOND + k, BEYOND - k);
            let end = BEYOND + BLOCK_FRAMES;
            mirror(lines, end - k, end + k);
        }
    }
}

fn mirror(lines: &mut Lines, from: usize, to: usize) {
    let [re, im] = lines.get(from).copied().unwrap_or([0.0; 2]);
    if let Some(slot) = lines.get_mut(to) {
        *slot = [re, -im];
    }
}

/// Adds the lines below 0 and above N to those that they are mirror images of.
pub(super) fn fold(lines: &mut Lines) {
    let mut add = |from: usize, to: usize| {
        let [re, im] = lines.get(from).copied().unwrap_or([0.0; 2]);
        if let Some(slot) = lines.get_mut(to) {
            *slot = [slot[0] + re, slot[1] - im];
        }
    };
    for k in 1..=BEYOND {
        add(BEYOND - k, BEYOND + k);
        let end = BEYOND + BLOCK_FRAMES;
        add(end + k, end - k);
    }
}

/// Puts a range of folded lines, by the gains of both sides, into the spectrum of `left + i right`,
/// or adds them (`ADDS`).
pub(super) fn pan<const ADDS: bool>(
    lines: &Lines,
    range: Range<usize>,
    [left, right]: [f32; 2],
    stereo: &mut [Complex; POINTS],
) {
    let put = |slot: Option<&mut Complex>, [re, im]: Complex| {
        if let Some(slot) = slot {
            *slot = if ADDS { [slot[0] + re, slot[1] + im] } else { [re, im] };
        }
    };
    let ends = [0, BLOCK_FRAMES];
    for end in ends.into_iter().filter(|end| range.contains(end)) {
        // Each is its own mirror image.
        let re = lines.get(BEYOND + end).map_or(0.0, |line| line[0]);
        put(stereo.get_mut(end), [left * re, right * re]);
    }
    let (left, right) = (0.5 * left, 0.5 * right);
    let inner = range.start.max(1)..range.end.min(BLOCK_FRAMES);
    let (low, high) = stereo.split_at_mut(BLOCK_FRAMES);
    let high = high.get_mut(BLOCK_FRAMES - (inner.end - 1)..=BLOCK_FRAMES - inner.start).unwrap_or(&mut []);
    let places = (low.get_mut(inner.clone()).unwrap_or(&mut []).iter_mut()).zip(high.iter_mut().rev());
    let lines = lines.get(BEYOND + inner.start..BEYOND + inner.end).unwrap_or(&[]);
    for ([re, im], (low, high)) in lines.iter().zip(places) {
        let ([a, b], [c, d]) = ([left * re, left * im], [right * re, right * im]);
        put(Some(low), [a - d, b + c]);
        put(Some(high), [a + d, c - b]);
    }
}
