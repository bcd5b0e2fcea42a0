//! Exchange of a mode's coefficients for those under a hand, and back.

use core::ops::Range;

use super::super::coefficient::{Coefficients, change_of_u};
use super::super::mode::Mode;
use super::origin::{Origin, grown};
use crate::fixed;

/// Largest share by which a u grows or shrinks for which [`inverse`] holds.
pub(super) const LARGEST_SHARE: u32 = 1 << 24;

/// Grows both numbers of a mode that belong to u by a share of themselves.
pub(super) fn grow(mode: &mut Mode, share: f32) {
    mode.gain.u = grown(mode.gain.u, share);
    mode.state.u = grown(mode.state.u, share);
}

/// Gives the modes at places of the table's order the coefficients that they have with a hand
/// (`LIES`) or without. Calls `scale` with the slot of each mode of the coupled form, the mode, its
/// share and its former coefficients.
#[inline(always)]
pub(super) fn exchange<const LIES: bool>(
    modes: &mut [Mode],
    origins: &mut [Origin],
    places: Range<usize>,
    mut scale: impl FnMut(usize, &mut Mode, i32, Coefficients),
) {
    // Both have one length: one check a mode.
    let count = modes.len().min(origins.len());
    let (Some(modes), Some(origins)) = (modes.get_mut(..count), origins.get_mut(..count)) else { return };
    for place in places {
        let Some(slot) = origins.get(place).map(|origin| usize::from(origin.slot)) else { return };
        let (Some(mode), Some(origin)) = (modes.get_mut(slot), origins.get_mut(slot)) else { return };
        let flags = origin.index_and_flags;
        if (flags & Origin::HELD != 0) == LIES {
            continue;
        }
        origin.index_and_flags = flags ^ Origin::HELD;
        let from = core::mem::replace(&mut mode.coefficients, origin.other);
        origin.other = from;
        if flags & Origin::COUPLED != 0 {
            scale(slot, mode, origin.share, from);
        }
    }
}

/// Exchanges coefficients, and grows a mode's u and the gain into it by the mode's share.
#[inline(always)]
pub(super) fn exchange_quickly<const LIES: bool>(modes: &mut [Mode], origins: &mut [Origin], places: Range<usize>) {
    exchange::<LIES>(modes, origins, places, |_, mode, share, from| {
        if share == 0 {
            return grow_much(mode, from);
        }
        let share = if LIES { share } else { inverse(share) };
        // A gain has headroom, and a state stays within its own.
        mode.gain.u = mode.gain.u.wrapping_add(fixed::smmulr(mode.gain.u, share));
        mode.state.u = mode.state.u.wrapping_add(fixed::smmulr(mode.state.u, share));
    });
}

/// Grows u of a low mode, for which [`inverse`] is not precise enough.
#[cold]
#[inline(never)]
fn grow_much(mode: &mut Mode, from: Coefficients) {
    grow(mode, change_of_u(from, mode.coefficients));
}

/// `1/(1 + s) - 1` in Q32 for an s below [`LARGEST_SHARE`], within 2^-31: undoes the growth by s.
#[inline(always)]
fn inverse(share: i32) -> i32 {
    let square = fixed::smmulr(share, share);
    square - share - fixed::smmulr(square, share)
}
