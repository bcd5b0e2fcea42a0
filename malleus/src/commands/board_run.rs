//! `malleus board run`: runs an unmodified firmware image on a virtual board.

use malleus::wave;
use virtual_board::{Setup, VirtualBoard};

use super::board::{Form, LONGEST_S, RunArguments};
use super::error::CommandError;
use super::output::{print, print_json, progress};
use super::{board_inputs as inputs, board_midi, board_text};

/// Default time from the end of the last signal or press to the end of the run, in seconds.
const TAIL_S: f64 = 2.0;

pub(super) fn run(arguments: &RunArguments) -> Result<(), CommandError> {
    inputs::check_outputs(arguments)?;
    let elf = inputs::read(&arguments.image)?;
    let kit = arguments.kit.as_deref().map(inputs::read_kit).transpose()?.unwrap_or_default();
    let pins = inputs::pins(arguments)?;
    let setup = Setup {
        cycles: arguments.cycles.into(),
        flash_waits: arguments.flash_waits,
        piezos: inputs::signals(arguments, &pins)?,
        pins,
        adc_noise_counts: arguments.adc_noise,
        presses: arguments.button.clone(),
        faults: arguments.fault.clone(),
        kit,
        usb: board_midi::host(&arguments.midi_arguments())?,
        ..Setup::default()
    };
    let seconds = arguments.seconds.unwrap_or_else(|| length_s(&setup)).min(LONGEST_S);
    let mut board = VirtualBoard::new(arguments.board, &elf, &setup)?;
    let bar = progress((seconds * 1000.0) as u64, "running");
    let mut reached = 0.0;
    let mut ended = Ok(());
    while reached < seconds && ended.is_ok() {
        reached = (reached + 0.05_f64).min(seconds);
        ended = board.run_until(reached);
        bar.set_position((reached * 1000.0) as u64);
    }
    bar.finish_and_clear();
    if let Some(output) = &arguments.output
        && (ended.is_ok() || !board.streams().is_empty())
    {
        let (rate_hz, frames) = board.sound()?;
        wave::write_stereo(output, rate_hz, &frames)?;
    }
    let report = board.report()?;
    board_midi::write(&arguments.midi_arguments(), &report.usb)?;
    match arguments.report {
        Form::Json => print_json(&report)?,
        Form::Text => print(&board_text::text(&report))?,
    }
    if let Some(warning) = board_midi::undelivered(&report.usb) {
        eprintln!("malleus: {warning}");
    }
    Ok(ended?)
}

fn length_s(setup: &Setup) -> f64 {
    let signals = setup.piezos.iter().map(|signal| signal.start_s + signal.samples.len() as f64 / signal.rate_hz);
    let presses = setup.presses.iter().map(|press| press.at_s + press.for_s + press.bounce_s);
    let usb = setup.usb.actions.iter().map(|action| action.0);
    signals.chain(presses).chain(usb).fold(0.0, f64::max) + TAIL_S
}
