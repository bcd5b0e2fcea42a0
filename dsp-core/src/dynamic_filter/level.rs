//! The level of a dynamic filter's sound along its path, and how fast it falls by itself. A hand on
//! the pad adds only the decay that is then missing.
//!
//! The level at a breakpoint is the noise's level there times the filter's gain for white noise,
//! `sqrt(Σ h²)`. It is taken as linear between two breakpoints, and is 0 after the last. Sound that
//! rings in the filter falls no faster than the slowest pole, whose radius is taken as linear too.

use super::settings::Breakpoint;
use crate::SampleRate;
use crate::memory::{Memory, OutOfMemory, Region};

/// Levels from one breakpoint to the next, in frames after the strike.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// First frame of the piece.
    start: u32,
    /// Level at the first frame.
    level: f32,
    /// Change of the level per frame.
    level_step: f32,
    /// Distance of the slowest pole from the unit circle at the first frame.
    gap: f32,
    /// Change of that distance per frame.
    gap_step: f32,
}

impl Piece {
    const NOTHING: Self = Self { start: 0, level: 0.0, level_step: 0.0, gap: 1.0, gap_step: 0.0 };

    fn level(&self, frame: u32) -> f32 {
        (self.level + self.level_step * frame.saturating_sub(self.start) as f32).max(0.0)
    }

    fn gap(&self, frame: u32) -> f32 {
        self.gap_at(frame.saturating_sub(self.start) as f32)
    }

    fn gap_at(&self, since: f32) -> f32 {
        // After the last breakpoint the distance stays for ever, so no time multiplies the step.
        let change = if self.gap_step == 0.0 { 0.0 } else { self.gap_step * since };
        (self.gap + change).clamp(0.0, 1.0)
    }

    /// Mean decay of the slowest pole over the next frames, in nepers per frame.
    fn falls_of_pole(&self, frame: u32, frames: u32) -> f32 {
        let gap = self.gap_at(frame.saturating_sub(self.start) as f32 + 0.5 * (frames - 1) as f32);
        if gap < 1.0 { -libm::log1pf(-gap) } else { f32::INFINITY }
    }
}

/// Levels along a path.
#[derive(Debug)]
pub struct Levels<'m> {
    pieces: &'m mut [Piece],
    count: usize,
    /// True if loops ring on by themselves.
    looped: bool,
}

impl<'m> Levels<'m> {
    /// Makes levels without a path.
    pub const fn none() -> Self {
        Self { pieces: &mut [], count: 0, looped: false }
    }

    /// Takes memory for `count` breakpoints.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(memory: &mut Memory<'m>, count: usize) -> Result<Self, OutOfMemory> {
        Ok(Self { pieces: memory.take(Region::Bulk, count, || Piece::NOTHING)?, ..Self::none() })
    }

    /// Derives the levels of a path whose coefficients are for a rate of `1/ratio` times `rate`.
    #[inline(never)] // only on load: its stack is not the caller's
    pub fn load(
        &mut self,
        order: u8,
        path: impl Iterator<Item = Breakpoint> + Clone,
        (rate, ratio): (SampleRate, f64),
        looped: bool,
    ) {
        (self.count, self.looped) = (0, looped);
        let path = path.map(|point| point.carried(order, ratio));
        let mut following = path.clone().skip(1);
        for (here, piece) in path.zip(&mut *self.pieces) {
            let next = following.next();
            let (from, to) = (here.time_s * rate.hz(), next.map_or(f64::INFINITY, |next| next.time_s * rate.hz()));
            let start = libm::ceil(from);
            let of = |point: &Breakpoint| (point.noise * noise_gain(point), 1.0 - slowest(order, point));
            let ((level, gap), (next_level, next_gap)) = (of(&here), of(&next.unwrap_or(here)));
            // After the last breakpoint there is no noise, and the filter stays as it is.
            let level = if next.is_some() { level } else { 0.0 };
            let next_level = if next.is_some() { next_level } else { 0.0 };
            let line = |from_value: f64, to_value: f64| {
                let step = (to_value - from_value) / (to - from);
                ((from_value + step * (start - from)) as f32, step as f32)
            };
            let ((level, level_step), (gap, gap_step)) = (line(level, next_level), line(gap, next_gap));
            *piece = Piece { start: start as u32, level, level_step, gap, gap_step };
            self.count += 1;
        }
    }

    /// Decay of the sound by itself, at a frame after the strike.
    ///
    /// Gives the number of frames, at most `most`, for which one rate of decay is precise enough,
    /// and that rate in nepers per frame. The rate is infinite if no sound is left.
    ///
    /// From n to n + 1 the amplitude is multiplied by the larger of two factors, at most 1. One is
    /// the level at n + 1 over the level at n (0 if both are 0), the other is the radius of the
    /// slowest pole. With this rule kits under hands are 98 dB from the reference
    /// (`cargo test -p malleus --test kits whole_sound`).
    pub fn falls(&self, frame: u32, most: u32) -> (u32, f32) {
        let pieces = self.pieces.get(..self.count).unwrap_or(&[]);
        let at = pieces.iter().rposition(|piece| piece.start <= frame).unwrap_or(0);
        let Some(piece) = pieces.get(at) else { return (most, 0.0) };
        let next = pieces.get(at + 1).filter(|next| next.start > frame);
        let to_next = next.map_or(u32::MAX, |next| next.start - frame);
        if self.looped {
            return (most.min(to_next), 0.0);
        }
        let before = piece.level(frame);
        if let Some(next) = next.filter(|_| to_next == 1) {
            // The next frame lies behind a breakpoint, at which the level may jump.
            let of_level = if next.level > 0.0 { falls_of(before, next.level, 1) } else { f32::INFINITY };
            return (1, of_level.min(piece.falls_of_pole(frame, 1)));
        }
        let frames = most.min(to_next - 1);
        let lost = -piece.level_step;
        if lost < 0.0 || lost == 0.0 && before > 0.0 {
            return (frames, 0.0);
        }
        let at_pole = lost == 0.0 || before * piece.gap(frame) <= lost;
        if at_pole {
            return (frames, piece.falls_of_pole(frame, frames));
        }
        // One rate serves until the level has lost a 64th. Until then it is within (1/64)²/8 of the
        // line. `as` saturates.
        let frames = frames.min((before / (64.0 * lost)) as u32).max(1);
        (frames, falls_of(before, piece.level(frame + frames), frames).min(piece.falls_of_pole(frame, frames)))
    }
}

/// Decay from one level to another, in nepers per frame; 0 if the level rises.
fn falls_of(before: f32, after: f32, frames: u32) -> f32 {
    if before > 0.0 && after > 0.0 {
        (-libm::log1pf((after - before) / before) / frames as f32).max(0.0)
    } else if after > 0.0 {
        0.0
    } else {
        f32::INFINITY
    }
}

/// Gain for white noise, `sqrt(Σ h²)`: the rms of the output for noise of rms 1.
fn noise_gain(point: &Breakpoint) -> f64 {
    let Breakpoint { a1, a2, b0, b1, b2, .. } = *point;
    let squares = b0 * b0 + b1 * b1 + b2 * b2;
    let above = (1.0 + a2) * squares - 2.0 * a1 * b1 * (b0 + b2) + 2.0 * b0 * b2 * (a1 * a1 - a2 * (1.0 + a2));
    let below = (1.0 - a2) * (1.0 + a2 - a1) * (1.0 + a2 + a1);
    libm::sqrt((above / below).max(0.0))
}

/// Radius of the slowest pole.
fn slowest(order: u8, point: &Breakpoint) -> f64 {
    let Breakpoint { a1, a2, .. } = *point;
    let rest = a1 * a1 - 4.0 * a2;
    if order == 1 {
        a1.abs()
    } else if rest < 0.0 {
        libm::sqrt(a2)
    } else {
        0.5 * (a1.abs() + libm::sqrt(rest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gain_for_noise_is_that_of_the_impulse_response() {
        for (a1, a2, b0, b1, b2) in [
            (-0.5, 0.0, 0.3, 0.3, 0.0),
            (0.9, 0.0, 1.0, -0.4, 0.0),
            (-1.2, 0.7, 0.2, -0.1, 0.4),
            (-1.5, 0.55, 1.0, 0.0, -0.9),
        ] {
            let point = Breakpoint { a1, a2, b0, b1, b2, ..Breakpoint::default() };
            let (mut y, mut sum) = ([0.0; 2], 0.0);
            for n in 0..5_000 {
                let x = match n {
                    0 => b0,
                    1 => b1,
                    2 => b2,
                    _ => 0.0,
                };
                let now: f64 = x - a1 * y[0] - a2 * y[1];
                sum += now * now;
                y = [now, y[0]];
            }
            assert!(
                (noise_gain(&point) / sum.sqrt() - 1.0).abs() < 1e-9,
                "{point:?}: {} {}",
                noise_gain(&point),
                sum.sqrt()
            );
        }
    }
}
