//! Arbitrary valid surfaces, and strikers that scrape and roll.

use dsp_core::table::range;
use kit::{ObjectSurface, Roll, Scrape, Surface};
use proptest::prelude::*;

use crate::arbitrary_number::number;

/// Profile or map with 256 to 600 heights, which are not all the same.
pub(crate) fn surface(
    name: String,
    source: impl Strategy<Value = String>,
    licence: impl Strategy<Value = String>,
) -> impl Strategy<Value = Surface> {
    let heights = prop::collection::vec(any::<i16>(), range::HEIGHTS[0]..600)
        .prop_filter("not flat", |heights| heights.iter().any(|height| *height != heights[0]));
    // Rows, and the shortest wave in steps: a map of 16 rows and as many columns at least has room
    // for three waves of 5 steps.
    let shape = prop_oneof![(Just(1_usize), 2.0..200.0_f32), (Just(16), 2.0..5.0_f32)];
    (source, licence, 1e-7..1e-4_f32, 1e-12..1e-6_f32, shape, heights).prop_map(
        move |(source, licence, step_m, unit_m, (rows, shortest), heights)| Surface {
            name: name.clone(),
            source,
            licence,
            step_m,
            rows,
            unit_m,
            shortest_m: (shortest * step_m).max(range::SHORTEST_M.min),
            heights: heights[..heights.len() / rows * rows].to_vec(),
        },
    )
}

/// Surface of an object, if there are surfaces.
pub(crate) fn object_surface(names: &[String]) -> BoxedStrategy<Option<ObjectSurface>> {
    if names.is_empty() {
        return Just(None).boxed();
    }
    let size_m = [number(range::SIZE_M), number(range::SIZE_M)];
    let place = (prop::sample::select(names.to_vec()), size_m, number(range::SURFACE_LEVEL_DB));
    prop::option::of(place.prop_map(|(surface, size_m, level_db)| ObjectSurface { surface, size_m, level_db })).boxed()
}

pub(crate) fn scrape() -> impl Strategy<Value = Scrape> {
    let limits = (number(range::ALPHA_M), number(range::ALPHA_M)).prop_map(|(a, b)| (a.min(b), a.max(b)));
    let force = (number(range::MASS_KG), number(range::SLOPE_GAIN), number(range::SLOPE_EXPONENT));
    let limit = (prop::option::of(limits), number(range::ALPHA_EXPONENT), number(range::SMOOTHING_S));
    // The product of the friction and the tilt's tangent must be below 1.
    let tilt = (number(range::TILT_RAD), number(range::FRICTION))
        .prop_map(|(tilt_rad, friction)| (tilt_rad, friction.min(0.99 / tilt_rad.max(1e-3).tan())));
    (force, limit, tilt).prop_map(|(force, (limits, alpha_exponent, smoothing_s), (tilt_rad, friction))| {
        let (mass_kg, slope_gain, slope_exponent) = force;
        Scrape {
            mass_kg,
            slope_gain,
            slope_exponent,
            alpha_min_m: limits.map(|limits| limits.0),
            alpha_max_m: limits.map(|limits| limits.1),
            alpha_exponent,
            smoothing_s,
            tilt_rad,
            friction,
        }
    })
}

pub(crate) fn roll() -> impl Strategy<Value = Roll> {
    let ball = (number(range::RADIUS_M), number(range::OFFSET_M), number(range::STIFFNESS));
    (ball, number(range::DISSIPATION), number(range::MODULATION), number(range::SLIP)).prop_map(
        |((radius_m, offset_m, stiffness), dissipation, modulation, slip)| Roll {
            radius_m,
            offset_m,
            stiffness,
            dissipation,
            modulation,
            slip,
        },
    )
}
