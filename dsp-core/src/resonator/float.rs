//! The modified coupled form in single precision: what the field ships, for comparison with the fixed-point forms.
//!
//! Not used by the engine: worst SNR against `f64` about 54 dB where the fixed-point forms keep 100 dB
//! (`cargo bench -p host-tests --bench accuracy`), at three multiplies and three additions a sample.

/// One mode, `u = (1-δ) u - e v; v += e u`.
#[derive(Clone, Copy, Debug, Default)]
pub struct FloatMode {
    /// The quadrature component.
    pub u: f32,
    /// The component that sounds.
    pub v: f32,
    one_minus_delta: f32,
    epsilon: f32,
}

impl FloatMode {
    /// A mode of a frequency in Hz and a decay in 1/s at a sample rate in Hz; its coefficients are derived in `f64` and rounded once.
    /// Frequencies from 0 to below fs/2.
    pub fn new(frequency_hz: f64, decay_per_s: f64, rate_hz: f64) -> Self {
        let radius = libm::exp(-decay_per_s / rate_hz);
        let sine = libm::sin(core::f64::consts::PI * frequency_hz / rate_hz);
        let step_squared = (1.0 - radius) * (1.0 - radius) + 4.0 * radius * sine * sine;
        Self { one_minus_delta: (radius * radius) as f32, epsilon: libm::sqrt(step_squared) as f32, ..Self::default() }
    }

    /// Advances one sample and gives v.
    #[inline]
    pub fn step(&mut self) -> f32 {
        self.u = self.one_minus_delta * self.u - self.epsilon * self.v;
        self.v += self.epsilon * self.u;
        self.v
    }
}
