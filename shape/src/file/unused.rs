//! Keys that the kind of body does not use: they are refused, as their numbers would be dropped.

use toml::de::{DeTable, DeValue};

use super::{FileError, Kind, Modulus, Readout, ShapeFile};

/// Key of `[shape]`, the kinds of body that use it, and what to do for others.
type Use = (&'static str, &'static [Kind], &'static str);

const USES: [Use; 8] = [
    (
        "polygon_m",
        &[Kind::Plate, Kind::Sheet, Kind::Membrane, Kind::Solid],
        "give profile_m, the corners of its profile as [radius, height]",
    ),
    ("profile_m", &[Kind::Revolve], "only a body of revolution has a profile; give polygon_m, or kind = \"revolve\""),
    ("split", &[Kind::Revolve], "only the pairs of a body of revolution are split; leave it out"),
    (
        "thickness_m",
        &[Kind::Plate, Kind::Sheet, Kind::Solid],
        "a body of revolution is as thick as its profile, and a membrane has density_kg_per_m2; leave it out",
    ),
    ("tension_n_per_m", &[Kind::Membrane], "only a membrane has a tension; leave it out, or give kind = \"membrane\""),
    (
        "density_kg_per_m2",
        &[Kind::Membrane],
        "only a membrane has a mass per area; give material.density_kg_per_m3 and thickness_m",
    ),
    ("plane", &[Kind::Sheet], "only a sheet has a state of plane stress or strain; leave it out"),
    ("surface", &[Kind::Solid], "only a solid has a surface; give kind = \"solid\", or polygon_m"),
];

/// Checks that the file has no key that its kind of body does not use.
pub(super) fn check(text: &str, file: &ShapeFile) -> Result<(), FileError> {
    let Ok(document) = DeTable::parse(text) else { return Ok(()) };
    // Line of a key, if the file has it.
    let line = |table: &str, key: &str| {
        let (_, value) = document.get_ref().iter().find(|(name, _)| name.get_ref().as_ref() == table)?;
        let DeValue::Table(table) = value.get_ref() else { return None };
        let (name, _) = table.iter().find(|(name, _)| name.get_ref().as_ref() == key)?;
        Some(text.get(..name.span().start)?.matches('\n').count() + 1)
    };
    let refuse = |table: &'static str, key: &'static str, of: &'static str, advice: &'static str| {
        line(table, key).map_or(Ok(()), |line| Err(FileError::Unused { line, table, key, of, advice }))
    };
    let (shape, kind) = (&file.shape, file.shape.kind);
    for (key, kinds, advice) in USES {
        if !kinds.contains(&kind) {
            refuse("shape", key, named(kind), advice)?;
        }
    }
    let is_drawn = shape.outline.is_some() || shape.surface.is_some();
    if !is_drawn {
        refuse("shape", "unit_m", "a body with corners in metres", "it is the unit of an outline or a surface")?;
    } else {
        refuse("shape", "holes_m", "a body with a file", "draw its holes into the file")?;
    }
    let named_moduli = file.material.named()?.map(|named| &named.youngs_modulus_pa);
    let moduli = file.material.youngs_modulus_pa.as_ref().or(named_moduli);
    if matches!(moduli, Some(Modulus::All(_))) {
        let of = "a material that is alike in all directions";
        let advice = "it is for wood, whose youngs_modulus_pa has two numbers: along the grain and across it";
        refuse("material", "shear_modulus_pa", of, advice)?;
        refuse("material", "grain_deg", of, advice)?;
    }
    if file.sound.readout != Readout::Velocity {
        refuse("sound", "direction", "this readout", "only readout = \"velocity\" has a direction")?;
    }
    Ok(())
}

fn named(kind: Kind) -> &'static str {
    match kind {
        Kind::Plate => "a plate",
        Kind::Sheet => "a sheet",
        Kind::Membrane => "a membrane",
        Kind::Revolve => "a body of revolution",
        Kind::Solid => "a solid",
    }
}
