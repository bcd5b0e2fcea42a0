//! Ticks in which nothing begins or ends, and no modes come. Several of them are granted at a time,
//! so that each tick takes hardly any bookkeeping.
//!
//! The bits are those of [`DynamicFilter::render_any`], which settles the loops on each tick.
//! Between the ends of the loops' windows, settling changes nothing as long as the states and the
//! line keep within the bounds of their scaling. The grant ends when one of them does not.

use super::kernel;
use super::object::DynamicFilter;
use crate::time::TICK_FRAMES;

impl DynamicFilter<'_> {
    /// Grants whole ticks and begins the first of them. Returns false if no tick begins, or if
    /// something begins or ends in it.
    #[inline(always)]
    pub(super) fn renew(&mut self) -> bool {
        let begins = self.ringing && self.frame == 0 && self.left == 0;
        begins && !self.plain && !self.modes_through && self.renew_any()
    }

    #[inline(never)]
    fn renew_any(&mut self) -> bool {
        self.settle_whole_ticks();
        let looped = self.loops.count() > 0;
        let of_path = self.filter.whole_ticks(looped);
        if of_path == 0 || (looped && self.loops.whole_ticks() == 0) {
            return false;
        }
        self.settle();
        if self.ringing {
            self.granted = if looped { of_path.min(self.loops.whole_ticks()) } else { of_path };
            self.whole_ticks = self.granted;
        }
        self.ringing
    }

    /// Counts the granted ticks that have passed, and takes back those that are left.
    pub(super) fn settle_whole_ticks(&mut self) {
        let passed = self.granted - self.whole_ticks;
        self.filter.pass(passed);
        self.loops.pass(passed);
        (self.granted, self.whole_ticks) = (0, 0);
    }

    /// Renders one of the granted whole ticks.
    #[inline(never)]
    pub(super) fn run_tick(&mut self, out: &mut [i32; TICK_FRAMES]) {
        if self.looped && self.noisy {
            self.filter.tick_lines();
            let (noise, level) = self.filter.noise_of_sums();
            self.loops.add_to_noise(noise, level, kernel::noise);
            self.filter_sums(out);
        } else {
            if self.filter.is_under_way() {
                self.noisy = self.filter.tick();
            }
            if self.loops.count() == 0 {
                return self.run(&[], out);
            }
            self.run_looped(&[], out);
        }
        if !self.loops.is_settled() {
            self.granted -= self.whole_ticks;
            self.whole_ticks = 0;
        }
    }
}
