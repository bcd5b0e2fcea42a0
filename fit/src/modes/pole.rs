//! A mode's pole, with the sample as unit of time.

use nalgebra::Complex;

use crate::vectors::vectorized;

/// A pole `z = e^{-decay + j angular}`, both per sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pole {
    /// Decay in 1/sample, above 0.
    pub(crate) decay: f64,
    /// Angular frequency in rad/sample, 0 to π.
    pub(crate) angular: f64,
}

impl Pole {
    pub(crate) fn new(frequency_hz: f64, decay_per_s: f64, rate_hz: f64) -> Self {
        Self { decay: decay_per_s / rate_hz, angular: std::f64::consts::TAU * frequency_hz / rate_hz }
    }

    pub(crate) fn frequency_hz(self, rate_hz: f64) -> f64 {
        self.angular * rate_hz / std::f64::consts::TAU
    }

    pub(crate) fn decay_per_s(self, rate_hz: f64) -> f64 {
        self.decay * rate_hz
    }

    /// Power `zⁿ`.
    pub(crate) fn power(self, n: f64) -> Complex<f64> {
        Complex::from_polar((-self.decay * n).exp(), self.angular * n)
    }

    /// Number of `length` samples after which the rest changes no digit (150 dB down).
    pub(crate) fn lasting(self, length: usize) -> usize {
        length.min(((17.3 / self.decay).ceil() as usize).saturating_add(1))
    }
}

/// Number of powers in a block: a whole block is made by one product, as
/// `z^(start + i) = z^start z^i`.
const BLOCK: usize = 64;

/// Powers `z^0 .. z^63`, with real and imaginary parts in separate arrays.
pub(crate) struct PowerBlock {
    re: [f64; BLOCK],
    im: [f64; BLOCK],
}

impl PowerBlock {
    #[inline(always)]
    pub(crate) fn new(pole: Pole) -> Self {
        let mut block = Self { re: [0.0; BLOCK], im: [0.0; BLOCK] };
        block.re[0] = 1.0;
        // Sines and exponentials cost far more than products: each half is the one before, turned.
        let (mut turn, mut made) = (pole.power(1.0), 1);
        while made < BLOCK {
            let ((re, later_re), (im, later_im)) = (block.re.split_at_mut(made), block.im.split_at_mut(made));
            for (((re, im), later_re), later_im) in re.iter().zip(im).zip(later_re).zip(later_im) {
                *later_re = re * turn.re - *im * turn.im;
                *later_im = re * turn.im + *im * turn.re;
            }
            turn *= turn;
            made *= 2;
        }
        block
    }

    /// Sums `[Σ x zⁱ, Σ i x zⁱ]` over at most a block of samples.
    #[inline(always)]
    fn weigh(&self, samples: &[f64]) -> [Complex<f64>; 2] {
        let (mut re, mut im, mut re_n, mut im_n) = ([0.0; 4], [0.0; 4], [0.0; 4], [0.0; 4]);
        let mut index = [0.0, 1.0, 2.0, 3.0];
        let mut add = |x: f64, z_re: f64, z_im: f64, lane: usize| {
            let (a, b) = (x * z_re, x * z_im);
            re[lane] += a;
            im[lane] += b;
            re_n[lane] += a * index[lane];
            im_n[lane] += b * index[lane];
            index[lane] += 4.0;
        };
        let (fours, rest) = samples.as_chunks::<4>();
        for ((x, z_re), z_im) in fours.iter().zip(self.re.as_chunks::<4>().0).zip(self.im.as_chunks::<4>().0) {
            for lane in 0..4 {
                add(x[lane], z_re[lane], z_im[lane], lane);
            }
        }
        let from = 4 * fours.len();
        for (lane, ((x, z_re), z_im)) in rest.iter().zip(&self.re[from..]).zip(&self.im[from..]).enumerate() {
            add(*x, *z_re, *z_im, lane);
        }
        let sum = |lanes: [f64; 4]| (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
        [Complex::new(sum(re), sum(im)), Complex::new(sum(re_n), sum(im_n))]
    }

    #[inline(always)]
    fn add(&self, factor: Complex<f64>, samples: &mut [f64]) {
        for ((x, re), im) in samples.iter_mut().zip(&self.re).zip(&self.im) {
            *x += factor.re * re - factor.im * im;
        }
    }
}

/// Sums `[Σ x[n] zⁿ, Σ n x[n] zⁿ]`.
pub(crate) fn project(pole: Pole, samples: &[f64]) -> [Complex<f64>; 2] {
    let samples = &samples[..pole.lasting(samples.len())];
    vectorized(
        #[inline(always)]
        || {
            let block = PowerBlock::new(pole);
            let mut sums = [Complex::new(0.0, 0.0); 2];
            for (index, samples) in samples.chunks(BLOCK).enumerate() {
                let start = (index * BLOCK) as f64;
                let power = pole.power(start);
                let [plain, ramp] = block.weigh(samples);
                sums[0] += power * plain;
                sums[1] += power * (ramp + plain * start);
            }
            sums
        },
    )
}

/// Adds `Re(gain zⁿ)` to the samples.
pub(crate) fn add_ringing(pole: Pole, gain: Complex<f64>, samples: &mut [f64]) {
    let lasting = pole.lasting(samples.len());
    let samples = &mut samples[..lasting];
    vectorized(
        #[inline(always)]
        || {
            let block = PowerBlock::new(pole);
            for (index, samples) in samples.chunks_mut(BLOCK).enumerate() {
                block.add(gain * pole.power((index * BLOCK) as f64), samples);
            }
        },
    );
}
