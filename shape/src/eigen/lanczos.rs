//! Lanczos steps by blocks, every vector made M-orthogonal to all before it.

use super::factor::{Cholesky, zeros};
use super::mass::Mass;
use super::{EigenError, Problem};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par, Scale, Side};

/// Part of a vector's norm that is only rounding once the vectors before it are taken away.
const ROUNDING: f64 = 1e-14;

/// Part of a vector's norm below which what is left of it is made orthogonal again.
const CANCELLED: f64 = 0.1;

/// M-orthonormal vectors, and the operator (K − σ M)⁻¹ M between them.
pub(super) struct Basis<'a> {
    problem: &'a Problem,
    mass: &'a Mass,
    /// All vectors but those of the next block, by columns, and their products with the mass: each
    /// product is made once, as it costs as much as the parts along dozens of vectors.
    vectors: Vec<f64>,
    vectors_mass: Vec<f64>,
    /// First vector of the last block.
    recent: usize,
    /// Products of the vectors with the images of each, a list for each image.
    projected: Vec<Vec<f64>>,
    /// Vectors of the next block, and their products with the mass.
    next: Vec<Vec<f64>>,
    next_mass: Vec<Vec<f64>>,
    /// Part of the images of the last block along each vector of the next.
    coupling: Vec<Vec<f64>>,
    random: u64,
}

/// Approximations of the eigenpairs of the operator, the greatest first.
pub(super) struct Ritz {
    /// Eigenvalues θ of the projected operator.
    pub(super) values: Vec<f64>,
    /// Norm of what each eigenpair leaves.
    pub(super) residuals: Vec<f64>,
    /// Eigenvectors of the projected operator by columns, in ascending order.
    vectors: Mat<f64>,
}

impl<'a> Basis<'a> {
    /// Starts with a block of random vectors.
    pub(super) fn new(problem: &'a Problem, mass: &'a Mass, block: usize) -> Result<Self, EigenError> {
        let mut basis = Self {
            problem,
            mass,
            vectors: Vec::new(),
            vectors_mass: Vec::new(),
            recent: 0,
            projected: Vec::new(),
            next: Vec::new(),
            next_mass: Vec::new(),
            coupling: Vec::new(),
            random: 0x9e37_79b9_7f4a_7c15,
        };
        basis.widen(block)?;
        Ok(basis)
    }

    /// Returns the number of vectors whose images are known.
    pub(super) fn len(&self) -> usize {
        self.projected.len()
    }

    /// Tells whether the vectors span everything.
    pub(super) fn is_full(&self) -> bool {
        self.next.is_empty()
    }

    /// Takes the next block in, and makes another one of its images.
    pub(super) fn expand(&mut self, factor: &mut Cholesky<'_>) -> Result<(), EigenError> {
        let size = self.problem.size;
        let (block, blocks_mass) = (std::mem::take(&mut self.next), std::mem::take(&mut self.next_mass));
        let width = block.len();
        let mut images = blocks_mass.concat();
        for (all, block) in [(&mut self.vectors, block), (&mut self.vectors_mass, blocks_mass)] {
            all.try_reserve(size * width).map_err(|_| EigenError::Memory)?;
            block.iter().for_each(|vector| all.extend_from_slice(vector));
        }
        factor.solve(MatMut::from_column_major_slice_mut(&mut images, size, width));
        // Images have parts along their own block and the one before it; all others are rounding.
        let (all, recent) = (self.vectors.len() / size, self.recent);
        let near = self.take_away(&mut images, width, recent);
        let mut parts = self.take_away(&mut images, width, 0);
        let mut recent_parts = parts.as_mut().subrows_mut(recent, all - recent);
        recent_parts += near;
        self.recent = all - width;
        for column in 0..width {
            self.projected.push(parts.col(column).iter().copied().collect());
        }
        let first = self.projected.len() - width;
        self.coupling = Vec::new();
        let products = self.products(&images)?;
        let each = images.chunks_exact_mut(size).zip(products.chunks_exact(size));
        for (column, (image, product)) in each.enumerate() {
            let norm = parts.col(column).norm_l2().hypot(length(image, product)?);
            let along = self.settle(image, product.to_vec(), norm, Some(first + column))?;
            for (row, part) in self.coupling.iter_mut().zip(&along.parts) {
                row[column] = *part;
            }
            if along.length.is_some() || self.add_random()? {
                let mut row = vec![0.0; width];
                row[column] = along.length.unwrap_or(0.0);
                self.coupling.push(row);
            }
        }
        Ok(())
    }

    /// Adds random vectors to the next block, as many as there is room for.
    pub(super) fn widen(&mut self, number: usize) -> Result<(), EigenError> {
        let width = self.coupling.first().map_or(0, Vec::len);
        for _ in 0..number {
            if self.add_random()? {
                self.coupling.push(vec![0.0; width]);
            }
        }
        Ok(())
    }

    /// Returns the width of the next block.
    pub(super) fn width(&self) -> usize {
        self.next.len()
    }

    fn add_random(&mut self) -> Result<bool, EigenError> {
        if self.len() + self.next.len() >= self.problem.size {
            return Ok(false);
        }
        // A random vector has something of every direction: a second one is hardly ever needed.
        for _ in 0..8 {
            let mut vector = zeros(self.problem.size)?;
            vector.fill_with(|| self.draw());
            let mut parts = self.take_away(&mut vector, 1, 0);
            parts += self.take_away(&mut vector, 1, 0);
            let product = self.products(&vector)?;
            let norm = parts.norm_l2().hypot(length(&vector, &product)?);
            if self.settle(&mut vector, product, norm, None)?.length.is_some() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Returns a number from −1 to 1 (xorshift).
    fn draw(&mut self) -> f64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn products(&self, columns: &[f64]) -> Result<Vec<f64>, EigenError> {
        let mut products = zeros(columns.len())?;
        self.mass.times(columns, &mut products);
        Ok(products)
    }

    /// Takes the parts along the vectors of the basis from the `first` one on away from some
    /// columns, and returns them.
    fn take_away(&self, columns: &mut [f64], width: usize, first: usize) -> Mat<f64> {
        let size = self.problem.size;
        let count = self.vectors.len() / size - first;
        let basis = MatRef::from_column_major_slice(&self.vectors[first * size..], size, count);
        let masses = MatRef::from_column_major_slice(&self.vectors_mass[first * size..], size, count);
        let mut columns = MatMut::from_column_major_slice_mut(columns, size, width);
        let mut parts = Mat::zeros(count, width);
        matmul(parts.as_mut(), Accum::Replace, masses.transpose(), columns.as_ref(), 1.0, Par::Seq);
        matmul(columns.as_mut(), Accum::Add, basis, parts.as_ref(), -1.0, Par::Seq);
        parts
    }

    /// Makes a vector orthogonal to the next block and adds it to that, if something is left of it.
    ///
    /// `product` is that with the mass. What is taken away along the basis is added to the
    /// projection of the `image`.
    fn settle(
        &mut self,
        vector: &mut [f64],
        mut product: Vec<f64>,
        norm: f64,
        image: Option<usize>,
    ) -> Result<Along, EigenError> {
        let mut parts = vec![0.0; self.next.len()];
        if self.len() + self.next.len() >= self.problem.size {
            return Ok(Along { parts, length: None });
        }
        let mut before = length(vector, &product)?;
        for _ in 0..6 {
            for ((part, other), others_mass) in parts.iter_mut().zip(&self.next).zip(&self.next_mass) {
                let along = dot(others_mass, vector);
                vector.iter_mut().zip(other).for_each(|(value, of_other)| *value -= along * of_other);
                product.iter_mut().zip(others_mass).for_each(|(value, of_other)| *value -= along * of_other);
                *part += along;
            }
            let left = length(vector, &product)?;
            if left <= ROUNDING * norm {
                return Ok(Along { parts, length: None });
            }
            if left > CANCELLED * before {
                vector.iter_mut().chain(&mut product).for_each(|value| *value /= left);
                self.next.push(vector.to_vec());
                self.next_mass.push(product);
                return Ok(Along { parts, length: Some(left) });
            }
            let taken = self.take_away(vector, 1, 0);
            if let Some(image) = image {
                self.projected[image].iter_mut().zip(taken.col(0).iter()).for_each(|(part, more)| *part += more);
            }
            product = self.products(vector)?;
            before = left;
        }
        Ok(Along { parts, length: None })
    }

    /// Solves the projected problem.
    pub(super) fn ritz(&self) -> Result<Ritz, EigenError> {
        let count = self.len();
        if count == 0 {
            // No vector has a positive mass.
            return Err(EigenError::NotPositive);
        }
        // An image has no part along vectors that came after the block that followed it.
        let part = |row: usize, column: usize| self.projected[column].get(row).copied();
        let operator = Mat::from_fn(count, count, |row, column| match (part(row, column), part(column, row)) {
            (Some(one), Some(other)) => 0.5 * (one + other),
            (one, other) => one.or(other).unwrap_or(0.0),
        });
        // The dense solver errs by an absolute amount where all entries are small, as with θ of
        // about 1e-10: the highest modes of a slender sheet hardly settled.
        let greatest = operator.norm_max();
        let scaled = Scale(if greatest > 0.0 { 1.0 / greatest } else { 1.0 }) * operator;
        let solved = scaled.self_adjoint_eigen(Side::Lower).map_err(|_| EigenError::NotPositive)?;
        let vectors = solved.U().to_owned();
        let width = self.coupling.first().map_or(0, Vec::len);
        let coupling = Mat::from_fn(self.coupling.len(), width, |row, column| self.coupling[row][column]);
        let left = &coupling * vectors.as_ref().subrows(count - width, width);
        let values = solved.S().column_vector().iter().rev().map(|value| value * greatest).collect();
        let residuals = (0..count).rev().map(|column| left.col(column).norm_l2()).collect();
        Ok(Ritz { values, residuals, vectors })
    }

    /// Returns the first `number` eigenvectors.
    pub(super) fn vectors(&self, ritz: &Ritz, number: usize) -> Vec<Vec<f64>> {
        let (size, count) = (self.problem.size, self.len());
        let basis = MatRef::from_column_major_slice(&self.vectors, size, count);
        let shapes = basis * ritz.vectors.as_ref().subcols(count - number, number);
        (0..number).rev().map(|column| shapes.col(column).iter().copied().collect()).collect()
    }
}

/// Parts of a vector along those of its block before it, and what length is left if any.
struct Along {
    parts: Vec<f64>,
    length: Option<f64>,
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    // Four sums at once: the order of a single one would forbid that.
    let ((ones, one_rest), (others, other_rest)) = (one.as_chunks::<4>(), other.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (one, other) in ones.iter().zip(others) {
        (0..4).for_each(|lane| sums[lane] += one[lane] * other[lane]);
    }
    let rest: f64 = one_rest.iter().zip(other_rest).map(|(one, other)| one * other).sum();
    sums.iter().sum::<f64>() + rest
}

/// Returns the M-norm of a vector from it and its product with the mass.
fn length(vector: &[f64], product: &[f64]) -> Result<f64, EigenError> {
    let square = dot(vector, product);
    if square.is_finite() { Ok(square.max(0.0).sqrt()) } else { Err(EigenError::NotPositive) }
}
