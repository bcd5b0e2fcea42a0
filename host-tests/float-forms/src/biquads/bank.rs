//! The bank in single precision: quads, and when they are at rest.

use dsp_core::biquad::fractions::parts;
use dsp_core::biquad::{Biquad, BiquadError};
use dsp_core::resonator::TICK_FRAMES;

use super::kernel::{self, portable};
use super::quad::{FloatPole, Quad};

/// L parallel chains of M biquads in single precision, in at most `QUADS` fours of sections.
///
/// Input and output are blocks of `f32`, 1.0 = 0 dBFS. The caller's block size changes no bit.
/// Sections that stay below 2^-27, with no input left, are cleared and not run. An input that is
/// not finite sounds until it ends, and is cleared then.
///
/// Worst SNR against `f64`, and cycles: `docs/biquads.md`.
#[derive(Clone, Debug)]
pub struct FloatBank<const QUADS: usize> {
    quads: [Quad; QUADS],
    count: usize,
    direct: f32,
    /// Frame within the tick; ticks begin on even frames.
    frame: usize,
    has_input: bool,
    ringing: bool,
}

impl<const QUADS: usize> FloatBank<QUADS> {
    /// A bank of no chains.
    pub const EMPTY: Self =
        Self { quads: [Quad::EMPTY; QUADS], count: 0, direct: 0.0, frame: 0, has_input: false, ringing: false };

    /// Derives a bank at rest from chains of `depth` sections, one behind the other. All states are
    /// cleared; after an error the bank is empty.
    ///
    /// # Errors
    /// [`BiquadError`].
    pub fn load(&mut self, biquads: &[Biquad], depth: usize) -> Result<(), BiquadError> {
        self.quads.fill(Quad::EMPTY);
        (self.count, self.direct, self.ringing) = (0, 0.0, false);
        let sections = biquads.len();
        if !(1..=4).contains(&depth) || !sections.is_multiple_of(depth) {
            return Err(BiquadError::Depth { depth, sections });
        }
        for (index, biquad) in biquads.iter().enumerate() {
            biquad.check(index)?;
        }
        let (mut direct, mut count) = (0.0, 0);
        for chain in biquads.chunks(depth) {
            direct += chain.iter().map(|biquad| biquad.numerator[0]).product::<f64>();
            let all = parts::<FloatPole>(chain);
            for cluster in all.get(..depth).unwrap_or(&[]).chunk_by(|_, next| next.handed != 0.0) {
                if self.quads.iter_mut().take(count).any(|quad| quad.take(cluster)) {
                    continue;
                }
                let slot = self.quads.get_mut(count).ok_or(BiquadError::Full { sections, room: QUADS })?;
                *slot = Quad::for_cluster(cluster);
                slot.take(cluster);
                count += 1;
            }
        }
        if let Some(used) = self.quads.get_mut(..count) {
            used.sort_unstable_by_key(Quad::key);
        }
        (self.count, self.direct) = (count, direct as f32);
        Ok(())
    }

    /// Clears all states.
    pub fn rest(&mut self) {
        self.quads.iter_mut().for_each(Quad::rest);
        (self.ringing, self.has_input) = (false, false);
    }

    /// True if anything sounds or may sound. If false, a block without input costs nothing.
    pub fn is_ringing(&self) -> bool {
        self.ringing
    }

    /// Adds the bank's sound to `out`. Without an input, or behind its end, it rings on.
    pub fn render(&mut self, input: Option<&[f32]>, out: &mut [f32]) {
        let mut input = input.unwrap_or(&[]);
        let comes = input.iter().any(|&x| x != 0.0);
        if self.count == 0 || !self.ringing && !comes {
            self.frame = (self.frame + out.len()) % TICK_FRAMES;
            return;
        }
        let mut out = out;
        while !out.is_empty() {
            if self.frame == 0 {
                self.tick();
            }
            let frames = out.len().min(TICK_FRAMES - self.frame);
            let frames = if input.is_empty() { frames } else { frames.min(input.len()) };
            let (now, later) = out.split_at_mut(frames);
            let (x, more) = input.split_at(frames.min(input.len()));
            if x.iter().any(|&x| x != 0.0) {
                (self.has_input, self.ringing) = (true, true);
                self.quads.iter_mut().take(self.count).for_each(|quad| quad.awake = 1);
            }
            if self.ringing {
                self.run((!x.is_empty()).then_some(x), now);
            }
            self.frame = (self.frame + frames) % TICK_FRAMES;
            (input, out) = (more, later);
        }
    }

    /// Lets quads rest that are no longer heard: the bookkeeping of a tick.
    fn tick(&mut self) {
        if !self.has_input && self.ringing {
            self.ringing = false;
            for quad in self.quads.iter_mut().take(self.count).filter(|quad| quad.awake != 0) {
                if quad.is_heard() {
                    self.ringing = true;
                } else {
                    quad.rest();
                }
            }
        }
        self.has_input = false;
    }

    /// Frames within a tick.
    fn run(&mut self, input: Option<&[f32]>, out: &mut [f32]) {
        let odd = self.frame % 2 == 1;
        let quads = self.quads.get_mut(..self.count).unwrap_or(&mut []);
        let plain = quads.partition_point(|quad| quad.key() == (false, false));
        let (plain, others) = quads.split_at_mut(plain);
        kernel::run(plain, input, self.direct, out);
        for alike in others.chunk_by_mut(|one, next| one.key() == next.key()) {
            if alike.iter().all(|quad| quad.awake == 0) {
                continue;
            }
            if alike.first().is_some_and(|quad| !quad.is_mirrored()) {
                sound(alike, input, out);
                continue;
            }
            let (mut x, mut mix) = ([0.0; TICK_FRAMES], [0.0; TICK_FRAMES]);
            let flipped = |frame: usize, word: f32| if (frame % 2 == 1) == odd { word } else { -word };
            for (frame, (x, &given)) in x.iter_mut().zip(input.unwrap_or(&[])).enumerate() {
                *x = flipped(frame, given);
            }
            let mix = mix.get_mut(..out.len()).unwrap_or(&mut []);
            sound(alike, input.and_then(|input| x.get(..input.len())), mix);
            for (frame, (out, &sum)) in out.iter_mut().zip(&*mix).enumerate() {
                *out += flipped(frame, sum);
            }
        }
    }
}

fn sound(quads: &mut [Quad], input: Option<&[f32]>, out: &mut [f32]) {
    if quads.first().is_some_and(Quad::is_linked) {
        for quad in quads.iter_mut().filter(|quad| quad.awake != 0) {
            portable::run_linked(quad, input, out);
        }
    } else {
        kernel::run(quads, input, 0.0, out);
    }
}
