//! Draws the pictures of docs/dynamic-filter-fits.md from the recordings in
//! ../shared/data/recordings.
//!
//! Run it by `cargo run -p malleus --example dynamic_filter_pictures`.

mod panels;

use std::error::Error;
use std::path::Path;

use fit::dynamic_filter::study::{Heard, Way, heard_in, resynthesis};
use fit::dynamic_filter::{Form, Model, mean_law};
use malleus::plot::{CurvesPicture, curves};

/// Materials that are compared, each with the name of its recording.
const RECORDINGS: [(&str, &str); 3] =
    [("wood", "wood_block_1"), ("ceramic", "ceramic_mug_1"), ("metal", "metal_agogo_1")];
/// Factors of the modes' frequencies, from a large object to a small one.
const SIZES: [f64; 5] = [0.5, 0.7, 1.0, 1.4, 2.0];

fn main() -> Result<(), Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let recordings = workspace.join("../shared/data/recordings");
    let images = workspace.join("docs/images");
    if !recordings.is_dir() {
        println!("{}: there are no recordings, so that nothing is drawn", recordings.display());
        return Ok(());
    }
    let mut heard: Vec<(&str, Heard)> = Vec::new();
    for (material, name) in RECORDINGS {
        heard.push((material, heard_in(&recordings.join(format!("{name}.wav")))?));
    }
    let draw = |name: &str, title: &str, remark: &str, panels| {
        let picture = CurvesPicture { title: title.to_owned(), remark: remark.to_owned(), panels };
        curves(&images.join(format!("dynamic_filter_{name}.png")), &picture)
    };

    let first: Vec<_> = heard
        .iter()
        .map(|(material, heard)| (*material, Way::Noise(Form::FirstOrder).model(heard, &|_| {}).path))
        .collect();
    draw(
        "coefficients",
        "The dynamic filter of wood, ceramic and metal",
        "b0(1 + z^-1)/(1 + a1 z^-1) that makes white noise decay as the recording does, by all bands (compare Fig. 9 to 11 of the paper)",
        panels::coefficients(&first),
    )?;

    let additive: Vec<Model> =
        heard.iter().map(|(_, heard)| Way::Additive(Form::SecondOrder).model(heard, &|_| {})).collect();
    let mut damping = Vec::new();
    for ((material, heard), additive) in heard.iter().zip(&additive) {
        let waveguide = Way::Waveguide(Form::SecondOrder).model(heard, &|_| {});
        let laws = [additive, &waveguide].map(|model| mean_law(&resynthesis(model, heard)));
        damping.push(panels::damping(material, heard, &laws));
    }
    draw(
        "damping",
        "Damping per Bark band",
        "Recording, and the mean of 4 resyntheses by noise through the dynamic filter (second order) with at most ten modes or loops",
        damping,
    )?;

    let [(_, wood), _, (_, metal)] = heard.as_slice() else { return Ok(()) };
    let [of_wood, _, of_metal] = additive.as_slice() else { return Ok(()) };
    draw(
        "material",
        "Material: the modes of wood with the curves of metal",
        "Frequencies and amplitudes of the wood block's modes; path of the filter and decays of the modes from the agogo",
        panels::material(wood, of_wood, metal, of_metal),
    )?;
    let sizes: Vec<(f64, Model)> = SIZES.iter().map(|size| (*size, panels::sized(of_metal, *size))).collect();
    draw(
        "size",
        "Size: the modes moved, the material kept",
        "The agogo's modes times a factor, its filter and its law of damping as they were",
        panels::sizes(metal, &sizes),
    )?;
    Ok(())
}
