//! Headroom: the proof that no state can wrap.
//!
//! **Measure.** The size of a mode's state is `s = max(|u| · 2^k, |v|)`, k the shift of its form (0
//! for the coupled one).
//!
//! **Growth.** Without input a mode's exact orbit is `v[n] = r^n (S sin nθ + C cos nθ)`, an ellipse
//! that shrinks by r a sample. From a state of size s neither `|v|`, `|u|` nor the intermediate
//! `|u| · 2^k` ever exceeds [`GROWTH`] · s along it, for every r, θ and form that
//! [`super::coefficient::Pole::new`] can choose. The bound follows from the ellipse's axes: with
//! `δ = 0` the form `u² + v² - e u v` is invariant, so that
//! `v² <= (u² + v² + e|u v|) / (1 - e²/4)`. That is 2.67 s² for the coupled form at e = 1/2 and,
//! with `|u| <= s/e` in coupled units, at most 6.4 s² for the shifted ones; decay only shrinks the
//! orbit. The test `an_orbit_never_grows_beyond_its_bound` walks the whole range of coefficients
//! from the four corners of the square `s = 1`, which are the extreme points of all starts.
//!
//! **Input.** The map is linear: the injection of a force sample x begins an orbit of its own, of
//! size at most `G |x| 2^-32`, G the largest gain of the group. So over a run of frames in which
//! the sum of |x| is at most an allowance X, every state stays below
//! `GROWTH · (s + G X 2^-32 + rounding)`.
//!
//! **Guard.** At every tick, and whenever a force has used up its allowance, the guard of
//! [`super::group::Group`] shifts the group's states so that the bracket is below [`LIMIT`].
//! `GROWTH · LIMIT = 2^31` exactly, hence nothing wraps before the next guard. If even the smallest
//! exponent cannot hold the input, the input is refused for that run: an amplitude of +160 dBFS,
//! which only a fault can bring.
//!
//! **Weak forces.** A gain multiplier must stay below 1/2, which would keep the states of a weak
//! force small and its rounding noise large. So the bank shifts the force left, as far as its
//! allowance permits, and the gains right.
//!
//! **Mix.** The bank adds `v · 2^-(exponent + m)` of all modes with a plain add. Its mix exponent m
//! is chosen at every guard such that the sum of the modes' bounds stays below 2^31, and is undone
//! by one saturating shift a frame.

/// State size to which a group is normalised: it lies in `[LIMIT/2, LIMIT)` while it rings freely.
pub const LIMIT: u64 = 1 << 29;

/// Bound of the growth of a state along its orbit. Measured over all coefficients: 3.31
/// (`cargo test -p dsp-core orbit -- --nocapture`).
pub const GROWTH: u64 = 4;

/// Bound of the growth of v alone, which the mix adds. Measured: 2.54.
pub const GROWTH_OF_V: u64 = 3;

/// Size that rounding may add to a state between two guards: half a step for each of five roundings
/// a sample, over 32 samples, with the growth of each; and the rounding of the gain itself.
pub const ROUNDING: u64 = 128;

#[cfg(test)]
mod tests {
    use super::super::coefficient::{Form, Pole};
    use super::*;
    use crate::SampleRate;

    #[test]
    fn an_orbit_never_grows_beyond_its_bound() {
        assert_eq!(GROWTH * LIMIT, 1 << 31);
        let rate = SampleRate::HZ_48000;
        let (mut worst, mut worst_v) = (0.0f64, 0.0f64);
        for frequency_step in 0..1500 {
            let frequency = 0.1 * (239_990.0f64).powf(f64::from(frequency_step) / 1499.0);
            for t60 in [0.000_45, 0.000_6, 0.001, 0.002, 0.01, 0.1, 1.0, 100.0] {
                let Some(pole) = Pole::new(frequency, 1000f64.ln() / t60, rate) else { continue };
                let delta = f64::from(pole.coefficients.delta) / 2f64.powi(32);
                let epsilon = f64::from(pole.coefficients.epsilon) / 2f64.powi(32);
                let scale = f64::from(1 << pole.form.shift());
                for start in [1.0, -1.0] {
                    let (mut u, mut v) = (1.0 / scale, start);
                    for _ in 0..3000 {
                        u -= delta * u;
                        u -= epsilon * v;
                        v += if pole.form == Form::Coupled { epsilon * u } else { u * scale };
                        worst = worst.max((u * scale).abs()).max(v.abs());
                        worst_v = worst_v.max(v.abs());
                        if u.abs() + v.abs() < 0.1 {
                            break;
                        }
                    }
                }
            }
        }
        std::println!("growth: {worst:.3} of the state, {worst_v:.3} of v");
        assert!(worst < GROWTH as f64 && worst_v < GROWTH_OF_V as f64, "{worst} {worst_v}");
    }
}
