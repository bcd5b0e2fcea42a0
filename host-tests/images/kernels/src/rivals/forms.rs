//! Resonators of other crates, and the plain loop that one would write first.
//!
//! They are compiled twice: into the image, to count cycles, and into `host-tests`, to compare them
//! with `f64`.
//!
//! Each is used as its crate's documentation shows: a sample at a time, in a loop. Its memory is in
//! local variables during a block, and its output is added to the mix in that loop. No use that the
//! crates allow is faster.

use biquad::Biquad as _;
use dsp_fixedpoint::Q32;
use dsp_process::SplitProcess;
use idsp::iir;

/// Resonator of one kind.
pub trait Resonator: Clone {
    /// Type of a sample.
    type Sample: Copy;
    /// Sample that stands for no input.
    const SILENCE: Self::Sample;
    /// Makes a resonator from five words: bits of `f32` or integers. Each kind says what they mean.
    fn new(words: [u32; 5]) -> Self;
    /// Computes the next sample.
    fn step(&mut self, input: Self::Sample) -> Self::Sample;
    /// Computes the next sample without input.
    #[inline(always)]
    fn ring(&mut self) -> Self::Sample {
        self.step(Self::SILENCE)
    }
    /// Adds a sample of this kind to a mix.
    fn mix(sum: Self::Sample, sample: Self::Sample) -> Self::Sample;
}

/// Adds a block of all resonators to `out`. Each is driven by `force`, or rings freely.
#[inline(always)]
pub fn render<R: Resonator>(resonators: &mut [R], force: Option<&[R::Sample]>, out: &mut [R::Sample]) {
    for resonator in resonators {
        let mut local = resonator.clone();
        match force {
            Some(force) => {
                for (sum, &x) in out.iter_mut().zip(force) {
                    *sum = R::mix(*sum, local.step(x));
                }
            }
            None => {
                for sum in out.iter_mut() {
                    *sum = R::mix(*sum, local.ring());
                }
            }
        }
        *resonator = local;
    }
}

/// Number of bits by which a fixed-point rival's sample is shifted right into the mix.
///
/// A mode at full scale peaks at 2^29 in the rival, which leaves two bits of headroom, and at 2^27
/// on the bus.
pub const MIX_SHIFT: u32 = 2;

macro_rules! float_mix {
    () => {
        type Sample = f32;
        const SILENCE: f32 = 0.0;
        #[inline(always)]
        fn mix(sum: f32, sample: f32) -> f32 {
            sum + sample
        }
    };
}

macro_rules! fixed_mix {
    () => {
        type Sample = i32;
        const SILENCE: i32 = 0;
        #[inline(always)]
        fn mix(sum: i32, sample: i32) -> i32 {
            sum.wrapping_add(sample >> MIX_SHIFT)
        }
    };
}

fn float_words(words: [u32; 5]) -> [f32; 5] {
    words.map(f32::from_bits)
}

/// Recurrence `y = b x + a1 y1 + a2 y2` in single precision.
///
/// An input is heard in its own sample. The other resonators take inputs through b1, a sample
/// later.
#[derive(Clone)]
pub struct PlainDirect {
    b: f32,
    a1: f32,
    a2: f32,
    y1: f32,
    y2: f32,
}

impl Resonator for PlainDirect {
    float_mix!();
    fn new(words: [u32; 5]) -> Self {
        let [_, b, _, a1, a2] = float_words(words);
        Self { b, a1, a2, y1: 0.0, y2: 0.0 }
    }
    #[inline(always)]
    fn step(&mut self, input: f32) -> f32 {
        self.ring();
        self.y1 += self.b * input;
        self.y1
    }
    #[inline(always)]
    fn ring(&mut self) -> f32 {
        (self.y1, self.y2) = (self.a1 * self.y1 + self.a2 * self.y2, self.y1);
        self.y1
    }
}

/// `biquad::DirectForm1<f32>`. The crate has no fixed-point type.
#[derive(Clone)]
pub struct BiquadDirect1(biquad::DirectForm1<f32>);

/// `biquad::DirectForm2Transposed<f32>`.
#[derive(Clone)]
pub struct BiquadDirect2(biquad::DirectForm2Transposed<f32>);

/// Coefficients for `biquad`, whose a1 and a2 have the signs of the denominator.
fn biquad_coefficients(words: [u32; 5]) -> biquad::Coefficients<f32> {
    let [b0, b1, b2, a1, a2] = float_words(words);
    biquad::Coefficients { b0, b1, b2, a1: -a1, a2: -a2 }
}

impl Resonator for BiquadDirect1 {
    float_mix!();
    fn new(words: [u32; 5]) -> Self {
        Self(biquad::DirectForm1::new(biquad_coefficients(words)))
    }
    #[inline(always)]
    fn step(&mut self, input: f32) -> f32 {
        self.0.run(input)
    }
}

impl Resonator for BiquadDirect2 {
    float_mix!();
    fn new(words: [u32; 5]) -> Self {
        Self(biquad::DirectForm2Transposed::new(biquad_coefficients(words)))
    }
    #[inline(always)]
    fn step(&mut self, input: f32) -> f32 {
        self.0.run(input)
    }
}

/// Configuration of `idsp` with its state.
#[derive(Clone)]
pub struct Idsp<C, S> {
    configuration: C,
    state: S,
}

/// `idsp::iir::Biquad<f32>`, direct form 1.
pub type IdspFloatDirect1 = Idsp<iir::Biquad<f32>, iir::DirectForm1<f32>>;
/// `idsp::iir::Biquad<f32>`, direct form 2 transposed.
pub type IdspFloatDirect2 = Idsp<iir::Biquad<f32>, iir::DirectForm2Transposed<f32>>;
/// `idsp::iir::Biquad<Q32<30>>`, direct form 1. Coefficients have 30 bits behind the point, because
/// a1 reaches 2.
pub type IdspFixedDirect1 = Idsp<iir::Biquad<Q32<30>>, iir::DirectForm1<i32>>;
/// `idsp::iir::Biquad<Q32<30>>`, direct form 1 with first-order error feedback.
pub type IdspFixedDither = Idsp<iir::Biquad<Q32<30>>, iir::DirectForm1Dither>;
/// `idsp::iir::Biquad<Q32<30>>`, direct form 1 with 64-bit outputs in its memory.
pub type IdspFixedWide = Idsp<iir::Biquad<Q32<30>>, iir::DirectForm1Wide>;
/// `idsp::iir::normal::Normal<f32>`: rotation of two components.
pub type IdspFloatNormal = Idsp<iir::normal::Normal<f32>, iir::DirectForm1<f32>>;
/// `idsp::iir::normal::Normal<Q32<31>>`: rotation of two components. Coefficients have 31 bits
/// behind the point, because poles are inside the unit circle.
pub type IdspFixedNormal = Idsp<iir::normal::Normal<Q32<31>>, iir::DirectForm1<i32>>;

macro_rules! idsp_resonator {
    ($form:ty, $mix:ident, |$words:ident| $configuration:expr) => {
        impl Resonator for $form {
            $mix!();
            fn new($words: [u32; 5]) -> Self {
                Self { configuration: $configuration, state: Default::default() }
            }
            #[inline(always)]
            fn step(&mut self, input: Self::Sample) -> Self::Sample {
                self.configuration.process(&mut self.state, input)
            }
        }
    };
}

idsp_resonator!(IdspFloatDirect1, float_mix, |words| iir::Biquad { ba: float_words(words) });
idsp_resonator!(IdspFloatDirect2, float_mix, |words| iir::Biquad { ba: float_words(words) });
idsp_resonator!(IdspFixedDirect1, fixed_mix, |words| iir::Biquad { ba: fixed_words(words) });
idsp_resonator!(IdspFixedDither, fixed_mix, |words| iir::Biquad { ba: fixed_words(words) });
idsp_resonator!(IdspFixedWide, fixed_mix, |words| iir::Biquad { ba: fixed_words(words) });
idsp_resonator!(IdspFloatNormal, float_mix, |words| normal(float_words(words)));
idsp_resonator!(IdspFixedNormal, fixed_mix, |words| normal(fixed_words(words)));

fn fixed_words<const F: i8>(words: [u32; 5]) -> [Q32<F>; 5] {
    words.map(|word| Q32::from_bits(word.cast_signed()))
}

/// Makes a rotation from three output weights and the pole.
fn normal<C: Copy>([b0, b1, b2, re, im]: [C; 5]) -> iir::normal::Normal<C> {
    iir::normal::Normal { b: [b0, b1, b2], p: idsp::Complex::new(re, im) }
}

/// Low-pass output of `idsp::iir::svf::Svf<f32>`: two integrators in a loop.
#[derive(Clone)]
pub struct IdspVariable {
    configuration: iir::svf::Svf<f32>,
    state: iir::svf::State<f32>,
    gain: f32,
}

impl Resonator for IdspVariable {
    float_mix!();
    /// Makes a filter from the gain of the input, the frequency in cycles a sample, and the
    /// quality.
    fn new(words: [u32; 5]) -> Self {
        let [gain, frequency, quality, ..] = float_words(words);
        Self { configuration: iir::svf::Svf::new(frequency, quality), state: Default::default(), gain }
    }
    #[inline(always)]
    fn step(&mut self, input: f32) -> f32 {
        self.configuration.process(&mut self.state, self.gain * input);
        self.state.lp
    }
}
