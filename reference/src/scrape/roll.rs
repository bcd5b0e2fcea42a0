//! Force of a ball that rolls (eq. 15 to 19).
//!
//! The penetration is `ρ = ρ0 - r cos(x/R) + S`, at least 0. In place of the paper's constant R it
//! is measured from the resting depth ρ0, at which `k ρ0^1.5` carries the weight. What changes
//! below 20 Hz, the weight and its slow shifts, is left out of the force.

/// Lowest frequency of the force in hertz.
const LOWEST_HZ: f64 = 20.0;

/// Ball that rolls, in SI units (§4.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rolling {
    /// Mean radius R in metres.
    pub radius_m: f64,
    /// Distance r of the centre of mass from the middle in metres.
    pub offset_m: f64,
    /// Stiffness k in N/m^1.5.
    pub stiffness: f64,
    /// Dissipation λ in N s/m^2.5.
    pub dissipation: f64,
    /// Share of the normal force that goes up and down with the centre of mass, 0 to 1.
    pub modulation: f64,
}

/// State of a ball.
#[derive(Clone, Debug)]
pub(super) struct Roll {
    pub(super) ball: Rolling,
    rest_m: f64,
    /// Force below [`LOWEST_HZ`] in newtons.
    slow_n: f64,
    /// Way that the ball has turned, in radians.
    angle: f64,
    height_m: f64,
}

impl Roll {
    pub(super) fn new(ball: Rolling, weight_n: f64) -> Self {
        let rest_m = (weight_n.max(0.0) / ball.stiffness).powf(2.0 / 3.0);
        Self { ball, rest_m, slow_n: weight_n.max(0.0), angle: 0.0, height_m: 0.0 }
    }

    /// Share of the normal force (§4.1), which is largest where the centre of mass moves down.
    pub(super) fn normal_share(&self, is_backwards: bool) -> f64 {
        let sine = self.angle.sin();
        1.0 + self.ball.modulation * if is_backwards { sine } else { -sine }
    }

    /// Force in newtons at the end of a frame of `frame_s`, over which the path has the speed and
    /// the slope.
    pub(super) fn force_n(&mut self, speed_m_per_s: f64, slope: f64, leak: f64, frame_s: f64) -> f64 {
        let ball = self.ball;
        self.angle += speed_m_per_s * frame_s / ball.radius_m;
        self.height_m += speed_m_per_s * slope * frame_s - self.height_m * leak;
        let depth_m = (self.rest_m - ball.offset_m * self.angle.cos() + self.height_m).max(0.0);
        let rate = speed_m_per_s * (slope + ball.offset_m / ball.radius_m * self.angle.sin());
        let factor = (1.0 + ball.dissipation / ball.stiffness * rate).max(0.0);
        let fast_n = ball.stiffness * depth_m.powf(1.5) * factor - self.slow_n;
        self.slow_n += std::f64::consts::TAU * LOWEST_HZ * frame_s * fast_n;
        fast_n
    }
}
