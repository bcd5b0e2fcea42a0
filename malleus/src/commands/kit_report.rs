//! Facts on a kit that `malleus kit build`, `check` and `show` share: opening, counting, the
//! report.

use kit::counting::counted;
use kit::{BankStatistics, Loaded};
use serde::Serialize;

use super::error::CommandError;

/// Opens a kit by name or path, and tells the user of sections that this version does not know.
pub(super) fn open(name: &str) -> Result<Loaded, CommandError> {
    let loaded = kit::open(name)?;
    for tag in &loaded.skipped_sections {
        eprintln!("malleus: {name}: section {tag} is unknown to this version and is left out");
    }
    Ok(loaded)
}

/// Numbers of the kit's pads, objects, strikers, modes, filters and residuals, in words.
pub(super) fn counts(loaded: &Loaded) -> String {
    let statistics = loaded.statistics();
    let modes: usize = statistics.objects.iter().chain(&statistics.strikers).map(|bank| bank.modes).sum();
    let kit = &loaded.kit;
    let (pads, objects, strikers) = (kit.pads.len(), kit.objects.len(), kit.strikers.len());
    let mut counts = [(pads, "pads"), (objects, "objects"), (strikers, "strikers"), (modes, "modes")]
        .map(|(count, what)| counted(count, what))
        .join(", ");
    let all = |count: fn(&BankStatistics) -> usize| statistics.objects.iter().map(count).sum::<usize>();
    for (count, what) in [
        (all(|object| usize::from(object.breakpoints > 0)), "dynamic filters"),
        (all(|object| object.loops), "loops"),
        (all(|object| object.biquads), "biquads"),
        (kit.objects.iter().filter(|object| object.residual.is_some()).count(), "residuals"),
    ] {
        if count > 0 {
            counts += &format!(", {}", counted(count, what));
        }
    }
    counts
}

/// Report on a kit that `--json` prints (docs/json.md).
#[derive(Debug, Serialize)]
pub(super) struct KitReport<'a> {
    kit: &'a str,
    name: &'a str,
    binary_bytes: usize,
    modes_bytes: usize,
    pads: Vec<&'a str>,
    objects: Vec<BankReport>,
    strikers: Vec<BankReport>,
    skipped_sections: &'a [String],
}

/// Part of the report on one object or striker.
#[derive(Debug, Serialize)]
struct BankReport {
    name: String,
    modes: usize,
    positions: usize,
    lowest_frequency_hz: Option<f32>,
    highest_frequency_hz: Option<f32>,
    shortest_t60_s: Option<f32>,
    longest_t60_s: Option<f32>,
    breakpoints: usize,
    loops: usize,
    biquads: usize,
}

impl<'a> KitReport<'a> {
    pub(super) fn of(kit: &'a str, loaded: &'a Loaded) -> Self {
        let statistics = loaded.statistics();
        Self {
            kit,
            name: &loaded.kit.name,
            binary_bytes: statistics.bytes,
            modes_bytes: statistics.mode_bytes,
            pads: loaded.kit.pads.iter().map(|pad| pad.name.as_str()).collect(),
            objects: statistics.objects.iter().map(BankReport::of).collect(),
            strikers: statistics.strikers.iter().map(BankReport::of).collect(),
            skipped_sections: &loaded.skipped_sections,
        }
    }
}

impl BankReport {
    fn of(bank: &BankStatistics) -> Self {
        Self {
            name: bank.name.clone(),
            modes: bank.modes,
            positions: bank.positions,
            lowest_frequency_hz: bank.frequency_hz.map(|(lowest, _)| lowest),
            highest_frequency_hz: bank.frequency_hz.map(|(_, highest)| highest),
            shortest_t60_s: bank.t60_s.map(|(shortest, _)| shortest),
            longest_t60_s: bank.t60_s.map(|(_, longest)| longest),
            breakpoints: bank.breakpoints,
            loops: bank.loops,
            biquads: bank.biquads,
        }
    }
}
