//! From a piezo's voltage, or a button, to a strike.
//!
//! ```text
//!  ADC channels                       strikes at ADC frames        output frames
//!  [[u16; CHANNELS]] ──► Trigger ──┬─► Report::Strike ──► FrameMap ──► Event ──► engine
//!                                  └─► Report::Force ──► Resampler ──► Direct ─► engine
//!  button levels ──► Buttons ────────► Detection ───────► FrameMap ──► Event ──► engine
//! ```
//!
//! Samples are 12-bit counts at the ADC's rate, in blocks of any length; the length changes no bit of what is found, only when it is
//! reported. A strike is decided a fixed time after its onset (the pad's scan time), so that latency does not depend on how hard it
//! was or how blocks fall.
//!
//! | step | what it does | file |
//! | --- | --- | --- |
//! | conditioning | takes away offset, drift and mains hum | `baseline` |
//! | onset | full-wave envelope above threshold, noise floor and mask; dated back to where it left the floor | `channel`, `noise` |
//! | rest | what stays in the noise's band moves nothing, and costs next to nothing | `rest` |
//! | retrigger cancellation | a mask that decays from the strike's peak and follows a long ring | `mask` |
//! | scan | interpolated peak over the scan time | `scan` |
//! | decision | second sensor, crosstalk, velocity curve | `decide`, `crosstalk`, `curve` |
//! | direct drive | noise gate, then from the ADC's clock to the output's | `direct`, `resampler` |
//!
//! All arithmetic by sample is in integers; only a decision (once a strike) uses floats. Nothing allocates or panics.
//!
//! # Measured
//!
//! On the generated set of `host-tests` (`cargo test -p host-tests --test trigger quality -- --nocapture`; noise to 3 counts rms, hum to 10
//! counts, rings of 200 Hz to 8 kHz that fall to 1/e in 5 to 60 ms): of 1200 strikes 99.7 % found, none false or double, velocity within
//! 1 dB for 97.4 %. What is lost are second strokes of flams into a long ring of the same pad, whose phases may cancel: there 1 in 100 is missed
//! and 1 in 16 is over 1 dB off. The twin in `reference` finds the same strikes, velocities within 0.10 dB.
//!
//! Decided 1.48 to 1.52 ms after the onset over 40 dB of one wave, jitter 0.02 to 0.03 ms over 1000 offsets; a tenth of a direct force's peak is
//! there after 0.10 ms (`--test trigger timing`).
//!
//! Cycles of a Cortex-M4 (nominal) a channel and sample, blocks of 32 frames, four channels: silent 17, in a scene of strikes on all pads 41 on
//! average and 163 in the worst block; the resampler 86 a sample; 920 bytes of state (`--test on_chip trigger`). Blocks that are
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
//! let mut trigger = Trigger::<CHANNELS>::new([Settings::of_unset_pad(0), Settings::of_unset_pad(1)], adc_rate)?;
//! let map = FrameMap::new(adc_rate, output_rate)?;
//!
//! // Half a second of silence with a strike on channel 1 after 0.25 s: a ring of 1 kHz, a quarter of full scale.
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
//!         // A constant makes up for the blocks' latency: the strike must not lie in the past of the engine.
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
mod mask;
mod noise;
mod report;
mod resampler;
mod rest;
mod scan;
mod settings;

pub use button::{Button, Buttons, Edge};
pub use clock::FrameMap;
pub use curve::Curve;
pub use error::TriggerError;
pub use report::{Detection, Fault, Report};
pub use resampler::Resampler;
pub use settings::{Mode, Settings};

use crate::SampleRate;
use crate::event::Action;
use crate::table::Kit;
use baseline::MainsTurn;
use channel::Channel;
use config::ChannelConfig;
use direct::Gate;

/// The slowest ADC rate that the trigger is made for, in Hz.
pub const MIN_RATE_HZ: f64 = 32_000.0;
/// The fastest ADC rate that the trigger is made for, in Hz.
pub const MAX_RATE_HZ: f64 = 64_000.0;
/// How long a channel is at a rail until it counts as stuck, in seconds at 48 kHz.
pub const STUCK_S: f64 = 0.02;

/// Slow bookkeeping falls on absolute ticks of so many ADC frames.
const TICK_FRAMES: usize = 32;
/// One ADC count in signal units.
const COUNT: i32 = 256;
/// Half the ADC's range, in counts and in signal units.
const FULL_COUNTS: f32 = 2048.0;
const FULL_UNITS: i32 = 2048 * COUNT;
/// The largest 12-bit count.
const LAST_COUNT: u16 = 4095;

/// A channel that a pad listens to: its configuration and its state.
#[derive(Clone, Copy, Debug)]
struct Lane {
    channel: Channel,
    config: ChannelConfig,
    gate: Gate,
}

/// Finds strikes in `CHANNELS` ADC channels.
#[derive(Clone, Debug)]
pub struct Trigger<const CHANNELS: usize> {
    lanes: [Option<Lane>; CHANNELS],
    turn: MainsTurn,
    now: u64,
    /// A bit for each lane that is there.
    heard: u32,
    /// Whether all of those rested at the last tick or decision, and have since.
    all_rest: bool,
}

impl<const CHANNELS: usize> Trigger<CHANNELS> {
    /// A trigger for pads of the given settings (the first is pad 0's), at the ADC's rate. Pads whose channel is not among the
    /// `CHANNELS` are not heard; see [`hears`](Self::hears).
    ///
    /// # Errors
    /// [`TriggerError`] for a rate or a number outside its range, and for two sensors on one channel.
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

    /// A trigger for the pads of a kit.
    ///
    /// # Errors
    /// As [`new`](Self::new).
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

    /// Frames taken so far.
    pub fn now(&self) -> u64 {
        self.now
    }

    /// Whether any channel plays the pad.
    pub fn hears(&self, pad: u8) -> bool {
        self.lanes.iter().flatten().any(|lane| lane.config.pad == pad)
    }

    /// What is wrong with a channel at present.
    pub fn fault(&self, channel: usize) -> Option<Fault> {
        self.lanes.get(channel)?.as_ref()?.channel.fault
    }

    /// Takes the next frames, one 12-bit count a channel, and reports what it finds. The reports do not depend on how frames fall into
    /// blocks, but for the lengths of [`Report::Force`].
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
            // Up to the next tick or decision: between them channels know nothing of each other.
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

    /// The soonest decision of a scan that is on.
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
                Some(Some(fault)) => report(Report::Fault { frame, channel, fault }),
                Some(None) => report(Report::Recovered { frame, channel }),
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

impl Lane {
    /// One segment, within a tick.
    fn run<const CHANNELS: usize>(
        &mut self,
        segment: &[[u16; CHANNELS]],
        index: usize,
        now: u32,
        report: &mut impl FnMut(Report<'_>),
    ) {
        match self.config.direct_gain_q16 {
            None => self.channel.run(segment, index, now, &self.config),
            Some(gain_q16) => {
                let mut force = [0; TICK_FRAMES];
                let samples = channel::samples(segment, index);
                let written = self.gate.run(&mut self.channel, samples, &self.config, gain_q16, &mut force);
                if let Some(samples) = force.get(..written) {
                    report(Report::Force { pad: self.config.pad, samples });
                }
            }
        }
    }
}
