//! A candidate of the descent: filters, modes and loops.

use crate::dynamic_filter::guide::Guide;
use crate::dynamic_filter::lattice::Lattice;
use crate::modes::DampedSine;

/// Filters over time, modes and loops whose band levels are compared with the law.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    /// Filters at all times of [`times_s`](crate::dynamic_filter::times::times_s).
    pub(crate) filters: Vec<Lattice>,
    /// Modes beside the filter.
    pub(crate) modes: Vec<DampedSine>,
    /// Loops round the filter.
    pub(crate) guides: Vec<Guide>,
    /// Index of the time after which there is no noise and the filter stands still; `None` for
    /// never.
    pub(crate) end: Option<usize>,
}

impl Candidate {
    /// Ends the noise and stops the filter after the time with index `end`.
    pub(crate) fn freeze_after(&mut self, end: Option<usize>) {
        self.end = end;
        let last = end.and_then(|end| self.filters.get(end)).cloned();
        if let (Some(end), Some(last)) = (end, last) {
            self.filters.iter_mut().skip(end + 1).for_each(|filter| filter.clone_from(&last));
        }
    }
}
