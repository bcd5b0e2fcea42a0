//! Conversion of dynamic filters and biquad banks to the sections `dynf` and `biqd`, and back.

use dsp_core::table::layout::{
    BiquadRecord, BiquadsHeader, BreakpointRecord, DynamicFilterHeader, HAS_EXCITER, HAS_LEVELS, LoopRecord,
    MODES_THROUGH,
};
use dsp_core::table::{
    Biquads as BiquadsView, DynamicFilter as FilterView, ExciterBand, Field, Kit as TableView, Place, TableError, range,
};
use zerocopy::IntoBytes;
use zerocopy::byteorder::little_endian::{F32, U16, U32};

use super::builder::{Build, append};
use crate::content::Object;
use crate::error::{Fault, KitError};
use crate::filters::{Biquad, Biquads, Breakpoint, DynamicFilter, Exciter, Loop, ModesGo, Order};

/// Reads the bytes of a kit in place and checks all sections, also those that few engines play.
pub(super) fn parse(bytes: &[u8]) -> Result<TableView<'_>, TableError> {
    let view = TableView::parse(bytes)?;
    view.dynamic_filters().try_for_each(|filter| filter.map(|_| ()))?;
    view.biquads().try_for_each(|bank| bank.map(|_| ()))?;
    view.check_surfaces()?;
    Ok(view)
}

/// Adds their filters to the objects of a kit, from a checked view of its bytes.
pub(super) fn read(view: &TableView<'_>, objects: &mut [Object]) {
    for filter in view.dynamic_filters().flatten() {
        if let Some(object) = objects.get_mut(filter.object_index()) {
            object.dynamic_filter = Some(read_filter(&filter));
        }
    }
    for bank in view.biquads().flatten() {
        if let Some(object) = objects.get_mut(bank.object_index()) {
            object.biquads = Some(read_biquads(&bank));
        }
    }
}

fn read_filter(view: &FilterView<'_>) -> DynamicFilter {
    DynamicFilter {
        seed: view.seed(),
        modes: if view.takes_modes() { ModesGo::Through } else { ModesGo::Beside },
        rate_hz: view.rate_hz(),
        exciter: view.exciter().map(|ExciterBand { low_hz, high_hz, exponent }| Exciter { low_hz, high_hz, exponent }),
        order: if view.order() == 1 { Order::First } else { Order::Second },
        path: view.path().iter().zip(view.levels()).map(read_breakpoint).collect(),
        loops: view.loops().iter().map(read_loop).collect(),
    }
}

fn read_breakpoint((record, noise): (&BreakpointRecord, f32)) -> Breakpoint {
    Breakpoint {
        time_s: record.time_s.get(),
        noise,
        a1: record.a1.get(),
        a2: record.a2.get(),
        b0: record.b0.get(),
        b1: record.b1.get(),
        b2: record.b2.get(),
    }
}

fn read_loop(record: &LoopRecord) -> Loop {
    Loop {
        frequency_hz: record.frequency_hz.get(),
        bandwidth_hz: record.bandwidth_hz.get(),
        gain: record.gain.get(),
        delay_s: record.delay_s.get(),
    }
}

fn read_biquads(view: &BiquadsView<'_>) -> Biquads {
    let biquad = |record: &BiquadRecord| Biquad {
        pole: [record.pole_re.get(), record.pole_im.get()],
        zero: [record.zero_re.get(), record.zero_im.get()],
        gain: record.gain.get(),
    };
    let chains = view.chains().map(|chain| chain.iter().map(biquad).collect());
    Biquads { rate_hz: view.rate_hz(), chains: chains.collect() }
}

impl Build<'_> {
    pub(super) fn dynamic_filter(&self, object: usize, filter: &DynamicFilter) -> Result<Vec<u8>, KitError> {
        let place = Place::ObjectFilter(object);
        let DynamicFilter { seed, modes, rate_hz, exciter, order, path, loops } = filter;
        let through = if *modes == ModesGo::Through { MODES_THROUGH } else { 0 };
        let has_levels = path.iter().any(|point| point.noise != 1.0);
        let Exciter { low_hz, high_hz, exponent } =
            exciter.unwrap_or(Exciter { low_hz: 0.0, high_hz: 0.0, exponent: 0.0 });
        let header = DynamicFilterHeader {
            object: self.count(place, Field::Object, object, 0, usize::from(u16::MAX))?,
            order: match order {
                Order::First => 1,
                Order::Second => 2,
            },
            flags: through | if exciter.is_some() { HAS_EXCITER } else { 0 } | if has_levels { HAS_LEVELS } else { 0 },
            seed: U32::new(*seed),
            rate_hz: F32::new(*rate_hz),
            breakpoint_count: self.count(place, Field::Path, path.len(), 1, range::BREAKPOINTS)?,
            loop_count: self.count(place, Field::Loops, loops.len(), 0, range::LOOPS)?,
            low_hz: F32::new(low_hz),
            high_hz: F32::new(high_hz),
            exponent: F32::new(exponent),
        };
        let mut section = header.as_bytes().to_vec();
        for &Breakpoint { time_s, noise: _, a1, a2, b0, b1, b2 } in path {
            let [time_s, a1, a2, b0, b1, b2] = [time_s, a1, a2, b0, b1, b2].map(F32::new);
            append(&mut section, &BreakpointRecord { time_s, a1, a2, b0, b1, b2 });
        }
        for &Loop { frequency_hz, bandwidth_hz, gain, delay_s } in loops {
            let [frequency_hz, bandwidth_hz, gain, delay_s] = [frequency_hz, bandwidth_hz, gain, delay_s].map(F32::new);
            append(&mut section, &LoopRecord { frequency_hz, bandwidth_hz, gain, delay_s });
        }
        if has_levels {
            path.iter().for_each(|point| append(&mut section, &F32::new(point.noise)));
        }
        Ok(section)
    }

    pub(super) fn biquads(&self, object: usize, biquads: &Biquads) -> Result<Vec<u8>, KitError> {
        let place = Place::ObjectBiquads(object);
        let Biquads { rate_hz, chains } = biquads;
        let chain_count = self.count(place, Field::Chains, chains.len(), 1, range::CHAINS)?;
        let expected = chains.first().map_or(0, Vec::len);
        let header = BiquadsHeader {
            object: self.count(place, Field::Object, object, 0, usize::from(u16::MAX))?,
            chain_count,
            depth: self.count(Place::ObjectChain(object, 0), Field::Biquads, expected, 1, range::CHAIN_DEPTH)?,
            reserved: U16::ZERO,
            rate_hz: F32::new(*rate_hz),
        };
        let mut section = header.as_bytes().to_vec();
        for (chain, biquads) in chains.iter().enumerate() {
            if biquads.len() != expected {
                let fault = Fault::ChainDepth { found: biquads.len(), expected };
                return Err(self.fault(Place::ObjectChain(object, chain), fault));
            }
            for &Biquad { pole, zero, gain } in biquads {
                let [pole_re, pole_im, zero_re, zero_im, gain] =
                    [pole[0], pole[1], zero[0], zero[1], gain].map(F32::new);
                append(&mut section, &BiquadRecord { pole_re, pole_im, zero_re, zero_im, gain });
            }
        }
        Ok(section)
    }
}
