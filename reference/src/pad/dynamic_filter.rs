//! Dynamic filter of a sounding object, with its noise and its loops, rendered sample by sample.

use crate::dynamic_filter::{BandPass, Breakpoint, Exciter, Filter, White};
use crate::rate::SampleRate;
use crate::waveguide::{Loop, Loops};

/// Dynamic filter of an object, at the sample rate at which it is rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicFilter {
    /// Order of the filter, 1 or 2.
    pub order: u8,
    /// Coefficients and level of the noise over time.
    pub path: Vec<Breakpoint>,
    /// Band-pass of the noise; `None` for white noise.
    pub exciter: Option<Exciter>,
    /// Banded waveguides round the filter.
    pub loops: Vec<Loop>,
    /// True if the object's modes feed the filter; if false they go to the output.
    pub takes_modes: bool,
    /// Generator of the noise, and its largest value after a strike at the reference force.
    pub noise: (White, f64),
    /// Peak force of a strike of level 1, in newtons.
    pub reference_force: f64,
}

/// Dynamic filter in motion: its noise, band-pass, filter and loops.
pub(crate) struct DynamicFilterVoice<'a> {
    table: &'a DynamicFilter,
    noise: White,
    /// Generator as it began, or as the last mute on the path set it.
    noise_start: White,
    /// Factor on the generator's values.
    amplitude: f64,
    /// Samples since the last strike; [`PAST`] before the first strike and after the end.
    since: usize,
    band: Option<BandPass>,
    filter: Filter<'a>,
    loops: Loops,
}

/// Number of samples that stands for a time after the end of any path.
const PAST: usize = usize::MAX / 2;

impl<'a> DynamicFilterVoice<'a> {
    pub(crate) fn new(table: &'a DynamicFilter, rate: SampleRate) -> Self {
        Self {
            table,
            noise: table.noise.0,
            noise_start: table.noise.0,
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

    /// Starts the path anew, with noise in proportion to the force in newtons.
    pub(crate) fn strike(&mut self, peak_force: f64) {
        let level = peak_force / self.table.reference_force;
        (self.amplitude, self.since) = (level * self.table.noise.1, 0);
        if let Some(band) = &mut self.band {
            band.strike(level);
        }
    }

    /// Multiplies the present sound, and the noise until the next strike, by `left`.
    pub(crate) fn attenuate(&mut self, left: f64) {
        self.amplitude *= left;
        if let Some(band) = &mut self.band {
            band.attenuate(left);
        }
        self.filter.attenuate(left);
        self.loops.attenuate(left);
    }

    /// Silences the filter until the next strike.
    ///
    /// If its path was not over, the generator goes on 1 000 003 draws behind its start, or behind
    /// the place to which the mute before this one put it.
    pub(crate) fn mute(&mut self) {
        if self.filter.is_under_way(self.since) {
            self.noise_start = self.noise_start.skipped();
            self.noise = self.noise_start;
        }
        self.attenuate(0.0);
        self.since = PAST;
    }

    /// Factor by which the filter's sound falls by itself in the sample rendered last.
    ///
    /// It is never below the radius of the slowest pole, and 1 if there are loops.
    pub(crate) fn own_decay(&self) -> f64 {
        if self.table.loops.is_empty() { self.filter.own_decay(self.since.saturating_sub(1)) } else { 1.0 }
    }

    /// Renders one sample; `modes` is added to the noise at the filter's input.
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
