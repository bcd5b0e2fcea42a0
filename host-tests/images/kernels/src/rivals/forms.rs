//! Resonators as others offer them, and the plain loop that anyone would write first. Compiled
//! twice: into the image, to be counted, and into `host-tests`, to be measured against `f64`.
//!
//! Each is used as its crate's documentation shows, a sample at a time in a loop, with its memory
//! in local variables during a block and its output added to the mix in the same loop: the fastest
//! use that the crates allow.

use biquad::Biquad as _;
use dsp_fixedpoint::Q32;
use dsp_process::SplitProcess;
use idsp::iir;

/// One resonator of some kind.
pub trait Resonator: Clone {
    /// Type of a sample.
    type Sample: Copy;
    /// No input.
    const SILENCE: Self::Sample;
    /// From the words that the kind takes: five coefficients, as bits of `f32` or as integers.
    fn new(words: [u32; 5]) -> Self;
    /// The next sample.
    fn step(&mut self, input: Self::Sample) -> Self::Sample;
    /// The next sample without input.
    #[inline(always)]
    fn ring(&mut self) -> Self::Sample {
        self.step(Self::SILENCE)
    }
    /// The sum of a mix and a sample of this kind.
    fn mix(sum: Self::Sample, sample: Self::Sample) -> Self::Sample;
}

/// Adds a block of all resonators, each driven by `force` or ringing freely, to `out`.
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

/// Bits that a fixed-point rival's sample is shifted right into the mix: a mode at full scale peaks
/// at 2^29 in it, which leaves two bits of headroom, and at 2^27 on the bus.
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

/// `y = b x + a1 y1 + a2 y2` in single precision: unlike the others' inputs, which come in through
/// b1, its is heard at once.
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

/// `biquad::DirectForm1<f32>`; the crate brings no fixed-point type.
#[derive(Clone)]
pub struct BiquadDirect1(biquad::DirectForm1<f32>);

/// `biquad::DirectForm2Transposed<f32>`.
#[derive(Clone)]
pub struct BiquadDirect2(biquad::DirectForm2Transposed<f32>);

/// The crate's sign of a1 and a2 is that of the denominator.
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

/// A configuration of `idsp` with its state.
#[derive(Clone)]
pub struct Idsp<C, S> {
    configuration: C,
    state: S,
}

/// `idsp::iir::Biquad<f32>`, direct form 1.
pub type IdspFloatDirect1 = Idsp<iir::Biquad<f32>, iir::DirectForm1<f32>>;
/// `idsp::iir::Biquad<f32>`, direct form 2 transposed.
pub type IdspFloatDirect2 = Idsp<iir::Biquad<f32>, iir::DirectForm2Transposed<f32>>;
/// `idsp::iir::Biquad<Q32<30>>`, direct form 1 (a1 reaches 2, so that coefficients have 30 bits
/// behind the point).
pub type IdspFixedDirect1 = Idsp<iir::Biquad<Q32<30>>, iir::DirectForm1<i32>>;
/// Direct form 1 with first-order error feedback.
pub type IdspFixedDither = Idsp<iir::Biquad<Q32<30>>, iir::DirectForm1Dither>;
/// Direct form 1 with 64-bit outputs in its memory.
pub type IdspFixedWide = Idsp<iir::Biquad<Q32<30>>, iir::DirectForm1Wide>;
/// `idsp::iir::normal::Normal<f32>`: rotation of two components.
pub type IdspFloatNormal = Idsp<iir::normal::Normal<f32>, iir::DirectForm1<f32>>;
/// `idsp::iir::normal::Normal<Q32<31>>`: the same; poles are inside the unit circle, so that
/// coefficients have 31 bits behind the point.
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

/// Three output weights, then the pole.
fn normal<C: Copy>([b0, b1, b2, re, im]: [C; 5]) -> iir::normal::Normal<C> {
    iir::normal::Normal { b: [b0, b1, b2], p: idsp::Complex::new(re, im) }
}

/// `idsp::iir::svf::Svf<f32>`, its low-pass output: two integrators in a loop.
#[derive(Clone)]
pub struct IdspVariable {
    configuration: iir::svf::Svf<f32>,
    state: iir::svf::State<f32>,
    gain: f32,
}

impl Resonator for IdspVariable {
    float_mix!();
    /// Frequency in cycles a sample, quality, and the gain of the input.
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
