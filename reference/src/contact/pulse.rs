//! Shape of one contact force.

use std::f64::consts::PI;

use crate::rate::SampleRate;

/// Shape `C(t)` of a contact force, with its peak at 1.
///
/// Times are counted from the pulse's start, which is the time of the strike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pulse {
    /// Contact of two spheres that lose energy: `N sin(πx) (1 + A cos(πx))`, x = t/τ in 0 to 1.
    ///
    /// `A = (1-r)/(1+r)`; r is the ratio of the force's last slope to its first, `r = e^4.6` with
    /// the coefficient of restitution e. For e of 0.45 to 1 this r is within 4 % of that of Hunt
    /// and Crossley's contact `x'' = -x^1.5 (1 + μ x')`, which is `e^1.5 (1-μe)/(1+μ)` with
    /// `μ (1+e) = ln((1+μ)/(1-μe))`. At e = 1 the pulse is the half-sine of frictionless spheres
    /// (§3.2, the model that eq. 2 smooths). At e below 1 its spectrum has no zeros.
    Hertz {
        /// Coefficient of restitution e, 0.1 to 1: rebound speed over impact speed.
        restitution: f64,
    },
    /// Gaussian `exp(-6/τ² (t - c)²)` with its centre at `c = τ √(ln(10⁵)/6)`, about 1.385 τ (eq.
    /// 2).
    ///
    /// A Gaussian has no beginning: it is cut where it is 100 dB (10⁻⁵) below its peak, at `t = 0`
    /// and `t = 2c`. Eq. 2 counts from the onset `t_i` of the unsmoothed contact and has its centre
    /// at `t_i + τ/2`. Here the time counts from the first audible point, so that no strike sounds
    /// before it happens. `t_i` is `c - τ/2` later. The area of the pulse is
    /// `τ √(π/6) erf(√ln(10⁵))`.
    Gaussian,
}

/// Shortest Gaussian contact time in samples.
///
/// The samples of a shorter pulse would not add up to its impulse. Such a pulse is played at this
/// length, with its peak lowered in the ratio of the two lengths.
const SHORTEST_GAUSSIAN_SAMPLES: f64 = 1.75;

impl Pulse {
    /// Force `C(t)` at `since_start_s` seconds after the start, as a share of its peak.
    ///
    /// `contact_time_s` is τ, above 0. The result is 0 outside the pulse.
    pub fn shape(self, since_start_s: f64, contact_time_s: f64) -> f64 {
        if !(0.0..=self.duration_s(contact_time_s)).contains(&since_start_s) {
            return 0.0;
        }
        match self {
            Self::Hertz { restitution } => {
                let (skew, scale) = skew_and_scale(restitution);
                let (sine, cosine) = (PI * since_start_s / contact_time_s).sin_cos();
                scale * sine * (1.0 + skew * cosine)
            }
            // Eq. 2.
            Self::Gaussian => {
                let from_centre = since_start_s - gaussian_centre_s(contact_time_s);
                (-6.0 / contact_time_s.powi(2) * from_centre.powi(2)).exp()
            }
        }
    }

    /// Force of the sample at `since_start_s`, as a share of the peak.
    ///
    /// Hertz: the mean of `C` over the sample interval that ends there. The samples' sum is then
    /// the impulse, for every onset and every contact time. Gaussian: `C` itself.
    pub fn sample(self, since_start_s: f64, contact_time_s: f64, rate: SampleRate) -> f64 {
        match self {
            Self::Hertz { restitution } => {
                let interval = 1.0 / (contact_time_s * rate.hz());
                let end = since_start_s / contact_time_s;
                let (from, to) = ((end - interval).clamp(0.0, 1.0), end.clamp(0.0, 1.0));
                let (skew, scale) = skew_and_scale(restitution);
                // ∫ sin πx and ∫ sin 2πx from `from` to `to`, each as a product of two sines.
                let (sum, difference) = (PI * (from + to) / 2.0, PI * (to - from) / 2.0);
                let first = 2.0 / PI * sum.sin() * difference.sin();
                let second = (2.0 * sum).sin() * (2.0 * difference).sin() / PI;
                scale * (first + skew / 2.0 * second) / interval
            }
            Self::Gaussian => {
                let played_s = contact_time_s.max(SHORTEST_GAUSSIAN_SAMPLES / rate.hz());
                contact_time_s / played_s * self.shape(since_start_s, played_s)
            }
        }
    }

    /// Duration of the force in seconds, for a contact time τ of `contact_time_s` seconds.
    pub fn duration_s(self, contact_time_s: f64) -> f64 {
        match self {
            Self::Hertz { .. } => contact_time_s,
            Self::Gaussian => 2.0 * gaussian_centre_s(contact_time_s),
        }
    }

    /// Longest time in seconds after the start at which a sample may have force.
    pub fn sampled_duration_s(self, contact_time_s: f64, rate: SampleRate) -> f64 {
        match self {
            Self::Hertz { .. } => contact_time_s + 1.0 / rate.hz(),
            Self::Gaussian => self.duration_s(contact_time_s.max(SHORTEST_GAUSSIAN_SAMPLES / rate.hz())),
        }
    }
}

/// Skew A of the Hertz pulse, and the factor N that makes its peak 1.
fn skew_and_scale(restitution: f64) -> (f64, f64) {
    let slopes = restitution.powf(4.6);
    let skew = (1.0 - slopes) / (1.0 + slopes);
    // The force is largest where 2A cos²(πx) + cos(πx) - A = 0.
    let cosine = 2.0 * skew / (1.0 + (1.0 + 8.0 * skew * skew).sqrt());
    (skew, 1.0 / ((1.0 - cosine * cosine).sqrt() * (1.0 + skew * cosine)))
}

/// Time in which eq. 2 rises from 10⁻⁵ of its peak to the peak: `exp(-6 c²/τ²) = 10⁻⁵`.
fn gaussian_centre_s(contact_time_s: f64) -> f64 {
    contact_time_s * (1e5_f64.ln() / 6.0).sqrt()
}
