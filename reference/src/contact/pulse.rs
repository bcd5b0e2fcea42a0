//! The shape of one contact force.

use std::f64::consts::PI;

/// The shape `C(t)` of a contact force, with its peak at 1.
///
/// Times are counted from the pulse's start, which is the time of the strike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pulse {
    /// `sin(π t/τ)` for `0 <= t <= τ`: the contact of two frictionless spheres, approximately
    /// (§3.2, the model that eq. 2 smooths). Its area is `2τ/π`.
    HertzHalfSine,
    /// `exp(-6/τ² (t - c)²)` with its centre at `c = τ √(ln(10⁵)/6)`, about 1.385 τ (eq. 2).
    ///
    /// A Gaussian has no beginning: it is cut where it is 100 dB (10⁻⁵) below its peak, at `t = 0`
    /// and `t = 2c`. Eq. 2 counts from the onset `t_i` of the unsmoothed contact and has its centre
    /// at `t_i + τ/2`; here the time counts from where the pulse is first heard, so that no strike
    /// sounds before it happens: `t_i` is `c - τ/2` after that. Its area is
    /// `τ √(π/6) erf(√ln(10⁵))`.
    Gaussian,
}

impl Pulse {
    /// `C(t)`: the force at `since_start_s` seconds after the start, as a share of its peak.
    ///
    /// `contact_time_s` is τ, above 0. The result is 0 outside the pulse.
    pub fn shape(self, since_start_s: f64, contact_time_s: f64) -> f64 {
        if !(0.0..=self.duration_s(contact_time_s)).contains(&since_start_s) {
            return 0.0;
        }
        match self {
            Self::HertzHalfSine => (PI * since_start_s / contact_time_s).sin(),
            // Eq. 2.
            Self::Gaussian => {
                let from_centre = since_start_s - gaussian_centre_s(contact_time_s);
                (-6.0 / contact_time_s.powi(2) * from_centre.powi(2)).exp()
            }
        }
    }

    /// How long the force acts, in seconds, for a contact time τ of `contact_time_s` seconds.
    pub fn duration_s(self, contact_time_s: f64) -> f64 {
        match self {
            Self::HertzHalfSine => contact_time_s,
            Self::Gaussian => 2.0 * gaussian_centre_s(contact_time_s),
        }
    }
}

/// Time from where eq. 2 has risen to 10⁻⁵ of its peak to that peak: `exp(-6 c²/τ²) = 10⁻⁵`.
fn gaussian_centre_s(contact_time_s: f64) -> f64 {
    contact_time_s * (1e5_f64.ln() / 6.0).sqrt()
}
