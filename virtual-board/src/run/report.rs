//! What a run shows, as a structure that serialises to the JSON of `malleus board run --report json` (docs/json.md).

use std::path::Path;

use serde::Serialize;
use virtual_core::{CycleCase, FunctionCost};

use super::account::exception_name;
use super::{LogLine, VirtualBoard};
use crate::devices::AudioHalf;
use crate::devices::rcc::ResetCause;
use crate::error::BoardError;

/// Everything that a run shows but its sound. Cycles are those of the chosen column of the cycle model; times are seconds from power-on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The board.
    pub board: &'static str,
    /// `best`, `nominal` or `worst`, and whether the waits of flash are added.
    pub cycle_case: &'static str,
    /// Whether the waits of flash are in the cycles.
    pub flash_waits: bool,
    /// Bytes of the image in flash.
    pub flash_bytes: u32,
    /// Bytes of RAM in use before the first call.
    pub static_ram_bytes: u32,
    /// The most stack that was used.
    pub stack_bytes: Option<u32>,
    /// How much the memory map leaves it; `None` where the image has no such symbols.
    pub stack_room_bytes: Option<u32>,
    /// How long the board ran.
    pub seconds: f64,
    /// The core's clock at the end, in Hz.
    pub core_hz: f64,
    /// Instructions executed.
    pub instructions: u64,
    /// Cycles since power-on.
    pub cycles: u64,
    /// Those of them in which the core slept: between two reports, the difference tells the load of that time.
    pub idle_cycles: u64,
    /// The one by the other.
    pub idle_share: f64,
    /// Cycles in thread mode, awake.
    pub thread_cycles: u64,
    /// Every interrupt and exception that ran, the dearest first.
    pub interrupts: Vec<InterruptReport>,
    /// The dearest functions, without what they called.
    pub functions: Vec<FunctionReport>,
    /// The sound.
    pub audio: AudioReport,
    /// The ADC.
    pub adc: AdcReport,
    /// LEDs that went on or off.
    pub leds: Vec<LedReport>,
    /// When the converter became audible or mute.
    pub mutes: Vec<MuteReport>,
    /// Resets after power-on.
    pub resets: Vec<ResetReport>,
    /// What the codec's driver did wrong.
    pub codec_complaints: Vec<String>,
    /// What is not an error, and yet wrong.
    pub warnings: Vec<String>,
    /// The log.
    pub log: Vec<LogLine>,
}

/// An interrupt or exception.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InterruptReport {
    /// Its name in the vector table.
    pub name: String,
    /// How often it ran.
    pub count: u64,
    /// Cycles in all, without what preempted it.
    pub cycles: u64,
    /// The most that one run took, without what preempted it.
    pub worst_cycles: u64,
    /// The longest from entry to return, preemptions included.
    pub worst_span_cycles: u64,
    /// From the line's assertion to the handler's first instruction, mean; absent where a program pends it itself.
    pub mean_latency_cycles: Option<f64>,
    /// The longest of these.
    pub worst_latency_cycles: Option<u64>,
}

/// A function.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FunctionReport {
    /// Its demangled name.
    pub name: String,
    /// Nominal cycles, memory without waits.
    pub nominal_cycles: u64,
    /// Instructions.
    pub instructions: u64,
}

/// The sound that left the board.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AudioReport {
    /// Frames a second of the last stream: exactly, as a ratio of whole Hz.
    pub rate: Option<String>,
    /// The same as a number.
    pub rate_hz: Option<f64>,
    /// Stretches without interruption.
    pub streams: Vec<StreamReport>,
    /// Halves of the DMA's buffer that began to play.
    pub halves: u64,
    /// How many of them the program had not finished with.
    pub late_halves: u64,
    /// The longest run of the audio interrupt, entry to return, as a share of a half's time.
    pub worst_load: Option<f64>,
}

/// One stretch of sound without interruption.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StreamReport {
    /// When its first bit stood on the pin.
    pub start_s: f64,
    /// Its length.
    pub frames: usize,
    /// Half-words that were sent twice because none had come.
    pub underruns: u64,
    /// Frames that no pin carried.
    pub unconnected_frames: u64,
}

/// The ADC.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AdcReport {
    /// Sequences of conversions that began.
    pub sequences: u64,
    /// Triggers that came while one ran, and were lost.
    pub lost_triggers: u64,
}

/// A LED that went on or off.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LedReport {
    /// When.
    pub at_s: f64,
    /// Its colour.
    pub led: &'static str,
    /// Whether it is lit from then on.
    pub lit: bool,
}

/// The converter became audible or mute.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MuteReport {
    /// When.
    pub at_s: f64,
    /// Whether it is mute from then on.
    pub mute: bool,
}

/// A reset of the chip.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResetReport {
    /// When.
    pub at_s: f64,
    /// `software` or `watchdog`.
    pub cause: &'static str,
}

/// Functions that a report names.
const FUNCTIONS: usize = 20;

impl VirtualBoard {
    /// What the run has shown so far.
    ///
    /// # Errors
    /// [`BoardError::LogTable`] if the image's log cannot be decoded.
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
            cycle_case: match self.case {
                CycleCase::Best => "best",
                CycleCase::Nominal => "nominal",
                CycleCase::Worst => "worst",
            },
            flash_waits: self.flash_waits,
            flash_bytes: self.image.flash_bytes(),
            static_ram_bytes: self.image.static_ram_bytes(),
            stack_bytes: self.stack_bytes(),
            stack_room_bytes: self.stack_room_bytes(),
            seconds: devices.seconds(now),
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
            codec_complaints: devices.codec.as_ref().map(|codec| codec.complaints.clone()).unwrap_or_default(),
            warnings: recording.warnings.clone(),
            log,
        })
    }

    fn stack_bytes(&self) -> Option<u32> {
        self.stack_top()?.checked_sub(self.lowest_stack.min(self.machine.lowest_stack()))
    }

    /// The first word of the vector table is where the stack starts.
    fn stack_top(&self) -> Option<u32> {
        let mut top = [0; 4];
        self.machine.read(virtual_core::FLASH_ADDRESS, &mut top).ok()?;
        Some(u32::from_le_bytes(top))
    }

    fn stack_room_bytes(&self) -> Option<u32> {
        // cortex-m-rt's name: the stack may grow down to the last of the statics.
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

    /// Halves whose flag came up while the program still had the last one's, or was still handling it.
    fn late_halves(&self, halves: &[AudioHalf]) -> u64 {
        let spans = &self.account.audio_spans;
        let is_late = |half: &&AudioHalf| {
            let next = spans.partition_point(|span| span.1 < half.cycle);
            half.late || spans.get(next).is_some_and(|span| span.0 < half.cycle)
        };
        halves.iter().filter(is_late).count() as u64
    }

    fn worst_load(&self, halves: &[AudioHalf]) -> Option<f64> {
        let half_cycles = halves.windows(2).map(|pair| pair[1].cycle - pair[0].cycle).min()?;
        let worst = self.account.audio_spans.iter().map(|span| span.1 - span.0).max()?;
        Some(worst as f64 / half_cycles.max(1) as f64)
    }

    /// Writes all that left the I2S as a 24-bit stereo WAV file. Its rate is rounded to whole Hz; the exact one is in the report. The file begins with
    /// the first frame; pauses between two streams are silence.
    ///
    /// # Errors
    /// [`BoardError::Wave`] if nothing left the I2S, or the file cannot be written.
    pub fn write_wav(&self, path: &Path) -> Result<(), BoardError> {
        let wrong = |reason: String| BoardError::Wave { path: path.to_owned(), reason };
        let streams = self.streams();
        let Some(first) = streams.first() else { return Err(wrong("no sound left the I2S".to_owned())) };
        let sample_rate = first.rate.as_f64().round() as u32;
        let spec =
            hound::WavSpec { channels: 2, sample_rate, bits_per_sample: 24, sample_format: hound::SampleFormat::Int };
        let mut writer = hound::WavWriter::create(path, spec).map_err(|error| wrong(error.to_string()))?;
        let mut written = 0_usize;
        for stream in &streams {
            let begins = ((stream.start_s - first.start_s) * first.rate.as_f64()).round() as usize;
            let silence = std::iter::repeat_n([0; 2], begins.saturating_sub(written));
            for frame in silence.chain(stream.frames.iter().copied()) {
                written += 1;
                for sample in frame {
                    writer.write_sample(sample >> 8).map_err(|error| wrong(error.to_string()))?;
                }
            }
        }
        writer.finalize().map_err(|error| wrong(error.to_string()))
    }
}

fn function(cost: FunctionCost) -> FunctionReport {
    FunctionReport { name: cost.name, nominal_cycles: cost.cost.nominal, instructions: cost.cost.instructions }
}
