//! Factors of K − σ M: for solves if it is positive, for its inertia if it is not.

use super::{EigenError, Problem};
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// Relative steps by which a limit is moved off an eigenvalue on which it lies.
const STEPS: [f64; 4] = [0.0, 1e-12, 1e-10, 1e-8];

/// Takes the factors by supernodes always: faer's constant for it leaves out those without fill.
const SUPERNODAL: SupernodalThreshold = SupernodalThreshold(-1.0);

/// Largest number of entries of a factor: with it, the matrices and the vectors take about 1.7 GB,
/// as there is one factor at a time.
pub(super) const MOST_ENTRIES: usize = 75_000_000;

/// Order of elimination and pattern of the factors of a problem.
pub(super) struct Plan<'a> {
    problem: &'a Problem,
    symbolic: SymbolicCholesky<usize>,
}

/// Cholesky factor of K − σ M.
pub(super) struct Cholesky<'a> {
    symbolic: &'a SymbolicCholesky<usize>,
    values: Vec<f64>,
    scratch: MemBuffer,
}

/// Allocates zeros, or says that there is no memory for them.
pub(super) fn zeros<T: Clone + Default>(count: usize) -> Result<Vec<T>, EigenError> {
    let mut values = Vec::new();
    values.try_reserve_exact(count).map_err(|_| EigenError::Memory)?;
    values.resize(count, T::default());
    Ok(values)
}

fn memory(request: StackReq) -> Result<MemBuffer, EigenError> {
    MemBuffer::try_new(request).map_err(|_| EigenError::Memory)
}

impl<'a> Plan<'a> {
    /// Plans the factors of a problem whose pattern is sound.
    pub(super) fn new(problem: &'a Problem) -> Result<Self, EigenError> {
        let params = CholeskySymbolicParams { supernodal_flop_ratio_threshold: SUPERNODAL, ..Default::default() };
        // `SymmetricOrdering::Identity` of this version takes the lower triangle for the upper one.
        let kept: Vec<usize> = (0..problem.size).collect();
        let order = if problem.is_ordered {
            SymmetricOrdering::Custom(PermRef::new_checked(&kept, &kept, problem.size))
        } else {
            SymmetricOrdering::Amd
        };
        let symbolic = factorize_symbolic_cholesky(pattern(problem), Side::Lower, order, params)
            .map_err(|_| EigenError::Memory)?;
        if symbolic.len_val() > MOST_ENTRIES {
            return Err(EigenError::TooLarge { unknowns: problem.size, entries: symbolic.len_val() });
        }
        Ok(Self { problem, symbolic })
    }

    /// Returns the problem.
    pub(super) fn problem(&self) -> &'a Problem {
        self.problem
    }

    fn shifted(&self, shift: f64) -> Result<Vec<f64>, EigenError> {
        let mut values = zeros(self.problem.rows.len())?;
        for ((value, stiffness), mass) in values.iter_mut().zip(&self.problem.stiffness).zip(&self.problem.mass) {
            *value = stiffness - shift * mass;
        }
        Ok(values)
    }

    /// Factors K − `shift` M, which has to be positive definite.
    pub(super) fn cholesky(&self, shift: f64) -> Result<Cholesky<'_>, EigenError> {
        self.positive(&self.shifted(shift)?)
    }

    fn positive(&self, entries: &[f64]) -> Result<Cholesky<'_>, EigenError> {
        let symbolic = &self.symbolic;
        let mut values = zeros(symbolic.len_val())?;
        let mut scratch = memory(symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()))?;
        let matrix = SparseColMatRef::new(pattern(self.problem), entries);
        symbolic
            .factorize_numeric_llt(
                &mut values,
                matrix,
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut scratch),
                Default::default(),
            )
            .map_err(|_| EigenError::NotPositive)?;
        let scratch = memory(symbolic.solve_in_place_scratch::<f64>(super::search::WIDEST, Par::Seq))?;
        Ok(Cholesky { symbolic, values, scratch })
    }

    /// Counts the eigenvalues below a limit: as many as K − `limit` M has negative ones.
    pub(super) fn count_below(&self, limit: f64) -> Result<usize, EigenError> {
        for step in STEPS {
            if let Some(count) = self.negative(limit + step * limit.abs())? {
                return Ok(count);
            }
        }
        Err(EigenError::NotPositive)
    }

    /// Counts the negative eigenvalues of K − `shift` M; `None` if it is singular.
    fn negative(&self, shift: f64) -> Result<Option<usize>, EigenError> {
        let (symbolic, size) = (&self.symbolic, self.problem.size);
        let SymbolicCholeskyRaw::Supernodal(nodes) = symbolic.raw() else { return Err(EigenError::Memory) };
        let entries = self.shifted(shift)?;
        let mut values = zeros(symbolic.len_val())?;
        let mut below = zeros(size)?;
        let (mut forward, mut inverse) = (zeros(size)?, zeros(size)?);
        let request = symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, Default::default());
        let mut scratch = memory(request)?;
        symbolic.factorize_numeric_intranode_lblt(
            &mut values,
            &mut below,
            &mut forward,
            &mut inverse,
            SparseColMatRef::new(pattern(self.problem), &entries),
            Side::Lower,
            Par::Seq,
            MemStack::new(&mut scratch),
            Default::default(),
        );
        Ok(negative_pivots(nodes, &values, &below))
    }
}

impl Cholesky<'_> {
    /// Solves for all columns of a right-hand side, at most `WIDEST` of them.
    pub(super) fn solve(&mut self, columns: MatMut<'_, f64>) {
        let stack = MemStack::new(&mut self.scratch);
        LltRef::new(self.symbolic, &self.values).solve_in_place_with_conj(Conj::No, columns, Par::Seq, stack);
    }
}

/// Counts the negative eigenvalues of the pivots, each of one row or, where there is an entry
/// `below` the diagonal, of two; `None` if one is zero or not finite.
fn negative_pivots(nodes: &SymbolicSupernodalCholesky<usize>, values: &[f64], below: &[f64]) -> Option<usize> {
    let mut count = 0;
    for node in 0..nodes.n_supernodes() {
        let (begin, end) = (nodes.supernode_begin()[node], nodes.supernode_end()[node]);
        let block = &values[nodes.col_ptr_for_val()[node]..nodes.col_ptr_for_val()[node + 1]];
        let width = end - begin;
        let height = block.len() / width;
        let mut at = 0;
        while at < width {
            let (first, beside) = (block[at * height + at], below[begin + at]);
            if beside == 0.0 {
                if first == 0.0 || !first.is_finite() {
                    return None;
                }
                count += usize::from(first < 0.0);
                at += 1;
            } else {
                let second = block[(at + 1) * height + at + 1];
                let determinant = first * second - beside * beside;
                let trace = first + second;
                if determinant == 0.0 || !determinant.is_finite() {
                    return None;
                }
                count += if determinant < 0.0 { 1 } else { 2 * usize::from(trace < 0.0) };
                at += 2;
            }
        }
    }
    Some(count)
}

fn pattern(problem: &Problem) -> SymbolicSparseColMatRef<'_, usize> {
    SymbolicSparseColMatRef::new_checked(problem.size, problem.size, &problem.starts, None, &problem.rows)
}
