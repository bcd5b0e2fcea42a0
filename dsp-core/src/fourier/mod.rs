//! Inverse complex Fourier transform in `f32` that can be computed a piece at a time.
//!
//! The transform is `x[n] = Σ_k X_k e^{2πi kn/M}` for M points, a power of two up to 512. It is
//! radix 4 with decimation in frequency, in place; a size that is no power of 4 has one radix-2
//! pass. The result is in bit-reversed order ([`place`]). Its error is 120 dB below it or less
//! (`cargo test -p dsp-core waves_agree`).

mod twiddles;

pub(crate) use twiddles::{Complex, MAX_POINTS, TURN, TWIDDLES, cosine, quarter_sine};
use twiddles::{FACTORS_16, FACTORS_64, FACTORS_128, FACTORS_256, FACTORS_512, Factors};

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
        let (quarter, all) = (self.block / radix, data.len() / radix);
        let mut count = (all - self.done).min((cycles / cost) as usize + 1);
        match self.block {
            4 => last_pass(data, self.done..self.done + count),
            16 => {
                // Whole blocks.
                count = count.next_multiple_of(4);
                pass_of_16(data, self.done / 4..(self.done + count) / 4);
            }
            _ => self.rows(data, quarter, count),
        }
        self.done += count;
        if self.done == all {
            (self.block, self.done) = (self.block / radix, 0);
        }
        count as u32 * cost
    }

    fn rows(&self, data: &mut [Complex], row: usize, count: usize) {
        let (mut done, end) = (self.done, self.done + count);
        let row = row.max(1);
        while done < end {
            let (block, first) = (done / row, done % row);
            let length = (row - first).min(end - done);
            let Some(points) = data.get_mut(block * self.block..(block + 1) * self.block) else { return };
            match self.block {
                512 => row_of_2(points, first, length, &FACTORS_512),
                128 => row_of_2(points, first, length, &FACTORS_128),
                256 => row_of_4(points, first, length, &FACTORS_256),
                _ => row_of_4(points, first, length, &FACTORS_64),
            }
            done += length;
        }
    }
}

/// Radix of the pass over blocks of a size, and cycles of a butterfly, for sharing the work among
/// ticks; measured on the virtual core.
const fn butterfly_cycles(block: usize) -> (usize, u32) {
    match block {
        4 => (4, 52),
        16 => (4, 75),
        64 | 256 => (4, 92),
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

#[inline(never)]
fn row_of_2(points: &mut [Complex], first: usize, length: usize, factors: &[Complex]) {
    let Some((low, high)) = points.split_at_mut_checked(points.len() / 2) else { return };
    let range = first..first + length;
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

#[inline(never)] // one copy for all sizes
fn row_of_4(points: &mut [Complex], first: usize, length: usize, factors: &[Factors]) {
    let quarter = points.len() / 4;
    let Some((low, high)) = points.split_at_mut_checked(2 * quarter) else { return };
    let (Some((a, b)), Some((c, d))) = (low.split_at_mut_checked(quarter), high.split_at_mut_checked(quarter)) else {
        return;
    };
    let range = first..first + length;
    let (Some(a), Some(b), Some(c), Some(d), Some(factors)) = (
        a.get_mut(range.clone()),
        b.get_mut(range.clone()),
        c.get_mut(range.clone()),
        d.get_mut(range.clone()),
        factors.get(range),
    ) else {
        return;
    };
    for ((((a, b), c), d), factors) in a.iter_mut().zip(b).zip(c).zip(d).zip(factors) {
        (*a, *b, *c, *d) = turned_butterfly([*a, *b, *c, *d], factors);
    }
}

#[inline(always)]
fn turned_butterfly(points: [Complex; 4], [w1, w2, w3]: &Factors) -> (Complex, Complex, Complex, Complex) {
    let [y0, y1, y2, y3] = butterfly(points);
    (y0, times(y2, *w2), times(y1, *w1), times(y3, *w3))
}

#[inline(never)]
fn pass_of_16(data: &mut [Complex], blocks: core::ops::Range<usize>) {
    let (data, _) = data.as_chunks_mut::<16>();
    let Some(blocks) = data.get_mut(blocks) else { return };
    for block in blocks {
        let (low, high) = block.split_at_mut(8);
        let ((a, b), (c, d)) = (low.split_at_mut(4), high.split_at_mut(4));
        for ((((a, b), c), d), factors) in a.iter_mut().zip(b).zip(c).zip(d).zip(&FACTORS_16) {
            (*a, *b, *c, *d) = turned_butterfly([*a, *b, *c, *d], factors);
        }
    }
}

#[inline(never)]
fn last_pass(data: &mut [Complex], blocks: core::ops::Range<usize>) {
    let (data, _) = data.as_chunks_mut::<4>();
    let Some(blocks) = data.get_mut(blocks) else { return };
    for points in blocks {
        let [y0, y1, y2, y3] = butterfly(*points);
        *points = [y0, y2, y1, y3];
    }
}

/// Inverse transform of four points.
#[inline(always)]
fn butterfly([a, b, c, d]: [Complex; 4]) -> [Complex; 4] {
    let (even, odd) = ([a[0] + c[0], a[1] + c[1]], [a[0] - c[0], a[1] - c[1]]);
    let (sum, turned) = ([b[0] + d[0], b[1] + d[1]], [d[1] - b[1], b[0] - d[0]]);
    [
        [even[0] + sum[0], even[1] + sum[1]],
        [odd[0] + turned[0], odd[1] + turned[1]],
        [even[0] - sum[0], even[1] - sum[1]],
        [odd[0] - turned[0], odd[1] - turned[1]],
    ]
}

#[inline(always)]
fn times(x: Complex, w: Complex) -> Complex {
    [x[0] * w[0] - x[1] * w[1], x[0] * w[1] + x[1] * w[0]]
}

/// Place of a sample of the result, modulo the number of points.
#[inline(always)]
pub(crate) fn place(n: u32, points_log2: u32) -> usize {
    // Reversed, the bits beyond the length come out at the bottom and drop.
    (n.reverse_bits() >> (32 - points_log2)) as usize
}
