//! From a mode's frequency and decay to the coefficients of its form.

use crate::SampleRate;
use crate::square_root::rounded_root;
use crate::{exponential, sine};

/// Arithmetic of a mode, chosen by the mode's step `e` (see [`Pole::new`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Form {
    /// Modified coupled form, e < 1/2: `u -= δu; u -= e v; v += e u`.
    Coupled = 0,
    /// Shifted form, e² < 1: `u -= δu; u -= (e²/2) v; v += 2u`.
    Shifted1 = 1,
    /// Shifted form, e² < 2: `u -= δu; u -= (e²/4) v; v += 4u`.
    Shifted2 = 2,
}

impl Form {
    /// Shift k of the shifted forms; 0 for the coupled one.
    pub const fn shift(self) -> u32 {
        self as u32
    }
}

/// Two multipliers of a form as Q32: `value · 2^-32`, both in [0, 1/2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Coefficients {
    /// δ = 1 - r².
    pub delta: i32,
    /// e for the coupled form, e²/2^k for the shifted ones.
    pub epsilon: i32,
}

/// Place of a mode in the z-plane, as one of the forms realises it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pole {
    /// Arithmetic.
    pub form: Form,
    /// True if the bank runs the mode, which is above fs/4, at fs/2 - f with input and output of
    /// alternating sign.
    pub mirrored: bool,
    /// Multipliers.
    pub coefficients: Coefficients,
}

/// Fastest decay in 1/s that the forms can hold at a rate (δ < 1/2): T60 of 0.42 ms at 48 kHz.
pub fn max_decay_per_s(rate: SampleRate) -> f64 {
    0.34 * rate.hz()
}

impl Pole {
    /// Chooses the form and derives its coefficients in `f64`, with the pole radius
    /// `r = e^{-d/fs}`, its angle `θ = 2πf/fs` and the step `e² = (1-r)² + 4r sin²(θ/2)`:
    ///
    /// | | f (for r near 1) | form |
    /// | --- | --- | --- |
    /// | e < 1/2 | below fs/12.4 | coupled |
    /// | otherwise | up to fs/4 | shifted by k = 1 or 2, the smaller with e²/2^k < 1/2 |
    /// | above fs/4 | | mirrored: the mode fs/2 - f, by the same rule |
    ///
    /// `None` for a mode at or above Nyquist, which is never rendered, and for a decay above
    /// [`max_decay_per_s`].
    ///
    /// A third shifted form, k = 0 for e² < 1/2, would improve its modes' median SNR by 0.6 dB but
    /// not the worst one, for 4 KB of kernels. k = 2 for all would cost 8 dB of the worst.
    ///
    /// Accuracy over 1 Hz to 0.499 fs and T60 1 ms to 120 s: frequency within 0.004 cent, decay
    /// within 0.01 % (`cargo test -p dsp-core quantised_poles`). Cost: two series in software
    /// `f64`: on load only.
    pub fn new(frequency_hz: f64, decay_per_s: f64, rate: SampleRate) -> Option<Self> {
        let fs = rate.hz();
        if frequency_hz >= fs / 2.0 || decay_per_s > max_decay_per_s(rate) {
            return None;
        }
        let mirrored = frequency_hz > fs / 4.0;
        let folded_hz = if mirrored { fs / 2.0 - frequency_hz } else { frequency_hz };
        let gap = exponential::loss(decay_per_s / fs); // 1 - r, exact for slow decays
        let radius = 1.0 - gap;
        let sine = sine::sin(core::f64::consts::PI * folded_hz / fs);
        let step_squared = gap * gap + 4.0 * radius * sine * sine;
        let (form, epsilon) = match step_squared {
            e2 if e2 < 0.25 => (Form::Coupled, libm::sqrt(e2)),
            e2 if e2 < 1.0 => (Form::Shifted1, e2 / 2.0),
            e2 => (Form::Shifted2, e2 / 4.0),
        };
        let delta = gap * (1.0 + radius);
        Some(Self { form, mirrored, coefficients: Coefficients { delta: q32_from(delta), epsilon: q32_from(epsilon) } })
    }
}

const TWO_POW_32: f64 = 4294967296.0;

/// Nearest Q32; at 1/2 exactly (f = fs/4, no decay) the largest Q32 below.
fn q32_from(value: f64) -> i32 {
    libm::rint(value * TWO_POW_32) as i32
}

impl Pole {
    /// Sums over the mode's free vibration, `Σ_{n>=0} r^n sin nθ` and `Σ_{n>=0} r^n cos nθ`: the
    /// final responses of both phases to a constant force.
    ///
    /// With p = r e^{iθ} they are `r sin θ / |1-p|²` and `(1 - r cos θ) / |1-p|²`, and |1-p|² is
    /// the e² of the form (`4 - 2δ - e²` if the mode is mirrored). From the quantised coefficients;
    /// relative error 1e-6.
    pub fn sums(self) -> (f32, f32) {
        Turn::new(self.form, self.coefficients).sums(self.mirrored)
    }
}

/// Geometry of a pole after quantisation.
pub(super) struct Turn {
    form: Form,
    delta: f32,
    e: f32,
    e_squared: f32,
    /// `1 - r cos θ`.
    gap_cosine: f32,
    /// `r sin θ`.
    radius_sine: f32,
}

impl Turn {
    pub(super) fn new(form: Form, coefficients: Coefficients) -> Self {
        let (delta, e, e_squared) = steps(form, coefficients);
        // r² sin²θ = e² - ((δ + e²)/2)², factored so that low frequencies keep their precision.
        let half = (delta + e_squared) / 2.0;
        let difference = match form {
            Form::Coupled => coupled_difference(coefficients),
            _ => e - half,
        };
        let radius_sine = rounded_root((difference * (e + half)).max(f32::MIN_POSITIVE));
        Self { form, delta, e, e_squared, gap_cosine: half, radius_sine }
    }

    /// [`Pole::sums`] of the pole.
    pub(super) fn sums(&self, mirrored: bool) -> (f32, f32) {
        let (gap_cosine, distance) = match mirrored {
            false => (self.gap_cosine, self.e_squared),
            true => (2.0 - self.gap_cosine, 4.0 - 2.0 * self.delta - self.e_squared),
        };
        // The lowest mode that a kit may have, 0.1 Hz, has e² = 1e-11 at 192 kHz.
        let unit = 1.0 / distance.max(f32::MIN_POSITIVE);
        (self.radius_sine * unit, gap_cosine * unit)
    }

    /// Orbit of the pole. Relative error 1e-6.
    pub(super) fn orbit(&self) -> Orbit {
        let unit = match self.form {
            Form::Coupled => 1.0 / (self.e * (1.0 - self.delta)),
            form => 1.0 / ((1u32 << form.shift()) as f32 * (1.0 - self.delta)),
        };
        let cosine_to_u = (self.e_squared - self.delta) / 2.0 * unit;
        Orbit { sine_to_u: self.radius_sine * unit, cosine_to_u }
    }
}

/// Pole in single precision, to turn gains into injections and states into amplitudes.
///
/// In the coupled form a mode that starts with `v = C` and `u = cs S + cc C` rings as
/// `v[n] = r^n (S sin nθ + C cos nθ)`, with `cs = r sin θ / (e r²)` and `cc = (e² - δ) / (2 e r²)`;
/// the shifted form's u is e/2^k of that.
#[derive(Clone, Copy, Debug)]
pub struct Orbit {
    /// `cs` of the form.
    sine_to_u: f32,
    /// `cc` of the form.
    cosine_to_u: f32,
}

impl Orbit {
    /// Derives the orbit of quantised coefficients. Relative error 1e-6.
    pub fn new(form: Form, coefficients: Coefficients) -> Self {
        Turn::new(form, coefficients).orbit()
    }

    /// State (u, v) that rings as `sine · sin nθ + cosine · cos nθ`.
    pub fn state(self, sine: f32, cosine: f32) -> (f32, f32) {
        (self.sine_to_u * sine + self.cosine_to_u * cosine, cosine)
    }

    /// The (sine, cosine) with which a state rings.
    pub fn phases(self, u: f32, v: f32) -> (f32, f32) {
        ((u - self.cosine_to_u * v) / self.sine_to_u, v)
    }
}

/// `e - (δ + e²)/2` of the coupled form, exact in Q64 before it is rounded. If a decay is much
/// faster than the mode's turn, almost nothing is left of the two.
fn coupled_difference(coefficients: Coefficients) -> f32 {
    let (delta, e) = (i64::from(coefficients.delta), i64::from(coefficients.epsilon));
    // Both are below 2^31, so that neither term reaches 2^63.
    ((e << 32) - ((delta << 31) + ((e * e) >> 1))) as f32 / (TWO_POW_32 * TWO_POW_32) as f32
}

impl Coefficients {
    /// Coefficients of the same frequency with a faster decay: δ is raised to `choke_delta` (Q32)
    /// and the step follows, `e'² - e² = (r-r') (2-r-r' - (e²-(1-r)²)/r)`. Unchanged if the mode
    /// already decays faster.
    ///
    /// The change alone is in single precision, and added in Q32: a choked mode keeps its phase
    /// within 7e-9 rad a frame
    /// (`cargo test -p dsp-core a_choke_keeps_the_frequency -- --nocapture`).
    pub fn choked(self, form: Form, choke_delta: i32) -> Self {
        if choke_delta <= self.delta {
            return self;
        }
        let unit = TWO_POW_32 as f32;
        let (delta, e, e_squared) = steps(form, self);
        let choked = choke_delta as f32 / unit;
        let (radius, choked_radius) = (rounded_root(1.0 - delta), rounded_root(1.0 - choked));
        // 1 - r = δ / (1 + r) does not cancel, nor does the difference of both δ in Q32.
        let (gap, choked_gap) = (delta / (1.0 + radius), choked / (1.0 + choked_radius));
        let lost = (choke_delta - self.delta) as f32 / unit / (radius + choked_radius); // r - r'
        let change = lost * (gap + choked_gap - (e - gap) * (e + gap) / radius);
        let epsilon = match form {
            Form::Coupled => change / (e + rounded_root((e_squared + change).max(0.0))),
            _ => change / (1u32 << form.shift()) as f32,
        };
        // A step below 1/2 moves by less than 1/2; e' is not negative.
        Self { delta: choke_delta, epsilon: (self.epsilon + libm::rintf(epsilon * unit) as i32).max(0) }
    }
}

/// Share of itself by which a coupled form's u grows when its step goes from `from` to `to`:
/// `e/e' - 1`.
///
/// The form adds `e u` to v, so that u times e is the last movement of v: the sample before stays
/// as it was. A share, unlike a factor, keeps a small change exact: the sum that it goes into keeps
/// all its bits.
pub fn change_of_u(from: Coefficients, to: Coefficients) -> f32 {
    match to.epsilon {
        0 => 0.0,
        // Both are in [0, 2^31).
        step => (from.epsilon - step) as f32 / step as f32,
    }
}

/// [`change_of_u`] in Q32; `None` above `largest` in either direction.
pub fn q32_change_of_u(from: Coefficients, to: Coefficients, largest: u32) -> Option<i32> {
    let change = (change_of_u(from, to) * TWO_POW_32 as f32) as i32; // `as` saturates
    (change.unsigned_abs() <= largest).then_some(change)
}

/// Largest factor, at least 1, by which a change between two decays changes a mode's amplitude in
/// either direction: `(1 + (1 - ρ) / θ) / ρ`, ρ the smaller radius over the larger, because the
/// sine becomes `ρ S + (1 - ρ) C cot θ`.
pub fn growth_of_change(frequency_hz: f64, rest_decay_per_s: f64, choked_decay_per_s: f64, rate: SampleRate) -> f64 {
    let fs = rate.hz();
    let folded_hz = if frequency_hz > fs / 4.0 { fs / 2.0 - frequency_hz } else { frequency_hz };
    let angle = core::f64::consts::TAU * folded_hz / fs; // 1/θ is above cot θ
    let lost = exponential::loss((choked_decay_per_s - rest_decay_per_s).max(0.0) / fs); // 1 - ρ
    (1.0 + lost / angle) / (1.0 - lost)
}

/// Decay in 1/s of modes under a hand of a T60.
pub fn decay_of_t60(t60_s: f64, rate: SampleRate) -> f64 {
    (core::f64::consts::LN_10 * 3.0 / t60_s).min(max_decay_per_s(rate))
}

/// Q32 δ of modes under a hand of a T60.
pub fn delta_of_t60(t60_s: f64, rate: SampleRate) -> i32 {
    q32_from(exponential::loss(2.0 * decay_of_t60(t60_s, rate) / rate.hz()))
}

/// δ, e and e² after quantisation.
fn steps(form: Form, coefficients: Coefficients) -> (f32, f32, f32) {
    let unit = TWO_POW_32 as f32;
    let (delta, epsilon) = (coefficients.delta as f32 / unit, coefficients.epsilon as f32 / unit);
    match form {
        Form::Coupled => (delta, epsilon, epsilon * epsilon),
        _ => {
            let e_squared = epsilon * (1u32 << form.shift()) as f32;
            (delta, rounded_root(e_squared), e_squared)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frequency and decay of the pole that quantised coefficients realise.
    fn realised(pole: Pole, fs: f64) -> (f64, f64) {
        let delta = f64::from(pole.coefficients.delta) / TWO_POW_32;
        let epsilon = f64::from(pole.coefficients.epsilon) / TWO_POW_32;
        let e_squared = match pole.form {
            Form::Coupled => epsilon * epsilon,
            _ => epsilon * f64::from(1 << pole.form.shift()),
        };
        let gap = -libm::expm1(libm::log1p(-delta) / 2.0);
        let sine = libm::sqrt((e_squared - gap * gap) / (4.0 * (1.0 - gap)));
        let folded = libm::asin(sine) * fs / core::f64::consts::PI;
        let frequency = if pole.mirrored { fs / 2.0 - folded } else { folded };
        (frequency, -fs * libm::log1p(-delta) / 2.0)
    }

    #[test]
    fn quantised_poles_keep_frequency_and_decay() {
        let (mut worst_cent, mut worst_decay) = (0.0f64, 0.0f64);
        for rate in [SampleRate::HZ_44100, SampleRate::HZ_48000] {
            let fs = rate.hz();
            for step in 0..400 {
                let frequency = (f64::from(step) / 399.0 * (0.499 * fs).ln()).exp();
                for t60 in [0.001, 0.05, 0.2, 1.0, 5.0, 20.0, 120.0] {
                    let decay = 1000f64.ln() / t60;
                    if decay > 0.5 * core::f64::consts::TAU * frequency {
                        continue; // barely a mode: its frequency means nothing
                    }
                    let pole = Pole::new(frequency, decay, rate).unwrap();
                    let (got_frequency, got_decay) = realised(pole, fs);
                    worst_cent = worst_cent.max((1200.0 * (got_frequency / frequency).log2()).abs());
                    worst_decay = worst_decay.max((got_decay / decay - 1.0).abs());
                }
            }
        }
        assert!(worst_cent < 0.004, "{worst_cent} cent");
        assert!(worst_decay < 1e-4, "{worst_decay}");
    }

    #[test]
    fn sums_of_a_vibration_are_those_of_the_geometric_series() {
        for rate in [SampleRate::HZ_44100, SampleRate::HZ_48000] {
            let fs = rate.hz();
            for (frequency, decay) in [
                (20.0, 0.3),
                (98.0, 15.0),
                (1_000.0, 900.0),
                (4_500.0, 40.0),
                (9_000.0, 1.0),
                (13_000.0, 30.0),
                (21_900.0, 6.0),
            ] {
                let (radius, angle) = ((-decay / fs).exp(), core::f64::consts::TAU * frequency / fs);
                let distance = (1.0 - radius).powi(2) + 4.0 * radius * (angle / 2.0).sin().powi(2);
                let (sine, cosine) = Pole::new(frequency, decay, rate).unwrap().sums();
                let expected = [radius * angle.sin() / distance, (1.0 - radius * angle.cos()) / distance];
                for (got, expected) in [sine, cosine].into_iter().zip(expected) {
                    let size = (radius / distance.sqrt()).max(0.5);
                    assert!((f64::from(got) - expected).abs() < 2e-6 * size, "{frequency} Hz: {got}, not {expected}");
                }
            }
        }
    }

    #[test]
    fn modes_at_or_above_nyquist_have_no_pole() {
        assert_eq!(Pole::new(24_000.0, 1.0, SampleRate::HZ_48000), None);
        assert!(Pole::new(23_999.0, 1.0, SampleRate::HZ_48000).is_some_and(|pole| pole.mirrored));
    }

    #[test]
    fn forms_change_where_their_coefficients_would_leave_q32() {
        let form = |hz| Pole::new(hz, 1.0, SampleRate::HZ_48000).unwrap();
        assert_eq!(form(3_800.0).form, Form::Coupled);
        assert_eq!(form(3_900.0).form, Form::Shifted1);
        assert_eq!(form(7_900.0).form, Form::Shifted1);
        assert_eq!(form(8_100.0).form, Form::Shifted2);
        assert_eq!((form(11_999.0).form, form(11_999.0).mirrored), (Form::Shifted2, false));
        assert_eq!((form(12_000.0).form, form(12_000.0).mirrored), (Form::Shifted2, false));
        assert_eq!((form(12_001.0).form, form(12_001.0).mirrored), (Form::Shifted2, true));
        assert_eq!((form(23_000.0).form, form(23_000.0).mirrored), (Form::Coupled, true));
    }

    #[test]
    fn a_choke_keeps_the_frequency() {
        let rate = SampleRate::HZ_48000;
        let mut worst = 0.0f64;
        for frequency in [30.0, 440.0, 1_729.0, 3_500.0, 5_000.0, 11_000.0, 20_000.0] {
            for choke_t60_s in [0.01, 0.1, 0.46, 2.0] {
                let pole = Pole::new(frequency, 0.5, rate).unwrap();
                let choked = pole.coefficients.choked(pole.form, delta_of_t60(choke_t60_s, rate));
                let (got, decay) = realised(Pole { coefficients: choked, ..pole }, rate.hz());
                assert!((decay / (1000f64.ln() / choke_t60_s) - 1.0).abs() < 1e-6);
                worst = worst.max((got - frequency).abs() * core::f64::consts::TAU / rate.hz());
            }
        }
        std::println!("phase within {worst:.1e} rad a frame");
        assert!(worst < 1e-8, "{worst}");
    }
}
