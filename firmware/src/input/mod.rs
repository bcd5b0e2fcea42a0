//! Inputs: piezos and the button, from their pins to events at frames of the output.
//!
//! ```text
//! ADC frame n ──► trigger: decided at n
//!             ──► anchor + floor((n - anchor) Q/P) + DELAY_FRAMES ──► event at that frame
//! ```
//!
//! The clocks of ADC and output come from one crystal, so their ratio Q/P is exact. An anchor pairs
//! one frame of each. It is set when the ADC is started, and moved when halves were missed.

pub mod button;
pub mod piezo;

use dsp_core::SampleRate;
use dsp_core::engine::Direct;
use dsp_core::event::Event;
use dsp_core::table::Kit;
use dsp_core::trigger::{self, Buttons, Fault, FrameMap, Mode, Report, Resampler, Trigger, TriggerError};

use self::button::Button;
use self::piezo::{CHANNELS, Piezos, RING_FRAMES};
use crate::board::CLOCKS;
use crate::clock::ADC_RATE_HZ;
use crate::half::HALF_FRAMES;
use crate::owned::Owned;
use crate::{counters, cycles};

/// Number of frames from the decision of a strike to its sound.
///
/// A strike is seen at most a half (32 frames) after it was decided. The conversion of the last
/// channel takes 0.4 of a frame, and rounding down to a frame of the output takes one more. The
/// rest is for interrupts that are a little late.
const DELAY_FRAMES: u64 = HALF_FRAMES as u64 + 2;
/// Number of frames from a sample of a direct force to its sound: the last of a half's 32 frames is
/// interpolated from three frames of the ADC after it.
const DIRECT_DELAY_FRAMES: u32 = HALF_FRAMES as u32 + 3;

/// Frame of the ADC, and the frame of the output that was to be rendered next when it was sampled.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    adc: u64,
    output: u64,
}

/// Report of the inputs.
#[derive(Clone, Copy, Debug)]
pub enum Told {
    /// A pad was struck, choked or released.
    Event(Event),
    /// The channel of a piezo fails.
    Fault {
        /// Number of the channel, from 0.
        channel: u8,
        /// Fault of the channel.
        fault: Fault,
    },
    /// The channel of a piezo works again.
    Recovered {
        /// Number of the channel, from 0.
        channel: u8,
    },
}

/// Pad that its piezo drives directly.
struct DirectPad {
    pad: u8,
    /// Resampler from ADC to output, or `None` until an anchor is set.
    resampler: Option<Resampler>,
    /// Force in the half that is rendered next.
    force: [i32; HALF_FRAMES],
}

impl DirectPad {
    fn new(pad: u8) -> Self {
        Self { pad, resampler: None, force: [0; HALF_FRAMES] }
    }

    /// Pairs the next sample of the ADC with the next frame of the output.
    // Not inlined: its kilobyte must not add to the stack of every half.
    #[inline(never)]
    fn start(&mut self) {
        self.resampler = Resampler::new(adc_rate(), CLOCKS.sample_rate(), DIRECT_DELAY_FRAMES).ok();
    }
}

/// Inputs of the board. There is one set.
pub struct Inputs {
    piezos: Piezos,
    button: Button,
    trigger: Trigger<CHANNELS>,
    buttons: Buttons<1>,
    map: FrameMap,
    anchor: Option<Anchor>,
    /// True until the first frames since a start have come.
    is_starting: bool,
    direct: Option<DirectPad>,
    /// Inputs at which a piezo was found.
    found: [bool; CHANNELS],
}

#[unsafe(link_section = ".hot")]
static INPUTS: Owned<Inputs> = Owned::empty();

/// Settings of the board that go before those of the kit, piezo 0 first.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// Softest peak that is a strike, of half the ADC's range.
    pub thresholds: [Option<f32>; CHANNELS],
    /// Exponent of the velocity curve.
    pub exponents: [Option<f32>; CHANNELS],
}

impl Overrides {
    fn apply(&self, pad: trigger::Settings) -> trigger::Settings {
        let of = |values: &[Option<f32>; CHANNELS]| values.get(usize::from(pad.channel)).copied().flatten();
        trigger::Settings {
            threshold: of(&self.thresholds).unwrap_or(pad.threshold),
            velocity_exponent: of(&self.exponents).unwrap_or(pad.velocity_exponent),
            ..pad
        }
    }
}

/// Settings that a kit makes for the inputs.
pub struct Settings {
    trigger: Trigger<CHANNELS>,
    buttons: Buttons<1>,
    map: FrameMap,
    /// Number of the first pad in direct mode. The engine takes one force, so others are ignored.
    direct_pad: Option<u8>,
}

impl Settings {
    /// Checks the settings of a kit and those of the board.
    ///
    /// # Errors
    /// [`TriggerError`] if a trigger or a button cannot be set as the kit says.
    // Not inlined: the settings that are built here must not add to the stack of a load.
    #[inline(never)]
    pub fn check(kit: &Kit<'_>, board: &Overrides) -> Result<(), TriggerError> {
        Self::of(kit, board).map(drop)
    }

    /// Derives the settings from a kit and those of the board.
    ///
    /// # Errors
    /// [`TriggerError`] if a trigger or a button of the kit cannot be set as the kit says.
    fn of(kit: &Kit<'_>, board: &Overrides) -> Result<Self, TriggerError> {
        let rate = adc_rate();
        let is_direct = |settings: trigger::Settings| settings.mode == Mode::Direct;
        Ok(Self {
            direct_pad: (0..=u8::MAX)
                .zip(trigger::Settings::of_kit(kit))
                .find(|&(_, pad)| is_direct(pad))
                .map(|(pad, _)| pad),
            trigger: Trigger::new(trigger::Settings::of_kit(kit).map(|pad| board.apply(pad)), rate)?,
            buttons: Buttons::from_kit(kit, rate)?,
            map: FrameMap::new(rate, CLOCKS.sample_rate())?,
        })
    }
}

fn adc_rate() -> SampleRate {
    SampleRate::new(ADC_RATE_HZ, 1).unwrap_or(SampleRate::HZ_48000)
}

impl Inputs {
    /// Makes the one set of inputs, not started.
    ///
    /// # Errors
    /// [`TriggerError`] if a trigger or a button cannot be set as the kit says.
    ///
    /// # Safety
    /// This is called once.
    // Not inlined: the inputs are built here and moved to their place, and must not add to the
    // stack of the whole program.
    #[inline(never)]
    pub unsafe fn place(
        mut piezos: Piezos,
        button: Button,
        kit: &Kit<'_>,
        board: &Overrides,
    ) -> Result<&'static mut Self, TriggerError> {
        let found = piezos.find();
        for (channel, found) in found.into_iter().enumerate() {
            match found {
                true => defmt::info!("piezo {=usize}: found", channel),
                false => defmt::info!("piezo {=usize}: none, or no bias at its pin; not listened to", channel),
            }
        }
        button.listen();
        let Settings { trigger, buttons, map, direct_pad } = Settings::of(kit, board)?;
        let direct = direct_pad.map(DirectPad::new);
        // SAFETY: the caller promises to call this once, so nothing else uses the memory.
        let inputs = unsafe {
            INPUTS.fill(Self { piezos, button, trigger, buttons, map, anchor: None, is_starting: false, direct, found })
        };
        inputs.disconnect_open_inputs();
        Ok(inputs)
    }

    /// Changes the settings to those of another kit, or to others of the board. The inputs must be
    /// started anew ([`forget_anchor`](Self::forget_anchor)).
    ///
    /// # Errors
    /// [`TriggerError`] if a trigger or a button cannot be set as the kit says. Nothing changes
    /// then.
    // Not inlined: the settings that are built here must not add to the stack of a load.
    #[inline(never)]
    pub fn set(&mut self, kit: &Kit<'_>, board: &Overrides) -> Result<(), TriggerError> {
        let Settings { trigger, buttons, map, direct_pad } = Settings::of(kit, board)?;
        (self.trigger, self.buttons, self.map) = (trigger, buttons, map);
        self.direct = direct_pad.map(DirectPad::new);
        self.disconnect_open_inputs();
        Ok(())
    }

    fn disconnect_open_inputs(&mut self) {
        for (channel, found) in self.found.into_iter().enumerate() {
            if !found {
                self.trigger.disconnect(channel);
            }
        }
    }

    /// Reports by `tell` all that has happened since the last call.
    ///
    /// `now` is the frame of the output that is rendered next. `missed` is the number of halves of
    /// the output that were missed since the last call.
    pub fn take(&mut self, now: u64, missed: u32, mut tell: impl FnMut(Told)) {
        let taken = cycles::now();
        let Some(anchor) = &mut self.anchor else { return self.start(now, taken) };
        // Sound that is rendered from now on is heard later by the missed halves.
        anchor.output = anchor.output.saturating_sub(u64::from(missed) * HALF_FRAMES as u64);
        let anchor = *anchor;
        if missed as usize >= RING_FRAMES / HALF_FRAMES - 1 {
            counters::LOST_ADC_FRAMES.add((missed + 1) * HALF_FRAMES as u32);
            return self.start(now, taken);
        }
        // No frame in a half means that the ADC has stopped, whatever the reason.
        let Some(parts) = self.piezos.take().ok().filter(|[first, _]| !first.is_empty()) else {
            counters::ADC_RESTARTS.add(1);
            return self.start(now, taken);
        };
        if core::mem::take(&mut self.is_starting) {
            // The first block is a frame short. Without it all others begin where a tick of the
            // trigger does, which costs half as much in silence.
            let passed = parts.iter().map(|part| part.len() as u64).sum();
            self.anchor = Some(Anchor { output: anchor.output + self.map.output_frame(passed), ..anchor });
            if let Some(direct) = &mut self.direct {
                direct.start();
            }
            return;
        }
        let (map, direct) = (self.map, &mut self.direct);
        let mut hear = |report: Report<'_>| match report {
            Report::Strike(found) => tell(Told::Event(found.event(anchor.output_frame(map, found.frame)))),
            Report::Force { pad, samples } => {
                let direct = direct.as_mut().filter(|direct| direct.pad == pad);
                if let Some(resampler) = direct.and_then(|direct| direct.resampler.as_mut()) {
                    resampler.push(samples);
                }
            }
            Report::Fault { channel, fault, .. } => tell(Told::Fault { channel, fault }),
            Report::Recovered { channel, .. } => tell(Told::Recovered { channel }),
        };
        for part in parts {
            self.trigger.process(part, &mut hear);
        }
        self.take_button(anchor, taken, tell);
    }

    /// Reports a press. `taken` is the time in core cycles up to which the frames of the ADC have
    /// been processed.
    fn take_button(&mut self, anchor: Anchor, taken: u32, mut tell: impl FnMut(Told)) {
        let (map, now) = (self.map, self.trigger.now());
        let mut sample = |frame, is_down| {
            self.buttons.sample(0, frame, is_down, |found| {
                tell(Told::Event(found.event(anchor.output_frame(map, found.frame))));
            });
        };
        // The level is read first: a contact that closes behind it is noted with its time.
        let is_pressed = self.button.is_pressed();
        if let Some(at) = self.button.touched_before(taken) {
            let age = taken.wrapping_sub(at) / CYCLES_PER_ADC_FRAME;
            // The contact must not lie before the frames that the last call has processed.
            sample(now.saturating_sub(u64::from(age).min(HALF_FRAMES as u64)), true);
        }
        if !self.button.is_touched() {
            sample(now, is_pressed);
        }
    }

    /// Returns the force of the pad in direct mode for the half that is rendered next.
    pub fn direct(&mut self) -> Option<Direct<'_>> {
        let DirectPad { pad, resampler, force } = self.direct.as_mut()?;
        resampler.as_mut()?.pull(force);
        Some(Direct { pad: *pad, force })
    }

    /// Starts or restarts the ADC at the time `taken` in core cycles, and pairs its next frame with
    /// the frame `now` of the output.
    fn start(&mut self, now: u64, taken: u32) {
        self.piezos.start(taken);
        self.is_starting = true;
        self.anchor = Some(Anchor { adc: self.trigger.now(), output: now });
    }

    /// Forgets the anchor, because the stream of the output was restarted.
    pub fn forget_anchor(&mut self) {
        self.anchor = None;
    }
}

const CYCLES_PER_ADC_FRAME: u32 = CLOCKS.core_hz() / ADC_RATE_HZ;

impl Anchor {
    /// Returns the frame of the output at which a strike sounds that was decided at `adc_frame`.
    fn output_frame(self, map: FrameMap, adc_frame: u64) -> u64 {
        self.output + map.output_frame(adc_frame.saturating_sub(self.adc)) + DELAY_FRAMES
    }
}
