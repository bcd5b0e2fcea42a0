//! Loudness of a kit's pads relative to each other, and their peaks relative to full scale.

mod k_weighting;

use dsp_core::SampleRate;
use dsp_core::engine::Setup;
use dsp_core::event::{Event, Time};
use dsp_core::fixed::ONE_Q27;
use dsp_core::table::{Kit, TableError};

use crate::render::Performance;
use crate::render::instrument::{self, Output, RenderError, Settings};

pub use k_weighting::loudest_lkfs;

/// Velocity of the strike whose loudness is measured.
pub const VELOCITY: f32 = 0.8;
/// Length of the loudest stretch of which the loudness is taken, in seconds.
pub const WINDOW_S: f64 = 0.4;
/// Number of strikes per second of a roll.
const ROLL_PER_S: f64 = 10.0;
/// Number of strikes of a roll, which lasts 2 s.
const ROLL_STRIKES: u64 = 20;
/// Length of the sound after the last strike, in seconds.
const TAIL_S: f64 = 1.0;

/// Stereo sound of the bus before it is clipped, 1.0 = full scale.
pub type Sound = Vec<[f64; 2]>;

/// Meter of a kit's pads, which the instrument plays at one sample rate.
#[derive(Debug)]
pub struct Meter<'a> {
    kit: &'a kit::Kit,
    table: Kit<'a>,
    rate: SampleRate,
}

impl<'a> Meter<'a> {
    /// Creates the meter of a loaded kit at a sample rate.
    ///
    /// # Errors
    /// [`TableError`] if the kit's bytes are not a valid kit.
    pub fn new(loaded: &'a kit::Loaded, rate: SampleRate) -> Result<Self, TableError> {
        Ok(Self { kit: &loaded.kit, table: Kit::parse(&loaded.binary)?, rate })
    }

    /// Loudness of a pad in LKFS: that of the loudest [`WINDOW_S`] seconds of a strike by the pad's
    /// first striker at [`VELOCITY`].
    ///
    /// # Errors
    /// [`RenderError`] if the kit does not fit the engine.
    pub fn loudness(&self, pad: usize) -> Result<f64, RenderError> {
        let sound = self.play(vec![strike(pad, 0, VELOCITY, 0, 0.0)])?;
        Ok(loudest_lkfs(&sound, self.rate.hz(), WINDOW_S))
    }

    /// Largest sample of a roll at velocity 1, over all strikers of the pad and all positions of
    /// its object, 1.0 = full scale.
    ///
    /// # Errors
    /// [`RenderError`] if the kit does not fit the engine.
    pub fn roll_peak(&self, pad: usize) -> Result<f64, RenderError> {
        let mut largest: f64 = 0.0;
        for (striker, position) in self.ways(pad) {
            let frame = |index: u64| (index as f64 * self.rate.hz() / ROLL_PER_S) as u64;
            let roll = (0..ROLL_STRIKES).map(|index| strike(pad, frame(index), 1.0, striker, position));
            largest = largest.max(peak(&self.play(roll.collect())?));
        }
        Ok(largest)
    }

    /// Sound of a strike at velocity 1, by the striker and at the position that peak highest.
    ///
    /// # Errors
    /// [`RenderError`] if the kit does not fit the engine.
    pub fn hardest_strike(&self, pad: usize) -> Result<Sound, RenderError> {
        let mut hardest = (-1.0, Sound::new());
        for (striker, position) in self.ways(pad) {
            let sound = self.play(vec![strike(pad, 0, 1.0, striker, position)])?;
            let peak = peak(&sound);
            if peak > hardest.0 {
                hardest = (peak, sound);
            }
        }
        Ok(hardest.1)
    }

    /// Pairs of a striker of the pad and a position at which its object's gains are given.
    fn ways(&self, pad: usize) -> Vec<(u8, f32)> {
        let kit = self.kit;
        let Some(pad) = kit.pads.get(pad) else { return Vec::new() };
        let object = kit.objects.iter().find(|object| object.name == pad.object);
        let count = object.map_or(1, kit::Object::position_count);
        // Gains and α are linear between two of the object's positions, so that no place between
        // them peaks higher than both.
        let position = move |index: usize| index as f32 / (count - 1).max(1) as f32;
        let strikers = (0u8..).zip(&pad.strikers).map(|(striker, _)| striker);
        strikers.flat_map(|striker| (0..count).map(move |index| (striker, position(index)))).collect()
    }

    fn play(&self, events: Vec<Event>) -> Result<Sound, RenderError> {
        let performance = Performance::new(events, None, self.kit, self.rate, Some(TAIL_S));
        let settings = Settings { setup: Setup::new(self.rate), block: 128, budget_cycles: None };
        let bus = instrument::render(&self.table, &performance, settings, Output::Bus, |_| {})?;
        Ok(bus.into_iter().map(|frame| frame.map(|x| f64::from(x) / f64::from(ONE_Q27))).collect())
    }
}

fn strike(pad: usize, frame: u64, velocity: f32, striker: u8, position: f32) -> Event {
    let time = Time { frame: 10 + frame, fraction: 0x5000_0000 };
    Event { time, pad: pad as u8, velocity, striker, position, ..Event::default() }
}

/// Largest magnitude of a sample on either side of a sound, 1.0 = full scale.
pub fn peak(sound: &[[f64; 2]]) -> f64 {
    sound.iter().flatten().fold(0.0, |peak, x| peak.max(x.abs()))
}

/// Sum of sounds, each multiplied by its gain; as long as the longest of them.
pub fn sum<'a>(sounds: impl IntoIterator<Item = (f64, &'a Sound)>) -> Sound {
    let mut sum = Sound::new();
    for (gain, sound) in sounds {
        sum.resize(sum.len().max(sound.len()), [0.0; 2]);
        for (sum, x) in sum.iter_mut().zip(sound) {
            *sum = [sum[0] + gain * x[0], sum[1] + gain * x[1]];
        }
    }
    sum
}
