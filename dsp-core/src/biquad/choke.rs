//! Sections under a hand: after each frame a chain's states are multiplied by κ, and so is what an input has put into them.
//!
//! That moves all its poles p to κp, whatever form the states have; the sound goes on without a step, when the hand comes and when it goes. No kernel
//! knows of it: a section has a second pole with the same v, and its u is turned into the other's on the way there and back.
//!
//! ```text
//! free:   v' = (1 - e²) v + t u                  t: what of u reaches v (the form's `entry`)
//! choked: v' = (1 - e_c²) v + t_c u_c            e_c² = |1 - κp|²;  the next output is to be κ times the free one:
//!
//! u_c = (κ t / t_c) u + (κ (1 - e²) - (1 - e_c²)) / t_c v,   gains: κ times the same of g_u and g_v,   handed on: κ² as much
//! ```

use super::design::Root;
use super::fractions::{Part, Realised};
use super::pole::Pole;

/// What a cell's u becomes: so much of u and so much of v.
pub(super) type Turn = [f64; 2];

/// A unit's parts under the hand, and of each what its u becomes there and back.
pub(super) struct Choked {
    pub(super) parts: [Part<Pole>; 4],
    pub(super) there: [Turn; 4],
    pub(super) back: [Turn; 4],
}

/// As it is.
const SAME: Turn = [1.0, 0.0];

impl Choked {
    /// `kept` is κ, above 0 to 1. As many parts are in use as are given, at most four.
    pub(super) fn of(parts: &[Part<Pole>], kept: f64) -> Self {
        let mut new = Self { parts: [Part::EMPTY; 4], there: [SAME; 4], back: [SAME; 4] };
        for (slot, &part) in new.parts.iter_mut().zip(parts) {
            *slot = part;
        }
        if kept >= 1.0 {
            return new;
        }
        let root = |part: &Part<Pole>| moved(part.pole, kept);
        // One form that serves all of a unit.
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

/// κp of a pole as it is realised, without cancellation where it is slow.
fn moved(pole: Pole, kept: f64) -> Root {
    let (delta, step) = (pole.delta(), pole.step_squared());
    let half = 0.5 * (delta + step);
    let real = kept * if pole.mirrored { half - 1.0 } else { 1.0 - half };
    Root { real, imaginary: kept * libm::sqrt((step - half * half).max(0.0)) }
}
