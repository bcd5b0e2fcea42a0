//! Records of surfaces, and of the strikers that move over them.

use zerocopy::byteorder::little_endian::{F32, U16, U32};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

use super::NAME_BYTES;

/// Number of limits α at which a surface holds the slope of the limited path.
pub const LIMITS: usize = 3;
/// Number of octaves in which it is held; each has half the points of the one before.
pub const OCTAVES: usize = 7;
/// Number of a spline's coefficients that stand twice: a copy of the last one before the first, and
/// copies of the first two behind the last. A reader may so take four in a row at any place.
pub const GUARD: usize = 3;
/// Points of the grid are a multiple of this, so that each octave has a whole number.
pub const GRID_MULTIPLE: usize = 1 << (OCTAVES - 1);

/// Number of a map's curvatures: `z_xx`, `2 z_xy` and `z_yy`.
pub const CURVATURES: usize = 3;

/// Head of a `surf` section. Behind it stand `point_count` heights, `grid_count` coefficients of
/// the curvature's spline, then for each octave the coefficients of the slope's splines, those of
/// all limits at the first point, then at the second ..., all as 16-bit integers; then source and
/// licence as UTF-8, and zeros up to a multiple of 4.
///
/// A map, `rows` above 1, has a [`MapHeader`] next to the head. Behind its heights stand the
/// coefficients of its [`CURVATURES`], one map behind the other, each row by row with guards in
/// both directions; it has no slopes.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct SurfaceHeader {
    /// Name of the surface.
    pub name: [u8; NAME_BYTES],
    /// Distance of the heights in metres.
    pub step_m: F32,
    /// Height of one unit in metres.
    pub unit_m: F32,
    /// Shortest wave in metres.
    pub shortest_m: F32,
    /// Number of heights.
    pub point_count: U32,
    /// Number of points of the grid on which curvature and slope are given; of a map's in a row.
    pub grid_count: U32,
    /// Rms of the curvature, 1/m.
    pub curvature_rms_per_m: F32,
    /// Curvature of one unit, 1/m.
    pub curvature_unit_per_m: F32,
    /// Limits α in metres, rising.
    pub alpha_m: [F32; LIMITS],
    /// Slope of one unit at each limit; 1 for a map.
    pub slope_unit: [F32; LIMITS],
    /// Mean of the limited curvature at each limit, 1/m, which the slope leaves out.
    pub mean_per_m: [F32; LIMITS],
    /// Gain by which a mix of the slopes at two neighbouring limits falls short: between them the
    /// weights `1 - s` and `s` become `(1 - s)(1 + g s)` and `s (1 + g (1 - s))`.
    pub mix_gain: [F32; LIMITS - 1],
    /// Number of rows of the heights; a profile has 1.
    pub rows: U16,
    /// Length of the source text in bytes.
    pub source_bytes: U16,
    /// Length of the licence text in bytes.
    pub licence_bytes: U16,
    /// Reserved; must be 0.
    pub reserved: U16,
}

/// Second head of a map.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct MapHeader {
    /// Number of the grid's rows.
    pub grid_rows: U32,
    /// Mean of the limited curvature at each limit over the direction θ: factors of cos 2θ,
    /// sin 2θ, cos 4θ, sin 4θ, cos 6θ and sin 6θ, 1/m. They come on top of the head's mean.
    pub mean_waves_per_m: [[F32; 6]; LIMITS],
}

/// Element of the `osur` section: the surface of an object.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct ObjectSurfaceRecord {
    /// Number of the object, counted from 0.
    pub object: U16,
    /// Number of the surface, counted from 0 in the order of the `surf` sections.
    pub surface: U16,
    /// Size of the object in metres, along its positions and across them.
    pub size_m: [F32; 2],
    /// Level in dB of scrapes and rolls on the object.
    pub level_db: F32,
}

/// Element of the `scrp` section: the way in which a striker scrapes.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct ScrapeRecord {
    /// Number of the striker, counted from 0.
    pub striker: U16,
    /// Reserved; must be 0.
    pub reserved: U16,
    /// Mass m_p in kg.
    pub mass_kg: F32,
    /// Gain β1 of the slope.
    pub slope_gain: F32,
    /// Exponent β2 of the slope.
    pub slope_exponent: F32,
    /// Limit α at the largest normal force, in metres; 0 for 1/c, c the surface's rms curvature.
    pub alpha_min_m: F32,
    /// Limit α at the least normal force, in metres; 0 for 5/c.
    pub alpha_max_m: F32,
    /// Exponent ζ with which α follows the normal force.
    pub alpha_exponent: F32,
    /// Standard deviation of the smoothing at the mean of both limits, in seconds.
    pub smoothing_s: F32,
    /// Tilt θ of the scraper from the surface in radians.
    pub tilt_rad: F32,
    /// Friction μ between scraper and surface.
    pub friction: F32,
}

/// Element of the `roll` section: the way in which a striker rolls.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct RollRecord {
    /// Number of the striker, counted from 0. It must have a [`ScrapeRecord`], too.
    pub striker: U16,
    /// Reserved; must be 0.
    pub reserved: U16,
    /// Mean radius R in metres.
    pub radius_m: F32,
    /// Distance r of the centre of mass from the middle in metres.
    pub offset_m: F32,
    /// Stiffness k in N/m^1.5.
    pub stiffness: F32,
    /// Dissipation λ in N s/m^2.5.
    pub dissipation: F32,
    /// Share of the normal force that goes up and down with the centre of mass.
    pub modulation: F32,
    /// Share of the force of scraping that the ball has.
    pub slip: F32,
}
