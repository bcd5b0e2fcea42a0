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
    /// What one unit of force adds to u.
    pub gain: f32,
    delta: f32,
    epsilon: f32,
}

impl FloatMode {
    /// A mode of a frequency in Hz and a decay in 1/s at a sample rate in Hz, at rest and with gain 0; its coefficients are derived in
    /// `f64` and rounded once. Frequencies from 0 to below fs/2.
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

    /// Advances one sample under a force, and gives v: the force is heard a sample later.
    #[inline]
    pub fn step_driven(&mut self, force: f32) -> f32 {
        let v = self.step();
        self.u += self.gain * force;
        v
    }
}

/// Modes held in registers at once.
const LANES: usize = 4;

/// Adds the sound of modes that ring freely to `out`.
pub fn free(modes: &mut [FloatMode], out: &mut [f32]) {
    let (fours, rest) = modes.as_chunks_mut::<LANES>();
    for four in fours {
        free_together(four, out);
    }
    for one in rest.as_chunks_mut::<1>().0 {
        free_together(one, out);
    }
}

/// Adds the sound of modes under a force to `out`; frames beyond the shorter of the two are left alone.
pub fn driven(modes: &mut [FloatMode], force: &[f32], out: &mut [f32]) {
    let (fours, rest) = modes.as_chunks_mut::<LANES>();
    for four in fours {
        driven_together(four, force, out);
    }
    for one in rest.as_chunks_mut::<1>().0 {
        driven_together(one, force, out);
    }
}

#[inline(always)]
fn free_together<const N: usize>(modes: &mut [FloatMode; N], out: &mut [f32]) {
    let mut u = modes.map(|mode| mode.u);
    let mut v = modes.map(|mode| mode.v);
    let delta = modes.map(|mode| mode.delta);
    let epsilon = modes.map(|mode| mode.epsilon);
    let mut damped: [f32; N] = core::array::from_fn(|m| delta[m] * u[m]);
    let mut turned: [f32; N] = core::array::from_fn(|m| epsilon[m] * v[m]);
    for sum in out {
        for m in 0..N {
            u[m] -= damped[m];
        }
        for m in 0..N {
            u[m] -= turned[m];
        }
        for m in 0..N {
            v[m] += epsilon[m] * u[m];
        }
        let mut total = *sum;
        for m in 0..N {
            damped[m] = delta[m] * u[m];
            total += v[m];
        }
        for m in 0..N {
            turned[m] = epsilon[m] * v[m];
        }
        *sum = total;
        core::hint::black_box(());
    }
    for (m, mode) in modes.iter_mut().enumerate() {
        (mode.u, mode.v) = (u[m], v[m]);
    }
}

#[inline(always)]
fn driven_together<const N: usize>(modes: &mut [FloatMode; N], force: &[f32], out: &mut [f32]) {
    let mut u = modes.map(|mode| mode.u);
    let mut v = modes.map(|mode| mode.v);
    let delta = modes.map(|mode| mode.delta);
    let epsilon = modes.map(|mode| mode.epsilon);
    let gain = modes.map(|mode| mode.gain);
    let mut damped: [f32; N] = core::array::from_fn(|m| delta[m] * u[m]);
    let mut turned: [f32; N] = core::array::from_fn(|m| epsilon[m] * v[m]);
    for (sum, &force) in out.iter_mut().zip(force) {
        for m in 0..N {
            u[m] -= damped[m];
        }
        for m in 0..N {
            u[m] -= turned[m];
        }
        for m in 0..N {
            v[m] += epsilon[m] * u[m];
        }
        let mut total = *sum;
        for m in 0..N {
            u[m] += gain[m] * force;
            total += v[m];
        }
        for m in 0..N {
            damped[m] = delta[m] * u[m];
        }
        for m in 0..N {
            turned[m] = epsilon[m] * v[m];
        }
        *sum = total;
        core::hint::black_box(());
    }
    for (m, mode) in modes.iter_mut().enumerate() {
        (mode.u, mode.v) = (u[m], v[m]);
    }
}
