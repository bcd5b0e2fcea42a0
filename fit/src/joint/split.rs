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
        let to = first + shape.re.len();
        let (re, im) = (&self.re[first..to], &self.im[first..to]);
        const LANES: usize = 8;
        let (mut sum_re, mut sum_im) = ([0.0f32; LANES], [0.0f32; LANES]);
        let chunks = re.chunks(LANES).zip(im.chunks(LANES));
        for ((x, y), (a, b)) in chunks.zip(shape.re.chunks(LANES).zip(shape.im.chunks(LANES))) {
            for lane in 0..x.len().min(LANES) {
                sum_re[lane] += x[lane] * a[lane] + y[lane] * b[lane];
                sum_im[lane] += x[lane] * b[lane] - y[lane] * a[lane];
            }
        }
        C32::new(sum_re.iter().sum(), sum_im.iter().sum())
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
