//! Settings of the descent.

/// Number of modes and steps, and the starts of a descent.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Number of modes, 1 to 1025. Default 64.
    pub modes: usize,
    /// Number of steps of the best start, at least 1. Default 6000, as in the released notebook.
    pub steps: usize,
    /// Learning rate of each start, above 0. Default 0.001, 0.003, 0.01 and 0.03.
    ///
    /// The notebook has 0.001. The starts begin at different random numbers and take a tenth of
    /// the steps each; the one with the least loss takes the rest.
    pub rates: Vec<f64>,
    /// Seed of all random numbers. Default 1.
    pub seed: u64,
}

impl Settings {
    /// Number of steps of all starts together.
    pub fn all_steps(&self) -> usize {
        self.trial_steps() * self.rates.len() + self.steps.saturating_sub(self.trial_steps())
    }

    /// Number of steps of each start before one is chosen.
    pub(super) fn trial_steps(&self) -> usize {
        self.steps.div_ceil(10)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self { modes: 64, steps: 6_000, rates: vec![0.001, 0.003, 0.01, 0.03], seed: 1 }
    }
}
