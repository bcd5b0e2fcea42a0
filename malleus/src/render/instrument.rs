//! Rendering by dsp-core, exactly as a board does.

use dsp_core::SampleRate;
use dsp_core::engine::{
    Direct, Engine, Filters, LoadError, Residuals, STANDARD_CONTACTS, Skipping, Surroundings, TickReport,
};
use dsp_core::event::{Event, EventError};
use dsp_core::room::Room;
use dsp_core::table::Kit;
use dsp_core::table::range::{BREAKPOINTS, CHAIN_DEPTH, CHAINS, LOOPS};

use super::Performance;

/// Samples of delay of the room.
pub const ROOM_SAMPLES: usize = 49_152;

/// Noise of 32 pads; a second of delay for the room: a longer T60 than that keeps its decay, with fewer resonances; filters of 32 pads with all that a
/// table may hold, but for loops' delays: 8192 frames.
type PcSurroundings = (Residuals<32>, Room<i32, ROOM_SAMPLES>, Filters<32, BREAKPOINTS, LOOPS, 8192, BIQUADS>);

const BIQUADS: usize = CHAINS * CHAIN_DEPTH;

/// The engine of the PC: room for large kits; as many contacts at once as a board has.
pub type PcEngine<'k> = Engine<'k, 64, 320, 8192, 4096, 8192, STANDARD_CONTACTS, PcSurroundings>;

/// Why a performance cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The engine cannot hold the kit.
    #[error("the kit does not fit the engine: {0}")]
    Load(#[from] LoadError),
    /// An event cannot be.
    #[error("{0}")]
    Event(#[from] EventError),
}

/// How to render.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Sample rate.
    pub rate: SampleRate,
    /// Frames a block; any number of 1 and more gives the same bits.
    pub block: usize,
    /// What is left out.
    pub skipping: Skipping,
    /// Cycles of a Cortex-M4 that a tick may take; what does not fit is left out.
    pub budget_cycles: Option<u32>,
}

/// What comes out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Signed 24-bit samples.
    Samples24,
    /// Bus samples, Q4.27.
    Bus,
}

/// An engine without a kit, on the heap.
///
/// It is made on a stack of its own: it is larger than that of a usual thread.
pub fn engine<'k>() -> Box<PcEngine<'k>> {
    let made = std::thread::scope(|scope| {
        let large = std::thread::Builder::new().stack_size(4 * size_of::<PcEngine<'_>>() + (1 << 20));
        large.spawn_scoped(scope, make).ok()?.join().ok()
    });
    made.unwrap_or_else(make)
}

#[inline(never)] // its stack must not be its caller's
fn make<'k>() -> Box<PcEngine<'k>> {
    Box::new(PcEngine::new())
}

/// Whether the instrument can hold a kit at a rate.
///
/// # Errors
/// [`LoadError`].
pub fn check(kit: &Kit<'_>, rate: SampleRate) -> Result<(), LoadError> {
    engine().load(kit, rate, Skipping::On)
}

/// Renders a performance; `observe` sees each tick's report.
///
/// # Errors
/// [`RenderError`].
pub fn render(
    kit: &Kit<'_>,
    performance: &Performance,
    settings: Settings,
    output: Output,
    observe: impl FnMut(&TickReport),
) -> Result<Vec<[i32; 2]>, RenderError> {
    render_logged(kit, performance, settings, output, observe, |_| {})
}

/// The same; `log` sees every event as it is played, the engine's own decisions to leave something out among them, in the order in which
/// they play to the same bits.
///
/// # Errors
/// [`RenderError`].
pub fn render_logged(
    kit: &Kit<'_>,
    performance: &Performance,
    settings: Settings,
    output: Output,
    observe: impl FnMut(&TickReport),
    log: impl FnMut(&Event),
) -> Result<Vec<[i32; 2]>, RenderError> {
    let mut engine = engine();
    engine.load(kit, settings.rate, settings.skipping)?;
    engine.set_budget(settings.budget_cycles);
    play(&mut *engine, performance, settings.block, output, observe, log)
}

/// Plays a performance on an engine with a kit, in blocks of `block` frames.
///
/// # Errors
/// [`RenderError::Event`].
pub fn play<
    const PADS: usize,
    const BANKS: usize,
    const MODES: usize,
    const GROUPS: usize,
    const ORIGINS: usize,
    const CONTACTS: usize,
    S: Surroundings,
>(
    engine: &mut Engine<'_, PADS, BANKS, MODES, GROUPS, ORIGINS, CONTACTS, S>,
    performance: &Performance,
    block: usize,
    output: Output,
    mut observe: impl FnMut(&TickReport),
    mut log: impl FnMut(&Event),
) -> Result<Vec<[i32; 2]>, RenderError> {
    let mut frames = vec![[0; 2]; performance.frames];
    let mut events = performance.events.as_slice();
    let mut silence = Vec::new();
    for block in frames.chunks_mut(block.max(1)) {
        let start = engine.now();
        let end = start + block.len() as u64;
        let due = events.iter().take_while(|event: &&Event| event.time.first_frame() < end).count();
        let (now, later) = events.split_at(due);
        events = later;
        let direct = performance.direct.as_ref().map(|(pad, force)| {
            let from = (start as usize).min(force.len());
            let rest = &force[from..];
            let force = match rest.get(..block.len()) {
                Some(force) => force,
                None => {
                    silence.clear();
                    silence.extend_from_slice(rest);
                    silence.resize(block.len(), 0);
                    &silence
                }
            };
            Direct { pad: *pad, force }
        });
        let mut decisions = Vec::new();
        match output {
            Output::Samples24 => {
                engine.render_logged(now, direct, block, &mut observe, |decision| decisions.push(*decision))?;
            }
            Output::Bus => {
                engine.render_bus_logged(now, direct, block, &mut observe, |decision| decisions.push(*decision))?;
            }
        }
        // A decision stands behind the events of its frame.
        let mut now = now.iter().peekable();
        for decision in &decisions {
            while let Some(event) = now.next_if(|event| event.time.first_frame() <= decision.time.frame) {
                log(event);
            }
            log(decision);
        }
        now.for_each(&mut log);
    }
    Ok(frames)
}
