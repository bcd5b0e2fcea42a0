//! The pads of a shipped kit are about equally loud, and together below full scale.

use dsp_core::SampleRate;
use malleus::loudness::{Meter, peak, sum};

/// Loudest 400 ms at velocity 0.8, K-weighted, from the softest to the loudest pad of a kit.
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
