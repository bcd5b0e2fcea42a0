//! What a board's log says was played, and what `malleus play` makes of it.

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::{Action, Event};
use dsp_core::table::Kit;
use malleus::events::csv;
use malleus::render::Performance;
use malleus::render::instrument::{Output, Settings, render};
use virtual_board::{Board, VirtualBoard};

/// A board's true rate.
pub(crate) fn rate(board: Board) -> SampleRate {
    match board {
        Board::Stm32f407gDisc1 => SampleRate::new(86_000_000, 1792).unwrap(),
        Board::BlackpillF411 => SampleRate::HZ_48000,
    }
}

/// The events that the log tells, as an events file's.
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

pub(crate) fn strikes(events: &[Event]) -> usize {
    events.iter().filter(|event| event.action == Action::Strike).count()
}

/// What leaves the I2S against what `malleus play` renders for the log's events: the frames that were compared, all of which must be the
/// same. The stream begins before the engine does: both are laid over each other at their first sound.
pub(crate) fn assert_same_bits(running: &VirtualBoard, board: Board, kit: &[u8]) -> usize {
    let (kit, rate) = (Kit::parse(kit).unwrap(), rate(board));
    let streams = running.streams();
    let [stream] = streams.as_slice() else { panic!("{} streams", streams.len()) };
    assert_eq!((stream.underruns, stream.unconnected_frames), (0, 0));
    // The last ones may have been played before they were logged.
    let played: Vec<[i32; 2]> = stream.frames.iter().map(|frame| frame.map(|slot| slot >> 8)).collect();
    assert!(stream.frames.iter().flatten().all(|slot| slot & 0xFF == 0), "24 bits at the top of 32");
    let events = events(running, &kit, rate);
    let performance = Performance { events, direct: None, frames: played.len() };
    let settings = Settings { rate, block: 32, skipping: Skipping::On, budget_cycles: None };
    let expected = render(&kit, &performance, settings, Output::Samples24, |_| {}).unwrap();
    let first = |frames: &[[i32; 2]]| frames.iter().position(|frame| *frame != [0; 2]);
    let (Some(heard), Some(rendered)) = (first(&played), first(&expected)) else { panic!("silence") };
    let same = played[heard..].iter().zip(&expected[rendered..]).take_while(|(a, b)| a == b).count();
    let compared = played.len() - heard;
    // A strike whose line was still under way at the end is missing in the log.
    let margin = (0.01 * rate.hz()) as usize;
    assert!(same + margin >= compared, "{}: frame {same} of {compared} differs", board.name());
    same
}
