//! Spectra in separate real and imaginary parts, in single and double precision.

use fourier::Complex;

use crate::vectors::LANES;

/// Complex number in single precision.
pub(super) type C32 = Complex<f32>;

/// A spectrum in separate real and imaginary parts.
#[derive(Clone, Debug, Default)]
pub(super) struct Split {
    pub(super) re: Vec<f32>,
    pub(super) im: Vec<f32>,
}

/// Values in separate real and imaginary parts, in double precision.
#[derive(Clone, Debug, Default)]
pub(super) struct Wide {
    pub(super) re: Vec<f64>,
    pub(super) im: Vec<f64>,
}

impl Split {
    pub(super) fn zeros(length: usize) -> Self {
        Self { re: vec![0.0; length], im: vec![0.0; length] }
    }

    pub(super) fn clear(&mut self) {
        self.re.fill(0.0);
        self.im.fill(0.0);
    }

    pub(super) fn push(&mut self, value: Complex<f64>) {
        self.re.push(value.re as f32);
        self.im.push(value.im as f32);
    }

    pub(super) fn at(&self, index: usize) -> C32 {
        match (self.re.get(index), self.im.get(index)) {
            (Some(&re), Some(&im)) => C32 { re, im },
            _ => C32::default(),
        }
    }

    /// Adds `factor` times `shape` from `first` on.
    #[inline(always)] // into loops for the vector units that there are
    pub(super) fn add(&mut self, factor: C32, shape: &Self, first: usize) {
        let to = first + shape.re.len();
        let (re, im) = (&mut self.re[first..to], &mut self.im[first..to]);
        for (((re, im), a), b) in re.iter_mut().zip(im).zip(&shape.re).zip(&shape.im) {
            *re += factor.re * a - factor.im * b;
            *im += factor.re * b + factor.im * a;
        }
    }

    /// Sum `Σ self* · shape` from `first` on.
    #[inline(always)] // into loops for the vector units that there are
    pub(super) fn dot(&self, shape: &Self, first: usize) -> C32 {
        let to = first + shape.re.len();
        let ((x, x_rest), (y, y_rest)) =
            (self.re[first..to].as_chunks::<LANES>(), self.im[first..to].as_chunks::<LANES>());
        let ((a, a_rest), (b, b_rest)) = (shape.re.as_chunks::<LANES>(), shape.im.as_chunks::<LANES>());
        let (mut re, mut im) = ([0.0f32; LANES], [0.0f32; LANES]);
        for ((x, y), (a, b)) in x.iter().zip(y).zip(a.iter().zip(b)) {
            re = std::array::from_fn(|lane| re[lane] + (x[lane] * a[lane] + y[lane] * b[lane]));
            im = std::array::from_fn(|lane| im[lane] + (x[lane] * b[lane] - y[lane] * a[lane]));
        }
        let rest = x_rest.iter().zip(y_rest).zip(a_rest.iter().zip(b_rest));
        for ((re, im), ((x, y), (a, b))) in re.iter_mut().zip(&mut im).zip(rest) {
            *re += x * a + y * b;
            *im += x * b - y * a;
        }
        C32::new(re.iter().sum(), im.iter().sum())
    }
}

impl Wide {
    pub(super) fn at(&self, index: usize) -> Complex<f64> {
        Complex::new(self.re[index], self.im[index])
    }

    /// Derivatives of values `D` by `ln z`: `D² - D`.
    #[inline(always)]
    pub(super) fn bent(&self) -> Self {
        let pairs = self.re.iter().zip(&self.im);
        Self {
            re: pairs.clone().map(|(re, im)| re * re - im * im - re).collect(),
            im: pairs.map(|(re, im)| 2.0 * re * im - im).collect(),
        }
    }

    /// The values in single precision.
    #[inline(always)]
    pub(super) fn narrow(&self) -> Split {
        Split {
            re: self.re.iter().map(|value| *value as f32).collect(),
            im: self.im.iter().map(|value| *value as f32).collect(),
        }
    }
}

/// Values under a Hann window, without the first and the last.
#[inline(always)]
pub(super) fn windowed(values: &Wide) -> Split {
    let part = |part: &[f64]| -> Vec<f32> {
        let inner = part.get(1..part.len().saturating_sub(1)).unwrap_or(&[]);
        let threes = part.iter().zip(inner).zip(part.get(2..).unwrap_or(&[]));
        threes.map(|((before, at), behind)| (at * 0.5 - (before + behind) * 0.25) as f32).collect()
    };
    Split { re: part(&values.re), im: part(&values.im) }
}

/// The spectrum under a Hann window; its own adjoint.
#[inline(always)]
pub(super) fn hann_of(spectrum: &Split) -> Split {
    let length = spectrum.re.len();
    let part = |x: &[f32]| {
        let at = |index: usize| if index < length { x[index] } else { 0.0 };
        (0..length).map(|k| 0.5 * x[k] - 0.25 * (at(k.wrapping_sub(1)) + at(k + 1))).collect()
    };
    Split { re: part(&spectrum.re), im: part(&spectrum.im) }
}
