//! Inverse complex Fourier transform in `f32` that can be computed a piece at a time.
//!
//! The transform is `x[n] = Σ_k X_k e^{2πi kn/M}` for M points, a power of two up to 512. It is
//! radix 4 with decimation in frequency, in place; a size that is no power of 4 has one radix-2
//! pass. The result is in bit-reversed order ([`place`]). Its error is 120 dB below it or less
//! (`cargo test -p dsp-core waves_agree`).

mod kernel;
mod twiddles;

pub(crate) use twiddles::{Complex, MAX_POINTS, TURN, TWIDDLES, cosine, quarter_sine};
use twiddles::{FACTORS_16, FACTORS_64, FACTORS_128, FACTORS_256, FACTORS_512, times};

/// Progress of a transform.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Progress {
    /// Points of the blocks that the current pass transforms; 1 when all is done.
    block: usize,
    /// Number of butterflies of the pass that are done.
    done: usize,
}

impl Progress {
    /// Start of a transform of `points` points.
    pub(crate) const fn start(points: usize) -> Self {
        Self { block: points, done: 0 }
    }

    /// True if the whole transform is done.
    pub(crate) const fn is_over(self) -> bool {
        self.block <= 1
    }

    /// Computes butterflies of one pass until they have cost about `cycles`, or until the pass is
    /// over. Gives their cycles.
    pub(crate) fn advance(&mut self, data: &mut [Complex], cycles: u32) -> u32 {
        let (radix, cost) = butterfly_cycles(self.block);
        let all = data.len() / radix;
        let count = (all - self.done).min((cycles / cost) as usize + 1);
        match self.block {
            4 => kernel::last_pass(data, self.done, count),
            16 => kernel::pass(data, &FACTORS_16, self.done, count),
            64 => kernel::pass(data, &FACTORS_64, self.done, count),
            256 => kernel::pass(data, &FACTORS_256, self.done, count),
            128 => pass_of_2(data, &FACTORS_128, self.done, count),
            _ => pass_of_2(data, &FACTORS_512, self.done, count),
        }
        self.done += count;
        if self.done == all {
            (self.block, self.done) = (self.block / radix, 0);
        }
        count as u32 * cost
    }
}

/// Radix of the pass over blocks of a size, and cycles of a butterfly, for sharing the work among
/// ticks; measured on the virtual core.
const fn butterfly_cycles(block: usize) -> (usize, u32) {
    match block {
        4 => (4, 38),
        16 | 64 | 256 => (4, 68),
        _ => (2, 37),
    }
}

/// Cycles of a transform, by the cycles of its butterflies.
pub(crate) const fn cycles(points: usize) -> u32 {
    let (mut block, mut sum) = (points, 0);
    while block > 1 {
        let (radix, cost) = butterfly_cycles(block);
        sum += (points / radix) as u32 * cost;
        block /= radix;
    }
    sum
}

/// Computes butterflies of radix 2 of the only block, from a butterfly on.
#[inline(never)]
fn pass_of_2(points: &mut [Complex], factors: &[Complex], first: usize, count: usize) {
    let Some((low, high)) = points.split_at_mut_checked(points.len() / 2) else { return };
    let range = first..first + count;
    let (Some(low), Some(high), Some(factors)) =
        (low.get_mut(range.clone()), high.get_mut(range.clone()), factors.get(range))
    else {
        return;
    };
    for ((a, b), w) in low.iter_mut().zip(high).zip(factors) {
        let difference = [a[0] - b[0], a[1] - b[1]];
        *a = [a[0] + b[0], a[1] + b[1]];
        *b = times(difference, *w);
    }
}

/// Place of a sample of the result, modulo the number of points.
#[inline(always)]
pub(crate) fn place(n: u32, points_log2: u32) -> usize {
    // Reversed, the bits beyond the length come out at the bottom and drop.
    (n.reverse_bits() >> (32 - points_log2)) as usize
}
