//! `malleus kit new`: a kit whose pads play the objects of tables, at levels that do not clip.

use std::path::{Path, PathBuf};

use clap::CommandFactory;
use clap::error::ErrorKind;
use dsp_core::SampleRate;
use kit::counting::counted;
use malleus::render::headroom::{self, LARGEST_FORCE, LARGEST_OWN, Loudness};

use super::error::CommandError;
use super::kit_report::open;
use super::output::{has_extension, print, progress, refuse_input};
use crate::arguments::Arguments;

/// Maximum number of strikers of a pad.
const STRIKERS_PER_PAD: usize = dsp_core::table::layout::STRIKERS_PER_PAD;
/// Sample rate at which levels are measured.
const RATE: SampleRate = SampleRate::HZ_48000;

/// Writes a kit with one pad for each object of the tables, struck by the strikers of its table, or
/// by those of the tables together if it has none.
///
/// Without `output`, the first of the paths is the kit to write.
pub(super) fn run(tables: &[PathBuf], output: Option<&Path>, first_note: u8) -> Result<(), CommandError> {
    let (output, tables) = match (output, tables) {
        (Some(output), tables) => (output, tables),
        // Without -o the first path may be a table that was meant to be read.
        (None, [output, _, ..]) if output.exists() => {
            return Err(CommandError::KitExists { output: output.clone() });
        }
        (None, [output, tables @ ..]) if !tables.is_empty() => (output.as_path(), tables),
        (None, _) => Arguments::command()
            .error(
                ErrorKind::MissingRequiredArgument,
                "give at least one table and the kit to write: malleus kit new TABLE... -o KIT.toml",
            )
            .exit(),
    };
    refuse_input(output, tables.iter().map(PathBuf::as_path))?;
    let mut kit = bound(output, tables, first_note)?;
    set_reference_forces(&mut kit);
    // Refuses what a board would refuse, before anything is rendered or written.
    kit::binary::build(&kit)?;
    for (name, change_db) in set_levels(output, &mut kit) {
        eprintln!(
            "malleus: {}: gains of {name:?} are {:.1} dB lower than in its table: its own sound peaked above +12 dBFS before level_db, and \
             several strikes at once would clip there",
            output.display(),
            -change_db
        );
    }
    let binary = kit::binary::build(&kit)?;
    let text = (!has_extension(output, "bin")).then(|| kit::text::write(&kit));
    kit::file::write_whole(output, text.as_ref().map_or(&binary, |text| text.as_bytes()))?;
    let (pads, bytes) = (counted(kit.pads.len(), "pads"), binary.len());
    print(&format!("{}: {pads}, {bytes} bytes in binary\n", output.display()))
}

/// Kit of all objects, strikers and surfaces of the tables, with one pad per object at a level of
/// 0 dB.
fn bound(output: &Path, tables: &[PathBuf], first_note: u8) -> Result<kit::Kit, CommandError> {
    let name = output.file_stem().unwrap_or_default().to_string_lossy();
    let mut kit = kit::Kit { name: kit::item_name(&name, ""), ..kit::Kit::default() };
    let mut notes = (first_note..=127).map(|note| vec![note]);
    for table in tables {
        let mut loaded = open(&table.display().to_string())?;
        rename_clashes(&kit, &mut loaded.kit);
        let strikers = names(&loaded.kit.strikers);
        for object in &loaded.kit.objects {
            let Some(note) = notes.next() else {
                return Err(CommandError::NotesEnd { first_note, pads: usize::from(128 - first_note) });
            };
            kit.pads.push(pad(object, strikers.clone(), note));
        }
        loaded.kit.strikers.retain(|striker| !kit.strikers.contains(striker));
        loaded.kit.surfaces.retain(|surface| !kit.surfaces.contains(surface));
        // A table's room is that of its recording. A kit has one room, so that of several tables
        // none is taken.
        match tables.len() {
            1 => kit.room = loaded.kit.room,
            _ if loaded.kit.room.is_empty() => {}
            _ => eprintln!(
                "malleus: {}: the room of its recording is left out, since a kit of several tables has none",
                table.display()
            ),
        }
        kit.objects.extend(loaded.kit.objects);
        kit.strikers.extend(loaded.kit.strikers);
        kit.surfaces.extend(loaded.kit.surfaces);
    }
    if kit.objects.is_empty() {
        return Err(CommandError::NoObject);
    }
    if kit.strikers.is_empty() {
        return Err(CommandError::NoStriker);
    }
    let all = names(&kit.strikers);
    kit.pads.iter_mut().filter(|pad| pad.strikers.is_empty()).for_each(|pad| pad.strikers.clone_from(&all));
    Ok(kit)
}

/// Gives objects of a table, and strikers and surfaces that are not the same as those of a kit,
/// names that the kit does not have.
fn rename_clashes(kit: &kit::Kit, table: &mut kit::Kit) {
    let unused = |name: &str, is_used: &dyn Fn(&str) -> bool| {
        let numbered = (2..).map(|number| kit::item_name(name, &format!(" {number}")));
        std::iter::once(name.to_owned()).chain(numbered).find(|name| !is_used(name)).unwrap_or_default()
    };
    for object in &mut table.objects {
        object.name = unused(&object.name, &|name| kit.objects.iter().any(|other| other.name == name));
    }
    for striker in &mut table.strikers {
        if !kit.strikers.contains(striker) {
            striker.name = unused(&striker.name, &|name| kit.strikers.iter().any(|other| other.name == name));
        }
    }
    for surface in &mut table.surfaces {
        // A surface takes up to 64 KB: one that the kit has under another name is not taken twice.
        let is_same =
            |other: &&kit::Surface| kit::Surface { name: surface.name.clone(), ..(*other).clone() } == *surface;
        let name = match kit.surfaces.iter().find(is_same) {
            Some(same) => same.name.clone(),
            None => unused(&surface.name, &|name| kit.surfaces.iter().any(|other| other.name == name)),
        };
        let named = table.objects.iter_mut().filter_map(|object| object.surface.as_mut());
        named.filter(|own| own.surface == surface.name).for_each(|own| own.surface.clone_from(&name));
        surface.name = name;
    }
}

/// Kit of one table, ready to be played: each object on a pad that peaks at -6 dBFS.
pub(super) fn playable(table: kit::Kit, shown: &Path) -> Result<kit::Kit, CommandError> {
    let strikers = names(&table.strikers);
    let pads = table.objects.iter().map(|object| pad(object, strikers.clone(), vec![])).collect();
    let mut kit = kit::Kit { pads, ..table };
    set_reference_forces(&mut kit);
    kit::binary::build(&kit)?;
    set_levels(shown, &mut kit);
    Ok(kit)
}

/// Pad of an object at a level of 0 dB.
fn pad(object: &kit::Object, strikers: Vec<String>, midi_notes: Vec<u8>) -> kit::Pad {
    kit::Pad {
        name: object.name.clone(),
        object: object.name.clone(),
        strikers,
        level_db: 0.0,
        pan: 0.0,
        striker_weight: 1.0,
        choke_t60_s: 0.1,
        midi_notes,
        note_off: kit::NoteOff::Nothing,
        trigger: None,
    }
}

/// Names of the first strikers, as many as a pad may have.
fn names(strikers: &[kit::Striker]) -> Vec<String> {
    strikers.iter().take(STRIKERS_PER_PAD).map(|striker| striker.name.clone()).collect()
}

/// Raises the reference force of objects whose hardest striker comes near the end of the force bus.
///
/// The reference force becomes the peak force of that striker. The object sounds as before.
fn set_reference_forces(kit: &mut kit::Kit) {
    for index in 0..kit.objects.len() {
        let Some(object) = kit.objects.get(index) else { continue };
        let Some(newtons) = headroom::fitting_reference_force(kit, &object.name, LARGEST_FORCE) else { continue };
        let object = object.with_reference_force(newtons);
        if let Some(slot) = kit.objects.get_mut(index) {
            *slot = object;
        }
    }
}

/// Sets each pad's level so that its loudest striker peaks at -6 dBFS at velocity 1.
///
/// Gains of an object are lowered first if a pad's own sound comes near the end of its bus: no
/// level mends what is clipped before it. Returns names of such objects with the change in dB.
/// Levels stay at 0 dB if the instrument cannot render the kit.
fn set_levels(output: &Path, kit: &mut kit::Kit) -> Vec<(String, f64)> {
    let bar = progress(headroom::strike_count(kit) as u64, "choosing levels");
    let strikes = headroom::of_strikes(kit, RATE, || bar.inc(1));
    bar.finish_and_clear();
    match strikes {
        Ok(mut strikes) => {
            let lowered = lower_gains(kit, &mut strikes);
            for (index, pad) in kit.pads.iter_mut().enumerate() {
                let peaks = strikes.iter().filter(|strike| strike.pad == index).map(|strike| strike.peak);
                pad.level_db = headroom::fitting_level_db(pad.level_db, peaks.fold(0.0, f64::max));
            }
            lowered
        }
        Err(error) => {
            eprintln!("malleus: {}: levels stay at 0 dB: {error}", output.display());
            Vec::new()
        }
    }
}

/// Lowers the gains of objects whose pads' own sound comes near the end of its bus, and with them
/// the peaks of their strikes. Returns names of these objects with the change in dB.
fn lower_gains(kit: &mut kit::Kit, strikes: &mut [Loudness]) -> Vec<(String, f64)> {
    let mut all = Vec::new();
    for index in 0..kit.objects.len() {
        let Some(object) = kit.objects.get(index) else { continue };
        let name = object.name.clone();
        let Some(gain) = headroom::fitting_gain(kit, &name, strikes, LARGEST_OWN) else { continue };
        let lowered = object.with_gain(gain);
        if let Some(slot) = kit.objects.get_mut(index) {
            *slot = lowered;
        }
        for (index, pad) in kit.pads.iter_mut().enumerate().filter(|(_, pad)| pad.object == name) {
            pad.striker_weight = (f64::from(pad.striker_weight) * gain) as f32;
            for strike in strikes.iter_mut().filter(|strike| strike.pad == index) {
                (strike.peak, strike.own_peak) = (strike.peak * gain, strike.own_peak * gain);
            }
        }
        all.push((name, 20.0 * gain.log10()));
    }
    all
}
