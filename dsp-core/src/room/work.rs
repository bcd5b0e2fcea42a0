//! Rendering, and the work on a block: cut into a part for each of its ticks.

use core::cell::Cell;

use super::crossover;
use super::dimensions::{BLOCK_FRAMES, TICKS};
use super::network::Turns;
use super::sample::Sample;
use super::state::{Room, Scratch, Work, turned};
use crate::time::TICK_FRAMES;

impl<T: Sample> Room<'_, T> {
    /// Takes a run of the dry stereo sum (Q4.27) in and adds the room's answer to it.
    pub fn render(&mut self, out: &mut [[i32; 2]]) {
        if self.bands.is_empty() {
            return;
        }
        let mut out = out;
        while !out.is_empty() {
            let left = TICK_FRAMES - self.passed % TICK_FRAMES;
            let (now, later) = out.split_at_mut(left.min(out.len()));
            self.pass(now);
            out = later;
            if self.passed == BLOCK_FRAMES {
                self.begin();
            }
            if self.passed.is_multiple_of(TICK_FRAMES) {
                self.work_on();
            }
        }
    }

    /// Lets frames of silence pass while the room [is silent](Self::is_silent), with the effect of
    /// rendering them.
    pub fn pass_silence(&mut self, frames: usize) {
        // While the room is silent its input is zeros throughout.
        let passed = self.passed + frames;
        self.passed = passed % BLOCK_FRAMES;
        // 2^32 blocks are more than a month.
        self.silent_blocks = self.silent_blocks.wrapping_add((passed / BLOCK_FRAMES) as u32);
    }

    #[inline(never)]
    fn pass(&mut self, out: &mut [[i32; 2]]) {
        let frames = self.passed..self.passed + out.len();
        self.passed = frames.end;
        // While the room is silent, its input is zeros already, and its chains rest.
        if self.silent && out.iter().all(|sides| *sides == [0; 2]) {
            return;
        }
        let ([input, _], [wet, _]) = (turned(&mut self.inputs, self.side), turned(&mut self.outputs, self.side));
        let (Some(input), Some(wet)) = (input.get_mut(frames.clone()), wet.get(frames)) else { return };
        self.dry |= self.feed.exchange(out, wet, input);
        self.heard |= self.dry != 0;
        self.silent &= !self.heard;
    }

    /// Ends a block: its input is worked on, the finished output goes out.
    fn begin(&mut self) {
        self.passed = 0;
        if self.silent {
            self.silent_blocks = self.silent_blocks.wrapping_add(1);
            return;
        }
        self.side = !self.side;
        let rings = self.feed.settle(self.dry == 0);
        (self.worked, self.heard, self.dry) = (self.heard, rings, 0);
        self.turn.advance(core::mem::take(&mut self.silent_blocks));
        if let Some(scratch) = &mut self.scratch {
            scratch.turns = Turns::new(&self.turn);
        }
        self.work = Work { begun: true, ..Work::NONE };
    }

    /// Does a tick's part of the work on a block.
    #[inline(never)]
    fn work_on(&mut self) {
        if !self.work.begun {
            return;
        }
        let part = self.passed / TICK_FRAMES;
        while self.part_ends.get(part).is_some_and(|&end| self.work.next < usize::from(end)) {
            let band = self.bands.len().wrapping_sub(1 + self.work.next / 2);
            match self.work.next {
                next if next == 2 * self.bands.len() => self.double(),
                next if next.is_multiple_of(2) => self.split(band),
                _ => self.answer(band),
            }
            self.work.next += 1;
        }
        if part + 1 == TICKS {
            if self.work.asleep && !self.worked && !self.heard {
                self.clear();
            }
            self.work.begun = false;
        }
    }

    /// Brings the sound at lower rates to the full one.
    fn double(&mut self) {
        let [_, full_rate] = turned(&mut self.outputs, self.side);
        let [at_full_rate, written @ ..] = &mut self.work.written;
        let [_, upsampler, upsamplers @ ..] = &self.upsamplers;
        let [state, states @ ..] = &mut self.upsampler_states;
        for ((level, state), upsampler) in (1..self.levels).zip(states).zip(upsamplers).rev() {
            let block = BLOCK_FRAMES >> level;
            let Some((slow, fast)) = self.rates.split_at_mut_checked(block) else { return };
            let (Some(slow), Some(fast)) = (slow.get_mut(block / 2..), fast.get_mut(..block)) else { return };
            let Some([fast_written, slow_written]) = written.get_mut(level - 1..=level) else { return };
            if !*slow_written {
                slow.fill([0; 2]);
            }
            upsampler.render(state, slow, fast, *fast_written);
            *fast_written = true;
        }
        if self.levels > 0 {
            let Some((_, slow)) = self.rates.split_at_mut_checked(BLOCK_FRAMES / 2) else { return };
            if !written.first().copied().unwrap_or_default() {
                slow.fill([0; 2]);
            }
            upsampler.render(state, slow, full_rate, *at_full_rate);
        } else if !*at_full_rate {
            full_rate.fill([0; 2]);
        }
    }

    /// Splits a band from the input; the sound below it stays.
    fn split(&mut self, index: usize) {
        let Work { division, bits, .. } = &mut self.work;
        let [_, low] = turned(&mut self.inputs, self.side);
        let Some(band) = self.bands.get_mut(index) else { return };
        let own = usize::from(band.division);
        if own > *division
            && let Some(low) = low.get_mut(..quotient(BLOCK_FRAMES, *division))
        {
            thin(low, quotient(own, *division));
        }
        let block = quotient(BLOCK_FRAMES, own);
        let Some(scratch) = self.scratch.as_deref_mut() else { return };
        let (Some(low), Some(high)) = (low.get_mut(..block), scratch.high.get_mut(..block)) else { return };
        *division = own;
        *bits = if index == 0 {
            let mut sizes = 0;
            for (high, low) in high.iter_mut().zip(low.iter()) {
                *high = *low << 1;
                sizes |= (*high ^ (*high >> 31)) as u32;
            }
            crossover::bits(sizes, high)
        } else {
            *division = if band.thins { 2 * own } else { own };
            band.split.render(&mut band.split_state, low, high, band.thins)
        };
    }

    /// Lets a band answer to its part of the input.
    fn answer(&mut self, index: usize) {
        let Some(Scratch { high, sound, turns }) = self.scratch.as_deref_mut() else { return };
        let Work { written, asleep, bits, .. } = &mut self.work;
        let [_, full_rate] = turned(&mut self.outputs, self.side);
        let Some(band) = self.bands.get_mut(index) else { return };
        if band.config.sleeps(&band.state, *bits) {
            return;
        }
        let own = usize::from(band.division);
        let block = quotient(BLOCK_FRAMES, own);
        let out = if own == 1 { full_rate.get_mut(..) } else { self.rates.get_mut(block..2 * block) };
        let lines = self.lines.get_mut(usize::from(band.start)..usize::from(band.start) + usize::from(band.pairs));
        let (Some(lines), Some(out), Some(written), Some(high)) =
            (lines, out, written.get_mut(own.trailing_zeros() as usize), high.get(..block))
        else {
            return;
        };
        *asleep = false;
        *written |= band.config.render(&mut band.state, lines, (high, *bits), turns, sound, (out, *written));
    }
}

/// A division without a panic: the divisor is never 0.
fn quotient(dividend: usize, divisor: usize) -> usize {
    dividend.checked_div(divisor).unwrap_or(0)
}

/// Keeps every `step`th sample, a power of two.
fn thin(block: &mut [i32], step: usize) {
    let mut block = Cell::from_mut(block).as_slice_of_cells();
    for _ in 0..step.trailing_zeros() {
        for (to, [from, _]) in block.iter().zip(block.as_chunks::<2>().0) {
            to.set(from.get());
        }
        block = block.get(..block.len() / 2).unwrap_or_default();
    }
}
