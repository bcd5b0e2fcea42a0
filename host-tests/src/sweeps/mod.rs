//! Sweeps over many seeds, tables and strikes. The tests run a tenth of each, the bench `nightly`
//! runs all.
//!
//! A sweep prints its figures, and panics if a limit is broken. Limits do not depend on the extent.

pub mod dynamic_filter;
pub mod hands;
pub mod residual;
pub mod rolls;
pub mod room;
pub mod stability;

/// Part of a sweep that is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// About a tenth, for the tests.
    Tenth,
    /// All, for the bench `nightly`.
    Whole,
}

impl Extent {
    /// Picks a value by the extent.
    pub fn pick<T>(self, tenth: T, whole: T) -> T {
        match self {
            Extent::Tenth => tenth,
            Extent::Whole => whole,
        }
    }
}

/// Name of a sweep, and its function.
pub type Sweep = (&'static str, fn(Extent));

/// All sweeps, in the order in which `nightly` runs them.
pub const ALL: &[Sweep] = &[
    ("residual: energies of a hundred smooth bands", residual::energies),
    ("residual: energies beside bands that last longer", residual::energies_beside_longer_ones),
    ("residual: energies beside louder bands", residual::energies_beside_louder_ones),
    ("residual: decays beside others", residual::decays_beside_others),
    ("residual: decays of equal bands", residual::decays_of_equal_bands),
    ("residual: decays of a hundred bands", residual::decays_of_a_hundred_bands),
    ("residual: flatness of a band", residual::flatness),
    ("residual: energies of strikes on strikes", residual::strikes_add),
    ("residual: an hour of rolls", residual::rolls),
    ("dynamic filter: bands of a standing filter", dynamic_filter::standing_bands),
    ("dynamic filter: decays", dynamic_filter::decays),
    ("dynamic filter: lines at the tick rate", dynamic_filter::tick_lines),
    ("room: decays and energies of random tables", room::decays_and_energies),
    ("stability: resonance for 30 s", stability::resonance),
    ("stability: a thousand strikes a second for a minute", stability::strikes),
    ("stability: a thousand million mode samples", stability::drift),
    ("hands: every pad of every kit at every phase of a tick", hands::every_pad),
    ("rolls: an hour on every stage", rolls::hour),
];
