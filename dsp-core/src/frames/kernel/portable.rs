//! The hot loops in plain Rust.

use super::super::mode::{FrameMode, Line};
use super::super::numbers::window_at;
use super::super::samples::{place_of_pair, rounded, sample};
use super::super::{BLOCK_FRAMES, PADDED_LINES, POINTS, WIDTH};
use super::{Convolution, ZEROS};
use crate::fixed;
use crate::fourier::Complex;

/// Adds the ringing modes of some lines to a spectrum, and steps them to the next block.
///
/// `modes` begins with the first mode of `lines`; `first` is the number of the first line.
pub fn synthesize(modes: &mut [FrameMode], lines: &[Line], first: usize, spectrum: &mut [Complex; PADDED_LINES]) {
    let mut rest = modes;
    for (line, number) in lines.iter().zip(first..) {
        let Some((modes, behind)) = rest.split_at_mut_checked(line.count.into()) else { return };
        rest = behind;
        let Some(sums) = spectrum.get_mut(number..number + WIDTH) else { return };
        for mode in modes.iter_mut().take(line.ringing.into()) {
            let [re, im] = mode.state;
            for (sum, number) in sums.iter_mut().zip(&mode.numbers) {
                sum[0] = sum[0] + number[0] * re - number[1] * im;
                sum[1] = sum[1] + number[0] * im + number[1] * re;
            }
            let ([x, y], word) = (mode.step, mode.step_rest);
            let (rest_x, rest_y) = (f32::from_bits(word & 0xffff_0000), f32::from_bits(word << 16));
            mode.state =
                [(re * x - im * y) + (re * rest_x - im * rest_y), (re * y + im * x) + (re * rest_y + im * rest_x)];
        }
    }
}

/// Adds a force to the states of all modes of some lines: `s += G Σ_l c_l Φ_l`, Φ the force's
/// spectrum.
pub fn gather(modes: &mut [FrameMode], lines: &[Line], first: usize, spectrum: &[Complex; PADDED_LINES]) {
    let mut rest = modes;
    for (line, number) in lines.iter().zip(first..) {
        let Some((modes, behind)) = rest.split_at_mut_checked(line.count.into()) else { return };
        rest = behind;
        let Some(force) = spectrum.get(number..number + WIDTH) else { return };
        for mode in modes {
            let mut sum = [0.0f32; 2];
            for (force, number) in force.iter().zip(&mode.numbers) {
                sum[0] = sum[0] + number[0] * force[0] - number[1] * force[1];
                sum[1] = sum[1] + number[0] * force[1] + number[1] * force[0];
            }
            let [x, y] = mode.gain;
            mode.state[0] += sum[0] * x - sum[1] * y;
            mode.state[1] += sum[0] * y + sum[1] * x;
        }
    }
}

/// Adds a head's outputs from a frame of two blocks on: `Σ_m force[m] taps[frame - m]` over the
/// ranges, in bus steps, rounded and saturating.
///
/// Sums stay below 2^63 in magnitude.
pub fn convolve(head: &Convolution<'_>, frame: usize, out: &mut [i32]) {
    for (out, frame) in out.iter_mut().zip(frame..) {
        let mut sum = head.half();
        for &[first, end] in head.ranges {
            let (first, end) = (usize::from(first), usize::from(end).min(frame + 1));
            let force = head.force.get(first..end).unwrap_or(&[]);
            let taps = head.taps.get((ZEROS[0] + POINTS - 1 + first).saturating_sub(frame)..).unwrap_or(&[]);
            sum = force.iter().zip(taps).fold(sum, |sum, (&force, &tap)| sum + i64::from(force) * i64::from(tap));
        }
        *out = fixed::qadd(*out, scaled(sum, head.exponent));
    }
}

/// Sum of taps and force on the bus, saturating.
fn scaled(sum: i64, exponent: i32) -> i32 {
    if exponent <= 0 {
        return fixed::saturate(sum.saturating_mul(1i64 << exponent.unsigned_abs().min(30)));
    }
    fixed::saturate(sum >> exponent)
}

/// Takes the window away from lines of a force. Line k becomes `Σ_l numbers[|l|] lines[k + 3 + l]`,
/// l = -3 to 3.
///
/// `lines` is longer than `out` by [`WIDTH`] - 1.
pub fn unwindow(lines: &[Complex], numbers: &[f32; WIDTH / 2 + 1], out: &mut [Complex]) {
    for (out, [l3, l2, l1, line, r1, r2, r3]) in out.iter_mut().zip(lines.array_windows::<WIDTH>()) {
        let [c0, c1, c2, c3] = numbers;
        *out = [
            c0 * line[0] + c1 * (l1[0] + r1[0]) + c2 * (l2[0] + r2[0]) + c3 * (l3[0] + r3[0]),
            c0 * line[1] + c1 * (l1[1] + r1[1]) + c2 * (l2[1] + r2[1]) + c3 * (l3[1] + r3[1]),
        ];
    }
}

/// Adds frames of a block to the stereo bus, from frame `first` on: the transform of both sides
/// times the window, rounded.
pub fn play(stereo: &[Complex; POINTS], first: usize, out: &mut [[i32; 2]]) {
    for (out, frame) in out.iter_mut().zip(first..) {
        let [left, right] = sample(stereo, frame);
        *out = [fixed::qadd(out[0], rounded(left)), fixed::qadd(out[1], rounded(right))];
    }
}

/// Adds a bank's own block to the stereo bus, from frame `first` on. A sample of the transform is
/// multiplied by the window, then by the gain of each side, and rounded.
pub fn play_lone(block: &[Complex; BLOCK_FRAMES], gains: &[f32; 2], first: usize, out: &mut [[i32; 2]]) {
    for (out, frame) in out.iter_mut().zip(first..) {
        let sound = block.get(place_of_pair(frame)).map_or(0.0, |pair| pair[frame % 2]) * window_at(frame);
        *out = [fixed::qadd(out[0], rounded(sound * gains[0])), fixed::qadd(out[1], rounded(sound * gains[1]))];
    }
}
