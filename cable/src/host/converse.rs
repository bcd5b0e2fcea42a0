//! The loop of a program that waits for its link.

use super::{Exchange, HostError, Task, Turn};
use crate::wire::Message;

/// Cable to a board.
pub trait Link {
    /// Failure of the cable.
    type Error: From<HostError>;

    /// Sends a message.
    ///
    /// # Errors
    /// [`Error`](Self::Error) if the cable is gone.
    fn send(&mut self, message: &[u8]) -> Result<(), Self::Error>;

    /// Gives the next byte from the board, or `None` if none comes before a time.
    ///
    /// # Errors
    /// [`Error`](Self::Error) if the cable is gone.
    fn receive(&mut self, until_ms: u64) -> Result<Option<u8>, Self::Error>;

    /// Time of the link's clock in milliseconds, which never goes back.
    fn now_ms(&mut self) -> u64;
}

/// Carries out a task over a link; `observe` is called after each answer.
///
/// # Errors
/// A [`HostError`] if the board refuses or does not answer, and the link's own errors.
pub fn converse<L: Link, T: Task>(
    link: &mut L,
    exchange: &mut Exchange,
    task: &mut T,
    mut observe: impl FnMut(&T),
) -> Result<(), L::Error> {
    let mut message = Message::new();
    let mut turn = Turn::Ask;
    let mut until_ms = 0;
    while turn != Turn::Done {
        if turn == Turn::Ask {
            exchange.ask(task, &mut message);
            link.send(message.bytes())?;
        }
        if turn != Turn::Listen {
            observe(task);
            until_ms = link.now_ms() + u64::from(exchange.wait_ms());
        }
        turn = match link.receive(until_ms)? {
            Some(byte) => exchange.receive(byte, task)?,
            // A stream of other bytes must not hide that the time is over.
            None => exchange.timed_out()?,
        };
        if turn == Turn::Listen && link.now_ms() >= until_ms {
            turn = exchange.timed_out()?;
        }
    }
    Ok(())
}
