//! Transforms against each other.

use fourier::{forward, inverse};

#[test]
fn a_signal_comes_back_times_its_length() {
    for length in [2, 30, 97, 1024] {
        let signal: Vec<f64> = (0..length).map(|n| f64::from(n * n % 7)).collect();
        let plan = forward(length as usize);
        let mut spectrum = plan.make_output_vec();
        plan.process(&mut signal.clone(), &mut spectrum).unwrap();
        let mut back = vec![0.0; signal.len()];
        inverse(length as usize).process(&mut spectrum, &mut back).unwrap();
        for (x, y) in signal.iter().zip(&back) {
            assert!((x - y / f64::from(length)).abs() < 1e-12, "{length}");
        }
    }
}
