//! `malleus board`: which command is run, and `run`, an unmodified firmware image on a virtual
//! board.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use virtual_board::{Board, BoardError, CycleCase, Fault, PiezoPin, PiezoSignal, Press, Report, Setup, VirtualBoard};

use super::board_midi::{self, MidiArguments};
use super::error::CommandError;
use super::output::{print, print_json, progress};
use super::usb_midi::{self, EraseArguments, PortArguments, ReadArguments, SendArguments, SettingsArguments};

/// Commands of `malleus board`.
#[derive(Debug, Subcommand)]
pub(crate) enum BoardCommand {
    /// Run a firmware image on a virtual board: gives its sound as a WAV file, its log, and its
    /// cycles
    Run(Box<RunArguments>),
    /// Show a board's firmware, its slots, their kits, and what it leaves out of each
    Info(PortArguments),
    /// Send a kit to a slot of a board over USB-MIDI, and play it
    Send(SendArguments),
    /// Read the kit in a slot of a board into a file
    Read(ReadArguments),
    /// Erase a slot of a board
    Erase(EraseArguments),
    /// Show or change a board's settings
    Settings(SettingsArguments),
    /// Restart a board in its bootloader, for dfu-util
    Dfu(PortArguments),
}

/// Arguments of `malleus board run`.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    /// ELF file of the firmware, as cargo builds it in firmware/
    image: PathBuf,
    /// Board: stm32f407g-disc1 or blackpill-f411
    #[arg(long, value_parser = parse_board, default_value = "stm32f407g-disc1")]
    board: Board,
    /// Signal at the pin of a piezo, as a WAV file whose range -1 to 1 is 0 V to the supply; piezos
    /// count from 0 [default piezo: 0]
    #[arg(long, value_name = "[PIEZO=]HIT.wav")]
    piezo: Vec<String>,
    /// Part that is wired to each piezo's pin, piezo 0 first
    #[arg(long, value_enum, value_delimiter = ',', value_name = "PIN,...")]
    pins: Vec<PinPart>,
    /// Noise of each conversion of the ADC, in counts rms
    #[arg(long, value_name = "COUNTS", default_value_t = 0.0, value_parser = parse_seconds)]
    adc_noise: f64,
    /// Start of these signals, in seconds after power-on: the firmware needs some time to start
    #[arg(long, value_name = "SECONDS", default_value_t = 0.5, value_parser = parse_seconds)]
    piezo_start: f64,
    /// Press of the button, in seconds: when, for how long (0.1 if left out), and for how long its
    /// contacts bounce (0 if left out)
    #[arg(long, value_name = "AT[,FOR[,BOUNCE]]", value_parser = parse_press)]
    button: Vec<Press>,
    /// Fault of the hardware or the program: adc-overrun@AT, audio-dma-error@AT, adc-dma-error@AT,
    /// codec-silent, crystal-dead, probe-away@AT,FOR, core-stalled@AT,FOR, halted@AT,FOR,
    /// audio-interrupt-lost@AT,FOR, piezo-at-rail@AT,PIEZO, stack-used-up@AT,BYTES (that are
    /// left), flash-error@NTH, power-lost@AT, panic@AT, hard-fault@AT; times in seconds
    #[arg(long, value_name = "FAULT[@AT,...]", value_parser = parse_fault)]
    fault: Vec<Fault>,
    /// Song that a USB host plays on the board: a Standard MIDI File
    #[arg(long, value_name = "SONG.mid")]
    midi: Option<PathBuf>,
    /// Start of the song and of --sysex, in seconds after power-on: a host needs 0.2 s to find the
    /// board once it has loaded its kit
    #[arg(long, value_name = "SECONDS", default_value_t = 0.6, value_parser = parse_seconds)]
    midi_start: f64,
    /// Standard MIDI File to write: what the board sends over USB, from the start of the song on
    #[arg(long, value_name = "OUT.mid")]
    midi_out: Option<PathBuf>,
    /// SysEx that a USB host sends to the board: raw bytes, one message after the other
    #[arg(long, value_name = "FILE.syx")]
    sysex: Option<PathBuf>,
    /// Binary kit in the kit sector of the board, from malleus kit build [default: erased flash]
    #[arg(long, value_name = "KIT.bin")]
    kit: Option<PathBuf>,
    /// Seconds to run, from power-on [default: 2 s more than the signals and presses last]
    #[arg(long, value_parser = parse_seconds)]
    seconds: Option<f64>,
    /// Column of the cycle model that sets the time of the board
    #[arg(long, value_enum, default_value = "nominal")]
    cycles: Cycles,
    /// Add the wait states of the flash that its accelerator does not hide
    #[arg(long)]
    flash_waits: bool,
    /// WAV file to write: the sound on the I2S, from its first frame on
    #[arg(short, long, value_name = "OUT.wav")]
    output: Option<PathBuf>,
    /// Form of the printed report: text for people, json for programs (docs/json.md)
    #[arg(long, value_enum, default_value = "text")]
    report: Form,
}

impl RunArguments {
    fn midi_arguments(&self) -> MidiArguments<'_> {
        MidiArguments {
            song: self.midi.as_deref(),
            sysex: self.sysex.as_deref(),
            output: self.midi_out.as_deref(),
            start_s: self.midi_start,
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Cycles {
    Best,
    Nominal,
    Worst,
}

/// Part that is wired to a piezo's pin.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum PinPart {
    /// A piezo with clamp and bias
    Piezo,
    /// Nothing
    Open,
    /// Ground
    Ground,
    /// 10 cm of wire, with nothing at its end
    Wire,
}

impl From<PinPart> for PiezoPin {
    fn from(part: PinPart) -> PiezoPin {
        match part {
            PinPart::Piezo => PiezoPin::Circuit,
            PinPart::Open => PiezoPin::Open,
            PinPart::Ground => PiezoPin::Grounded,
            PinPart::Wire => PiezoPin::Wire,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum Form {
    Text,
    Json,
}

/// Default time from the end of the last signal or press to the end of the run, in seconds.
const TAIL_S: f64 = 2.0;
/// Longest run, in seconds: an hour.
const LONGEST_S: f64 = 3600.0;

pub(crate) fn run(command: &BoardCommand) -> Result<(), CommandError> {
    match command {
        BoardCommand::Run(arguments) => run_image(arguments),
        BoardCommand::Info(arguments) => usb_midi::info(arguments),
        BoardCommand::Send(arguments) => usb_midi::send(arguments),
        BoardCommand::Read(arguments) => usb_midi::read(arguments),
        BoardCommand::Erase(arguments) => usb_midi::erase(arguments),
        BoardCommand::Settings(arguments) => usb_midi::settings(arguments),
        BoardCommand::Dfu(arguments) => usb_midi::enter_dfu(arguments),
    }
}

fn run_image(arguments: &RunArguments) -> Result<(), CommandError> {
    let elf = read(&arguments.image)?;
    let kit = arguments.kit.as_deref().map(read).transpose()?.unwrap_or_default();
    let piezos = arguments.piezo.iter().map(|piezo| signal(piezo, arguments.piezo_start));
    let setup = Setup {
        cycles: match arguments.cycles {
            Cycles::Best => CycleCase::Best,
            Cycles::Nominal => CycleCase::Nominal,
            Cycles::Worst => CycleCase::Worst,
        },
        flash_waits: arguments.flash_waits,
        piezos: piezos.collect::<Result<Vec<_>, BoardError>>()?,
        pins: arguments.pins.iter().map(|&part| part.into()).collect(),
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
        board.write_wav(output)?;
    }
    let report = board.report()?;
    board_midi::write(&arguments.midi_arguments(), &report.usb)?;
    match arguments.report {
        Form::Json => print_json(&report)?,
        Form::Text => print(&text(&report))?,
    }
    Ok(ended?)
}

pub(super) fn read(path: &Path) -> Result<Vec<u8>, CommandError> {
    std::fs::read(path).map_err(|error| CommandError::Unreadable { file: path.display().to_string(), error })
}

fn signal(argument: &str, start_s: f64) -> Result<PiezoSignal, BoardError> {
    let numbered = argument.split_once('=').and_then(|(piezo, path)| Some((piezo.parse().ok()?, path)));
    let (piezo, path) = numbered.unwrap_or((0, argument));
    PiezoSignal::from_wav(piezo, start_s, Path::new(path))
}

fn length_s(setup: &Setup) -> f64 {
    let signals = setup.piezos.iter().map(|signal| signal.start_s + signal.samples.len() as f64 / signal.rate_hz);
    let presses = setup.presses.iter().map(|press| press.at_s + press.for_s + press.bounce_s);
    let usb = setup.usb.actions.iter().map(|action| action.0);
    signals.chain(presses).chain(usb).fold(0.0, f64::max) + TAIL_S
}

fn text(report: &Report) -> String {
    let mut text = String::new();
    let mhz = report.core_hz / 1e6;
    let microseconds = |cycles: f64| cycles / mhz;
    for line in &report.log {
        let _ = writeln!(text, "{:10.4} s  {:5} {}", line.at_s, line.level, line.message);
    }
    let waits = if report.flash_waits { " with the waits of flash" } else { "" };
    let _ =
        writeln!(text, "{}: {:.3} s at {mhz} MHz, {} cycles{waits}", report.board, report.seconds, report.cycle_case);
    let stack = report.stack_bytes.map_or("unknown".to_owned(), |bytes| format!("{bytes} bytes"));
    let _ = writeln!(
        text,
        "flash {} bytes, static RAM {} bytes, stack {stack}; {} instructions, idle {:.1} %",
        report.flash_bytes,
        report.static_ram_bytes,
        report.instructions,
        100.0 * report.idle_share
    );
    let audio = &report.audio;
    let frames: usize = audio.streams.iter().map(|stream| stream.frames).sum();
    let underruns: u64 = audio.streams.iter().map(|stream| stream.underruns).sum();
    let rate = audio.rate.as_deref().unwrap_or("no rate");
    let _ = writeln!(
        text,
        "I2S: {rate} Hz, {frames} frames in {} streams, {underruns} underruns; {} halves, {} late, worst load {:.1} %",
        audio.streams.len(),
        audio.halves,
        audio.late_halves,
        100.0 * audio.worst_load.unwrap_or(0.0)
    );
    let _ = writeln!(text, "ADC: {} sequences, {} triggers lost", report.adc.sequences, report.adc.lost_triggers);
    for interrupt in &report.interrupts {
        let latency = interrupt
            .worst_latency_cycles
            .map_or(String::new(), |cycles| format!(", latency at most {:.2} us", microseconds(cycles as f64)));
        let _ = writeln!(
            text,
            "{:14} {:8} times, {:5.1} % of the time, at most {:.1} us{latency}",
            interrupt.name,
            interrupt.count,
            100.0 * interrupt.cycles as f64 / (report.seconds * report.core_hz),
            microseconds(interrupt.worst_span_cycles as f64)
        );
    }
    let usb = &report.usb;
    if usb.resets > 0 {
        let _ = writeln!(
            text,
            "USB: configured {} times, {} transfers to the board, {} refused for the moment, {} from the board",
            usb.configured_s.len(),
            usb.sent.len(),
            usb.refused,
            usb.received.len()
        );
    }
    let flash = &report.flash;
    if flash.programmed + flash.failed + flash.torn > 0 || flash.erases.iter().any(|&erases| erases > 0) {
        let _ = writeln!(
            text,
            "flash: {} programmed, {} failed, {} torn; erases by sector {:?}",
            flash.programmed, flash.failed, flash.torn, flash.erases
        );
    }
    if let Some(lost_s) = report.power_lost_s {
        let _ = writeln!(text, "{lost_s:10.4} s  power lost");
    }
    for reset in &report.resets {
        let _ = writeln!(text, "{:10.4} s  reset: {}", reset.at_s, reset.cause);
    }
    for mute in &report.mutes {
        let _ = writeln!(text, "{:10.4} s  converter {}", mute.at_s, if mute.mute { "mute" } else { "audible" });
    }
    for volume in &report.volumes {
        let side = |db: Option<f64>| db.map_or("mute".to_owned(), |db| format!("{db} dB"));
        let [left, right] = volume.headphones_db.map(side);
        let _ = writeln!(text, "{:10.4} s  headphones {left} and {right}", volume.at_s);
    }
    let _ = writeln!(text, "LEDs: {} changes", report.leds.len());
    for warning in report.codec_complaints.iter().chain(&report.warnings).chain(&usb.failures) {
        let _ = writeln!(text, "warning: {warning}");
    }
    text
}

pub(crate) fn parse_board(name: &str) -> Result<Board, String> {
    name.parse().map_err(|error: BoardError| error.to_string())
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.0..=LONGEST_S).contains(seconds));
    seconds.ok_or_else(|| format!("must be from 0 to {LONGEST_S} seconds"))
}

fn parse_press(text: &str) -> Result<Press, String> {
    let times = text.split(',').map(parse_seconds).collect::<Result<Vec<f64>, String>>()?;
    match times[..] {
        [at_s] => Ok(Press { at_s, for_s: 0.1, bounce_s: 0.0 }),
        [at_s, for_s] => Ok(Press { at_s, for_s, bounce_s: 0.0 }),
        [at_s, for_s, bounce_s] => Ok(Press { at_s, for_s, bounce_s }),
        _ => {
            Err("must be when, for how long, and for how long it bounces, in seconds, such as 1.5,0.2,0.005".to_owned())
        }
    }
}

fn parse_fault(text: &str) -> Result<Fault, String> {
    let (name, rest) = text.split_once('@').unwrap_or((text, ""));
    let parts: Vec<&str> = rest.split(',').filter(|part| !part.is_empty()).collect();
    let at = |index: usize| {
        let part = parts.get(index).ok_or_else(|| format!("must give more times, such as {name}@1.5,0.1"))?;
        parse_seconds(part)
    };
    let number = |index: usize| -> Result<u64, String> {
        parts[index].parse().map_err(|_| format!("{name} takes a whole number, counted from 0"))
    };
    Ok(match (name, parts.len()) {
        ("codec-silent", 0) => Fault::CodecSilent,
        ("adc-overrun", 1) => Fault::AdcOverrun { at_s: at(0)? },
        ("audio-dma-error", 1) => Fault::AudioDmaError { at_s: at(0)? },
        ("adc-dma-error", 1) => Fault::AdcDmaError { at_s: at(0)? },
        ("core-stalled", 2) => Fault::CoreStalled { at_s: at(0)?, for_s: at(1)? },
        ("halted", 2) => Fault::Halted { at_s: at(0)?, for_s: at(1)? },
        ("audio-interrupt-lost", 2) => Fault::AudioInterruptLost { at_s: at(0)?, for_s: at(1)? },
        ("crystal-dead", 0) => Fault::CrystalDead,
        ("probe-away", 2) => Fault::ProbeAway { at_s: at(0)?, for_s: at(1)? },
        ("stack-used-up", 2) => Fault::StackUsedUp { at_s: at(0)?, left_bytes: number(1)? as u32 },
        ("piezo-at-rail", 2) => Fault::PiezoAtRail { at_s: at(0)?, piezo: number(1)? as usize },
        ("flash-error", 1) => Fault::FlashError { nth: number(0)? },
        ("power-lost", 1) => Fault::PowerLost { at_s: at(0)?, seed: 0 },
        ("panic", 1) => Fault::Panic { at_s: at(0)? },
        ("hard-fault", 1) => Fault::HardFault { at_s: at(0)? },
        _ => {
            return Err(
                "must be adc-overrun@AT, audio-dma-error@AT, adc-dma-error@AT, codec-silent, crystal-dead, probe-away@AT,FOR, \
                        core-stalled@AT,FOR, halted@AT,FOR, audio-interrupt-lost@AT,FOR, piezo-at-rail@AT,PIEZO, \
                        stack-used-up@AT,BYTES, flash-error@NTH, power-lost@AT, \
                        panic@AT or hard-fault@AT"
                    .to_owned(),
            );
        }
    })
}
