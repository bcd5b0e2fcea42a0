//! Report of a run, which serialises to the JSON of `malleus board run --report json`
//! (docs/json.md).

use serde::Serialize;
use virtual_core::{CycleCase, FunctionCost};

use super::account::exception_name;
use super::{LogLine, VirtualBoard};
use crate::devices::AudioHalf;
use crate::devices::rcc::ResetCause;
use crate::error::BoardError;
use crate::flash::{FlashChange, FlashEnding, FlashHistory, FlashMemory, FlashOperation};
use crate::usb_host::UsbReport;

/// Report of a run, without its sound.
///
/// Cycles are those of the chosen column of the cycle model. Times are seconds from power-on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Name of the board.
    pub board: &'static str,
    /// Column of the cycle model: `best`, `nominal` or `worst`.
    pub cycle_case: &'static str,
    /// True if the waits of flash are in the cycles.
    pub flash_waits: bool,
    /// Number of bytes of the image in flash.
    pub flash_bytes: u32,
    /// Number of bytes of RAM in use before the first call.
    pub static_ram_bytes: u32,
    /// Most bytes of stack that were used.
    pub stack_bytes: Option<u32>,
    /// Number of bytes that the memory map leaves to the stack; `None` if the image does not name
    /// the end of the stack.
    pub stack_room_bytes: Option<u32>,
    /// Time for which the board ran, in seconds, rounded to microseconds.
    pub seconds: f64,
    /// Clock of the core at the end, in Hz.
    pub core_hz: f64,
    /// Number of instructions executed.
    pub instructions: u64,
    /// Number of cycles since power-on.
    pub cycles: u64,
    /// Number of cycles in which the core slept. The differences between two reports tell the load
    /// in the time between them.
    pub idle_cycles: u64,
    /// Share of the cycles in which the core slept.
    pub idle_share: f64,
    /// Number of cycles in thread mode, awake.
    pub thread_cycles: u64,
    /// Interrupts and exceptions that ran, the dearest first.
    pub interrupts: Vec<InterruptReport>,
    /// The 20 dearest functions, the dearest first.
    pub functions: Vec<FunctionReport>,
    /// Sound that left the board.
    pub audio: AudioReport,
    /// Conversions of the ADC.
    pub adc: AdcReport,
    /// Changes of the LEDs.
    pub leds: Vec<LedReport>,
    /// Changes of the converter between audible and mute.
    pub mutes: Vec<MuteReport>,
    /// Changes of the level at which the codec's headphones play.
    pub volumes: Vec<VolumeReport>,
    /// Resets after power-on.
    pub resets: Vec<ResetReport>,
    /// Time at which power was lost, in seconds; `None` if it was not.
    pub power_lost_s: Option<f64>,
    /// Operations on flash.
    pub flash: FlashReport,
    /// Traffic on the USB, as its host saw it.
    pub usb: UsbReport,
    /// Faults of the codec's driver, as sentences.
    pub codec_complaints: Vec<String>,
    /// Faults of the program that a chip would let pass, as sentences.
    pub warnings: Vec<String>,
    /// Lines of the log.
    pub log: Vec<LogLine>,
}

/// Cycles of an interrupt or another exception.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InterruptReport {
    /// Name in the vector table.
    pub name: String,
    /// Number of runs of the handler.
    pub count: u64,
    /// Number of cycles of all runs, without those that preempted them.
    pub cycles: u64,
    /// Most cycles of a run, without those that preempted it.
    pub worst_cycles: u64,
    /// Most cycles from entry to return, preemptions included.
    pub worst_span_cycles: u64,
    /// Mean number of cycles from the assertion of the line to the handler's first instruction;
    /// `None` if only the program itself pends the interrupt.
    pub mean_latency_cycles: Option<f64>,
    /// Most cycles from the assertion of the line to the handler's first instruction.
    pub worst_latency_cycles: Option<u64>,
}

/// Cost of a function, without that of the functions it called.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FunctionReport {
    /// Demangled name.
    pub name: String,
    /// Number of nominal cycles, without the waits of memory.
    pub nominal_cycles: u64,
    /// Number of instructions.
    pub instructions: u64,
}

/// Sound that left the board.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AudioReport {
    /// Exact sample rate of the last stream, as a ratio of whole Hz such as `86000000/1792`.
    pub rate: Option<String>,
    /// Sample rate of the last stream in Hz.
    pub rate_hz: Option<f64>,
    /// Streams without interruption.
    pub streams: Vec<StreamReport>,
    /// Number of halves of the DMA buffer that began to play.
    pub halves: u64,
    /// Number of halves that began to play before the program had finished with them.
    pub late_halves: u64,
    /// Longest run of the audio interrupt, from entry to return, as a share of a half's time.
    pub worst_load: Option<f64>,
}

/// Stream of sound without interruption.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StreamReport {
    /// Time at which the first bit stood on the pin.
    pub start_s: f64,
    /// Number of frames.
    pub frames: usize,
    /// Number of half-words that were sent twice because no new one had come.
    pub underruns: u64,
    /// Number of frames that no pin carried.
    pub unconnected_frames: u64,
}

/// Conversions of the ADC.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AdcReport {
    /// Number of sequences of conversions that began.
    pub sequences: u64,
    /// Number of triggers that were lost because they came while a sequence ran.
    pub lost_triggers: u64,
}

/// Change of a LED.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LedReport {
    /// Time of the change.
    pub at_s: f64,
    /// Colour of the LED.
    pub led: &'static str,
    /// True if the LED is lit from then on.
    pub lit: bool,
}

/// Change of the converter between audible and mute.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MuteReport {
    /// Time of the change.
    pub at_s: f64,
    /// True if the converter is mute from then on.
    pub mute: bool,
}

/// Change of the level at which the codec's headphones play.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VolumeReport {
    /// Time of the change.
    pub at_s: f64,
    /// Level of left and right in dB from then on, `None` for a side that is mute.
    pub headphones_db: [Option<f64>; 2],
}

/// Reset of the chip.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResetReport {
    /// Time of the reset.
    pub at_s: f64,
    /// Cause of the reset: `software` or `watchdog`.
    pub cause: &'static str,
}

/// Operations on flash.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlashReport {
    /// Number of erases of each sector, with those of earlier runs on this flash.
    pub erases: Vec<u32>,
    /// Number of bytes, half-words and words that were programmed.
    pub programmed: usize,
    /// Number of operations that were refused on request.
    pub failed: usize,
    /// Number of operations that a reset or a loss of power broke off.
    pub torn: usize,
}

impl FlashReport {
    fn of((memory, history): (&FlashMemory, &FlashHistory)) -> FlashReport {
        let count = |is_counted: fn(&FlashOperation) -> bool| {
            history.operations.iter().filter(|operation| is_counted(operation)).count()
        };
        FlashReport {
            erases: memory.erases().to_vec(),
            programmed: count(|operation| {
                operation.ending == FlashEnding::Done && matches!(operation.change, FlashChange::Program { .. })
            }),
            failed: count(|operation| operation.ending == FlashEnding::Failed),
            torn: count(|operation| matches!(operation.ending, FlashEnding::Torn { .. })),
        }
    }
}

/// Number of functions that a report names.
const FUNCTIONS: usize = 20;

impl VirtualBoard {
    /// Returns a report of the run so far.
    ///
    /// # Errors
    /// [`BoardError::LogTable`] if the log of the image cannot be decoded.
    pub fn report(&self) -> Result<Report, BoardError> {
        let log = self.log.lines()?;
        let now = self.machine.now();
        let functions = self.machine.profile().into_iter().take(FUNCTIONS);
        let mut devices = self.devices.lock();
        let (sequences, lost_triggers) = devices.adc_counts();
        let streams: Vec<StreamReport> = devices
            .audio()
            .streams
            .iter()
            .map(|stream| StreamReport {
                start_s: stream.start_s,
                frames: stream.frames.len(),
                underruns: stream.underruns,
                unconnected_frames: stream.unconnected_frames,
            })
            .collect();
        let rate = devices.audio().streams.last().map(|stream| stream.rate);
        let recording = &devices.recording;
        Ok(Report {
            board: self.board.name(),
            cycle_case: match self.machine.pace().case {
                CycleCase::Best => "best",
                CycleCase::Nominal => "nominal",
                CycleCase::Worst => "worst",
            },
            flash_waits: self.machine.pace().flash_waits,
            flash_bytes: self.image.flash_bytes(),
            static_ram_bytes: self.image.static_ram_bytes(),
            stack_bytes: self.stack_bytes(),
            stack_room_bytes: self.stack_room_bytes(),
            seconds: (devices.seconds(now) * 1e6).round() / 1e6,
            core_hz: devices.clocks.core.as_f64(),
            instructions: self.machine.cost().instructions,
            cycles: now,
            idle_cycles: self.account.idle_cycles,
            idle_share: self.account.idle_cycles as f64 / now.max(1) as f64,
            thread_cycles: self.account.thread_cycles,
            interrupts: self.interrupts(),
            functions: functions.map(function).collect(),
            audio: AudioReport {
                rate: rate.map(|rate| format!("{}/{}", rate.numerator(), rate.denominator())),
                rate_hz: rate.map(|rate| rate.as_f64()),
                streams,
                halves: recording.audio_halves.len() as u64,
                late_halves: self.late_halves(&recording.audio_halves),
                worst_load: self.worst_load(&recording.audio_halves),
            },
            adc: AdcReport { sequences, lost_triggers },
            leds: (recording.leds.iter())
                .map(|change| LedReport {
                    at_s: change.at_s,
                    led: devices.wiring.leds[change.led].colour,
                    lit: change.lit,
                })
                .collect(),
            mutes: recording.mutes.iter().map(|change| MuteReport { at_s: change.at_s, mute: change.mute }).collect(),
            volumes: (recording.volumes.iter())
                .map(|change| VolumeReport { at_s: change.at_s, headphones_db: change.headphones_db })
                .collect(),
            resets: (recording.resets.iter())
                .map(|reset| ResetReport {
                    at_s: reset.at_s,
                    cause: match reset.cause {
                        ResetCause::Power => "power",
                        ResetCause::Software => "software",
                        ResetCause::Watchdog => "watchdog",
                    },
                })
                .collect(),
            power_lost_s: self.power_lost_s,
            flash: FlashReport::of(devices.flash_contents()),
            usb: devices.usb_host.report(),
            codec_complaints: devices.codec.as_ref().map(|codec| codec.complaints.clone()).unwrap_or_default(),
            warnings: recording.warnings.clone(),
            log,
        })
    }

    fn stack_bytes(&self) -> Option<u32> {
        self.stack_top()?.checked_sub(self.lowest_stack.min(self.machine.lowest_stack()))
    }

    /// Returns the start of the stack: the first word of the vector table.
    fn stack_top(&self) -> Option<u32> {
        let mut top = [0; 4];
        self.machine.read(virtual_core::FLASH_ADDRESS, &mut top).ok()?;
        Some(u32::from_le_bytes(top))
    }

    fn stack_room_bytes(&self) -> Option<u32> {
        // cortex-m-rt gives this name to the end of the statics, to which the stack may grow down.
        self.stack_top()?.checked_sub(self.machine.symbol("_stack_end")?.address)
    }

    fn interrupts(&self) -> Vec<InterruptReport> {
        let mut interrupts: Vec<InterruptReport> = (self.account.by_number.iter())
            .map(|(&number, activity)| InterruptReport {
                name: exception_name(number),
                count: activity.count,
                cycles: activity.cycles,
                worst_cycles: activity.worst_cycles,
                worst_span_cycles: activity.worst_span,
                mean_latency_cycles: (activity.latencies != 0)
                    .then(|| activity.latency_sum as f64 / activity.latencies as f64),
                worst_latency_cycles: (activity.latencies != 0).then_some(activity.worst_latency),
            })
            .collect();
        interrupts.sort_by_key(|interrupt| std::cmp::Reverse(interrupt.cycles));
        interrupts
    }

    /// Returns the number of halves whose flag rose while that of the half before was still set, or
    /// while the interrupt still handled it.
    fn late_halves(&self, halves: &[AudioHalf]) -> u64 {
        let spans = &self.account.audio_spans;
        let is_late = |half: &&AudioHalf| {
            let next = spans.partition_point(|span| span.1 < half.cycle);
            half.late || spans.get(next).is_some_and(|span| span.0 < half.cycle)
        };
        halves.iter().filter(is_late).count() as u64
    }

    /// Returns the longest run of the audio interrupt as a share of the shortest half.
    fn worst_load(&self, halves: &[AudioHalf]) -> Option<f64> {
        let half_cycles = halves.windows(2).map(|pair| pair[1].cycle - pair[0].cycle).min()?;
        let worst = self.account.audio_spans.iter().map(|span| span.1 - span.0).max()?;
        Some(worst as f64 / half_cycles.max(1) as f64)
    }

    /// Returns the sound that left the I2S as 24-bit stereo frames, and its rate in Hz.
    ///
    /// It begins with the first frame, and pauses between two streams are silence.
    ///
    /// # Errors
    /// [`BoardError::NoSound`] if nothing left the I2S.
    pub fn sound(&self) -> Result<(f64, Vec<[i32; 2]>), BoardError> {
        let mut devices = self.devices.lock();
        let streams = &devices.audio().streams;
        let first = streams.first().ok_or(BoardError::NoSound)?;
        let rate_hz = first.rate.as_f64();
        let mut frames = Vec::new();
        for stream in streams {
            let begins = ((stream.start_s - first.start_s) * rate_hz).round() as usize;
            frames.resize(frames.len().max(begins), [0; 2]);
            frames.extend(stream.frames.iter().map(|frame| frame.map(|sample| sample >> 8)));
        }
        Ok((rate_hz, frames))
    }
}

fn function(cost: FunctionCost) -> FunctionReport {
    FunctionReport { name: cost.name, nominal_cycles: cost.cost.nominal, instructions: cost.cost.instructions }
}
