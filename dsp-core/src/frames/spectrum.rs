//! Spectra: of a block of force, and from the modes' lines to both sides of the output.

use super::numbers::{HALF, window_at};
use super::{BLOCK_FRAMES, PADDED_LINES, POINTS, WIDTH};
use crate::fourier::{self, Complex, MAX_POINTS, TWIDDLES};

/// Lines of a spectrum from -3 to N + 3, line k at place k + 3.
pub(super) type Lines = [Complex; PADDED_LINES];

/// Number of lines beyond either end.
const BEYOND: usize = WIDTH / 2;

/// Fills the input of a transform of N points with a block of force, windowed: an even frame as the
/// real part, an odd one as the imaginary part, the middle of the block first.
pub(super) fn fill(force: &[i32; BLOCK_FRAMES], transform: &mut [Complex; BLOCK_FRAMES]) {
    transform.fill([0.0; 2]);
    for (frame, pair) in (0..).step_by(2).zip(force.as_chunks::<2>().0) {
        let place = ((frame + POINTS - HALF) / 2) % BLOCK_FRAMES;
        if let Some(slot) = transform.get_mut(place) {
            *slot = [pair[0] as f32 * window_at(frame), pair[1] as f32 * window_at(frame + 1)];
        }
    }
}

/// Lines `Σ_μ F[μ] w[μ] e^{-2πi kμ/2N}` of a force, from its transform.
pub(super) fn unfold(transform: &[Complex; BLOCK_FRAMES], lines: &mut Lines) {
    let at =
        |k: usize| transform.get(fourier::place(k as u32, BLOCK_FRAMES.trailing_zeros())).copied().unwrap_or([0.0; 2]);
    for k in 0..=BLOCK_FRAMES {
        let ([a, b], [c, d]) = (at(k), at(BLOCK_FRAMES - k));
        let [cos, sin] = match TWIDDLES.get(k * (MAX_POINTS / BLOCK_FRAMES)) {
            Some(&twiddle) => twiddle,
            // The table ends before half a turn.
            None => [-1.0, 0.0],
        };
        // Even frames' transform, odd frames' times i.
        let (even, odd) = ([0.5 * (a + c), 0.5 * (b - d)], [0.5 * (b + d), 0.5 * (c - a)]);
        let line = [even[0] + (cos * odd[0] - sin * odd[1]), even[1] + (cos * odd[1] + sin * odd[0])];
        if let Some(slot) = lines.get_mut(k + BEYOND) {
            *slot = conjugate(line);
        }
    }
    for k in 1..=BEYOND {
        mirror(lines, BEYOND + k, BEYOND - k);
        let end = BEYOND + BLOCK_FRAMES;
        mirror(lines, end - k, end + k);
    }
}

fn conjugate([re, im]: Complex) -> Complex {
    [re, -im]
}

fn mirror(lines: &mut Lines, from: usize, to: usize) {
    let line = lines.get(from).copied().unwrap_or([0.0; 2]);
    if let Some(slot) = lines.get_mut(to) {
        *slot = conjugate(line);
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

/// Adds folded lines, by the gains of both sides, to the spectrum of `left + i right`.
pub(super) fn pan(lines: &Lines, [left, right]: [f32; 2], stereo: &mut [Complex; POINTS]) {
    let Some(lines) = lines.get(BEYOND..=BEYOND + BLOCK_FRAMES) else { return };
    let Some(([first, low @ ..], [middle, high @ ..])) = stereo.split_at_mut_checked(BLOCK_FRAMES) else { return };
    let [start, inner @ .., end] = lines else { return };
    for (ends, slot) in [(start, first), (end, middle)] {
        *slot = [slot[0] + left * ends[0], slot[1] + right * ends[0]];
    }
    let (left, right) = (0.5 * left, 0.5 * right);
    for (([re, im], low), high) in inner.iter().zip(low).zip(high.iter_mut().rev()) {
        let ([a, b], [c, d]) = ([left * re, left * im], [right * re, right * im]);
        *low = [low[0] + (a - d), low[1] + (b + c)];
        *high = [high[0] + (a + d), high[1] + (c - b)];
    }
}

/// Both sides at a frame of a block, from the transform of their spectrum.
#[inline(always)]
pub(super) fn sample(stereo: &[Complex; POINTS], frame: usize) -> Complex {
    let place = fourier::place((frame + POINTS - HALF) as u32, POINTS.trailing_zeros());
    let window = window_at(frame);
    stereo.get(place).map_or([0.0; 2], |side| side.map(|x| x * window))
}
