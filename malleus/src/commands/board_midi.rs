//! MIDI of `malleus board run`: what a USB host sends to the board, and what the board sends.

use std::path::{Path, PathBuf};

use kit::counting::counted;
use malleus::events::usb_midi::{self, Packet};
use malleus::events::{EventsError, EventsFault};
use virtual_board::{UsbAction, UsbHost, UsbReport};

use super::board_inputs::read;
use super::error::CommandError;

/// Arguments that concern MIDI.
pub(super) struct MidiArguments<'a> {
    /// Song for the board.
    pub(super) song: Option<&'a Path>,
    /// SysEx for the board.
    pub(super) sysex: Option<&'a Path>,
    /// File for what the board sends.
    pub(super) output: Option<&'a Path>,
    /// Start of the song and the SysEx, in seconds from power-on.
    pub(super) start_s: f64,
}

/// Returns the host that sends song and SysEx. Its cable is plugged in at power-on, if there is
/// anything to send or to write.
///
/// # Errors
/// [`CommandError`] if a file cannot be read, or is no MIDI file.
pub(super) fn host(arguments: &MidiArguments<'_>) -> Result<UsbHost, CommandError> {
    let mut actions = Vec::new();
    let mut send = |at_s: f64, packets: &[Packet]| {
        actions.push((at_s, UsbAction::Send(packets.as_flattened().to_vec())));
    };
    if let Some(path) = arguments.sysex {
        send(arguments.start_s, &usb_midi::sysex(&read(path)?));
    }
    if let Some(path) = arguments.song {
        let in_file = |fault: EventsFault| EventsError { path: PathBuf::from(path), fault };
        let messages = usb_midi::packets(&read(path)?).map_err(in_file)?;
        // Messages of one time share transfers.
        for chord in messages.chunk_by(|a, b| a.0 == b.0) {
            let packets: Vec<Packet> = chord.iter().flat_map(|message| message.1.iter().copied()).collect();
            send(arguments.start_s + chord[0].0, &packets);
        }
    }
    if !actions.is_empty() || arguments.output.is_some() {
        actions.insert(0, (0.0, UsbAction::Plug));
    }
    Ok(UsbHost { actions, ..UsbHost::default() })
}

/// Writes what the board sent, if a file is asked for.
///
/// Times count from the start of the song and the SysEx, and what came before is left out. Without
/// both they count from power-on.
///
/// # Errors
/// [`CommandError`] if the file cannot be written.
pub(super) fn write(arguments: &MidiArguments<'_>, report: &UsbReport) -> Result<(), CommandError> {
    let Some(path) = arguments.output else { return Ok(()) };
    let begins_s = if arguments.song.or(arguments.sysex).is_some() { arguments.start_s } else { 0.0 };
    let mut packets = Vec::new();
    for transfer in report.received.iter().filter(|transfer| transfer.ended_s >= begins_s) {
        let at_s = transfer.ended_s - begins_s;
        packets.extend(transfer.bytes.as_chunks().0.iter().map(|&packet| (at_s, packet)));
    }
    Ok(kit::file::write_whole(path, &usb_midi::song(&packets)?)?)
}

/// Returns a warning if the board did not get all that the host had to send.
pub(super) fn undelivered(report: &UsbReport) -> Option<String> {
    if report.unsent == 0 {
        return None;
    }
    let lost = counted(report.unsent, "transfers");
    Some(match report.configured_s.first() {
        None => format!(
            "warning: the board never got {lost} of --midi and --sysex, because the USB host could not configure it; give more --seconds, or look into the log"
        ),
        Some(at_s) => format!(
            "warning: the board never got {lost} of --midi and --sysex: the USB host configured it at {at_s:.3} s, and what is sent before that is lost; give a later --midi-start, or more --seconds"
        ),
    })
}
