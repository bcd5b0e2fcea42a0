//! Spectra in separate real and imaginary parts, in single precision.

use fourier::Complex;

/// Complex number in single precision.
pub(super) type C32 = Complex<f32>;

/// A spectrum in separate real and imaginary parts.
#[derive(Clone, Debug, Default)]
pub(super) struct Split {
    pub(super) re: Vec<f32>,
    pub(super) im: Vec<f32>,
}

impl Split {
    pub(super) fn zeros(length: usize) -> Self {
        Self { re: vec![0.0; length], im: vec![0.0; length] }
    }

    /// A spectrum of values in double precision.
    pub(super) fn of(values: &[Complex<f64>]) -> Self {
        Self {
            re: values.iter().map(|value| value.re as f32).collect(),
            im: values.iter().map(|value| value.im as f32).collect(),
        }
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
    pub(super) fn add(&mut self, factor: C32, shape: &Self, first: usize) {
        let to = first + shape.re.len();
        let (re, im) = (&mut self.re[first..to], &mut self.im[first..to]);
        for (((re, im), a), b) in re.iter_mut().zip(im).zip(&shape.re).zip(&shape.im) {
            *re += factor.re * a - factor.im * b;
            *im += factor.re * b + factor.im * a;
        }
    }

    /// Sum `Σ self* · shape` from `first` on.
    pub(super) fn dot(&self, shape: &Self, first: usize) -> C32 {
        const LANES: usize = 8;
        let to = first + shape.re.len();
        let ((x, x_rest), (y, y_rest)) =
            (self.re[first..to].as_chunks::<LANES>(), self.im[first..to].as_chunks::<LANES>());
        let ((a, a_rest), (b, b_rest)) = (shape.re.as_chunks::<LANES>(), shape.im.as_chunks::<LANES>());
        let (mut re, mut im) = ([0.0f32; LANES], [0.0f32; LANES]);
        for ((x, y), (a, b)) in x.iter().zip(y).zip(a.iter().zip(b)) {
            for lane in 0..LANES {
                re[lane] += x[lane] * a[lane] + y[lane] * b[lane];
                im[lane] += x[lane] * b[lane] - y[lane] * a[lane];
            }
        }
        let rest = x_rest.iter().zip(y_rest).zip(a_rest.iter().zip(b_rest));
        for ((re, im), ((x, y), (a, b))) in re.iter_mut().zip(&mut im).zip(rest) {
            *re += x * a + y * b;
            *im += x * b - y * a;
        }
        C32::new(re.iter().sum(), im.iter().sum())
    }
}

/// The spectrum under a Hann window; its own adjoint.
pub(super) fn hann_of(spectrum: &Split) -> Split {
    let length = spectrum.re.len();
    let part = |x: &[f32]| {
        let at = |index: usize| if index < length { x[index] } else { 0.0 };
        (0..length).map(|k| 0.5 * x[k] - 0.25 * (at(k.wrapping_sub(1)) + at(k + 1))).collect()
    };
    Split { re: part(&spectrum.re), im: part(&spectrum.im) }
}
