//! Performances in parts, whose sounds add up.

use dsp_core::engine::{Setup, TickReport};
use dsp_core::event::{Action, Event};
use dsp_core::table::{Kit, TableError};

use super::instrument::{self, Output, RenderError, Settings};
use super::part::Part;
use super::performance::Performance;

/// Reason for which the parts of a performance cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum PartsError {
    /// The kit of a part cannot be built.
    #[error("a part of the kit cannot be played alone: {0}")]
    Build(Box<kit::KitError>),
    /// The table of a part is invalid.
    #[error("a part of the kit cannot be played alone: {0}")]
    Table(#[from] TableError),
    /// The engine refuses a part.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// Kits and performances whose sounds add up to a performance with parts.
///
/// Strikes by a striker's law are played on the kit itself; all other events act on every part.
pub fn scenes(kit: &kit::Kit, performance: &Performance, parts: &[Part]) -> Vec<(kit::Kit, Performance)> {
    let others: Vec<Event> =
        performance.events.iter().filter(|event| event.action != Action::Strike).copied().collect();
    let is_struck = others.len() < performance.events.len();
    let by_law = is_struck.then(|| (kit.clone(), Performance { direct: None, ..performance.clone() }));
    let of_part = |part: &Part| {
        let mut kit = part.kit.clone();
        // The kit itself sounds its background.
        kit.background = if is_struck { None } else { kit.background };
        let (events, direct) = (others.clone(), Some(part.direct.clone()));
        (kit, Performance { events, direct, frames: performance.frames })
    };
    by_law.into_iter().chain(parts.iter().map(of_part)).collect()
}

/// Renders scenes with the instrument and adds them up on the bus, Q4.27; `done` gets the number of
/// frames that are rendered, of all scenes together.
///
/// # Errors
/// [`PartsError`] if a kit cannot be played.
pub fn render(
    scenes: &[(kit::Kit, Performance)],
    setup: Setup,
    block: usize,
    done: impl Fn(u64),
) -> Result<Vec<[i32; 2]>, PartsError> {
    let mut bus = Vec::new();
    let mut before = 0;
    for (kit, performance) in scenes {
        bus.resize(performance.frames.max(bus.len()), [0i32; 2]);
        let binary = kit::binary::build(kit).map_err(|error| PartsError::Build(Box::new(error)))?;
        let table = Kit::parse(&binary)?;
        let settings = Settings { setup, block, budget_cycles: None };
        let observe = |report: &TickReport| done(before + report.frame);
        let sound = instrument::render_logged(&table, performance, settings, Output::Bus, observe, |_| {})?;
        let add = |sum: i32, x: i32| sum.saturating_add(x);
        bus.iter_mut().zip(sound).for_each(|(sum, x)| *sum = [add(sum[0], x[0]), add(sum[1], x[1])]);
        before += performance.frames as u64;
    }
    Ok(bus)
}
