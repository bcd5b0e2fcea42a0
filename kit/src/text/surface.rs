//! Text of surfaces, and of strikers that scrape and roll.

use std::fmt::{self, Display, Formatter};

use toml::Spanned;

use super::number::shortest_decimal;
use super::pair::Pair;
use crate::surface::{Roll, Scrape, Surface};

/// Table `[[surface]]`.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceTable {
    pub(super) name: Spanned<String>,
    #[serde(default)]
    pub(super) source: String,
    #[serde(default)]
    pub(super) licence: String,
    pub(super) step_m: f32,
    #[serde(default = "one")]
    pub(super) rows: usize,
    pub(super) unit_m: f32,
    pub(super) shortest_m: f32,
    pub(super) heights: Vec<i16>,
}

impl SurfaceTable {
    pub(super) fn read(self) -> Surface {
        let Self { name, source, licence, step_m, rows, unit_m, shortest_m, heights } = self;
        Surface { name: name.into_inner(), source, licence, step_m, rows, unit_m, shortest_m, heights }
    }
}

/// Table `[[surface_of]]`: surface of an object of an included file.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceOfTable {
    pub(super) object: String,
    pub(super) surface: String,
    #[serde(default = "usual_size_m")]
    pub(super) size_m: Pair,
    #[serde(default)]
    pub(super) surface_level_db: f32,
}

/// Size in metres of an object with a surface that does not give its own.
pub(super) fn usual_size_m() -> Pair {
    Pair([0.2, 0.2])
}

/// Table `[striker.scrape]`.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ScrapeTable {
    mass_kg: f32,
    slope_gain: Option<f32>,
    slope_exponent: Option<f32>,
    alpha_min_m: Option<f32>,
    alpha_max_m: Option<f32>,
    alpha_exponent: Option<f32>,
    smoothing_s: Option<f32>,
    tilt_rad: Option<f32>,
    friction: Option<f32>,
}

impl ScrapeTable {
    pub(super) fn read(self) -> Scrape {
        Scrape {
            mass_kg: self.mass_kg,
            slope_gain: self.slope_gain.unwrap_or(Scrape::DEFAULT_SLOPE_GAIN),
            slope_exponent: self.slope_exponent.unwrap_or(1.0),
            alpha_min_m: self.alpha_min_m,
            alpha_max_m: self.alpha_max_m,
            alpha_exponent: self.alpha_exponent.unwrap_or(Scrape::DEFAULT_ALPHA_EXPONENT),
            smoothing_s: self.smoothing_s.unwrap_or(Scrape::DEFAULT_SMOOTHING_S),
            tilt_rad: self.tilt_rad.unwrap_or(Scrape::DEFAULT_TILT_RAD),
            friction: self.friction.unwrap_or(Scrape::DEFAULT_FRICTION),
        }
    }
}

/// Table `[striker.roll]`.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RollTable {
    radius_m: f32,
    offset_m: Option<f32>,
    stiffness: Option<f32>,
    dissipation: Option<f32>,
    modulation: Option<f32>,
    slip: Option<f32>,
}

impl RollTable {
    pub(super) fn read(self) -> Roll {
        Roll {
            radius_m: self.radius_m,
            offset_m: self.offset_m.unwrap_or(Roll::DEFAULT_OFFSET_M),
            stiffness: self.stiffness.unwrap_or(Roll::DEFAULT_STIFFNESS),
            dissipation: self.dissipation.unwrap_or(Roll::DEFAULT_DISSIPATION),
            modulation: self.modulation.unwrap_or(Roll::DEFAULT_MODULATION),
            slip: self.slip.unwrap_or(Roll::DEFAULT_SLIP),
        }
    }
}

fn one() -> usize {
    1
}

/// Wrapper of a value that is written as TOML.
pub(super) struct Text<T>(pub(super) T);

impl Display for Text<&Scrape> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let scrape = self.0;
        writeln!(f, "\n[striker.scrape]\nmass_kg = {}", shortest_decimal(scrape.mass_kg))?;
        writeln!(
            f,
            "slope_gain = {}\nslope_exponent = {}",
            shortest_decimal(scrape.slope_gain),
            shortest_decimal(scrape.slope_exponent)
        )?;
        scrape.alpha_min_m.iter().try_for_each(|alpha| writeln!(f, "alpha_min_m = {}", shortest_decimal(*alpha)))?;
        scrape.alpha_max_m.iter().try_for_each(|alpha| writeln!(f, "alpha_max_m = {}", shortest_decimal(*alpha)))?;
        writeln!(
            f,
            "alpha_exponent = {}\nsmoothing_s = {}",
            shortest_decimal(scrape.alpha_exponent),
            shortest_decimal(scrape.smoothing_s)
        )?;
        writeln!(
            f,
            "tilt_rad = {}\nfriction = {}",
            shortest_decimal(scrape.tilt_rad),
            shortest_decimal(scrape.friction)
        )
    }
}

impl Display for Text<&Roll> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let roll = self.0;
        writeln!(
            f,
            "\n[striker.roll]\nradius_m = {}\noffset_m = {}",
            shortest_decimal(roll.radius_m),
            shortest_decimal(roll.offset_m)
        )?;
        writeln!(
            f,
            "stiffness = {}\ndissipation = {}",
            shortest_decimal(roll.stiffness),
            shortest_decimal(roll.dissipation)
        )?;
        writeln!(f, "modulation = {}\nslip = {}", shortest_decimal(roll.modulation), shortest_decimal(roll.slip))
    }
}
