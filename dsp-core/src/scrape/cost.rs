//! Cost of a contact, for the budget.
//!
//! Cycles are nominal: the waits of flash are left out, the engine's own work for a contact is in.
//! The constants were fitted to 2 800 ticks on the virtual core, built for size as the engine is,
//! with twelve contacts at speeds of up to 0.1 to 2.5 m/s: the mean over a contact is right to
//! about 5 %, a single tick to 11 % rms, guards of modes included. Those of a tick and of a ball
//! then follow four scenes, whose predicted and modelled cycles are within 1.5 %:
//! `cargo test -p host-tests --test on_chip the_cost_of_the_scenes -- --nocapture`.

use super::scraper::{Contact, Scraper};
use super::work::Work;

/// Cycles of a touch, and on top of a ball's, and of one that makes a table of powers.
const TOUCH: u32 = 15_000;
const TOUCH_ROLL: u32 = 11_000;
const TOUCH_POWERS: u32 = 25_000;
/// Cycles of a tick that something moves in, beside what follows, and of a map on top.
const TICK: u32 = 5_660;
const MAP: u32 = 3_030;
/// Cycles of a block of a profile or a map.
const BLOCK: [u32; 2] = [1_000, 2_050];
/// Cycles of a value of curvature on a profile or a map, where it is read along a course.
const CURVATURE: [u32; 2] = [37, 128];
/// Cycles of a sixteenth of a point of such a course on a profile or a map.
const SIXTEENTH: [u32; 2] = [2, 7];
/// Cycles of a value of a map that is read place by place.
const PLACE: u32 = 285;
/// Cycles of a frame of slope.
const SLOPE: u32 = 84;
/// Cycles of a frame that is faded.
const FADE: u32 = 33;
/// Cycles of taps that are derived, of each of them, and of one that the tick is filtered with.
const NEW_TAPS: u32 = 200;
const NEW_TAP: u32 = 20;
const TAP: u32 = 52;
/// Cycles of a tick of a ball.
const ROLL: u32 = 4_300;
/// Cycles of a tick of a slope's power.
const POWERS: u32 = 3_000;
/// Dearest tick without the extras, on a profile or a map.
const DEAREST: [u32; 2] = [18_000, 52_000];

/// Tick in which it begins to move, without the extras, on a profile or a map.
const FIRST: [u32; 2] = [9_000, 12_000];

/// Cycles of what there may be.
fn of(is: bool, cycles: u32) -> u32 {
    if is { cycles } else { 0 }
}

impl Contact<'_> {
    /// Nominal cycles of its touch.
    pub(crate) fn touch_cycles(&self) -> u32 {
        TOUCH + of(self.rolling.is_some(), TOUCH_ROLL) + of(self.has_powers(), TOUCH_POWERS)
    }

    /// Nominal cycles of the tick of its touch, in which it may begin to move.
    pub(crate) fn first_tick(&self) -> u32 {
        let [profile, map] = FIRST;
        self.touch_cycles() + self.extras() + if self.is_on_map() { map } else { profile }
    }

    /// Nominal cycles of its dearest tick behind the touch.
    pub(crate) fn dearest_tick(&self) -> u32 {
        let [profile, map] = DEAREST;
        self.extras() + if self.is_on_map() { map } else { profile }
    }

    /// Cycles of ball, power and map in a tick.
    fn extras(&self) -> u32 {
        of(self.rolling.is_some(), ROLL) + of(self.has_powers(), POWERS) + of(self.is_on_map(), MAP)
    }

    fn has_powers(&self) -> bool {
        self.slope[1] != 1.0
    }

    fn is_on_map(&self) -> bool {
        self.surface.rows() > 1
    }
}

impl Scraper<'_> {
    /// Nominal cycles that the last tick took, in which something moved.
    pub fn cycles(&self) -> u32 {
        let (Work { blocks, curvatures, places, sixteenths, slopes, fades }, [new_taps, taps]) = self.work();
        let contact = self.contact();
        let on = |[profile, map]: [u32; 2]| if contact.is_on_map() { map } else { profile };
        let read = blocks * on(BLOCK) + curvatures * on(CURVATURE) + sixteenths * on(SIXTEENTH);
        let read = read + places * PLACE + slopes * SLOPE + fades * FADE;
        let derived = if new_taps == 0 { 0 } else { NEW_TAPS + new_taps * NEW_TAP };
        TICK + read + derived + taps * TAP + contact.extras()
    }
}
