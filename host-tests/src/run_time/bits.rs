//! Comparison of the virtual core's bits with the PC's.
//!
//! If they are equal, the accuracy measured on the PC is the chip's too.

use dsp_core::fixed::ONE_Q27;
use dsp_core::resonator::TICK_FRAMES;

use super::chip::{Resonators, table};
use super::on_pc::BankOnPc;
use super::rivals::Rival;
use crate::on_chip::{BankOnChip, OnChipError};
use crate::single_mode::Case;

/// Counts of compared samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Compared {
    /// Number of samples that were compared.
    pub samples: usize,
    /// Number of samples whose bits differ.
    pub different: usize,
}

impl Compared {
    fn add(&mut self, same: impl Iterator<Item = bool>) {
        for same in same {
            self.samples += 1;
            self.different += usize::from(!same);
        }
    }
}

/// Compares struck modes of the bank, each alone, over a number of ticks.
///
/// The rates of all cases are whole numbers of Hz.
///
/// # Errors
/// [`OnChipError`]. It is [`OnChipError::Refused`] too for a case that cannot be played.
pub fn compare_bank(chip: &mut BankOnChip, cases: &[Case], ticks: usize) -> Result<Compared, OnChipError> {
    let mut compared = Compared::default();
    for (index, case) in cases.iter().enumerate() {
        let phase = index % 2 == 1;
        let (modes, gains) = table(&[*case], phase);
        chip.load(&modes, &gains, case.rate.hz() as u32)?;
        let refused = OnChipError::Refused { function: "bank_load", code: -1 };
        let mut bank = BankOnPc::new(&[*case], phase).ok_or(refused)?;
        let mut impulse = [0; TICK_FRAMES];
        impulse[0] = ONE_Q27;
        for tick in 0..ticks {
            let force = (tick == 0).then_some(&impulse[..]);
            chip.tick(false)?;
            let (on_chip, _) = chip.render(force, TICK_FRAMES)?;
            compared.add(bank.tick(force).iter().zip(on_chip).map(|(pc, chip)| *pc == chip));
        }
    }
    Ok(compared)
}

/// Compares struck modes of a rival, each alone, over a number of ticks.
///
/// # Errors
/// [`OnChipError`].
pub fn compare_rival(
    chip: &mut BankOnChip,
    rival: &Rival,
    cases: &[Case],
    ticks: usize,
) -> Result<Compared, OnChipError> {
    let mut compared = Compared::default();
    for case in cases {
        let resonators = Resonators {
            function: rival.function,
            words: vec![rival.words.of(case).to_vec()],
            force_word: rival.force_word,
        };
        resonators.load(chip.machine())?;
        let mut impulse = [(rival.force_word)(0.0); TICK_FRAMES];
        impulse[rival.delay] = (rival.force_word)(1.0);
        let on_pc = rival.render_words(case, ticks * TICK_FRAMES);
        for (tick, on_pc) in on_pc.chunks(TICK_FRAMES).enumerate() {
            let force = (tick == 0).then_some(&impulse[..]);
            let (on_chip, _) = resonators.render(chip.machine(), force, TICK_FRAMES)?;
            compared.add(on_pc.iter().zip(on_chip).map(|(pc, chip)| *pc == chip));
        }
    }
    Ok(compared)
}
