//! Finds levels at which the pads of a kit are equally loud, and prints one row per pad.
//!
//! Run it by `cargo run -p malleus --example kit_levels -- KIT [--spread DB]`. It changes no file.
//!
//! A pad's loudness is that of the loudest 400 ms of a strike at velocity 0.8, K-weighted (ITU-R
//! BS.1770). The levels found bring all pads to loudnesses within `--spread` dB (default 2). They
//! are the highest at which two sounds stay 0.5 dB below full scale: all pads struck at once at
//! velocity 1, and each pad rolled at velocity 1 and 10 strikes per second. The more a pad's peaks
//! stand above its loudness, the softer it is within the spread: else a click would hold all other
//! pads down.

use std::process::ExitCode;

use dsp_core::SampleRate;
use malleus::loudness::{Meter, Sound, peak, sum};

type Failure = Box<dyn std::error::Error>;

/// Largest sample that is allowed: -0.5 dBFS, 1.0 = full scale.
const CEILING: f64 = 0.944_060_876_285_923_5;

fn main() -> ExitCode {
    let Some((kit, spread_db)) = arguments() else {
        eprintln!("usage: kit_levels KIT [--spread DB]");
        return ExitCode::from(2);
    };
    // The engine that renders is built on the stack, and is larger than a usual one.
    let levels = std::thread::Builder::new()
        .stack_size(64 << 20)
        .spawn(move || level(&kit, spread_db).map_err(|error| eprintln!("kit_levels: {error}")));
    match levels.map(std::thread::JoinHandle::join) {
        Ok(Ok(Ok(()))) => ExitCode::SUCCESS,
        _ => ExitCode::FAILURE,
    }
}

fn arguments() -> Option<(String, f64)> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.as_slice() {
        [kit] => Some((kit.clone(), 2.0)),
        [kit, key, spread] if key == "--spread" => {
            Some((kit.clone(), spread.parse().ok().filter(|spread: &f64| *spread >= 0.0)?))
        }
        _ => None,
    }
}

/// Measurements of a pad at a level of 0 dB.
struct Measured {
    name: String,
    /// Level of the pad in the kit, in dB.
    level_db: f64,
    /// Loudness in LKFS.
    loudness: f64,
    /// Peak of a roll at velocity 1, 1.0 = full scale.
    roll_peak: f64,
    /// Sound of the strike at velocity 1 that peaks highest.
    hardest: Sound,
}

fn level(name: &str, spread_db: f64) -> Result<(), Failure> {
    let mut loaded = kit::open(name)?;
    let levels: Vec<f32> = loaded.kit.pads.iter().map(|pad| pad.level_db).collect();
    loaded.kit.pads.iter_mut().for_each(|pad| pad.level_db = 0.0);
    loaded.binary = kit::binary::build(&loaded.kit)?;
    let meter = Meter::new(&loaded, SampleRate::HZ_48000)?;
    let mut pads = Vec::new();
    for (index, (pad, level_db)) in loaded.kit.pads.iter().zip(levels).enumerate() {
        pads.push(Measured {
            name: pad.name.clone(),
            level_db: f64::from(level_db),
            loudness: meter.loudness(index)?,
            roll_peak: meter.roll_peak(index)?,
            hardest: meter.hardest_strike(index)?,
        });
    }
    let at_once = |levels: &[f64]| peak(&sum(pads.iter().zip(levels).map(|(pad, &level)| (gain(level), &pad.hardest))));

    // The loudness that each pad could have alone decides how much softer than the loudest it gets.
    let highest = |pad: &Measured| pad.loudness + decibels(CEILING / pad.roll_peak);
    let least = pads.iter().map(highest).fold(f64::INFINITY, f64::min);
    let most = pads.iter().map(highest).fold(f64::NEG_INFINITY, f64::max);
    let softer = |pad: &Measured| spread_db * (most - highest(pad)) / (most - least).max(f64::MIN_POSITIVE);
    let levels_at = |loudness: f64| -> Vec<f64> {
        pads.iter().map(|pad| (loudness - softer(pad)).min(highest(pad)) - pad.loudness).collect()
    };
    // The peak of all pads at once grows with the common loudness, so that bisection finds the
    // highest loudness that fits.
    let (mut low, mut high) = (least - 60.0, least + spread_db);
    if at_once(&levels_at(high)) > CEILING {
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if at_once(&levels_at(middle)) > CEILING { high = middle } else { low = middle }
        }
        high = low;
    }
    // Levels are rounded down to tenths of a dB.
    let chosen: Vec<f64> = levels_at(high).iter().map(|level| (10.0 * level).floor() / 10.0).collect();
    println!("| pad | level_db, as it is | loudness, LKFS | level_db, equal | loudness, LKFS | roll, peak dBFS |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for (pad, level) in pads.iter().zip(&chosen) {
        println!(
            "| `{}` | {:.1} | {:.1} | {level:.1} | {:.1} | {:.1} |",
            pad.name,
            pad.level_db,
            pad.loudness + pad.level_db,
            pad.loudness + level,
            decibels(pad.roll_peak) + level,
        );
    }
    let as_it_is: Vec<f64> = pads.iter().map(|pad| pad.level_db).collect();
    println!("all at once: {:.1} dBFS as it is, {:.1} dBFS", decibels(at_once(&as_it_is)), decibels(at_once(&chosen)));
    Ok(())
}

fn gain(level_db: f64) -> f64 {
    10f64.powf(level_db / 20.0)
}

fn decibels(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}
