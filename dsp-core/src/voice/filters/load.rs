//! Loading of a voice's filters: from a kit's tables to coefficients.

use super::super::choke::nepers_per_frame;
use super::state::Filters;
use crate::SampleRate;
use crate::biquad::{Biquad, BiquadError, Root};
use crate::dynamic_filter::{Breakpoint, DynamicFilter, DynamicFilterError, Exciter, FilterSize, Settings};
use crate::exponential;
use crate::table;
use crate::table::layout::{BiquadRecord, BreakpointRecord, LoopRecord};
use crate::waveguide::Loop;

impl Filters<'_> {
    /// Size of a dynamic filter at a rate.
    ///
    /// # Errors
    /// A [`DynamicFilterError`] if its loops are invalid.
    pub fn size_of_dynamic(
        filter: &table::DynamicFilter<'_>,
        rate: SampleRate,
    ) -> Result<FilterSize, DynamicFilterError> {
        DynamicFilter::size(&settings(filter, 0), rate)
    }

    /// Derives the dynamic filter for a rate.
    ///
    /// `stream` tells noises of one seed apart. `peak` is the peak force of the pad's hardest
    /// strike over the reference force. `is_known` is true if the filter has been loaded without
    /// memory before, so that its loops are known to be stable.
    ///
    /// # Errors
    /// A [`DynamicFilterError`] if the filter cannot be built at this rate.
    #[inline(never)] // runs on load only: keeps its stack apart from the caller's
    pub fn load_dynamic(
        &mut self,
        filter: &table::DynamicFilter<'_>,
        rate: SampleRate,
        stream: u32,
        peak: f32,
        is_known: bool,
    ) -> Result<(), DynamicFilterError> {
        self.louder = louder_bits(peak);
        let settings = settings(filter, self.louder);
        let path = settings.path.clone();
        self.dynamic.derive(settings, rate, stream, is_known)?;
        let at = (rate, rate.hz() / f64::from(filter.rate_hz()));
        self.levels.load(filter.order(), path, at, !filter.loops().is_empty());
        (self.has_dynamic, self.loop_count) = (true, filter.loops().len() as u32); // at most 16
        Ok(())
    }

    /// Checks a biquad bank for a rate, without memory for it.
    ///
    /// # Errors
    /// A [`BiquadError`] for the first biquad that cannot be built at this rate.
    pub fn check_biquads(bank: &table::Biquads<'_>, rate: SampleRate, reference_force: f32) -> Result<(), BiquadError> {
        carried(bank, rate, reference_force).enumerate().try_for_each(|(index, biquad)| biquad?.check(index))
    }

    /// Derives the biquads for a rate. `reference_force` is the force in newtons that 1.0 stands
    /// for, `choke_t60_s` the T60 of a choke, 0 if the pad cannot be choked.
    ///
    /// # Errors
    /// A [`BiquadError`] for the first biquad that cannot be built at this rate.
    #[inline(never)] // runs on load only: keeps its stack apart from the caller's
    pub fn load_biquads(
        &mut self,
        bank: &table::Biquads<'_>,
        rate: SampleRate,
        reference_force: f32,
        choke_t60_s: f32,
    ) -> Result<(), BiquadError> {
        let (depth, biquads) = (bank.depth().max(1), carried(bank, rate, reference_force));
        let choke = if choke_t60_s > 0.0 { exponential::exp(-nepers_per_frame(choke_t60_s, rate)) } else { 1.0 };
        self.biquads.load_each(biquads, depth, choke)
    }

    /// Unloads the biquad bank.
    pub(crate) fn unload_biquads(&mut self) {
        self.biquads.unload();
        (self.deaf, self.struck) = (false, false);
    }

    /// Nominal cycles of a tick in which the dynamic filter sounds.
    pub(crate) fn dynamic_cycles(&self) -> u32 {
        self.dynamic.cycles_a_tick()
    }

    /// Maximum nominal cycles of a tick in which biquads in chains of `depth` are struck; pairs of
    /// the same form are computed together.
    pub(crate) fn max_biquad_cycles(biquads: usize, depth: usize) -> u32 {
        let each = if depth > 1 { 3000 } else { 2400 };
        biquads.div_ceil(2) as u32 * each + 1500
    }
}

/// Settings of a dynamic filter, from its table, for a gain that is higher by a number of bits.
fn settings<'a>(
    filter: &table::DynamicFilter<'a>,
    louder_bits: u32,
) -> Settings<impl Iterator<Item = Breakpoint> + Clone + use<'a>, impl Iterator<Item = Loop> + Clone + use<'a>> {
    let louder = libm::scalbn(1.0, louder_bits as i32);
    let exciter = filter.exciter().map(|band| {
        // The filter hears of levels that are divided by `louder`.
        let exponent = f64::from(band.exponent);
        let factor = exponential::power(louder, exponent);
        Exciter { low_hz: f64::from(band.low_hz) * factor, high_hz: f64::from(band.high_hz) * factor, exponent }
    });
    Settings {
        seed: filter.seed(),
        rate_hz: f64::from(filter.rate_hz()),
        order: filter.order(),
        modes_through: filter.takes_modes(),
        exciter,
        path: filter.path().iter().zip(filter.levels()).map(move |(record, noise)| breakpoint(record, noise, louder)),
        loops: filter.loops().iter().map(move |record| band(record, louder)),
    }
}

/// Bits by which a filter's gain is raised and its input lowered, for a hardest strike of `peak`.
///
/// The filter's noise is at most 1.0, but a strike may be harder than the reference force.
fn louder_bits(peak: f32) -> u32 {
    (0..MAX_LOUDER_BITS).find(|&bits| peak <= (1u32 << bits) as f32).unwrap_or(MAX_LOUDER_BITS)
}

/// Maximum of [`louder_bits`]: forces are below 16 times the reference force.
const MAX_LOUDER_BITS: u32 = 4;

fn breakpoint(record: &BreakpointRecord, noise: f32, louder: f64) -> Breakpoint {
    Breakpoint {
        time_s: f64::from(record.time_s.get()),
        a1: f64::from(record.a1.get()),
        a2: f64::from(record.a2.get()),
        b0: f64::from(record.b0.get()) * louder,
        b1: f64::from(record.b1.get()) * louder,
        b2: f64::from(record.b2.get()) * louder,
        noise: f64::from(noise),
    }
}

fn band(record: &LoopRecord, louder: f64) -> Loop {
    Loop {
        frequency_hz: f64::from(record.frequency_hz.get()),
        bandwidth_hz: f64::from(record.bandwidth_hz.get()),
        gain: f64::from(record.gain.get()) / louder,
        delay_s: f64::from(record.delay_s.get()),
    }
}

/// Biquads of a table, carried to a rate.
fn carried<'a>(
    bank: &table::Biquads<'a>,
    rate: SampleRate,
    reference_force: f32,
) -> impl Iterator<Item = Result<Biquad, BiquadError>> + use<'a> {
    let (depth, rate_hz) = (bank.depth().max(1), f64::from(bank.rate_hz()));
    bank.records().iter().enumerate().map(move |(index, record)| {
        // The force enters the first of each chain, in newtons.
        let newtons = if index.is_multiple_of(depth) { f64::from(reference_force) } else { 1.0 };
        Biquad::from_roots_at(index, roots(record, newtons), rate_hz, rate)
    })
}

/// Pole, zero and gain of a record; the gain times another one.
fn roots(record: &BiquadRecord, gain: f64) -> (Root, Root, f64) {
    let root = |real: f32, imaginary: f32| Root { real: f64::from(real), imaginary: f64::from(imaginary) };
    let pole = root(record.pole_re.get(), record.pole_im.get());
    let zero = root(record.zero_re.get(), record.zero_im.get());
    (pole, zero, f64::from(record.gain.get()) * gain)
}
