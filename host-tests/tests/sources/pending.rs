//! Crates whose sources are still to be mended, rule by rule.
//!
//! Take a crate off a list once the test says that nothing is left to mend in it. No crate may be
//! put on.

use crate::files::Source;

/// Crates with doc lines that begin with a forbidden word.
pub(crate) const FIRST_WORDS: &[&str] =
    &["dsp-core", "host-tests", "host-tests/images/engine", "host-tests/images/kernels", "host-tests/images/trigger"];
/// Crates with comment lines above 100 columns.
pub(crate) const COLUMNS: &[&str] = &[
    "dsp-core",
    "host-tests",
    "host-tests/images/biquads",
    "host-tests/images/engine",
    "host-tests/images/filters",
    "host-tests/images/kernels",
    "host-tests/images/residual",
    "host-tests/images/trigger",
];
/// Crates with files above 400 lines.
pub(crate) const FILE_LINES: &[&str] = &["dsp-core", "host-tests"];
/// Crates that switch the lint of many arguments off.
pub(crate) const ARGUMENTS: &[&str] = &[];
/// Crates with names of tests above 80 characters.
pub(crate) const TEST_NAMES: &[&str] = &["host-tests"];
/// Crates with circles of imports.
pub(crate) const CIRCLES: &[&str] = &["dsp-core"];

/// A place that breaks a rule: the crate, and what a reader is told.
pub(crate) struct Fault {
    pub(crate) krate: String,
    pub(crate) message: String,
}

impl Fault {
    /// A fault in a line of a file, counted from 1.
    pub(crate) fn at(source: &Source, line: usize, what: &str) -> Self {
        Self { krate: source.krate.clone(), message: format!("{}:{line}: {what}", source.path) }
    }
}

/// Prints the number of faults in crates that are still to be mended, and fails with the faults of
/// all others.
pub(crate) fn check(rule: &str, pending: &[&str], faults: &[Fault]) {
    for &krate in pending {
        match faults.iter().filter(|fault| fault.krate == krate).count() {
            0 => println!("{rule}: nothing is left to mend in {krate}: take it off the list in sources/pending.rs"),
            count => println!("{rule}: {count} places still to be mended in {krate}"),
        }
    }
    let broken: Vec<_> = faults.iter().filter(|fault| !pending.contains(&fault.krate.as_str())).collect();
    for fault in faults.iter().filter(|_| std::env::var_os("ALL_FAULTS").is_some()) {
        println!("{}", fault.message);
    }
    let messages: Vec<_> = broken.iter().map(|fault| fault.message.as_str()).collect();
    assert!(messages.is_empty(), "{rule}: {} places\n{}", messages.len(), messages.join("\n"));
}
