//! Ticks in which nothing begins or ends, and no modes come: granted several at a time, so that
//! each asks for next to nothing.
//!
//! The bits are those of [`DynamicFilter::render_any`]'s way, which settles the loops on each tick:
//! between the ends of their windows that changes nothing but where a state or the line has left
//! the bounds of its scaling, at which the grant ends.

use super::kernel;
use super::object::DynamicFilter;
use crate::time::TICK_FRAMES;

impl DynamicFilter<'_> {
    /// Grants whole ticks, if a tick begins and is one, and begins it.
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

    /// Takes back what is left of the whole ticks that were granted.
    pub(super) fn settle_whole_ticks(&mut self) {
        let passed = self.granted - self.whole_ticks;
        self.filter.pass(passed);
        self.loops.pass(passed);
        (self.granted, self.whole_ticks) = (0, 0);
    }

    /// One of the whole ticks.
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
