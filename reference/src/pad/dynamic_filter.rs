//! The object's dynamic filter sounding, with its noise and its loops, sample by sample.

use crate::dynamic_filter::{BandPass, Breakpoint, Exciter, Filter, White};
use crate::rate::SampleRate;
use crate::waveguide::{Loop, Loops};

/// A dynamic filter of an object, at the sample rate at which it is rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicFilter {
    /// 1 or 2.
    pub order: u8,
    /// Coefficients and level of the noise over time.
    pub path: Vec<Breakpoint>,
    /// Band of the noise, if it has one.
    pub exciter: Option<Exciter>,
    /// Banded waveguides round it.
    pub loops: Vec<Loop>,
    /// Whether the object's modes go into it, rather than to the output.
    pub takes_modes: bool,
    /// Its noise: seed and stream, and the largest value after a strike at the reference force.
    pub noise: (White, f64),
    /// Peak force of a strike of level 1, in newtons.
    pub reference_force: f64,
}

/// A dynamic filter and all that moves in it.
pub(crate) struct Sounding<'a> {
    table: &'a DynamicFilter,
    noise: White,
    /// What the noise is multiplied by.
    amplitude: f64,
    /// Samples since the last strike; before the first, and after the end, past the path.
    since: usize,
    band: Option<BandPass>,
    filter: Filter<'a>,
    loops: Loops,
}

/// Long after any path.
const PAST: usize = usize::MAX / 2;

impl<'a> Sounding<'a> {
    pub(crate) fn new(table: &'a DynamicFilter, rate: SampleRate) -> Self {
        Self {
            table,
            noise: table.noise.0,
            amplitude: 0.0,
            since: PAST,
            band: table.exciter.map(|exciter| BandPass::new(exciter, rate)),
            filter: Filter::new(table.order, &table.path, rate),
            loops: Loops::new(&table.loops, rate),
        }
    }

    pub(crate) fn takes_modes(&self) -> bool {
        self.table.takes_modes
    }

    /// The path begins anew, with noise as loud as the force.
    pub(crate) fn strike(&mut self, peak_force: f64) {
        let level = peak_force / self.table.reference_force;
        (self.amplitude, self.since) = (level * self.table.noise.1, 0);
        if let Some(band) = &mut self.band {
            band.strike(level);
        }
    }

    /// Leaves so much of what rings, and of the noise to come until the next strike.
    pub(crate) fn attenuate(&mut self, left: f64) {
        self.amplitude *= left;
        if let Some(band) = &mut self.band {
            band.attenuate(left);
        }
        self.filter.attenuate(left);
        self.loops.attenuate(left);
    }

    /// Falls silent, for good but for a strike.
    pub(crate) fn rest(&mut self) {
        self.attenuate(0.0);
        self.since = PAST;
    }

    /// What of its sound is left by itself after the sample that was last rendered: no less than its slowest pole leaves, all of it where there are loops.
    pub(crate) fn own_decay(&self) -> f64 {
        if self.table.loops.is_empty() { self.filter.own_decay(self.since.saturating_sub(1)) } else { 1.0 }
    }

    /// One sample; `modes` is what goes in beside its noise.
    pub(crate) fn step(&mut self, modes: f64) -> f64 {
        let noise = if self.filter.is_noisy(self.since) {
            self.amplitude * self.filter.noise(self.since) * self.noise.draw()
        } else {
            0.0
        };
        let excited = self.band.as_mut().map_or(noise, |band| band.step(noise));
        let s = self.filter.step(self.since, excited + modes + self.loops.sum());
        self.loops.hear(s);
        self.since = (self.since + 1).min(PAST);
        s
    }
}
