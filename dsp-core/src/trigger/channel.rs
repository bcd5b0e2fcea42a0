//! One piezo: conditioning, envelope, onset, and the scan of a strike. All of a channel's state.
//!
//! ```text
//!  ADC ──(-)──► |x| ──► envelope ──► > level? ──► scan: peak of |x| ──► decision
//!         ▲              1/8 a frame    ▲
//!      baseline                         └── threshold, noise floor, mask
//! ```

use super::band::{Band, TAP_FRAMES};
use super::baseline::{Baseline, MainsTurn};
use super::config::ChannelConfig;
use super::mask::Mask;
use super::noise::NoiseFloor;
use super::rails::{self, Change, Rails};
use super::scan::Scan;
use crate::time::TICK_FRAMES;

/// Shift by which the envelope follows: 1/8 of its error a frame, 0.17 ms at 48 kHz, which is half
/// a period of 3 kHz.
const ENVELOPE_SHIFT: u32 = 3;
/// Level that no envelope reaches.
const DEAF: i32 = i32::MAX;
/// Maximum number of frames by which an onset is dated back from the frame in which the envelope
/// crosses its level.
const LONGEST_LAG: u32 = 24;
/// Ticks after a start in which offset, hum and noise are learnt: 31 ms at 48 kHz.
const WARM_UP_TICKS: u16 = 47;
/// Number of samples of a resting tick that are measured.
const TAPS: i32 = TICK_FRAMES as i32 / TAP_FRAMES as i32;
/// Shift by which the memory of peaks for crosstalk decays: 1/32 a tick, 21 ms.
const HOLD_SHIFT: u32 = 5;

/// State of one channel. Signals are in 1/256 of an ADC count.
#[derive(Clone, Copy, Debug)]
pub(super) struct Channel {
    baseline: Baseline,
    noise: NoiseFloor,
    mask: Mask,
    /// Smoothed magnitude of the conditioned signal.
    pub(super) envelope: i32,
    /// Envelope above which a strike is noticed.
    onset_level: i32,
    /// Envelope to which the onset of a noticed strike is dated back.
    foot_level: i32,
    /// Last frame whose envelope was not above the foot (low 32 bits).
    foot_frame: u32,
    /// Largest magnitude since `foot_frame`: some strikes are loudest in their first sample, before
    /// they are noticed.
    rise_peak: i32,
    /// Largest envelope of the tick so far.
    tick_envelope: i32,
    /// True if samples within the band change no state but sums.
    pub(super) is_resting: bool,
    /// Counts between which the channel rests.
    pub(super) band: Band,
    /// Sum of the magnitudes of the measured samples of a resting tick.
    rest_magnitude: i32,
    /// Sum of the tick's samples so far, in counts.
    sum: i32,
    /// Scan of the present strike.
    pub(super) scan: Scan,
    /// True if a strike is being scanned.
    pub(super) is_scanning: bool,
    /// Ticks until the mask time of the last strike ends.
    masked_ticks: u16,
    /// Ticks until offset, hum and noise are learnt.
    warm_up_ticks: u16,
    pub(super) rails: Rails,
    /// Decaying memory of the last peak, for the judgement of crosstalk.
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
        rails: Rails::UNSET,
        hold: 0,
    };

    /// Takes the samples of channel `index` from up to one tick of frames; the first frame is
    /// number `now`.
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

    /// Takes frames up to the first that leaves the band, without it, and gives their number.
    ///
    /// It takes one sample after the other, [`rest::pass`](super::rest::pass) all at once.
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

    /// Takes frames whose samples are all in the band and add up to `sum`; the first frame is
    /// number `now`.
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

    /// Takes frames of a tick in which the channel does not rest.
    #[inline(never)]
    fn follow<const CHANNELS: usize>(
        &mut self,
        frames: &[[u16; CHANNELS]],
        index: usize,
        now: u32,
        config: &ChannelConfig,
    ) {
        let heard = if self.is_scanning { 0 } else { self.listen(frames, index, now, config) };
        for raw in samples(frames.get(heard..).unwrap_or(&[]), index) {
            let (x, envelope) = self.take(raw);
            self.scan.push(raw, x, envelope);
        }
    }

    /// Takes frames up to the one in which a strike is noticed, begins its scan, and gives the
    /// number of frames taken.
    ///
    /// This is the hot loop of a channel that rings: its state is held in registers.
    #[inline(never)]
    fn listen<const CHANNELS: usize>(
        &mut self,
        frames: &[[u16; CHANNELS]],
        index: usize,
        now: u32,
        config: &ChannelConfig,
    ) -> usize {
        let Self { mut envelope, mut tick_envelope, mut sum, mut rise_peak, foot_level, onset_level, .. } = *self;
        let Baseline { mut level, slope, .. } = self.baseline;
        // Number of frames up to the last whose envelope was not above the foot.
        let mut to_foot = 0;
        let mut onset = None;
        let mut taken = frames.len();
        // Asked here, so that the compiler need not ask at every sample.
        if index < CHANNELS {
            for (at, frame) in (1..).zip(frames) {
                let raw = frame.get(index).copied().unwrap_or(0);
                let x = condition(raw, level);
                level = level.wrapping_add(slope);
                sum = sum.wrapping_add(i32::from(raw));
                envelope = follow(envelope, x);
                tick_envelope = tick_envelope.max(envelope);
                if envelope <= foot_level {
                    (to_foot, rise_peak) = (at, 0);
                } else if envelope > onset_level {
                    (onset, taken) = (Some((raw, x)), at);
                    break;
                } else {
                    rise_peak = rise_peak.max(x.wrapping_abs());
                }
            }
        }
        self.baseline.level = level;
        (self.envelope, self.tick_envelope, self.sum, self.rise_peak) = (envelope, tick_envelope, sum, rise_peak);
        if to_foot > 0 {
            self.foot_frame = now.wrapping_add(to_foot as u32).wrapping_sub(1);
        }
        if let Some((raw, x)) = onset {
            self.begin_scan(now.wrapping_add(taken as u32), config);
            self.scan.push(raw, x, envelope);
            self.rise_peak = self.rise_peak.max(x.wrapping_abs());
        }
        taken
    }

    /// Begins the scan of a strike that was noticed in the frame before `now`.
    fn begin_scan(&mut self, now: u32, config: &ChannelConfig) {
        let onset = now.wrapping_sub(now.wrapping_sub(self.foot_frame).min(LONGEST_LAG));
        let decide_at = onset.wrapping_add(config.scan_frames);
        // A decision falls behind the tick in which the strike was noticed.
        let nearest = now.wrapping_add(TICK_FRAMES as u32);
        let decide_at = if decide_at.wrapping_sub(nearest) < config.scan_frames { decide_at } else { nearest };
        self.scan = Scan::begin(decide_at, self.rise_peak);
        self.is_scanning = true;
        self.noise.struck();
    }

    /// Takes a sample; gives it without its baseline, and the envelope after it.
    #[inline(always)]
    pub(super) fn take(&mut self, raw: u16) -> (i32, i32) {
        let x = condition(raw, self.baseline.level);
        self.baseline.level = self.baseline.level.wrapping_add(self.baseline.slope);
        self.sum = self.sum.wrapping_add(i32::from(raw));
        self.envelope = follow(self.envelope, x);
        self.tick_envelope = self.tick_envelope.max(self.envelope);
        (x, self.envelope)
    }

    /// Starts the baseline at the first frame's sample.
    pub(super) fn start(&mut self, raw: u16) {
        self.baseline.start(raw);
    }

    /// Does the bookkeeping at the end of an absolute tick.
    #[inline(never)]
    pub(super) fn tick(&mut self, config: &ChannelConfig, turn: &MainsTurn) -> Option<Change> {
        if self.is_resting && self.mask.is_gone() && self.masked_ticks == 0 && rails::are_far(self.sum) {
            self.rest_on(config, turn);
            None
        } else {
            self.tick_at_large(config, turn)
        }
    }

    /// Does the work of [`tick_at_large`](Self::tick_at_large) for a channel that has rested for
    /// the whole tick, is away from the rails, and has no mask left.
    #[inline(always)]
    fn rest_on(&mut self, config: &ChannelConfig, turn: &MainsTurn) {
        self.rails.clear();
        self.baseline.tick(core::mem::take(&mut self.sum), true, turn);
        self.hold = self.hold.wrapping_sub(self.hold >> HOLD_SHIFT);
        let noise = self.noise.mean();
        self.noise.rest(core::mem::take(&mut self.rest_magnitude) / TAPS);
        if self.noise.mean() != noise {
            let noise = self.noise.mean();
            self.onset_level = config.threshold_envelope.max(self.noise.onset_level());
            self.foot_level = self.noise.foot_level();
            (self.envelope, self.tick_envelope) = (noise, noise);
        }
        self.set_band(config);
    }

    /// Does the bookkeeping at the end of a tick for any channel.
    #[inline(never)]
    fn tick_at_large(&mut self, config: &ChannelConfig, turn: &MainsTurn) -> Option<Change> {
        let sum = core::mem::take(&mut self.sum);
        let changed = self.rails.watch(sum);
        if changed == Some(Change::Recovered) {
            *self = Self::UNSET;
            self.start(u16::try_from(sum >> 5).unwrap_or(0));
        }
        self.baseline.tick(sum, !self.is_scanning && self.rails.fault.is_none(), turn);
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
        let quiet = config.threshold_envelope.max(self.noise.onset_level());
        let noise_foot = self.noise.foot_level();
        let envelope = core::mem::replace(&mut self.tick_envelope, self.envelope).max(self.envelope);
        self.mask.tick(envelope, noise_foot, config.mask_decay);
        let deaf = self.masked_ticks > 0 || self.warm_up_ticks > 0 || self.rails.fault.is_some();
        if deaf {
            self.rise_peak = 0;
        }
        self.onset_level = if deaf { DEAF } else { quiet.max(self.mask.onset_level()) };
        self.foot_level = noise_foot.max(self.mask.foot_level());
        let is_calm = !self.is_scanning && !self.mask.is_loud() && self.envelope <= self.foot_level;
        let may_rest = self.warm_up_ticks == 0 && self.rails.fault.is_none() && config.direct_gain_q16.is_none();
        self.is_resting = is_calm && may_rest;
        if self.is_resting {
            (self.envelope, self.tick_envelope) = (noise, noise);
            self.set_band(config);
        }
        changed
    }

    /// Sets the band for the tick that begins.
    #[inline(always)]
    fn set_band(&mut self, config: &ChannelConfig) {
        let Baseline { level, slope, .. } = self.baseline;
        self.band = Band::of_tick(level, slope, self.noise.rest_level(), config.threshold_peak >> 9);
    }

    /// Peak of the strike that is being scanned, in signal units, less what noise adds to a
    /// maximum.
    pub(super) fn scanned_peak(&self) -> i32 {
        let noise = self.noise.mean();
        self.scan.peak.wrapping_sub(noise + (noise >> 1)).max(0)
    }

    /// Largest magnitude of the last 20 ms or so, for the judgement of crosstalk.
    pub(super) fn recent_peak(&self) -> i32 {
        if self.rails.fault.is_some() {
            return 0;
        }
        let scanned = match (self.is_scanning, self.scan.saturated) {
            (false, _) => 0,
            (true, false) => self.scan.peak,
            // Beyond the rail the peak is unknown: it is taken for 6 dB higher.
            (true, true) => self.scan.peak.saturating_mul(2),
        };
        // A strike that hides in its own pad's ring shakes the other pads all the same.
        self.hold.max(scanned).max(self.envelope.saturating_add(self.envelope >> 1))
    }

    /// Remembers a direct pad's envelope for the judgement of crosstalk.
    pub(super) fn hold_envelope(&mut self) {
        self.hold = self.hold.max(self.envelope);
    }

    /// Ends the scan and masks the channel.
    ///
    /// The mask time follows a strike only. After anything else, such as crosstalk, only the mask's
    /// level counts, since the pad's own strike may be close behind.
    pub(super) fn end_scan(&mut self, was_strike: bool, config: &ChannelConfig) {
        self.hold = self.recent_peak();
        let envelope = if self.is_scanning { self.scan.envelope } else { self.envelope };
        self.mask.struck(envelope);
        (self.is_scanning, self.is_resting) = (false, false);
        self.masked_ticks = if was_strike { config.masked_ticks } else { 0 };
        self.rise_peak = 0;
        self.onset_level = DEAF;
    }

    /// Envelope above which a direct pad's gate opens: threshold or noise.
    pub(super) fn gate_level(&self, config: &ChannelConfig) -> i32 {
        if self.warm_up_ticks > 0 || self.rails.fault.is_some() {
            DEAF
        } else {
            config.threshold_envelope.max(self.noise.onset_level())
        }
    }

    /// Keeps the noise floor from rising while a direct pad's gate is open.
    pub(super) fn ring(&mut self) {
        self.noise.struck();
    }
}

/// Samples of one channel of frames.
#[inline(always)]
pub(super) fn samples<const CHANNELS: usize>(frames: &[[u16; CHANNELS]], index: usize) -> impl Iterator<Item = u16> {
    frames.iter().map(move |frame| frame.get(index).copied().unwrap_or(0))
}

/// Sample in signal units without its baseline.
#[inline(always)]
fn condition(raw: u16, level: i32) -> i32 {
    (i32::from(raw) << 8).wrapping_sub(level)
}

/// Envelope after a sample.
#[inline(always)]
fn follow(envelope: i32, x: i32) -> i32 {
    envelope.wrapping_add(x.wrapping_abs().wrapping_sub(envelope) >> ENVELOPE_SHIFT)
}
