//! Measurement of all rows of the table.

use super::accuracy::{Accuracy, Subject};
use super::bits::{self, Compared};
use super::chip::{BankUse, Measured, Resonators, measure_bank, measure_bookkeeping};
use super::fixed_forms::FixedForm;
use super::frames_rows;
use super::on_pc;
use super::rivals::Rival;
use super::rows::{Driven, KernelRow, OURS_FIXED, OURS_FLOAT};
use crate::on_chip::{BankOnChip, OnChipError};
use crate::single_mode::Case;

/// Number of modes of a bank whose cycles are counted.
const BANK_MODES: u32 = 480;
/// Number of modes of a set of rivals whose cycles are counted.
const RIVAL_MODES: u32 = 64;
/// T60 of modes that ring on throughout a measurement, in seconds.
const LONG_T60_S: f64 = 5.0;
/// T60 of modes whose bookkeeping is counted, in seconds.
const BOOKKEEPING_T60_S: f64 = 1.0;
/// Number of ticks over which the PC is timed.
pub(super) const PC_TICKS: usize = 200;
/// [`KernelRow::form`] of the bank's accuracy over the whole grid.
pub const ALL_FORMS: &str = "all";
/// [`KernelRow::form`] of the bank's work between blocks.
pub const BOOKKEEPING: &str = "guard, retirement and renormalisation";

const WHOLE_TICK: usize = 32;

/// Measures run time on the virtual core and on the PC, and joins it with the accuracies.
///
/// # Errors
/// [`OnChipError`].
pub fn kernel_rows(
    chip: &mut BankOnChip,
    accuracies: &[Accuracy],
    mut advance: impl FnMut(),
) -> Result<Vec<KernelRow>, OnChipError> {
    let mut rows = Vec::new();
    for accuracy in accuracies {
        match &accuracy.subject {
            Subject::Fixed(form) => fixed_rows(chip, *form, accuracy, &mut rows)?,
            Subject::Frames => frames_rows::add(accuracy, &mut rows)?,
            Subject::Float => float_rows(chip, accuracy, &mut rows)?,
            Subject::Rival(rival) => rival_rows(chip, rival, accuracy, &mut rows)?,
        }
        advance();
    }
    bookkeeping_rows(chip, &mut rows)?;
    Ok(rows)
}

fn fixed_rows(
    chip: &mut BankOnChip,
    form: Option<FixedForm>,
    accuracy: &Accuracy,
    rows: &mut Vec<KernelRow>,
) -> Result<(), OnChipError> {
    let cases = form.unwrap_or(FixedForm::Coupled).modes(BANK_MODES, LONG_T60_S);
    let blocks: &[usize] = if form == Some(FixedForm::Coupled) { &[WHOLE_TICK, 16, 8] } else { &[WHOLE_TICK] };
    for driven in [Driven::Free, Driven::Gain, Driven::GainAndPhase] {
        for &block in blocks {
            let measured = measure_bank(chip, &BankUse { cases: &cases, driven, block })?;
            let pc_ns = (block == WHOLE_TICK).then(|| on_pc::bank_ns(&cases, driven, PC_TICKS)).flatten();
            let form = form.map_or(ALL_FORMS, FixedForm::name);
            rows.push(row(OURS_FIXED, form, driven, block, &measured, Some(accuracy), pc_ns));
        }
    }
    Ok(())
}

fn bookkeeping_rows(chip: &mut BankOnChip, rows: &mut Vec<KernelRow>) -> Result<(), OnChipError> {
    let cases = FixedForm::Coupled.modes(BANK_MODES, BOOKKEEPING_T60_S);
    for driven in [Driven::Free, Driven::Gain, Driven::GainAndPhase] {
        let measured = measure_bookkeeping(chip, &BankUse { cases: &cases, driven, block: WHOLE_TICK })?;
        let no_loop = Measured { loop_bytes: 0, ..measured };
        rows.push(row(OURS_FIXED, BOOKKEEPING, driven, WHOLE_TICK, &no_loop, None, None));
    }
    Ok(())
}

fn float_rows(chip: &mut BankOnChip, accuracy: &Accuracy, rows: &mut Vec<KernelRow>) -> Result<(), OnChipError> {
    let cases = FixedForm::Coupled.modes(BANK_MODES, LONG_T60_S);
    let words = |case: &Case| [case.frequency_hz, case.decay_per_s(), 0.01].map(|x| (x as f32).to_bits()).to_vec();
    let force_word = |force| (force as f32).to_bits();
    let resonators = Resonators { function: "float", words: cases.iter().map(words).collect(), force_word };
    for driven in [Driven::Free, Driven::Gain] {
        for block in [WHOLE_TICK, 16, 8] {
            let measured = resonators.measure(chip.machine(), driven, block)?;
            let pc_ns = (block == WHOLE_TICK).then(|| on_pc::float_ns(&cases, driven, PC_TICKS));
            rows.push(row(OURS_FLOAT, "modified coupled", driven, block, &measured, Some(accuracy), pc_ns));
        }
    }
    Ok(())
}

fn rival_rows(
    chip: &mut BankOnChip,
    rival: &Rival,
    accuracy: &Accuracy,
    rows: &mut Vec<KernelRow>,
) -> Result<(), OnChipError> {
    let cases = FixedForm::Coupled.modes(RIVAL_MODES, LONG_T60_S);
    let words = cases.iter().map(|case| rival.words.of(case).to_vec()).collect();
    let resonators = Resonators { function: rival.function, words, force_word: rival.force_word };
    for driven in [Driven::Free, Driven::Gain] {
        let measured = resonators.measure(chip.machine(), driven, WHOLE_TICK)?;
        let pc_ns = Some(rival.time_ns(&cases, driven == Driven::Gain, PC_TICKS));
        rows.push(row(rival.kernel, rival.form, driven, WHOLE_TICK, &measured, Some(accuracy), pc_ns));
    }
    Ok(())
}

pub(super) fn row(
    kernel: &str,
    form: &str,
    driven: Driven,
    block: usize,
    measured: &Measured,
    accuracy: Option<&Accuracy>,
    pc_ns: Option<f64>,
) -> KernelRow {
    let snr = accuracy.filter(|accuracy| !accuracy.snr_db.is_empty()).map(Accuracy::worst_and_median);
    let each = |total: u64| total as f64 / measured.mode_samples;
    KernelRow {
        kernel: kernel.to_owned(),
        form: form.to_owned(),
        driven,
        block: block as u32,
        modes: measured.modes.map(|modes| modes as u32),
        cycles_best: each(measured.cost.best),
        cycles_nominal: each(measured.cost.nominal),
        cycles_worst: each(measured.cost.worst),
        cycles_with_flash: each(measured.cost.with_flash()),
        instructions: each(measured.cost.instructions),
        loop_bytes: measured.loop_bytes,
        snr_worst_db: snr.map(|(worst, _)| worst),
        snr_median_db: snr.map(|(_, median)| median),
        pc_ns,
    }
}

/// Compares the virtual core's bits with the PC's: first of the bank, then of all rivals together.
///
/// # Errors
/// [`OnChipError`].
pub fn compare_bits(
    chip: &mut BankOnChip,
    grid: &[Case],
    rivals: &[Rival],
    ticks: usize,
) -> Result<(Compared, Compared), OnChipError> {
    let cases: Vec<Case> = grid.iter().map(Case::exact).collect();
    let bank = bits::compare_bank(chip, &cases, ticks)?;
    let mut others = Compared::default();
    for rival in rivals {
        let compared = bits::compare_rival(chip, rival, &cases, ticks.div_ceil(20))?;
        others.samples += compared.samples;
        others.different += compared.different;
    }
    Ok((bank, others))
}

#[cfg(test)]
mod tests {
    use super::super::rivals;
    use super::*;
    use crate::single_mode::grid;

    #[test]
    fn the_virtual_core_has_the_bits_of_the_pc() {
        let mut chip = BankOnChip::new().expect("the image builds");
        let sample: Vec<Case> = grid(40, 1.0).into_iter().step_by(67).collect();
        let (bank, rivals) = compare_bits(&mut chip, &sample, &rivals::all(), 20).expect("they run");
        assert_eq!((bank.different, rivals.different), (0, 0));
        assert_eq!(bank.samples, sample.len() * 20 * WHOLE_TICK);
    }

    #[test]
    fn a_free_bank_takes_less_than_half_the_cycles_of_any_rival() {
        let mut chip = BankOnChip::new().expect("the image builds");
        let cases = FixedForm::Coupled.modes(60, LONG_T60_S);
        let nominal = |measured: Measured| measured.cost.nominal as f64 / measured.mode_samples;
        let used = BankUse { cases: &cases, driven: Driven::Free, block: WHOLE_TICK };
        let bank = nominal(measure_bank(&mut chip, &used).expect("it runs"));
        for rival in rivals::all().iter().filter(|rival| rival.kernel != "plain loop") {
            let words = cases.iter().map(|case| rival.words.of(case).to_vec()).collect();
            let resonators = Resonators { function: rival.function, words, force_word: rival.force_word };
            let cycles = nominal(resonators.measure(chip.machine(), Driven::Free, WHOLE_TICK).expect("it runs"));
            assert!(cycles > 2.0 * bank, "{}: {cycles} against {bank}", rival.form);
        }
    }
}
