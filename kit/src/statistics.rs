//! Statistics of a kit: numbers of modes, ringing times, and bytes.

use dsp_core::table::layout::{GainRecord, ModeRecord};

use crate::content::{Kit, Mode};
use crate::filters::Biquads;

/// Statistics of a kit.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// Size of the binary form in bytes.
    pub bytes: usize,
    /// Size of all modes and their gains in the binary form, in bytes.
    pub mode_bytes: usize,
    /// Statistics of each object, in the kit's order.
    pub objects: Vec<BankStatistics>,
    /// Statistics of each striker, in the kit's order.
    pub strikers: Vec<BankStatistics>,
}

/// Statistics of the modal bank of one object or striker, and of an object's filters.
#[derive(Clone, Debug, PartialEq)]
pub struct BankStatistics {
    /// Name of the object or striker.
    pub name: String,
    /// Number of modes.
    pub modes: usize,
    /// Number of positions at which gains are given.
    pub positions: usize,
    /// Lowest and highest frequency of a mode in Hz; `None` without modes.
    pub frequency_hz: Option<(f32, f32)>,
    /// Shortest and longest T60 = ln(1000)/d of a mode in seconds; `None` without modes.
    pub t60_s: Option<(f32, f32)>,
    /// Size of the modes and their gains in the binary form, in bytes.
    pub mode_bytes: usize,
    /// Number of breakpoints of the object's dynamic filter; 0 without one.
    pub breakpoints: usize,
    /// Number of loops round the object's dynamic filter.
    pub loops: usize,
    /// Number of biquads of the object.
    pub biquads: usize,
}

impl Statistics {
    /// Computes the statistics of a kit whose binary form has `bytes` bytes.
    pub(crate) fn of(kit: &Kit, bytes: usize) -> Self {
        let objects: Vec<_> = kit
            .objects
            .iter()
            .map(|object| BankStatistics {
                breakpoints: object.dynamic_filter.as_ref().map_or(0, |filter| filter.path.len()),
                loops: object.dynamic_filter.as_ref().map_or(0, |filter| filter.loops.len()),
                biquads: object.biquads.as_ref().map_or(0, Biquads::count),
                ..BankStatistics::of(&object.name, &object.modes, object.position_count())
            })
            .collect();
        let strikers: Vec<_> =
            kit.strikers.iter().map(|striker| BankStatistics::of(&striker.name, &striker.modes, 1)).collect();
        let mode_bytes = objects.iter().chain(&strikers).map(|bank| bank.mode_bytes).sum();
        Self { bytes, mode_bytes, objects, strikers }
    }

    /// Share of the binary form that modes and their gains take, 0 to 1.
    pub fn mode_share(&self) -> f64 {
        self.mode_bytes as f64 / self.bytes.max(1) as f64
    }
}

impl BankStatistics {
    fn of(name: &str, modes: &[Mode], positions: usize) -> Self {
        let gains: usize = modes.iter().map(|mode| mode.gains.len()).sum();
        Self {
            name: name.to_owned(),
            modes: modes.len(),
            positions,
            frequency_hz: extent(modes.iter().map(|mode| mode.frequency_hz)),
            t60_s: extent(modes.iter().map(|mode| 1000f32.ln() / mode.decay_per_s)),
            mode_bytes: modes.len() * size_of::<ModeRecord>() + gains * size_of::<GainRecord>(),
            breakpoints: 0,
            loops: 0,
            biquads: 0,
        }
    }
}

/// Smallest and largest of the values; `None` without values.
fn extent(values: impl Iterator<Item = f32>) -> Option<(f32, f32)> {
    values.map(|value| (value, value)).reduce(|(low, high), (value, _)| (low.min(value), high.max(value)))
}
