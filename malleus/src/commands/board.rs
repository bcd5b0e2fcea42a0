//! `malleus board`: which command is run, and the arguments of `run`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use virtual_board::{Board, BoardError, CycleCase, Fault, PiezoPin, Press};

use super::board_midi::MidiArguments;
use super::board_run;
use super::error::CommandError;
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
    pub(super) image: PathBuf,
    /// Board: stm32f407g-disc1 or blackpill-f411
    #[arg(long, value_parser = parse_board, default_value = "stm32f407g-disc1")]
    pub(super) board: Board,
    /// Signal at the pin of a piezo, as a WAV file whose range -1 to 1 is 0 V to the supply; piezos
    /// count from 0 [default piezo: 0]
    #[arg(long, value_name = "[PIEZO=]HIT.wav")]
    pub(super) piezo: Vec<String>,
    /// Part that is wired to each piezo's pin, piezo 0 first
    #[arg(long, value_enum, value_delimiter = ',', value_name = "PIN,...")]
    pub(super) pins: Vec<PinPart>,
    /// Noise of each conversion of the ADC, in counts rms, from 0 to 4095
    #[arg(long, value_name = "COUNTS", default_value_t = 0.0, value_parser = parse_counts)]
    pub(super) adc_noise: f64,
    /// Start of these signals, in seconds after power-on: the firmware needs some time to start
    #[arg(long, value_name = "SECONDS", default_value_t = 0.5, value_parser = parse_seconds)]
    pub(super) piezo_start: f64,
    /// Press of the button, in seconds: when, for how long (0.1 if left out), and for how long its
    /// contacts bounce (0 if left out)
    #[arg(long, value_name = "AT[,FOR[,BOUNCE]]", value_parser = parse_press)]
    pub(super) button: Vec<Press>,
    /// Fault of the hardware or the program: adc-overrun@AT, audio-dma-error@AT, adc-dma-error@AT,
    /// codec-silent, crystal-dead, probe-away@AT,FOR, core-stalled@AT,FOR, halted@AT,FOR,
    /// audio-interrupt-lost@AT,FOR, piezo-at-rail@AT,PIEZO, stack-used-up@AT,BYTES (that are
    /// left), flash-error@NTH, power-lost@AT, panic@AT, hard-fault@AT; times in seconds
    #[arg(long, value_name = "FAULT[@AT,...]", value_parser = parse_fault)]
    pub(super) fault: Vec<Fault>,
    /// Song that a USB host plays on the board: a Standard MIDI File
    #[arg(long, value_name = "SONG.mid")]
    pub(super) midi: Option<PathBuf>,
    /// Start of the song and of --sysex, in seconds after power-on: a host needs 0.2 s to find the
    /// board once it has loaded its kit
    #[arg(long, value_name = "SECONDS", default_value_t = 0.6, value_parser = parse_seconds)]
    pub(super) midi_start: f64,
    /// Standard MIDI File to write: what the board sends over USB, from the start of the song or of
    /// --sysex on; without both from power-on
    #[arg(long, value_name = "OUT.mid")]
    pub(super) midi_out: Option<PathBuf>,
    /// SysEx that a USB host sends to the board: raw bytes, one message after the other
    #[arg(long, value_name = "FILE.syx")]
    pub(super) sysex: Option<PathBuf>,
    /// Binary kit in the kit sector of the board, from malleus kit build [default: erased flash]
    #[arg(long, value_name = "KIT.bin")]
    pub(super) kit: Option<PathBuf>,
    /// Seconds to run, from power-on [default: 2 s more than the signals and presses last]
    #[arg(long, value_parser = parse_seconds)]
    pub(super) seconds: Option<f64>,
    /// Column of the cycle model that sets the time of the board
    #[arg(long, value_enum, default_value = "nominal")]
    pub(super) cycles: Cycles,
    /// Add the wait states of the flash that its accelerator does not hide
    #[arg(long)]
    pub(super) flash_waits: bool,
    /// WAV file to write: the sound on the I2S, from its first frame on
    #[arg(short, long, value_name = "OUT.wav")]
    pub(super) output: Option<PathBuf>,
    /// Form of the printed report: text for people, json for programs (docs/json.md)
    #[arg(long, value_enum, default_value = "text")]
    pub(super) report: Form,
}

impl RunArguments {
    pub(super) fn midi_arguments(&self) -> MidiArguments<'_> {
        MidiArguments {
            song: self.midi.as_deref(),
            sysex: self.sysex.as_deref(),
            output: self.midi_out.as_deref(),
            start_s: self.midi_start,
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum Cycles {
    Best,
    Nominal,
    Worst,
}

/// Part that is wired to a piezo's pin.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum PinPart {
    /// A piezo with clamp and bias
    Piezo,
    /// Nothing
    Open,
    /// Ground
    Ground,
    /// 10 cm of wire, with nothing at its end
    Wire,
}

impl From<Cycles> for CycleCase {
    fn from(cycles: Cycles) -> CycleCase {
        match cycles {
            Cycles::Best => CycleCase::Best,
            Cycles::Nominal => CycleCase::Nominal,
            Cycles::Worst => CycleCase::Worst,
        }
    }
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
pub(super) enum Form {
    Text,
    Json,
}

/// Longest run, in seconds: an hour.
pub(super) const LONGEST_S: f64 = 3600.0;
/// Largest noise of the ADC, in counts: its whole range of 12 bits.
const MOST_COUNTS: f64 = 4095.0;

pub(crate) fn run(command: &BoardCommand) -> Result<(), CommandError> {
    match command {
        BoardCommand::Run(arguments) => board_run::run(arguments),
        BoardCommand::Info(arguments) => usb_midi::info(arguments),
        BoardCommand::Send(arguments) => usb_midi::send(arguments),
        BoardCommand::Read(arguments) => usb_midi::read(arguments),
        BoardCommand::Erase(arguments) => usb_midi::erase(arguments),
        BoardCommand::Settings(arguments) => usb_midi::settings(arguments),
        BoardCommand::Dfu(arguments) => usb_midi::enter_dfu(arguments),
    }
}

pub(crate) fn parse_board(name: &str) -> Result<Board, String> {
    name.parse().map_err(|error: BoardError| error.to_string())
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.0..=LONGEST_S).contains(seconds));
    seconds.ok_or_else(|| format!("must be from 0 to {LONGEST_S} seconds"))
}

fn parse_counts(text: &str) -> Result<f64, String> {
    let counts = text.parse().ok().filter(|counts| (0.0..=MOST_COUNTS).contains(counts));
    counts.ok_or_else(|| format!("must be from 0 to {MOST_COUNTS} counts of the ADC, which has 12 bits"))
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
