//! Sections under a hand: after each frame a chain's states are multiplied by κ, input included.
//!
//! That moves all poles p of the chain to κp, in every form of the states. The sound goes on
//! without a step when the hand comes and when it goes. No kernel knows of the hand: a section has
//! a second pole with the same v, and its u is converted whenever the poles are exchanged.
//!
//! ```text
//! free:   v' = (1 - e²) v + t u                  t: what of u reaches v (the form's `entry`)
//! choked: v' = (1 - e_c²) v + t_c u_c            e_c² = |1 - κp|²
//!
//! The next choked output must be κ times the next free one:
//!
//! u_c = (κ t / t_c) u + (κ (1 - e²) - (1 - e_c²)) / t_c v
//! ```
//!
//! The gains g_u and g_v are converted like u and v, times κ. A section hands on κ² times as much.

use super::design::Root;
use super::fractions::{Part, Realised};
use super::pole::Pole;

/// Gains of u and of v into a section's new u.
pub(super) type Turn = [f64; 2];

/// Parts of a unit under the hand, with the conversions of u: `there` as it comes, `back` as it
/// goes.
pub(super) struct Choked {
    pub(super) parts: [Part<Pole>; 4],
    pub(super) there: [Turn; 4],
    pub(super) back: [Turn; 4],
}

/// Conversion that leaves u unchanged.
const SAME: Turn = [1.0, 0.0];

impl Choked {
    /// Derives the choked parts of at most four parts; `kept` is κ, above 0 and at most 1.
    pub(super) fn of(parts: &[Part<Pole>], kept: f64) -> Self {
        let mut new = Self { parts: [Part::EMPTY; 4], there: [SAME; 4], back: [SAME; 4] };
        for (slot, &part) in new.parts.iter_mut().zip(parts) {
            *slot = part;
        }
        if kept >= 1.0 {
            return new;
        }
        let root = |part: &Part<Pole>| moved(part.pole, kept);
        // All parts of a unit share a form.
        let form_of = |part: &Part<Pole>| Pole::form_of(root(part), part.pole.mirrored);
        let Some(form) = parts.iter().map(form_of).max() else { return new };
        for (((slot, part), there), back) in new.parts.iter_mut().zip(parts).zip(&mut new.there).zip(&mut new.back) {
            let pole = Pole::new(root(part), part.pole.mirrored, &form);
            let (before, after) = (part.pole.entry(), pole.entry());
            let of_v = kept * (1.0 - part.pole.step_squared()) - (1.0 - pole.step_squared());
            (*there, *back) =
                ([kept * before / after, of_v / after], [after / (kept * before), -of_v / (kept * before)]);
            let ([gain_u, gain_v], [of_u, of_v]) = (part.gains, *there);
            let gains = [kept * (of_u * gain_u + of_v * gain_v), kept * gain_v];
            *slot = Part { pole, gains, handed: kept * kept * part.handed };
        }
        new
    }
}

/// Pole κp of a realised pole p, without cancellation for slow poles.
fn moved(pole: Pole, kept: f64) -> Root {
    let (delta, step) = (pole.delta(), pole.step_squared());
    let half = 0.5 * (delta + step);
    let real = kept * if pole.mirrored { half - 1.0 } else { 1.0 - half };
    Root { real, imaginary: kept * libm::sqrt((step - half * half).max(0.0)) }
}
