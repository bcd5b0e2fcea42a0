//! Checks of a block's events and direct force.

use super::state::{Direct, Engine};
#[cfg(feature = "scrapes")]
use crate::event::Action;
use crate::event::{Event, EventError};
use crate::room::Sample;
#[cfg(feature = "scrapes")]
use crate::scrape::MotionError;
use crate::voice::Voice;

impl<S: Sample> Engine<'_, '_, S> {
    /// Refuses the first invalid event, or else a direct force that does not fit the block.
    pub(super) fn check(&self, events: &[Event], direct: Option<Direct<'_>>, frames: usize) -> Result<(), EventError> {
        let mut earliest = self.now;
        let end = self.now.saturating_add(frames as u64);
        let pads = self.pad_count();
        for (index, event) in events.iter().enumerate() {
            let frame = event.time.first_frame();
            let pad = self.voices.get(usize::from(event.pad));
            let strikers = pad.map_or(0, Voice::striker_count);
            if frame < earliest {
                return Err(EventError::OutOfOrder { index, frame, earliest });
            } else if frame >= end {
                return Err(EventError::BehindBlock { index, frame, end });
            } else if pad.is_none() {
                return Err(EventError::UnknownPad { index, pad: event.pad, pads });
            } else if usize::from(event.striker) >= strikers {
                return Err(EventError::UnknownStriker { index, striker: event.striker, strikers });
            } else if !(0.0..=1.0).contains(&event.velocity) {
                return Err(EventError::Velocity { index, value: event.velocity });
            } else if !(0.0..=1.0).contains(&event.position) {
                return Err(EventError::Position { index, value: event.position });
            }
            self.check_motion(index, event)?;
            earliest = frame;
        }
        match direct {
            Some(Direct { pad, force }) if usize::from(pad) >= pads || force.len() != frames => {
                Err(EventError::Direct { pad, frames: force.len(), block: frames })
            }
            _ => Ok(()),
        }
    }

    /// Lets all events pass: in this build none tells of a motion.
    #[cfg(not(feature = "scrapes"))]
    fn check_motion(&self, _: usize, _: &Event) -> Result<(), EventError> {
        Ok(())
    }

    /// Refuses a motion that is too fast or no number, and a touch where there is no surface.
    #[cfg(feature = "scrapes")]
    #[inline(always)] // most events are no motion
    fn check_motion(&self, index: usize, event: &Event) -> Result<(), EventError> {
        let Event { pad, striker, .. } = *event;
        match event.action {
            Action::Touch { rolls, normal_n } => {
                if normal_n.iter().any(|x| x.is_nan()) {
                    Err(EventError::Motion { index, error: MotionError::NormalForce })
                } else if !self.has_surface(pad, striker, rolls) {
                    Err(EventError::NoSurface { index, pad, striker, rolls })
                } else {
                    Ok(())
                }
            }
            Action::Move(motion) => motion.check().map_err(|error| EventError::Motion { index, error }),
            _ => Ok(()),
        }
    }
}
