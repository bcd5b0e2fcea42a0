//! Stationary noise of a recording: what all strikes and the room leave of it, octave by octave.

use std::f64::consts::TAU;

use super::estimate::BackgroundBand;
use crate::band::highest_hz;

/// Lower edge of the lowest octave in Hz.
const LOWEST_HZ: f64 = 22.1;
/// Length of a frame in samples.
const FRAME: usize = 8192;

/// Levels of the octaves from 22 Hz on: medians over frames, which loud moments do not move.
///
/// Empty for a residual that is shorter than a frame.
pub(crate) fn background(residual: &[f64], rate_hz: f64) -> Vec<BackgroundBand> {
    let transform = fourier::forward(FRAME);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    let top = highest_hz(rate_hz);
    let lower = std::iter::successors(Some(LOWEST_HZ), |edge| Some(2.0 * edge)).take_while(|edge| *edge < top);
    let edges: Vec<[f64; 2]> = lower.map(|edge| [edge, (2.0 * edge).min(top)]).collect();
    let bin = |hz: f64| ((hz / rate_hz * FRAME as f64).round() as usize).min(FRAME / 2);
    let mut powers: Vec<Vec<f64>> = vec![Vec::new(); edges.len()];
    for frame in residual.chunks_exact(FRAME) {
        for (n, (slot, x)) in input.iter_mut().zip(frame).enumerate() {
            *slot = x * (1.0 - (TAU * (n as f64 + 0.5) / FRAME as f64).cos());
        }
        if transform.process(&mut input, &mut output).is_err() {
            break;
        }
        for (powers, edges) in powers.iter_mut().zip(&edges) {
            let energy: f64 = output[bin(edges[0])..bin(edges[1])].iter().map(|bin| bin.norm_sqr()).sum();
            // The mean square of the window is 3/2; a bin stands for its mirror image too.
            powers.push(2.0 * energy / (1.5 * (FRAME * FRAME) as f64));
        }
    }
    let median = |mut powers: Vec<f64>| {
        powers.sort_by(f64::total_cmp);
        powers.get(powers.len() / 2).copied()
    };
    let of_band = |(edges_hz, powers): ([f64; 2], Vec<f64>)| {
        median(powers).map(|power| BackgroundBand { edges_hz, level_dbfs: 10.0 * power.max(1e-30).log10() })
    };
    edges.into_iter().zip(powers).filter_map(of_band).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn octaves_of_white_noise_have_their_share_of_its_power() {
        let mut random = SplitMix64(3);
        let mut noise: Vec<f64> = (0..300_000).map(|_| 1e-3 * random.normal()).collect();
        // A loud moment.
        noise[150_000..152_000].iter_mut().for_each(|x| *x *= 100.0);
        let bands = background(&noise, 44_100.0);
        assert_eq!(bands.len(), 10);
        for band in &bands[3..] {
            let share = (band.edges_hz[1] - band.edges_hz[0]) / 22_050.0;
            let expected = -60.0 + 10.0 * share.log10();
            assert!((band.level_dbfs - expected).abs() < 1.0, "{band:?}, {expected}");
        }
    }
}
