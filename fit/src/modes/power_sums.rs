//! Sums of powers, from which all inner products of damped sines follow without any samples.

use nalgebra::Complex;

/// Sums `[Σ zⁿ, Σ n zⁿ, Σ n² zⁿ]` over `n = 0 .. length`, for |z| <= 1.
///
/// Computed by doubling: the sums over `2L` terms are those over `L` terms plus those shifted by
/// `L`. The closed form has a factor `(1 - z)⁻³`, which cancels when a mode hardly decays over the
/// recording; here nothing is subtracted.
pub(crate) fn power_sums(z: Complex<f64>, length: usize) -> [Complex<f64>; 3] {
    let zero = Complex::new(0.0, 0.0);
    // Sums over the first `done` terms, and `z^done`.
    let (mut sums, mut done, mut z_done) = ([zero; 3], 0.0, Complex::new(1.0, 0.0));
    // Sums over a block of `block` terms, a power of two, and `z^block`.
    let (mut of_block, mut block, mut z_block) = ([Complex::new(1.0, 0.0), zero, zero], 1.0, z);
    let mut remaining = length;
    while remaining > 0 && z_done.norm_sqr() > NEGLIGIBLE {
        if remaining & 1 == 1 {
            sums = appended(sums, done, z_done, of_block);
            done += block;
            z_done *= z_block;
        }
        of_block = appended(of_block, block, z_block, of_block);
        block *= 2.0;
        z_block *= z_block;
        remaining >>= 1;
    }
    sums
}

/// Value of |zⁿ|² below which the following terms change no digit.
const NEGLIGIBLE: f64 = 1e-60;

/// Sums of two stretches of terms, the second of which starts `shift` terms after the first.
fn appended(
    first: [Complex<f64>; 3],
    shift: f64,
    z_shift: Complex<f64>,
    second: [Complex<f64>; 3],
) -> [Complex<f64>; 3] {
    let [s0, s1, s2] = second;
    [
        first[0] + z_shift * s0,
        first[1] + z_shift * (s1 + s0 * shift),
        first[2] + z_shift * (s2 + s1 * (2.0 * shift) + s0 * (shift * shift)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_sums_equal_plain_sums_for_fast_and_slow_decays() {
        for (decay, turn) in [(0.5, 1.0), (1e-3, 0.1), (1e-9, 1e-7), (0.0, 0.0), (1e-4, 3.1)] {
            let z = Complex::new(-decay, turn).exp();
            for length in [0, 1, 2, 63, 64, 1000, 4097] {
                let mut plain = [Complex::new(0.0, 0.0); 3];
                for n in 0..length {
                    let power = (Complex::new(-decay, turn) * n as f64).exp();
                    let n = n as f64;
                    for (sum, weight) in plain.iter_mut().zip([1.0, n, n * n]) {
                        *sum += power * weight;
                    }
                }
                for (order, (quick, plain)) in (0i32..).zip(power_sums(z, length).iter().zip(&plain)) {
                    let scale = (length as f64).max(1.0).powi(order) + plain.norm();
                    assert!((quick - plain).norm() < 1e-10 * scale, "{decay} {turn} {length} {order}");
                }
            }
        }
    }
}
