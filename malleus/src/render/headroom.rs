//! How loud the strikes of a kit are at velocity 1, rendered by the instrument without what clips
//! on the way, and the numbers that would fit.
//!
//! The instrument clips the force at 16 times the reference force, and its buses at +24 dBFS. What
//! is loud is rendered with `2^-k` of its forces, and counted `2^k` times: all that follows the
//! force is linear in it but for a dynamic filter's exciter, whose edges are moved against it. The
//! background is left out, the room is not.

use dsp_core::SampleRate;
use dsp_core::engine::{Skipping, TickReport};
use dsp_core::table::Kit;
use dsp_core::table::range::PEAK_FORCE;
use rayon::prelude::*;

use super::force;
use super::instrument::{Output, RenderError, Settings, render};
use super::level::Level;
use super::{Performance, strike};

/// Peak at velocity 1 of the levels that are proposed, dBFS.
pub const TARGET_DBFS: f64 = -6.0;
/// Largest force at velocity 1 in a kit whose reference forces are chosen, in reference forces:
/// four such strikes at once do not clip.
pub const LARGEST_FORCE: f64 = 4.0;

/// Seconds of a strike that are rendered, and how much of a dynamic filter's path at most.
const STRIKE_S: f64 = 1.0;
const LONGEST_S: f64 = 5.0;
/// Largest magnitude, 1.0 = full scale, that the buses are trusted with.
const TRUSTED: f64 = 4.0;

/// Why a kit's levels cannot be measured.
#[derive(Debug, thiserror::Error)]
pub enum HeadroomError {
    /// The kit is none.
    #[error(transparent)]
    Kit(#[from] kit::KitError),
    /// A kit that was built is not read back.
    #[error("{0}")]
    Table(dsp_core::table::TableError),
    /// The instrument cannot hold it.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A striker on a pad, at velocity 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loudness {
    /// The pad, counted from 0.
    pub pad: usize,
    /// Which of its strikers.
    pub striker: usize,
    /// Peak force in reference forces, what a piezo's direct force may add to it included.
    pub force: f64,
    /// Where along the object it is loudest, 0 to 1: one of the positions at which gains are given,
    /// between which the sound is a mean.
    pub position: f32,
    /// Peak of the sound there, 1.0 = full scale.
    pub peak: f64,
}

impl Loudness {
    /// Whether the force bus clips this strike.
    pub fn overloads_force(&self) -> bool {
        self.force > force::FORCE_BUS_END
    }

    /// Whether the output clips this strike.
    pub fn clips(&self) -> bool {
        self.peak > 1.0
    }
}

/// Strikes to be rendered to measure a kit.
pub fn strike_count(kit: &kit::Kit) -> usize {
    strikes(kit).len()
}

/// Each striker on each pad, alone, at the position where it is loudest. `progress` is told of
/// every strike that has been rendered.
///
/// # Errors
/// [`HeadroomError`].
pub fn of_strikes(
    kit: &kit::Kit,
    rate: SampleRate,
    progress: impl Fn() + Sync,
) -> Result<Vec<Loudness>, HeadroomError> {
    let peaks: Result<Vec<Loudness>, HeadroomError> = strikes(kit)
        .into_par_iter()
        .map(|(pad, striker, position)| {
            let alone = alone(kit, pad);
            let frames = (seconds(&alone) * rate.hz()) as usize;
            let events = vec![strike(0, striker as u8, position)];
            let performance = Performance { events, direct: None, frames };
            let peak = unclipped_peak(&alone, &performance, rate)?;
            progress();
            Ok(Loudness { pad, striker, force: force_of(kit, pad, striker), position, peak })
        })
        .collect();
    let mut loudest: Vec<Loudness> = Vec::new();
    for one in peaks? {
        match loudest.last_mut().filter(|last| (last.pad, last.striker) == (one.pad, one.striker)) {
            Some(last) if one.peak > last.peak => *last = one,
            Some(_) => {}
            None => loudest.push(one),
        }
    }
    Ok(loudest)
}

/// Peak of a kit's loudest [chord](Performance::chord), 1.0 = full scale.
///
/// # Errors
/// [`HeadroomError`].
pub fn of_chord(kit: &kit::Kit, rate: SampleRate) -> Result<f64, HeadroomError> {
    let kit = kit::Kit { background: None, ..kit.clone() };
    let chord = Performance::chord(kit.pads.len(), (seconds(&kit) * rate.hz()) as usize);
    unclipped_peak(&kit, &chord, rate)
}

/// The reference force with which an object's hardest strikes do not clip: their peak force, so
/// that the bus stands at 1.0. `None` where they do not come near the bus's end, and where nobody
/// strikes the object.
pub fn fitting_reference_force(kit: &kit::Kit, object: &str, largest_force: f64) -> Option<f32> {
    let pads = kit.pads.iter().filter(|pad| pad.object == object);
    let struck = pads.flat_map(|pad| (0..pad.strikers.len()).filter_map(|index| force::bound(kit, pad, index)));
    let hardest = struck.max_by(|(a, _), (b, _)| a.peak_force.total_cmp(&b.peak_force));
    hardest
        .filter(|(striker, object)| force::peak(striker, object) > largest_force)
        .map(|(striker, _)| striker.peak_force)
}

/// The level, in dB and rounded down to tenths, with which a pad of that level and peak peaks at
/// [`TARGET_DBFS`]; as it is for silence.
pub fn fitting_level_db(level_db: f32, peak: f64) -> f32 {
    if peak <= 0.0 {
        return level_db;
    }
    let level_db = f64::from(level_db) + TARGET_DBFS - 20.0 * peak.log10();
    ((level_db * 10.0).floor() / 10.0).clamp(-120.0, 40.0) as f32
}

/// All (pad, striker, position) that can be loudest.
fn strikes(kit: &kit::Kit) -> Vec<(usize, usize, f32)> {
    let positions = |pad: &kit::Pad| {
        let object = kit.objects.iter().find(|object| object.name == pad.object);
        object.map_or(1, kit::Object::position_count)
    };
    let of_pad = |(index, pad): (usize, &kit::Pad)| {
        let count = positions(pad);
        let place = move |position: usize| position as f32 / (count.max(2) - 1) as f32;
        let strikers = 0..pad.strikers.len();
        strikers.flat_map(move |striker| (0..count).map(move |position| (index, striker, place(position))))
    };
    kit.pads.iter().enumerate().flat_map(of_pad).collect()
}

/// Peak force of a striker on a pad; a pad that a piezo drives directly may have its force on top.
fn force_of(kit: &kit::Kit, pad: usize, striker: usize) -> f64 {
    let Some(pad) = kit.pads.get(pad) else { return 0.0 };
    let direct = pad.trigger.filter(|trigger| trigger.mode == dsp_core::trigger::Mode::Direct);
    let direct = direct.map_or(0.0, |trigger| f64::from(trigger.direct_gain));
    direct + force::bound(kit, pad, striker).map_or(0.0, |(striker, object)| force::peak(striker, object))
}

/// One pad of a kit and what it needs, in the kit's room.
fn alone(kit: &kit::Kit, pad: usize) -> kit::Kit {
    let pads: Vec<kit::Pad> = kit.pads.get(pad).into_iter().cloned().collect();
    let objects = kit.objects.iter().filter(|object| pads.iter().any(|pad| pad.object == object.name));
    let strikers = kit.strikers.iter().filter(|striker| pads.iter().any(|pad| pad.strikers.contains(&striker.name)));
    kit::Kit {
        name: kit.name.clone(),
        objects: objects.cloned().collect(),
        strikers: strikers.cloned().collect(),
        pads,
        background: None,
        room: kit.room.clone(),
    }
}

/// How long a kit's strikes are rendered.
fn seconds(kit: &kit::Kit) -> f64 {
    let filters = kit.objects.iter().filter_map(|object| object.dynamic_filter.as_ref());
    let longest = filters.map(kit::DynamicFilter::duration_s).fold(0.0, f64::max);
    (STRIKE_S + longest).min(LONGEST_S)
}

/// Peak of a performance at velocity 1 without what clips, 1.0 = full scale.
fn unclipped_peak(kit: &kit::Kit, performance: &Performance, rate: SampleRate) -> Result<f64, HeadroomError> {
    let pads = || kit.pads.iter().enumerate().flat_map(|(index, pad)| (0..pad.strikers.len()).map(move |n| (index, n)));
    let hardest = pads().map(|(pad, striker)| force_of(kit, pad, striker)).fold(0.0, f64::max);
    // Below 1.0 on the force bus.
    let mut halvings = hardest.log2().ceil().max(0.0) as i32;
    loop {
        let quiet = quietened(kit, halvings);
        let binary = kit::binary::build(&quiet)?;
        let table = Kit::parse(&binary).map_err(HeadroomError::Table)?;
        let settings = Settings { rate, block: 128, skipping: Skipping::On, budget_cycles: None };
        let mut refused = 0;
        let observe = |report: &TickReport| refused += report.refused_inputs;
        let bus = render(&table, performance, settings, Output::Bus, observe)?;
        let peak = Level::of_bus(&bus).peak;
        // Before a pad's level and pan its bus may stand much higher.
        let quietest = quiet.pads.iter().map(loudest_side).fold(1.0, f64::min);
        if refused == 0 && peak <= TRUSTED * quietest || halvings >= MOST_HALVINGS {
            return Ok(peak * f64::from(halvings).exp2());
        }
        halvings += 4;
    }
}

/// Halvings of the force after which a peak is taken as it is: 180 dB.
const MOST_HALVINGS: i32 = 30;

/// Gain of the louder side of a pad.
fn loudest_side(pad: &kit::Pad) -> f64 {
    let angle = (f64::from(pad.pan) + 1.0) * std::f64::consts::FRAC_PI_4;
    10f64.powf(f64::from(pad.level_db) / 20.0) * angle.cos().max(angle.sin())
}

/// A kit whose strikes have `2^-halvings` of their force, and sound so much softer, but no other.
fn quietened(kit: &kit::Kit, halvings: i32) -> kit::Kit {
    let mut kit = kit.clone();
    for striker in &mut kit.strikers {
        striker.peak_force = (striker.peak_force * (-halvings as f32).exp2()).max(PEAK_FORCE.min);
    }
    for object in &mut kit.objects {
        let Some(exciter) = object.dynamic_filter.as_mut().and_then(|filter| filter.exciter.as_mut()) else { continue };
        let moved = (halvings as f32 * exciter.exponent).exp2();
        (exciter.low_hz, exciter.high_hz) = (exciter.low_hz * moved, exciter.high_hz * moved);
    }
    kit
}
