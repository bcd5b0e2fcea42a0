//! Nominal cycles of the pieces of the mixer's work, and of a bank's share.

use super::bank::{FrameBank, SLOTS};
use super::{BLOCK_FRAMES, LINES, TICKS, spectrum};
use crate::fourier;
use crate::time::TICK_FRAMES;

/// Cycles of a block's work that are to be done by the end of a tick, counted from 0, of `all`. The
/// first tail, if it has any cycles, is to be ready within a number of ticks.
pub(super) fn due(tick: usize, all: u32, first_tail: (u32, u32)) -> u32 {
    let even = (all / TICKS as u32) * (tick as u32 + 1);
    match (tick, first_tail) {
        (tick, _) if tick + 1 >= TICKS => u32::MAX,
        (_, (0, _)) => even,
        (tick, (cycles, ticks)) => {
            let earliest = cycles / ticks.max(1) * (tick as u32 + 1);
            even.saturating_add_signed(ahead(tick as i32, ticks as i32)).max(earliest.min(cycles))
        }
    }
}

/// Cycles of a bank's work on the next block up to its lines.
pub(super) fn bank_cycles(bank: &FrameBank<'_>) -> u32 {
    let (modes, lines) = (bank.modes.len() as u32, LINES as u32);
    let synthesis = |modes: u32| CLEAR + lines * SYNTHESIS_LINE + modes * SYNTHESIS_MODE;
    let forced = (0..SLOTS).filter(|&slot| bank.to_gather(slot).is_some());
    let of_forces: u32 = forced
        .map(|slot| {
            let of_mode = GATHER_MODE + if bank.is_to_derive(slot) { DERIVED_MODE } else { 0 };
            let tail = if bank.tail_response(slot).is_some() { TAIL } else { 0 };
            FORCE + tail + lines * GATHER_LINE + modes * of_mode
        })
        .sum();
    match (of_forces, bank.ringing) {
        (0, 0) => 0,
        (0, ringing) => fade_cycles(bank) + synthesis(ringing.into()),
        _ => fade_cycles(bank) + of_forces + synthesis(modes),
    }
}

/// Cycles in which a hand takes its share of a bank's states.
pub(super) fn fade_cycles(bank: &FrameBank<'_>) -> u32 {
    if bank.hand.now().is_some() { bank.modes.len() as u32 * FADED_MODE } else { 0 }
}

/// Nominal cycles of pieces of the work: a line and a mode of the kernels, a pair of lines of a
/// force, a line that is panned (`cargo test -p host-tests --test on_chip frames`).
pub(super) const GATHER_LINE: u32 = 25;
pub(super) const SYNTHESIS_LINE: u32 = 90;
pub(super) const GATHER_MODE: u32 = 94;
pub(super) const SYNTHESIS_MODE: u32 = 105;
/// Nominal cycles of a mode whose gain is derived for another position.
pub(super) const DERIVED_MODE: u32 = 90;
/// Nominal cycles of a frame that plays, and of a tick beside its share of the work.
pub(super) const PLAY_FRAME: u32 = 47;
pub(super) const TICK: u32 = 2_900;
/// Nominal cycles of a state that a hand makes smaller, and of two steps of a bank's own block: a
/// pair of lines on the way to its transform, a frame that joins the other banks.
pub(super) const FADED_MODE: u32 = 12;
pub(super) const HALVE: u32 = 58;
pub(super) const JOIN: u32 = 40;
/// Nominal cycles from the lines of a bank to its own block under a hand.
pub(super) const ALONE: u32 =
    spectrum::PAIRS as u32 * HALVE + fourier::cycles(BLOCK_FRAMES) + BLOCK_FRAMES as u32 * JOIN;
/// Nominal cycles of a silent block, for banks that are all under a hand.
pub(super) const SILENCE: u32 = 3_000;
pub(super) const UNFOLD: u32 = 66;
pub(super) const PAN: u32 = 28;
/// Nominal cycles of the preparation of a force, and of the clearing of lines.
pub(super) const FILL: u32 = 3_800;
pub(super) const CLEAR: u32 = 1_800;
/// Nominal cycles of a line of a tail without the window, of a pair of lines of its spectrum, of
/// its rounding, and of all of it.
pub(super) const UNWINDOW: u32 = 29;
pub(super) const COMBINE: u32 = 75;
pub(super) const PUT: u32 = 7_600;
pub(super) const TAIL: u32 =
    BLOCK_FRAMES as u32 * UNWINDOW + spectrum::PAIRS as u32 * COMBINE + fourier::cycles(BLOCK_FRAMES) + PUT;
/// Nominal cycles in which all modes of a bank begin to ring.
pub(super) const WAKE: u32 = 2_200;
/// Nominal cycles of the lines of a force.
pub(super) const FORCE: u32 = FILL + fourier::cycles(BLOCK_FRAMES) + spectrum::PAIRS as u32 * UNFOLD + WAKE;
/// Nominal cycles of a product of the head.
pub(super) const PRODUCT: u32 = 2;
/// Number of samples of the last block whose products cost less than a tail at any rate.
pub(super) const LEAST_SPAN: u32 = TAIL / PRODUCT / BLOCK_FRAMES as u32;
/// Nominal cycles of a block's beginning for a head with a force, which the first tick pays.
pub(super) const BEGIN_FORCE: u32 = 4_500;
/// Those cycles less what the products of the first tick cost less than those of the second, for a
/// block whose tail a transform makes.
pub(super) const BEGIN_TAIL: u32 = 2_000;
/// Least number of ticks in which a bank's tail is made.
pub(super) const TAIL_TICKS: u32 = 2;

/// Cycles by which the work is ahead of even shares at the end of a tick, in a block whose first
/// tail takes a number of ticks: what the head's products leave of their mean, if force goes on
/// through this block.
const fn ahead(tick: i32, tail_ticks: i32) -> i32 {
    const TICK_PRODUCTS: i32 = TICK_FRAMES as i32 * BLOCK_FRAMES as i32 * PRODUCT as i32;
    // The last block's force takes a block of products a frame until its tail is there, this
    // block's a 16th of it in the middle of the first tick and an 8th more in each tick.
    let (ticks, with_last) = (tick + 1, if tick < tail_ticks { tick + 1 } else { tail_ticks });
    let sixteenths = ticks * (2 * tail_ticks + 8) - ticks * ticks - 16 * with_last;
    sixteenths * (TICK_PRODUCTS / 16)
}

/// Number of frames of a block of its own that join the others in one piece.
pub(super) const FRAMES_AT_ONCE: usize = 64;

/// Number of lines that are panned in one piece.
pub(super) const LINES_AT_ONCE: usize = 64;
