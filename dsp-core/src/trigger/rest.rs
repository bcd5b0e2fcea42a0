//! A channel at rest: silence in a few cycles a sample.
//!
//! While nothing has happened for a while, what a sample does is known before it comes: as long as it stays within a band round the
//! baseline, the envelope is the noise's mean by definition and only sums go on. So all that a silent channel needs is the proof that its samples are in
//! the band, and that is one addition and one logical operation for two channels at once. The first sample outside the band ends
//! the rest: from it on the envelope is followed.
//!
//! The band stands still for steps of [`STEP_FRAMES`] absolute frames, so that it is a pair of whole counts; the ramp of a hum of 10 counts
//! moves by 0.6 in that time. Its half width is 4.5 times the noise's mean (3.6 standard deviations of white noise) and half a count, but never more than
//! half of the softest strike's peak.

use super::Lane;

/// Frames for which the band stands still; a divisor of a tick.
pub(super) const STEP_FRAMES: u32 = 8;

/// The counts between which a channel rests, both among them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Band {
    low: i32,
    high: i32,
}

impl Band {
    /// All counts that an ADC can give.
    const ANY: Self = Self { low: 0, high: 4095 };

    /// `half_width` counts to both sides of `middle`. Cut off far outside the ADC's range, so that [`survey`]'s sums stay in their 16 bits.
    pub(super) fn round(middle: i32, half_width: i32) -> Self {
        let bound = |count: i32| count.clamp(-4096, 8190);
        Self { low: bound(middle.saturating_sub(half_width)), high: bound(middle.saturating_add(half_width)) }
    }

    /// Whether a sample lies in it.
    pub(super) fn holds(self, raw: u16) -> bool {
        (self.low..=self.high).contains(&i32::from(raw))
    }
}

/// Lets the resting ones of two neighbouring channels (`pair` counts from 0) take frames of one tick, step by step, until they leave their band: how
/// many frames each has taken. The first frame is number `now`.
#[inline(never)] // the hot loop, all that silence costs: it has all registers to itself
pub(super) fn pass<const CHANNELS: usize>(
    lanes: &mut [Option<Lane>],
    frames: &[[u16; CHANNELS]],
    pair: usize,
    now: u32,
) -> [usize; 2] {
    let mut passed = [0; 2];
    let mut open = [false; 2];
    for (open, lane) in open.iter_mut().zip(lanes.iter()) {
        *open = lane.as_ref().is_some_and(|lane| lane.channel.is_resting);
    }
    let (mut now, mut frames) = (now, frames);
    while open != [false; 2] && !frames.is_empty() {
        let length = (STEP_FRAMES - now % STEP_FRAMES) as usize;
        let (step, later) = frames.split_at_checked(length).unwrap_or((frames, &[]));
        let mut bands = [Band::ANY; 2];
        for ((band, lane), open) in bands.iter_mut().zip(lanes.iter()).zip(open) {
            if let (Some(lane), true) = (lane, open) {
                *band = lane.channel.band(now);
            }
        }
        let seen = survey(step, pair, bands);
        let next = now.wrapping_add(step.len() as u32);
        for (half, lane) in lanes.iter_mut().enumerate().take(2) {
            let (Some(lane), Some(open), Some(passed)) = (lane, open.get_mut(half), passed.get_mut(half)) else {
                continue;
            };
            let shift = 16 * half as u32;
            *open &= seen.outside >> shift & 0xFFFF == 0;
            if *open {
                lane.channel.rest_through(step.len(), seen.sum >> shift & 0xFFFF, seen.last >> shift & 0xFFFF, next);
                *passed += step.len();
            }
        }
        (now, frames) = (next, later);
    }
    passed
}

/// What a step of two channels amounts to; the first channel in the lower 16 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Seen {
    /// Not 0 where a sample lay outside its band.
    outside: u32,
    sum: u32,
    last: u32,
}

/// Looks at up to 8 frames. In each half of a word `raw + 0x4000 - low` has bit 14 set where the sample is not below the band, and
/// `raw + 0x4000 - (high + 1)` has it clear where it is not above. With samples of 12 bits and bounds from -4096 to 8191 both lie between 0 and
/// 24575, so that no half reaches into the other, and 8 samples sum up to 32760; whatever has more than 12 bits counts as outside.
fn survey<const CHANNELS: usize>(step: &[[u16; CHANNELS]], pair: usize, [first, second]: [Band; 2]) -> Seen {
    const FLAG: u32 = 0x4000_4000;
    let pack = |first: i32, second: i32| ((0x4000 - first) as u32 & 0xFFFF) | ((0x4000 - second) as u32) << 16;
    let (above_low, above_high) = (pack(first.low, second.low), pack(first.high + 1, second.high + 1));
    let (mut inside, mut outside, mut bits, mut sum, mut last) = (FLAG, 0u32, 0u32, 0u32, 0u32);
    let mut look = |samples: u32| {
        inside &= samples.wrapping_add(above_low);
        outside |= samples.wrapping_add(above_high);
        bits |= samples;
        sum = sum.wrapping_add(samples);
        last = samples;
    };
    // Known here, the compiler need not ask at every sample.
    if pair < CHANNELS / 2 {
        for frame in step {
            let &[first, second] = frame.as_chunks::<2>().0.get(pair).unwrap_or(&[0; 2]);
            look(u32::from(first) | u32::from(second) << 16);
        }
    } else {
        step.iter().for_each(|frame| look(frame.last().copied().unwrap_or(0).into()));
    }
    // A carry out of a half that has too many bits may have hidden the other half's.
    let garbled = if bits & 0xF000_F000 == 0 { 0 } else { u32::MAX };
    Seen { outside: !inside & FLAG | outside & FLAG | garbled, sum, last }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_at_the_edge_of_its_band_is_inside_and_the_next_outside_whatever_the_other_channel_does() {
        for middle in [-1000, 0, 3, 2048, 4095, 5000] {
            for half_width in [1, 2, 11, 512] {
                let band = Band::round(middle, half_width);
                for raw in (0..=4095u16).chain([4096, 0x8000, 0xFFFF]) {
                    for other in [0, 2048, 4095] {
                        let seen = survey(&[[raw, other], [raw, other]], 0, [band, Band::ANY]);
                        assert_eq!(seen.outside & 0xFFFF == 0, band.holds(raw) && raw <= 4095, "{raw} in {band:?}");
                        assert!(seen.outside >> 16 == 0 || raw > 4095);
                        let swapped = survey(&[[other, raw]], 0, [Band::ANY, band]);
                        assert_eq!(swapped.outside >> 16 == 0, band.holds(raw) && raw <= 4095);
                    }
                }
            }
        }
    }

    #[test]
    fn sums_of_eight_frames_keep_to_their_halves() {
        let seen = survey(&[[4095u16, 4095, 4095]; 8], 0, [Band::ANY; 2]);
        assert_eq!((seen.outside, seen.sum, seen.last), (0, 32_760 | 32_760 << 16, 4095 | 4095 << 16));
        // The odd one stands alone.
        let seen = survey(&[[7u16, 7, 100]; 8], 1, [Band::ANY; 2]);
        assert_eq!((seen.outside, seen.sum, seen.last), (0, 800, 100));
    }
}
