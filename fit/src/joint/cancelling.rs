//! Modes that lie within their widths and cancel.

use fourier::Complex;

use crate::modes::Pole;

/// Sum of the gains of two modes within their widths, relative to the sum of the magnitudes, below
/// which the two cancel: 6 dB.
const CANCELLING: f64 = 0.5;
/// Margin of the bound that the descent keeps.
const MARGIN: f64 = 1.02;
/// Number of halvings that find the share of a difference that is kept.
const HALVINGS: usize = 12;

/// True if two modes lie within their widths: nearer than the sum of their decays in rad/s.
fn are_within(a: &Pole, b: &Pole) -> bool {
    (a.angular - b.angular).abs() < a.decay + b.decay
}

/// True if two modes lie within their widths and cancel by more than 6 dB.
pub(crate) fn cancel(a: (&Pole, Complex<f64>), b: (&Pole, Complex<f64>)) -> bool {
    are_within(a.0, b.0) && (a.1 + b.1).norm() < CANCELLING * (a.1.norm() + b.1.norm())
}

/// Brings the gains of modes that cancel nearer to one another, until they cancel by 6 dB.
///
/// The sum of the two gains stays.
pub(crate) fn part_cancelling(poles: &[Pole], gains: &mut [Complex<f64>]) {
    for a in 0..poles.len() {
        for b in a + 1..poles.len() {
            let (sum, difference) = (gains[a] + gains[b], gains[a] - gains[b]);
            let limit = sum.norm() / (MARGIN * CANCELLING);
            let size = |share: f64| 0.5 * ((sum + difference * share).norm() + (sum - difference * share).norm());
            if !are_within(&poles[a], &poles[b]) || size(1.0) <= limit {
                continue;
            }
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if size(middle) <= limit { low = middle } else { high = middle }
            }
            gains[a] = 0.5 * (sum + difference * low);
            gains[b] = 0.5 * (sum - difference * low);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_within_their_widths_keep_their_sum_and_cancel_by_at_most_6_db() {
        let pole = |angular: f64| Pole { angular, decay: 1e-3 };
        let poles = [pole(0.1), pole(0.1005), pole(0.2)];
        let before = [Complex::new(1.0, 0.0), Complex::new(-0.9, 0.1), Complex::new(-1.0, 0.0)];
        let mut gains = before;
        part_cancelling(&poles, &mut gains);
        assert!((gains[0] + gains[1] - before[0] - before[1]).norm() < 1e-12);
        assert!(!cancel((&poles[0], gains[0]), (&poles[1], gains[1])), "{gains:?}");
        assert!(cancel((&poles[0], before[0]), (&poles[1], before[1])));
        assert_eq!(gains[2], before[2]);
    }
}
