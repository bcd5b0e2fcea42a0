//! Objects from measured modes: `modes_tdw.csv` (Traer et al. 2019 by way of the tdw package,
//! BSD-2-Clause).

use std::path::Path;

use kit::{Acceleration, Object};

use crate::failure::Failure;
use crate::level::{Contact, mode};

/// Measured mode: a row of the file.
#[derive(Clone, Debug)]
pub(crate) struct Measured {
    material: String,
    size: u32,
    frequency_hz: f64,
    onset_power_db: f64,
    rt60_s: f64,
}

impl Measured {
    /// True if `other` has equal numbers under another material's name.
    fn is_also_of_another(&self, other: &Self) -> bool {
        let row = |mode: &Self| (mode.frequency_hz, mode.onset_power_db, mode.rt60_s);
        self.material != other.material && row(self) == row(other)
    }
}

/// Reads the measured modes; `None` if the file is absent.
pub(crate) fn read(path: &Path) -> Result<Option<Vec<Measured>>, Failure> {
    if !path.exists() {
        return Ok(None);
    }
    let mut modes = Vec::new();
    for row in csv::Reader::from_path(path)?.deserialize() {
        let (material, size, frequency_hz, onset_power_db, rt60_s) = row?;
        modes.push(Measured { material, size, frequency_hz, onset_power_db, rt60_s });
    }
    Ok(Some(modes))
}

/// Objects that are made of measured modes.
pub(crate) fn all(modes: &[Measured]) -> Vec<Object> {
    vec![
        object(modes, "woodblock", "wood_hard", 1, 10, 0.34, 0.0007),
        object(modes, "pan", "metal", 0, 24, 0.34, 0.0007),
        object(modes, "glass", "glass", 1, 32, 0.34, 0.0002),
        object(modes, "plate", "ceramic", 2, 10, 0.34, 0.0002),
    ]
}

/// Object of the `count` modes of a material and size that radiate most energy.
///
/// The modes' onset levels set their balance, and `amplitude` sets the level of all together.
fn object(
    all: &[Measured],
    name: &str,
    material: &str,
    size: u32,
    count: usize,
    amplitude: f64,
    contact_time_s: f64,
) -> Object {
    let own = all.iter().filter(|mode| mode.material == material && mode.size == size);
    // Reverberation times above 20 s are outliers of the measurement.
    let plausible = own.filter(|mode| mode.rt60_s <= 20.0 && (20.0..20_000.0).contains(&mode.frequency_hz));
    // Glass and metal share 250 of their 475 rows, and the file does not tell which was measured.
    let mut modes: Vec<_> = plausible.filter(|mode| !all.iter().any(|other| mode.is_also_of_another(other))).collect();
    // The energy of a decaying sine is its onset power times its decay time.
    let energy = |mode: &Measured| 10f64.powf(mode.onset_power_db / 10.0) * mode.rt60_s;
    modes.sort_by(|a, b| energy(b).total_cmp(&energy(a)));
    modes.truncate(count);
    let amplitude_of = |mode: &Measured| 10f64.powf(mode.onset_power_db / 20.0);
    // Phases are unknown, and the modes' peaks do not coincide. Twice the root of the summed
    // squares is near the peak of their sum.
    let sum = 2.0 * modes.iter().map(|mode| amplitude_of(mode).powi(2)).sum::<f64>().sqrt();
    let contact = Contact { time_s: contact_time_s, peak: 1.0 };
    modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    Object {
        name: name.to_owned(),
        source: format!(
            "the {count} most energetic of the measured modes of {material}, size {size}, RT60 up to 20 s, rows that another material shares left out (Traer et al. 2019, Python package tdw); onset levels as gains in sine phase, scaled in common"
        ),
        licence: "BSD-2-Clause".to_owned(),
        reference_force: 1.0,
        acceleration: Acceleration::Balance,
        modes: modes
            .into_iter()
            .map(|measured| {
                let amplitude = amplitude * amplitude_of(measured) / sum;
                mode(measured.frequency_hz, measured.rt60_s, amplitude, &[1.0], contact)
            })
            .collect(),
        residual: None,
        dynamic_filter: None,
        biquads: None,
        surface: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(material: &str, frequency_hz: f64) -> Measured {
        Measured { material: material.to_owned(), size: 0, frequency_hz, onset_power_db: -30.0, rt60_s: 0.1 }
    }

    #[test]
    fn row_that_two_materials_share_is_left_out_of_both() {
        let modes = [measured("glass", 900.0), measured("glass", 500.0), measured("metal", 900.0)];
        let glass = object(&modes, "glass", "glass", 0, 10, 0.3, 0.0002);
        assert_eq!(glass.modes.iter().map(|mode| mode.frequency_hz).collect::<Vec<_>>(), [500.0]);
        assert!(object(&modes, "pan", "metal", 0, 10, 0.3, 0.0002).modes.is_empty());
    }
}
