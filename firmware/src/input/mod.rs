//! Piezos and the button, from their pins to events at frames of the output.
//!
//! ```text
//! ADC frame n ──► trigger: decided at n ──► anchor + floor((n - anchor) Q/P) + DELAY_FRAMES ──► event at that frame
//! ```
//!
//! Both clocks come from one crystal, so their ratio Q/P is exact; an anchor says which frames belong together. It is set whenever the ADC is
//! started, and moved when the output has fallen behind.

mod button;
pub mod piezo;

use dsp_core::SampleRate;
use dsp_core::engine::Direct;
use dsp_core::event::Event;
use dsp_core::table::Kit;
use dsp_core::trigger::{self, Buttons, Fault, FrameMap, Mode, Report, Resampler, Trigger, TriggerError};

pub use self::button::Button;
use self::piezo::{CHANNELS, Piezos, RING_FRAMES};
use crate::audio::i2s::HALF_FRAMES;
use crate::board::CLOCKS;
use crate::clock::ADC_RATE_HZ;
use crate::owned::Owned;
use crate::{counters, cycles};

/// From the anchor to the frame where a strike sounds. A strike is seen at the latest a half after it was decided (32 frames), the conversion
/// of the last channel takes 0.4 of a frame, and rounding down to a frame of the output one more; what is left is for interrupts that are a little
/// late.
const DELAY_FRAMES: u64 = HALF_FRAMES as u64 + 2;
/// The same for the direct force: the last of a half's 32 frames needs three frames of the ADC behind it.
const DIRECT_DELAY_FRAMES: u32 = HALF_FRAMES as u32 + 3;

/// A frame of the ADC and the output's frame that was next to be rendered when it was sampled.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    adc: u64,
    output: u64,
}

/// What the inputs have to tell.
#[derive(Clone, Copy, Debug)]
pub enum Told {
    /// Somebody plays.
    Event(Event),
    /// A piezo's channel fails.
    Fault {
        /// Which channel, counted from 0.
        channel: u8,
        /// What is wrong.
        fault: Fault,
    },
    /// It is well again.
    Recovered {
        /// Which channel, counted from 0.
        channel: u8,
    },
}

/// A pad that its piezo drives directly.
struct DirectPad {
    pad: u8,
    /// `None` until the clocks' frames are paired.
    resampler: Option<Resampler>,
    force: [i32; HALF_FRAMES],
}

impl DirectPad {
    /// From now on the resampler's first sample in belongs to its first sample out.
    #[inline(never)] // a kilobyte that must not weigh on the stack of every half
    fn start(&mut self) {
        self.resampler = Resampler::new(adc_rate(), CLOCKS.sample_rate(), DIRECT_DELAY_FRAMES).ok();
    }
}

/// All inputs. There is one.
pub struct Inputs {
    piezos: Piezos,
    button: Button,
    trigger: Trigger<CHANNELS>,
    buttons: Buttons<1>,
    map: FrameMap,
    anchor: Option<Anchor>,
    direct: Option<DirectPad>,
}

#[unsafe(link_section = ".hot")]
static INPUTS: Owned<Inputs> = Owned::empty();

/// What a kit says about the inputs.
pub struct Settings {
    trigger: Trigger<CHANNELS>,
    buttons: Buttons<1>,
    map: FrameMap,
    /// The first pad in direct mode: the engine takes one force.
    direct_pad: Option<u8>,
}

impl Settings {
    /// Derives the trigger from a kit.
    ///
    /// # Errors
    /// [`TriggerError`].
    #[inline(never)] // as `Inputs::place`
    pub fn of(kit: &Kit<'_>) -> Result<Self, TriggerError> {
        let rate = adc_rate();
        let is_direct = |settings: trigger::Settings| settings.mode == Mode::Direct;
        Ok(Self {
            direct_pad: (0..=u8::MAX)
                .zip(trigger::Settings::of_kit(kit))
                .find(|&(_, pad)| is_direct(pad))
                .map(|(pad, _)| pad),
            trigger: Trigger::from_kit(kit, rate)?,
            buttons: Buttons::from_kit(kit, rate)?,
            map: FrameMap::new(rate, CLOCKS.sample_rate())?,
        })
    }
}

fn adc_rate() -> SampleRate {
    SampleRate::new(ADC_RATE_HZ, 1).unwrap_or(SampleRate::HZ_48000)
}

impl Inputs {
    /// The one set of inputs, not started yet.
    ///
    /// # Safety
    /// Called once.
    #[inline(never)] // what is built here and moved to its place must not weigh on the stack of the whole program
    pub unsafe fn place(piezos: Piezos, button: Button, settings: Settings) -> &'static mut Self {
        let Settings { trigger, buttons, map, direct_pad } = settings;
        button.listen();
        let direct = direct_pad.map(|pad| DirectPad { pad, resampler: None, force: [0; HALF_FRAMES] });
        // SAFETY: the caller's word.
        unsafe { INPUTS.fill(Self { piezos, button, trigger, buttons, map, anchor: None, direct }) }
    }

    /// Takes what has come since the last half. `now` is the output's frame that is rendered next; `missed` halves of the output have
    /// been lost since the last call.
    pub fn take(&mut self, now: u64, missed: u32, mut tell: impl FnMut(Told)) {
        let Some(anchor) = &mut self.anchor else { return self.start(now) };
        // What is rendered from now on is heard later by as much.
        anchor.output = anchor.output.saturating_sub(u64::from(missed) * HALF_FRAMES as u64);
        let anchor = *anchor;
        if missed as usize >= RING_FRAMES / HALF_FRAMES - 1 {
            counters::LOST_ADC_FRAMES.add((missed + 1) * HALF_FRAMES as u32);
            return self.start(now);
        }
        // A half without a frame: whatever the reason, the sampler stands.
        let Some(parts) = self.piezos.take().ok().filter(|[first, _]| !first.is_empty()) else {
            counters::ADC_RESTARTS.add(1);
            return self.start(now);
        };
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
        self.take_button(anchor, tell);
    }

    fn take_button(&mut self, anchor: Anchor, mut tell: impl FnMut(Told)) {
        let (map, now) = (self.map, self.trigger.now());
        let mut sample = |frame, is_down| {
            self.buttons.sample(0, frame, is_down, |found| {
                tell(Told::Event(found.event(anchor.output_frame(map, found.frame))));
            });
        };
        if let Some(at) = self.button.touched() {
            let age = cycles::now().wrapping_sub(at) / CYCLES_PER_ADC_FRAME;
            // Not before what the last half saw.
            sample(now.saturating_sub(u64::from(age).min(HALF_FRAMES as u64)), true);
        }
        sample(now, self.button.is_pressed());
    }

    /// The force of a pad that its piezo drives directly, for the half that is rendered next.
    pub fn direct(&mut self) -> Option<Direct<'_>> {
        let DirectPad { pad, resampler, force } = self.direct.as_mut()?;
        resampler.as_mut()?.pull(force);
        Some(Direct { pad: *pad, force })
    }

    fn start(&mut self, now: u64) {
        self.piezos.start();
        if let Some(direct) = &mut self.direct {
            direct.start();
        }
        self.anchor = Some(Anchor { adc: self.trigger.now(), output: now });
    }

    /// The output's stream has begun anew: the clocks' frames must be paired again.
    pub fn forget_anchor(&mut self) {
        self.anchor = None;
    }
}

const CYCLES_PER_ADC_FRAME: u32 = CLOCKS.core_hz() / ADC_RATE_HZ;

impl Anchor {
    /// Where a strike that was decided at an ADC frame sounds.
    fn output_frame(self, map: FrameMap, adc_frame: u64) -> u64 {
        self.output + map.output_frame(adc_frame.saturating_sub(self.adc)) + DELAY_FRAMES
    }
}
