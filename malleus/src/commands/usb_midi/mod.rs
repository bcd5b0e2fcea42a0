//! `malleus board` with a real board: kits and settings over the USB cable.

#[cfg(not(feature = "usb-midi"))]
mod no_port;
#[cfg(feature = "usb-midi")]
mod port;
mod settings;
#[cfg(test)]
mod tests;

use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

use cable::{Answer, Content, Download, Exchange, HostError, Identity, Link, Query, Request, Task, Upload, converse};
use clap::Args;
use dsp_core::table::Kit;
use kit::Loaded;
use virtual_board::Board;

use super::error::CommandError;
use super::kit_report::open;
use super::left_out::left_out;
use super::output::{print, progress};
#[cfg(not(feature = "usb-midi"))]
use no_port::connect;
#[cfg(feature = "usb-midi")]
use port::connect;
use settings::Change;

/// MIDI port of a board.
#[derive(Debug, Args)]
pub(crate) struct PortArguments {
    /// MIDI port of the board, by a part of its name
    #[arg(long, value_name = "NAME", default_value = "Malleus")]
    port: String,
}

/// Arguments of `malleus board send`.
#[derive(Debug, Args)]
pub(crate) struct SendArguments {
    /// Kit: a .toml or .bin file, or the name of a shipped kit
    kit: String,
    /// Slot of the board, counted from 0
    #[arg(long, value_name = "N", default_value_t = 0)]
    slot: u8,
    /// End an upload that another program began and left
    #[arg(long)]
    abandon: bool,
    #[command(flatten)]
    port: PortArguments,
}

/// Arguments of `malleus board read`.
#[derive(Debug, Args)]
pub(crate) struct ReadArguments {
    /// Slot of the board, counted from 0
    #[arg(long, value_name = "N", default_value_t = 0)]
    slot: u8,
    /// Binary kit to write
    #[arg(short, long, value_name = "KIT.bin")]
    output: PathBuf,
    #[command(flatten)]
    port: PortArguments,
}

/// Arguments of `malleus board erase`.
#[derive(Debug, Args)]
pub(crate) struct EraseArguments {
    /// Slot of the board, counted from 0
    #[arg(long, value_name = "N")]
    slot: u8,
    #[command(flatten)]
    port: PortArguments,
}

/// Arguments of `malleus board settings`.
#[derive(Debug, Args)]
pub(crate) struct SettingsArguments {
    /// Settings to change, such as threshold.0=0.01 curve.0=1.5 channel=10 level=-6 start-slot=1;
    /// without a value the kit's own holds again [default: show all]
    #[arg(value_name = "NAME=[VALUE]", value_parser = settings::parse)]
    changes: Vec<Change>,
    #[command(flatten)]
    port: PortArguments,
}

pub(super) fn send(arguments: &SendArguments) -> Result<(), CommandError> {
    let loaded = open(&arguments.kit)?;
    print(&send_over(&mut connect(&arguments.port.port)?, &loaded, arguments)?)
}

pub(super) fn info(arguments: &PortArguments) -> Result<(), CommandError> {
    print(&info_over(&mut connect(&arguments.port)?)?)
}

pub(super) fn read(arguments: &ReadArguments) -> Result<(), CommandError> {
    let kit = read_over(&mut connect(&arguments.port.port)?, arguments.slot)?;
    kit::file::write_whole(&arguments.output, &kit)?;
    print(&format!("{}: {} bytes\n", arguments.output.display(), kit.len()))
}

pub(super) fn erase(arguments: &EraseArguments) -> Result<(), CommandError> {
    ask(&mut connect(&arguments.port.port)?, Request::Erase { slot: arguments.slot })?;
    print(&format!("slot {} is empty\n", arguments.slot))
}

pub(super) fn settings(arguments: &SettingsArguments) -> Result<(), CommandError> {
    print(&settings::settings_over(&mut connect(&arguments.port.port)?, &arguments.changes)?)
}

pub(super) fn enter_dfu(arguments: &PortArguments) -> Result<(), CommandError> {
    ask(&mut connect(&arguments.port)?, Request::EnterDfu)?;
    print("the board waits for a firmware in its bootloader: flash it with dfu-util (docs/hardware.md)\n")
}

/// Exchange whose tags begin elsewhere than those of a program that was started at another time.
fn exchange() -> Exchange {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    Exchange::new((since.as_millis() & 0x7F) as u8)
}

/// Carries out a task under a progress bar.
fn carry_out<L: Link<Error = CommandError>, T: Task>(
    link: &mut L,
    task: &mut T,
    (bytes, what): (usize, &'static str),
    done: impl Fn(&T) -> usize,
) -> Result<(), CommandError> {
    let bar = progress(bytes as u64, what);
    let carried_out = converse(link, &mut exchange(), task, |task| bar.set_position(done(task) as u64));
    bar.finish_and_clear();
    carried_out
}

/// Answer of the board to one request.
fn ask(link: &mut impl Link<Error = CommandError>, request: Request<'_>) -> Result<Answer<'static>, CommandError> {
    let mut query = Query::new(request);
    converse(link, &mut exchange(), &mut query, |_| {})?;
    query.answer().ok_or(CommandError::Cable(HostError::BadAnswer))
}

fn identity(link: &mut impl Link<Error = CommandError>) -> Result<(Identity, u8, Option<u8>), CommandError> {
    match ask(link, Request::Identity)? {
        Answer::Identity { identity, slots, playing } => Ok((identity, slots, playing)),
        _ => Err(CommandError::Cable(HostError::BadAnswer)),
    }
}

fn send_over(
    link: &mut impl Link<Error = CommandError>,
    loaded: &Loaded,
    arguments: &SendArguments,
) -> Result<String, CommandError> {
    let (name, slot) = (&arguments.kit, arguments.slot);
    let (identity, _, _) = identity(link)?;
    // A board that this program does not know decides alone.
    if let Ok(board) = identity.board.as_str().parse::<Board>() {
        let table = Kit::parse(&loaded.binary).map_err(|error| CommandError::Table { kit: name.clone(), error })?;
        malleus::render::board::plan(board, &table).map_err(|error| CommandError::NotLoadable {
            kit: name.clone(),
            board: board.name(),
            error,
        })?;
        for line in left_out(name, board, &table) {
            eprintln!("malleus: {line}");
        }
    }
    if arguments.abandon {
        ask(link, Request::Abandon)?;
    }
    let mut upload = Upload::new(&loaded.binary, slot).map_err(CommandError::Cable)?;
    carry_out(link, &mut upload, (loaded.binary.len(), "sending"), Upload::written)?;
    ask(link, Request::Start { slot: Some(slot) })?;
    let bytes = loaded.binary.len();
    Ok(format!("{name}: {bytes} bytes in slot {slot} of {}, which plays it\n", identity.board))
}

fn info_over(link: &mut impl Link<Error = CommandError>) -> Result<String, CommandError> {
    let (identity, slots, playing) = identity(link)?;
    let Identity { firmware, revision, board, rate } = identity;
    let playing = playing.map_or("the built-in kit".to_owned(), |slot| format!("slot {slot}"));
    let mut text = format!("{board}: firmware {firmware} ({revision}), {rate}; {playing} plays\n");
    for slot in 0..slots {
        let Answer::Slot { capacity, content, left_out, .. } = ask(link, Request::Slot { slot })? else {
            return Err(CommandError::Cable(HostError::BadAnswer));
        };
        text += &match content {
            Content::Empty => format!("slot {slot}: empty, {capacity} bytes\n"),
            Content::Unfinished => format!("slot {slot}: an upload that was not ended; send it again\n"),
            Content::Kit { name, length, .. } => format!("slot {slot}: {name}, {length} of {capacity} bytes\n"),
            Content::Refused(refusal) => format!("slot {slot}: refused: {refusal}\n"),
        };
        text.extend(left_out.iter().map(|stage| format!("slot {slot} leaves out: {stage}\n")));
    }
    Ok(text)
}

fn read_over(link: &mut impl Link<Error = CommandError>, slot: u8) -> Result<Vec<u8>, CommandError> {
    let Answer::Slot { capacity, content, .. } = ask(link, Request::Slot { slot })? else {
        return Err(CommandError::Cable(HostError::BadAnswer));
    };
    let length = Download::length(slot, content).map_err(CommandError::Cable)?;
    if length > capacity as usize {
        return Err(CommandError::Cable(HostError::BadAnswer));
    }
    let mut kit = vec![0; length];
    carry_out(link, &mut Download::new(slot, &mut kit, 0), (length, "reading"), Download::read)?;
    Ok(kit)
}
