//! The modified coupled form in single precision: what the field ships, for comparison with the fixed-point forms.
//!
//! Not used by the engine: worst SNR against `f64` 39 dB (near Nyquist), median 103 dB, where the fixed-point forms keep 101 dB and 122 dB
//! (`cargo bench -p host-tests --bench accuracy`), at three multiplies and three additions a sample.

/// One mode, `u -= δu; u -= e v; v += e u`: δ apart, because 1 - δ would round away most of a slow decay.
#[derive(Clone, Copy, Debug, Default)]
pub struct FloatMode {
    /// The quadrature component.
    pub u: f32,
    /// The component that sounds.
    pub v: f32,
    delta: f32,
    epsilon: f32,
}

impl FloatMode {
    /// A mode of a frequency in Hz and a decay in 1/s at a sample rate in Hz; its coefficients are derived in `f64` and rounded once.
    /// Frequencies from 0 to below fs/2.
    pub fn new(frequency_hz: f64, decay_per_s: f64, rate_hz: f64) -> Self {
        let radius = libm::exp(-decay_per_s / rate_hz);
        let sine = libm::sin(core::f64::consts::PI * frequency_hz / rate_hz);
        let step_squared = (1.0 - radius) * (1.0 - radius) + 4.0 * radius * sine * sine;
        Self {
            delta: -libm::expm1(-2.0 * decay_per_s / rate_hz) as f32,
            epsilon: libm::sqrt(step_squared) as f32,
            ..Self::default()
        }
    }

    /// Advances one sample and gives v.
    #[inline]
    pub fn step(&mut self) -> f32 {
        self.u -= self.delta * self.u;
        self.u -= self.epsilon * self.v;
        self.v += self.epsilon * self.u;
        self.v
    }
}
