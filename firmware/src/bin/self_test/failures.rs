//! Count of the checks that failed.

/// Number of checks that failed.
#[derive(Default)]
pub(crate) struct Failures(u32);

impl Failures {
    /// Counts a check and returns the word that ends its line.
    pub(crate) fn check(&mut self, is_good: bool) -> &'static str {
        self.0 += u32::from(!is_good);
        if is_good { "good" } else { "WRONG" }
    }

    /// Returns the number of checks that failed.
    pub(crate) fn count(&self) -> u32 {
        self.0
    }
}
