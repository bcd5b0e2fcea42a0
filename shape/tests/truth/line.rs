//! Functions along a line from -1 to 1, even or odd, orthonormal: factors of products by Ritz.

/// Functions at the points of a quadrature over the half line from 0 to 1.
pub(crate) struct Line {
    /// Weights of the quadrature; they sum to 1.
    weights: Vec<f64>,
    /// Values of each function and of its first two derivatives at the points of the quadrature.
    functions: Vec<[Vec<f64>; 3]>,
}

/// Points and weights of Gauss's quadrature from 0 to 1, exact to the degree 2 count - 1.
pub(crate) fn gauss(count: usize) -> Vec<[f64; 2]> {
    let point = |k: usize| {
        let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (count as f64 + 0.5)).cos();
        for _ in 0..8 {
            let [value, slope, _] = legendre(count, x);
            x -= value / slope;
        }
        let slope = legendre(count, x)[1];
        [(1.0 - x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..count).map(point).collect()
}

/// Legendre polynomial and its first two derivatives.
pub(crate) fn legendre(degree: usize, x: f64) -> [f64; 3] {
    let (mut before, mut now) = ([0.0; 3], [1.0, 0.0, 0.0]);
    for k in 1..=degree {
        let k = k as f64;
        let (a, b) = ((2.0 * k - 1.0) / k, (k - 1.0) / k);
        let next = [
            a * x * now[0] - b * before[0],
            a * (x * now[1] + now[0]) - b * before[1],
            a * (x * now[2] + 2.0 * now[1]) - b * before[2],
        ];
        (before, now) = (now, next);
    }
    now
}

/// Product of functions with their first two derivatives.
pub(crate) fn product(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2]]
}

impl Line {
    /// Makes orthonormal functions, even or odd, of Legendre polynomials below a degree, each times
    /// `factor`. A layer (width, count) adds the powers of the distance from its inner end, from
    /// the first to the count-th, times `factor`, that vanish outside the layer.
    pub(crate) fn new(
        is_odd: bool,
        degrees: usize,
        layer: Option<(f64, usize)>,
        factor: impl Fn(f64) -> [f64; 3],
    ) -> Self {
        let width = layer.map_or(1.0, |(width, _)| width.min(1.0));
        let points = gauss(degrees + 12);
        let inner = points.iter().map(|[at, weight]| [(1.0 - width) * at, (1.0 - width) * weight]);
        let outer = points.iter().map(|[at, weight]| [1.0 - width + width * at, width * weight]);
        let points: Vec<[f64; 2]> = inner.chain(outer).filter(|[_, weight]| *weight > 0.0).collect();
        let mut line = Self { weights: points.iter().map(|point| point[1]).collect(), functions: vec![] };
        for degree in (usize::from(is_odd)..degrees).step_by(2) {
            line.push(points.iter().map(|[x, _]| product(legendre(degree, *x), factor(*x))));
        }
        for power in 1..=layer.map_or(0, |(_, count)| count as i32) {
            line.push(points.iter().map(|[x, _]| {
                let depth = (x - 1.0 + width) / width;
                let slope = f64::from(power) / width;
                let value =
                    if depth > 0.0 { [depth.powi(power), slope * depth.powi(power - 1), 0.0] } else { [0.0; 3] };
                product(value, factor(*x))
            }));
        }
        line
    }

    /// Makes orthonormal functions of others, each given by its value and first derivative at a
    /// place, by the places and weights of a quadrature.
    pub(crate) fn over(points: &[[f64; 2]], functions: &[impl Fn(f64) -> [f64; 2]]) -> Self {
        let mut line = Self { weights: points.iter().map(|point| point[1]).collect(), functions: vec![] };
        for function in functions {
            line.push(points.iter().map(|[x, _]| {
                let [value, slope] = function(*x);
                [value, slope, 0.0]
            }));
        }
        line
    }

    /// Value of a function or, with the order 1, of its derivative at a point of the quadrature.
    pub(crate) fn value(&self, function: usize, order: usize, point: usize) -> f64 {
        self.functions[function][order][point]
    }

    /// Adds a function made orthonormal to those before, unless it is one of their sums.
    fn push(&mut self, values: impl Iterator<Item = [f64; 3]> + Clone) {
        let mut new = [0, 1, 2].map(|order| values.clone().map(|value| value[order]).collect::<Vec<f64>>());
        let size = self.inner(&new[0], &new[0]).sqrt();
        // Twice: rounding leaves a part of what the first pass takes away.
        for _ in 0..2 {
            for function in &self.functions {
                let share = self.inner(&new[0], &function[0]);
                for (new, old) in new.iter_mut().zip(function) {
                    new.iter_mut().zip(old).for_each(|(new, old)| *new -= share * old);
                }
            }
        }
        let left = self.inner(&new[0], &new[0]).sqrt();
        if left > 1e-6 * size {
            new.iter_mut().flatten().for_each(|value| *value /= left);
            self.functions.push(new);
        }
    }

    fn inner(&self, a: &[f64], b: &[f64]) -> f64 {
        self.weights.iter().zip(a).zip(b).map(|((weight, a), b)| weight * a * b).sum()
    }

    /// Number of functions.
    pub(crate) fn count(&self) -> usize {
        self.functions.len()
    }

    /// Integrals from 0 to 1 of the products of derivatives of this line's functions (rows) and of
    /// another's, of the orders given.
    pub(crate) fn integrals(&self, order: usize, other: &Self, other_order: usize) -> Vec<Vec<f64>> {
        let row = |function: &[Vec<f64>; 3]| {
            other.functions.iter().map(|other| self.inner(&function[order], &other[other_order])).collect()
        };
        self.functions.iter().map(row).collect()
    }
}
