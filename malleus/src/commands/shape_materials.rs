//! `malleus shape --materials`: the shipped materials with the sources of their numbers.

use ::shape::file::{Modulus, NamedMaterial, materials};

use super::error::CommandError;
use super::output::{print, print_json};

pub(super) fn run(is_json: bool) -> Result<(), CommandError> {
    if is_json { print_json(materials()) } else { print(&as_text()) }
}

fn as_text() -> String {
    let mut text = String::from("material       kg/m3  modulus GPa  poisson  damping, and source\n");
    for (name, material) in materials() {
        let modulus = match &material.youngs_modulus_pa {
            Modulus::All(modulus) => format!("{:.1}", modulus / 1e9),
            Modulus::Grain([along, across]) => format!("{:.1}, {:.1}", along / 1e9, across / 1e9),
        };
        text += &format!(
            "{name:13} {:6.0}  {modulus:>11}  {:7.2}  {}\n{:43}{}\n",
            material.density_kg_per_m3,
            material.poisson,
            damping(material),
            "",
            material.source
        );
    }
    text
}

fn damping(material: &NamedMaterial) -> String {
    match material.loss_factor {
        Some(factor) => format!("loss factor {factor}"),
        None => format!("alpha {} 1/s, beta {:e} s", material.rayleigh_alpha_per_s, material.rayleigh_beta_s),
    }
}
