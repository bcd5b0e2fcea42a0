//! White noise of the dynamic filter: the random numbers of the instrument before it rounds them.

/// Generator of uniform noise in -1 to 1 (deviation 1/√3).
///
/// `x ← 0x93d765dd x` modulo 2^32, x odd, read as a signed fraction (Steele and Vigna 2021).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct White(u32);

impl White {
    /// Generator for a seed and a stream.
    ///
    /// Its state is the first word of SFC32 (Doty-Humphrey's PractRand) after 16 steps from (seed,
    /// stream, 0x9e3779b9, counter 1), made odd.
    pub fn new(seed: u32, stream: u32) -> Self {
        let [mut a, mut b, mut c] = [seed, stream, 0x9e37_79b9u32];
        let mut word = 0;
        for counter in 1..=17u32 {
            word = a.wrapping_add(b).wrapping_add(counter);
            (a, b, c) = (b ^ (b >> 9), c.wrapping_add(c << 3), c.rotate_left(21).wrapping_add(word));
        }
        Self(word | 1)
    }

    /// Generator that is 1 000 003 draws ahead of this one.
    pub fn skipped(mut self) -> Self {
        for _ in 0..1_000_003 {
            self.draw();
        }
        self
    }

    /// Draws the next random number.
    pub fn draw(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(0x93d7_65dd);
        f64::from(self.0 as i32) / 2_147_483_648.0
    }
}
