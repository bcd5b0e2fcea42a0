//! Motions from lines, one after the other: contacts begin and end.

use super::error::MotionFault;
use super::path::{Action, Contact, Knot, Motion, smooth};
use super::speed::too_fast;

/// Least time between two lines in seconds. Within less, the speed of a resting tool would be lost
/// in the rounding of its place.
const LEAST_STEP_S: f64 = 1e-9;

/// Action of the tool at a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// Touches a pad, or goes on touching it, here.
    Touch(Action, [f64; 2]),
    /// Lifts off here; without a place, somewhere behind the line before.
    Lift(Option<[f64; 2]>),
}

/// One line of a motion. All its numbers are finite.
pub(super) struct Line<'a> {
    /// Line of the file, counted from 1.
    pub(super) line: u64,
    pub(super) time_s: f64,
    /// Number of the pad, counted from 0, and its name.
    pub(super) pad: (u8, &'a str),
    /// Number of the striker; `None` for the contact's own, which is the pad's first at the touch.
    pub(super) striker: Option<u8>,
    pub(super) step: Step,
    /// Normal force in newtons, 0 or more; `None` if it follows from the motion.
    pub(super) normal_n: Option<f64>,
}

/// Contact that is not yet lifted.
struct Open {
    pad: u8,
    name: String,
    striker: u8,
    action: Action,
    /// Lines of the file, one for each knot.
    lines: Vec<u64>,
}

/// Takes lines in order of time, and makes a motion of them.
#[derive(Default)]
pub(super) struct Builder {
    motion: Parts,
    open: Option<Open>,
    /// Pads that have been touched.
    touched: Vec<u8>,
    before_s: Option<f64>,
}

/// Contacts and knots of the motion so far.
#[derive(Default)]
struct Parts {
    contacts: Vec<Contact>,
    knots: Vec<Knot>,
}

impl Builder {
    /// Adds a line.
    ///
    /// # Errors
    /// The [`MotionFault`] of the line, or of the contact that it ends.
    pub(super) fn add(&mut self, line: &Line<'_>) -> Result<(), MotionFault> {
        if let Some(before_s) = self.before_s
            && line.time_s - before_s < LEAST_STEP_S
        {
            return Err(MotionFault::OutOfOrder { line: line.line, time_s: line.time_s, before_s });
        }
        self.before_s = Some(line.time_s);
        match line.step {
            Step::Touch(action, position_m) => {
                self.touch(line, action)?;
                self.place(line, position_m);
                Ok(())
            }
            Step::Lift(position_m) => {
                self.check_lift(line)?;
                if let Some(position_m) = position_m {
                    self.place(line, position_m);
                }
                self.close()
            }
        }
    }

    /// Ends the motion. A contact that is not lifted ends at its last line, with a remark.
    ///
    /// # Errors
    /// The [`MotionFault`] of the last contact, and [`MotionFault::NoContact`].
    pub(super) fn finish(mut self) -> Result<Motion, MotionFault> {
        let mut remarks = Vec::new();
        if let Some(open) = &self.open {
            let end_s = self.before_s.unwrap_or(0.0);
            remarks.push(format!("pad {} is not lifted; its contact ends at the last line, {end_s} s", open.name));
            self.close()?;
        }
        let Parts { contacts, knots } = self.motion;
        if contacts.is_empty() { Err(MotionFault::NoContact) } else { Ok(Motion { contacts, knots, remarks }) }
    }

    /// Begins a contact, or checks that the line goes on with the one that is open.
    fn touch(&mut self, line: &Line<'_>, action: Action) -> Result<(), MotionFault> {
        let (pad, name) = line.pad;
        let fault_pad = || name.to_owned();
        match &self.open {
            None => {
                if !self.touched.contains(&pad) {
                    self.touched.push(pad);
                }
                let striker = line.striker.unwrap_or(0);
                self.open = Some(Open { pad, name: name.to_owned(), striker, action, lines: Vec::new() });
                Ok(())
            }
            Some(open) if open.pad != pad => {
                Err(MotionFault::TwoPads { line: line.line, pad: fault_pad(), touched: open.name.clone() })
            }
            Some(open) if open.action != action => Err(MotionFault::ActionChanged {
                line: line.line,
                pad: fault_pad(),
                before: open.action,
                after: action,
            }),
            Some(open) => self.check_striker(line, open),
        }
    }

    fn check_lift(&self, line: &Line<'_>) -> Result<(), MotionFault> {
        let (pad, name) = line.pad;
        match &self.open {
            Some(open) if open.pad == pad => self.check_striker(line, open),
            _ if self.touched.contains(&pad) => {
                Err(MotionFault::LiftAfterLift { line: line.line, pad: name.to_owned() })
            }
            _ => Err(MotionFault::LiftBeforeTouch { line: line.line, pad: name.to_owned() }),
        }
    }

    fn check_striker(&self, line: &Line<'_>, open: &Open) -> Result<(), MotionFault> {
        match line.striker {
            Some(striker) if striker != open.striker => {
                Err(MotionFault::StrikerChanged { line: line.line, pad: open.name.clone() })
            }
            _ => Ok(()),
        }
    }

    /// Adds a place of the open contact.
    fn place(&mut self, line: &Line<'_>, position_m: [f64; 2]) {
        if let Some(open) = &mut self.open {
            open.lines.push(line.line);
            self.motion.knots.push(Knot {
                contact: self.motion.contacts.len(),
                time_s: line.time_s,
                position_m,
                velocity_m_per_s: [0.0; 2],
                acceleration_m_per_s2: [0.0; 2],
                normal_n: line.normal_n,
            });
        }
    }

    /// Ends the open contact: its path is made, and its speed checked.
    fn close(&mut self) -> Result<(), MotionFault> {
        let Some(open) = self.open.take() else { return Ok(()) };
        let Parts { contacts, knots } = &mut self.motion;
        let begin = knots.len() - open.lines.len();
        let [first, .., last] = &knots[begin..] else {
            let line = open.lines.first().copied().unwrap_or(0);
            return Err(MotionFault::SingleLine { line, pad: open.name });
        };
        contacts.push(Contact {
            pad: open.pad,
            striker: open.striker,
            action: open.action,
            touch_s: first.time_s,
            lift_s: last.time_s,
            knots: begin..knots.len(),
        });
        smooth(&mut knots[begin..]);
        for (pair, &line) in knots[begin..].windows(2).zip(&open.lines[1..]) {
            if let Some((time_s, speed_m_per_s)) = too_fast(&pair[0], &pair[1]) {
                return Err(MotionFault::TooFast { line, time_s, speed_m_per_s });
            }
        }
        Ok(())
    }
}
