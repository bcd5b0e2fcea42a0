//! Bessel functions, and the frequency parameters of round plates and membranes.

use std::f64::consts::PI;

/// Bessel function J of a whole order.
pub(crate) fn j(order: u32, x: f64) -> f64 {
    libm::jn(order as i32, x)
}

/// Bessel function Y of a whole order.
fn y(order: u32, x: f64) -> f64 {
    libm::yn(order as i32, x)
}

/// Modified Bessel function I of a whole order times e^-x: its integral by the trapezoidal rule,
/// which is exact to rounding for what repeats.
pub(crate) fn i(order: u32, x: f64) -> f64 {
    let count = 200;
    let term = |k: i32| {
        let angle = 2.0 * PI * f64::from(k) / f64::from(count);
        (x * (angle.cos() - 1.0)).exp() * (f64::from(order) * angle).cos()
    };
    (0..count).map(term).sum::<f64>() / f64::from(count)
}

/// Modified Bessel function K of a whole order times e^x: its integral by the trapezoidal rule,
/// which is exact to rounding for what falls off so fast.
fn k(order: u32, x: f64) -> f64 {
    let step = 0.02;
    let term = |k: i32| {
        let t = step * f64::from(k);
        let value = (x * (1.0 - t.cosh())).exp() * (f64::from(order) * t).cosh();
        if k == 0 { value / 2.0 } else { value }
    };
    step * (0..600).map(term).sum::<f64>()
}

/// Roots of a function between two numbers, in order; a step from one place to the next shorter
/// than their distances.
fn roots(from: f64, to: f64, step: f64, function: impl Fn(f64) -> f64) -> Vec<f64> {
    let count = ((to - from) / step) as usize;
    let places: Vec<f64> = (0..=count).map(|k| from + step * k as f64).collect();
    let values: Vec<f64> = places.iter().map(|place| function(*place)).collect();
    let mut found = Vec::new();
    for k in 0..count {
        let changes = values[k] * values[k + 1] < 0.0;
        if !changes {
            continue;
        }
        let (mut low, mut high) = (places[k], places[k + 1]);
        for _ in 0..50 {
            let half = (low + high) / 2.0;
            if values[k] * function(half) <= 0.0 { high = half } else { low = half }
        }
        found.push(low);
    }
    found
}

/// Place below all parameters of a number of waves: each is above the zeros of J.
fn first(waves: u32) -> f64 {
    f64::from(waves).max(0.5)
}

/// Parameters of all numbers of waves round the axis below a limit, those with waves twice.
fn pairs(limit: f64, of_waves: impl Fn(u32) -> Vec<f64>) -> Vec<f64> {
    let mut all = Vec::new();
    for waves in 0..limit as u32 {
        let found = of_waves(waves);
        (0..1 + usize::from(waves > 0)).for_each(|_| all.extend(&found));
    }
    all.sort_by(f64::total_cmp);
    all
}

/// Wave numbers times outer radius of a clamped membrane between two circles, in order up to a
/// limit.
pub(crate) fn ring_membrane(inner: f64, limit: f64) -> Vec<f64> {
    pairs(limit, |n| roots(first(n), limit, 0.05, |x| j(n, x) * y(n, inner * x) - j(n, inner * x) * y(n, x)))
}

/// Roots of the frequency equation of a clamped thin disc for a number of waves round it.
fn disc_roots(waves: u32, limit: f64) -> Vec<f64> {
    // J I' - I J' with f' = n/x f -/+ f of the next order.
    roots(first(waves), limit, 0.05, |x| j(waves, x) * i(waves + 1, x) + i(waves, x) * j(waves + 1, x))
}

/// Wave numbers times radius of a clamped thin disc, in order up to a limit.
pub(crate) fn clamped_disc(limit: f64) -> Vec<f64> {
    pairs(limit, |waves| disc_roots(waves, limit))
}

/// Waves round a clamped thin disc and wave number times radius of each mode or pair, in order up
/// to a limit.
pub(crate) fn clamped_disc_modes(limit: f64) -> Vec<(u32, f64)> {
    let of_waves = |waves: u32| disc_roots(waves, limit).into_iter().map(move |number| (waves, number));
    let mut modes: Vec<(u32, f64)> = (0..limit as u32).flat_map(of_waves).collect();
    modes.sort_by(|a, b| a.1.total_cmp(&b.1));
    modes
}

/// Shape of a clamped thin disc's mode along the radius, as a share of it.
pub(crate) fn clamped_disc_shape((waves, number): (u32, f64), share: f64) -> f64 {
    let grown = i(waves, number * share) * (number * (share - 1.0)).exp() / i(waves, number);
    j(waves, number * share) - j(waves, number) * grown
}

/// Wave numbers times outer radius of a thin plate clamped at two circles, in order up to a limit.
pub(crate) fn clamped_ring(inner: f64, limit: f64) -> Vec<f64> {
    let determinant = |n: u32, x: f64| {
        let row = |share: f64| {
            let at = x * share;
            let [grows, falls] = [(at - x).exp(), (inner * x - at).exp()];
            let ratio = f64::from(n) / at;
            let values = [j(n, at), y(n, at), grows * i(n, at), falls * k(n, at)];
            let next = [j(n + 1, at), y(n + 1, at), -grows * i(n + 1, at), falls * k(n + 1, at)];
            [values, [0, 1, 2, 3].map(|column| ratio * values[column] - next[column])]
        };
        let [[a, b], [c, d]] = [inner, 1.0].map(row);
        faer::Mat::from_fn(4, 4, |row, column| [a, b, c, d][row][column]).determinant()
    };
    pairs(limit, |n| roots(first(n), limit, 0.05, |x| determinant(n, x)))
}

/// Zeros below a limit of the Bessel function of any order, by the power series.
pub(crate) fn zeros_of_order(order: f64, most: f64) -> Vec<f64> {
    let value = |x: f64| {
        let (mut term, mut sum) = (1.0, 1.0);
        for k in 1..80 {
            term *= -0.25 * x * x / (f64::from(k) * (f64::from(k) + order));
            sum += term;
        }
        sum
    };
    let steps = (most / 0.05) as usize;
    let bounds = (0..steps).map(|k| [0.05 * k as f64, 0.05 * (k + 1) as f64]);
    let crossings = bounds.filter(|&[low, high]| value(low) * value(high) < 0.0);
    let zero = |[mut low, mut high]: [f64; 2]| {
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if value(low) * value(middle) <= 0.0 { high = middle } else { low = middle }
        }
        low
    };
    crossings.map(zero).collect()
}
