//! Cost of a contact, for the budget.
//!
//! Cycles are nominal: the waits of flash are left out, the engine's own work for a contact is in.
//! The constants were fitted to 2 000 ticks on the virtual core, with seven contacts at 0 to
//! 2.5 m/s. The mean over a contact is right to 1 %, a single tick to 2.5 % rms. Predicted and
//! modelled cycles of four scenes with scraping are printed by
//! `cargo test -p host-tests --test on_chip the_cost_of_the_scenes -- --nocapture`.

use super::scraper::{Contact, Scraper};
use super::slope::Work;

/// Cycles of a touch, and of each table of powers that it makes.
const TOUCH: u32 = 12_500;
const TOUCH_POWERS: u32 = 25_000;
/// Cycles of a tick that something moves in, beside what follows, and of a map on top.
const TICK: u32 = 7_430;
const MAP: u32 = 3_350;
/// Cycles of a block of a profile or a map.
const BLOCK: [u32; 2] = [707, 992];
/// Cycles of a frame of curvature on a profile or a map.
const CURVATURE: [u32; 2] = [111, 316];
/// Cycles of a frame of slope.
const SLOPE: u32 = 195;
/// Cycles of a frame that is faded.
const FADE: u32 = 40;
/// Cycles of a tap that is derived, and of one that the tick is filtered with.
const NEW_TAP: u32 = 56;
const TAP: u32 = 47;
/// Cycles of a tick of a ball.
const ROLL: u32 = 15_100;
/// Cycles of a tick of a slope's power.
const POWERS: u32 = 3_000;
/// Dearest tick without the extras, on a profile or a map.
const DEAREST: [u32; 2] = [27_000, 58_000];

impl Contact<'_> {
    /// Nominal cycles of its touch.
    pub(crate) fn touch_cycles(&self) -> u32 {
        TOUCH + TOUCH_POWERS * (u32::from(self.rolling.is_some()) + u32::from(self.has_powers()))
    }

    /// Nominal cycles of its dearest tick.
    pub(crate) fn dearest_tick(&self) -> u32 {
        let [profile, map] = DEAREST;
        self.extras() + if self.is_on_map() { map } else { profile }
    }

    /// Cycles of ball, power and map in a tick.
    fn extras(&self) -> u32 {
        let of = |is: bool, cycles: u32| if is { cycles } else { 0 };
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
        let (Work { blocks, curvatures, slopes, fades }, [new_taps, taps]) = self.work();
        let contact = self.contact();
        let on = |[profile, map]: [u32; 2]| if contact.is_on_map() { map } else { profile };
        let read = blocks * on(BLOCK) + curvatures * on(CURVATURE) + slopes * SLOPE + fades * FADE;
        TICK + read + new_taps * NEW_TAP + taps * TAP + contact.extras()
    }
}
