//! Modes at the zeros of all contacts: errors of the contacts' form, which no strike tells.

use std::f64::consts::PI;

use super::contact::strength;
use super::model::{Model, Strike};

/// Share of a contact's strength without its zeros below which a mode lies at a zero: -30 dB.
///
/// Half-sines have zeros at `(k + 1/2)/τ`, k from 1 on. Errors of a contact's form ring there in
/// none of the modes. A mode takes them up with a gain that is large by as much as the contact is
/// weak, and would ring loudly with any other contact time.
const AT_ZERO: f64 = 0.03;

/// Modes that lie at a zero of each contact that rings them.
pub(super) fn modes_at_zeros(model: &Model) -> Vec<usize> {
    let is_at_zero = |mode: &usize| {
        let exponent = model.exponent(*mode);
        let is_weak = |strike: &Strike| {
            let p = PI / strike.contact.time;
            let without_zeros = 2.0 * p / (exponent.norm_sqr() + p * p);
            strength(exponent, strike.contact.time).value.norm() < AT_ZERO * without_zeros
        };
        model.strikes.iter().filter(|strike| model.rings(*mode, strike)).all(is_weak)
    };
    (0..model.poles.len()).filter(is_at_zero).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;
    use crate::modes::Pole;
    use crate::multi_strike::contact::Contact;

    #[test]
    fn modes_at_a_zero_of_all_contacts_are_told_and_no_others() {
        let strike = |time: f64| {
            let contact = Contact { middle: 100.0, time, peak: 1.0 };
            Strike { contact, position: 0.0, striker: 0 }
        };
        let zero = |k: f64| 2.0 * PI * (k + 0.5) / 48.0;
        let pole = |angular: f64| Pole { decay: 1e-5, angular };
        let mut model = Model {
            poles: vec![pole(zero(1.0)), pole(zero(2.0) * 1.03), pole(zero(3.0)), pole(zero(0.0))],
            gains: vec![vec![Complex::new(1.0, 0.0)]; 4],
            owners: vec![None; 4],
            acceleration: 0.0,
            contact_times_are_held: false,
            shapes_are_real: false,
            strikes: vec![strike(48.0), strike(48.01)],
        };
        // The first zero of the half-sine's cosine, at 1/(2τ), is none: a pole cancels it.
        assert_eq!(modes_at_zeros(&model), [0, 2]);
        model.strikes.push(strike(46.0));
        assert!(modes_at_zeros(&model).is_empty());
    }
}
