//! Fourier transform of a power-of-two length, by the recursion of textbooks.

use crate::resonator::Complex;

/// Transform `X_k = Σ_n x_n e^(sign 2πi kn/N)`; the length must be a power of two.
pub(super) fn transform(x: &[Complex], sign: f64) -> Vec<Complex> {
    let length = x.len();
    if length < 2 {
        return x.to_vec();
    }
    let part = |first: usize| transform(&x.iter().skip(first).step_by(2).copied().collect::<Vec<_>>(), sign);
    let (even, odd) = (part(0), part(1));
    let half = length / 2;
    let mut out = vec![Complex::ZERO; length];
    for k in 0..half {
        let angle = sign * 2.0 * std::f64::consts::PI * k as f64 / length as f64;
        let turned = odd[k] * Complex::exp(0.0, angle);
        out[k] = even[k] + turned;
        out[k + half] = even[k] + turned * -1.0;
    }
    out
}
