//! Lines of a trial: as a file, and as the motion that the file gives.

use crate::motion::builder::{Builder, Line, Step};
use crate::motion::csv::COLUMNS;
use crate::motion::error::MotionFault;
use crate::motion::path::{Action, Motion};

/// Lines of a trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub(super) action: Action,
    /// Times and places of each contact; the last one is the lift.
    pub(super) contacts: Vec<Vec<(f64, [f64; 2])>>,
}

impl Drawing {
    /// Number of contacts; at least one.
    pub fn contacts(&self) -> usize {
        self.contacts.len()
    }

    /// Number of lines behind the header.
    pub fn lines(&self) -> usize {
        self.contacts.iter().map(Vec::len).sum()
    }

    /// The file: CSV that [`crate::motion::csv::parse`] reads, for a pad and a striker by name.
    ///
    /// An empty striker is the pad's first one.
    pub fn csv(&self, pad: &str, striker: &str) -> String {
        let mut text = format!("{}\n", COLUMNS[1..].join(","));
        let (pad, striker) = (quoted(pad), quoted(striker));
        for contact in &self.contacts {
            for (index, (time_s, [x_m, y_m])) in contact.iter().enumerate() {
                let action = if index + 1 == contact.len() { "lift".to_owned() } else { self.action.to_string() };
                text += &format!("{time_s},{pad},{action},{striker},{x_m},{y_m},\n");
            }
        }
        text
    }

    /// The motion that reading the file gives, on pad 0 and by its first striker.
    ///
    /// # Errors
    /// [`MotionFault`] for a path that is too fast.
    pub fn motion(&self) -> Result<Motion, MotionFault> {
        let mut builder = Builder::default();
        // The first line behind the header is line 2.
        let mut line = 2;
        for contact in &self.contacts {
            for (index, &(time_s, place_m)) in contact.iter().enumerate() {
                let is_last = index + 1 == contact.len();
                let step = if is_last { Step::Lift(Some(place_m)) } else { Step::Touch(self.action, place_m) };
                builder.add(&Line { line, time_s, pad: (0, ""), striker: None, step, normal_n: None })?;
                line += 1;
            }
        }
        builder.finish()
    }
}

/// A field as it stands in CSV.
fn quoted(text: &str) -> String {
    let needs_quotes = text.contains([',', '"', '\n', '\r', '#']) || text.trim() != text;
    if needs_quotes { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
