//! The kernel in plain Rust: the definition of the bits. Nothing is fused, and sums go from the
//! first section to the last.

use super::super::quad::Quad;

/// Adds the sound of all quads to `out`, one after the other, and first the input times `direct`.
/// An input is as long as `out`.
pub fn run(quads: &mut [Quad], input: Option<&[f32]>, direct: f32, out: &mut [f32]) {
    if direct != 0.0
        && let Some(input) = input
    {
        out.iter_mut().zip(input).for_each(|(out, x)| *out += direct * x);
    }
    for quad in quads.iter_mut().filter(|quad| quad.awake != 0) {
        match input {
            Some(input) => {
                for (out, &x) in out.iter_mut().zip(input) {
                    quad.step(out);
                    quad.inject(x);
                }
            }
            None => out.iter_mut().for_each(|out| quad.step(out)),
        }
    }
}

/// Adds the sound of a quad whose sections stand behind one another to `out`: plain code on every
/// machine.
pub fn run_linked(quad: &mut Quad, input: Option<&[f32]>, out: &mut [f32]) {
    for (index, out) in out.iter_mut().enumerate() {
        let before = quad.v;
        for (v, sounding) in before.iter().zip(quad.sounding) {
            *out += v * sounding;
        }
        quad.turn();
        let handed = [0.0].into_iter().chain(before);
        for ((u, couple), v) in quad.u.iter_mut().zip(quad.couple).zip(handed) {
            *u += couple * v;
        }
        if let Some(&x) = input.and_then(|input| input.get(index)) {
            quad.inject(x);
        }
    }
}

impl Quad {
    #[inline(always)]
    fn step(&mut self, out: &mut f32) {
        for v in self.v {
            *out += v;
        }
        self.turn();
    }

    #[inline(always)]
    fn turn(&mut self) {
        for m in 0..4 {
            self.u[m] -= self.turn[m] * self.v[m];
            self.v[m] += self.entry[m] * self.u[m];
            self.u[m] *= self.kept[m];
        }
    }

    #[inline(always)]
    fn inject(&mut self, x: f32) {
        for m in 0..4 {
            self.u[m] += x;
            self.v[m] += self.gain[m] * x;
        }
    }
}
