//! The kernels in plain Rust: the definition of the bits.

use super::super::pair::{Cell, Pair};
use super::super::pole::Form;
use super::parameters::{Outcome, Run};
use crate::fixed::{qadd, saturating_shift_left, smmlar, smmlsr, smmulr};
use crate::time::TICK_FRAMES;

/// Runs all pairs in their order and adds their sound to `out`, which is at most a tick.
///
/// Mirrored pairs must come last. An input is as long as `out`.
pub fn run(pairs: &mut [Pair], run: Run, input: Option<&[i32]>, out: &mut [i32]) -> Outcome {
    let given = input.unwrap_or(&[]);
    let frames = out.len().min(TICK_FRAMES);
    let (mut x, mut mix, mut chain) = ([0; TICK_FRAMES], [0; TICK_FRAMES], [0; TICK_FRAMES]);
    let (mut peak, mut used) = (0, 0u32);
    for ((x, mix), &word) in x.iter_mut().zip(&mut mix).zip(given) {
        peak |= folded(word);
        *x = run.word(word);
        // The cap is far above any allowance.
        used = used.saturating_add(folded(*x)).min(i32::MAX as u32);
        *mix = smmulr(*x, run.direct);
    }
    if peak >> run.bits != 0 || used > run.allowance {
        return Outcome { used: 0, asks: false, refused: true };
    }
    let (mut asks, mut flipped) = (false, false);
    for pair in pairs.iter_mut().filter(|pair| !pair.is_skipped()) {
        if pair.is_mirrored() && !flipped {
            flip(&mut x, run.odd);
            flip(&mut mix, run.odd);
            flipped = true;
        }
        let words = x.iter().zip(&mut mix).zip(&mut chain).take(frames);
        words.for_each(|((&x, mix), chain)| pair.step(x, mix, chain));
        pair.asks = u8::from(pair.has_left_bounds());
        asks |= pair.asks != 0;
    }
    if flipped {
        flip(&mut mix, run.odd);
    }
    for (out, &sum) in out.iter_mut().zip(&mix) {
        *out = qadd(*out, saturating_shift_left(sum, run.room));
    }
    Outcome { used, asks, refused: false }
}

fn folded(word: i32) -> u32 {
    (word ^ (word >> 31)) as u32
}

fn flip(words: &mut [i32; TICK_FRAMES], odd: bool) {
    words.iter_mut().skip(usize::from(!odd)).step_by(2).for_each(|word| *word = word.wrapping_neg());
}

impl Pair {
    /// Runs a frame. Multipliers that a wiring does not use are 0 and add nothing.
    #[inline(always)]
    fn step(&mut self, x: i32, mix: &mut i32, chain: &mut i32) {
        let form = self.form();
        let [first, second] = &mut self.cells;
        let [scale, other_scale] = self.scales;
        *mix = smmlar(*mix, first.v, scale);
        *mix = smmlar(*mix, second.v, other_scale);
        let handed = core::mem::replace(chain, second.v);
        second.step(form);
        second.u = smmlar(second.u, first.v, self.couple);
        first.step(form);
        first.u = smmlar(first.u, handed, self.chain);
        first.inject(x);
        second.inject(x);
    }
}

impl Cell {
    #[inline(always)]
    fn step(&mut self, form: Form) {
        self.u = smmlsr(self.u, self.turn, self.v);
        self.v = match form {
            Form::Coupled => smmlar(self.v, self.turn, self.u),
            form => self.v.wrapping_add(self.u << form.shift()),
        };
        self.u = match form {
            Form::Damped => smmulr(self.u << 1, self.damp),
            _ => smmlsr(self.u, self.damp, self.u),
        };
    }

    #[inline(always)]
    fn inject(&mut self, x: i32) {
        self.u = smmlar(self.u, self.gain_u, x);
        self.v = smmlar(self.v, self.gain_v, x);
    }
}
