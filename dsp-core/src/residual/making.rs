//! Waves in the making: amplitudes of lines, random lines, inverse transform, a piece at a time.

use super::bands::{Bands, Common};
use super::fill;
use super::lines::{Cursor, amplitude_cycles, fill_amplitudes};
use crate::fourier::{self, Complex, MAX_POINTS, Progress};
use crate::noise::Sfc32;

/// Next step in the making of a wave.
#[derive(Clone, Copy, Debug)]
enum Step {
    Amplitudes(Cursor),
    Lines(usize),
    Transform(Progress),
}

/// A wave in the making, for bands that are up to date.
#[derive(Clone, Copy, Debug)]
pub(super) struct Making {
    /// Region of the stage's memory in which it is made.
    pub(super) region: usize,
    common: Common,
    step: Step,
}

/// Cycles of a pair of lines, for sharing the work; measured on the virtual core.
const PAIR_CYCLES: u32 = 116;

impl Making {
    /// A wave that is not begun; `common` holds the values that its bands share.
    pub(super) fn new(region: usize, bands: &Bands<'_>, common: &Common) -> Self {
        let spacing = 0.5 / MAX_POINTS as f32;
        Self { region, common: *common, step: Step::Amplitudes(Cursor::new(bands, common, spacing)) }
    }

    /// Approximate cycles of the whole wave with a number of bands.
    pub(super) fn cycles(bands: usize) -> u32 {
        let pairs = MAX_POINTS as u32 / 2 * PAIR_CYCLES;
        amplitude_cycles(MAX_POINTS, bands) + pairs + const { fourier::cycles(MAX_POINTS) }
    }

    pub(super) fn is_over(&self) -> bool {
        matches!(self.step, Step::Transform(progress) if progress.is_over())
    }

    /// Does work that costs about `share` cycles in its region. Gives the cycles that it has cost.
    pub(super) fn advance(
        &mut self,
        bands: &Bands<'_>,
        spectrum: &mut [Complex],
        noise: &mut Sfc32,
        share: u32,
    ) -> u32 {
        let points = spectrum.len();
        let mut spent = 0;
        while spent < share && !self.is_over() {
            let room = share - spent;
            match &mut self.step {
                Step::Amplitudes(cursor) => {
                    spent += fill_amplitudes(bands, &self.common, spectrum, cursor, room);
                    if cursor.lines() == points {
                        fill::fill_middle(spectrum, random_lines(noise));
                        self.step = Step::Lines(1);
                    }
                }
                Step::Lines(from) => {
                    let within = (room / PAIR_CYCLES) as usize + 1;
                    let range = *from..within.saturating_add(*from).min(points / 2);
                    fill_pairs(spectrum, range.clone(), noise);
                    spent += range.len() as u32 * PAIR_CYCLES;
                    *from = range.end;
                    if range.end == points / 2 {
                        self.step = Step::Transform(Progress::start(points));
                    }
                }
                Step::Transform(progress) => spent += progress.advance(spectrum, room),
            }
        }
        spent
    }
}

fn fill_pairs(spectrum: &mut [Complex], pairs: core::ops::Range<usize>, noise: &mut Sfc32) {
    // The copy stays in registers.
    let mut local = *noise;
    fill::fill_pairs(spectrum, pairs, || random_lines(&mut local));
    *noise = local;
}

/// Random parts of two lines.
#[inline(always)]
fn random_lines(noise: &mut Sfc32) -> [f32; 4] {
    noise.four().map(|part| part as f32)
}
