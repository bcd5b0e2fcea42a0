//! Loudness of the shipped kits: their pads are about equally loud, and below full scale together.

use dsp_core::SampleRate;
use malleus::loudness::{Meter, loudest_lkfs, peak, sum};

/// Largest difference in dB between the loudnesses of two pads of a kit.
///
/// A pad's loudness is that of the loudest 400 ms of a strike at velocity 0.8, K-weighted.
const MOST_SPREAD_DB: f64 = 6.0;

#[test]
fn pads_of_each_shipped_kit_lie_within_6_db_of_loudness() {
    let mut failures = Vec::new();
    for name in kit::shipped_names() {
        let loaded = kit::open(name).expect("a shipped kit");
        let meter = Meter::new(&loaded, SampleRate::HZ_48000).expect("a valid table");
        let loudness: Vec<f64> =
            (0..loaded.kit.pads.len()).map(|pad| meter.loudness(pad).expect("the kit fits")).collect();
        for (pad, loudness) in loaded.kit.pads.iter().zip(&loudness) {
            println!("{name} {}: {loudness:.1} LKFS", pad.name);
        }
        let loudest = loudness.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let softest = loudness.iter().copied().fold(f64::INFINITY, f64::min);
        println!("{name}: {:.1} dB from the softest to the loudest", loudest - softest);
        if loudest - softest > MOST_SPREAD_DB {
            failures.push(format!("{name}: {:.1} dB", loudest - softest));
        }
    }
    assert!(failures.is_empty(), "cargo run -p malleus --example kit_levels gives levels: {failures:?}");
}

#[test]
fn pads_of_each_shipped_kit_at_once_or_rolled_stay_below_full_scale() {
    let mut failures = Vec::new();
    for name in kit::shipped_names() {
        let loaded = kit::open(name).expect("a shipped kit");
        let meter = Meter::new(&loaded, SampleRate::HZ_48000).expect("a valid table");
        let mut hardest = Vec::new();
        for (index, pad) in loaded.kit.pads.iter().enumerate() {
            let roll = meter.roll_peak(index).expect("the kit fits");
            println!("{name} {}: {:.1} dBFS rolled", pad.name, 20.0 * roll.log10());
            if roll >= 1.0 {
                failures.push(format!("{name} {} rolled: {:.1} dBFS", pad.name, 20.0 * roll.log10()));
            }
            hardest.push(meter.hardest_strike(index).expect("the kit fits"));
        }
        let at_once = peak(&sum(hardest.iter().map(|sound| (1.0, sound))));
        println!("{name}: {:.1} dBFS all at once", 20.0 * at_once.log10());
        if at_once >= 1.0 {
            failures.push(format!("{name} all at once: {:.1} dBFS", 20.0 * at_once.log10()));
        }
    }
    assert!(failures.is_empty(), "cargo run -p malleus --example kit_levels gives levels: {failures:?}");
}

/// Loudness in LKFS of a full-scale sine in the left channel.
fn of_sine(hz: f64, rate_hz: f64) -> f64 {
    let frames = (2.0 * rate_hz) as u32;
    let sample = |n: u32| (std::f64::consts::TAU * hz * f64::from(n) / rate_hz).sin();
    let sound: Vec<[f64; 2]> = (0..frames).map(|n| [sample(n), 0.0]).collect();
    // The onset makes the filters ring at low frequencies, so that only the second half is
    // measured.
    loudest_lkfs(&sound[sound.len() / 2..], rate_hz, 0.4)
}

/// Magnitude in dB of the two biquads that the recommendation gives for 48 kHz.
fn published_db(hz: f64) -> f64 {
    let power = |b: [f64; 3], a: [f64; 3]| {
        let square = |c: [f64; 3]| {
            let angle = std::f64::consts::TAU * hz / 48_000.0;
            let re = c[0] + c[1] * angle.cos() + c[2] * (2.0 * angle).cos();
            let im = c[1] * angle.sin() + c[2] * (2.0 * angle).sin();
            re * re + im * im
        };
        10.0 * (square(b) / square(a)).log10()
    };
    power([1.53512485958697, -2.69169618940638, 1.19839281085285], [1.0, -1.69065929318241, 0.73248077421585])
        + power([1.0, -2.0, 1.0], [1.0, -1.99004745483398, 0.99007225036621])
}

#[test]
fn k_weighting_is_that_of_the_recommendation_at_every_rate() {
    for rate_hz in [44_100.0, 48_000.0, 96_000.0] {
        for hz in [100.0, 400.0, 997.0, 2_000.0, 5_000.0] {
            let (got, expected) = (of_sine(hz, rate_hz), published_db(hz) - 3.01 - 0.691);
            assert!((got - expected).abs() < 0.05, "{hz} Hz at {rate_hz} Hz: {got:.3}, not {expected:.3}");
        }
        assert!((of_sine(997.0, rate_hz) + 3.01).abs() < 0.05, "{rate_hz} Hz");
    }
}
