//! Rows of the bank in frames, whose cycles have a constant part beside that of each mode.

use dsp_core::resonator::TICK_FRAMES;

use super::accuracy::Accuracy;
use super::chip::{Measured, hottest_loop_bytes};
use super::measure::{PC_TICKS, row};
use super::on_pc::quickest_ns;
use super::rows::{Driven, FRAMES, FURTHER_MODE, KernelRow, OURS_FRAMES};
use crate::frames::{FramesOnPc, prior};
use crate::on_chip::lone_pad::{RATE, T60_S, direct_force, play_stage, struck_once};
use crate::on_chip::{FramesOnChip, OnChipError};

/// Numbers of modes of the banks whose cycles are counted. The last two give the cost of a further
/// mode.
const MODES: [usize; 3] = [64, 256, 1025];
/// Number of ticks after a strike or a load before ticks are measured.
const SETTLING_TICKS: usize = 40;
/// Number of measured ticks: four blocks.
const TICKS: usize = 32;

/// Adds the rows of banks in frames, and those of a further mode.
pub(super) fn add(accuracy: &Accuracy, rows: &mut Vec<KernelRow>) -> Result<(), OnChipError> {
    let mut chip = FramesOnChip::new()?;
    let mut further = Vec::new();
    for driven in [Driven::Free, Driven::Gain] {
        let mut measured = Vec::new();
        for modes in MODES {
            let one = measure(&mut chip, modes, driven)?;
            let pc_ns = Some(pc_ns(modes, driven));
            rows.push(row(OURS_FRAMES, FRAMES, driven, TICK_FRAMES, &one, Some(accuracy), pc_ns));
            measured.push(one);
        }
        let [.., fewer, more] = &measured[..] else { continue };
        let mut cost = more.cost - fewer.cost;
        // The bounds of the constant part differ by up to 0.01 cycles a further mode.
        (cost.best, cost.worst) = (cost.best.min(cost.worst), cost.best.max(cost.worst));
        let difference =
            Measured { cost, mode_samples: more.mode_samples - fewer.mode_samples, modes: None, loop_bytes: 0 };
        further.push(row(OURS_FRAMES, FURTHER_MODE, driven, TICK_FRAMES, &difference, Some(accuracy), None));
    }
    rows.extend(further);
    Ok(())
}

/// Measures a bank in frames as a stage: transform, force, head, panning and retirement.
///
/// # Errors
/// [`OnChipError`].
pub fn measure(chip: &mut FramesOnChip, modes: usize, driven: Driven) -> Result<Measured, OnChipError> {
    chip.load(&prior(modes, T60_S), RATE)?;
    // Both last for whole blocks.
    let force = |tick| if driven == Driven::Free { struck_once(tick) } else { Some(direct_force(tick)) };
    play_stage(chip, force, 0..SETTLING_TICKS)?;
    chip.machine().clear_counts();
    let force = |tick| (driven != Driven::Free).then(|| direct_force(SETTLING_TICKS + tick));
    let cost = play_stage(chip, force, 0..TICKS)?.total;
    let mode_samples = (modes * TICKS * TICK_FRAMES) as f64;
    Ok(Measured { cost, mode_samples, modes: Some(modes), loop_bytes: hottest_loop_bytes(chip.machine()) })
}

/// Time of a bank in frames on this PC, in ns a mode and sample.
fn pc_ns(modes: usize, driven: Driven) -> f64 {
    let mut bank = FramesOnPc::new(&prior(modes, T60_S), RATE, true);
    bank.render(&direct_force(0), TICK_FRAMES);
    let force = if driven == Driven::Free { vec![0; TICK_FRAMES] } else { direct_force(1) };
    quickest_ns(modes, PC_TICKS, || {
        std::hint::black_box(bank.render(std::hint::black_box(&force), TICK_FRAMES));
    })
}
