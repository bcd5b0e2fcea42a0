//! Mono feed of the network, whose energy is the mean of both sides' at every constant-power pan.

/// Coefficients α of the all-passes `(z^-1 - α)/(1 - α z^-1)` of each side.
///
/// The two chains are 90° apart within 7.7° from 40 Hz to 20 kHz at 48 kHz.
const ALPHAS: [[f64; 3]; 2] = [[0.995_873, 0.908_579, 0.075_641], [0.977_746, 0.664_43, -0.648_582]];

/// Mono feed `(A(left) + B(right))/√2`, with the all-pass chains A and B.
pub(super) fn feed(sides: [&[f64]; 2]) -> Vec<f64> {
    let [left, right] = [0, 1].map(|side| {
        ALPHAS[side].iter().fold(sides[side].to_vec(), |signal, alpha| {
            let (mut last_x, mut last_y) = (0.0, 0.0);
            let all_pass = |x: f64| {
                let y = last_x - alpha * x + alpha * last_y;
                (last_x, last_y) = (x, y);
                y
            };
            signal.into_iter().map(all_pass).collect()
        })
    });
    left.into_iter().zip(right).map(|(left, right)| (left + right) / 2f64.sqrt()).collect()
}
