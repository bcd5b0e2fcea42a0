//! One pad with many modes on the virtual core: in the whole engine, and as a stage in frames.

use std::ops::Range;

use dsp_core::SampleRate;
use dsp_core::engine::Direct;
use dsp_core::event::{Event, Time};
use dsp_core::resonator::TICK_FRAMES;

use super::scenes::SceneCost;
use super::{EngineOnChip, FramesOnChip, OnChipError};
use crate::frames::{HeardMode, contact, prior};
use crate::scene::{mode, one_pad};

/// Sample rate at which a lone pad is played.
pub const RATE: SampleRate = SampleRate::HZ_44100;

/// Bounds of the modes' T60, in seconds. All modes ring on throughout a measurement.
pub const T60_S: [f64; 2] = [3.0, 20.0];

/// Kit of a pad with a prior's modes, and with noise in bands if there are any.
///
/// The engine plays 184 modes and more in frames.
pub fn kit_of(modes: usize, bands: usize) -> kit::Kit {
    let rate_hz = RATE.hz();
    let record =
        |heard: &HeardMode| mode(heard.frequency_hz, heard.t60_s, rate_hz * heard.sine, rate_hz * heard.cosine);
    let mut kit = one_pad(prior(modes, T60_S).iter().map(record).collect());
    kit.objects[0].reference_force = 1.0;
    kit.pads[0].level_db = -20.0;
    let edge = |band: usize| (40.0 * (20_000f64 / 40.0).powf(band as f64 / bands as f64)) as f32;
    if bands > 0 {
        kit.objects[0].residual = Some(kit::Residual {
            seed: 1,
            edges_hz: (0..=bands).map(edge).collect(),
            weight: vec![0.001; bands],
            decay_db_per_s: vec![30.0; bands],
        });
    }
    kit
}

/// Drive of a pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// One strike at frame 300.
    Strike,
    /// Strikes from frame 300 on, at this distance in frames.
    Strikes(u64),
    /// Force of [`direct_force`], which never rests.
    Direct,
}

/// Scenes of a lone pad: name, drive, measured ticks.
pub const SCENES: [(&str, Drive, Range<usize>); 4] = [
    ("ringing", Drive::Strike, 60..92),
    ("a strike", Drive::Strike, 0..60),
    ("a strike each ms", Drive::Strikes(44), 24..88),
    ("direct force", Drive::Direct, 24..56),
];

/// Cycles a frame of some ticks of a lone pad.
#[derive(Clone, Copy, Debug, Default)]
pub struct PadCycles {
    /// Nominal cycles a frame, the mean of the ticks.
    pub mean: f64,
    /// Nominal cycles a frame of the dearest tick.
    pub dearest: f64,
    /// Cycles a frame with the waits of flash at 168 MHz, the mean of the ticks.
    pub mean_with_flash: f64,
    /// Cycles a frame of the dearest tick with the waits of flash at 168 MHz.
    pub dearest_with_flash: f64,
    /// Cycles a frame that a budget predicts, the mean of the ticks; 0 without a budget.
    pub predicted: f64,
}

/// Force of a tick in bus steps that is not 0 at any frame.
pub fn direct_force(tick: usize) -> Vec<i32> {
    (0..TICK_FRAMES).map(|n| (n * 9999 + tick * 77) as i32 * 50 + 1).collect()
}

/// Force of a tick in bus steps for one contact of 44 frames that begins at frame 0.
pub fn struck_once(tick: usize) -> Option<Vec<i32>> {
    let mut force: Vec<i32> = contact(44).into_iter().skip(tick * TICK_FRAMES).take(TICK_FRAMES).collect();
    force.resize(TICK_FRAMES, 0);
    (tick < 2).then_some(force)
}

/// Plays ticks of a kit's first pad in the engine, from a load to the end of the range.
///
/// Gives the cycles of the ticks in the range. The budget is in cycles a tick; the engine has none
/// for `None`.
///
/// # Errors
/// [`OnChipError`].
pub fn play_engine(
    chip: &mut EngineOnChip,
    kit: &[u8],
    drive: Drive,
    budget: Option<u32>,
    ticks: Range<usize>,
) -> Result<PadCycles, OnChipError> {
    chip.load(kit, RATE)?;
    if let Some(budget) = budget {
        chip.set_budget(budget)?;
    }
    let end = (ticks.end * TICK_FRAMES) as u64;
    let strikes: Vec<u64> = match drive {
        Drive::Strike => vec![300],
        Drive::Strikes(every) => (300..end).step_by(every as usize).collect(),
        Drive::Direct => vec![],
    };
    let mut played = PadCycles::default();
    for tick in 0..ticks.end {
        let frames = (tick * TICK_FRAMES) as u64..((tick + 1) * TICK_FRAMES) as u64;
        let events: Vec<Event> = (strikes.iter().filter(|&at| frames.contains(at)))
            .map(|&frame| Event { time: Time::at_frame(frame), velocity: 0.8, ..Event::default() })
            .collect();
        let force = direct_force(tick);
        let direct = (drive == Drive::Direct).then_some(Direct { pad: 0, force: &force });
        let (_, call) = chip.render(&events, direct, TICK_FRAMES)?;
        if ticks.contains(&tick) {
            let [nominal, with_flash] =
                [call.cost.nominal, call.cost.with_flash()].map(|cycles| cycles as f64 / TICK_FRAMES as f64);
            let predicted = f64::from(chip.told()?.predicted_cycles) / TICK_FRAMES as f64;
            for (sum, one) in [
                (&mut played.mean, nominal),
                (&mut played.mean_with_flash, with_flash),
                (&mut played.predicted, predicted),
            ] {
                *sum += one / ticks.len() as f64;
            }
            played.dearest = played.dearest.max(nominal);
            played.dearest_with_flash = played.dearest_with_flash.max(with_flash);
        }
    }
    Ok(played)
}

/// Renders ticks of a bank in frames as it stands, up to the end of the range; gives the cost of
/// the ticks in the range.
///
/// # Errors
/// [`OnChipError`].
pub fn play_stage(
    chip: &mut FramesOnChip,
    force: impl Fn(usize) -> Option<Vec<i32>>,
    ticks: Range<usize>,
) -> Result<SceneCost, OnChipError> {
    let mut played = SceneCost::default();
    for tick in 0..ticks.end {
        let (_, cost) = chip.render(force(tick).as_deref(), TICK_FRAMES)?;
        if ticks.contains(&tick) {
            played.add(cost);
        }
    }
    Ok(played)
}
