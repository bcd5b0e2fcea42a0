//! The dynamic filter's estimation: stability, decays of loops, and the damping of recordings that survives in it.

use std::f64::consts::PI;

use fit::bark::damping_law;
use fit::dynamic_filter::{Breakpoint, Coefficients, Loop, Model, Path, RATE_HZ, average, loop_gain, render};

/// Noise for 20 ms through a low-pass that stands still.
fn burst() -> Path {
    let coefficients = Coefficients { a: [-0.3, 0.0], b: [0.2, 0.1, 0.0] };
    let point = |time_s| Breakpoint { time_s, coefficients };
    Path { points: vec![point(0.0), point(0.02)] }
}

/// A loop whose gain round the filter is `gain`, in phase (eq. 22).
fn tuned(path: &Path, frequency_hz: f64, bandwidth_hz: f64, gain: f64) -> Loop {
    let angular = std::f64::consts::TAU * frequency_hz / RATE_HZ;
    let filter = average(path, angular);
    let period = RATE_HZ / frequency_hz;
    let first = filter.arg() / std::f64::consts::TAU * period;
    let delay = first + period * ((32.0 - first) / period).ceil();
    Loop { frequency_hz, bandwidth_hz, gain: gain / filter.norm(), delay_s: delay / RATE_HZ }
}

#[test]
fn a_loop_left_to_itself_decays_by_its_width_and_gain() {
    for (frequency, bandwidth, gain) in
        [(440.0, 10.0, 0.9), (2055.0, 24.0, 0.916), (5963.0, 100.0, 0.9), (9529.0, 60.0, 0.8)]
    {
        let path = burst();
        let guide = tuned(&path, frequency, bandwidth, gain);
        assert!((loop_gain(&path, &[guide]) / gain - 1.0).abs() < 0.01, "{}", loop_gain(&path, &[guide]));
        let model = Model { path, loops: vec![guide], ..Model::default() };
        let sound = render(&model, 96_000, 1);
        let law = damping_law(&sound[1200..], RATE_HZ).expect("it decays");
        let beta = PI * bandwidth;
        let expected = beta * (1.0 - gain) / (1.0 + beta * gain * guide.delay_s);
        let ratio = law.decay_per_s(frequency) / expected;
        println!("{frequency} Hz: {:.2} for {expected:.2} 1/s", law.decay_per_s(frequency));
        assert!((ratio - 1.0).abs() < 0.05, "{frequency} Hz: {ratio}");
    }
}
