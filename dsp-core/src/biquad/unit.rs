//! Units of a bank: what is scaled and put to rest together.

use super::pair::Pair;

/// Gives the units of a slice: single pairs, and twos of pairs whose sections stand in a row.
pub(super) fn units(pairs: Option<&mut [Pair]>) -> impl Iterator<Item = &mut [Pair]> {
    let mut rest = pairs.unwrap_or(&mut []);
    core::iter::from_fn(move || {
        let tails = rest.iter().skip(1).take_while(|pair| pair.is_tail()).count();
        let unit = rest.split_off_mut(..rest.len().min(1 + tails))?;
        (!unit.is_empty()).then_some(unit)
    })
}

/// Returns true if a unit without input will still be heard; clears it and leaves it out if not.
pub(super) fn rings_on(unit: &mut [Pair]) -> bool {
    let is_heard = unit.iter().any(|pair| !pair.is_skipped() && pair.sound_bits() > 0);
    if !is_heard {
        unit.iter_mut().for_each(Pair::rest);
    }
    is_heard
}
