//! The valid range of every number in a kit; a kit with a number outside its range is refused.
//!
//! The ranges hold the values of physics with a margin, and the fixed-point engine keeps its stated
//! accuracy within them. Two further limits depend on the sample rate and are checked on load
//! ([`crate::engine::LoadError`]).

/// A closed interval of allowed values.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Range {
    /// Smallest allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
}

impl Range {
    pub(super) const fn new(min: f32, max: f32) -> Self {
        Self { min, max }
    }

    /// True if the value lies in the interval; false for NaN.
    pub fn holds(self, value: f32) -> bool {
        value >= self.min && value <= self.max
    }
}

/// Frequency of a mode in Hz. Modes at or above Nyquist are valid but not rendered.
pub const FREQUENCY_HZ: Range = Range::new(0.1, 1e6);
/// Decay of a mode in 1/s: T60 from 0.35 ms to 690 s. At low sample rates the upper limit is
/// [`crate::resonator::max_decay_per_s`].
pub const DECAY_PER_S: Range = Range::new(0.01, 20_000.0);
/// Gain of a mode or a biquad, of either sign.
pub const GAIN: Range = Range::new(-1e9, 1e9);
/// Reference force in newtons.
pub const REFERENCE_FORCE: Range = Range::new(1e-6, 1e6);
/// Acceleration sound, output per newton.
pub const ACCELERATION: Range = Range::new(-1e6, 1e6);
/// Peak force at velocity 1, in newtons.
pub const PEAK_FORCE: Range = Range::new(1e-6, 1e6);
/// Exponent of the peak force.
pub const PEAK_EXPONENT: Range = Range::new(0.0, 8.0);
/// Contact time at velocity 1, in seconds.
pub const CONTACT_TIME_S: Range = Range::new(2e-5, 0.1);
/// Exponent of the contact time.
pub const CONTACT_EXPONENT: Range = Range::new(-1.0, 1.0);
/// Coefficient of restitution of a Hertz pulse.
pub const RESTITUTION: Range = Range::new(0.1, 1.0);
/// Coefficient of restitution of strikers without one in the kit.
///
/// It is at or above the median of the measured hammer forces, and its spectrum has no ripple above
/// 0.5 dB.
pub const DEFAULT_RESTITUTION: f32 = 0.45;
/// Volume of a board's headphones in dB.
pub const HEADPHONE_DB: Range = Range::new(-60.0, 0.0);
/// Volume in dB of a board's headphones with a kit that gives none.
pub const DEFAULT_HEADPHONE_DB: f32 = -12.0;
/// Level of a pad in dB.
pub const LEVEL_DB: Range = Range::new(-120.0, 40.0);
/// Constant-power pan of a pad, -1 (left) to 1 (right).
pub const PAN: Range = Range::new(-1.0, 1.0);
/// Weight of the own modes of a pad's strikers.
pub const STRIKER_WEIGHT: Range = Range::new(-1e3, 1e3);
/// T60 of a choke in seconds. A kit may also hold 0 for a pad that cannot be choked.
pub const CHOKE_T60_S: Range = Range::new(0.001, 100.0);
/// Maximum number of modes of one object or striker.
pub const MODES_PER_BANK: usize = 4096;
/// Maximum number of bands of a room.
pub const ROOM_BANDS: usize = 8;
/// Maximum number of positions along an object.
pub const POSITIONS: usize = 64;
/// Softest peak that is a strike, as a fraction of half the ADC's range.
pub const THRESHOLD: Range = Range::new(0.001, 0.5);
/// Scan time in seconds.
pub const SCAN_TIME_S: Range = Range::new(0.001, 0.01);
/// Mask time in seconds.
pub const MASK_TIME_S: Range = Range::new(0.001, 0.5);
/// Decay of the mask's amplitude in 1/s.
pub const MASK_DECAY_PER_S: Range = Range::new(1.0, 1000.0);
/// Peak of a strike of velocity 1, as a fraction of half the ADC's range.
pub const FULL_SCALE: Range = Range::new(0.01, 1.0);
/// Exponent of the velocity curve.
pub const VELOCITY_EXPONENT: Range = Range::new(0.1, 8.0);
/// Ratio of a peak to the sum of the other pads' peaks below which it is crosstalk, in dB.
pub const CROSSTALK_DB: Range = Range::new(-60.0, 0.0);
/// Gain of the second sensor in dB.
pub const RIM_DB: Range = Range::new(-40.0, 40.0);
/// Force of a full-scale signal in direct mode.
pub const DIRECT_GAIN: Range = Range::new(0.001, 8.0);
/// Velocity of a button's strikes.
pub const BUTTON_VELOCITY: Range = Range::new(0.0, 1.0);
/// Edge of a noise band in Hz. On load it must also be below half the sample rate.
pub const EDGE_HZ: Range = Range::new(1.0, 96_000.0);
/// Least width of a noise band in Hz.
pub const BAND_WIDTH_HZ: f32 = 1.0;
/// Maximum number of bands of a residual or of the background.
pub const NOISE_BANDS: usize = 100;
/// Rms of a noise band at t = 0; 1.0 is full scale.
pub const WEIGHT: Range = Range::new(0.0, 16.0);
/// Decay of a noise band in dB/s: T60 from 3 ms to 60 s.
pub const DECAY_DB_PER_S: Range = Range::new(1.0, 20_000.0);
/// Largest number of an ADC channel that a kit may name.
pub const LAST_CHANNEL: usize = 15;
/// Largest number of a button that a kit may name.
pub const LAST_BUTTON: usize = 15;
/// Initial gain of a room's band in 1/√s; the reverberation's energy is gain²/(2 decay).
pub const ROOM_GAIN: Range = Range::new(0.0, 100.0);
/// Decay of a room's band in 1/s: T60 from 46 ms to 23 s.
pub const ROOM_DECAY_PER_S: Range = Range::new(0.3, 150.0);
/// Sample rate in Hz that a filter's coefficients are for: the rates that the engine supports.
pub const RATE_HZ: Range = Range::new(8_000.0, 192_000.0);
/// Maximum number of breakpoints of a dynamic filter.
pub const BREAKPOINTS: usize = 32;
/// Maximum number of loops round a dynamic filter.
pub const LOOPS: usize = 16;
/// Time of each breakpoint but the first, in seconds after the strike. The first is at 0.
pub const TIME_S: Range = Range::new(0.0, 3_600.0);
/// Coefficients b0, b1 and b2 of a dynamic filter, of either sign. On load the filter's gain is
/// checked too.
pub const COEFFICIENT: Range = Range::new(-1e6, 1e6);
/// Level of the noise at a breakpoint.
pub const NOISE_LEVEL: Range = Range::new(0.0, 1.0);
/// Coefficient a1 of a dynamic filter. The poles must also lie within the unit circle.
pub const A1: Range = Range::new(-2.0, 2.0);
/// Coefficient a2 of a dynamic filter. The poles must also lie within the unit circle.
pub const A2: Range = Range::new(-1.0, 1.0);
/// Exponent with which the exciter's edges follow the strike's peak force.
pub const EXCITER_EXPONENT: Range = Range::new(-4.0, 4.0);
/// Bandwidth of a loop in Hz. It must also be below the loop's frequency.
pub const BANDWIDTH_HZ: Range = Range::new(0.01, 48_000.0);
/// Gain of a loop at its frequency. On load the loops must also be stable round the filter.
pub const LOOP_GAIN: Range = Range::new(-1e6, 1e6);
/// Delay of a loop in seconds. On load it must also fit the engine's delay line.
pub const DELAY_S: Range = Range::new(5e-6, 1.0);
/// Maximum number of chains of a biquad bank.
pub const CHAINS: usize = 64;
/// Maximum number of biquads of a chain.
pub const CHAIN_DEPTH: usize = 4;
/// Real and imaginary part of a pole. The pole must also lie within the unit circle.
pub const POLE: Range = Range::new(-1.0, 1.0);
/// Real and imaginary part of a zero.
pub const ZERO: Range = Range::new(-1e3, 1e3);
/// Distance of a surface's heights in metres.
pub const STEP_M: Range = Range::new(1e-7, 0.01);
/// Height of one unit of a surface in metres.
pub const UNIT_M: Range = Range::new(1e-15, 1e-3);
/// Shortest wave of a surface in metres. It must also be at least two steps long.
pub const SHORTEST_M: Range = Range::new(2e-7, 0.1);
/// Least and largest number of heights of a surface.
pub const HEIGHTS: [usize; 2] = [256, 32_768];
/// Least number of points of a surface's grid in either direction.
pub const GRID_POINTS: usize = 8;
/// Largest number of bytes that a surface takes.
pub const SURFACE_BYTES: usize = 65_536;
/// Size of an object in metres, along its positions and across them.
pub const SIZE_M: Range = Range::new(1e-3, 100.0);
/// Level in dB of scrapes and rolls on an object.
pub const SURFACE_LEVEL_DB: Range = Range::new(-80.0, 40.0);
/// Mass of a scraper in kg.
pub const MASS_KG: Range = Range::new(1e-6, 100.0);
/// Gain β1 of the slope.
pub const SLOPE_GAIN: Range = Range::new(0.0, 1e4);
/// Exponent β2 of the slope.
pub const SLOPE_EXPONENT: Range = Range::new(0.25, 4.0);
/// Limit α in metres. 0 stands for the surface's own, and is allowed as well. The largest limit
/// must not be below the least.
pub const ALPHA_M: Range = Range::new(1e-9, 1.0);
/// Exponent ζ of the limit.
pub const ALPHA_EXPONENT: Range = Range::new(0.05, 8.0);
/// Standard deviation of the smoothing in seconds.
pub const SMOOTHING_S: Range = Range::new(0.0, 2e-4);
/// Tilt of a scraper in radians. The product of its tangent and the friction must be below 1.
pub const TILT_RAD: Range = Range::new(0.0, 1.5);
/// Friction of a scraper.
pub const FRICTION: Range = Range::new(0.0, 10.0);
/// Radius of a ball in metres.
pub const RADIUS_M: Range = Range::new(5e-4, 1.0);
/// Distance of a ball's centre of mass from its middle, in metres.
pub const OFFSET_M: Range = Range::new(0.0, 1e-3);
/// Stiffness of a ball's contact in N/m^1.5.
pub const STIFFNESS: Range = Range::new(1e3, 1e12);
/// Dissipation of a ball's contact in N s/m^2.5.
pub const DISSIPATION: Range = Range::new(0.0, 1e12);
/// Share of the normal force that goes up and down with the centre of mass.
pub const MODULATION: Range = Range::new(0.0, 1.0);
/// Share of the force of scraping that a ball has.
pub const SLIP: Range = Range::new(0.0, 1.0);
