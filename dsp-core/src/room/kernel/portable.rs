//! The kernels in plain Rust: the definition of the bits.

#[cfg(not(cortex_m4f))]
use super::super::crossover::{Split, SplitState};
use super::super::level::{LOUD_BITS, QUIET_BITS};
use super::super::network::{LINES, Lines, Sound, Turns};
use super::super::storage::Sample;
use crate::fixed;

/// As [`Sample::prepare`].
pub(in crate::room) fn prepare<T: Sample>(
    input: &[i32],
    prepared: &mut [[T; 2]],
    shift: u32,
    [gain, growth]: [i32; 2],
) {
    let mut gain = gain;
    for (prepared, &x) in prepared.iter_mut().zip(input) {
        *prepared = [T::input(fixed::smmulr(x << shift, gain)); 2];
        gain = fixed::smmlar(gain, gain, growth);
    }
}

/// As [`Sample::radiate`].
pub(in crate::room) fn radiate<T: Sample>(
    output: &[[T; 2]],
    [gain, loss]: [i32; 2],
    out: &mut [[i32; 2]],
    add: bool,
) -> bool {
    let (mut gain, mut loud) = (gain, false);
    for ([left, right], &[y_left, y_right]) in out.iter_mut().zip(output) {
        let [before_left, before_right] = if add { [*left, *right] } else { [0; 2] };
        *left = before_left.saturating_add(y_left.times(gain));
        *right = before_right.saturating_add(y_right.times(gain));
        loud |= y_left.exceeds(LOUD_BITS) || y_right.exceeds(LOUD_BITS);
        gain = fixed::smmlsr(gain, gain, loss);
    }
    loud
}

/// As [`Sample::pass`].
pub(in crate::room) fn pass<T: Sample>(
    lines: Lines<'_, T>,
    sound: &mut Sound<T>,
    turns: &Turns<T>,
    from: usize,
) -> bool {
    let mut busy = false;
    for (words, (&x, out), frame) in frames(lines, sound, from) {
        let [moving, fixed] = turns.at(frame);
        *out = mix(words, x, [&moving, &fixed, &moving, &fixed], &mut busy);
    }
    busy
}

/// As [`Sample::pass_between`], with what [`lowered`](super::lowered) gives.
pub(in crate::room) fn pass_between<T: Sample>(
    lines: Lines<'_, T>,
    sound: &mut Sound<T>,
    turns: &[T::Turn; LINES],
    from: usize,
    double: bool,
) -> bool {
    let mut busy = false;
    for (words, (&x, out), _) in frames(lines, sound, from) {
        let words = words.map(|word| {
            if double {
                *word = word.map(|value| T::add(value, value));
            }
            word
        });
        *out = mix(words, x, turns.each_ref(), &mut busy);
    }
    busy
}

type Frame<'a, T> = ([&'a mut [T; 2]; LINES], (&'a [T; 2], &'a mut [T; 2]), usize);

fn frames<'a, T: Sample>(
    [l0, l1, l2, l3]: Lines<'a, T>,
    Sound { input, output }: &'a mut Sound<T>,
    from: usize,
) -> impl Iterator<Item = Frame<'a, T>> {
    let sound = input.iter().zip(output).zip(0..).skip(from);
    let pairs = l0.iter_mut().zip(l1).zip(l2.iter_mut().zip(l3));
    pairs.zip(sound).map(|(((w0, w1), (w2, w3)), (sound, frame))| ([w0, w1, w2, w3], sound, frame))
}

/// One frame: lines are read, turned, mixed and written; gives half the outputs.
#[inline(always)]
fn mix<T: Sample>(words: [&mut [T; 2]; LINES], x: [T; 2], turns: [&T::Turn; LINES], busy: &mut bool) -> [T; 2] {
    let [w0, w1, w2, w3] = words;
    let [turn0, turn1, turn2, turn3] = turns;
    let swapped = |[a, b]: [T; 2]| [b, a];
    let r0 = sum(T::rotate(*w0, turn0), x);
    let r1 = swapped(T::rotate(*w1, turn1));
    let r2 = T::rotate(*w2, turn2);
    let r3 = swapped(T::rotate(*w3, turn3));
    let (s0, s1, s2, s3) = (sum(r0, r1), difference(r0, r1), sum(r2, r3), difference(r2, r3));
    (*w1, *w2, *w3, *w0) = (sum(s0, s2), sum(s1, s3), difference(s0, s2), difference(s1, s3));
    *busy |= [w0, w1, w2, w3].iter().any(|word| word.iter().any(|value| value.exceeds(QUIET_BITS)));
    s3
}

#[inline(always)]
fn sum<T: Sample>([a, b]: [T; 2], [c, d]: [T; 2]) -> [T; 2] {
    [T::add(a, c), T::add(b, d)]
}

#[inline(always)]
fn difference<T: Sample>([a, b]: [T; 2], [c, d]: [T; 2]) -> [T; 2] {
    [T::subtract(a, c), T::subtract(b, d)]
}

/// As [`Split::render`], but gives the or of the sizes.
#[cfg(not(cortex_m4f))]
pub(in crate::room) fn split(split: &Split, state: &mut SplitState, low: &mut [i32], high: &mut [i32]) -> u32 {
    let ([c0, c1], [s0, s1]) = (&split.second, &mut state.second);
    high.copy_from_slice(low);
    first_order(split.first, &mut state.first, high);
    section(c1, s1, high);
    section(c0, s0, low);
    let mut sizes = 0;
    for (low, high) in low.iter_mut().zip(high.iter_mut()) {
        let (a, b) = (*low, *high);
        (*low, *high) = (clip(a + b), a - b);
        sizes |= (*high ^ (*high >> 31)) as u32;
    }
    sizes
}

/// `y = x2 + c2 (x - y2) + c1 (x1 - y1)`. What is cut off is added to the next sum: a pole pair near 0 Hz would raise plain rounding noise by the square of what it
/// raises this.
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

/// `y = x1 - α (x - y1)`, with what is cut off carried on in the same way.
#[cfg(not(cortex_m4f))]
pub(in crate::room) fn first_order(alpha: i32, state: &mut [i32; 3], block: &mut [i32]) {
    let [mut x1, mut y1, mut rest] = *state;
    for x in block {
        let sum = i64::from(*x - y1) * i64::from(alpha) + i64::from(rest as u32);
        rest = sum as i32;
        let y = x1 - ((sum >> 32) << 1) as i32;
        (x1, y1) = (*x, y);
        *x = y;
    }
    *state = [x1, y1, rest];
}

/// Adds `slow` at twice its rate to `fast`, or puts it there, side by side: see [`Upsampler`](super::super::upsample::Upsampler).
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
            *even = *x1 + (fixed::smmulr(x - *even, a0) << 1);
            *odd = *x1 + (fixed::smmulr(x - *odd, a1) << 1);
            *x1 = x;
            let before = if add { [*fast_even, *fast_odd] } else { [0; 2] };
            (*fast_even, *fast_odd) = (before[0].saturating_add(*even), before[1].saturating_add(*odd));
        }
    }
}

/// Puts half the middle of `out`, at most ±1.0, to `input` and adds `wet` to `out`; gives the or of the input.
#[cfg(not(cortex_m4f))]
pub(in crate::room) fn exchange(out: &mut [[i32; 2]], wet: &[[i32; 2]], input: &mut [i32]) -> u32 {
    let mut heard = 0;
    for (([left, right], wet), input) in out.iter_mut().zip(wet).zip(input) {
        *input = clip((*left >> 1) + (*right >> 1)) >> 1;
        heard |= *input as u32;
        *left = left.saturating_add(wet[0]);
        *right = right.saturating_add(wet[1]);
    }
    heard
}

/// To ±2.0, for the next split.
#[cfg(not(cortex_m4f))]
#[inline(always)]
fn clip(value: i32) -> i32 {
    const CLIP: i32 = 1 << 28;
    let value = if value < -CLIP { -CLIP } else { value };
    if value > CLIP - 1 { CLIP - 1 } else { value }
}
