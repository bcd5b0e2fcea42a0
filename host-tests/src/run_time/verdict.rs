//! The fixed-point bank against its rivals, in three sentences.

use std::fmt;

use super::measure::ALL_FORMS;
use super::report::typed;
use super::rows::{Driven, KernelRow, OURS_FIXED};

/// Length in frames of the blocks whose cycles are compared.
const BLOCK: u32 = 32;

/// A rival beside the freely ringing fixed-point bank.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Crate and type of the rival.
    pub rival: String,
    /// Nominal cycles of the rival.
    pub cycles: f64,
    /// Cycles of the rival over those of the bank.
    pub cycle_ratio: f64,
    /// Worst SNR of the rival, dB.
    pub snr_worst_db: f64,
    /// Worst SNR of the bank less that of the rival, dB.
    pub gap_db: f64,
}

/// Comparison of the bank with the crates `biquad` and `idsp`.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Nominal cycles of the freely ringing bank, and its worst SNR over the whole grid in dB.
    pub bank: (f64, f64),
    /// Rival with the fewest cycles as a filter, when every sample goes through it with an input.
    pub quickest_filter: Comparison,
    /// Rival with the fewest cycles when its input is a constant 0. The compiler then drops the
    /// numerator.
    pub quickest_without_input: Comparison,
    /// Rival with the best worst SNR, when its input is a constant 0.
    pub most_accurate: Comparison,
}

impl Verdict {
    /// Verdict of the rows; `None` if they lack the bank or the rivals.
    pub fn of(rows: &[KernelRow]) -> Option<Self> {
        let free = |row: &&KernelRow| row.driven == Driven::Free && row.block == BLOCK;
        let bank = rows.iter().filter(free).find(|row| row.kernel == OURS_FIXED && row.form == ALL_FORMS)?;
        let bank = (bank.cycles_nominal, bank.snr_worst_db?);
        let compare = |row: &KernelRow| {
            let snr_worst_db = row.snr_worst_db?;
            Some(Comparison {
                rival: format!("{}, {}", row.kernel, typed(&row.form)),
                cycles: row.cycles_nominal,
                cycle_ratio: row.cycles_nominal / bank.0,
                snr_worst_db,
                gap_db: bank.1 - snr_worst_db,
            })
        };
        let rivals = |driven| {
            let of_crate = |row: &&KernelRow| row.kernel == "biquad" || row.kernel == "idsp";
            rows.iter().filter(of_crate).filter(move |row| row.driven == driven).filter_map(compare)
        };
        let quickest = |driven| rivals(driven).min_by(|a, b| a.cycles.total_cmp(&b.cycles));
        Some(Self {
            bank,
            quickest_filter: quickest(Driven::Gain)?,
            quickest_without_input: quickest(Driven::Free)?,
            most_accurate: rivals(Driven::Free).max_by(|a, b| a.snr_worst_db.total_cmp(&b.snr_worst_db))?,
        })
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (cycles, snr_db) = self.bank;
        writeln!(
            f,
            "The fixed-point bank rings freely at {cycles:.2} cycles a mode and sample with a worst SNR of {snr_db:.1} dB."
        )?;
        writeln!(f)?;
        let which = [
            ("quickest rival as a filter (`run(x)` of every sample)", &self.quickest_filter),
            ("quickest rival whose input is a constant 0", &self.quickest_without_input),
            ("most accurate rival whose input is a constant 0", &self.most_accurate),
        ];
        for (what, rival) in which {
            let Comparison { rival, cycles, cycle_ratio, snr_worst_db, gap_db } = rival;
            writeln!(
                f,
                "- {what}: {rival}: {cycles:.1} cycles, {cycle_ratio:.2} times the bank's; worst SNR {snr_worst_db:.1} dB, {gap_db:.1} dB below."
            )?;
        }
        Ok(())
    }
}
