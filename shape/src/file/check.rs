//! Checks of the numbers in a shape file.

use super::{FileError, Kind, Modulus, Readout, ShapeFile, unused};

/// Maximum number of positions that a table holds.
const MOST_POSITIONS: usize = 64;
/// Peak forces that a table holds, newtons.
const PEAK_FORCES_N: std::ops::RangeInclusive<f64> = 1e-6..=1e6;
/// Densities of materials from the lightest aerogel to above osmium, kg/m³.
const DENSITIES: std::ops::RangeInclusive<f64> = 1.0..=30_000.0;
const DENSITIES_TEXT: &str = "1 to 30000 kg/m3: is it in g/cm3? Steel has 7850";
/// Young's moduli of materials from gels to above diamond, Pa.
const MODULI: std::ops::RangeInclusive<f64> = 1e4..=2e12;
const MODULI_TEXT: &str = "1e4 to 2e12 Pa: is it in GPa or MPa? Steel has 200e9";
/// Shear moduli, Pa: rolling shear of wood is far below Young's modulus.
const SHEAR_MODULI: std::ops::RangeInclusive<f64> = 1e3..=2e12;
const SHEAR_MODULI_TEXT: &str = "1e3 to 2e12 Pa: is it in GPa or MPa? Spruce has 0.7e9";
/// Highest speed of sound in a rod, m/s: diamond has 17 000, fibres of carbon up to 25 000.
const FASTEST_M_PER_S: f64 = 30_000.0;
/// Share of a direction across a plate below which it lies in the plane.
const LEAST_ACROSS: f64 = 1e-6;
/// Contact times that a table holds, seconds.
const CONTACT_TIMES_S: std::ops::RangeInclusive<f64> = 2e-5..=0.1;

impl ShapeFile {
    pub(super) fn check(&self, text: &str) -> Result<(), FileError> {
        if self.format != 1 {
            return Err(FileError::Format(self.format));
        }
        unused::check(text, self)?;
        self.check_shape()?;
        self.check_material()?;
        self.check_strike()
    }

    fn check_shape(&self) -> Result<(), FileError> {
        let shape = &self.shape;
        let is_round = shape.kind == Kind::Revolve;
        if let Some(value) = shape.split.filter(|split| !(0.0..0.1).contains(split)) {
            return Err(FileError::Range { key: "shape.split", value, range: "0 or above, and below 0.1" });
        }
        let is_flat = shape.polygon_m.is_some() || shape.outline.is_some() || shape.thickness_m.is_some();
        if shape.surface.is_some() && is_flat {
            return Err(FileError::Keys("a solid has shape.surface, or an outline with thickness_m, not both"));
        }
        match (self.corners_m(), &shape.outline) {
            (None, None) if shape.surface.is_some() => {}
            (None, None) if shape.kind == Kind::Solid => {
                return Err(missing("shape.surface", "an STL or OBJ file, or polygon_m with thickness_m"));
            }
            (None, None) if is_round => return Err(missing("shape.profile_m", "the profile as [radius, height]")),
            (None, None) => return Err(missing("shape.polygon_m", "or outline, an SVG or PNG file")),
            (Some(_), Some(_)) => return Err(FileError::Keys("give corners or shape.outline, not both")),
            (None, Some(_)) if shape.unit_m.is_none() => {
                return Err(missing("shape.unit_m", "metres of a unit of the outline's file"));
            }
            _ => {}
        }
        positive("shape.unit_m", shape.unit_m)?;
        positive("shape.thickness_m", shape.thickness_m)?;
        positive("shape.tension_n_per_m", shape.tension_n_per_m)?;
        positive("shape.density_kg_per_m2", shape.density_kg_per_m2)?;
        if shape.kind == Kind::Membrane {
            if shape.tension_n_per_m.is_none() {
                return Err(missing("shape.tension_n_per_m", "the tension of the membrane"));
            }
            if shape.density_kg_per_m2.is_none() {
                return Err(missing("shape.density_kg_per_m2", "the mass of the membrane per area"));
            }
        } else if shape.thickness_m.is_none() && !is_round && shape.surface.is_none() {
            let what = "the thickness of the plate or solid, or the width of the sheet";
            return Err(missing("shape.thickness_m", what));
        }
        if self.support.edge.is_some() && self.support.edges.is_some() {
            return Err(FileError::Keys("support.edge and support.edges exclude each other"));
        }
        Ok(())
    }

    fn check_material(&self) -> Result<(), FileError> {
        let (material, is_membrane) = (&self.material, self.shape.kind == Kind::Membrane);
        let named = material.named()?;
        positive("material.density_kg_per_m3", material.density_kg_per_m3)?;
        positive("material.shear_modulus_pa", material.shear_modulus_pa)?;
        not_negative("material.rayleigh_alpha_per_s", material.rayleigh_alpha_per_s)?;
        not_negative("material.rayleigh_beta_s", material.rayleigh_beta_s)?;
        not_negative("material.loss_factor", material.loss_factor)?;
        let moduli = match &material.youngs_modulus_pa {
            None => vec![],
            Some(Modulus::All(modulus)) => vec![*modulus],
            Some(Modulus::Grain(moduli)) => moduli.to_vec(),
        };
        moduli.iter().try_for_each(|&modulus| positive("material.youngs_modulus_pa", Some(modulus)))?;
        plausible("material.density_kg_per_m3", material.density_kg_per_m3, DENSITIES, DENSITIES_TEXT)?;
        plausible("material.shear_modulus_pa", material.shear_modulus_pa, SHEAR_MODULI, SHEAR_MODULI_TEXT)?;
        moduli
            .iter()
            .try_for_each(|&modulus| plausible("material.youngs_modulus_pa", Some(modulus), MODULI, MODULI_TEXT))?;
        if let Some(value) = material.poisson {
            // Of wood the ratio along the grain may be above one half.
            let is_right =
                if moduli.len() == 2 { value * value * moduli[1] < moduli[0] } else { value > -1.0 && value < 0.5 };
            if !is_right {
                let range = "above -1 and below 0.5; of wood, its square below the ratio of the moduli";
                return Err(FileError::Range { key: "material.poisson", value, range });
            }
        }
        if named.is_none() && !is_membrane {
            if material.density_kg_per_m3.is_none() {
                return Err(missing("material.density_kg_per_m3", "or material.name"));
            }
            if moduli.is_empty() {
                return Err(missing("material.youngs_modulus_pa", "or material.name"));
            }
            if material.poisson.is_none() {
                return Err(missing("material.poisson", "or material.name"));
            }
        }
        if !is_membrane {
            self.check_speed()?;
        }
        if moduli.len() == 2 && material.shear_modulus_pa.is_none() {
            return Err(missing("material.shear_modulus_pa", "wood needs the shear modulus in its plane"));
        }
        let laws = [
            material.rayleigh_alpha_per_s.is_some() || material.rayleigh_beta_s.is_some(),
            material.loss_factor.is_some(),
            material.damping.is_some(),
        ];
        if laws.iter().filter(|&&is_given| is_given).count() > 1 {
            return Err(FileError::Keys("give one law of damping: rayleigh_*, loss_factor, or damping"));
        }
        if named.is_none() && !laws.contains(&true) {
            return Err(missing("material.rayleigh_alpha_per_s", "or loss_factor, damping, or material.name"));
        }
        Ok(())
    }

    /// Checks that sound is no faster than in any material.
    fn check_speed(&self) -> Result<(), FileError> {
        let named = self.material.named()?;
        let density = self.material.density_kg_per_m3.or(named.map(|named| named.density_kg_per_m3));
        let moduli = self.material.youngs_modulus_pa.as_ref().or(named.map(|named| &named.youngs_modulus_pa));
        let largest = moduli.map(|moduli| match moduli {
            Modulus::All(modulus) => *modulus,
            Modulus::Grain([along, across]) => along.max(*across),
        });
        let Some((density_kg_per_m3, modulus_pa)) = density.zip(largest) else { return Ok(()) };
        let speed = (modulus_pa / density_kg_per_m3).sqrt();
        if speed > FASTEST_M_PER_S {
            return Err(FileError::Speed { speed_km_per_s: 1e-3 * speed, density_kg_per_m3, modulus_pa });
        }
        Ok(())
    }

    fn check_strike(&self) -> Result<(), FileError> {
        if let Some(positions) = self.strike.positions.filter(|&count| count == 0 || count > MOST_POSITIONS) {
            return Err(FileError::Range { key: "strike.positions", value: positions as f64, range: "1 to 64" });
        }
        if let Some(value) = self.strike.peak_force_n.filter(|force| !PEAK_FORCES_N.contains(force)) {
            return Err(FileError::Range { key: "strike.peak_force_n", value, range: "0.000001 to 1000000" });
        }
        if let Some(value) = self.strike.contact_time_s.filter(|time| !CONTACT_TIMES_S.contains(time)) {
            return Err(FileError::Range { key: "strike.contact_time_s", value, range: "0.00002 to 0.1" });
        }
        if self.strike.path_m.as_ref().is_some_and(Vec::is_empty) {
            return Err(missing("strike.path_m", "the path has no point"));
        }
        let is_solid = self.shape.kind == Kind::Solid;
        let is_finite = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        let is_place =
            |numbers: &Vec<f64>| is_finite(numbers) && (numbers.len() == 2 || numbers.len() == 3 && is_solid);
        if !self.strike.path_m.iter().flatten().all(is_place) {
            return Err(FileError::Keys("strike.path_m has points of two numbers, on a solid of two or three"));
        }
        let is_in_plane = matches!(self.shape.kind, Kind::Sheet | Kind::Revolve);
        let length = if is_in_plane { 2 } else { 3 };
        let is_direction = |numbers: &&Vec<f64>| {
            is_finite(numbers) && numbers.len() == length && numbers.iter().any(|number| *number != 0.0)
        };
        let mut directions = self.strike.direction.iter().chain(&self.sound.direction);
        if !directions.all(|numbers| is_direction(&numbers)) {
            let text =
                "a direction has two numbers on a sheet and on a body of revolution, three on others, and one is not 0";
            return Err(FileError::Keys(text));
        }
        if matches!(self.shape.kind, Kind::Plate | Kind::Membrane) {
            let strike = self.strike.direction.as_deref().map(|numbers| ("strike.direction", numbers));
            let heard = self.sound.direction.as_deref().map(|numbers| ("sound.direction", numbers));
            for (key, numbers) in strike.into_iter().chain(heard) {
                let length = numbers.iter().map(|number| number * number).sum::<f64>().sqrt();
                if numbers.last().is_some_and(|across| across.abs() < LEAST_ACROSS * length) {
                    return Err(FileError::InPlane { key });
                }
            }
        }
        self.check_heard()
    }

    /// Checks the place of what is heard.
    fn check_heard(&self) -> Result<(), FileError> {
        let is_solid = self.shape.kind == Kind::Solid;
        if let (Readout::Pressure, Some(&[_, _, z])) = (self.sound.readout, self.sound.at_m.as_deref()) {
            let above_m =
                if self.shape.kind == Kind::Plate { self.shape.thickness_m.unwrap_or(0.0) / 2.0 } else { 0.0 };
            if z.is_nan() || z <= above_m {
                return Err(FileError::NotAbove { z, above_m });
            }
        }
        let places = self.sound.at_m.as_ref().map(Vec::len);
        match (self.sound.readout, places) {
            (Readout::Velocity, Some(3)) if self.shape.kind == Kind::Revolve || is_solid => Ok(()),
            (Readout::Velocity, Some(2)) | (Readout::Pressure, Some(3)) | (Readout::Even, None) => Ok(()),
            (Readout::Velocity, _) => Err(FileError::Keys("sound.at_m: the velocity is that of a point [x, y]")),
            (Readout::Pressure, _) => Err(FileError::Keys("sound.at_m: the pressure is that at a point [x, y, z]")),
            (Readout::Even, _) => Err(FileError::Keys("sound.at_m: give readout = \"velocity\" or \"pressure\" too")),
        }
    }
}

fn missing(key: &'static str, what: &'static str) -> FileError {
    FileError::Missing { key, what }
}

fn positive(key: &'static str, value: Option<f64>) -> Result<(), FileError> {
    match value {
        Some(value) if !(value > 0.0 && value.is_finite()) => Err(FileError::Range { key, value, range: "above 0" }),
        _ => Ok(()),
    }
}

fn plausible(
    key: &'static str,
    value: Option<f64>,
    values: std::ops::RangeInclusive<f64>,
    range: &'static str,
) -> Result<(), FileError> {
    match value {
        Some(value) if !values.contains(&value) => Err(FileError::Range { key, value, range }),
        _ => Ok(()),
    }
}

fn not_negative(key: &'static str, value: Option<f64>) -> Result<(), FileError> {
    match value {
        Some(value) if !(value >= 0.0 && value.is_finite()) => {
            Err(FileError::Range { key, value, range: "0 or above" })
        }
        _ => Ok(()),
    }
}
