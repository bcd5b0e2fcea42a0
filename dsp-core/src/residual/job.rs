//! A frame in the making: its work is shared among the ticks before it sounds.

use super::bands::{Bands, Common, Passage};
use super::making::Making;
use super::stream::Stream;
use crate::fourier::Complex;
use crate::noise::Sfc32;
use crate::square_root::square_root;

/// Next step in the making of a frame.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// Bands from this one on are to be brought up to date.
    Bands(usize),
    Wave(Making),
}

/// A frame in the making.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job {
    /// Region of the stage's memory in which the wave is made.
    pub(super) region: usize,
    passage: Passage,
    step: Step,
    /// Approximate cycles that are left to do.
    left: u32,
    /// Power of the bands that are up to date, and the power that is left after a quarter of the
    /// frame, without a hand and with one.
    sum: (f32, [f32; 2]),
    common: Common,
    /// Energy at the frame's beginning of strikes that came too late for it; and their energy by
    /// distance before that.
    late: f32,
    missed: Passage,
}

/// Cycles of bringing a band up to date, and extra cycles if a strike adds to it, for sharing the
/// work; measured on the virtual core.
const BAND_CYCLES: u32 = 70;
const STRUCK_CYCLES: u32 = 110;

impl Job {
    pub(super) fn new(region: usize, passage: Passage, bands: usize, is_struck: bool) -> Self {
        Self {
            region,
            passage,
            step: Step::Bands(0),
            left: Self::cycles(bands, is_struck),
            sum: (0.0, [0.0; 2]),
            common: Common::NONE,
            late: 0.0,
            missed: Passage { is_late: true, ..Passage::NEXT },
        }
    }

    /// Approximate cycles of the whole frame with a number of bands.
    pub(super) fn cycles(bands: usize, is_struck: bool) -> u32 {
        let of_band = BAND_CYCLES + if is_struck { STRUCK_CYCLES } else { 0 };
        bands as u32 * of_band + Making::cycles(bands)
    }

    /// Adds the energy of a strike `ticks` before the frame: band by band before any has been
    /// brought up to date, else to the whole frame, as `late`.
    pub(super) fn add(&mut self, energy: f32, ticks: f32, late: f32) {
        if matches!(self.step, Step::Bands(0)) {
            self.passage.add(energy, ticks);
        } else {
            self.late += late;
            self.missed.add(energy, ticks);
        }
    }

    /// Time from this frame's beginning to the next one's.
    pub(super) fn onward(&self) -> Passage {
        if self.missed.is_struck() { self.missed } else { Passage::NEXT }
    }

    /// Gives the frame up. If some bands have been brought up to its beginning, all are. True if
    /// they stand for it.
    pub(super) fn give_up(&self, bands: &mut Bands<'_>) -> bool {
        match self.step {
            Step::Bands(0) if !self.passage.is_late => return false,
            Step::Bands(from) => _ = bands.advance(from..bands.count(), &self.passage, false),
            _ => {}
        }
        true
    }

    /// True if the frame is known to be below a power at its beginning, after a hand has left
    /// `kept` of its amplitude.
    pub(super) fn is_below(&self, power: f32, kept: f32) -> bool {
        !matches!(self.step, Step::Bands(_)) && (self.common.power + self.late) * kept * kept < power
    }

    /// Does work that costs about `share` cycles. Gives the cycles that it has cost.
    pub(super) fn advance(
        &mut self,
        bands: &mut Bands<'_>,
        spectrum: &mut [Complex],
        noise: &mut Sfc32,
        share: u32,
    ) -> u32 {
        let mut spent = 0;
        while spent < share {
            match &mut self.step {
                Step::Bands(from) => {
                    let to = bands.count().min(*from + 10);
                    let (power, left) = bands.advance(*from..to, &self.passage, true);
                    let (sum, [free, choked]) = self.sum;
                    self.sum = (sum + power, [free + left[0], choked + left[1]]);
                    let is_struck = self.passage.is_struck();
                    spent += (to - *from) as u32 * (BAND_CYCLES + if is_struck { STRUCK_CYCLES } else { 0 });
                    *from = to;
                    if to == bands.count() {
                        let hand = self.passage.is_choked.then(|| bands.hand_eighth());
                        self.common = Common::of(self.sum.0, self.sum.1, hand);
                        self.step = Step::Wave(Making::new(self.region, bands, &self.common));
                    }
                }
                Step::Wave(making) => {
                    spent += making.advance(bands, spectrum, noise, share - spent);
                    break;
                }
            }
        }
        self.left = self.left.saturating_sub(spent);
        spent
    }

    /// Approximate cycles that are left to do.
    pub(super) fn left(&self) -> u32 {
        self.left
    }

    /// Share of the amplitude that is left after a hand lay there for `choked_ticks` more ticks
    /// than the frame was made for.
    pub(super) fn kept(&self, choked_ticks: f32) -> f32 {
        self.common.kept(choked_ticks)
    }

    /// The frame as it sounds. `kept` is the share of its amplitude that a hand has left.
    pub(super) fn stream(&self, kept: f32) -> Stream {
        let has_late = self.late > 0.0 && self.common.power > 0.0;
        let growth = if has_late { square_root(1.0 + self.late / self.common.power) } else { 1.0 };
        Stream::of_frame(self.region, kept * growth, self.common.per_frame())
    }
}
