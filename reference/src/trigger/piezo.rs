//! One piezo channel: conditioning, envelope, onset and scan.

use super::adc::{HALF_RANGE_COUNTS, LAST_COUNT, TICK_FRAMES};
use super::baseline::Baseline;
use super::mask::Mask;
use super::settings::PiezoSettings;

/// Factor by which the envelope must exceed the mask's level to be an onset.
const OVER_MASK: f64 = 1.4;
/// Factor by which the envelope must exceed the mask's crest to leave the foot of a rise.
const OVER_MASK_FOOT: f64 = 1.0625;
/// Factor by which the envelope must exceed the noise to be an onset.
const OVER_NOISE: f64 = 2.4;
/// Factor by which the envelope must exceed the noise to leave the foot of a rise.
const OVER_NOISE_FOOT: f64 = 1.5;
/// Counts added to the foot level, half of the ADC's step.
const FOOT_COUNTS: f64 = 0.5;
/// Half width of the band in which a channel rests, in mean magnitudes of its noise.
///
/// Half a count and the baseline's change in half a tick are added to it. The sum is rounded up to
/// whole counts and limited to half the softest peak. While a channel rests, only every 16th of its
/// samples is used, to measure the noise.
const REST_NOISE: f64 = 4.5;
/// Frames between two samples of a resting channel from which its noise is measured.
const REST_TAP_FRAMES: usize = 16;
/// Longest time from an onset to the frame that notices it, in frames.
const LONGEST_LAG: usize = 24;
const WARM_UP_TICKS: usize = 47;
/// Ticks after an onset before the noise estimate may rise.
const QUIET_TICKS: usize = 225;
/// Amount that noise adds to a maximum, in mean envelopes.
const NOISE_IN_PEAK: f64 = 1.5;

/// Strike whose peak is being measured.
pub(super) struct Scan {
    pub(super) decide_at: usize,
    pub(super) peak: f64,
    pub(super) envelope: f64,
    pub(super) saturated: bool,
    before: Option<f64>,
    previous: Option<f64>,
}

pub(super) struct Piezo {
    settings: PiezoSettings,
    rate_hz: f64,
    baseline: Baseline,
    mask: Mask,
    pub(super) scan: Option<Scan>,
    envelope: f64,
    tick_envelope: f64,
    /// Middle and half width in counts of the band in which the channel rests; `None` while it does
    /// not.
    rest: Option<(f64, f64)>,
    /// Magnitudes of this tick's samples from which the resting channel's noise is measured.
    rest_magnitudes: Vec<f64>,
    noise: f64,
    quiet_ticks: usize,
    onset_level: f64,
    foot_level: f64,
    foot_frame: usize,
    /// Largest magnitude since the foot.
    rise_peak: f64,
    masked_ticks: usize,
    warm_up_ticks: usize,
    sum: f64,
    hold: f64,
}

impl Piezo {
    pub(super) fn new(settings: PiezoSettings, first_count: u16, rate_hz: f64) -> Self {
        Self {
            settings,
            rate_hz,
            baseline: Baseline::new(first_count.into(), rate_hz),
            mask: Mask::new(),
            scan: None,
            envelope: 0.0,
            tick_envelope: 0.0,
            rest: None,
            rest_magnitudes: Vec::new(),
            noise: 0.0,
            quiet_ticks: QUIET_TICKS,
            onset_level: f64::INFINITY,
            foot_level: 0.0,
            foot_frame: 0,
            rise_peak: 0.0,
            masked_ticks: 0,
            warm_up_ticks: WARM_UP_TICKS,
            sum: 0.0,
            hold: 0.0,
        }
    }

    fn scan_frames(&self) -> usize {
        (self.settings.scan_time_s * self.rate_hz + 0.5) as usize
    }

    /// Takes one frame's ADC count.
    pub(super) fn push(&mut self, count: u16, frame: usize) {
        let x = f64::from(count) - self.baseline.level;
        self.baseline.step();
        self.sum += f64::from(count);
        if let Some((middle, half)) = self.rest {
            if (f64::from(count) - middle).abs() <= half {
                if (frame + 1).is_multiple_of(REST_TAP_FRAMES) {
                    self.rest_magnitudes.push(x.abs());
                }
                return;
            }
            self.rest = None;
            self.foot_frame = frame.saturating_sub(1);
            self.rise_peak = 0.0;
        }
        self.envelope += (x.abs() - self.envelope) / 8.0;
        self.tick_envelope = self.tick_envelope.max(self.envelope);
        if self.scan.is_none() {
            if self.envelope <= self.foot_level {
                self.foot_frame = frame;
                self.rise_peak = 0.0;
            } else if self.envelope > self.onset_level {
                let noticed = frame + 1;
                let onset = self.foot_frame.max(noticed.saturating_sub(LONGEST_LAG));
                self.scan = Some(Scan {
                    decide_at: (onset + self.scan_frames()).max(noticed + TICK_FRAMES),
                    peak: self.rise_peak,
                    envelope: 0.0,
                    saturated: false,
                    before: None,
                    previous: None,
                });
                self.quiet_ticks = 0;
            }
        }
        if self.envelope > self.foot_level {
            self.rise_peak = self.rise_peak.max(x.abs());
        }
        if let Some(scan) = &mut self.scan {
            scan.saturated |= count == 0 || count >= LAST_COUNT;
            scan.envelope = scan.envelope.max(self.envelope);
            scan.peak = scan.peak.max(x.abs());
            if let (Some(before), Some(middle)) = (scan.before, scan.previous) {
                scan.peak = scan.peak.max(vertex(before, middle, x));
            }
            (scan.before, scan.previous) = (scan.previous, Some(x));
        }
    }

    /// Updates baseline, noise, mask and levels at the end of a tick.
    pub(super) fn tick(&mut self) {
        let mean = std::mem::take(&mut self.sum) / TICK_FRAMES as f64;
        self.baseline.tick(mean, self.scan.is_none());
        self.warm_up_ticks = self.warm_up_ticks.saturating_sub(1);
        self.masked_ticks = self.masked_ticks.saturating_sub(1);
        self.hold -= self.hold / 32.0;
        let magnitudes = std::mem::take(&mut self.rest_magnitudes);
        if self.rest.is_some() {
            self.quiet_ticks += 1;
            let mean = magnitudes.iter().sum::<f64>() / magnitudes.len() as f64;
            self.noise += (mean - self.noise) / 64.0;
        } else if self.scan.is_none() {
            self.quiet_ticks += 1;
            let error = self.envelope - self.noise;
            if error < 0.0 || self.quiet_ticks > QUIET_TICKS {
                self.noise += error / if self.warm_up_ticks > 0 { 8.0 } else { 64.0 };
            }
        }
        let quiet = (self.settings.threshold * HALF_RANGE_COUNTS / 2.0).max(OVER_NOISE * self.noise);
        let envelope = std::mem::replace(&mut self.tick_envelope, self.envelope).max(self.envelope);
        let noise_foot = OVER_NOISE_FOOT * self.noise + FOOT_COUNTS;
        self.mask.tick(envelope, noise_foot, self.settings.mask_decay_per_s, self.rate_hz);
        let is_deaf = self.masked_ticks > 0 || self.warm_up_ticks > 0;
        if is_deaf {
            self.rise_peak = 0.0;
        }
        self.onset_level = if is_deaf { f64::INFINITY } else { quiet.max(OVER_MASK * self.mask.level) };
        self.foot_level = noise_foot.max(OVER_MASK_FOOT * self.mask.crest);
        let is_calm = self.scan.is_none() && !self.mask.is_loud() && self.envelope <= self.foot_level;
        self.rest = (is_calm && self.warm_up_ticks == 0).then(|| {
            let softest = self.settings.threshold * HALF_RANGE_COUNTS;
            let ramp = self.baseline.half_tick_ramp();
            let half = (REST_NOISE * self.noise + FOOT_COUNTS + ramp.abs()).ceil();
            ((self.baseline.level + ramp).round(), half.min((softest / 2.0).floor()).max(1.0))
        });
        if self.rest.is_some() {
            (self.envelope, self.tick_envelope) = (self.noise, self.noise);
        }
    }

    /// Peak of the scan in counts, less the contribution of noise.
    pub(super) fn scanned_peak(&self) -> f64 {
        self.scan.as_ref().map_or(0.0, |scan| (scan.peak - NOISE_IN_PEAK * self.noise).max(0.0))
    }

    /// Loudness in counts from which other pads estimate their crosstalk.
    pub(super) fn recent_peak(&self) -> f64 {
        let scanned = self.scan.as_ref().map_or(0.0, |scan| scan.peak * if scan.saturated { 2.0 } else { 1.0 });
        self.hold.max(scanned).max(1.5 * self.envelope)
    }

    /// Ends the scan and masks the channel.
    ///
    /// After a strike the mask time applies. After anything else only the mask's level applies.
    pub(super) fn end_scan(&mut self, was_strike: bool) {
        self.hold = self.recent_peak();
        let envelope = self.scan.take().map_or(self.envelope, |scan| scan.envelope);
        self.mask.struck(envelope);
        let mask_frames = (self.settings.mask_time_s * self.rate_hz + 0.5) as usize;
        let masked_ticks = mask_frames.saturating_sub(self.scan_frames()) / TICK_FRAMES + 1;
        self.masked_ticks = if was_strike { masked_ticks } else { 0 };
        self.rise_peak = 0.0;
        self.rest = None;
        self.onset_level = f64::INFINITY;
    }
}

/// Magnitude of the extremum of the parabola through three samples; 0 unless the middle sample is
/// largest.
fn vertex(before: f64, middle: f64, after: f64) -> f64 {
    let sign = middle.signum();
    let (before, middle, after) = (before * sign, middle * sign, after * sign);
    let curvature = 2.0 * middle - before - after;
    if middle < before || middle < after || curvature <= 0.0 {
        return 0.0;
    }
    middle + (after - before).powi(2) / (8.0 * curvature)
}
