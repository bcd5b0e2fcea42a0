//! Kernels on the virtual core: their cost and their output.

use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::layout::{GainRecord, ModeRecord};
use virtual_core::{CCM_ADDRESS, Cost, Machine};

use super::rows::Driven;
use crate::on_chip::{BankOnChip, OnChipError};
use crate::single_mode::Case;

/// Number of ticks over which sound is measured, after [`WARM_TICKS`]. A kernel's cycles depend on
/// no sample: 64 ticks give the page's figures too.
const SOUND_TICKS: usize = 16;
/// Number of ticks over which bookkeeping is measured. Guards and renormalisation come seldom.
const BOOKKEEPING_TICKS: usize = 64;
/// Number of ticks in which the caches fill and the guards settle.
const WARM_TICKS: usize = 8;

/// Cost of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// Cost of all modes and samples together.
    pub cost: Cost,
    /// Number of modes times number of samples.
    pub mode_samples: f64,
    /// Number of modes that were played together; `None` for the cost of a further mode.
    pub modes: Option<usize>,
    /// Length of the hottest loop in bytes; 0 if no loop ran.
    pub loop_bytes: u32,
}

/// Modes that ring together in a bank on the virtual core.
#[derive(Clone, Debug)]
pub struct BankUse<'a> {
    /// Modes of the bank, all at one rate in whole Hz.
    pub cases: &'a [Case],
    /// Input of the modes.
    pub driven: Driven,
    /// Frames of a call: 32 or a divisor of it.
    pub block: usize,
}

/// Measures a bank's sound: the calls of `bank_render`, without the bookkeeping between them.
///
/// # Errors
/// [`OnChipError`].
pub fn measure_bank(chip: &mut BankOnChip, used: &BankUse<'_>) -> Result<Measured, OnChipError> {
    run_bank(chip, used, SOUND_TICKS, |_, render| render)
}

/// Measures a bank's bookkeeping: the calls of `bank_tick`, with retirement.
///
/// # Errors
/// [`OnChipError`].
pub fn measure_bookkeeping(chip: &mut BankOnChip, used: &BankUse<'_>) -> Result<Measured, OnChipError> {
    run_bank(chip, used, BOOKKEEPING_TICKS, |tick, _| tick)
}

fn run_bank(
    chip: &mut BankOnChip,
    used: &BankUse<'_>,
    ticks: usize,
    pick: impl Fn(Cost, Cost) -> Cost,
) -> Result<Measured, OnChipError> {
    let (modes, gains) = table(used.cases, used.driven == Driven::GainAndPhase);
    chip.load(&modes, &gains, used.cases.first().map_or(48_000, |case| case.rate.hz() as u32))?;
    let mut noise = Noise(1);
    let mut cost = Cost::default();
    for tick in 0..WARM_TICKS + ticks {
        if tick == WARM_TICKS {
            chip.machine().clear_counts();
        }
        let mut now = pick(chip.tick(true)?.1, Cost::default());
        for _ in 0..TICK_FRAMES / used.block {
            let force: Option<Vec<i32>> = (tick == 0 || used.driven != Driven::Free)
                .then(|| noise.by_ref().take(used.block).map(|x| (x * f64::from(1 << 20)) as i32).collect());
            now += pick(Cost::default(), chip.render(force.as_deref(), used.block)?.1);
        }
        if tick >= WARM_TICKS {
            cost += now;
        }
    }
    let mode_samples = (used.cases.len() * ticks * TICK_FRAMES) as f64;
    let modes = Some(used.cases.len());
    Ok(Measured { cost, mode_samples, modes, loop_bytes: hottest_loop_bytes(chip.machine()) })
}

/// Records of modes that an impulse of 1.0 makes ring at their cases' levels.
///
/// If `phase`, they have a cosine gain too.
pub fn table(cases: &[Case], phase: bool) -> (Vec<ModeRecord>, Vec<GainRecord>) {
    let mode = |case: &Case| ModeRecord {
        frequency_hz: (case.frequency_hz as f32).into(),
        decay_per_s: (case.decay_per_s() as f32).into(),
    };
    let gain = |case: &Case| {
        let gain = case.level * case.rate.hz();
        let (sine, cosine) = if phase { (0.8 * gain, 0.6 * gain) } else { (gain, 0.0) };
        GainRecord { sine: (sine as f32).into(), cosine: (cosine as f32).into() }
    };
    (cases.iter().map(mode).collect(), cases.iter().map(gain).collect())
}

/// Resonators of the image that are loaded from words and rendered in blocks: `f32` modes and
/// rivals.
#[derive(Clone, Debug)]
pub struct Resonators<'a> {
    /// Name of the kind: its functions are `load_` and `render_` with this name.
    pub function: &'a str,
    /// Words of each resonator.
    pub words: Vec<Vec<u32>>,
    /// Converts a force to the word that the image takes.
    pub force_word: fn(f64) -> u32,
}

const RESONATORS: u32 = CCM_ADDRESS;
const WORDS: u32 = CCM_ADDRESS + 0x8000;
const FORCE: u32 = CCM_ADDRESS + 0xa000;
const OUT: u32 = CCM_ADDRESS + 0xa100;

impl Resonators<'_> {
    /// Loads the resonators, at rest.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn load(&self, machine: &mut Machine) -> Result<(), OnChipError> {
        machine.write(WORDS, &bytes_of(self.words.iter().flatten()))?;
        let load = format!("load_{}", self.function);
        machine.call(&load, &[RESONATORS, WORDS, self.words.len() as u32])?;
        Ok(())
    }

    /// Renders a block of at most a tick from silence; gives its sound as words, and its cost.
    ///
    /// `force` has the length of the block.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn render(
        &self,
        machine: &mut Machine,
        force: Option<&[u32]>,
        frames: usize,
    ) -> Result<(Vec<u32>, Cost), OnChipError> {
        machine.write(OUT, &[0; TICK_FRAMES * 4])?;
        if let Some(force) = force {
            machine.write(FORCE, &bytes_of(force))?;
        }
        let force = if force.is_some() { FORCE } else { 0 };
        let render = format!("render_{}", self.function);
        let call = machine.call(&render, &[RESONATORS, self.words.len() as u32, force, OUT, frames as u32])?;
        let mut out = vec![0; frames * 4];
        machine.read(OUT, &mut out)?;
        Ok((out.as_chunks().0.iter().map(|&word| u32::from_le_bytes(word)).collect(), call.cost))
    }

    /// Measures blocks of `block` frames.
    ///
    /// # Errors
    /// [`OnChipError`].
    pub fn measure(&self, machine: &mut Machine, driven: Driven, block: usize) -> Result<Measured, OnChipError> {
        self.load(machine)?;
        let mut noise = Noise(1);
        let mut cost = Cost::default();
        let blocks_of = |ticks: usize| ticks * TICK_FRAMES / block;
        for count in 0..blocks_of(WARM_TICKS + SOUND_TICKS) {
            if count == blocks_of(WARM_TICKS) {
                machine.clear_counts();
            }
            let force: Option<Vec<u32>> = (count == 0 || driven != Driven::Free)
                .then(|| noise.by_ref().take(block).map(|x| (self.force_word)(x / 1024.0)).collect());
            let spent = self.render(machine, force.as_deref(), block)?.1;
            if count >= blocks_of(WARM_TICKS) {
                cost += spent;
            }
        }
        let mode_samples = (self.words.len() * SOUND_TICKS * TICK_FRAMES) as f64;
        let modes = Some(self.words.len());
        Ok(Measured { cost, mode_samples, modes, loop_bytes: hottest_loop_bytes(machine) })
    }
}

fn bytes_of<'a>(words: impl IntoIterator<Item = &'a u32>) -> Vec<u8> {
    words.into_iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// Length in bytes of the innermost loop that runs most.
///
/// It is the shortest of the loops that ran at least half as many instructions as the busiest one.
pub(super) fn hottest_loop_bytes(machine: &Machine) -> u32 {
    let loops = machine.loops();
    let most = loops.first().map_or(0, |most| most.instructions);
    loops.iter().filter(|one| 2 * one.instructions >= most).map(|one| one.bytes).min().unwrap_or(0)
}

/// White noise from -1 to 1, equal in every run: the linear congruential generator `ranqd1` of
/// Numerical Recipes.
struct Noise(u32);

impl Iterator for Noise {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        Some(f64::from(self.0.cast_signed()) / 2_147_483_648.0)
    }
}
