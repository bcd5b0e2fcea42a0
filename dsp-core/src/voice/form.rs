//! Form in which a pad's object is played.

/// Form in which the modes of a pad's object are played: in [frames](crate::frames), or in the
/// fixed-point bank for a reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// In frames.
    Frames,
    /// In the bank: for so few modes it takes fewer cycles.
    FewModes,
    /// In the bank: a dynamic filter takes the modes sample by sample.
    Filtered,
    /// In the bank: contacts move along the object as they scrape it, and frames keep a force's
    /// position over a block.
    Scraped,
    /// In the bank: its choke is too fast for frames.
    FastChoke,
    /// In the bank: a strike would take too many cycles in frames.
    TooDear,
    /// In the bank: there is no memory for frames.
    NoMemory,
}
