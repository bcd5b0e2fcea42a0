//! Rendering by `dsp-core`, the instrument that a board runs.

use std::mem;

use dsp_core::SampleRate;
use dsp_core::engine::{Direct, Engine, LoadError, Plan, Setup, TickReport};
use dsp_core::event::{Event, EventError};
use dsp_core::memory::{Memory, Word};
use dsp_core::room::Sample;
use dsp_core::table::Kit;
use dsp_core::time::TICK_FRAMES;
use dsp_core::voice::Form;

use super::performance::Performance;

/// Maximum number of samples of delay in the reverberation: as many as its bands can use.
///
/// A reverberation with a longer T60 than its delay keeps its decay, with fewer resonances.
pub const ROOM_SAMPLES: usize = Setup::new(SampleRate::HZ_48000).room_samples;

/// Type of a sample in the delay lines of the PC's reverberation.
///
/// 32 bits keep 95 dB of its sound, the boards' 16 bits 49.8 dB (docs/room.md).
type RoomSample = i32;

/// Reason for which a performance cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The engine cannot hold the kit.
    #[error("the kit does not fit the engine: {0}")]
    Load(#[from] LoadError),
    /// An event is out of range or out of order.
    #[error("{0}")]
    Event(#[from] EventError),
}

/// Settings of a rendering.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Sample rate, skipping of modes that cannot be heard, and stages beside the kit's.
    pub setup: Setup,
    /// Frames per block, 1 or more; every number gives the same bits.
    pub block: usize,
    /// Cycles of a Cortex-M4 that a tick may take; modes that do not fit are left out. `None` means
    /// no limit.
    pub budget_cycles: Option<u32>,
}

/// Format of the rendered samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Signed 24-bit samples.
    Samples24,
    /// Bus samples, Q4.27.
    Bus,
}

/// Plans the memory that the instrument takes for a kit at a sample rate.
///
/// # Errors
/// [`LoadError`] with the first part of the kit that the instrument refuses.
pub fn plan(kit: &Kit<'_>, rate: SampleRate) -> Result<Plan, LoadError> {
    Plan::of::<RoomSample>(kit, Setup::new(rate))
}

/// Forms in which the instrument plays a kit's pads at a sample rate.
///
/// # Errors
/// [`LoadError`] with the first part of the kit that the instrument refuses.
pub fn forms(kit: &Kit<'_>, rate: SampleRate) -> Result<Vec<Form>, LoadError> {
    let setup = Setup::new(rate);
    let words = Plan::of::<RoomSample>(kit, setup)?.words;
    let (mut fast, mut bulk) = (vec![Word::uninit(); words.fast], vec![Word::uninit(); words.bulk]);
    let engine = Engine::<RoomSample>::new(kit, setup, Memory::new(&mut fast, &mut bulk))?;
    Ok((0..engine.pad_count()).filter_map(|pad| engine.form(pad)).collect())
}

/// Renders a performance; `observe` gets the report of each tick.
///
/// # Errors
/// [`RenderError`] if the engine refuses the kit or an event.
pub fn render(
    kit: &Kit<'_>,
    performance: &Performance,
    settings: Settings,
    output: Output,
    observe: impl FnMut(&TickReport),
) -> Result<Vec<[i32; 2]>, RenderError> {
    render_logged(kit, performance, settings, output, observe, |_| {})
}

/// Renders a performance as [`render`] does, and logs the events as they are played.
///
/// `log` gets every event and, between them, the engine's own decisions to leave modes out. Played
/// in that order, they give the same bits without a budget.
///
/// # Errors
/// [`RenderError`] if the engine refuses the kit or an event.
pub fn render_logged(
    kit: &Kit<'_>,
    performance: &Performance,
    settings: Settings,
    output: Output,
    observe: impl FnMut(&TickReport),
    log: impl FnMut(&Event),
) -> Result<Vec<[i32; 2]>, RenderError> {
    let setup = settings.setup;
    let words = Plan::of::<RoomSample>(kit, setup)?.words;
    let (mut fast, mut bulk) = (vec![Word::uninit(); words.fast], vec![Word::uninit(); words.bulk]);
    let mut engine = Engine::<RoomSample>::new(kit, setup, Memory::new(&mut fast, &mut bulk))?;
    engine.set_budget(settings.budget_cycles);
    play(&mut engine, performance, settings.block, output, observe, log)
}

/// Plays a performance on an engine that holds a kit, in blocks of `block` frames.
///
/// With a budget and blocks of a tick, [`Engine::postpone`] moves strikes as on a board. `log` gets
/// each event with the time at which it happens.
///
/// # Errors
/// [`RenderError::Event`].
pub fn play<S: Sample>(
    engine: &mut Engine<'_, '_, S>,
    performance: &Performance,
    block: usize,
    output: Output,
    mut observe: impl FnMut(&TickReport),
    mut log: impl FnMut(&Event),
) -> Result<Vec<[i32; 2]>, RenderError> {
    let (mut frames, mut length) = (Vec::new(), performance.frames);
    let mut events = performance.events.as_slice();
    let mut postponed = Vec::new();
    let mut silence = Vec::new();
    while frames.len() < length {
        let begin = frames.len();
        frames.resize(length.min(begin + block.max(1)), [0; 2]);
        let Some(block) = frames.get_mut(begin..) else { break };
        let start = engine.now();
        let end = start + block.len() as u64;
        let due = events.iter().take_while(|event: &&Event| event.time.first_frame() < end).count();
        let (due, later) = events.split_at(due);
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
        let mut now = mem::take(&mut postponed);
        now.extend_from_slice(due);
        if block.len() == TICK_FRAMES {
            let last = |events: &[Event]| events.last().map_or(0, |event| event.time.first_frame());
            let asked = last(&now);
            engine.postpone(&mut now, direct);
            // The playback of the log has the same length: its last event is that much later.
            length += if events.is_empty() { (last(&now) - asked) as usize } else { 0 };
            let split = now.iter().take_while(|event| event.time.first_frame() < end).count();
            postponed = now.split_off(split);
        }
        let mut decisions = Vec::new();
        match output {
            Output::Samples24 => {
                engine.render_logged(&now, direct, block, &mut observe, |decision| decisions.push(*decision))?;
            }
            Output::Bus => {
                engine.render_bus_logged(&now, direct, block, &mut observe, |decision| decisions.push(*decision))?;
            }
        }
        // The engine decides behind the events of a frame, so that the log has its decision there.
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
