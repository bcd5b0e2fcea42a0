//! The USB-MIDI port of a board.

use std::collections::VecDeque;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use cable::Link;
use midir::{Ignore, MidiIO, MidiInput, MidiInputConnection, MidiOutput, MidiOutputConnection};

use crate::commands::error::CommandError;

/// Name of this program in the system's lists of MIDI clients.
const CLIENT: &str = "malleus";

/// Connection to a board.
pub(super) struct MidiLink {
    output: MidiOutputConnection,
    // The connection ends when this is dropped.
    _input: MidiInputConnection<()>,
    received: Receiver<Vec<u8>>,
    bytes: VecDeque<u8>,
    began: Instant,
}

/// Connects to the one port whose name contains `wanted`, in capitals or not.
///
/// # Errors
/// [`CommandError::Port`] if no port or several have such a name, [`CommandError::Midi`] if the
/// system does not connect.
pub(super) fn connect(wanted: &str) -> Result<MidiLink, CommandError> {
    let (no_midi, no_port) = ("the system's MIDI cannot be used", "the board's MIDI port cannot be opened");
    let mut input = MidiInput::new(CLIENT).map_err(|_| CommandError::Midi { what: no_midi })?;
    let output = MidiOutput::new(CLIENT).map_err(|_| CommandError::Midi { what: no_midi })?;
    input.ignore(Ignore::TimeAndActiveSense);
    let (from, to) = (find(&input, wanted)?, find(&output, wanted)?);
    let (sender, received) = mpsc::channel();
    // At the end of the program nobody receives any more.
    let receive = move |_, bytes: &[u8], (): &mut ()| drop(sender.send(bytes.to_vec()));
    let input = input.connect(&from, CLIENT, receive, ()).map_err(|_| CommandError::Midi { what: no_port })?;
    let output = output.connect(&to, CLIENT).map_err(|_| CommandError::Midi { what: no_port })?;
    Ok(MidiLink { output, _input: input, received, bytes: VecDeque::new(), began: Instant::now() })
}

fn find<I: MidiIO>(io: &I, wanted: &str) -> Result<I::Port, CommandError> {
    let named = io.ports().into_iter().filter_map(|port| io.port_name(&port).ok().map(|name| (port, name)));
    let (ports, names): (Vec<_>, Vec<_>) = named.unzip();
    let contains = |name: &String| name.to_lowercase().contains(&wanted.to_lowercase());
    let mut fitting = ports.into_iter().zip(&names).filter(|(_, name)| contains(name));
    match (fitting.next(), fitting.next()) {
        (Some((port, _)), None) => Ok(port),
        (first, _) => Err(CommandError::Port {
            problem: if first.is_none() { "no MIDI port" } else { "more than one MIDI port" },
            wanted: wanted.to_owned(),
            found: if names.is_empty() { "none".to_owned() } else { names.join(", ") },
        }),
    }
}

impl Link for MidiLink {
    type Error = CommandError;

    fn send(&mut self, message: &[u8]) -> Result<(), CommandError> {
        self.output.send(message).map_err(|_| CommandError::Midi { what: "the board's MIDI port takes no message" })
    }

    fn receive(&mut self, until_ms: u64) -> Result<Option<u8>, CommandError> {
        while self.bytes.is_empty() {
            let wait = Duration::from_millis(until_ms.saturating_sub(self.now_ms()));
            match self.received.recv_timeout(wait) {
                Ok(bytes) => self.bytes.extend(bytes),
                Err(RecvTimeoutError::Timeout) => return Ok(None),
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(CommandError::Midi { what: "the connection to the board ended" });
                }
            }
        }
        Ok(self.bytes.pop_front())
    }

    fn now_ms(&mut self) -> u64 {
        self.began.elapsed().as_millis() as u64
    }
}
