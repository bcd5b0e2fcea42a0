//! Motion of `malleus play`: its force, and the performance that it makes with the strikes.

use std::path::Path;

use dsp_core::SampleRate;
use dsp_core::table::Kit;
use malleus::render::part::Part;
use malleus::render::scraped::{self, Ablation, Renderer, Trace};
use malleus::render::{Performance, board};
use malleus::{events, motion, wave};

use super::error::CommandError;
use super::output::progress;
use crate::arguments::{AblationName, PlayArguments};

/// Reads a motion, and strikes with it, and renders the motion's force. Writes that as a file where
/// it is asked for.
pub(super) fn read_performance(
    arguments: &PlayArguments,
    path: &Path,
    kit: &kit::Kit,
    table: &Kit<'_>,
) -> Result<(SampleRate, Performance, Vec<Part>), CommandError> {
    let rate = arguments.board.map(board::rate).or(arguments.rate).unwrap_or(SampleRate::HZ_48000);
    let motion = motion::read(path, table, rate)?;
    for remark in motion.remarks() {
        eprintln!("malleus: {}: {remark}", path.display());
    }
    let events = match &arguments.strikes {
        None => Vec::new(),
        Some(strikes) => {
            let list = events::read(strikes, table, rate)?;
            list.remarks.iter().for_each(|remark| eprintln!("malleus: {}: {remark}", strikes.display()));
            if !list.strikes.is_empty() {
                return Err(CommandError::OwnForceWithMotion { file: strikes.display().to_string() });
            }
            list.events
        }
    };
    let ablations: Vec<Ablation> = arguments.without.iter().copied().map(ablation).collect();
    let pads: Vec<u8> = motion.contacts().iter().map(|contact| contact.pad).collect();
    let kit = scraped::without(kit, &ablations, &pads);
    let failed = |error| CommandError::Scraped { kit: arguments.kit.clone(), error };
    let binary = kit::binary::build(&kit)?;
    let table = Kit::parse(&binary).map_err(|error| CommandError::Table { kit: arguments.kit.clone(), error })?;
    let bar = progress((motion.end_s() * rate.hz()) as u64, "scraping");
    let renderer = if arguments.reference { Renderer::Reference } else { Renderer::Instrument };
    let is_constant = ablations.contains(&Ablation::NormalForce);
    let scraped = scraped::render(&motion, &table, rate, (renderer, is_constant), |done| bar.set_position(done as u64))
        .map_err(failed)?;
    bar.finish_and_clear();
    if let Some(path) = &arguments.force {
        write_trace(path, rate, &scraped.trace)?;
    }
    // Parts have their own kits, from which something may be left out; the board has its own.
    let whole = if ablations.is_empty() { scraped::direct(&scraped, &kit) } else { None };
    if let Some(direct) = whole {
        return Ok((rate, Performance::new(events, Some(direct), &kit, rate, arguments.tail), Vec::new()));
    }
    if arguments.board.is_some() || arguments.budget_mhz.is_some() || arguments.limit.is_some() {
        return Err(CommandError::MotionOnBoard { file: path.display().to_string() });
    }
    let parts = scraped::parts(&scraped, &kit);
    let longest = parts.iter().max_by_key(|part| part.direct.1.len()).map(|part| part.direct.clone());
    let performance = Performance::new(events, longest, &kit, rate, arguments.tail);
    Ok((rate, performance, parts))
}

fn ablation(name: AblationName) -> Ablation {
    match name {
        AblationName::Nonlinearity => Ablation::Nonlinearity,
        AblationName::NormalForce => Ablation::NormalForce,
        AblationName::Scraper => Ablation::Scraper,
    }
}

/// Writes force, normal force, speed and distance as four channels of 32-bit float.
fn write_trace(path: &Path, rate: SampleRate, trace: &Trace) -> Result<(), CommandError> {
    let Trace { force_n, normal_n, speed_m_per_s, distance_m } = trace;
    let channels = [force_n, normal_n, speed_m_per_s, distance_m];
    Ok(wave::write_channels(path, rate.hz(), &channels.map(Vec::as_slice))?)
}
