//! Transverse modes of a uniform free-free bar (Euler-Bernoulli).
//!
//! Their wave numbers β solve `cos βL cosh βL = 1`, and their frequencies are proportional to
//! (βL)².

/// Root `n`, counted from 1, of `cos x cosh x = 1` above 0.
///
/// It is found by bisection of `cos x - 1/cosh x` around (n + 1/2) π.
pub(crate) fn root(n: u32) -> f64 {
    let equation = |x: f64| x.cos() - 1.0 / x.cosh();
    let middle = (f64::from(n) + 0.5) * std::f64::consts::PI;
    let (mut low, mut high) = (middle - 0.5, middle + 0.5);
    for _ in 0..60 {
        let x = 0.5 * (low + high);
        if (equation(x) > 0.0) == (equation(low) > 0.0) { low = x } else { high = x }
    }
    0.5 * (low + high)
}

/// Ratio of the frequency of mode `n`, counted from 1, to that of the first mode.
pub(crate) fn ratio(n: u32) -> f64 {
    (root(n) / root(1)).powi(2)
}

/// Shape of mode `n`, counted from 1, at a place from 0 (one end) to 1 (the other end).
///
/// It is `(cosh βx + cos βx - σ (sinh βx + sin βx)) / 2` with
/// `σ = (cosh βL - cos βL)/(sinh βL - sin βL)`, so that its magnitude is 1 at the ends.
pub(crate) fn shape(n: u32, place: f64) -> f64 {
    let length = root(n);
    let sigma = (length.cosh() - length.cos()) / (length.sinh() - length.sin());
    let x = length * place;
    0.5 * (x.cosh() + x.cos() - sigma * (x.sinh() + x.sin()))
}

/// Shapes of mode `n`, counted from 1, at five positions from the middle (0) to an end (1) of the
/// bar.
pub(crate) fn five_positions(n: u32) -> [f64; 5] {
    [0.5, 0.375, 0.25, 0.125, 0.0].map(|place| shape(n, place))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_and_ratios_of_the_bar_are_the_published_ones() {
        for (n, published) in (1..).zip([4.730041, 7.853205, 10.995608, 14.137165, 17.278760]) {
            assert!((root(n) - published).abs() < 1e-6);
        }
        for (n, published) in (1..).zip([1.0, 2.7565, 5.4039, 8.9330, 13.3443, 18.6379]) {
            assert!((ratio(n) - published).abs() < 1e-4);
        }
    }

    #[test]
    fn even_modes_have_a_node_in_the_middle_and_all_are_1_at_the_end() {
        assert!(shape(2, 0.5).abs() < 1e-9 && shape(1, 0.5).abs() > 0.5);
        for n in 1..6 {
            assert!((shape(n, 0.0) - 1.0).abs() < 1e-12);
        }
    }
}
