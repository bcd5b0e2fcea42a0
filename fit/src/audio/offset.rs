//! Constant offset of a channel, as the inputs of cheap sound cards add it.

/// Longest block in seconds over which the mean is taken.
const BLOCK_S: f64 = 0.05;
/// Least number of blocks.
const LEAST_BLOCKS: usize = 16;
/// Share of the blocks that count as quiet.
const QUIET_SHARE: usize = 4;
/// Least offset in standard deviations of its estimate.
const LEAST_DEVIATIONS: f64 = 12.0;
/// Least offset relative to the rms of quiet blocks: -20 dB of their noise.
const LEAST_OVER_NOISE: f64 = 0.1;
/// Least offset relative to full scale. Samples that are cut off to 16 bits, and not rounded, are
/// 0.000015 too low.
const LEAST_OFFSET: f64 = 2e-5;
/// Least variance of a block: digital silence has none.
const LEAST_VARIANCE: f64 = 1e-16;

/// Constant offset of a channel of `length` samples, full scale 1; 0 if none is noticeable.
///
/// The channel is cut into short blocks, and the mean of each is weighted by the inverse of the
/// block's variance: quiet blocks count most. The weighted mean of these means is the estimate, and
/// their scatter gives its standard deviation. An estimate below [`LEAST_DEVIATIONS`] is noise: the
/// function returns 0, and the channel keeps all its bits.
pub(super) fn constant_offset(samples: impl Iterator<Item = f64>, length: usize, rate_hz: f64) -> f64 {
    let size = ((BLOCK_S * rate_hz) as usize).min(length / LEAST_BLOCKS);
    if size == 0 {
        return 0.0;
    }
    let mut block = Vec::with_capacity(size);
    // Mean and variance of each block.
    let mut blocks: Vec<[f64; 2]> = Vec::with_capacity(length / size);
    for x in samples {
        block.push(x);
        if block.len() == size {
            let mean = block.iter().sum::<f64>() / size as f64;
            let variance = block.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / size as f64;
            blocks.push([mean, variance.max(LEAST_VARIANCE)]);
            block.clear();
        }
    }
    let mut variances: Vec<f64> = blocks.iter().map(|block| block[1]).collect();
    variances.sort_by(f64::total_cmp);
    // One silent block alone would say nothing of the scatter.
    let Some(&quiet) = variances.get(variances.len() / QUIET_SHARE) else { return 0.0 };
    let weight = |variance: f64| 1.0 / variance.max(quiet);
    let all: f64 = blocks.iter().map(|block| weight(block[1])).sum();
    let offset = blocks.iter().map(|block| weight(block[1]) * block[0]).sum::<f64>() / all;
    let scatter = blocks.iter().map(|block| (weight(block[1]) * (block[0] - offset)).powi(2)).sum::<f64>();
    let deviation = scatter.sqrt() / all;
    let least = (LEAST_DEVIATIONS * deviation).max(LEAST_OVER_NOISE * quiet.sqrt()).max(LEAST_OFFSET);
    if offset.abs() > least { offset } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;

    fn offset(samples: &[f64], added: f64) -> f64 {
        constant_offset(samples.iter().map(|x| x + added), samples.len(), 44_100.0)
    }

    #[test]
    fn offset_of_struck_things_is_told_within_a_tenth_of_their_noise() {
        for seed in 1..4 {
            let sound = plain(seed, 3.0, 5, -60.0);
            for added in [1e-3, -0.02, 0.2] {
                let found = offset(&sound.samples, added);
                assert!((found - added).abs() < 0.1 * sound.noise_rms, "seed {seed}: {found} for {added}");
            }
        }
    }

    #[test]
    fn struck_things_silence_and_hum_have_no_offset() {
        for seed in 1..4 {
            assert_eq!(offset(&plain(seed, 3.0, 5, -60.0).samples, 0.0), 0.0);
        }
        let hum: Vec<f64> = (0..88_200).map(|n| 0.01 * (f64::from(n) * 50.3 / 7_000.0).sin()).collect();
        assert_eq!((offset(&hum, 0.0), offset(&[0.0; 9_000], 0.0), offset(&[0.5; 5], 0.0)), (0.0, 0.0, 0.0));
        assert_eq!(offset(&[0.5; 9_000], 0.0), 0.5);
    }
}
