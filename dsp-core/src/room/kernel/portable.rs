//! The kernels in plain Rust: the definition of the bits.

#[cfg(not(cortex_m4f))]
use super::super::chain::{CHAINS, Chain, ChainState};
use super::super::dimensions::LINES;
use super::super::lines::{FIRST_OF_SECOND, LOUD_BITS, NetworkTick, Place, QUIET_BITS, Radiation, Sound};
#[cfg(not(cortex_m4f))]
use super::super::split::{SHAPED_FIRST, Split, SplitState};
use super::super::storage::Stored;
use crate::fixed;

/// Lets a tick pass through a network, as `Sample::network` says.
pub(in crate::room) fn network<T: Stored>(tick: NetworkTick<'_, T>) -> bool {
    let NetworkTick { memory, lines, places, sound, turns, busy, input, out, .. } = tick;
    prepare(input, &mut sound.input, tick.input_shift, tick.input_gain);
    let exceeded = pass(memory, lines, places, sound, turns, input.len(), busy);
    match tick.radiation {
        Radiation::Put => radiate(&sound.output, tick.output_gain, out, false),
        Radiation::Add => radiate(&sound.output, tick.output_gain, out, true),
        Radiation::Nothing => {}
    }
    exceeded
}

/// Gives the second values of pairs input times `2^shift · gain / 2^32`, in 2^-16 steps, and the
/// first ones [`FIRST_OF_SECOND`] of that; the gain grows by a part of itself (Q32) a sample.
fn prepare<T: Stored>(input: &[i32], prepared: &mut [[T; 2]], shift: u32, [gain, growth]: [i32; 2]) {
    let mut gain = gain;
    for (prepared, &x) in prepared.iter_mut().zip(input) {
        let second = fixed::smmulr(x << shift, gain);
        *prepared = [fixed::smmulr(second, FIRST_OF_SECOND << 17), second].map(T::input);
        gain = fixed::smmlar(gain, gain, growth);
    }
}

/// Adds outputs to `out`, or puts them there, times a gain that loses a part of itself (Q32) a
/// frame.
fn radiate<T: Stored>(output: &[[T; 2]], [gain, loss]: [i32; 2], out: &mut [[i32; 2]], add: bool) {
    let mut gain = gain;
    for ([left, right], &[y_left, y_right]) in out.iter_mut().zip(output) {
        let [before_left, before_right] = if add { [*left, *right] } else { [0; 2] };
        *left = before_left.saturating_add(y_left.times(gain));
        *right = before_right.saturating_add(y_right.times(gain));
        gain = fixed::smmlsr(gain, gain, loss);
    }
}

/// Lets a tick pass through the lines. If it is `busy`, true if a [watched](Stored::watched) value
/// is beyond the bits that raise the level; otherwise true if a stored value is beyond those up to
/// which it may be lowered.
fn pass<T: Stored>(
    memory: &mut [[T; 2]],
    lines: &[Place; LINES],
    places: &mut [Place; LINES],
    Sound { input, output }: &mut Sound<T>,
    (turns, turn_frames, fixed): (&[T::Turn], usize, T::Turn),
    frames: usize,
    busy: bool,
) -> bool {
    let mut exceeded = false;
    let sound = input.iter().zip(output).take(frames);
    let turns = turns.iter().flat_map(|turn| core::iter::repeat_n(turn, turn_frames));
    for ((&x, out), moving) in sound.zip(turns) {
        let at = places.map(|place| usize::from(place.at));
        let Some(words) = at_each(memory, at) else { return exceeded };
        let (written, y) = mix(words, x, [moving, &fixed]);
        let exceeds = |words: &[[T; 2]], bits: u32| words.as_flattened().iter().any(|value| value.exceeds(bits));
        exceeded |= if busy { exceeds(T::watched(&written), LOUD_BITS) } else { exceeds(&written, QUIET_BITS) };
        *out = y;
        for (word, at) in written.into_iter().zip(at) {
            if let Some(place) = memory.get_mut(at) {
                *place = word;
            }
        }
        for (place, line) in places.iter_mut().zip(lines) {
            *place = if place.left > 1 { Place { at: place.at + 1, left: place.left - 1 } } else { *line };
        }
    }
    exceeded
}

fn at_each<T: Copy>(memory: &[[T; 2]], [a, b, c, d]: [usize; LINES]) -> Option<[[T; 2]; LINES]> {
    let at = |at: usize| memory.get(at).copied();
    Some([at(a)?, at(b)?, at(c)?, at(d)?])
}

/// Doubles or halves all, as `Sample::scale` says.
pub(in crate::room) fn scale<T: Stored>(words: &mut [[T; 2]], rise: i32) {
    for value in words.as_flattened_mut() {
        *value = match rise {
            0.. => T::add(*value, *value),
            _ => (rise..0).fold(*value, |value, _| T::halve(value)),
        };
    }
}

/// Mixes one frame of the lines, turned. Gives the values that they are to hold, and half the
/// outputs.
#[inline(always)]
fn mix<T: Stored>(
    [w0, w1, w2, w3]: [[T; 2]; LINES],
    x: [T; 2],
    [moving, fixed]: [&T::Turn; 2],
) -> ([[T; 2]; LINES], [T; 2]) {
    let swapped = |[a, b]: [T; 2]| [b, a];
    let r0 = sum(T::reflect(w0, moving), x);
    let r1 = T::rotate(w1, fixed);
    let r2 = swapped(T::rotate(w2, moving));
    let r3 = swapped(T::reflect(w3, fixed));
    let (s0, s1, s2, s3) = (sum(r0, r1), difference(r0, r1), sum(r2, r3), difference(r2, r3));
    ([difference(s1, s3), sum(s0, s2), sum(s1, s3), difference(s0, s2)], s3)
}

#[inline(always)]
fn sum<T: Stored>([a, b]: [T; 2], [c, d]: [T; 2]) -> [T; 2] {
    [T::add(a, c), T::add(b, d)]
}

#[inline(always)]
fn difference<T: Stored>([a, b]: [T; 2], [c, d]: [T; 2]) -> [T; 2] {
    [T::subtract(a, c), T::subtract(b, d)]
}

/// Splits as [`Split::render`] does, but gives the or of the sizes.
#[cfg(not(cortex_m4f))]
pub(in crate::room) fn split(
    split: &Split,
    state: &mut SplitState,
    low: &mut [i32],
    high: &mut [i32],
    thin: bool,
) -> u32 {
    high.copy_from_slice(low);
    first_order(split.first, &mut state.first, high);
    let sections = split.second.iter().zip(&mut state.second).take(split.sections as usize);
    for (index, (coefficients, state)) in sections.enumerate() {
        section(coefficients, state, if index.is_multiple_of(2) { &mut *low } else { &mut *high });
    }
    let mut sizes = 0;
    for (low, high) in low.iter_mut().zip(high.iter_mut()) {
        let (a, b) = (*low, *high);
        (*low, *high) = (clip(a + b) >> 1, a - b);
        sizes |= (*high ^ (*high >> 31)) as u32;
    }
    if thin {
        for index in 1..low.len().div_ceil(2) {
            let kept = low.get(2 * index).copied();
            if let (Some(low), Some(kept)) = (low.get_mut(index), kept) {
                *low = kept;
            }
        }
    }
    sizes
}

/// Section of second order, `y = x2 + c2 (x - y2) + c1 (x1 - y1)`. The cut off bits are added to
/// the next sum: a pole pair near 0 Hz would raise plain rounding noise by the square of its gain
/// for these.
#[cfg(not(cortex_m4f))]
pub(in crate::room) fn section(&[half_c1, half_c2]: &[i32; 2], state: &mut [i32; 5], block: &mut [i32]) {
    let [mut x1, mut x2, mut y1, mut y2, mut rest] = *state;
    for x in block {
        // Products of at most 2^30.5 by 2^31 and by 2^30: below 2^62.1.
        let sum =
            i64::from(*x - y2) * i64::from(half_c2) + i64::from(x1 - y1) * i64::from(half_c1) + i64::from(rest as u32);
        rest = sum as i32;
        let y = x2 + ((sum >> 32) << 2) as i32;
        (x2, x1, y2, y1) = (x1, *x, y1, y);
        *x = y;
    }
    *state = [x1, x2, y1, y2, rest];
}

/// Section of first order, `y = x1 - α (x - y1)`, which carries the cut off bits on if α is above
/// [`SHAPED_FIRST`].
#[cfg(not(cortex_m4f))]
pub(in crate::room) fn first_order(alpha: i32, state: &mut [i32; 3], block: &mut [i32]) {
    let [mut x1, mut y1, mut rest] = *state;
    for x in block {
        let product = if alpha > SHAPED_FIRST {
            let sum = i64::from(*x - y1) * i64::from(alpha) + i64::from(rest as u32);
            rest = sum as i32;
            (sum >> 32) as i32
        } else {
            fixed::smmulr(*x - y1, alpha)
        };
        let y = x1 - (product << 1);
        (x1, y1) = (*x, y);
        *x = y;
    }
    *state = [x1, y1, rest];
}

/// Adds `slow` at twice its rate to `fast`, or puts it there, side by side: see
/// [`Upsampler`](super::super::upsample::Upsampler).
#[cfg(not(cortex_m4f))]
pub(in crate::room) fn double(
    &[a0, a1]: &[i32; 2],
    sides: &mut [[i32; 3]; 2],
    slow: &[[i32; 2]],
    fast: &mut [[i32; 2]],
    add: bool,
) {
    let (pairs, _) = fast.as_chunks_mut::<2>();
    for (side, [x1, even, odd]) in sides.iter_mut().enumerate() {
        for (slow, [fast_even, fast_odd]) in slow.iter().zip(pairs.iter_mut()) {
            let (Some(&x), Some(fast_even), Some(fast_odd)) =
                (slow.get(side), fast_even.get_mut(side), fast_odd.get_mut(side))
            else {
                return;
            };
            let x = x.clamp(-(1 << 29), (1 << 29) - 1);
            *even = fixed::smmlar(*x1, x - *even, a0);
            *odd = *x1 + (fixed::smmulr(x - *odd, a1) << 1);
            *x1 = x;
            let before = if add { [*fast_even, *fast_odd] } else { [0; 2] };
            (*fast_even, *fast_odd) = (before[0].saturating_add(*even), before[1].saturating_add(*odd));
        }
    }
}

/// Makes `input`, at most ±1.0, of both sides of `out` by their [chains](super::super::chain) and
/// adds `wet` to `out`. Gives the or of the chains' inputs.
#[cfg(not(cortex_m4f))]
pub(in crate::room) fn exchange(
    out: &mut [[i32; 2]],
    wet: &[[i32; 2]],
    input: &mut [i32],
    [left_state, right_state]: &mut [ChainState; 2],
) -> u32 {
    const HALF_CLIP: i32 = 1 << 27;
    let [left_chain, right_chain] = &CHAINS;
    let mut heard = 0;
    for (([left, right], wet), input) in out.iter_mut().zip(wet).zip(input) {
        let [a, b] = [*left, *right].map(|side| (side >> 2).clamp(-HALF_CLIP, HALF_CLIP - 1));
        heard |= (a | b) as u32;
        let (a, b) = (chain(left_chain, left_state, a, false), chain(right_chain, right_state, b, true));
        *input = (a + b).clamp(-HALF_CLIP, HALF_CLIP - 1);
        *left = left.saturating_add(wet[0]);
        *right = right.saturating_add(wet[1]);
    }
    heard
}

/// Sample of one side through its three sections.
#[cfg(not(cortex_m4f))]
#[inline(always)]
fn chain(chain: &Chain, state: &mut ChainState, x: i32, right: bool) -> i32 {
    let [first, second] = chain.complements;
    let d = x - (state.slow >> 32) as i32;
    state.slow += i64::from(d) * i64::from(first);
    let x = (state.slow >> 32) as i32 - d;
    let d = x - state.second;
    state.second = fixed::smmlar(state.second, d, second);
    let x = state.second - d;
    let d = x - state.last;
    let half = if right { d >> 1 } else { 0 };
    let y = fixed::smmlar(state.last + half, d, chain.last);
    state.last = y + d;
    y
}

/// Clips to ±2.0, for the next split.
#[cfg(not(cortex_m4f))]
#[inline(always)]
fn clip(value: i32) -> i32 {
    const CLIP: i32 = 1 << 28;
    let value = if value < -CLIP { -CLIP } else { value };
    if value > CLIP - 1 { CLIP - 1 } else { value }
}
