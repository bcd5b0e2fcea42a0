//! The generator SFC32 (Chris Doty-Humphrey, PractRand).

/// Random generator SFC32: small, fast, chaotic, with a counter.
///
/// ```
/// use dsp_core::noise::Sfc32;
/// let (mut one, mut same, mut other) = (Sfc32::new(7, 0), Sfc32::new(7, 0), Sfc32::new(7, 1));
/// let word = one.draw();
/// assert_eq!(word, same.draw());
/// assert_ne!(word, other.draw());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sfc32 {
    a: u32,
    b: u32,
    c: u32,
    counter: u32,
}

/// Standard deviation of the numbers of [`Sfc32::four`], `sqrt((256² - 1) / 3)`.
///
/// The numbers are odd, from -255 to 255, and all equally likely.
pub const DEVIATION: f64 = 147.800_541_270_555_32;

impl Sfc32 {
    /// Makes a generator from a seed and the number of the stream that it serves, such as a pad's.
    pub const fn new(seed: u32, stream: u32) -> Self {
        let mut new = Self { a: seed, b: stream, c: 0x9e37_79b9, counter: 1 };
        let mut step = 0;
        // After 16 steps all bits of the seed have reached all words.
        while step < 16 {
            (new, _) = new.step();
            step += 1;
        }
        new
    }

    const fn step(self) -> (Self, u32) {
        let out = self.a.wrapping_add(self.b).wrapping_add(self.counter);
        let next = Self {
            a: self.b ^ (self.b >> 9),
            b: self.c.wrapping_add(self.c << 3),
            c: self.c.rotate_left(21).wrapping_add(out),
            counter: self.counter.wrapping_add(1),
        };
        (next, out)
    }

    /// Returns the bits that the next [`draw`](Self::draw) will give.
    pub const fn first(self) -> u32 {
        self.step().1
    }

    /// Draws the next 32 random bits.
    #[inline(always)]
    pub fn draw(&mut self) -> u32 {
        let (next, out) = self.step();
        *self = next;
        out
    }

    /// Draws four independent odd numbers from -255 to 255 of mean 0 and deviation [`DEVIATION`].
    ///
    /// They are the real and imaginary parts of two lines of a noise spectrum. A band of several
    /// lines is Gaussian by the central limit theorem.
    #[inline(always)]
    pub fn four(&mut self) -> [i32; 4] {
        self.draw().to_le_bytes().map(|byte| 2 * i32::from(byte as i8) + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_stated_mean_deviation_and_no_correlation() {
        let mut noise = Sfc32::new(3, 5);
        const DRAWS: u32 = 1_000_000;
        let (mut sum, mut products, mut last) = ([0.0; 4], [[0.0; 8]; 4], [0.0; 4]);
        for _ in 0..DRAWS {
            let four = noise.four().map(|x| f64::from(x) / DEVIATION);
            for part in 0..4 {
                sum[part] += four[part];
                for (product, other) in products[part].iter_mut().zip(four.iter().chain(&last)) {
                    *product += four[part] * other;
                }
            }
            last = four;
        }
        let count = f64::from(DRAWS);
        for part in 0..4 {
            assert!((sum[part] / count).abs() < 5e-3, "{sum:?}");
            for (other, product) in products[part].iter().enumerate() {
                let expected = if other == part { 1.0 } else { 0.0 };
                assert!((product / count - expected).abs() < 5e-3, "{part} {other}: {product}");
            }
        }
    }

    #[test]
    fn near_seeds_and_streams_give_unlike_noise() {
        let first = |seed, stream| Sfc32::new(seed, stream).draw();
        let mut drawn: std::vec::Vec<u32> = (0..64).flat_map(|seed| (0..64).map(move |pad| first(seed, pad))).collect();
        drawn.sort_unstable();
        drawn.dedup();
        assert!(drawn.len() >= 4095, "{}", drawn.len());
        let bits: u32 = (0..1000).map(|seed| (first(seed, 0) ^ first(seed + 1, 0)).count_ones()).sum();
        assert!((15_500..16_500).contains(&bits), "{bits}");
    }
}
