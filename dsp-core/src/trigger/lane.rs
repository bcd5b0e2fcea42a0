//! A lane: one ADC channel and the part that it plays in a pad.

use super::channel::{Channel, samples};
use super::config::ChannelConfig;
use super::direct::Gate;
use super::report::Report;
use crate::time::TICK_FRAMES;

/// Channel that a pad listens to: its configuration and its state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lane {
    pub(super) channel: Channel,
    pub(super) config: ChannelConfig,
    gate: Gate,
}

impl Lane {
    pub(super) const fn new(config: ChannelConfig) -> Self {
        Self { channel: Channel::UNSET, config, gate: Gate::SHUT }
    }

    /// Takes a segment of a tick in channel `index`; the first frame is number `now`.
    pub(super) fn run<const CHANNELS: usize>(
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
                let samples = samples(segment, index);
                let written = self.gate.run(&mut self.channel, samples, &self.config, gain_q16, &mut force);
                if let Some(samples) = force.get(..written) {
                    report(Report::Force { pad: self.config.pad, samples });
                }
            }
        }
    }
}
