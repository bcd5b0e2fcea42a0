//! From the bands' energies to the lines of a frame's spectrum: the strength of each line, and its
//! tilt in time.
//!
//! A frame blurs a band's edges by about a line, so that a band that lasts would be heard, and
//! measured, in a neighbour that is long over. Hence the stronger of two neighbours keeps away from
//! their edge (`edges`), and carries its energy in the rest of its width.
//!
//! Within a frame, a band falls faster or slower than the mean of all bands. A **tilt**
//! `1 + c sin 2πt` (t from 0 to 1 over the frame) makes up for that. In frequency it adds to a line
//! its two neighbours: cheap, and each band may have its own.

use super::bands::{Bands, Common, least};
use crate::fourier::Complex;
use crate::noise::DEVIATION;
use crate::square_root::square_root;

/// Progress of the lines through the bands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor {
    line: usize,
    piece: Piece,
    next: Next,
}

/// The rest of a band that is still to be filled, as a frame carries it.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// Edges in cycles/sample.
    low: f32,
    high: f32,
    /// Power per (cycle/sample) in the wave.
    density: f32,
    /// Half of c.
    half_tilt: f32,
}

impl Piece {
    /// Beyond all bands.
    const END: Self = Self { low: 2.0, high: 2.0, density: 0.0, half_tilt: 0.0 };
}

/// The band that comes after a piece.
#[derive(Clone, Copy, Debug)]
struct Next {
    band: usize,
    lower: f32,
    upper: f32,
    /// Share of its energy that is left after a quarter of the frame.
    quarter: f32,
    /// Energy in the frame, per (cycle/sample).
    energy: f32,
    /// Distances that it keeps from its lower edge, and from its upper one if nothing lies beyond.
    retreats: [f32; 2],
}

impl Next {
    /// A band of no width and no energy, at an edge.
    const fn nothing(band: usize, edge: f32) -> Self {
        Self { band, lower: edge, upper: edge, quarter: 1.0, energy: 0.0, retreats: [0.0; 2] }
    }
}

/// Share of its energy that the lowest band gains for each time that it fits a line beyond the
/// first. Narrower than a line, it loses to what lies below it, and no band there makes up for
/// that.
const OUTER: f32 = 0.28;
const OUTER_OF_ONSET: f32 = 0.8;
/// c over `(q - p) / (q + p)`, where p and q are left after a quarter of a frame of the band and of
/// all. Over the window that is the tilt that keeps the slope from frame to frame (fitted to decays
/// of 20 to 400 dB/s beside each other).
const TILT: f32 = 1.15;
const STEEPEST: f32 = 0.9;

impl Cursor {
    /// Begins at the lowest line, for bands that are up to date. `spacing` is the distance of lines
    /// in cycles/sample.
    pub(super) fn new(bands: &Bands<'_>, common: &Common, spacing: f32) -> Self {
        let mut new = Self { line: 0, piece: Piece::END, next: Next::nothing(0, bands.lower()) };
        new.advance(bands, common);
        new.advance(bands, common);
        let width = new.piece.high - new.piece.low;
        if width > 0.0 {
            let outer = if common.is_onset { OUTER_OF_ONSET } else { OUTER };
            new.piece.density *= 1.0 + outer * least(positive(spacing / width - 1.0), 8.0);
        }
        new
    }

    /// Number of lines that are done.
    pub(super) fn lines(&self) -> usize {
        self.line
    }

    /// Goes on to the next band's piece.
    #[inline(never)]
    fn advance(&mut self, bands: &Bands<'_>, common: &Common) {
        let Next { band, lower, upper, quarter, energy, retreats: [from_lower, from_upper] } = self.next;
        if band > bands.count() {
            self.piece = Piece::END;
            return;
        }
        let mut after = Next::nothing(band + 1, upper);
        if let Some(band) = bands.all().get(band) {
            let e = least(band.per_eighth, common.eighth);
            (after.upper, after.quarter, after.energy) = (band.upper, e * e, common.energy_of(band));
            after.retreats = band.retreats;
        }
        // The stronger of two bands keeps away from their edge.
        let (mut high, mut of_after) = (upper, 0.0);
        if energy > after.energy {
            high -= from_upper * (1.0 - after.energy / energy);
        } else if after.energy > energy {
            of_after = 1.0 - energy / after.energy;
        }
        after.retreats[0] *= of_after;
        let (low, width) = (lower + from_lower, upper - lower);
        let steep = TILT * (common.quarter - quarter) / (common.quarter + quarter);
        let steep = if common.is_onset { 0.0 } else { steep };
        let tilt = least(if steep > -STEEPEST { steep } else { -STEEPEST }, STEEPEST);
        let [zeroth, first, second] = common.moments;
        let window = zeroth + tilt * (2.0 * first + tilt * second);
        let density = if high > low { energy * width / ((high - low) * window) } else { 0.0 };
        (self.piece, self.next) = (Piece { low, high, density, half_tilt: 0.5 * tilt }, after);
    }
}

/// Puts the lines' amplitudes into the real parts of a spectrum (of a wave twice as long), and the
/// amplitudes times half their tilt into the imaginary parts, from `cursor` on until they have cost
/// about `cycles`. The bands' powers are shared among the lines by the part of a line's width that
/// lies in the band. A line has the tilt of the uppermost band in it. Gives the cycles.
#[inline(never)]
pub(super) fn fill_amplitudes(
    bands: &Bands<'_>,
    common: &Common,
    spectrum: &mut [Complex],
    cursor: &mut Cursor,
    cycles: u32,
) -> u32 {
    let lines_per_cycle = 2.0 * spectrum.len() as f32;
    let spacing = 1.0 / lines_per_cycle;
    let Some(mut lines) = spectrum.get_mut(cursor.line..) else { return 0 };
    let mut spent = 0;
    while spent < cycles
        && let Some(at_edge) = lines.split_off_first_mut()
    {
        let end = (cursor.line as f32 + 0.5) * spacing;
        let (mut power, mut half_tilt) = (0.0, 0.0);
        cursor.line += 1;
        spent += LINE_CYCLES;
        loop {
            let Piece { low, high, density, half_tilt: own } = cursor.piece;
            if low >= end {
                break;
            }
            half_tilt = own;
            if high > end {
                power += density * (end - low);
                cursor.piece.low = end;
                break;
            }
            power += density * (high - low);
            cursor.advance(bands, common);
            spent += BAND_CYCLES;
        }
        *at_edge = line(power, half_tilt);
        // All lines within a band, or within nothing, are alike.
        let Piece { low, high, density, half_tilt } = cursor.piece;
        let (up_to, power) = if low <= end { (high, density * spacing) } else { (low, 0.0) };
        let beyond = (up_to * lines_per_cycle + 0.5) as usize;
        let count = beyond.saturating_sub(cursor.line).min(lines.len());
        if count > 0
            && let Some(alike) = lines.split_off_mut(..count)
        {
            alike.fill(line(power, half_tilt));
            cursor.line += count;
            if low <= end {
                cursor.piece.low = (cursor.line as f32 - 0.5) * spacing;
            }
            spent += count as u32 * ALIKE_CYCLES;
        }
    }
    spent
}

/// Amplitude of a line in units of the noise, and that times half its tilt. Half the root, because
/// a line beside its mirror image has 4 times the power of each of its two parts.
#[inline(always)]
fn line(power: f32, half_tilt: f32) -> Complex {
    const SCALE: f32 = (0.5 / DEVIATION) as f32;
    let amplitude = square_root(power) * SCALE;
    [amplitude, amplitude * half_tilt]
}

/// Cycles of a line with an edge, of a band, and of a line inside a band; measured on the virtual
/// core.
const LINE_CYCLES: u32 = 150;
const BAND_CYCLES: u32 = 210;
const ALIKE_CYCLES: u32 = 8;

/// Cycles of all lines of a spectrum, with a number of bands.
pub(super) fn amplitude_cycles(lines: usize, bands: usize) -> u32 {
    let edges = bands.min(lines) as u32;
    bands as u32 * BAND_CYCLES + edges * LINE_CYCLES + (lines as u32 - edges) * ALIKE_CYCLES
}

#[inline(always)]
fn positive(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}
