//! Parts of a kit that are played alone, so that their sounds add up to the whole.
//!
//! A pad plays a direct force at one position and with its first striker. All stages of a force are
//! linear, so that a part for each position of the object, with the share of each force that falls
//! to it, and one for each striker with modes of its own make the whole.

/// Kit with a pad that a force drives; the sounds of all parts of a performance add up.
#[derive(Clone, Debug)]
pub struct Part {
    /// Kit whose pad has one position, and no modes of strikers beside the object's.
    pub kit: kit::Kit,
    /// Number of the pad, and its force in Q4.27 of the force bus.
    pub direct: (u8, Vec<i32>),
}

/// Number of positions of a pad's object.
pub(super) fn positions(kit: &kit::Kit, pad: &kit::Pad) -> usize {
    let object = kit.objects.iter().find(|object| object.name == pad.object);
    let gains = object.into_iter().flat_map(|object| &object.modes).map(|mode| mode.gains.len());
    gains.max().unwrap_or(1).max(1)
}

/// Share of a force at a position, 0 to 1, that falls to one of the object's evenly spaced ones.
pub(super) fn share(at: f64, position: usize, positions: usize) -> f64 {
    let along = at * positions.saturating_sub(1) as f64;
    (1.0 - (along - position as f64).abs()).max(0.0)
}

/// Kit whose pad's object has one of its positions alone; strikers have no modes, and nothing has a
/// surface.
pub(super) fn at_position(kit: &kit::Kit, pad: &kit::Pad, position: usize) -> kit::Kit {
    let mut part = without_own_modes(kit);
    let object = part.objects.iter_mut().find(|object| object.name == pad.object);
    for mode in object.into_iter().flat_map(|object| &mut object.modes) {
        mode.gains = mode.gains.get(position).or(mode.gains.first()).copied().into_iter().collect();
    }
    part
}

/// Kit whose pad sounds the modes of one of its strikers alone; `None` if that has none.
pub(super) fn of_striker(kit: &kit::Kit, pad: &kit::Pad, striker: usize) -> Option<kit::Kit> {
    let name = pad.strikers.get(striker)?;
    let own = kit.strikers.iter().find(|striker| striker.name == *name && !striker.modes.is_empty())?;
    let mut part = without_own_modes(kit);
    let object = part.objects.iter_mut().find(|object| object.name == pad.object)?;
    // The object's part has its acceleration sound; a balance holds for the striker's modes too.
    if object.acceleration != kit::Acceleration::Balance {
        object.acceleration = kit::Acceleration::NONE;
    }
    (object.residual, object.dynamic_filter, object.biquads) = (None, None, None);
    object.modes = own.modes.clone();
    for gain in object.modes.iter_mut().flat_map(|mode| &mut mode.gains) {
        (gain.sine, gain.cosine) = (gain.sine * pad.striker_weight, gain.cosine * pad.striker_weight);
    }
    Some(part)
}

fn without_own_modes(kit: &kit::Kit) -> kit::Kit {
    let mut part = without_surfaces(kit.clone());
    part.strikers.iter_mut().for_each(|striker| striker.modes.clear());
    part
}

/// Kit whose objects have no surfaces, and whose strikers neither scrape nor roll.
pub(super) fn without_surfaces(mut kit: kit::Kit) -> kit::Kit {
    kit.strikers.iter_mut().for_each(|striker| (striker.scrape, striker.roll) = (None, None));
    kit.objects.iter_mut().for_each(|object| object.surface = None);
    kit.surfaces.clear();
    kit
}
