//! Modes of an ideal circular membrane: zeros of the Bessel functions J_m.

/// Bessel function J_m(x), by its integral `1/π ∫ cos(m τ - x sin τ) dτ` over 0 to π.
///
/// The trapezoidal rule gives this integral exactly but for rounding.
pub(crate) fn bessel(m: u32, x: f64) -> f64 {
    const STEPS: u32 = 200;
    let sum: f64 = (0..=STEPS)
        .map(|step| {
            let tau = std::f64::consts::PI * f64::from(step) / f64::from(STEPS);
            let weight = if step == 0 || step == STEPS { 0.5 } else { 1.0 };
            weight * (f64::from(m) * tau - x * tau.sin()).cos()
        })
        .sum();
    sum / f64::from(STEPS)
}

/// Zero `n`, counted from 1, of J_m above 0, by scanning and bisection.
pub(crate) fn zero(m: u32, n: u32) -> f64 {
    let (mut x, mut found) = (0.5, 0);
    loop {
        let next = x + 0.05;
        if (bessel(m, x) > 0.0) != (bessel(m, next) > 0.0) {
            found += 1;
            if found == n {
                return bisect(m, x, next);
            }
        }
        x = next;
    }
}

fn bisect(m: u32, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..60 {
        let x = 0.5 * (low + high);
        if (bessel(m, x) > 0.0) == (bessel(m, low) > 0.0) { low = x } else { high = x }
    }
    0.5 * (low + high)
}

/// Shapes `J_m(j r)` at five positions from the middle (0) towards the rim (1, at 90 % of the
/// radius).
pub(crate) fn five_positions(m: u32, zero: f64) -> [f64; 5] {
    [0.0, 0.225, 0.45, 0.675, 0.9].map(|radius| bessel(m, zero * radius))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_of_the_bessel_zeros_are_the_published_ones() {
        let mut zeros: Vec<f64> = (0..6).flat_map(|m| (1..4).map(move |n| zero(m, n))).collect();
        zeros.sort_by(f64::total_cmp);
        for (zero, published) in
            zeros.iter().zip([1.0, 1.5933, 2.1355, 2.2954, 2.6531, 2.9173, 3.1555, 3.5001, 3.5985, 3.6475])
        {
            assert!((zero / zeros[0] - published).abs() < 1e-4, "{zero}");
        }
    }
}
