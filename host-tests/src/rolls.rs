//! Endless rolls: every stage of the engine under overlapping strikes, for any length of time.

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::{Action, Event, Time};
use dsp_core::fixed::ONE_Q27;
use dsp_core::noise::Sfc32;
use dsp_core::table::Kit as KitView;
use kit::Loaded;
use kit::text::SourceText;

use crate::lent;
use crate::scene::load;

/// A kit of four pads that has every stage.
const KIT: &str = include_str!("rolls.toml");

/// The kit of the rolls.
///
/// # Panics
/// If the kit beside this file is wrong.
pub fn kit() -> Loaded {
    let source = SourceText { file: "rolls.toml".into(), text: KIT.into() };
    load(kit::text::parse(&source, |_| Ok(source.clone())).expect("the kit beside this file is right"))
}

/// Source of the strikes on all four pads.
///
/// Strikes of every strength fall 8 to 120 ms apart on each pad, at any position. Some are replaced
/// by a choke or a release.
#[derive(Debug)]
pub struct Hands {
    random: Sfc32,
    next: [u64; 4],
}

impl Hands {
    /// Source at the first frame, before any strike.
    pub fn new() -> Self {
        Self { random: Sfc32::new(11, 0), next: [0; 4] }
    }

    fn uniform(&mut self) -> f64 {
        f64::from(self.random.draw()) / 4_294_967_296.0
    }

    /// Events before a frame, the earliest first. Their order does not depend on the block size.
    pub fn until(&mut self, frame: u64) -> Vec<Event> {
        let mut events = Vec::new();
        while let Some((pad, at)) = (0..4u8).zip(self.next).min_by_key(|(_, at)| *at).filter(|(_, at)| *at < frame) {
            let velocity = self.uniform().powi(2) as f32;
            let position = self.uniform() as f32;
            let action = match self.uniform() {
                ..0.02 => Action::Choke,
                ..0.06 => Action::Release,
                _ => Action::Strike,
            };
            events.push(Event { time: Time::at_frame(at), pad, velocity, position, striker: 0, action });
            self.next[usize::from(pad)] = at + 384 + (5_376.0 * self.uniform() * self.uniform()) as u64;
        }
        events
    }
}

impl Default for Hands {
    fn default() -> Self {
        Self::new()
    }
}

/// Figures of a roll.
#[derive(Clone, Debug, PartialEq)]
pub struct Rolled {
    /// Number of strikes.
    pub strikes: u64,
    /// Rms of each minute, and of a last part of a minute, 1.0 = full scale.
    pub minute_rms: Vec<f64>,
    /// Largest sample, 1.0 = full scale.
    pub peak: f64,
    /// Seconds from the end of the roll to exact silence; `None` if it takes more than a minute.
    pub silent_after_s: Option<f64>,
    /// Hash of all samples but zeros, and of their places.
    pub hash: u64,
}

/// Rolls on all pads for `seconds` in blocks of `block` frames, then waits for silence.
///
/// [`Hands`] gives the strikes, chokes and releases.
/// # Panics
/// If the kit beside this file is wrong.
pub fn roll(seconds: f64, block: usize, mut progress: impl FnMut(f64)) -> Rolled {
    let loaded = kit();
    let view = KitView::parse(&loaded.binary).expect("it was built just now");
    let rate = SampleRate::HZ_48000;
    let mut engine = lent::engine(&view, rate, Skipping::On).expect("it can be played");
    let end = (seconds * rate.hz()) as u64;
    let mut hands = Hands::new();
    let mut rolled =
        Rolled { strikes: 0, minute_rms: Vec::new(), peak: 0.0, silent_after_s: None, hash: 0xcbf2_9ce4_8422_2325 };
    let mut out = vec![[0; 2]; block];
    let minute = (60.0 * rate.hz()) as u64;
    let (mut energy, mut frames) = (0.0, 0u64);
    while engine.now() < end + minute {
        let (from, to) = (engine.now(), engine.now() + block as u64);
        let events = hands.until(to.min(end));
        rolled.strikes += events.iter().filter(|event| event.action == Action::Strike).count() as u64;
        if from >= end && rolled.silent_after_s.is_none() && engine.is_silent() {
            rolled.silent_after_s = Some((from - end) as f64 / rate.hz());
            break;
        }
        engine.render_bus(&events, None, &mut out, |_| {}).expect("the events are in order");
        for (sample, place) in out.as_flattened().iter().zip(2 * from..).filter(|(sample, _)| **sample != 0) {
            let value = f64::from(*sample) / f64::from(ONE_Q27);
            rolled.peak = rolled.peak.max(value.abs());
            energy += value * value;
            rolled.hash = (rolled.hash ^ u64::from(*sample as u32) ^ place << 32).wrapping_mul(0x0100_0000_01b3);
        }
        frames += block as u64;
        if frames >= minute || to >= end && from < end {
            if from < end {
                rolled.minute_rms.push((energy / (2 * frames) as f64).sqrt());
            }
            (energy, frames) = (0.0, 0);
        }
        progress(from as f64 / rate.hz());
    }
    rolled
}
