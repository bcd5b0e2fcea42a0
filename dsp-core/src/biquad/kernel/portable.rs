//! The kernels in plain Rust: the definition of the bits.

use super::super::section::{SKIPPED, Section};
use super::Signals;
use crate::fixed::{smmlar, smmlsr, smmulr};

/// Runs all sections in their order over the first `frames` of the signals; `odd` says whether the first frame is an odd one.
/// Gives whether any section has left its bounds.
pub fn run(sections: &mut [Section], signals: &mut Signals, frames: usize, odd: bool) -> bool {
    let mut asks = false;
    for section in sections.iter_mut().filter(|section| section.kind != SKIPPED) {
        if section.flip != 0 {
            for word in signals.chain.iter_mut().skip(usize::from(!odd)).step_by(2) {
                *word = word.wrapping_neg();
            }
        }
        let Signals { input, alternating, chain, mix, alternating_mix } = signals;
        let source = match section.source {
            0 => &*input,
            1 => &*alternating,
            _ => &*chain,
        };
        let mix = if section.target == 0 { mix } else { alternating_mix };
        match section.kind >> 2 {
            0 => {
                let direct = section.direct;
                let source = *source;
                for (out, x) in chain.iter_mut().zip(source).take(frames) {
                    *out = smmlar(section.v, direct, x);
                    section.step(x);
                }
            }
            role => {
                for (sum, &x) in mix.iter_mut().zip(source).take(frames) {
                    *sum = smmlar(*sum, section.v, section.scale);
                    if role == 1 {
                        *sum = smmlar(*sum, section.direct, x);
                    }
                    section.step(x);
                }
            }
        }
        asks |= section.asks();
    }
    asks
}

impl Section {
    /// One sample.
    #[inline(always)]
    fn step(&mut self, x: i32) {
        self.u = smmlsr(self.u, self.turn, self.v);
        match self.kind & 3 {
            0 => self.v = smmlar(self.v, self.turn, self.u),
            1 => self.v += self.u << 1,
            _ => self.v += self.u << 2,
        }
        self.u = match self.kind & 3 {
            3 => smmulr(self.u << 1, self.damp),
            _ => smmlsr(self.u, self.damp, self.u),
        };
        self.u = smmlar(self.u, self.gain_u, x);
        self.v = smmlar(self.v, self.gain_v, x);
    }
}
