//! A kit played by the instrument and by the reference, and the difference between the two.

use dsp_core::SampleRate;
use dsp_core::engine::{Setup, Skipping, TickReport};
use dsp_core::fixed::ONE_Q27;
use dsp_core::table::Kit;
use malleus::render::instrument::{Output, Settings};
use malleus::render::{Performance, instrument, reference};

/// Stereo bus of the instrument, 1.0 = full scale, and the reports of all ticks.
pub fn instrument(
    loaded: &kit::Loaded,
    performance: &Performance,
    rate: SampleRate,
    skipping: Skipping,
) -> (Vec<[f64; 2]>, Vec<TickReport>) {
    let kit = Kit::parse(&loaded.binary).expect("a loaded kit is valid");
    let mut reports = Vec::new();
    let settings = Settings { setup: Setup { skipping, ..Setup::new(rate) }, block: 128, budget_cycles: None };
    let bus = instrument::render(&kit, performance, settings, Output::Bus, |report| reports.push(*report))
        .expect("the kit fits and the events are valid");
    (bus.into_iter().map(|frame| frame.map(|x| f64::from(x) / f64::from(ONE_Q27))).collect(), reports)
}

/// Stereo sound of the reference, 1.0 = full scale.
pub fn reference(loaded: &kit::Loaded, performance: &Performance, rate: SampleRate) -> Vec<[f64; 2]> {
    reference::render(&loaded.kit, performance, rate, |_| {}).expect("the events are valid")
}

/// SNR in dB over both channels.
pub fn snr_db(expected: &[[f64; 2]], got: &[[f64; 2]]) -> f64 {
    crate::single_mode::snr_db(expected.iter().flatten().copied(), got.iter().flatten().copied())
}

/// Largest difference of two sounds over both channels, 1.0 = full scale.
pub fn largest_difference(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
