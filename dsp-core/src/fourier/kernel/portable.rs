//! The loops in plain Rust.

use super::super::twiddles::{Complex, Factors, times};

/// Computes butterflies of radix 4 over blocks of a size, from a butterfly on. Each block has as
/// many butterflies as there are factors, a quarter of its points.
pub(in super::super) fn pass(data: &mut [Complex], factors: &[Factors], first: usize, count: usize) {
    let row = factors.len().max(1);
    let (mut done, end) = (first, first + count);
    while done < end {
        let (block, first) = (done / row, done % row);
        let length = (row - first).min(end - done);
        let Some(points) = data.get_mut(block * 4 * row..(block + 1) * 4 * row) else { return };
        row_of_4(points, first..first + length, factors);
        done += length;
    }
}

fn row_of_4(points: &mut [Complex], range: core::ops::Range<usize>, factors: &[Factors]) {
    let quarter = points.len() / 4;
    let Some((low, high)) = points.split_at_mut_checked(2 * quarter) else { return };
    let (Some((a, b)), Some((c, d))) = (low.split_at_mut_checked(quarter), high.split_at_mut_checked(quarter)) else {
        return;
    };
    let (Some(a), Some(b), Some(c), Some(d), Some(factors)) = (
        a.get_mut(range.clone()),
        b.get_mut(range.clone()),
        c.get_mut(range.clone()),
        d.get_mut(range.clone()),
        factors.get(range),
    ) else {
        return;
    };
    for ((((a, b), c), d), [w1, w2, w3]) in a.iter_mut().zip(b).zip(c).zip(d).zip(factors) {
        let [y0, y1, y2, y3] = butterfly([*a, *b, *c, *d]);
        (*a, *b, *c, *d) = (y0, times(y2, *w2), times(y1, *w1), times(y3, *w3));
    }
}

/// Computes the butterflies of the last pass, over blocks of four points, from a block on.
pub(in super::super) fn last_pass(data: &mut [Complex], first: usize, count: usize) {
    for points in data.as_chunks_mut::<4>().0.iter_mut().skip(first).take(count) {
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
