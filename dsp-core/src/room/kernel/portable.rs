//! The kernels in plain Rust: the definition of the bits.

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
pub(in crate::room) fn radiate<T: Sample>(output: &[[T; 2]], [gain, loss]: [i32; 2], out: &mut [[i32; 2]]) -> bool {
    let (mut gain, mut loud) = (gain, false);
    for ([left, right], &[y_left, y_right]) in out.iter_mut().zip(output) {
        *left = left.saturating_add(y_left.times(gain));
        *right = right.saturating_add(y_right.times(gain));
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
