//! A channel at rest: silence in a few cycles a sample.
//!
//! A channel rests once nothing has happened for a while. As long as its samples stay within a band
//! round the baseline, the envelope is the noise's mean by definition, and only sums go on. All
//! that a silent channel needs is the proof that its samples are in the band. That proof takes two
//! additions and two logical operations for two channels at once. The first sample outside the band
//! ends the rest: from there on the envelope is followed.
//!
//! The band stands still for a tick, so that it is a pair of whole counts. Its half width adds up
//! 4.5 times the noise's mean (3.6 standard deviations of white noise), half a count, and the
//! baseline's motion in half a tick. It is never more than half of the softest strike's peak.

use super::band::Band;
use super::channel::Channel;
use super::lane::Lane;

/// Lets each resting channel take the frames if all of its samples are in its band, and gives a bit
/// for each channel that took them.
///
/// The frames are at most a tick; the first is number `now`. The proof is for two neighbours at
/// once: if one of them leaves its band, neither takes the frames.
#[inline(never)] // the hot loop, all that silence costs: it has all registers to itself
pub(super) fn pass<const CHANNELS: usize>(
    lanes: &mut [Option<Lane>; CHANNELS],
    frames: &[[u16; CHANNELS]],
    now: u32,
) -> u32 {
    let mut passed = 0;
    for (pair, lanes) in lanes.chunks_mut(2).enumerate() {
        let index = 2 * pair;
        let (first, second) = lanes.split_at_mut_checked(1).unwrap_or_default();
        match (resting(first), resting(second)) {
            (None, None) => {}
            (Some(lane), None) => {
                if let Some([sum, _]) = sums_inside(frames, |frame| column(frame, index), [lane.band, Band::NONE]) {
                    lane.rest_through(frames, index, sum, now);
                    passed |= 1 << index;
                }
            }
            (None, Some(lane)) => {
                if let Some([sum, _]) = sums_inside(frames, |frame| column(frame, index + 1), [lane.band, Band::NONE]) {
                    lane.rest_through(frames, index + 1, sum, now);
                    passed |= 2 << index;
                }
            }
            (Some(lane), Some(next)) => {
                if let Some([sum, next_sum]) = sums_inside(frames, |frame| columns(frame, pair), [lane.band, next.band])
                {
                    lane.rest_through(frames, index, sum, now);
                    next.rest_through(frames, index + 1, next_sum, now);
                    passed |= 3 << index;
                }
            }
        }
    }
    passed
}

/// State of the first lane's channel if it rests.
fn resting(lane: &mut [Option<Lane>]) -> Option<&mut Channel> {
    let channel = &mut lane.first_mut()?.as_mut()?.channel;
    channel.is_resting.then_some(channel)
}

fn column<const CHANNELS: usize>(frame: &[u16; CHANNELS], index: usize) -> u32 {
    frame.get(index).copied().unwrap_or(0).into()
}

fn columns<const CHANNELS: usize>(frame: &[u16; CHANNELS], pair: usize) -> u32 {
    let &[first, second] = frame.as_chunks::<2>().0.get(pair).unwrap_or(&[0; 2]);
    u32::from(first) | u32::from(second) << 16
}

/// Sums of up to 32 samples of two channels, or `None` if a sample is outside its band. Each word
/// of `samples` holds one channel's sample in each half.
///
/// In each half, `raw - low` of a sample inside is 0 to `width`. Its bit 15 is clear, and so is
/// that of `raw - low + 0x7FFF - width`. Outside, one of the two is set: below the band by the
/// borrow, above it by the second sum, or by the first if that goes beyond 0x7FFF. A carry from the
/// first half into the second does not matter then, as the answer is `None` already. Inside, 32
/// times 1023 stay in their half.
#[inline(always)]
fn sums_inside<const CHANNELS: usize>(
    frames: &[[u16; CHANNELS]],
    samples: impl Fn(&[u16; CHANNELS]) -> u32,
    [first, second]: [Band; 2],
) -> Option<[i32; 2]> {
    const SIGN: u32 = 0x8000_8000;
    let low = (first.low as u32).wrapping_add((second.low as u32) << 16);
    let to_sign = (0x7FFF - first.width) as u32 | ((0x7FFF - second.width) as u32) << 16;
    let (mut seen, mut sum) = (0u32, 0u32);
    let mut look = |frame: &[u16; CHANNELS]| {
        let above = samples(frame).wrapping_sub(low);
        seen |= above | above.wrapping_add(to_sign);
        sum = sum.wrapping_add(above);
    };
    let (fours, rest) = frames.as_chunks::<4>();
    for [a, b, c, d] in fours {
        look(a);
        look(b);
        look(c);
        look(d);
    }
    rest.iter().for_each(look);
    let whole = |half: u32, band: Band| half as i32 + band.low * frames.len() as i32;
    (seen & SIGN == 0).then(|| [whole(sum & 0xFFFF, first), whole(sum >> 16, second)])
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::format;
    use std::vec::Vec;

    use super::super::band::WIDEST;
    use super::super::{Report, Settings, Trigger};
    use super::*;
    use crate::SampleRate;
    use crate::time::TICK_FRAMES;

    fn band(low: i32, width: i32) -> Band {
        Band { low, width }
    }

    fn both(frames: &[[u16; 2]], bands: [Band; 2]) -> Option<[i32; 2]> {
        sums_inside(frames, |frame| columns(frame, 0), bands)
    }

    #[test]
    fn samples_at_the_edge_of_a_band_are_inside_whatever_the_other_channel_does() {
        for low in [0, 1, 3, 2048, 4000, 4095] {
            for width in [0, 2, 22, WIDEST - 1, WIDEST] {
                let here = band(low, width);
                let edges = [low.max(1) - 1, low, low + width, low + width + 1].into_iter().map(|raw| raw as u16);
                for raw in (0..=4095u16).step_by(13).chain(edges).chain([4095, 4096, 0x7FFF, 0x8000, 0xFFFF]) {
                    for (other, inside) in
                        [(2047u16, false), (2048, true), (2058, true), (2059, false), (0xFFFF, false)]
                    {
                        let there = band(2048, 10);
                        let expected = here.holds(raw) && inside;
                        assert_eq!(
                            both(&[[raw, other]], [here, there]).is_some(),
                            expected,
                            "{raw} in {here:?}, {other}"
                        );
                        assert_eq!(
                            both(&[[other, raw]], [there, here]).is_some(),
                            expected,
                            "{raw} in {here:?}, {other}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn sums_of_a_tick_at_the_edges_of_the_widest_bands_are_exact() {
        let bands = [band(0, WIDEST), band(3072, WIDEST)];
        assert_eq!(both(&[[0, 4095]; 32], bands), Some([0, 32 * 4095]));
        assert_eq!(both(&[[0, 3072]; 31], bands), Some([0, 31 * 3072]));
        let bands = [band(0, WIDEST), band(0, WIDEST)];
        assert_eq!(both(&[[1023, 1023]; 32], bands), Some([32 * 1023; 2]));
    }

    #[test]
    fn odd_channel_is_summed_alone() {
        let frames = [[7u16, 7, 100]; 9];
        assert_eq!(sums_inside(&frames, |frame| column(frame, 2), [band(98, 2), Band::NONE]), Some([900, 0]));
        assert_eq!(sums_inside(&frames, |frame| column(frame, 2), [band(97, 2), Band::NONE]), None);
        assert_eq!(sums_inside(&frames, |frame| column(frame, 1), [band(7, 0), Band::NONE]), Some([63, 0]));
    }

    /// Counts of three piezos: noise with rare peaks on a slow drift, a ring every 0.1 s, and hum.
    fn counts(frame: usize, random: &mut u32) -> [u16; 3] {
        let mut noise = || {
            *random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(*random >> 16) / 32_768.0 - 1.0
        };
        let t = frame as f64 / 48_000.0;
        let ring = (-(t % 0.1) / 0.004).exp() * (6000.0 * t).sin();
        let noisy = 2000.0 + 40.0 * t + 2.0 * (noise() + noise() + noise());
        let ringing = 2048.0 + noise() + if t > 0.15 { 300.0 * ring } else { 0.0 };
        let humming = 2100.0 + 8.0 * (314.0 * t).sin() + noise();
        [noisy, ringing, humming].map(|count| count.round() as u16)
    }

    #[test]
    fn samples_taken_at_once_leave_the_state_that_samples_taken_one_by_one_leave() {
        let pads = [0, 1, 2].map(Settings::of_unset_pad);
        let mut quick = Trigger::<3>::new(pads, SampleRate::HZ_48000).unwrap();
        let mut plain = quick.clone();
        let mut random = 1;
        let frames: Vec<[u16; 3]> = (0..48_000).map(|frame| counts(frame, &mut random)).collect();
        let (mut found, mut found_plainly) = (Vec::new(), Vec::new());
        let (mut resting, mut ticks) = (0, 0);
        for tick in frames.chunks(TICK_FRAMES) {
            quick.process(tick, |report| found.push(format!("{report:?}")));
            for frame in tick {
                plain.process_plainly(frame, |report| found_plainly.push(format!("{report:?}")));
            }
            let [quick, plain] = [&quick, &plain].map(|trigger| format!("{:?}", trigger.lanes));
            assert_eq!(quick, plain, "after {ticks} ticks");
            resting += quick.matches("is_resting: true").count();
            ticks += 1;
        }
        assert_eq!(found, found_plainly);
        assert!(found.len() >= 8, "{found:?}");
        assert!(resting > ticks, "{resting} rests of {ticks} ticks and 3 channels");
    }

    impl Trigger<3> {
        /// Takes one frame as [`Trigger::process`] does, but lets no channel pass at rest.
        fn process_plainly(&mut self, frame: &[u16; 3], mut report: impl FnMut(Report<'_>)) {
            if self.now == 0 {
                for (lane, &raw) in self.lanes.iter_mut().flatten().zip(frame) {
                    lane.channel.start(raw);
                }
            }
            let now = self.now as u32;
            let soonest = self.frames_to_decision(now);
            self.run(&[*frame], now, 0, &mut report);
            self.now += 1;
            if self.now.is_multiple_of(TICK_FRAMES as u64) {
                self.tick(&mut report);
            }
            if soonest == Some(1) {
                self.decide(&mut report);
            }
        }
    }
}
