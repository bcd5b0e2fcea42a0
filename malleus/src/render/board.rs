//! Rendering with the very engine of a board: what it leaves out, and its room, which is smaller than the PC's.

use boards::{BlackpillF411, BoardEngine, Stages, Stm32f407gDisc1};
use dsp_core::SampleRate;
use dsp_core::engine::{LoadError, TickReport};
use dsp_core::event::Event;
use dsp_core::resonator::TICK_FRAMES;
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

/// The budget of a board's engine: cycles that a tick may take, as the engine predicts them.
pub fn budget_cycles(board: Board) -> u32 {
    match board {
        Board::Stm32f407gDisc1 => <Stm32f407gDisc1 as boards::Board>::BUDGET_CYCLES,
        Board::BlackpillF411 => <BlackpillF411 as boards::Board>::BUDGET_CYCLES,
    }
}

/// What a board plays for a performance at its own rate, in blocks of a tick as the board has them.
/// With the board's [budget](budget_cycles) the same bits for the same events; without one, the
/// same bits for the events of the board's log, which hold its decisions. `log` sees every event as
/// it is played.
///
/// # Errors
/// [`RenderError`].
pub fn render(
    board: Board,
    kit: &Kit<'_>,
    performance: &Performance,
    budget_cycles: Option<u32>,
    output: Output,
    observe: impl FnMut(&TickReport),
    log: impl FnMut(&Event),
) -> Result<Vec<[i32; 2]>, RenderError> {
    match board {
        Board::Stm32f407gDisc1 => {
            let mut engine = loaded::<Stm32f407gDisc1>(kit, |_| {})?;
            engine.set_budget(budget_cycles);
            play(&mut *engine, performance, TICK_FRAMES, output, observe, log)
        }
        Board::BlackpillF411 => {
            let mut engine = loaded::<BlackpillF411>(kit, |_| {})?;
            engine.set_budget(budget_cycles);
            play(&mut *engine, performance, TICK_FRAMES, output, observe, log)
        }
    }
}

/// What a board with its budget leaves out of a chord.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Shed {
    /// Number of modes of each pad that are left out, and number of modes that the pad has.
    pub modes: Vec<(usize, usize)>,
    /// Number of residuals, dynamic filters and biquad banks that find no time.
    pub refused_stages: u32,
}

/// What a board with its budget leaves out of a kit's loudest [chord](Performance::chord).
///
/// # Errors
/// [`RenderError`].
pub fn shed_of_chord(board: Board, kit: &Kit<'_>) -> Result<Shed, RenderError> {
    match board {
        Board::Stm32f407gDisc1 => shed_by::<Stm32f407gDisc1>(kit),
        Board::BlackpillF411 => shed_by::<BlackpillF411>(kit),
    }
}

fn shed_by<B: boards::Board>(kit: &Kit<'_>) -> Result<Shed, RenderError> {
    let mut engine = loaded::<B>(kit, |_| {})?;
    engine.set_budget(Some(B::BUDGET_CYCLES));
    let chord = Performance::chord(kit.pads().len(), (CHORD_S * B::rate().hz()) as usize);
    let mut shed = Shed::default();
    let observe = |report: &TickReport| shed.refused_stages += report.refused_stages;
    play(&mut *engine, &chord, TICK_FRAMES, Output::Bus, observe, |_| {})?;
    shed.modes = (0..engine.pad_count()).map(|pad| (engine.shed_mode_count(pad), engine.mode_count(pad))).collect();
    Ok(shed)
}

/// Seconds of a chord in which a board is watched: its contacts are over by then, and what rings on
/// takes less time from tick to tick.
const CHORD_S: f64 = 0.5;

/// On the heap: some 170 KB.
type Loaded<'k, B> = Box<BoardEngine<'k, Stages<B>>>;

fn loaded<'k, B: boards::Board>(kit: &Kit<'k>, tell: impl FnMut(LoadError)) -> Result<Loaded<'k, B>, LoadError> {
    let mut engine = Box::new(BoardEngine::<Stages<B>>::new());
    B::load(&mut engine, kit, tell)?;
    Ok(engine)
}
