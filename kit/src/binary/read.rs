//! Conversion of the binary form to a kit.

use dsp_core::residual::ResidualBand;
use dsp_core::table::layout::{GainRecord, ModeRecord};
use dsp_core::table::{
    Background as BackgroundView, Object as ObjectView, Pad as PadView, Residual as ResidualView,
    Striker as StrikerView,
};
use dsp_core::trigger::Settings;

use crate::content::{
    Acceleration, Background, Gain, Kit, Mode, NoteOff, Object, Pad, Pulse, Residual, RoomBand, Striker,
};
use crate::error::KitError;

/// Reads a kit from its binary form, which erased flash (0xFF) may follow.
///
/// Two things are not in the result: sections that this version skips, which
/// [`crate::Loaded::skipped_sections`] lists, and the number of positions of an object without
/// modes.
///
/// # Errors
/// [`KitError::Binary`] with the first thing that [`dsp_core::table::Kit`] refuses.
pub fn read(bytes: &[u8]) -> Result<Kit, KitError> {
    let view = super::filters::parse(bytes)?;
    let mut objects: Vec<Object> = view.objects().map(object).collect();
    let mut strikers: Vec<Striker> = view.strikers().map(striker).collect();
    let mut pads: Vec<Pad> = view.pads().map(|pad| read_pad(pad, &objects, &strikers)).collect();
    for trigger in view.triggers() {
        if let Some(pad) = pads.get_mut(trigger.pad_index()) {
            pad.trigger = Some(Settings::of_table(&trigger));
        }
    }
    for residual in view.residuals() {
        if let Some(object) = objects.get_mut(residual.object_index()) {
            object.residual = Some(read_residual(residual));
        }
    }
    for (index, object) in objects.iter_mut().enumerate() {
        if view.is_balanced(index) {
            object.acceleration = Acceleration::Balance;
        }
    }
    super::filters::read(&view, &mut objects);
    let background = view.background().map(read_background);
    let room = view.room().iter().map(|band| RoomBand {
        from_hz: band.from_hz.get(),
        gain: band.gain.get(),
        decay_per_s: band.decay_per_s.get(),
    });
    let surfaces = super::surface::read(&view, &mut objects, &mut strikers);
    let (name, headphone_db) = (view.name().to_owned(), view.headphone_db());
    Ok(Kit { name, objects, strikers, pads, background, room: room.collect(), headphone_db, surfaces })
}

fn object(view: ObjectView<'_>) -> Object {
    Object {
        name: view.name().to_owned(),
        source: view.source().to_owned(),
        licence: view.licence().to_owned(),
        reference_force: view.reference_force(),
        acceleration: Acceleration::Factor(view.acceleration()),
        modes: modes(view.modes(), view.gains(), view.position_count()),
        residual: None,
        dynamic_filter: None,
        biquads: None,
        surface: None,
    }
}

fn read_residual(view: ResidualView<'_>) -> Residual {
    Residual {
        seed: view.seed(),
        edges_hz: edges_hz(view.bands()),
        weight: view.bands().map(|band| band.weight).collect(),
        decay_db_per_s: view.bands().map(|band| band.decay_db_per_s).collect(),
    }
}

fn read_background(view: BackgroundView<'_>) -> Background {
    Background {
        seed: view.seed(),
        edges_hz: edges_hz(view.bands()),
        weight: view.bands().map(|band| band.weight).collect(),
    }
}

fn edges_hz(mut bands: impl Iterator<Item = ResidualBand> + Clone) -> Vec<f32> {
    let uppers = bands.clone().map(|band| band.edges_hz[1]);
    bands.next().map(|band| band.edges_hz[0]).into_iter().chain(uppers).collect()
}

fn striker(view: StrikerView<'_>) -> Striker {
    Striker {
        name: view.name().to_owned(),
        source: view.source().to_owned(),
        licence: view.licence().to_owned(),
        pulse: if view.contact().is_gaussian() { Pulse::Gaussian } else { Pulse::Hertz },
        peak_force: view.contact().peak_force(),
        peak_exponent: view.contact().peak_exponent(),
        contact_time_s: view.contact().contact_time_s(),
        contact_exponent: view.contact().contact_exponent(),
        restitution: view.contact().restitution(),
        scrape: None,
        roll: None,
        modes: modes(view.modes(), view.gains(), 1),
    }
}

fn read_pad(view: PadView<'_>, objects: &[Object], strikers: &[Striker]) -> Pad {
    // The reader has checked the indices, so that neither default is ever used.
    let object = objects.get(view.object_index()).map(|object| object.name.clone()).unwrap_or_default();
    let strikers =
        view.striker_indices().filter_map(|index| strikers.get(index)).map(|striker| striker.name.clone()).collect();
    Pad {
        name: view.name().to_owned(),
        object,
        strikers,
        level_db: view.level_db(),
        pan: view.pan(),
        striker_weight: view.striker_weight(),
        choke_t60_s: view.choke_t60_s(),
        midi_notes: view.midi_notes().collect(),
        note_off: if view.note_off_chokes() { NoteOff::Choke } else { NoteOff::Nothing },
        trigger: None,
    }
}

fn modes(modes: &[ModeRecord], gains: &[GainRecord], positions: usize) -> Vec<Mode> {
    let gain = |gain: &GainRecord| Gain { sine: gain.sine.get(), cosine: gain.cosine.get() };
    modes
        .iter()
        .zip(gains.chunks_exact(positions.max(1)))
        .map(|(mode, gains)| Mode {
            frequency_hz: mode.frequency_hz.get(),
            decay_per_s: mode.decay_per_s.get(),
            gains: gains.iter().map(gain).collect(),
        })
        .collect()
}
