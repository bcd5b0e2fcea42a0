//! Surfaces and contacts of the instrument as those of the reference.

use dsp_core::scrape::Contact;
use dsp_core::table::Surface;
use dsp_core::table::layout::{GUARD, LIMITS, OCTAVES};

/// The reference's contact with the numbers of the instrument's.
pub fn contact(contact: &Contact<'_>) -> reference::scrape::Contact {
    reference::scrape::Contact {
        surface: surface(&contact.surface),
        mass_kg: contact.mass_kg.into(),
        slope: contact.slope.map(f64::from),
        alpha_m: contact.alpha_m.map(f64::from),
        alpha_exponent: contact.alpha_exponent.into(),
        smoothing_s: contact.smoothing_s.into(),
        rolling: contact.rolling.map(|ball| reference::scrape::Rolling {
            radius_m: ball.radius_m.into(),
            offset_m: ball.offset_m.into(),
            stiffness: ball.stiffness.into(),
            dissipation: ball.dissipation.into(),
            modulation: ball.modulation.into(),
        }),
        normal_n: contact.normal_n.map(f64::from),
        seed: contact.seed,
    }
}

/// The reference's surface with the numbers of a kit's.
fn surface(surface: &Surface<'_>) -> reference::scrape::Surface {
    let unit = f64::from(surface.curvature_unit_per_m());
    let map = surface.map().map(|map| {
        let [columns, rows] = map.points();
        let width = columns + GUARD;
        let curvature = |index: usize| {
            // Behind the first row and column of the guard.
            let lines = map.coefficients().chunks_exact(width).skip(index * (rows + GUARD) + 1).take(rows);
            lines.flat_map(|line| &line[1..=columns]).map(|n| f64::from(n.get()) * unit).collect()
        };
        reference::scrape::Map {
            points: [columns, rows],
            row_step_m: map.row_step_m().into(),
            curvatures: [0, 1, 2].map(curvature),
            mean_waves_per_m: map.mean_waves_per_m().map(|limit| limit.map(f64::from)),
        }
    });
    let points = if map.is_some() { 0 } else { surface.grid_points() };
    let slope_unit = surface.slope_unit().map(f64::from);
    let slopes = |octave| {
        // Behind the first one of the guard.
        let numbers = surface.slopes(octave).get(LIMITS..).unwrap_or(&[]);
        let limit = |limit: usize| {
            numbers
                .iter()
                .skip(limit)
                .step_by(LIMITS)
                .take(points >> octave)
                .map(|n| f64::from(n.get()) * slope_unit[limit])
                .collect()
        };
        [limit(0), limit(1), limit(2)]
    };
    reference::scrape::Surface {
        grid_step_m: surface.grid_step_m().into(),
        curvature: surface.curvature().iter().skip(1).take(points).map(|n| f64::from(n.get()) * unit).collect(),
        alpha_m: surface.alpha_m().map(f64::from),
        mean_per_m: surface.mean_per_m().map(f64::from),
        mix_gain: surface.mix_gain().map(f64::from),
        map,
        slopes: (0..OCTAVES).map(slopes).collect(),
    }
}
