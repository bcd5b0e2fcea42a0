//! Triggers: from a piezo's voltage, or a button, to a strike.
//!
//! ```text
//!  ADC channels                       strikes at ADC frames        output frames
//!  [[u16; CHANNELS]] ──► Trigger ──┬─► Report::Strike ──► FrameMap ──► Event ──► engine
//!                                  └─► Report::Force ──► Resampler ──► Direct ─► engine
//!  button levels ──► Buttons ────────► Detection ───────► FrameMap ──► Event ──► engine
//! ```
//!
//! Samples are 12-bit counts at the ADC's rate, in blocks of any length. The length changes no bit
//! of a detection, only the time of its report. A strike is decided a fixed time after its onset
//! (the pad's scan time), so that latency depends neither on velocity nor on blocks.
//!
//! | step | work | file |
//! | --- | --- | --- |
//! | conditioning | offset, drift and mains hum are subtracted | `baseline` |
//! | onset | envelope above threshold, noise floor and mask; dated back | `channel`, `noise` |
//! | rest | samples within the noise's band change nothing and cost little | `rest`, `band` |
//! | retrigger cancellation | mask that decays from the peak and follows a long ring | `mask` |
//! | scan | interpolated peak over the scan time | `scan` |
//! | decision | second sensor, crosstalk, velocity curve | `decide`, `crosstalk`, `curve` |
//! | direct drive | noise gate, then from the ADC's clock to the output's | `direct`, `resampler` |
//! | faults | channels that lie at a rail are not listened to | `rails` |
//!
//! Arithmetic on samples is in integers; only a decision (once a strike) uses floats. Nothing
//! allocates or panics.
//!
//! # Measured
//!
//! Quality, on the generated set of `host-tests` (`cargo test -p host-tests --test trigger quality
//! -- --nocapture`; noise to 3 counts rms, hum to 10 counts, rings of 200 Hz to 8 kHz that fall to
//! 1/e in 5 to 60 ms): of 1200 strikes 99.7 % are found, none is false or double, and velocity is
//! within 1 dB for 97.4 %. The trigger loses second strokes of flams into a long ring of the same
//! pad, whose phases may cancel: 1 in 100 of those is missed and 1 in 16 is over 1 dB off. The twin
//! in `reference` finds the same strikes, with velocities within 0.10 dB.
//!
//! Latency (`--test trigger timing`): a strike is decided 1.48 to 1.52 ms after the onset over 40
//! dB of one wave, with a jitter of 0.02 to 0.03 ms over 1000 offsets. A tenth of a direct force's
//! peak is there after 0.10 ms.
//!
//! Cycles of a Cortex-M4 (nominal) a channel and sample, for four channels and blocks of 32 frames
//! (`--test on_chip trigger`): 17 in silence; in a scene of strikes on all pads 41 on average and
//! 163 in the worst block; 86 a sample for the resampler. State: 920 bytes. Blocks that are
//! multiples of 32 frames cost least.
//!
//! # Use
//!
//! ```
//! use dsp_core::SampleRate;
//! use dsp_core::trigger::{FrameMap, Report, Settings, Trigger};
//!
//! const CHANNELS: usize = 2;
//! let adc_rate = SampleRate::HZ_48000;
//! let output_rate = SampleRate::new(86_000_000, 1792).unwrap();
//! // On a board: `Trigger::from_kit(&kit, adc_rate)`.
//! let pads = [0, 1].map(Settings::of_unset_pad);
//! let mut trigger = Trigger::<CHANNELS>::new(pads, adc_rate)?;
//! let map = FrameMap::new(adc_rate, output_rate)?;
//!
//! // Half a second with a strike on channel 1 after 0.25 s: 1 kHz, a quarter of full scale.
//! let adc: Vec<[u16; CHANNELS]> = (0..24_000)
//!     .map(|n| {
//!         let t = (f64::from(n) - 12_000.0) / 48_000.0;
//!         let ring = if t < 0.0 { 0.0 } else { 512.0 * (-t / 0.01).exp() * (6283.2 * t).sin() };
//!         [2048, (2048.0 + ring) as u16]
//!     })
//!     .collect();
//!
//! let mut strikes = Vec::new();
//! for half_buffer in adc.chunks(48) {
//!     trigger.process(half_buffer, |report| match report {
//!         // The constant covers the blocks' latency: no strike may lie in the engine's past.
//!         Report::Strike(found) => strikes.push(found.event(map.output_frame(found.frame) + 96)),
//!         Report::Force { .. } => {} // to the pad's resampler
//!         Report::Fault { .. } | Report::Recovered { .. } => {} // to the log
//!     });
//! }
//! assert_eq!(strikes.len(), 1);
//! assert_eq!(strikes[0].pad, 1);
//! assert!((strikes[0].velocity / 0.25 - 1.0).abs() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod band;
mod baseline;
mod button;
mod channel;
mod clock;
mod config;
mod crosstalk;
mod curve;
mod decide;
mod direct;
mod error;
mod lane;
mod limits;
mod mask;
mod noise;
mod rails;
mod report;
mod resampler;
mod rest;
mod scan;
mod settings;
mod units;

pub use button::{Button, Buttons, Edge};
pub use clock::FrameMap;
pub use curve::Curve;
pub use error::TriggerError;
pub use limits::{MAX_RATE_HZ, MIN_RATE_HZ, STUCK_S};
pub use report::{Detection, Fault, Report};
pub use resampler::Resampler;
pub use settings::{Mode, Settings};

use crate::SampleRate;
use crate::event::Action;
use crate::table::Kit;
use crate::time::TICK_FRAMES;
use baseline::MainsTurn;
use config::ChannelConfig;
use lane::Lane;
use rails::Change;

/// Trigger: finds strikes in `CHANNELS` ADC channels.
#[derive(Clone, Debug)]
pub struct Trigger<const CHANNELS: usize> {
    lanes: [Option<Lane>; CHANNELS],
    turn: MainsTurn,
    now: u64,
    /// Bit for each lane that a pad listens to.
    heard: u32,
    /// True if all lanes have rested since the last tick.
    all_rest: bool,
}

impl<const CHANNELS: usize> Trigger<CHANNELS> {
    /// Makes a trigger for pads of the given settings, pad 0 first, at the ADC's rate.
    ///
    /// Pads whose channel is not among the `CHANNELS` are not heard; [`hears`](Self::hears) tells
    /// them.
    ///
    /// # Errors
    /// [`TriggerError`] for a rate or a number outside its range, and for two sensors on one
    /// channel.
    pub fn new(pads: impl IntoIterator<Item = Settings>, rate: SampleRate) -> Result<Self, TriggerError> {
        if !(MIN_RATE_HZ..=MAX_RATE_HZ).contains(&rate.hz()) {
            return Err(TriggerError::Rate { rate });
        }
        let mut trigger =
            Self { lanes: [None; CHANNELS], turn: MainsTurn::new(rate), now: 0, heard: 0, all_rest: false };
        for (pad, settings) in (0..=u8::MAX).zip(pads) {
            let (head, rim) = config::derive(pad, &settings, rate)?;
            if settings.mode != Mode::Off {
                trigger.connect(settings.channel, head)?;
                if let (Some(channel), Some(rim)) = (settings.rim_channel, rim) {
                    trigger.connect(channel, rim)?;
                }
            }
        }
        Ok(trigger)
    }

    /// Makes a trigger for the pads of a kit.
    ///
    /// # Errors
    /// [`TriggerError`] for a rate outside its range.
    pub fn from_kit(kit: &Kit<'_>, rate: SampleRate) -> Result<Self, TriggerError> {
        Self::new(Settings::of_kit(kit), rate)
    }

    fn connect(&mut self, channel: u8, config: ChannelConfig) -> Result<(), TriggerError> {
        match self.lanes.get_mut(usize::from(channel)) {
            Some(Some(_)) => Err(TriggerError::SharedChannel { pad: config.pad, channel }),
            Some(lane) => {
                *lane = Some(Lane::new(config));
                self.heard |= 1 << channel;
                Ok(())
            }
            None => Ok(()),
        }
    }

    /// Disconnects a channel to which nothing is wired: its samples are not looked at any more.
    pub fn disconnect(&mut self, channel: usize) {
        if let Some(lane) = self.lanes.get_mut(channel) {
            *lane = None;
            self.heard &= !(1 << channel);
        }
    }

    /// Number of frames taken so far.
    pub fn now(&self) -> u64 {
        self.now
    }

    /// True if a channel plays the pad.
    pub fn hears(&self, pad: u8) -> bool {
        self.lanes.iter().flatten().any(|lane| lane.config.pad == pad)
    }

    /// Present fault of a channel; `None` if the channel is well or no pad listens to it.
    pub fn fault(&self, channel: usize) -> Option<Fault> {
        self.lanes.get(channel)?.as_ref()?.channel.rails.fault
    }

    /// Takes the next frames, one 12-bit count for each channel, and reports strikes, forces and
    /// faults.
    ///
    /// The split of the frames into blocks changes nothing but the lengths of [`Report::Force`].
    pub fn process(&mut self, frames: &[[u16; CHANNELS]], mut report: impl FnMut(Report<'_>)) {
        let mut rest = frames;
        if let (0, Some(first)) = (self.now, rest.first()) {
            for (lane, &raw) in self.lanes.iter_mut().zip(first) {
                if let Some(lane) = lane {
                    lane.channel.start(raw);
                }
            }
        }
        while !rest.is_empty() {
            // A segment reaches up to the next tick or decision. Within it channels do not depend
            // on each other.
            let now = self.now as u32;
            let tick_left = TICK_FRAMES - (self.now % TICK_FRAMES as u64) as usize;
            let soonest = if self.all_rest { None } else { self.frames_to_decision(now) };
            let length = soonest.map_or(tick_left, |frames| frames.clamp(1, tick_left));
            let (segment, behind) = rest.split_at_checked(length).unwrap_or((rest, &[]));
            let rested = rest::pass(&mut self.lanes, segment, now);
            if rested != self.heard {
                self.run(segment, now, rested, &mut report);
            }
            self.now = self.now.wrapping_add(segment.len() as u64);
            rest = behind;
            if self.now.is_multiple_of(TICK_FRAMES as u64) {
                self.tick(&mut report);
            }
            if soonest == Some(segment.len()) {
                self.decide(&mut report);
            }
        }
    }

    /// Number of frames to the soonest decision of a scan that is on.
    fn frames_to_decision(&self, now: u32) -> Option<usize> {
        let decisions = self.lanes.iter().flatten().filter_map(|lane| decide::frames_left(lane, now));
        decisions.min().map(|frames| frames as usize)
    }

    /// Takes a segment in all channels but those whose bit is set in `rested`.
    #[inline(never)] // its tables must not weigh on silence
    fn run(&mut self, segment: &[[u16; CHANNELS]], now: u32, rested: u32, report: &mut impl FnMut(Report<'_>)) {
        self.all_rest = false;
        for (index, lane) in self.lanes.iter_mut().enumerate() {
            if let (Some(lane), 0) = (lane, rested >> index & 1) {
                lane.run(segment, index, now, report);
            }
        }
    }

    fn tick(&mut self, report: &mut impl FnMut(Report<'_>)) {
        self.all_rest = true;
        let frame = self.now;
        for (channel, lane) in (0..=u8::MAX).zip(&mut self.lanes) {
            let Some(lane) = lane else { continue };
            match lane.channel.tick(&lane.config, &self.turn) {
                Some(Change::Failed(fault)) => report(Report::Fault { frame, channel, fault }),
                Some(Change::Recovered) => report(Report::Recovered { frame, channel }),
                None => {}
            }
            self.all_rest &= lane.channel.is_resting;
        }
    }

    #[inline(never)] // once a strike
    fn decide(&mut self, report: &mut impl FnMut(Report<'_>)) {
        let now = self.now as u32;
        for index in 0..CHANNELS {
            let due = matches!(self.lanes.get(index), Some(Some(lane)) if decide::is_due(lane, now));
            if let (true, Some(verdict)) = (due, if due { decide::decide(&mut self.lanes, index) } else { None }) {
                let decide::Verdict { pad, striker, velocity } = verdict;
                let action = Action::Strike;
                report(Report::Strike(Detection { frame: self.now, pad, striker, velocity, action }));
            }
        }
    }
}
