//! Measurements of the residual: whole sounds over many seeds against the reference's expectations.

pub mod spectrum;
pub mod statistics;

use dsp_core::SampleRate;
use dsp_core::noise::Sfc32;
use dsp_core::residual::{ResidualBand, Shaper};
use dsp_core::resonator::TICK_FRAMES;

use crate::lent;

/// Rms below which noise ends: -110 dBFS.
pub const SILENCE: f32 = 3.162_277_7e-6;

/// Spacing of the edges of bands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spacing {
    /// All bands are equally wide in Hz.
    Linear,
    /// All bands are equally wide on the ERB-rate scale (Glasberg and Moore).
    Erb,
}

/// Edges of `count` adjacent bands from `low_hz` to `high_hz`.
pub fn edges_hz(spacing: Spacing, count: usize, [low_hz, high_hz]: [f64; 2]) -> Vec<f64> {
    let share = |edge: usize| edge as f64 / count as f64;
    let erb = |hz: f64| (1.0 + 0.004_37 * hz).ln();
    (0..=count)
        .map(|edge| match spacing {
            Spacing::Linear => low_hz + (high_hz - low_hz) * share(edge),
            Spacing::Erb => ((erb(low_hz) + (erb(high_hz) - erb(low_hz)) * share(edge)).exp() - 1.0) / 0.004_37,
        })
        .collect()
}

/// Bands as the reference takes them.
pub fn reference_bands(bands: &[ResidualBand]) -> Vec<reference::residual::Band> {
    let band = |band: &ResidualBand| reference::residual::Band {
        edges_hz: band.edges_hz.map(f64::from),
        weight: f64::from(band.weight),
        decay_db_per_s: f64::from(band.decay_db_per_s),
    };
    bands.iter().map(band).collect()
}

/// Residual stage of `dsp-core` with its bands, at 48 kHz.
pub fn shaper(bands: &[ResidualBand], seed: u32) -> Box<Shaper<'static>> {
    let mut shaper = Box::new(lent!(lender => Shaper::take(lender, bands.len())));
    shaper.load(bands.iter().copied(), SampleRate::HZ_48000, Sfc32::new(seed, 0), SILENCE);
    shaper
}

/// Sound of strikes (frame, strength) in order, as bus samples; full scale is 2^27.
pub fn play(shaper: &mut Shaper<'_>, strikes: &[(usize, f32)], frames: usize) -> Vec<i32> {
    let mut out = vec![0; frames];
    let mut strikes = strikes.iter().copied().peekable();
    for (tick, out) in out.chunks_mut(TICK_FRAMES).enumerate() {
        let mut done = 0;
        while done < out.len() {
            while let Some((_, strength)) = strikes.next_if(|(frame, _)| *frame <= tick * TICK_FRAMES + done) {
                shaper.strike(strength, done);
            }
            let next = strikes.peek().map_or(out.len(), |(frame, _)| (frame - tick * TICK_FRAMES).min(out.len()));
            shaper.render(&mut out[done..next]);
            done = next;
        }
        shaper.end_tick(0);
    }
    out
}
