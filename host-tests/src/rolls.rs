//! Rolls without an end: every stage of the engine under strikes that overlap for as long as one likes.

use dsp_core::SampleRate;
use dsp_core::engine::{Engine, Filters, Residuals, STANDARD_CONTACTS, Skipping};
use dsp_core::event::{Action, Event, Time};
use dsp_core::fixed::ONE_Q27;
use dsp_core::noise::Sfc32;
use dsp_core::room::Room;
use dsp_core::table::Kit as KitView;
use kit::text::SourceText;

use crate::scene::load;

/// A kit of four pads that has every stage.
const KIT: &str = include_str!("rolls.toml");

type Stages = (Residuals<5>, Room<i16, 8_192>, Filters<4, 32, 16, 2_048, 16>);
type RollEngine<'k> = Engine<'k, 4, 16, 128, 64, 128, STANDARD_CONTACTS, Stages>;

/// What a roll came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Rolled {
    /// Strikes in all.
    pub strikes: u64,
    /// Rms of each minute begun, 1.0 = full scale.
    pub minute_rms: Vec<f64>,
    /// Largest sample, 1.0 = full scale.
    pub peak: f64,
    /// Seconds from the last strike to exact silence, or `None` where it did not come within a minute.
    pub silent_after_s: Option<f64>,
    /// Hash of all samples but zeros, and of their places.
    pub hash: u64,
}

/// Rolls on all pads for `seconds`, strikes of every strength 8 to 120 ms apart, positions and hands included, then waits for silence; in blocks of `block` frames.
///
/// # Panics
/// If the kit beside this file is wrong.
pub fn roll(seconds: f64, block: usize, mut progress: impl FnMut(f64)) -> Rolled {
    let source = SourceText { file: "rolls.toml".into(), text: KIT.into() };
    let kit = kit::text::parse(&source, |_| Ok(source.clone())).expect("the kit beside this file is right");
    let loaded = load(kit);
    let view = KitView::parse(&loaded.binary).expect("it was built just now");
    let rate = SampleRate::HZ_48000;
    let mut engine: Box<RollEngine<'_>> = Box::new(Engine::new());
    engine.load(&view, rate, Skipping::On).expect("it fits");
    let end = (seconds * rate.hz()) as u64;
    let mut random = Sfc32::new(11, 0);
    let mut uniform = move || f64::from(random.draw()) / 4_294_967_296.0;
    let mut next = [0u64; 4];
    let mut rolled =
        Rolled { strikes: 0, minute_rms: Vec::new(), peak: 0.0, silent_after_s: None, hash: 0xcbf2_9ce4_8422_2325 };
    let mut out = vec![[0; 2]; block];
    let minute = (60.0 * rate.hz()) as u64;
    let (mut energy, mut frames, mut waiting) = (0.0, 0u64, Vec::new());
    while engine.now() < end + minute {
        let (from, to) = (engine.now(), engine.now() + block as u64);
        // Events are drawn in an order that blocks do not change: those of the earliest pad first.
        while let Some((pad, at)) = (0..4u8).zip(next).min_by_key(|(_, at)| *at).filter(|(_, at)| *at < to.min(end)) {
            let velocity = uniform().powi(2) as f32;
            let position = uniform() as f32;
            let kind = uniform();
            let action = match kind {
                ..0.02 => Action::Choke,
                ..0.06 => Action::Release,
                _ => Action::Strike,
            };
            rolled.strikes += u64::from(action == Action::Strike);
            waiting.push(Event { time: Time::at_frame(at), pad, velocity, position, striker: 0, action });
            next[usize::from(pad)] = at + 384 + (5_376.0 * uniform() * uniform()) as u64;
        }
        if from >= end && rolled.silent_after_s.is_none() && engine.is_silent() {
            rolled.silent_after_s = Some((from - end) as f64 / rate.hz());
            break;
        }
        engine.render_bus(&waiting, None, &mut out, |_| {}).expect("the events are in order");
        waiting.clear();
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
