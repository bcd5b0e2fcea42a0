//! One piezo: conditioning, envelope, onset, and the scan of a strike.
//!
//! ```text
//!  ADC ──(-)──► |x| ──► envelope ──► > level? ──► scan: peak of |x| ──► decision
//!         ▲              1/8 a frame    ▲
//!      baseline                         └── threshold, noise floor, mask
//! ```

use super::baseline::{Baseline, MainsTurn};
use super::config::ChannelConfig;
use super::mask::{Mask, OVER_Q8};
use super::noise::NoiseFloor;
use super::report::Fault;
use super::rest::{Band, TAP_FRAMES};
use super::scan::Scan;
use super::{COUNT, TICK_FRAMES};

/// The envelope moves by 1/8 of its error a frame: 0.17 ms at 48 kHz, one half period of 3 kHz.
const ENVELOPE_SHIFT: u32 = 3;
/// A level that no envelope reaches.
const DEAF: i32 = i32::MAX;
/// An onset is looked for at most so many frames before the envelope crosses its level.
const LONGEST_LAG: u32 = 24;
/// Ticks after a start in which offset, hum and noise are learnt: 31 ms at 48 kHz.
const WARM_UP_TICKS: u16 = 47;
/// Ticks at a rail until a channel counts as stuck, and away from it until it counts as well: 20 and 100 ms at 48 kHz.
const STUCK_TICKS: u16 = 30;
const WELL_TICKS: u16 = 150;
/// Sums of a tick's samples beyond which all of it was at a rail.
const LOW_RAIL: i32 = 32 * 15;
const HIGH_RAIL: i32 = 32 * 4080;
/// Noise stays below so many times its mean, in 1/256 (2.4: 6 standard deviations of the envelope of white noise), and an onset is
/// where the envelope leaves 1.5 times the mean.
const NOISE_LEVEL_Q8: i32 = 614;
const NOISE_FOOT_Q8: i32 = 384;
/// A resting channel's samples are no farther from the baseline than so many times the noise's mean, in 1/256 (4.5), and half a count.
const REST_NOISE_Q8: i32 = 1152;
/// Samples of a resting tick that are measured.
const TAPS: i32 = TICK_FRAMES as i32 / TAP_FRAMES as i32;
/// By how much an onset must leave the mask's level, in 1/256.
const MASK_FOOT_Q8: i32 = 272;
/// What peaks are remembered for crosstalk: decays by 1/32 a tick, 21 ms.
const HOLD_SHIFT: u32 = 5;

/// The state of one channel. Signals are in 1/256 of an ADC count.
#[derive(Clone, Copy, Debug)]
pub(super) struct Channel {
    baseline: Baseline,
    noise: NoiseFloor,
    mask: Mask,
    /// Smoothed magnitude.
    pub(super) envelope: i32,
    /// The envelope above which a strike begins, and at which its onset is put.
    onset_level: i32,
    foot_level: i32,
    foot_frame: u32,
    /// The largest magnitude since: some strikes are loudest in their first sample, before they are noticed.
    rise_peak: i32,
    /// The largest envelope of the tick so far.
    tick_envelope: i32,
    /// Whether samples within the band move nothing.
    pub(super) is_resting: bool,
    pub(super) band: Band,
    /// Sum of the magnitudes of a resting tick's samples that are measured.
    rest_magnitude: i32,
    /// Sum of the tick's samples so far, in counts.
    sum: i32,
    /// The strike that is being scanned.
    pub(super) scan: Scan,
    pub(super) is_scanning: bool,
    masked_ticks: u16,
    warm_up_ticks: u16,
    rail_ticks: u16,
    /// What is wrong with the channel.
    pub(super) fault: Option<Fault>,
    /// Decaying memory of the last peak.
    hold: i32,
}

impl Channel {
    pub(super) const UNSET: Self = Self {
        baseline: Baseline::UNSET,
        noise: NoiseFloor::UNSET,
        mask: Mask::UNSET,
        envelope: 0,
        onset_level: DEAF,
        foot_level: 0,
        foot_frame: 0,
        rise_peak: 0,
        tick_envelope: 0,
        is_resting: false,
        band: Band::NONE,
        rest_magnitude: 0,
        sum: 0,
        scan: Scan::NONE,
        is_scanning: false,
        masked_ticks: 0,
        warm_up_ticks: WARM_UP_TICKS,
        rail_ticks: 0,
        fault: None,
        hold: 0,
    };

    /// Takes samples `index` of up to one tick of frames, the first of which is number `now`.
    pub(super) fn run<const CHANNELS: usize>(
        &mut self,
        frames: &[[u16; CHANNELS]],
        index: usize,
        now: u32,
        config: &ChannelConfig,
    ) {
        let at = if self.is_resting { self.rest(frames, index, now) } else { 0 };
        if at < frames.len() {
            self.follow(frames.get(at..).unwrap_or(&[]), index, now.wrapping_add(at as u32), config);
        }
    }

    /// Takes frames while they lie in the band, and gives their number; the first that leaves it is not taken.
    ///
    /// One sample after the other: [`rest::pass`](super::rest::pass) does the same for all at once.
    #[inline(never)]
    fn rest<const CHANNELS: usize>(&mut self, frames: &[[u16; CHANNELS]], index: usize, now: u32) -> usize {
        let band = self.band;
        let inside = samples(frames, index).take_while(|&raw| band.holds(raw));
        let (count, sum) = inside.fold((0, 0), |(count, sum): (usize, i32), raw| (count + 1, sum + i32::from(raw)));
        self.rest_through(frames.get(..count).unwrap_or(&[]), index, sum, now);
        if count < frames.len() {
            self.is_resting = false;
            self.foot_frame = now.wrapping_add(count as u32).wrapping_sub(1);
            self.rise_peak = 0;
        }
        count
    }

    /// Takes frames that are all in the band, with their sum; the first is number `now`.
    #[inline(always)]
    pub(super) fn rest_through<const CHANNELS: usize>(
        &mut self,
        frames: &[[u16; CHANNELS]],
        index: usize,
        sum: i32,
        now: u32,
    ) {
        let Baseline { level, slope, .. } = self.baseline;
        let mut tap = (TAP_FRAMES - 1 - now % TAP_FRAMES) as usize;
        while let Some(frame) = frames.get(tap) {
            let raw = frame.get(index).copied().unwrap_or(0);
            let x = condition(raw, level.wrapping_add(slope.wrapping_mul(tap as i32)));
            self.rest_magnitude = self.rest_magnitude.wrapping_add(x.wrapping_abs());
            tap += TAP_FRAMES as usize;
        }
        self.sum = self.sum.wrapping_add(sum);
        self.baseline.level = level.wrapping_add(slope.wrapping_mul(frames.len() as i32));
    }

    /// Takes frames of a tick in which something happens or rings.
    #[inline(never)]
    fn follow<const CHANNELS: usize>(
        &mut self,
        frames: &[[u16; CHANNELS]],
        index: usize,
        now: u32,
        config: &ChannelConfig,
    ) {
        for (at, raw) in (1..).zip(samples(frames, index)) {
            let (x, envelope) = self.take(raw);
            if self.is_scanning {
                self.scan.push(raw, x, envelope);
            } else if envelope <= self.foot_level {
                self.foot_frame = now.wrapping_add(at).wrapping_sub(1);
                self.rise_peak = 0;
            } else {
                if envelope > self.onset_level {
                    self.begin_scan(now.wrapping_add(at), config);
                    self.scan.push(raw, x, envelope);
                }
                self.rise_peak = self.rise_peak.max(x.wrapping_abs());
            }
        }
    }

    /// A strike was noticed in the frame before `now`.
    fn begin_scan(&mut self, now: u32, config: &ChannelConfig) {
        let onset = now.wrapping_sub(now.wrapping_sub(self.foot_frame).min(LONGEST_LAG));
        let decide_at = onset.wrapping_add(config.scan_frames);
        // A decision falls behind the tick in which it was announced.
        let nearest = now.wrapping_add(TICK_FRAMES as u32);
        let decide_at = if decide_at.wrapping_sub(nearest) < config.scan_frames { decide_at } else { nearest };
        self.scan = Scan::begin(decide_at, self.rise_peak);
        self.is_scanning = true;
        self.noise.struck();
    }

    /// The next sample without its baseline, and the envelope behind it.
    #[inline(always)]
    pub(super) fn take(&mut self, raw: u16) -> (i32, i32) {
        let x = condition(raw, self.baseline.level);
        self.baseline.level = self.baseline.level.wrapping_add(self.baseline.slope);
        self.sum = self.sum.wrapping_add(i32::from(raw));
        self.envelope = follow(self.envelope, x);
        self.tick_envelope = self.tick_envelope.max(self.envelope);
        (x, self.envelope)
    }

    /// Where the baseline starts, before the very first frame.
    pub(super) fn start(&mut self, raw: u16) {
        self.baseline.start(raw);
    }

    /// The end of an absolute tick. `Some` where a fault was found (inner `Some`) or is over.
    #[inline(never)]
    pub(super) fn tick(&mut self, config: &ChannelConfig, turn: &MainsTurn) -> Option<Option<Fault>> {
        if self.is_resting
            && self.mask.is_gone()
            && self.masked_ticks == 0
            && (LOW_RAIL + 1..HIGH_RAIL).contains(&self.sum)
        {
            self.rest_on(config, turn);
            None
        } else {
            self.tick_at_large(config, turn)
        }
    }

    /// What [`tick_at_large`](Self::tick_at_large) does for a channel that has rested for the whole tick, is far from a rail, and has no mask left.
    #[inline(always)]
    fn rest_on(&mut self, config: &ChannelConfig, turn: &MainsTurn) {
        self.rail_ticks = 0;
        self.baseline.tick(core::mem::take(&mut self.sum), true, turn);
        self.hold = self.hold.wrapping_sub(self.hold >> HOLD_SHIFT);
        let noise = self.noise.mean();
        self.noise.rest(core::mem::take(&mut self.rest_magnitude) / TAPS);
        if self.noise.mean() != noise {
            let noise = self.noise.mean();
            self.onset_level = config.threshold_envelope.max(scale_q8(noise, NOISE_LEVEL_Q8));
            self.foot_level = scale_q8(noise, NOISE_FOOT_Q8) + COUNT / 2;
            (self.envelope, self.tick_envelope) = (noise, noise);
        }
        self.set_band(config);
    }

    #[inline(never)]
    fn tick_at_large(&mut self, config: &ChannelConfig, turn: &MainsTurn) -> Option<Option<Fault>> {
        let sum = core::mem::take(&mut self.sum);
        let changed = self.watch_rails(sum);
        self.baseline.tick(sum, !self.is_scanning && self.fault.is_none(), turn);
        self.warm_up_ticks = self.warm_up_ticks.saturating_sub(1);
        self.masked_ticks = self.masked_ticks.saturating_sub(1);
        self.hold = self.hold.wrapping_sub(self.hold >> HOLD_SHIFT);
        let magnitude = core::mem::take(&mut self.rest_magnitude) / TAPS;
        if self.is_resting {
            self.noise.rest(magnitude);
        } else if !self.is_scanning {
            self.noise.tick(self.envelope, self.warm_up_ticks > 0);
        }
        let noise = self.noise.mean();
        let quiet = config.threshold_envelope.max(scale_q8(noise, NOISE_LEVEL_Q8));
        let noise_foot = scale_q8(noise, NOISE_FOOT_Q8) + COUNT / 2;
        let envelope = core::mem::replace(&mut self.tick_envelope, self.envelope).max(self.envelope);
        self.mask.tick(envelope, noise_foot, config.mask_decay);
        let deaf = self.masked_ticks > 0 || self.warm_up_ticks > 0 || self.fault.is_some();
        if deaf {
            self.rise_peak = 0;
        }
        self.onset_level = if deaf { DEAF } else { quiet.max(scale_q8(self.mask.level(), OVER_Q8)) };
        self.foot_level = noise_foot.max(scale_q8(self.mask.crest(), MASK_FOOT_Q8));
        let is_calm = !self.is_scanning && !self.mask.is_loud() && self.envelope <= self.foot_level;
        let may_rest = self.warm_up_ticks == 0 && self.fault.is_none() && config.direct_gain_q16.is_none();
        self.is_resting = is_calm && may_rest;
        if self.is_resting {
            (self.envelope, self.tick_envelope) = (noise, noise);
            self.set_band(config);
        }
        changed
    }

    /// The band of the tick that begins.
    #[inline(always)]
    fn set_band(&mut self, config: &ChannelConfig) {
        let Baseline { level, slope, .. } = self.baseline;
        let noise = scale_q8(self.noise.mean(), REST_NOISE_Q8) + COUNT / 2;
        self.band = Band::of_tick(level, slope, noise, config.threshold_peak >> 9);
    }

    fn watch_rails(&mut self, sum: i32) -> Option<Option<Fault>> {
        let rail = match sum {
            ..=LOW_RAIL => Some(Fault::StuckLow),
            HIGH_RAIL.. => Some(Fault::StuckHigh),
            _ => None,
        };
        // Counts ticks that speak against the present state.
        self.rail_ticks = if rail.is_some() == self.fault.is_some() { 0 } else { self.rail_ticks.saturating_add(1) };
        match (self.fault, rail) {
            (None, Some(_)) if self.rail_ticks >= STUCK_TICKS => {
                self.rail_ticks = 0;
                self.fault = rail;
                Some(rail)
            }
            (Some(_), None) if self.rail_ticks >= WELL_TICKS => {
                *self = Self::UNSET;
                self.start(u16::try_from(sum >> 5).unwrap_or(0));
                Some(None)
            }
            _ => None,
        }
    }

    /// The peak of the strike that is being scanned less what noise adds to a maximum, in signal units.
    pub(super) fn scanned_peak(&self) -> i32 {
        let noise = self.noise.mean();
        self.scan.peak.wrapping_sub(noise + (noise >> 1)).max(0)
    }

    /// The largest magnitude of late, for the judgement of crosstalk.
    pub(super) fn recent_peak(&self) -> i32 {
        if self.fault.is_some() {
            return 0;
        }
        let scanned = match (self.is_scanning, self.scan.saturated) {
            (false, _) => 0,
            (true, false) => self.scan.peak,
            // How far above the rail it was, nobody knows.
            (true, true) => self.scan.peak.saturating_mul(2),
        };
        // A strike that hid in its own pad's ringing shakes the others all the same.
        self.hold.max(scanned).max(self.envelope.saturating_add(self.envelope >> 1))
    }

    /// Remembers a direct pad's loudness for the judgement of crosstalk.
    pub(super) fn hold_envelope(&mut self) {
        self.hold = self.hold.max(self.envelope);
    }

    /// Ends the scan and masks the channel: after a strike for the mask time, after anything else (crosstalk above all) only as far as its
    /// level goes, since the pad's own strike may be close behind.
    pub(super) fn end_scan(&mut self, was_strike: bool, config: &ChannelConfig) {
        self.hold = self.recent_peak();
        let envelope = if self.is_scanning { self.scan.envelope } else { self.envelope };
        self.mask.struck(envelope);
        (self.is_scanning, self.is_resting) = (false, false);
        self.masked_ticks = if was_strike { config.masked_ticks } else { 0 };
        self.rise_peak = 0;
        self.onset_level = DEAF;
    }

    /// The envelope above which a direct pad's gate opens: threshold or noise.
    pub(super) fn gate_level(&self, config: &ChannelConfig) -> i32 {
        if self.warm_up_ticks > 0 || self.fault.is_some() {
            DEAF
        } else {
            config.threshold_envelope.max(scale_q8(self.noise.mean(), NOISE_LEVEL_Q8))
        }
    }

    /// A direct pad's gate is open: what it lets through is no noise.
    pub(super) fn ring(&mut self) {
        self.noise.struck();
    }
}

/// One channel of frames.
#[inline(always)]
pub(super) fn samples<const CHANNELS: usize>(frames: &[[u16; CHANNELS]], index: usize) -> impl Iterator<Item = u16> {
    frames.iter().map(move |frame| frame.get(index).copied().unwrap_or(0))
}

/// The next sample without its baseline.
#[inline(always)]
fn condition(raw: u16, level: i32) -> i32 {
    (i32::from(raw) << 8).wrapping_sub(level)
}

#[inline(always)]
fn follow(envelope: i32, x: i32) -> i32 {
    envelope.wrapping_add(x.wrapping_abs().wrapping_sub(envelope) >> ENVELOPE_SHIFT)
}

/// `value · factor / 256`: levels have 24 bits at most, so the product is taken in 64.
fn scale_q8(value: i32, factor_q8: i32) -> i32 {
    ((i64::from(value) * i64::from(factor_q8)) >> 8) as i32
}
