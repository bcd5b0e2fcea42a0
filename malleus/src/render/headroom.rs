//! Peaks of a kit's strikes at velocity 1 as they would be without clipping, and levels that fit.
//!
//! The instrument clips the force at 16 times the reference force, and its buses at +24 dBFS. So a
//! loud strike is rendered with `2^-k` of its force, and its peak is multiplied by `2^k`: every
//! stage behind the force is linear in it except a dynamic filter's exciter, whose edges are moved
//! to make up for it. The background is left out; the kit's room is rendered.

use dsp_core::SampleRate;
use dsp_core::engine::{Setup, TickReport};
use dsp_core::table::Kit;
use dsp_core::table::range::PEAK_FORCE;
use rayon::prelude::*;

use super::force;
use super::instrument::{Output, RenderError, Settings, render};
use super::level::Level;
use super::part;
use super::performance::{Performance, strike};

/// Peak at velocity 1 with the levels that are proposed, in dBFS.
pub const TARGET_DBFS: f64 = -6.0;
/// Largest force at velocity 1 in a kit whose reference forces are chosen, in reference forces.
///
/// Four strikes of this force at once do not clip.
pub const LARGEST_FORCE: f64 = 4.0;

/// Peak of a pad's own sound, before its level, at which the sound is clipped: ±16 is +24 dBFS.
pub const OWN_END: f64 = 16.0;
/// Largest peak of a pad's own sound at velocity 1 in a kit whose gains are chosen.
///
/// Four strikes of this peak at once do not clip.
pub const LARGEST_OWN: f64 = 4.0;

/// Rendered length of a strike without a dynamic filter, in seconds.
const STRIKE_S: f64 = 1.0;
/// Longest rendered length of a strike, in seconds; a dynamic filter's path may last longer.
const LONGEST_S: f64 = 5.0;
/// Largest peak of a bus that is taken as not clipped, 1.0 = full scale; the bus ends at 16.
const TRUSTED: f64 = 4.0;

/// Reason for which a kit's levels cannot be measured.
#[derive(Debug, thiserror::Error)]
pub enum HeadroomError {
    /// The kit is invalid.
    #[error(transparent)]
    Kit(#[from] kit::KitError),
    /// The binary form of the kit, just built, cannot be read back.
    #[error("{0}")]
    Table(dsp_core::table::TableError),
    /// The instrument cannot render the kit.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// Force and peak of one striker on one pad at velocity 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loudness {
    /// Index of the pad, counted from 0.
    pub pad: usize,
    /// Index of the striker among the pad's strikers, counted from 0.
    pub striker: usize,
    /// Peak force in reference forces, with the most that a piezo's direct force may add.
    pub force: f64,
    /// Position along the object at which the strike is loudest, 0 to 1.
    ///
    /// It is one of the positions at which gains are given; between two of them the sound is a
    /// weighted mean of theirs.
    pub position: f32,
    /// Peak of the sound at that position, 1.0 = full scale.
    pub peak: f64,
    /// Largest peak of the pad's own sound, before its level and pan and without a room, as it
    /// would be without clipping, at any of the positions.
    pub own_peak: f64,
}

impl Loudness {
    /// True if the force bus clips this strike.
    pub fn overloads_force(&self) -> bool {
        self.force > force::FORCE_BUS_END
    }

    /// True if the pad's own sound is clipped before its level.
    pub fn overloads_pad(&self) -> bool {
        self.own_peak > OWN_END
    }

    /// True if the step to 24 bits clips this strike.
    pub fn clips(&self) -> bool {
        self.peak > 1.0
    }
}

/// Number of strikes that are rendered to measure a kit.
pub fn strike_count(kit: &kit::Kit) -> usize {
    strikes(kit).len()
}

/// Measures each striker on each pad, struck alone, at the position where it is loudest.
///
/// `progress` is called after every strike that has been rendered.
///
/// # Errors
/// [`HeadroomError`] if the kit is invalid or the instrument cannot render it.
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
            let dry_peak = match alone.room.is_empty() {
                true => peak,
                false => unclipped_peak(&kit::Kit { room: Vec::new(), ..alone.clone() }, &performance, rate)?,
            };
            let own_peak = dry_peak / alone.pads.first().map_or(1.0, loudest_side);
            progress();
            Ok(Loudness { pad, striker, force: force_of(kit, pad, striker), position, peak, own_peak })
        })
        .collect();
    let mut loudest: Vec<Loudness> = Vec::new();
    for one in peaks? {
        match loudest.last_mut().filter(|last| (last.pad, last.striker) == (one.pad, one.striker)) {
            Some(last) => {
                let own_peak = last.own_peak.max(one.own_peak);
                *last = Loudness { own_peak, ..if one.peak > last.peak { one } else { *last } };
            }
            None => loudest.push(one),
        }
    }
    Ok(loudest)
}

/// Peak of a kit's loudest [chord](Performance::chord), 1.0 = full scale.
///
/// # Errors
/// [`HeadroomError`] if the kit is invalid or the instrument cannot render it.
pub fn of_chord(kit: &kit::Kit, rate: SampleRate) -> Result<f64, HeadroomError> {
    let kit = kit::Kit { background: None, ..kit.clone() };
    let chord = Performance::chord(kit.pads.len(), (seconds(&kit) * rate.hz()) as usize);
    unclipped_peak(&kit, &chord, rate)
}

/// Reference force in newtons with which an object's hardest strike does not clip: its peak force,
/// so that the force bus peaks at 1.0.
///
/// Returns `None` if no strike at velocity 1 exceeds `largest_force`, in reference forces, or if no
/// pad plays the object.
pub fn fitting_reference_force(kit: &kit::Kit, object: &str, largest_force: f64) -> Option<f32> {
    let pads = kit.pads.iter().filter(|pad| pad.object == object);
    let struck = pads.flat_map(|pad| (0..pad.strikers.len()).filter_map(|index| force::bound(kit, pad, index)));
    let hardest = struck.max_by(|(a, _), (b, _)| a.peak_force.total_cmp(&b.peak_force));
    hardest
        .filter(|(striker, object)| force::peak(striker, object) > largest_force)
        .map(|(striker, _)| striker.peak_force)
}

/// Factor on an object's gains with which the own sound of each pad that plays it peaks at
/// [`LARGEST_OWN`]; `None` if none peaks above `largest`, 1.0 = full scale.
pub fn fitting_gain(kit: &kit::Kit, object: &str, strikes: &[Loudness], largest: f64) -> Option<f64> {
    let plays = |strike: &&Loudness| kit.pads.get(strike.pad).is_some_and(|pad| pad.object == object);
    let own_peak = strikes.iter().filter(plays).map(|strike| strike.own_peak).fold(0.0, f64::max);
    (own_peak > largest).then(|| LARGEST_OWN / own_peak)
}

/// Level in dB, rounded down to tenths, with which a pad peaks at [`TARGET_DBFS`].
///
/// `peak` is the pad's peak at `level_db`, 1.0 = full scale. A silent pad keeps its level.
pub fn fitting_level_db(level_db: f32, peak: f64) -> f32 {
    if peak <= 0.0 {
        return level_db;
    }
    let level_db = f64::from(level_db) + TARGET_DBFS - 20.0 * peak.log10();
    ((level_db * 10.0).floor() / 10.0).clamp(-120.0, 40.0) as f32
}

/// Every combination of pad, striker and position that can be the loudest.
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

/// Peak force of a striker on a pad, in reference forces.
///
/// For a pad that a piezo drives directly, the piezo's largest force is added.
fn force_of(kit: &kit::Kit, pad: usize, striker: usize) -> f64 {
    let Some(pad) = kit.pads.get(pad) else { return 0.0 };
    let direct = pad.trigger.filter(|trigger| trigger.mode == dsp_core::trigger::Mode::Direct);
    let direct = direct.map_or(0.0, |trigger| f64::from(trigger.direct_gain));
    direct + force::bound(kit, pad, striker).map_or(0.0, |(striker, object)| force::peak(striker, object))
}

/// Kit of one pad with its object, its strikers and the kit's room.
fn alone(kit: &kit::Kit, pad: usize) -> kit::Kit {
    let pads: Vec<kit::Pad> = kit.pads.get(pad).into_iter().cloned().collect();
    let objects = kit.objects.iter().filter(|object| pads.iter().any(|pad| pad.object == object.name));
    let strikers = kit.strikers.iter().filter(|striker| pads.iter().any(|pad| pad.strikers.contains(&striker.name)));
    part::without_surfaces(kit::Kit {
        name: kit.name.clone(),
        objects: objects.cloned().collect(),
        strikers: strikers.cloned().collect(),
        pads,
        background: None,
        room: kit.room.clone(),
        headphone_db: None,
        surfaces: Vec::new(),
    })
}

/// Rendered length of a kit's strikes, in seconds.
fn seconds(kit: &kit::Kit) -> f64 {
    let filters = kit.objects.iter().filter_map(|object| object.dynamic_filter.as_ref());
    let longest = filters.map(kit::DynamicFilter::duration_s).fold(0.0, f64::max);
    (STRIKE_S + longest).min(LONGEST_S)
}

/// Peak that a performance at velocity 1 would have without clipping, 1.0 = full scale.
fn unclipped_peak(kit: &kit::Kit, performance: &Performance, rate: SampleRate) -> Result<f64, HeadroomError> {
    let pads = || kit.pads.iter().enumerate().flat_map(|(index, pad)| (0..pad.strikers.len()).map(move |n| (index, n)));
    let hardest = pads().map(|(pad, striker)| force_of(kit, pad, striker)).fold(0.0, f64::max);
    // Enough to keep the force bus below 1.0.
    let mut halvings = hardest.log2().ceil().max(0.0) as i32;
    loop {
        let quiet = quietened(kit, halvings);
        let binary = kit::binary::build(&quiet)?;
        let table = Kit::parse(&binary).map_err(HeadroomError::Table)?;
        let settings = Settings { setup: Setup::new(rate), block: 128, budget_cycles: None };
        let mut refused = 0;
        let observe = |report: &TickReport| refused += report.refused_inputs;
        let bus = render(&table, performance, settings, Output::Bus, observe)?;
        let peak = Level::of_bus(&bus).peak;
        // A pad's own bus, before its level and pan, may stand much higher than the output.
        let quietest = quiet.pads.iter().map(loudest_side).fold(1.0, f64::min);
        if refused == 0 && peak <= TRUSTED * quietest || halvings >= MOST_HALVINGS {
            return Ok(peak * f64::from(halvings).exp2());
        }
        halvings += 4;
    }
}

/// Number of halvings of the force, 180 dB, after which a peak is taken as it is.
const MOST_HALVINGS: i32 = 30;

/// Gain of a pad's level and pan on its louder side.
fn loudest_side(pad: &kit::Pad) -> f64 {
    let angle = (f64::from(pad.pan) + 1.0) * std::f64::consts::FRAC_PI_4;
    10f64.powf(f64::from(pad.level_db) / 20.0) * angle.cos().max(angle.sin())
}

/// Kit whose strikes have `2^-halvings` of their force and sound softer by just that factor.
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
