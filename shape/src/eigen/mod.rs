//! Modes of a sparse symmetric problem K φ = λ M φ, λ = ω².
//!
//! Lanczos steps by blocks with the inverse of K − σ M, σ a little below zero: the lowest modes
//! come first, those of a free body (λ about 0) before all. A random start of a few vectors can
//! miss some modes of a multiplet. The number of negative pivots of K − μ M says how many modes
//! there are below μ: as long as it is higher than the number found, new random vectors join in.

mod factor;
mod lanczos;
mod mass;
mod search;

use factor::Plan;
use kit::counting::counted;
use thiserror::Error;

/// Symmetric matrices of stiffness and mass with one pattern: the lower triangle by columns, rows
/// of each column in order, the diagonal first.
#[derive(Clone, Debug, Default)]
pub struct Problem {
    /// Number of unknowns.
    pub size: usize,
    /// Begin of each column in `rows`, and the end of the last one: `size + 1` numbers.
    pub starts: Vec<usize>,
    /// Row of each entry.
    pub rows: Vec<usize>,
    /// True if factors in the order of the unknowns have little fill; false leaves their order to
    /// minimum degrees (AMD).
    pub is_ordered: bool,
    /// Entries of the stiffness K; positive semidefinite.
    pub stiffness: Vec<f64>,
    /// Entries of the mass M; positive semidefinite, and K positive definite where M is zero.
    pub mass: Vec<f64>,
}

/// Choice of modes to find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wanted {
    /// Number of modes, the lowest ones, rigid ones included.
    Lowest(usize),
    /// Highest λ = ω², (rad/s)²; values within 1e-10 of it, relatively, belong to the modes.
    Below(f64),
}

/// Modes of a problem.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Modes {
    /// Values λ = ω², (rad/s)², ascending. Those of rigid modes are about 0, and can be negative.
    pub values: Vec<f64>,
    /// Shapes φ of the modes, with φᵀ M φ = 1.
    pub vectors: Vec<Vec<f64>>,
    /// Number of eigenvalues below `count_limit`, by the inertia of K − `count_limit` M. All of
    /// them were found, and those that were asked for are returned.
    pub counted: usize,
    /// Limit of the count, (rad/s)²: in a gap above the last mode.
    pub count_limit: f64,
    /// Value of the mode above the last of those that were asked for, (rad/s)²: right to a
    /// twentieth of its distance from that one. `None` if there is none.
    pub next: Option<f64>,
}

/// Reason for which there are no modes.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EigenError {
    /// Fewer unknowns than modes asked for, or none.
    #[error("{} asked for, and the body has {}", counted(*wanted, "modes"), counted(*size, "unknowns"))]
    TooFew {
        /// Number of unknowns.
        size: usize,
        /// Number of modes asked for.
        wanted: usize,
    },
    /// A mass or a stiffness with a negative eigenvalue, or motions with neither.
    #[error("the mass or the stiffness has a negative eigenvalue, or some motion has neither")]
    NotPositive,
    /// Modes that the search did not find though the inertia counts them.
    #[error("only {found} of {counted} modes found")]
    Missed {
        /// Number of modes found.
        found: usize,
        /// Number of modes that there are.
        counted: usize,
    },
    /// A pattern that is not a lower triangle by columns, or entries that are not finite.
    #[error("the matrices are not lower triangles by columns with finite entries")]
    Malformed,
    /// Factors with which all would take near 2 GB or more.
    #[error(
        "{unknowns} unknowns have factors of {entries} entries, and at most {most} are solved; ask for a larger --error or fewer modes",
        most = factor::MOST_ENTRIES
    )]
    TooLarge {
        /// Number of unknowns.
        unknowns: usize,
        /// Number of entries of a factor.
        entries: usize,
    },
    /// Too little memory for the factors or the vectors.
    #[error("too little memory for this number of unknowns")]
    Memory,
}

/// Finds modes of a problem, the lowest ones first, and verifies by inertia that none is missing.
///
/// `lowest` is an optional estimate of λ, in (rad/s)², of the lowest mode that is not a rigid
/// motion. If it lies between 0.01 and 4 times the true λ, the search needs one factorisation and
/// about twelve solves fewer. The modes are the same with any estimate.
///
/// # Errors
/// An [`EigenError`] for too few unknowns, unsound matrices, modes that are not found, or too
/// little memory.
pub fn modes(problem: &Problem, wanted: Wanted, lowest: Option<f64>) -> Result<Modes, EigenError> {
    problem.check()?;
    if let Wanted::Lowest(number) = wanted
        && number > problem.size
    {
        return Err(EigenError::TooFew { size: problem.size, wanted: number });
    }
    let plan = Plan::new(problem)?;
    match wanted {
        Wanted::Lowest(number) => search::lowest(&plan, number, f64::INFINITY, lowest),
        Wanted::Below(limit) => {
            let number = plan.count_below(limit + search::GAP * limit.abs())?;
            search::lowest(&plan, number, limit + 1e-10 * limit.abs(), lowest)
        }
    }
}

/// Counts the eigenvalues λ below `limit`, (rad/s)², by the inertia of K − `limit` M.
pub fn count_below(problem: &Problem, limit: f64) -> Result<usize, EigenError> {
    problem.check()?;
    let plan = Plan::new(problem)?;
    plan.count_below(limit)
}

impl Problem {
    /// Checks the pattern, and that the entries are finite.
    fn check(&self) -> Result<(), EigenError> {
        if self.size == 0 {
            return Err(EigenError::TooFew { size: 0, wanted: 1 });
        }
        let entries = self.rows.len();
        let columns_sound = self.starts.len() == self.size + 1
            && self.starts.first() == Some(&0)
            && self.starts.last() == Some(&entries)
            && self.starts.is_sorted()
            && self.stiffness.len() == entries
            && self.mass.len() == entries;
        let sound = columns_sound
            && self.starts.windows(2).enumerate().all(|(column, ends)| {
                let rows = &self.rows[ends[0]..ends[1]];
                rows.first() == Some(&column)
                    && rows.last().is_some_and(|&last| last < self.size)
                    && rows.windows(2).all(|pair| pair[0] < pair[1])
            })
            && self.stiffness.iter().chain(&self.mass).all(|entry| entry.is_finite());
        if sound { Ok(()) } else { Err(EigenError::Malformed) }
    }

    /// Returns the ratio of the sums of stiffness and mass on the diagonal, (rad/s)²: a scale of
    /// high eigenvalues. The highest of all tells less: motions of nearly no mass, as those of a
    /// cell that the body hardly touches, have any.
    fn scale(&self) -> f64 {
        let sum = |entries: &[f64]| self.starts[..self.size].iter().map(|&at| entries[at]).sum::<f64>();
        sum(&self.stiffness) / sum(&self.mass)
    }

    /// Returns φᵀ K φ.
    fn energy(&self, vector: &[f64]) -> f64 {
        let mut energy = 0.0;
        for (column, ends) in self.starts.windows(2).enumerate() {
            let (rows, entries) = (&self.rows[ends[0]..ends[1]], &self.stiffness[ends[0]..ends[1]]);
            let beside: f64 = rows[1..].iter().zip(&entries[1..]).map(|(&row, entry)| entry * vector[row]).sum();
            energy += vector[column] * (entries[0] * vector[column] + 2.0 * beside);
        }
        energy
    }
}
