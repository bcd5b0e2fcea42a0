//! State of a voice's filters, and what happens to them between runs of frames.

use super::super::choke::ChokeEnvelope;
use crate::biquad::{self, TickKind};
use crate::built::Built;
use crate::dynamic_filter::level::Levels;
use crate::dynamic_filter::{DynamicFilter, FilterSize};
use crate::memory::{Memory, OutOfMemory, Region};
use crate::time::TICK_FRAMES;

/// Number of frames since a strike that lie behind the end of any path.
pub(super) const PAST: u32 = u32::MAX / 2;

/// Size of the filters of a voice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FiltersSize {
    /// Size of the dynamic filter; `None` if there is none.
    pub dynamic: Option<FilterSize>,
    /// Number of biquads; 0 if there are none.
    pub biquads: usize,
}

/// Filters of one voice: a dynamic filter with its loops, and biquads.
#[derive(Debug)]
pub struct Filters<'m> {
    pub(super) dynamic: DynamicFilter<'m>,
    pub(super) biquads: biquad::Bank<'m>,
    /// Worst cycles of a tick in which the dynamic filter sounds, and of one in which the biquads
    /// do.
    pub(crate) worst_cycles: [u32; 2],
    pub(super) has_dynamic: bool,
    pub(super) loop_count: u32,
    /// Bits by which the filter's gain is higher, and its noise, modes and loops lower, than in the
    /// kit.
    pub(super) louder: u32,
    pub(super) choke: ChokeEnvelope,
    /// Level of the dynamic filter's sound along its path: how fast it falls by itself.
    pub(super) levels: Levels<'m>,
    /// Frames since the path began.
    pub(super) since: u32,
    /// True if the last strike found no time for the biquads, so that no force reaches them.
    pub(super) deaf: bool,
    /// True if the last strike excites the biquads and they do not ring yet.
    pub(super) struck: bool,
    /// Frame within the tick up to which both have been rendered.
    pub(super) frame: usize,
}

impl<'m> Filters<'m> {
    /// Filters without a dynamic filter and biquads: silent, at no cost.
    pub const fn empty() -> Self {
        Self {
            dynamic: DynamicFilter::empty(),
            biquads: biquad::Bank::empty(),
            worst_cycles: [0; 2],
            has_dynamic: false,
            loop_count: 0,
            louder: 0,
            choke: ChokeEnvelope::OPEN,
            levels: Levels::none(),
            since: PAST,
            deaf: false,
            struck: false,
            frame: 0,
        }
    }

    /// Takes the memory of filters, which are silent until loaded; `None` from an account.
    ///
    /// # Errors
    /// [`OutOfMemory`] if too little is left.
    pub fn place(memory: &mut Memory<'m>, size: FiltersSize) -> Result<Option<&'m mut Self>, OutOfMemory> {
        let mut filters = Self::empty();
        if let Some(size) = size.dynamic {
            filters.dynamic = DynamicFilter::take(memory, size)?;
            filters.levels = Levels::take(memory, size.breakpoints)?;
        }
        filters.biquads = biquad::Bank::take(memory, size.biquads)?;
        let place = memory.take(Region::Bulk, 1, Self::empty)?.first_mut();
        Ok(place.map(|place| {
            *place = filters;
            place
        }))
    }

    pub(super) fn has_biquads(&self) -> bool {
        Built::HERE.biquads && self.biquads.size().0 > 0
    }

    /// True if a force makes the biquads sound.
    #[inline(always)]
    pub fn takes_force(&self) -> bool {
        self.has_biquads() && !self.deaf
    }

    /// True if the object's modes go through the dynamic filter, instead of to the pad's bus.
    #[inline(always)]
    pub fn takes_modes(&self) -> bool {
        self.has_dynamic && self.dynamic.takes_modes()
    }

    /// True if anything sounds; otherwise they need not be rendered without force and modes.
    #[inline(always)]
    pub fn is_active(&self) -> bool {
        self.dynamic.is_ringing() || self.biquads.is_ringing()
    }

    /// Begins a strike at a frame of the tick; `level` is its peak force over the reference force.
    ///
    /// The two flags admit the dynamic filter and the biquads to the strike. If one is not
    /// admitted, it goes without the strike, and rings on if it rings.
    pub fn strike(&mut self, level: f32, frame: usize, [dynamic, biquads]: [bool; 2]) {
        self.align(frame);
        self.take_choke_gain();
        if self.has_dynamic && dynamic {
            self.dynamic.strike(level / (1u32 << self.louder) as f32);
            self.since = 0;
        }
        (self.deaf, self.struck) = (!biquads, biquads);
    }

    /// Ends all sound at once. A hand stays.
    pub fn rest(&mut self) {
        self.dynamic.rest();
        if self.has_biquads() {
            self.biquads.rest();
        }
        (self.since, self.deaf, self.struck) = (PAST, false, false);
    }

    /// True for the dynamic filter and the biquads, in this order, if the pad has them.
    pub fn parts(&self) -> [bool; 2] {
        [self.has_dynamic, self.has_biquads()]
    }

    /// True for the dynamic filter and the biquads, in this order, if they sound, or will by the
    /// strike that has just begun.
    pub fn sounding(&self) -> [bool; 2] {
        [self.dynamic.is_ringing(), self.biquads.is_ringing() || self.struck]
    }

    /// Chokes the filters by a number of nepers a frame, or releases them; on a tick.
    pub fn set_choked(&mut self, nepers: Option<f64>) {
        self.align(0);
        if nepers.is_none() {
            self.take_choke_gain();
        }
        self.choke.set(nepers);
        if self.has_biquads() {
            self.biquads.set_choked(nepers.is_some());
        }
    }

    /// Attenuates the dynamic filter's state by the choke's gain, which begins anew at 1.
    fn take_choke_gain(&mut self) {
        if let Some(left) = self.choke.take_gain() {
            self.dynamic.attenuate(left);
        }
    }

    /// Brings both to a frame of the tick: they count ticks, but are not rendered while silent.
    pub(super) fn align(&mut self, frame: usize) {
        let passed = (TICK_FRAMES + frame - self.frame) % TICK_FRAMES;
        if passed > 0 {
            self.dynamic.pass(passed);
            if self.has_biquads() {
                self.biquads.render(None, [0; TICK_FRAMES].get_mut(..passed).unwrap_or(&mut []));
            }
        }
        self.frame = frame;
    }

    /// Nominal cycles that a choke or a release adds to its tick: all sections that ring are scaled
    /// anew, as by a strike.
    pub fn choke_cycles(&self) -> u32 {
        if self.biquads.is_ringing() {
            self.biquads.cycles(TickKind::Struck).saturating_sub(self.biquads.cycles(TickKind::Driven))
        } else {
            0
        }
    }

    /// Nominal cycles of a tick in which they sound, or of one in which they are struck.
    pub fn cycles(&self, is_struck: bool) -> u32 {
        let kind = if is_struck { TickKind::Struck } else { TickKind::Driven };
        self.dynamic.cycles_a_tick() + self.biquads.cycles(kind)
    }
}
