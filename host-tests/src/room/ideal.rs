//! The ideal room: independent decaying noise on both sides, cut exactly into its bands.

use super::{Band, Look, Spectrum, Table, tables::random};

/// Answer of an ideal room to a unit impulse, for each side. Each side and each seed has its own
/// noise.
///
/// It has no skirts, no resonances and no rounding. If a checker finds its T60 wrong, the reason is
/// the checker's filter or the scatter of noise.
pub fn ideal_response(table: &Table, rate_hz: f64, frames: usize, seed: u64) -> [Vec<f64>; 2] {
    let mut random = random(seed);
    // Neighbouring seeds begin with similar numbers, which are skipped.
    (0..20).for_each(|_| _ = random());
    [(); 2].map(|()| {
        let mut sum = vec![0.0; frames];
        for (index, band) in table.bands.iter().enumerate() {
            // White noise of power g²/rate a sample has the energy g²/(2 d). The band gets its
            // share of the spectrum.
            let rms = band.gain / rate_hz.sqrt();
            let decay = -1000f64.ln() / (band.t60_s * rate_hz);
            let noise: Vec<f64> =
                (0..frames).map(|frame| rms * (decay * frame as f64).exp() * 12f64.sqrt() * (random() - 0.5)).collect();
            let part = Spectrum::new(&noise, rate_hz)
                .band(Look::Whole, Band { from_hz: band.from_hz, to_hz: table.to_hz(index, rate_hz) });
            sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        }
        sum
    })
}
