//! Noise of a dynamic filter, as docs/noise.md defines it.

/// Generator of uniform noise from -1 to 1.
pub(crate) struct Generator(u32);

impl Generator {
    pub(crate) fn new(seed: u32, stream: u32) -> Self {
        let (mut a, mut b, mut c) = (seed, stream, 0x9e37_79b9_u32);
        let mut word = 0;
        for counter in 1..=17 {
            word = a.wrapping_add(b).wrapping_add(counter);
            (a, b, c) = (b ^ (b >> 9), c.wrapping_add(c << 3), c.rotate_left(21).wrapping_add(word));
        }
        Self(word | 1)
    }

    pub(crate) fn draw(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(0x93d7_65dd);
        f64::from(self.0 as i32) / 2f64.powi(31)
    }
}
