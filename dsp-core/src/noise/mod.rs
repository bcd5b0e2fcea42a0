//! Noise: the same numbers from the same seed on every machine.
//!
//! The generator is SFC32 (Chris Doty-Humphrey, PractRand): three words and a counter, about eight cycles a draw, a period of at least 2^32 from
//! every seed. Each stage has a generator of its own, and draws only while it sounds: what other stages do cannot change its noise.

/// SFC32: small, fast, chaotic, with a counter.
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

/// Standard deviation of the numbers of [`Sfc32::pair`]: each is the sum of two bytes, `sqrt(2 (256² - 1) / 12)`.
pub const PAIR_DEVIATION: f64 = 104.510_765_000_788_14;

impl Sfc32 {
    /// A generator from a seed and the number of the stream that it serves (such as a pad's).
    pub const fn new(seed: u32, stream: u32) -> Self {
        let mut new = Self { a: seed, b: stream, c: 0x9e37_79b9, counter: 1 };
        let mut step = 0;
        // So many until all bits of the seed have reached all words.
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

    /// The next 32 random bits.
    #[inline(always)]
    pub fn draw(&mut self) -> u32 {
        let (next, out) = self.step();
        *self = next;
        out
    }

    /// Two independent whole numbers from -255 to 255, triangularly distributed, mean 0, deviation [`PAIR_DEVIATION`]: the real and the
    /// imaginary part of a line of a noise spectrum. A band of several lines is Gaussian by the central limit theorem.
    #[inline(always)]
    pub fn pair(&mut self) -> [i32; 2] {
        let word = self.draw();
        let sum = |low: u32, high: u32| ((low & 0xff) + (high & 0xff)) as i32 - 255;
        [sum(word, word >> 8), sum(word >> 16, word >> 24)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_have_the_stated_mean_deviation_and_no_correlation() {
        let mut noise = Sfc32::new(3, 5);
        const DRAWS: u32 = 1_000_000;
        let (mut sum, mut square, mut product, mut last) = ([0.0; 2], [0.0; 2], 0.0, [0.0; 2]);
        let mut lagged = 0.0;
        for _ in 0..DRAWS {
            let pair = noise.pair().map(|x| f64::from(x) / PAIR_DEVIATION);
            for part in 0..2 {
                sum[part] += pair[part];
                square[part] += pair[part] * pair[part];
            }
            product += pair[0] * pair[1];
            lagged += pair[0] * last[0] + pair[1] * last[1];
            last = pair;
        }
        let count = f64::from(DRAWS);
        for part in 0..2 {
            assert!(
                (sum[part] / count).abs() < 5e-3 && (square[part] / count - 1.0).abs() < 5e-3,
                "{sum:?} {square:?}"
            );
        }
        assert!((product / count).abs() < 5e-3 && (lagged / count).abs() < 7e-3, "{product} {lagged}");
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
