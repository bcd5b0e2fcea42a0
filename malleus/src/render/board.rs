//! Rendering with the engine of a board, which leaves stages out that the PC's engine plays.
//!
//! Its reverberation, too, has less memory than the PC's.

use boards::{BlackpillF411, Stm32f407gDisc1};
use dsp_core::SampleRate;
use dsp_core::built::Built;
use dsp_core::engine::{Engine, LoadError, Setup, TickReport};
use dsp_core::event::Event;
use dsp_core::memory::{Memory, Word, Words};
use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::Kit;
use dsp_core::voice::Form;
use virtual_board::Board;

use super::instrument::{Output, RenderError, play};
use super::performance::Performance;

/// Sample rate of a board.
pub fn rate(board: Board) -> SampleRate {
    match board {
        Board::Stm32f407gDisc1 => <Stm32f407gDisc1 as boards::Board>::rate(),
        Board::BlackpillF411 => <BlackpillF411 as boards::Board>::rate(),
    }
}

/// Plan of a kit on a board.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardPlan {
    /// Words of memory that the board lends its engine.
    pub lent: Words,
    /// Words of memory that the engine takes.
    pub taken: Words,
    /// Cycles per tick that pads and stages may take together.
    pub stage_cycles: u32,
    /// Cycles per tick that are left of them for stages that strikes begin.
    pub stage_cycles_left: u32,
    /// Reasons for which stages are left out, in the order in which the board would load them.
    pub left_out: Vec<LoadError>,
}

/// Plans a kit on a board.
///
/// # Errors
/// [`LoadError`] if the board refuses the kit as a whole.
pub fn plan(board: Board, kit: &Kit<'_>) -> Result<BoardPlan, LoadError> {
    match board {
        Board::Stm32f407gDisc1 => plan_of::<Stm32f407gDisc1>(kit),
        Board::BlackpillF411 => plan_of::<BlackpillF411>(kit),
    }
}

fn plan_of<B: boards::Board>(kit: &Kit<'_>) -> Result<BoardPlan, LoadError> {
    let mut left_out = Vec::new();
    let plan = B::plan(kit, &mut |error| left_out.push(error))?;
    Ok(BoardPlan {
        lent: B::WORDS,
        taken: plan.words,
        stage_cycles: B::STAGE_CYCLES,
        stage_cycles_left: plan.stage_cycles_left.unwrap_or(B::STAGE_CYCLES),
        left_out,
    })
}

/// Budget of a board's engine: predicted cycles that a tick of 32 frames may take at most.
pub fn budget_cycles(board: Board) -> u32 {
    match board {
        Board::Stm32f407gDisc1 => <Stm32f407gDisc1 as boards::Board>::BUDGET_CYCLES,
        Board::BlackpillF411 => <BlackpillF411 as boards::Board>::BUDGET_CYCLES,
    }
}

/// Renders a performance as a board plays it: at the board's rate and in blocks of one tick.
///
/// With the board's [budget](budget_cycles), events give the bits that the board gives for them.
/// Without a budget, the events of the board's log, which hold its decisions, give the bits that
/// the board gave. `observe` gets the report of each tick, and `log` every event as it is played.
///
/// The boards' own firmware is built without scraping and rolling, which nothing on them would
/// lead. A performance with motions plays as on a firmware with them.
///
/// # Errors
/// [`RenderError`] if the board refuses the kit or an event.
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
            let mut memory = lent::<Stm32f407gDisc1>();
            let mut engine = built_for::<Stm32f407gDisc1>(kit, performance, &mut memory)?;
            engine.set_budget(budget_cycles);
            play(&mut engine, performance, TICK_FRAMES, output, observe, log)
        }
        Board::BlackpillF411 => {
            let mut memory = lent::<BlackpillF411>();
            let mut engine = built_for::<BlackpillF411>(kit, performance, &mut memory)?;
            engine.set_budget(budget_cycles);
            play(&mut engine, performance, TICK_FRAMES, output, observe, log)
        }
    }
}

/// Modes and stages that a board with its budget leaves out of a chord.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Shed {
    /// For each pad, the number of modes that are left out and the number of modes that it has.
    pub modes: Vec<(usize, usize)>,
    /// Number of residuals, dynamic filters and biquad banks that the budget does not allow to
    /// start.
    pub refused_stages: u32,
    /// Form in which each pad's object is played.
    pub forms: Vec<Form>,
}

/// Modes and stages that a board with its budget leaves out of a kit's loudest
/// [chord](Performance::chord).
///
/// # Errors
/// [`RenderError`] if the board refuses the kit.
pub fn shed_of_chord(board: Board, kit: &Kit<'_>) -> Result<Shed, RenderError> {
    match board {
        Board::Stm32f407gDisc1 => shed_by::<Stm32f407gDisc1>(kit),
        Board::BlackpillF411 => shed_by::<BlackpillF411>(kit),
    }
}

fn shed_by<B: boards::Board>(kit: &Kit<'_>) -> Result<Shed, RenderError> {
    let mut memory = lent::<B>();
    let mut engine = loaded::<B>(kit, &mut memory)?;
    engine.set_budget(Some(B::BUDGET_CYCLES));
    let chord = Performance::chord(kit.pads().len(), (CHORD_S * B::rate().hz()) as usize);
    let mut shed = Shed::default();
    let observe = |report: &TickReport| shed.refused_stages += report.refused_stages;
    play(&mut engine, &chord, TICK_FRAMES, Output::Bus, observe, |_| {})?;
    shed.forms = (0..engine.pad_count()).filter_map(|pad| engine.form(pad)).collect();
    shed.modes = (0..engine.pad_count()).map(|pad| (engine.shed_mode_count(pad), engine.mode_count(pad))).collect();
    Ok(shed)
}

/// Length of the chord that is rendered to find what a board leaves out, in seconds.
///
/// Contacts are over by then. Modes that still ring take less time from tick to tick.
const CHORD_S: f64 = 0.5;

/// Memory as a board lends it: fast and large.
fn lent<B: boards::Board>() -> [Vec<Word>; 2] {
    [B::WORDS.fast, B::WORDS.bulk].map(|words| vec![Word::uninit(); words])
}

fn loaded<'k, 'm, B: boards::Board>(
    kit: &Kit<'k>,
    [fast, bulk]: &'m mut [Vec<Word>; 2],
) -> Result<Engine<'k, 'm>, LoadError> {
    B::engine(kit, Memory::new(fast, bulk), &mut |_| {})
}

/// Engine for a performance: with scraping and rolling if there are motions.
fn built_for<'k, 'm, B: boards::Board>(
    kit: &Kit<'k>,
    performance: &Performance,
    memory: &'m mut [Vec<Word>; 2],
) -> Result<Engine<'k, 'm>, LoadError> {
    if !performance.events.iter().any(Event::is_motion) {
        return loaded::<B>(kit, memory);
    }
    let setup = Setup { built: Built { scrapes: true, ..B::BUILT }, ..B::setup() };
    let [fast, bulk] = memory;
    Engine::new_within(kit, setup, Memory::new(fast, bulk), B::STAGE_CYCLES, &mut |_| {})
}
