//! Surfaces, and what moves over them, as plain values.

/// Points of the grid, on which a kit's binary form holds curvatures, in a shortest wave.
pub const GRID_POINTS_PER_WAVE: f64 = 2.75;

/// Surface: heights of a profile that begins anew at its end, or of a map that begins anew at its
/// edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name of the surface.
    pub name: String,
    /// Origin of the surface's numbers, at most 65535 bytes of UTF-8.
    pub source: String,
    /// Licence of the surface's numbers, at most 65535 bytes of UTF-8.
    pub licence: String,
    /// Distance of the heights in metres, in a map also of its rows.
    pub step_m: f32,
    /// Number of rows; a profile has 1, a map more.
    pub rows: usize,
    /// Height of one unit in metres.
    pub unit_m: f32,
    /// Shortest wave in metres.
    pub shortest_m: f32,
    /// Heights in units, row by row.
    pub heights: Vec<i16>,
}

/// Surface of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectSurface {
    /// Name of the surface.
    pub surface: String,
    /// Size of the object in metres, along its positions and across them.
    pub size_m: [f32; 2],
    /// Level in dB of scrapes and rolls on the object, beside the newtons of their laws.
    pub level_db: f32,
}

/// Way in which a striker scrapes (scraping-rolling eq. 1 to 9).
#[derive(Clone, Debug, PartialEq)]
pub struct Scrape {
    /// Mass m_p in kg.
    pub mass_kg: f32,
    /// Gain β1 of the slope: force of a speed of 1 m/s over a slope of 1, in newtons.
    pub slope_gain: f32,
    /// Exponent β2 of the slope.
    pub slope_exponent: f32,
    /// Limit α at the largest normal force in metres, if given; else 1/c, c the surface's rms
    /// curvature.
    pub alpha_min_m: Option<f32>,
    /// Limit α at the least normal force in metres, if given; else 5/c.
    pub alpha_max_m: Option<f32>,
    /// Exponent ζ with which α follows the normal force.
    pub alpha_exponent: f32,
    /// Standard deviation in seconds of the path's smoothing, at the mean of both limits.
    pub smoothing_s: f32,
    /// Tilt θ of the scraper in radians.
    pub tilt_rad: f32,
    /// Friction μ between scraper and surface.
    pub friction: f32,
}

impl Scrape {
    /// Gain β1 of the paper.
    pub const DEFAULT_SLOPE_GAIN: f32 = 0.05;
    /// Exponent ζ of the paper.
    pub const DEFAULT_ALPHA_EXPONENT: f32 = 0.95;
    /// Deviation of a window of 5 samples to either side at 44.1 kHz: half of it.
    pub const DEFAULT_SMOOTHING_S: f32 = 57e-6;
    /// Tilt of a stick that is held like a pen, in radians.
    pub const DEFAULT_TILT_RAD: f32 = 0.7;
    /// Friction of wood on wood.
    pub const DEFAULT_FRICTION: f32 = 0.3;
}

/// Way in which a striker rolls (scraping-rolling eq. 15 to 19).
#[derive(Clone, Debug, PartialEq)]
pub struct Roll {
    /// Mean radius R in metres.
    pub radius_m: f32,
    /// Distance r of the centre of mass from the middle in metres.
    pub offset_m: f32,
    /// Stiffness k in N/m^1.5.
    pub stiffness: f32,
    /// Dissipation λ in N s/m^2.5.
    pub dissipation: f32,
    /// Share of the normal force that goes up and down with the centre of mass.
    pub modulation: f32,
    /// Share of the force of scraping that the ball has: how much it slips (§4).
    pub slip: f32,
}

impl Roll {
    /// Offset of a ball that is round to a twentieth of a hair, in metres.
    pub const DEFAULT_OFFSET_M: f32 = 4e-6;
    /// Stiffness in N/m^1.5: 20 g sink in by 20 µm, more than the roughness of most surfaces.
    pub const DEFAULT_STIFFNESS: f32 = 2e6;
    /// Dissipation of a tenth of the stiffness at 1 m/s, in N s/m^2.5.
    pub const DEFAULT_DISSIPATION: f32 = 2e5;
    /// Slip of a ball that rolls freely over a hard surface.
    pub const DEFAULT_SLIP: f32 = 0.02;
    /// Modulation that is heard, and lifts no ball off.
    pub const DEFAULT_MODULATION: f32 = 0.3;
}
