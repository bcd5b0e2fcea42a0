//! Force of contacts that go on: scraping and rolling, beside the impacts.

use crate::fixed;
use crate::memory::{Memory, OutOfMemory, Region};
use crate::time::TICK_FRAMES;

/// Force of one contact that goes on, over the tick that plays.
#[derive(Clone, Copy, Debug)]
struct Ongoing {
    pad: u8,
    striker: u8,
    /// Position slot of the pad that the contact drives.
    slot: u8,
    /// Number of the tick's frames that have played; all of them if there is no force.
    played: u8,
    /// Force, Q4.27.
    force: [i32; TICK_FRAMES],
}

impl Ongoing {
    /// No force.
    const NONE: Self = Self { pad: 0, striker: 0, slot: 0, played: TICK_FRAMES as u8, force: [0; TICK_FRAMES] };

    /// Ends the force at once.
    fn end(&mut self) {
        self.played = TICK_FRAMES as u8;
    }

    /// Force of the frames to come; empty if there is none.
    fn ahead(&self) -> &[i32] {
        self.force.get(usize::from(self.played)..).unwrap_or(&[])
    }

    fn is_over(&self) -> bool {
        usize::from(self.played) >= TICK_FRAMES
    }

    fn pass(&mut self, frames: usize) {
        self.played = (usize::from(self.played) + frames).min(TICK_FRAMES) as u8;
    }

    fn add_to(&mut self, sum: &mut [i32]) {
        sum.iter_mut().zip(self.ahead()).for_each(|(sum, &force)| *sum = fixed::qadd(*sum, force));
        self.pass(sum.len());
    }
}

/// Forces of all contacts that go on in an engine.
#[derive(Debug)]
pub struct OngoingForces<'m> {
    places: &'m mut [Ongoing],
}

impl<'m> OngoingForces<'m> {
    /// No place for any force.
    pub const fn none() -> Self {
        Self { places: &mut [] }
    }

    /// Takes memory for a number of forces.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(memory: &mut Memory<'m>, count: usize) -> Result<Self, OutOfMemory> {
        Ok(Self { places: memory.take(Region::Fast, count, || Ongoing::NONE)? })
    }

    /// Begins a tick of a force on a pad's striker, in one of the pad's position slots; gives its
    /// frames to be filled, Q4.27, or `None` beyond the last place.
    pub fn begin(&mut self, index: usize, (pad, striker): (u8, u8), slot: u8) -> Option<&mut [i32; TICK_FRAMES]> {
        let place = self.places.get_mut(index)?;
        (place.pad, place.striker, place.slot, place.played) = (pad, striker, slot, 0);
        Some(&mut place.force)
    }

    /// Ends a force at once.
    pub fn end(&mut self, index: usize) {
        self.places.get_mut(index).into_iter().for_each(Ongoing::end);
    }

    /// True if any force may act; never in a build without scrapes.
    #[inline(always)]
    pub fn has_places(&self) -> bool {
        cfg!(feature = "scrapes") && !self.places.is_empty()
    }

    // Kits without surfaces have no places, and pay for a look at their number alone.

    /// True if any force acts in the tick's rest.
    #[inline(always)]
    pub fn is_any(&self) -> bool {
        self.has_places() && self.places.iter().any(|place| !place.is_over())
    }

    /// True if any force acts on a pad in the tick's rest.
    #[inline(always)]
    pub(super) fn is_any_on(&self, pad: u8) -> bool {
        self.has_places() && self.on(pad).next().is_some()
    }

    /// True if any force acts in a position slot of a pad in the tick's rest.
    #[inline(always)]
    pub(super) fn is_any_in(&self, pad: u8, slot: u8) -> bool {
        self.has_places() && self.on(pad).any(|place| place.slot == slot)
    }

    /// True if any force of a pad's striker acts in the tick's rest.
    #[inline(always)]
    pub(super) fn is_any_by(&self, pad: u8, striker: u8) -> bool {
        self.has_places() && self.on(pad).any(|place| place.striker == striker)
    }

    /// Sum of |force| on a pad in the tick's rest, in bus steps.
    pub(super) fn input(&self, pad: u8) -> f32 {
        if !self.has_places() {
            return 0.0;
        }
        self.on(pad).flat_map(Ongoing::ahead).map(|x| x.unsigned_abs() as f32).sum()
    }

    /// Number of frames within a run in which forces act on a pad, added up over the forces.
    #[inline(always)]
    pub fn frames_ahead(&self, pad: u8, frames: u32) -> u32 {
        if !self.has_places() {
            return 0;
        }
        self.on(pad).map(|place| (place.ahead().len() as u32).min(frames)).sum()
    }

    /// Passes frames of a pad without adding its force anywhere.
    #[inline(always)]
    pub(super) fn pass(&mut self, pad: u8, frames: usize) {
        if !self.has_places() {
            return;
        }
        self.places.iter_mut().filter(|place| place.pad == pad).for_each(|place| place.pass(frames));
    }

    /// Adds all forces on a pad to a run, and passes it.
    #[inline(always)]
    pub(super) fn add_of_pad(&mut self, pad: u8, sum: &mut [i32]) {
        if self.has_places() {
            self.add_those(|place| place.pad == pad, sum);
        }
    }

    /// Adds the forces of a pad's striker in a position slot to a run, and passes it.
    #[inline(always)]
    pub(super) fn add(&mut self, pad: u8, striker: u8, slot: u8, sum: &mut [i32]) {
        if self.has_places() {
            self.add_those(|place| (place.pad, place.striker, place.slot) == (pad, striker, slot), sum);
        }
    }

    #[inline(never)]
    fn add_those(&mut self, are_chosen: impl Fn(&Ongoing) -> bool, sum: &mut [i32]) {
        for place in self.places.iter_mut().filter(|place| are_chosen(place) && !place.is_over()) {
            place.add_to(sum);
        }
    }

    /// Ends all forces at once.
    pub(super) fn clear(&mut self) {
        if self.has_places() {
            self.places.iter_mut().for_each(Ongoing::end);
        }
    }

    fn on(&self, pad: u8) -> impl Iterator<Item = &Ongoing> {
        self.places.iter().filter(move |place| place.pad == pad && !place.is_over())
    }
}
