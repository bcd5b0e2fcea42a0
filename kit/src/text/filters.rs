//! Tables `[object.dynamic_filter]` and `[object.biquads]`: they are read and written.

use std::fmt::{self, Display, Formatter};

use serde::de;
use toml::Spanned;

use super::number::shortest_decimal;
use super::pair::Pair;
use crate::filters::{Biquad, Biquads, Breakpoint, DynamicFilter, Exciter, Loop, ModesGo, Order};

/// Table `[object.dynamic_filter]`, key by key.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DynamicFilterTable {
    #[serde(default)]
    seed: u32,
    #[serde(default, deserialize_with = "modes_go")]
    modes: ModesGo,
    #[serde(default = "usual_rate_hz")]
    rate_hz: f32,
    exciter: Option<ExciterTable>,
    path: Vec<Spanned<BreakpointTable>>,
    #[serde(default)]
    loops: Vec<Spanned<LoopTable>>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct ExciterTable {
    low_hz: f32,
    high_hz: f32,
    #[serde(default)]
    exponent: f32,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct BreakpointTable {
    time_s: f32,
    #[serde(default = "full_level")]
    noise: f32,
    a1: f32,
    a2: Option<f32>,
    b0: f32,
    b1: Option<f32>,
    b2: Option<f32>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct LoopTable {
    frequency_hz: f32,
    bandwidth_hz: f32,
    gain: f32,
    delay_s: f32,
}

/// Table `[object.biquads]`, key by key.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BiquadsTable {
    #[serde(default = "usual_rate_hz")]
    rate_hz: f32,
    chains: Vec<Spanned<Vec<Spanned<BiquadTable>>>>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct BiquadTable {
    pole: Pair,
    #[serde(default = "no_zero")]
    zero: Pair,
    gain: f32,
}

fn no_zero() -> Pair {
    Pair([0.0; 2])
}

fn full_level() -> f32 {
    1.0
}

fn usual_rate_hz() -> f32 {
    48_000.0
}

fn modes_go<'de, D: de::Deserializer<'de>>(deserializer: D) -> Result<ModesGo, D::Error> {
    let word = <String as de::Deserialize>::deserialize(deserializer)?;
    [ModesGo::Beside, ModesGo::Through].into_iter().find(|modes| modes.key() == word).ok_or_else(|| {
        let (beside, through) = (ModesGo::Beside.key(), ModesGo::Through.key());
        de::Error::custom(format!("modes = {word:?}: must be {beside:?} or {through:?}"))
    })
}

/// Byte offsets of a dynamic filter and of its parts in their file.
#[derive(Default)]
pub(super) struct FilterOrigin {
    pub(super) offset: usize,
    pub(super) path: Vec<usize>,
    pub(super) loops: Vec<usize>,
}

/// Byte offsets of a biquad bank, of its chains and of their biquads in their file.
#[derive(Default)]
pub(super) struct BiquadsOrigin {
    pub(super) offset: usize,
    pub(super) chains: Vec<(usize, Vec<usize>)>,
}

fn offsets<T>(tables: &[Spanned<T>]) -> Vec<usize> {
    tables.iter().map(|table| table.span().start).collect()
}

impl DynamicFilterTable {
    /// Converts the table to a filter.
    ///
    /// The error is the index of the first breakpoint, counted from 0, whose order differs from
    /// that of the first one.
    pub(super) fn read(table: Spanned<Self>) -> (FilterOrigin, Result<DynamicFilter, usize>) {
        let offset = table.span().start;
        let Self { seed, modes, rate_hz, exciter, path, loops } = table.into_inner();
        let origin = FilterOrigin { offset, path: offsets(&path), loops: offsets(&loops) };
        let is_second = path.first().is_some_and(|first| first.get_ref().a2.is_some());
        let is_mixed = |point: &Spanned<BreakpointTable>| {
            let point = point.get_ref();
            point.a2.is_some() != is_second || point.b2.is_some() != is_second
        };
        if let Some(breakpoint) = path.iter().position(is_mixed) {
            return (origin, Err(breakpoint));
        }
        let exciter = exciter.map(|ExciterTable { low_hz, high_hz, exponent }| Exciter { low_hz, high_hz, exponent });
        let order = if is_second { Order::Second } else { Order::First };
        let path = path.into_iter().map(|point| point.into_inner().breakpoint()).collect();
        let loops = loops.into_iter().map(|table| {
            let LoopTable { frequency_hz, bandwidth_hz, gain, delay_s } = table.into_inner();
            Loop { frequency_hz, bandwidth_hz, gain, delay_s }
        });
        (origin, Ok(DynamicFilter { seed, modes, rate_hz, exciter, order, path, loops: loops.collect() }))
    }
}

impl BreakpointTable {
    /// Converts the table to a breakpoint; a missing b1 is b0, as in eq. 17.
    fn breakpoint(self) -> Breakpoint {
        let Self { time_s, noise, a1, a2, b0, b1, b2 } = self;
        Breakpoint { time_s, noise, a1, a2: a2.unwrap_or(0.0), b0, b1: b1.unwrap_or(b0), b2: b2.unwrap_or(0.0) }
    }
}

impl BiquadsTable {
    pub(super) fn read(table: Spanned<Self>) -> (BiquadsOrigin, Biquads) {
        let offset = table.span().start;
        let Self { rate_hz, chains } = table.into_inner();
        let origins = chains.iter().map(|chain| (chain.span().start, offsets(chain.get_ref())));
        let origin = BiquadsOrigin { offset, chains: origins.collect() };
        let biquad = |table: Spanned<BiquadTable>| {
            let BiquadTable { pole: Pair(pole), zero: Pair(zero), gain } = table.into_inner();
            Biquad { pole, zero, gain }
        };
        let chains = chains.into_iter().map(|chain| chain.into_inner().into_iter().map(biquad).collect());
        (origin, Biquads { rate_hz, chains: chains.collect() })
    }
}

/// Wrapper of a value that is written as TOML.
pub(super) struct Text<T>(pub(super) T);

impl Display for Text<&DynamicFilter> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let DynamicFilter { seed, modes, rate_hz, exciter, order, path, loops } = self.0;
        writeln!(f, "\n[object.dynamic_filter]\nseed = {seed}\nmodes = \"{}\"", modes.key())?;
        writeln!(f, "rate_hz = {}", shortest_decimal(*rate_hz))?;
        if let Some(Exciter { low_hz, high_hz, exponent }) = exciter {
            let [low_hz, high_hz, exponent] = [low_hz, high_hz, exponent].map(|&number| shortest_decimal(number));
            writeln!(f, "exciter = {{ low_hz = {low_hz}, high_hz = {high_hz}, exponent = {exponent} }}")?;
        }
        writeln!(f, "path = [")?;
        let has_levels = path.iter().any(|point| point.noise != 1.0);
        for &Breakpoint { time_s, noise, a1, a2, b0, b1, b2 } in path {
            let [time_s, noise, a1, a2, b0, b1, b2] = [time_s, noise, a1, a2, b0, b1, b2].map(shortest_decimal);
            let level = if has_levels { format!(", noise = {noise}") } else { String::new() };
            match order {
                Order::First => writeln!(f, "    {{ time_s = {time_s}{level}, a1 = {a1}, b0 = {b0}, b1 = {b1} }},")?,
                Order::Second => writeln!(
                    f,
                    "    {{ time_s = {time_s}{level}, a1 = {a1}, a2 = {a2}, b0 = {b0}, b1 = {b1}, b2 = {b2} }},"
                )?,
            }
        }
        writeln!(f, "]")?;
        if loops.is_empty() {
            return Ok(());
        }
        writeln!(f, "loops = [")?;
        for &Loop { frequency_hz, bandwidth_hz, gain, delay_s } in loops {
            let [frequency_hz, bandwidth_hz, gain, delay_s] =
                [frequency_hz, bandwidth_hz, gain, delay_s].map(shortest_decimal);
            writeln!(
                f,
                "    {{ frequency_hz = {frequency_hz}, bandwidth_hz = {bandwidth_hz}, gain = {gain}, delay_s = {delay_s} }},"
            )?;
        }
        writeln!(f, "]")
    }
}

impl Display for Text<&Biquads> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Biquads { rate_hz, chains } = self.0;
        writeln!(f, "\n[object.biquads]\nrate_hz = {}\nchains = [", shortest_decimal(*rate_hz))?;
        for chain in chains {
            let biquads: Vec<String> = chain.iter().map(|biquad| Text(biquad).to_string()).collect();
            writeln!(f, "    [ {} ],", biquads.join(", "))?;
        }
        writeln!(f, "]")
    }
}

impl Display for Text<&Biquad> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Biquad { pole, zero, gain } = self.0;
        let pair = |[re, im]: [f32; 2]| format!("[{}, {}]", shortest_decimal(re), shortest_decimal(im));
        write!(f, "{{ pole = {}, zero = {}, gain = {} }}", pair(*pole), pair(*zero), shortest_decimal(*gain))
    }
}
