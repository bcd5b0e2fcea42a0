//! `malleus play`: renders events or a direct force on a kit and writes the sound.

use std::path::{Path, PathBuf};

use dsp_core::SampleRate;
use dsp_core::engine::{Setup, Skipping, TickReport};
use dsp_core::event::{Action, Event};
use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::Kit;
use kit::counting::counted;
use malleus::render::force::{self, ForceLoad};
use malleus::render::instrument::{Output, Settings};
use malleus::render::level::{Level, held_frames};
use malleus::render::part::Part;
use malleus::render::{Performance, board, instrument, own_force, parts, reference};
use malleus::{events, wave};
use virtual_board::Board;

use super::error::CommandError;
use super::left_out::left_out;
use super::output::{peak_dbfs, print, print_json, progress, refuse_input, refuse_same};
use super::play_motion::{self, Played};
use super::play_report::{PlayReport, Work};
use crate::arguments::PlayArguments;

/// Longest sound that is rendered at once, in seconds: an hour is 1.4 GB of frames.
const LONGEST_S: f64 = 3_600.0;

pub(crate) fn run(arguments: &PlayArguments) -> Result<(), CommandError> {
    refuse_inputs(arguments)?;
    let loaded = kit::open(&arguments.kit)?;
    let name = &arguments.kit;
    let table = Kit::parse(&loaded.binary).map_err(|error| CommandError::Table { kit: name.clone(), error })?;
    if loaded.kit.pads.is_empty() {
        return Err(CommandError::NoPads { kit: name.clone() });
    }
    let Played { rate, performance, parts, ablated, force_file } = match &arguments.motion {
        Some(motion) => play_motion::read(arguments, motion, &loaded.kit, &table)?,
        None => {
            let (rate, performance, parts) = read_performance(arguments, &loaded.kit, &table)?;
            Played { rate, performance, parts, ablated: None, force_file: None }
        }
    };
    let (kit, binary) = ablated.as_ref().map_or((&loaded.kit, &loaded.binary), |(kit, binary)| (kit, binary));
    let table = Kit::parse(binary).map_err(|error| CommandError::Table { kit: name.clone(), error })?;
    let seconds = performance.frames as f64 / rate.hz();
    if seconds > LONGEST_S {
        let files = [&arguments.motion, &arguments.strikes].into_iter().flatten();
        let file = files.map(|path| path.display().to_string()).next();
        let file = file.or_else(|| arguments.direct.clone()).unwrap_or_default();
        return Err(CommandError::TooLong { file, seconds, longest: LONGEST_S });
    }
    let mut work = Work::default();
    let mut log_text = None;
    let budget_cycles = budget_cycles(arguments, &performance, rate);
    let (frames, level) = if !parts.is_empty() {
        play_parts(arguments, kit, &performance, &parts, rate)?
    } else if arguments.reference {
        let left_out = reference::leaves_out(kit);
        if !left_out.is_empty() {
            eprintln!("malleus: {name}: the reference leaves out {}", left_out.join(", "));
        }
        let bar = progress(performance.frames as u64, "reference");
        let sound = reference::render(kit, &performance, rate, |done| bar.set_position(done as u64))
            .map_err(|error| CommandError::Reference { kit: name.clone(), error })?;
        bar.finish_and_clear();
        let level = Level::of_reference(&sound);
        (sound.into_iter().map(|frame| frame.map(::reference::scene::quantise_24)).collect(), level)
    } else {
        let skipping = if arguments.no_skip { Skipping::Off } else { Skipping::On };
        // Strikes wait for a tick with time, as on a board, in blocks of one tick.
        let block = if budget_cycles.is_some() { TICK_FRAMES } else { arguments.block as usize };
        // What is in frames cannot be left out, and has to stay within the budget.
        let frame_cycles = budget_cycles.map(|cycles| cycles / TICK_FRAMES as u32);
        let settings = Settings {
            setup: Setup { skipping, frame_cycles, ceiling_db: arguments.limit, ..Setup::new(rate) },
            block,
            budget_cycles,
        };
        if let Some(on) = arguments.board {
            // A motion is played as on a firmware with scraping and rolling.
            let is_told = |line: &&String| arguments.motion.is_none() || !line.contains("leaves out: surfaces");
            left_out(name, on, &table).iter().filter(is_told).for_each(|line| eprintln!("malleus: {line}"));
        }
        let bar = progress(performance.frames as u64, "playing");
        let mut played = Vec::new();
        let observe = |report: &TickReport| {
            work.add(report);
            bar.set_position(report.frame);
        };
        // The log stands beside the motion.
        let log = |event: &Event| played.extend((!event.is_motion()).then_some(*event));
        let frames = match arguments.board {
            Some(on) => board::render(on, &table, &performance, budget_cycles, Output::Bus, observe, log),
            None => instrument::render_logged(&table, &performance, settings, Output::Bus, observe, log),
        };
        let mut frames = frames.map_err(|error| CommandError::Render { kit: name.clone(), error })?;
        bar.finish_and_clear();
        log_text = Some(events::csv::write(&played, &table, rate));
        let level = Level { held_frames: held_frames(&table, &frames), ..Level::of_bus(&frames) };
        dsp_core::output::to_24_bit(&mut frames);
        (frames, level)
    };
    // All files appear together: a force or a log without its sound would be that of another run.
    let sound = wave::stereo_bytes(&arguments.output, rate.hz(), &frames)?;
    let force_file = arguments.force.as_deref().zip(force_file.as_deref());
    let log = arguments.log.as_deref().zip(log_text.as_deref().map(str::as_bytes));
    let files: Vec<(&Path, &[u8])> = force_file.into_iter().chain(log).chain([(&*arguments.output, &*sound)]).collect();
    kit::file::write_together(&files)?;
    if work.refused_scrapes > 0 {
        eprintln!(
            "malleus: {name}: {} left out: an engine has two contacts at once, and a board has time for few",
            counted(work.refused_scrapes, "touches")
        );
    }
    let force = (!arguments.reference).then(|| force::load(kit, &performance.events, rate));
    warn_of_clipping(name, &level, force);
    let report = PlayReport {
        output: &arguments.output,
        kit: name,
        renderer: if arguments.reference { "reference" } else { "instrument" },
        board: arguments.board.map(Board::name),
        rate_hz: rate.hz(),
        rate_ratio: rate.ratio(),
        frames: frames.len(),
        duration_s: frames.len() as f64 / rate.hz(),
        peak_dbfs: peak_dbfs(&frames),
        unclipped_peak_dbfs: level.peak_dbfs(),
        clipped_samples: level.clipped_samples,
        saturated_samples: (!arguments.reference).then_some(level.saturated_samples),
        held_frames: (!arguments.reference).then_some(level.held_frames),
        largest_force: force.map(|force| force.largest),
        force_overloads: force.map(|force| force.overloads),
        budget_cycles,
        work: (!arguments.reference).then_some(work),
    };
    if arguments.json { print_json(&report) } else { print(&report.as_text(rate)) }
}

/// Cycles that a tick may take; `None` for no limit.
///
/// Without `--budget-mhz` a board's own limit holds. Events that are a log hold the board's
/// decisions already, and are played without a limit.
fn budget_cycles(arguments: &PlayArguments, performance: &Performance, rate: SampleRate) -> Option<u32> {
    match arguments.budget_mhz {
        Some(0.0) => None,
        Some(mhz) => Some((mhz * 1e6 * TICK_FRAMES as f64 / rate.hz()) as u32),
        None => {
            let is_log = performance.events.iter().any(|event| matches!(event.action, Action::Shed(_)));
            arguments.board.filter(|_| !is_log).map(board::budget_cycles)
        }
    }
}

fn warn_of_clipping(kit: &str, level: &Level, force: Option<ForceLoad>) {
    if let Some(ForceLoad { largest, overloads }) = force.filter(|force| force.overloads > 0) {
        eprintln!(
            "malleus: {kit}: the force of {} may clip: it comes up to {largest:.1} times reference_force, and the force bus ends at 16; malleus kit check says which reference_force fits",
            counted(overloads, "strikes")
        );
    }
    if level.saturated_samples > 0 {
        eprintln!(
            "malleus: {kit}: {} at the end of the bus, +24 dBFS, may be clipped there; lower the pads' level_db",
            counted(level.saturated_samples, "samples")
        );
    }
    if level.held_frames > 0 {
        eprintln!(
            "malleus: {kit}: a pad's sound is clipped in {}, at +24 dBFS before its level_db; lower its object's gains (of scrapes and rolls, surface_level_db), and raise the level_db as much",
            counted(level.held_frames, "frames")
        );
    }
    if level.clipped_samples > 0 {
        let peak_dbfs = level.peak_dbfs().unwrap_or_default();
        eprintln!(
            "malleus: {kit}: clipped in {}, since the peak is {peak_dbfs:+.1} dBFS; lower the pads' level_db as malleus kit check proposes",
            counted(level.clipped_samples, "samples")
        );
    }
}

fn read_performance(
    arguments: &PlayArguments,
    kit: &kit::Kit,
    table: &Kit<'_>,
) -> Result<(SampleRate, Performance, Vec<Part>), CommandError> {
    if let (Some(direct), Some(pad)) = (&arguments.direct, &arguments.pad) {
        let (path, channel) = split_channel(direct);
        let pad = (0u8..).zip(&kit.pads).find(|(_, candidate)| candidate.name == *pad).map(|(index, _)| index);
        let pad = pad.ok_or_else(|| CommandError::UnknownPad {
            kit: arguments.kit.clone(),
            name: arguments.pad.clone().unwrap_or_default(),
            pads: kit.pads.iter().map(|pad| pad.name.as_str()).collect::<Vec<_>>().join(", "),
        })?;
        let force = wave::read_force(&path, channel)?;
        let rate = arguments.board.map(board::rate).or(arguments.rate).unwrap_or(force.rate);
        if rate.hz() != force.rate.hz() {
            let file = path.display().to_string();
            return Err(CommandError::RateMismatch { file, file_rate: force.rate, rate });
        }
        let performance = Performance::new(Vec::new(), Some((pad, force.samples)), kit, rate, arguments.tail);
        return Ok((rate, performance, Vec::new()));
    }
    let rate = arguments.board.map(board::rate).or(arguments.rate).unwrap_or(SampleRate::HZ_48000);
    let path = arguments.strikes.as_deref().unwrap_or(Path::new(""));
    let list = events::read(path, table, rate)?;
    for remark in &list.remarks {
        eprintln!("malleus: {}: {remark}", path.display());
    }
    let direct = own_force::direct(&list.strikes, kit, rate);
    let parts = own_force::parts(&list.strikes, kit, rate);
    let is_limited = arguments.board.is_some() || arguments.budget_mhz.is_some() || arguments.limit.is_some();
    if !parts.is_empty() && (is_limited || arguments.log.is_some()) {
        return Err(CommandError::PartsOnBoard { file: path.display().to_string() });
    }
    Ok((rate, Performance::new(list.events, direct, kit, rate, arguments.tail), parts))
}

/// Renders the parts of strikes at several positions or with several strikers, and adds them up.
fn play_parts(
    arguments: &PlayArguments,
    kit: &kit::Kit,
    performance: &Performance,
    parts: &[Part],
    rate: SampleRate,
) -> Result<(Vec<[i32; 2]>, Level), CommandError> {
    let scenes = parts::scenes(kit, performance, parts);
    let bar = progress((scenes.len() * performance.frames) as u64, "playing");
    let name = || arguments.kit.clone();
    if arguments.reference {
        let mut exact = vec![[0.0; 2]; performance.frames];
        for (index, (kit, performance)) in scenes.iter().enumerate() {
            let done = |done: usize| bar.set_position((index * performance.frames + done) as u64);
            let sound = reference::render(kit, performance, rate, done)
                .map_err(|error| CommandError::Reference { kit: name(), error })?;
            exact.iter_mut().zip(sound).for_each(|(sum, x)| *sum = [sum[0] + x[0], sum[1] + x[1]]);
        }
        bar.finish_and_clear();
        let level = Level::of_reference(&exact);
        return Ok((exact.into_iter().map(|frame| frame.map(::reference::scene::quantise_24)).collect(), level));
    }
    let skipping = if arguments.no_skip { Skipping::Off } else { Skipping::On };
    let setup = Setup { skipping, ..Setup::new(rate) };
    let mut bus = parts::render(&scenes, setup, arguments.block as usize, |done| bar.set_position(done))
        .map_err(|error| CommandError::Parts { kit: name(), error })?;
    bar.finish_and_clear();
    let level = Level::of_bus(&bus);
    dsp_core::output::to_24_bit(&mut bus);
    Ok((bus, level))
}

/// Refuses to write sound or log over the kit, the events or the force that are played, or over one
/// another.
fn refuse_inputs(arguments: &PlayArguments) -> Result<(), CommandError> {
    let direct = arguments.direct.as_deref().map(|direct| split_channel(direct).0);
    let motion = arguments.motion.as_deref();
    let inputs = [Some(Path::new(&arguments.kit)), arguments.strikes.as_deref(), motion, direct.as_deref()];
    let outputs = [arguments.log.as_deref(), arguments.force.as_deref(), Some(arguments.output.as_path())];
    let outputs: Vec<&Path> = outputs.into_iter().flatten().collect();
    for output in &outputs {
        refuse_input(output, inputs.into_iter().flatten())?;
    }
    refuse_same(&outputs)
}

/// Splits `FILE:2` into the path FILE and channel 2. Without a number behind the last colon the
/// channel is 0.
fn split_channel(argument: &str) -> (PathBuf, u16) {
    if let Some((path, channel)) = argument.rsplit_once(':')
        && let Ok(channel) = channel.parse()
    {
        return (PathBuf::from(path), channel);
    }
    (PathBuf::from(argument), 0)
}
