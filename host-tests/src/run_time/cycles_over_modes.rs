//! Cycles of one pad over its number of modes, in the fixed-point bank and in frames.
//!
//! Both forms play the same modes in the whole engine, to its 24-bit stereo output. The engine
//! plays pads of fewer than [`FEWEST_MODES`] in the bank alone. For such pads, frames are measured
//! as a stage, and the cycles that the engine takes beside the stage with [`FEWEST_MODES`] modes
//! are added.

use std::fmt;

use dsp_core::frames::FEWEST_MODES;
use serde::Serialize;

use crate::frames::{HeardMode, prior};
use crate::on_chip::lone_pad::{Drive, RATE, T60_S, direct_force, kit_of, play_engine, play_stage, struck_once};
use crate::on_chip::{EngineOnChip, FramesOnChip, OnChipError};
use crate::scene::load;

/// Numbers of modes of the table and the picture.
pub const MODES: [usize; 12] = [16, 32, 64, 96, 128, 160, FEWEST_MODES, 256, 384, 512, 768, 1025];

/// Number of ways to play a pad.
const WAYS: usize = Play::ALL.len();

/// Form in which a pad's modes are played.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum PadForm {
    /// The fixed-point bank, which renders each mode at each sample.
    #[serde(rename = "bank")]
    Bank,
    /// Blocks of 256 frames by one transform.
    #[serde(rename = "frames")]
    Frames,
}

impl PadForm {
    /// Name of the form in table and picture.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bank => "bank",
            Self::Frames => "frames",
        }
    }
}

/// Way in which a pad is played while its cycles are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Play {
    /// Mean of ticks without a force, after a strike.
    #[serde(rename = "ringing")]
    Ringing,
    /// Dearest tick of one strike.
    #[serde(rename = "strike")]
    Strike,
    /// Mean of ticks under a direct force that never rests.
    #[serde(rename = "direct force")]
    DirectForce,
    /// Mean of ticks under a direct force, all modes with a sine gain alone.
    ///
    /// The bank then takes one product a mode and sample less; frames take the same cycles.
    #[serde(rename = "direct force, sine gains")]
    SineDirectForce,
}

impl Play {
    /// All ways, in the order of [`PadRow::cycles`].
    pub const ALL: [Self; 4] = [Self::Ringing, Self::Strike, Self::DirectForce, Self::SineDirectForce];

    /// Name of the way in table and picture.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ringing => "ringing",
            Self::Strike => "dearest tick of a strike",
            Self::DirectForce => "direct force",
            Self::SineDirectForce => "direct force, sine gains",
        }
    }
}

/// Cycles of a pad in one form.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PadRow {
    /// Number of modes of the pad.
    pub modes: u32,
    /// Form in which the modes are played.
    pub form: PadForm,
    /// True if the whole engine was measured; false for frames measured as a stage, with the
    /// engine's own cycles added.
    pub is_whole_engine: bool,
    /// Nominal cycles a frame, in the order of [`Play::ALL`].
    pub cycles: [f64; WAYS],
}

/// Number of modes from which frames take fewer cycles than the bank.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Crossing {
    /// Way in which the pad is played.
    pub play: Play,
    /// Number of modes, between those of two rows.
    pub modes: f64,
    /// Nominal cycles a frame of both forms there.
    pub cycles: f64,
}

impl fmt::Display for Crossing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { modes, cycles, .. } = self;
        let what = match self.play {
            Play::Ringing => "A ringing pad takes",
            Play::Strike => "The dearest tick of a strike takes",
            Play::DirectForce => "A pad under a force that never rests takes",
            Play::SineDirectForce => "A pad under such a force whose modes have sine gains alone takes",
        };
        write!(f, "{what} fewer cycles in frames from {:.0} modes on, at {cycles:.0} cycles a frame.", modes.ceil())
    }
}

/// Cycles of pads with growing numbers of modes in both forms.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct OverModes {
    /// Pads by their number of modes, each in the bank and then in frames.
    pub pads: Vec<PadRow>,
    /// Nominal cycles a frame that the engine takes beside the stage of frames with
    /// [`FEWEST_MODES`] modes, in the order of [`Play::ALL`].
    pub engine_beside_stage: [f64; WAYS],
    /// Points from which frames take fewer cycles.
    pub crossings: Vec<Crossing>,
}

impl OverModes {
    /// Points of a form, `[modes, cycles]`, for a place in [`PadRow::cycles`].
    pub fn curve(&self, form: PadForm, play: usize) -> Vec<[f64; 2]> {
        curve(&self.pads, form, play)
    }
}

/// Measures pads of these numbers of modes in both forms; `advance` is called after each pad.
///
/// # Errors
/// [`OnChipError`].
pub fn measure(modes: &[usize], mut advance: impl FnMut()) -> Result<OverModes, OnChipError> {
    let mut engine = EngineOnChip::new()?;
    let mut stage = FramesOnChip::new()?;
    let with_engine = in_engine(&mut engine, FEWEST_MODES, PadForm::Frames)?;
    let alone = as_stage(&mut stage, FEWEST_MODES)?;
    let engine_beside_stage: [f64; WAYS] = std::array::from_fn(|play| with_engine[play] - alone[play]);
    let mut pads = Vec::new();
    for &count in modes {
        let bank = in_engine(&mut engine, count, PadForm::Bank)?;
        let is_whole_engine = count >= FEWEST_MODES;
        let frames = if is_whole_engine {
            in_engine(&mut engine, count, PadForm::Frames)?
        } else {
            let stage = as_stage(&mut stage, count)?;
            std::array::from_fn(|play| stage[play] + engine_beside_stage[play])
        };
        let modes = count as u32;
        pads.push(PadRow { modes, form: PadForm::Bank, is_whole_engine: true, cycles: bank });
        pads.push(PadRow { modes, form: PadForm::Frames, is_whole_engine, cycles: frames });
        advance();
    }
    let crossings = crossings(&pads);
    Ok(OverModes { pads, engine_beside_stage, crossings })
}

/// Cycles of a pad in the engine.
fn in_engine(chip: &mut EngineOnChip, modes: usize, form: PadForm) -> Result<[f64; WAYS], OnChipError> {
    let mut kit = kit_of(modes, 0);
    if form == PadForm::Bank {
        // Too short a choke for frames keeps the pad in the bank. No event chokes it here.
        kit.pads[0].choke_t60_s = 0.01;
    }
    let mut sines = kit.clone();
    sines.objects[0].modes.iter_mut().for_each(|mode| mode.gains[0].cosine = 0.0);
    let [kit, sines] = [kit, sines].map(|kit| load(kit).binary);
    Ok([
        play_engine(chip, &kit, Drive::Strike, None, 60..92)?.mean,
        play_engine(chip, &kit, Drive::Strike, None, 0..60)?.dearest,
        play_engine(chip, &kit, Drive::Direct, None, 24..56)?.mean,
        play_engine(chip, &sines, Drive::Direct, None, 24..56)?.mean,
    ])
}

/// Cycles of a bank in frames to the stereo bus.
fn as_stage(chip: &mut FramesOnChip, modes: usize) -> Result<[f64; WAYS], OnChipError> {
    let modes = prior(modes, T60_S);
    chip.load(&modes, RATE)?;
    let struck = play_stage(chip, struck_once, 0..40)?;
    let ringing = play_stage(chip, |_| None, 0..32)?;
    let sines: Vec<HeardMode> = modes.iter().map(|mode| HeardMode { cosine: 0.0, ..*mode }).collect();
    let mut direct = |modes: &[HeardMode]| {
        chip.load(modes, RATE)?;
        Ok::<_, OnChipError>(play_stage(chip, |tick| Some(direct_force(tick)), 24..56)?.mean())
    };
    Ok([ringing.mean(), struck.dearest(), direct(&modes)?, direct(&sines)?])
}

/// Points where the cycles of frames fall below those of the bank, on straight lines between the
/// rows; at most one for each way to play.
fn crossings(rows: &[PadRow]) -> Vec<Crossing> {
    Play::ALL.into_iter().enumerate().filter_map(|(index, play)| crossing(rows, index, play)).collect()
}

fn crossing(rows: &[PadRow], index: usize, play: Play) -> Option<Crossing> {
    let curve = |form| curve(rows, form, index);
    let both: Vec<_> = curve(PadForm::Bank).into_iter().zip(curve(PadForm::Frames)).collect();
    let [below, above] = *both.windows(2).find(|pair| {
        let saved = |(bank, frames): ([f64; 2], [f64; 2])| bank[1] - frames[1];
        saved(pair[0]) <= 0.0 && saved(pair[1]) > 0.0
    })?
    else {
        return None;
    };
    let excess = below.1[1] - below.0[1];
    let share = excess / (excess + above.0[1] - above.1[1]);
    let between = |low: f64, high: f64| low + share * (high - low);
    Some(Crossing { play, modes: between(below.0[0], above.0[0]), cycles: between(below.0[1], above.0[1]) })
}

fn curve(rows: &[PadRow], form: PadForm, play: usize) -> Vec<[f64; 2]> {
    let of_form = rows.iter().filter(|row| row.form == form);
    of_form.map(|row| [f64::from(row.modes), row.cycles[play]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossing_lies_where_two_straight_lines_meet() {
        let row = |modes: u32, form, cycles: f64| PadRow { modes, form, is_whole_engine: true, cycles: [cycles; WAYS] };
        let rows: Vec<PadRow> = [50u32, 100, 200]
            .into_iter()
            .flat_map(|modes| {
                let bank = row(modes, PadForm::Bank, 5.0 * f64::from(modes));
                [bank, row(modes, PadForm::Frames, 300.0 + f64::from(modes))]
            })
            .collect();
        let found = crossings(&rows);
        assert_eq!(found.len(), WAYS);
        assert!(found.iter().all(|one| (one.modes, one.cycles) == (75.0, 375.0)), "{found:?}");
        assert_eq!(crossings(&rows[..2]), []);
    }
}
