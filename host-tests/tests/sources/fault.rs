//! Places that break a rule.

use crate::files::Source;

/// Place that breaks a rule, as a message to the reader.
pub(crate) struct Fault {
    pub(crate) message: String,
}

impl Fault {
    /// Fault in a line of a file, counted from 1.
    pub(crate) fn at(source: &Source, line: usize, what: &str) -> Self {
        Self { message: format!("{}:{line}: {what}", source.path) }
    }
}

/// Fails with all faults, if there are any.
pub(crate) fn check(rule: &str, faults: &[Fault]) {
    let messages: Vec<_> = faults.iter().map(|fault| fault.message.as_str()).collect();
    assert!(messages.is_empty(), "{rule}: {} places\n{}", messages.len(), messages.join("\n"));
}
