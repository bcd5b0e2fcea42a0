//! Rendering with the very engine of a board: what it leaves out, and its room, which is smaller than the PC's.

use boards::{BlackpillF411, BoardEngine, Stages, Stm32f407gDisc1};
use dsp_core::SampleRate;
use dsp_core::engine::{LoadError, TickReport};
use dsp_core::event::Event;
use dsp_core::table::Kit;
use virtual_board::Board;

use super::Performance;
use super::instrument::{Output, RenderError, play};

/// A board's sample rate.
pub fn rate(board: Board) -> SampleRate {
    match board {
        Board::Stm32f407gDisc1 => <Stm32f407gDisc1 as boards::Board>::rate(),
        Board::BlackpillF411 => <BlackpillF411 as boards::Board>::rate(),
    }
}

/// Why a board leaves stages of a kit out, in the order in which it would load them.
///
/// # Errors
/// [`LoadError`]: the board refuses the kit.
pub fn leaves_out(board: Board, kit: &Kit<'_>) -> Result<Vec<LoadError>, LoadError> {
    let mut left_out = Vec::new();
    let tell = |error| left_out.push(error);
    match board {
        Board::Stm32f407gDisc1 => drop(loaded::<Stm32f407gDisc1>(kit, tell)?),
        Board::BlackpillF411 => drop(loaded::<BlackpillF411>(kit, tell)?),
    }
    Ok(left_out)
}

/// What a board plays for a performance at its own rate: for the events of its log, the same bits. `log` sees every event as it is played.
///
/// # Errors
/// [`RenderError`].
pub fn render(
    board: Board,
    kit: &Kit<'_>,
    performance: &Performance,
    block: usize,
    observe: impl FnMut(&TickReport),
    log: impl FnMut(&Event),
) -> Result<Vec<[i32; 2]>, RenderError> {
    let output = Output::Samples24;
    match board {
        Board::Stm32f407gDisc1 => {
            play(&mut *loaded::<Stm32f407gDisc1>(kit, |_| {})?, performance, block, output, observe, log)
        }
        Board::BlackpillF411 => {
            play(&mut *loaded::<BlackpillF411>(kit, |_| {})?, performance, block, output, observe, log)
        }
    }
}

/// On the heap: some 170 KB.
type Loaded<'k, B> = Box<BoardEngine<'k, Stages<B>>>;

fn loaded<'k, B: boards::Board>(kit: &Kit<'k>, tell: impl FnMut(LoadError)) -> Result<Loaded<'k, B>, LoadError> {
    let mut engine = Box::new(BoardEngine::<Stages<B>>::new());
    B::load(&mut engine, kit, tell)?;
    Ok(engine)
}
