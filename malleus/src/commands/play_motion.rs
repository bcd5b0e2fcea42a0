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

/// Performance as it is played, and the file that is written beside its sound.
pub(super) struct Played {
    pub(super) rate: SampleRate,
    pub(super) performance: Performance,
    /// Parts of the sound, if the reference needs several.
    pub(super) parts: Vec<Part>,
    /// Kit that is played, if a part of its model is left out, and its binary form.
    pub(super) ablated: Option<(kit::Kit, Vec<u8>)>,
    /// Bytes of the file of the force, if one was asked for.
    pub(super) force_file: Option<Vec<u8>>,
}

/// Reads a motion, and strikes with it. Makes the file of the motion's force where it is asked for.
pub(super) fn read(
    arguments: &PlayArguments,
    path: &Path,
    kit: &kit::Kit,
    table: &Kit<'_>,
) -> Result<Played, CommandError> {
    let rate = arguments.board.map(board::rate).or(arguments.rate).unwrap_or(SampleRate::HZ_48000);
    let motion = motion::read(path, table, rate)?;
    for remark in motion.remarks() {
        eprintln!("malleus: {}: {remark}", path.display());
    }
    for beyond in scraped::beyond(&motion, table, rate) {
        eprintln!("malleus: {}: {beyond}", path.display());
    }
    let strikes = match &arguments.strikes {
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
    let binary = kit::binary::build(&kit)?;
    let table = Kit::parse(&binary).map_err(|error| CommandError::Table { kit: arguments.kit.clone(), error })?;
    let is_constant = ablations.contains(&Ablation::NormalForce);
    let failed = |error| CommandError::Scraped { kit: arguments.kit.clone(), error };
    let events = scraped::events(&motion, &table, rate, is_constant).map_err(failed)?;
    let mut performance = Performance::new(scraped::merged(&strikes, &events), None, &kit, rate, arguments.tail);
    let (mut parts, mut force_file) = (Vec::new(), None);
    if arguments.force.is_some() || arguments.reference {
        let bar = progress((motion.end_s() * rate.hz()) as u64, "scraping");
        let renderer = if arguments.reference { Renderer::Reference } else { Renderer::Instrument };
        let done = |done| bar.set_position(done as u64);
        let scraped = scraped::render(&motion, &table, rate, (renderer, is_constant), done).map_err(failed)?;
        bar.finish_and_clear();
        if let Some(path) = &arguments.force {
            force_file = Some(trace_bytes(path, rate, &scraped.trace)?);
        }
        if arguments.reference {
            performance.events = strikes;
            performance.direct = scraped::direct(&scraped, &kit);
            parts = if performance.direct.is_some() { Vec::new() } else { scraped::parts(&scraped, &kit) };
        }
    }
    let ablated = (!ablations.is_empty()).then_some((kit, binary));
    Ok(Played { rate, performance, parts, ablated, force_file })
}

fn ablation(name: AblationName) -> Ablation {
    match name {
        AblationName::Nonlinearity => Ablation::Nonlinearity,
        AblationName::NormalForce => Ablation::NormalForce,
        AblationName::Scraper => Ablation::Scraper,
    }
}

/// Force, normal force, speed and distance as a file of four channels of 32-bit float; `path` is
/// named in the error.
fn trace_bytes(path: &Path, rate: SampleRate, trace: &Trace) -> Result<Vec<u8>, CommandError> {
    let Trace { force_n, normal_n, speed_m_per_s, distance_m } = trace;
    let channels = [force_n, normal_n, speed_m_per_s, distance_m];
    Ok(wave::channels_bytes(path, rate.hz(), &channels.map(Vec::as_slice))?)
}
