//! Noise of a dynamic filter, as docs/noise.md defines it.

/// Generator of uniform noise from -1 to 1.
pub(crate) struct Generator {
    x: u32,
    /// x at the last start.
    start: u32,
}

impl Generator {
    pub(crate) fn new(seed: u32, stream: u32) -> Self {
        let (mut a, mut b, mut c) = (seed, stream, 0x9e37_79b9_u32);
        let mut word = 0;
        for counter in 1..=17 {
            word = a.wrapping_add(b).wrapping_add(counter);
            (a, b, c) = (b ^ (b >> 9), c.wrapping_add(c << 3), c.rotate_left(21).wrapping_add(word));
        }
        Self { x: word | 1, start: word | 1 }
    }

    /// Goes on 1 000 003 draws behind the last start.
    pub(crate) fn start_anew(&mut self) {
        self.start = (0..1_000_003).fold(self.start, |x, _| x.wrapping_mul(0x93d7_65dd));
        self.x = self.start;
    }

    pub(crate) fn draw(&mut self) -> f64 {
        self.x = self.x.wrapping_mul(0x93d7_65dd);
        f64::from(self.x as i32) / 2f64.powi(31)
    }
}
