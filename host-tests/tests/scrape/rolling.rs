//! A ball that rolls: its line, its weight, and hills.

use dsp_core::scrape::Contact;
use dsp_core::time::TICK_FRAMES;
use host_tests::scrape::{RATE, Scrapes, along, render};

/// Weight of the ball of the kit, in newtons.
const WEIGHT_N: f32 = 0.022 * 9.806_65;

/// Frequency of the strongest line of a force's envelope, from 1 to 50 Hz.
fn line_hz(force: &[i32]) -> f64 {
    // The envelope: mean square of each tick.
    let square = |tick: &[i32]| tick.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>().sqrt();
    let envelope: Vec<f64> = force.chunks_exact(TICK_FRAMES).map(square).collect();
    let mean = envelope.iter().sum::<f64>() / envelope.len() as f64;
    let tick_s = TICK_FRAMES as f64 / RATE.hz();
    let power = |frequency_hz: f64| {
        let (mut real, mut imaginary) = (0.0, 0.0);
        for (tick, x) in envelope.iter().enumerate() {
            let window = 0.5 - 0.5 * (std::f64::consts::TAU * tick as f64 / envelope.len() as f64).cos();
            let angle = std::f64::consts::TAU * frequency_hz * tick as f64 * tick_s;
            real += (x - mean) * window * angle.cos();
            imaginary += (x - mean) * window * angle.sin();
        }
        real * real + imaginary * imaginary
    };
    let best = |candidates: &mut dyn Iterator<Item = f64>| {
        candidates.map(|hz| (power(hz), hz)).max_by(|a, b| a.0.total_cmp(&b.0)).expect("candidates").1
    };
    let coarse = best(&mut (40..2000).map(|step| f64::from(step) * 0.025));
    best(&mut (-100..=100).map(|step| coarse + f64::from(step) * 0.0005))
}

#[test]
fn envelope_has_its_line_where_the_ball_has_gone_round_once() {
    let scrapes = Scrapes::new();
    for speed in [0.4, 0.9] {
        for pad in ["mug", "woodblock", "glass"] {
            let contact = scrapes.contact(pad, "ball", true, [WEIGHT_N; 2]);
            let force = render(contact, &along((0..15_000).map(|_| speed), WEIGHT_N));
            let expected_hz = speed / (std::f64::consts::TAU * 0.02);
            let found_hz = line_hz(&force[3200..]);
            println!("{pad} at {speed} m/s: line at {found_hz:.4} Hz, once round is {expected_hz:.4} Hz");
            assert!((found_hz / expected_hz - 1.0).abs() < 0.005, "{pad}: {found_hz:.4} Hz for {expected_hz:.4} Hz");
        }
    }
}

#[test]
fn resting_ball_is_silent_and_one_that_begins_to_roll_does_not_click() {
    let scrapes = Scrapes::new();
    let contact = scrapes.contact("mug", "ball", true, [WEIGHT_N; 2]);
    assert!(render(contact, &along((0..3000).map(|_| 0.0), WEIGHT_N)).iter().all(|&force| force == 0));
    let begins = render(contact, &along((0..600).map(|tick| 1e-3 * f64::from(tick) / 600.0), WEIGHT_N));
    let largest = begins.iter().map(|force| force.unsigned_abs()).max().expect("frames");
    let weight = f64::from(WEIGHT_N / contact.reference_force_n) * f64::from(dsp_core::fixed::ONE_Q27);
    let step = begins.windows(2).map(|pair| pair[0].abs_diff(pair[1])).max().expect("frames");
    assert!(f64::from(step) < 0.02 * weight, "step {step}, largest {largest}, weight {weight:.0}");
}

#[test]
fn ball_without_an_offset_and_a_modulation_has_no_line() {
    let scrapes = Scrapes::new();
    let contact = scrapes.contact("mug", "ball", true, [WEIGHT_N; 2]);
    let round = contact.rolling.map(|ball| dsp_core::scrape::Rolling { offset_m: 0.0, modulation: 0.0, ..ball });
    let round = Contact { rolling: round, ..contact };
    let found_hz = line_hz(&render(round, &along((0..15_000).map(|_| 0.4), WEIGHT_N))[3200..]);
    let expected_hz = 0.4 / (std::f64::consts::TAU * 0.02);
    assert!((found_hz / expected_hz - 1.0).abs() > 0.01, "{found_hz:.4} Hz");
}
