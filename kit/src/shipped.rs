//! Kits that ship with Malleus, inside the program.

use std::io;

use crate::error::KitError;
use crate::file::FileError;
use crate::load::Loaded;
use crate::text::SourceText;

/// Shipped kit: its name and the text of its own file.
struct Shipped {
    name: &'static str,
    text: &'static str,
}

/// All shipped kits.
const KITS: &[Shipped] = &[
    Shipped { name: "demo", text: include_str!("../../tables/demo.toml") },
    Shipped { name: "recorded", text: include_str!("../../tables/recorded.toml") },
    Shipped { name: "filters", text: include_str!("../../tables/filters.toml") },
    Shipped { name: "scrapes", text: include_str!("../../tables/scrapes.toml") },
    Shipped { name: "priors", text: include_str!("../../tables/priors.toml") },
    Shipped { name: "shapes", text: include_str!("../../tables/shapes.toml") },
];

/// Tables that shipped kits include, each with the name of its file.
const TABLES: &[(&str, &str)] = &[
    ("marimba.toml", include_str!("../../tables/marimba.toml")),
    ("glockenspiel.toml", include_str!("../../tables/glockenspiel.toml")),
    ("bell.toml", include_str!("../../tables/bell.toml")),
    ("woodblock.toml", include_str!("../../tables/woodblock.toml")),
    ("claves.toml", include_str!("../../tables/claves.toml")),
    ("drum.toml", include_str!("../../tables/drum.toml")),
    ("mug.toml", include_str!("../../tables/mug.toml")),
    ("bowl.toml", include_str!("../../tables/bowl.toml")),
    ("pan.toml", include_str!("../../tables/pan.toml")),
    ("glass.toml", include_str!("../../tables/glass.toml")),
    ("plate.toml", include_str!("../../tables/plate.toml")),
    ("strikers.toml", include_str!("../../tables/strikers.toml")),
    ("scrapes/ceramic.toml", include_str!("../../tables/scrapes/ceramic.toml")),
    ("scrapes/acrylic.toml", include_str!("../../tables/scrapes/acrylic.toml")),
    ("scrapes/polycarbonate.toml", include_str!("../../tables/scrapes/polycarbonate.toml")),
    ("scrapes/polyethylene.toml", include_str!("../../tables/scrapes/polyethylene.toml")),
    ("scrapes/sanded-acrylic.toml", include_str!("../../tables/scrapes/sanded-acrylic.toml")),
    ("scrapes/vinyl.toml", include_str!("../../tables/scrapes/vinyl.toml")),
    ("scrapes/bass-wood.toml", include_str!("../../tables/scrapes/bass-wood.toml")),
    ("scrapes/poplar-wood.toml", include_str!("../../tables/scrapes/poplar-wood.toml")),
    ("scrapes/rough-wood.toml", include_str!("../../tables/scrapes/rough-wood.toml")),
    ("scrapes/sandpaper.toml", include_str!("../../tables/scrapes/sandpaper.toml")),
    ("recorded/bass-drum.toml", include_str!("../../tables/recorded/bass-drum.toml")),
    ("recorded/treble-drum.toml", include_str!("../../tables/recorded/treble-drum.toml")),
    ("recorded/bongo.toml", include_str!("../../tables/recorded/bongo.toml")),
    ("recorded/tabla.toml", include_str!("../../tables/recorded/tabla.toml")),
    ("recorded/marimba-low.toml", include_str!("../../tables/recorded/marimba-low.toml")),
    ("recorded/marimba.toml", include_str!("../../tables/recorded/marimba.toml")),
    ("recorded/xylophone.toml", include_str!("../../tables/recorded/xylophone.toml")),
    ("recorded/glockenspiel.toml", include_str!("../../tables/recorded/glockenspiel.toml")),
    ("recorded/handbell.toml", include_str!("../../tables/recorded/handbell.toml")),
    ("recorded/meditation-bell.toml", include_str!("../../tables/recorded/meditation-bell.toml")),
    ("recorded/wood-block.toml", include_str!("../../tables/recorded/wood-block.toml")),
    ("recorded/utensil-holder.toml", include_str!("../../tables/recorded/utensil-holder.toml")),
    ("recorded/ceramic-mug.toml", include_str!("../../tables/recorded/ceramic-mug.toml")),
    ("recorded/plastic-cup.toml", include_str!("../../tables/recorded/plastic-cup.toml")),
    ("priors/cymbal.toml", include_str!("../../tables/priors/cymbal.toml")),
    ("priors/claves.toml", include_str!("../../tables/priors/claves.toml")),
    ("priors/glass.toml", include_str!("../../tables/priors/glass.toml")),
    ("shapes/drum.toml", include_str!("../../tables/shapes/drum.toml")),
    ("shapes/heart-drum.toml", include_str!("../../tables/shapes/heart-drum.toml")),
    ("shapes/marimba.toml", include_str!("../../tables/shapes/marimba.toml")),
    ("shapes/vibraphone.toml", include_str!("../../tables/shapes/vibraphone.toml")),
    ("shapes/glockenspiel.toml", include_str!("../../tables/shapes/glockenspiel.toml")),
    ("shapes/bell.toml", include_str!("../../tables/shapes/bell.toml")),
    ("shapes/gong.toml", include_str!("../../tables/shapes/gong.toml")),
    ("shapes/cymbal.toml", include_str!("../../tables/shapes/cymbal.toml")),
    ("shapes/glass.toml", include_str!("../../tables/shapes/glass.toml")),
    ("shapes/woodblock.toml", include_str!("../../tables/shapes/woodblock.toml")),
    ("shapes/cowbell.toml", include_str!("../../tables/shapes/cowbell.toml")),
];

/// Names of the shipped kits.
pub fn shipped_names() -> impl Iterator<Item = &'static str> {
    KITS.iter().map(|kit| kit.name)
}

/// Reads the shipped kit of a name; `None` if there is none of that name.
///
/// # Errors
/// The errors of [`crate::text::parse`]; the kits as they ship have none.
pub fn shipped(name: &str) -> Option<Result<Loaded, KitError>> {
    let kit = KITS.iter().find(|kit| kit.name == name)?;
    let main = SourceText { file: format!("tables/{name}.toml"), text: kit.text.to_owned() };
    Some(Loaded::from_text(&main, |include| match TABLES.iter().find(|(file, _)| *file == include) {
        Some((file, text)) => Ok(SourceText { file: format!("tables/{file}"), text: (*text).to_owned() }),
        None => Err(KitError::File(FileError {
            action: "read",
            path: include.into(),
            cause: io::ErrorKind::NotFound.into(),
        })),
    }))
}
