//! Events that a board's log tells, and their rendering by `malleus play`.

use dsp_core::SampleRate;
use dsp_core::engine::{Setup, TickReport};
use dsp_core::event::{Action, Event};
use dsp_core::table::Kit;
use malleus::events::csv;
use malleus::render::instrument::{Output, Settings, render};
use malleus::render::{Performance, board};
use virtual_board::{Board, VirtualBoard};

/// Returns the exact sample rate of a board.
pub(crate) fn rate(board: Board) -> SampleRate {
    match board {
        Board::Stm32f407gDisc1 => SampleRate::new(86_000_000, 1792).unwrap(),
        Board::BlackpillF411 => SampleRate::HZ_48000,
    }
}

/// Returns the events that the log tells, read as an events file.
pub(crate) fn events(running: &VirtualBoard, kit: &Kit<'_>, rate: SampleRate) -> Vec<Event> {
    let mut file = String::from("sample,pad,velocity,position,striker,action\n");
    for line in running.report().unwrap().log {
        if let Some(event) = line.message.strip_prefix("event ") {
            file += event;
            file.push('\n');
        }
    }
    csv::parse(file.as_bytes(), kit, rate).unwrap().events
}

/// Returns the frames that left the I2S in its only stream, and those that `malleus play` renders
/// for the events of the log, both as samples of 24 bits.
///
/// Both begin with their first sound, since the stream begins before the engine does.
pub(crate) fn heard_and_rendered(running: &VirtualBoard, board: Board, kit: &[u8]) -> [Vec<[i32; 2]>; 2] {
    let (kit, rate) = (Kit::parse(kit).unwrap(), rate(board));
    let heard = heard(running);
    let performance = Performance { events: events(running, &kit, rate), direct: None, frames: heard.len() };
    let settings = Settings { setup: Setup::new(rate), block: 32, budget_cycles: None };
    let rendered = render(&kit, &performance, settings, Output::Samples24, |_| {}).unwrap();
    [heard, rendered].map(from_first_sound)
}

/// Returns the frames that left the I2S and those that `malleus play --board` renders for the
/// events of the log, from their first sound on, with the work of the rendering.
///
/// The work is the number of frames of residuals, dynamic filters, loops, biquads and the room, and
/// the number of stages that were refused.
pub(crate) fn heard_and_rendered_as_board(
    running: &VirtualBoard,
    board: Board,
    kit: &[u8],
) -> ([Vec<[i32; 2]>; 2], [u32; 6]) {
    let (kit, rate, heard) = (Kit::parse(kit).unwrap(), rate(board), heard(running));
    let performance = Performance { events: events(running, &kit, rate), direct: None, frames: heard.len() };
    let mut work = [0; 6];
    let observe = |tick: &TickReport| {
        let frames = [tick.residual_frames, tick.filter_frames, tick.loop_frames, tick.biquad_frames, tick.room_frames];
        work.iter_mut().zip(frames).for_each(|(sum, frames)| *sum += frames);
        work[5] += tick.refused_stages;
    };
    // The log holds the decisions of the board's budget, so the rendering has no budget.
    let rendered = board::render(board, &kit, &performance, None, Output::Samples24, observe, |_| {}).unwrap();
    ([heard, rendered].map(from_first_sound), work)
}

/// Returns the frames that left the I2S, and those that `malleus play --board` renders within the
/// board's budget for the strikes of the log alone, from their first sound on.
///
/// The played events come with them: those of the board's log, and the decisions of the PC.
pub(crate) fn heard_and_decided_as_board(
    running: &VirtualBoard,
    board: Board,
    kit: &[u8],
) -> ([Vec<[i32; 2]>; 2], [Vec<Event>; 2]) {
    let (kit, rate, heard) = (Kit::parse(kit).unwrap(), rate(board), heard(running));
    let told = events(running, &kit, rate);
    let strikes = told.iter().filter(|event| event.action == Action::Strike).copied().collect();
    let performance = Performance { events: strikes, direct: None, frames: heard.len() };
    let (budget, mut decided) = (Some(board::budget_cycles(board)), Vec::new());
    let log = |event: &Event| decided.push(*event);
    let rendered = board::render(board, &kit, &performance, budget, Output::Samples24, |_| {}, log).unwrap();
    ([heard, rendered].map(from_first_sound), [told, decided])
}

/// Returns the frames that left the I2S in its only stream, as samples of 24 bits.
fn heard(running: &VirtualBoard) -> Vec<[i32; 2]> {
    let streams = running.streams();
    let [stream] = streams.as_slice() else {
        let log: Vec<String> = running.report().unwrap().log.into_iter().map(|line| line.message).collect();
        panic!("{} streams; the log: {log:#?}", streams.len())
    };
    assert_eq!((stream.underruns, stream.unconnected_frames), (0, 0));
    assert!(stream.frames.iter().flatten().all(|slot| slot & 0xFF == 0), "24 bits at the top of 32");
    stream.frames.iter().map(|frame| frame.map(|slot| slot >> 8)).collect()
}

/// Returns the frames from the first one on that is not silent.
fn from_first_sound(frames: Vec<[i32; 2]>) -> Vec<[i32; 2]> {
    let first = frames.iter().position(|frame| *frame != [0; 2]).expect("no sound");
    frames[first..].to_vec()
}
