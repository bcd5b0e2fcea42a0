//! Report of `malleus play`.

use std::path::Path;

use dsp_core::SampleRate;
use dsp_core::engine::{CostItem, TickReport};
use kit::counting::counted;
use serde::Serialize;

/// Sums over the reports of all ticks (docs/json.md).
#[derive(Debug, Default, Serialize)]
pub(super) struct Work {
    pub(super) driven_mode_frames: u64,
    pub(super) free_mode_frames: u64,
    pub(super) skipped_unstruck_mode_frames: u64,
    pub(super) skipped_decayed_mode_frames: u64,
    pub(super) striker_mode_frames: u64,
    pub(super) acceleration_frames: u64,
    pub(super) direct_frames: u64,
    pub(super) contact_frames: u64,
    pub(super) strikes: u64,
    pub(super) displaced_contacts: u64,
    pub(super) merged_positions: u64,
    pub(super) retired_modes: u64,
    pub(super) largest_retired_amplitude: f32,
    pub(super) refused_inputs: u64,
    pub(super) residual_frames: u64,
    pub(super) background_frames: u64,
    pub(super) room_frames: u64,
    pub(super) filter_frames: u64,
    pub(super) loop_frames: u64,
    pub(super) biquad_frames: u64,
    pub(super) refused_stages: u64,
    pub(super) shed_groups: u64,
    pub(super) shed_modes: u64,
    pub(super) shedding_ticks: u64,
    pub(super) largest_shed_amplitude: f32,
    pub(super) largest_predicted_cycles: u32,
    pub(super) mean_predicted_cycles: f64,
    pub(super) scrape_frames: u64,
    pub(super) refused_scrapes: u64,
    /// Number of ticks with anything to do.
    #[serde(skip)]
    busy_ticks: u32,
}

impl Work {
    pub(super) fn add(&mut self, report: &TickReport) {
        self.driven_mode_frames += u64::from(report.driven_mode_frames);
        self.free_mode_frames += u64::from(report.free_mode_frames);
        self.skipped_unstruck_mode_frames += u64::from(report.unstruck_mode_frames);
        self.skipped_decayed_mode_frames += u64::from(report.decayed_mode_frames);
        self.striker_mode_frames += u64::from(report.striker_mode_frames);
        self.acceleration_frames += u64::from(report.acceleration_frames);
        self.direct_frames += u64::from(report.direct_frames);
        self.contact_frames += u64::from(report.contact_frames);
        self.strikes += u64::from(report.strikes);
        self.displaced_contacts += u64::from(report.displaced_contacts);
        self.merged_positions += u64::from(report.merged_positions);
        self.retired_modes += u64::from(report.retired_modes);
        self.largest_retired_amplitude = self.largest_retired_amplitude.max(report.retired_amplitude);
        self.refused_inputs += u64::from(report.refused_inputs);
        self.residual_frames += u64::from(report.residual_frames);
        self.background_frames += u64::from(report.background_frames);
        self.room_frames += u64::from(report.room_frames);
        self.filter_frames += u64::from(report.filter_frames);
        self.loop_frames += u64::from(report.loop_frames);
        self.biquad_frames += u64::from(report.biquad_frames);
        self.refused_stages += u64::from(report.refused_stages);
        self.shed_groups += u64::from(report.shed.groups);
        self.shed_modes += u64::from(report.shed.modes);
        self.shedding_ticks += u64::from(report.shed.groups > 0);
        self.largest_shed_amplitude = self.largest_shed_amplitude.max(report.shed.amplitude);
        self.largest_predicted_cycles = self.largest_predicted_cycles.max(report.predicted_cycles());
        self.scrape_frames += u64::from(report.scrape_frames);
        self.refused_scrapes += u64::from(report.refused_scrapes);
        if report.counts.of(CostItem::Tick) > 0 {
            self.busy_ticks += 1;
            let growth = f64::from(report.predicted_cycles()) - self.mean_predicted_cycles;
            self.mean_predicted_cycles += growth / f64::from(self.busy_ticks);
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct PlayReport<'a> {
    pub(super) output: &'a Path,
    pub(super) kit: &'a str,
    pub(super) renderer: &'static str,
    pub(super) board: Option<&'static str>,
    pub(super) rate_hz: f64,
    pub(super) rate_ratio: (u32, u32),
    pub(super) frames: usize,
    pub(super) duration_s: f64,
    pub(super) peak_dbfs: Option<f64>,
    pub(super) unclipped_peak_dbfs: Option<f64>,
    pub(super) clipped_samples: u64,
    pub(super) saturated_samples: Option<u64>,
    pub(super) held_frames: Option<u64>,
    pub(super) largest_force: Option<f64>,
    pub(super) force_overloads: Option<u64>,
    pub(super) budget_cycles: Option<u32>,
    pub(super) work: Option<Work>,
}

impl PlayReport<'_> {
    pub(super) fn as_text(&self, rate: SampleRate) -> String {
        let mut text = format!("{}: {:.2} s at {rate}, ", self.output.display(), self.duration_s);
        text += &match (self.unclipped_peak_dbfs, self.clipped_samples) {
            (None, _) => "silence".to_owned(),
            (Some(peak), 0) => format!("peak {peak:.1} dBFS"),
            (Some(peak), clipped) => format!("peak {peak:+.1} dBFS, clipped in {}", counted(clipped, "samples")),
        };
        if let (Some(cycles), Some(work)) = (self.budget_cycles, &self.work) {
            text += &left_out(work, cycles);
        }
        text + "\n"
    }
}

/// Modes, stages and touches that a budget of cycles a tick left out, and the dearest tick if it
/// takes more all the same.
fn left_out(work: &Work, cycles: u32) -> String {
    let modes = || format!("{} in {}", counted(work.shed_modes, "modes"), counted(work.shedding_ticks, "ticks"));
    let kinds = [
        (work.shed_modes > 0).then(modes),
        (work.refused_stages > 0).then(|| counted(work.refused_stages, "stages")),
        (work.refused_scrapes > 0).then(|| counted(work.refused_scrapes, "touches")),
    ];
    let kinds: Vec<String> = kinds.into_iter().flatten().collect();
    let dearest = work.largest_predicted_cycles;
    match (kinds.is_empty(), dearest > cycles) {
        (true, false) => format!("; nothing is left out within {cycles} cycles per tick"),
        (true, true) => format!("; nothing is left out, but a tick takes up to {dearest} of {cycles} cycles"),
        (false, false) => format!("; left out: {}, to stay within {cycles} cycles per tick", kinds.join(", ")),
        (false, true) => {
            format!("; left out: {}, and still a tick takes up to {dearest} of {cycles} cycles", kinds.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_budget_leaves_out_is_counted_and_a_dearer_tick_is_told() {
        let mut work = Work { largest_predicted_cycles: 900, ..Work::default() };
        assert_eq!(left_out(&work, 1000), "; nothing is left out within 1000 cycles per tick");
        (work.shed_modes, work.shedding_ticks, work.refused_scrapes) = (4, 1, 1);
        assert_eq!(
            left_out(&work, 1000),
            "; left out: 4 modes in 1 tick, 1 touch, to stay within 1000 cycles per tick"
        );
        let over = left_out(&work, 800);
        assert_eq!(over, "; left out: 4 modes in 1 tick, 1 touch, and still a tick takes up to 900 of 800 cycles");
    }
}
