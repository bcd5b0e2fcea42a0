//! Content of a kit, as plain owned values that mirror the keys of the text form.
//!
//! Nothing is checked here; [`crate::binary::build`] checks. Ranges are those of
//! [`dsp_core::table::range`].

use dsp_core::trigger::Settings;

use crate::filters::{Biquads, DynamicFilter, ModesGo};
use crate::surface::{ObjectSurface, Roll, Scrape, Surface};

/// Kit: objects and strikers, bound to pads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Kit {
    /// Name of the kit: 1 to 24 printable ASCII characters without comma and quote, and without a
    /// space at its ends.
    ///
    /// Names of objects, strikers and pads obey the same rule, and no two items of one kind share
    /// one.
    pub name: String,
    /// Objects that are struck.
    pub objects: Vec<Object>,
    /// Strikers that strike them.
    pub strikers: Vec<Striker>,
    /// Pads, each of which plays one object with its strikers.
    pub pads: Vec<Pad>,
    /// Stationary noise behind all pads (diffimpact §3.4), if any.
    pub background: Option<Background>,
    /// Bands of the room round all pads (diffimpact §3.4), from the lowest up; empty without a
    /// room.
    pub room: Vec<RoomBand>,
    /// Volume of a board's headphones in dB, if the kit gives one; else it is
    /// [`DEFAULT_HEADPHONE_DB`](dsp_core::table::range::DEFAULT_HEADPHONE_DB).
    pub headphone_db: Option<f32>,
    /// Surfaces of objects.
    pub surfaces: Vec<Surface>,
}

/// Band of the room's response to an impulse: noise that decays.
///
/// Its power is `gain² e^(−2 decay_per_s t)`, and its energy `gain²/(2 decay_per_s)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoomBand {
    /// Lower edge in Hz; 0 for the first band.
    ///
    /// A band ends at the lower edge of the next one, the last band at half the sample rate.
    pub from_hz: f32,
    /// Initial gain g in 1/√s.
    pub gain: f32,
    /// Decay rate d in 1/s; T60 = ln(1000)/d.
    pub decay_per_s: f32,
}

impl RoomBand {
    /// Creates a band from its lower edge in Hz, its T60 in seconds, and its energy in dB relative
    /// to that of the direct sound in the band.
    pub fn new(from_hz: f64, t60_s: f64, energy_db: f64) -> Self {
        let decay_per_s = 1000f64.ln() / t60_s;
        let gain = (2.0 * decay_per_s * 10f64.powf(energy_db / 10.0)).sqrt();
        Self { from_hz: from_hz as f32, gain: gain as f32, decay_per_s: decay_per_s as f32 }
    }

    /// T60 of the band in seconds.
    pub fn t60_s(&self) -> f64 {
        1000f64.ln() / f64::from(self.decay_per_s)
    }

    /// Energy in dB relative to that of the direct sound in the band.
    pub fn energy_db(&self) -> f64 {
        10.0 * (f64::from(self.gain).powi(2) / (2.0 * f64::from(self.decay_per_s))).log10()
    }
}

/// Residual of an object, heard beside its modes: bands of decaying noise that each strike starts
/// (physics-diffusion eq. 5, 6).
#[derive(Clone, Debug, PartialEq)]
pub struct Residual {
    /// Seed of the noise. Two objects with equal seeds still have different noise.
    pub seed: u32,
    /// Edges of the bands in Hz, rising: one more than bands, at most 101.
    pub edges_hz: Vec<f32>,
    /// Rms w of each band at t = 0 (1.0 = full scale) of a strike whose peak force is the reference
    /// force.
    pub weight: Vec<f32>,
    /// Decay rate γ of each band in dB/s.
    pub decay_db_per_s: Vec<f32>,
}

/// Stationary noise with a gain for each band.
#[derive(Clone, Debug, PartialEq)]
pub struct Background {
    /// Seed of the noise.
    pub seed: u32,
    /// Edges of the bands in Hz, rising: one more than bands, at most 101.
    pub edges_hz: Vec<f32>,
    /// Rms of each band (1.0 = full scale).
    pub weight: Vec<f32>,
}

/// Acceleration sound of an object: its factor α, output per newton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Acceleration {
    /// A given number.
    Factor(f32),
    /// Derived from the modes at the rate at which they are rendered, so that a constant force
    /// makes no sound ([`dsp_core::radiation`]).
    ///
    /// The strikers' own modes are balanced together with the object's.
    Balance,
}

impl Acceleration {
    /// No acceleration sound.
    pub const NONE: Self = Self::Factor(0.0);

    /// The word in the text form that stands for [`Acceleration::Balance`].
    pub const BALANCE_KEY: &str = "balance";

    /// The given number; `None` if the factor is derived.
    pub fn factor(self) -> Option<f32> {
        match self {
            Self::Factor(factor) => Some(factor),
            Self::Balance => None,
        }
    }
}

/// Object that is struck: a modal bank (diffimpact eq. 1, `IR_object`) and its acceleration sound.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Name of the object.
    pub name: String,
    /// Origin of the object's numbers, at most 65535 bytes of UTF-8.
    pub source: String,
    /// Licence of the object's numbers, at most 65535 bytes of UTF-8.
    pub licence: String,
    /// Force in newtons for which 1.0 on the force bus stands; 1 for an object without calibration.
    pub reference_force: f32,
    /// Acceleration sound (diffimpact eq. 1).
    pub acceleration: Acceleration,
    /// Modes, all with the same number of gains.
    pub modes: Vec<Mode>,
    /// Noise beside the modes, if any.
    pub residual: Option<Residual>,
    /// Filter that moves after each strike, for noise or also for the modes, if any.
    pub dynamic_filter: Option<DynamicFilter>,
    /// Biquad bank beside the modes, if any.
    pub biquads: Option<Biquads>,
    /// Surface over which things scrape and roll, if any.
    pub surface: Option<ObjectSurface>,
}

/// Striker: its contact pulse and its own modal bank (diffimpact eq. 1, `IR_striker`).
#[derive(Clone, Debug, PartialEq)]
pub struct Striker {
    /// Name of the striker.
    pub name: String,
    /// Origin of the striker's numbers, at most 65535 bytes of UTF-8.
    pub source: String,
    /// Licence of the striker's numbers, at most 65535 bytes of UTF-8.
    pub licence: String,
    /// Shape of the contact pulse.
    pub pulse: Pulse,
    /// Peak force m1 at velocity 1, in newtons.
    pub peak_force: f32,
    /// Exponent a of the peak force, `m = m1 v^a`.
    pub peak_exponent: f32,
    /// Contact time τ1 at velocity 1, in seconds.
    pub contact_time_s: f32,
    /// Exponent b of the contact time, `τ = τ1 v^b`.
    pub contact_exponent: f32,
    /// Coefficient of restitution of a Hertz pulse, 0.1 to 1.
    ///
    /// A Gaussian pulse has none; its striker keeps [`Striker::DEFAULT_RESTITUTION`].
    pub restitution: f32,
    /// The striker's own modes, each with exactly one gain.
    pub modes: Vec<Mode>,
    /// Way in which the striker scrapes, if it does.
    pub scrape: Option<Scrape>,
    /// Way in which the striker rolls, if it does; it must scrape, too.
    pub roll: Option<Roll>,
}

impl Striker {
    /// Coefficient of restitution of a striker that does not give its own.
    pub const DEFAULT_RESTITUTION: f32 = dsp_core::table::range::DEFAULT_RESTITUTION;
}

/// Shape of a contact pulse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pulse {
    /// Pulse of spheres in contact that lose energy, by the striker's restitution.
    ///
    /// It begins at the onset of the strike.
    #[default]
    Hertz,
    /// Gaussian pulse (diffimpact eq. 2). At the onset of the strike it stands 100 dB below its
    /// peak.
    Gaussian,
}

impl Pulse {
    /// Word that stands for the pulse in the text form.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Hertz => "hertz",
            Self::Gaussian => "gaussian",
        }
    }
}

/// Mode: `h(t) = e^{-d t} (sine · sin 2πft + cosine · cos 2πft)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Frequency f in Hz.
    pub frequency_hz: f32,
    /// Decay rate d in 1/s; T60 = ln(1000)/d.
    pub decay_per_s: f32,
    /// Gains, one for each position along the object.
    pub gains: Vec<Gain>,
}

/// Gain of a mode at one position, output per newton-second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gain {
    /// Gain gs of the sine phase.
    pub sine: f32,
    /// Gain gc of the cosine phase.
    pub cosine: f32,
}

/// Effect of the end of a MIDI note on its pad.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NoteOff {
    /// The pad rings on.
    #[default]
    Nothing,
    /// A hand is laid on the pad until it is struck again.
    Choke,
}

/// Pad: an object, its strikers, and the way in which it is played.
#[derive(Clone, Debug, PartialEq)]
pub struct Pad {
    /// Name of the pad.
    pub name: String,
    /// Name of the object that the pad plays.
    pub object: String,
    /// Names of 1 to 4 strikers, the default one first.
    pub strikers: Vec<String>,
    /// Level in dB.
    pub level_db: f32,
    /// Constant-power pan, -1 (left) to 1 (right).
    pub pan: f32,
    /// Weight η of the strikers' own banks.
    pub striker_weight: f32,
    /// T60 of the pad while it is choked, in seconds; 0 for a pad that cannot be choked.
    pub choke_t60_s: f32,
    /// Up to 4 MIDI notes, 0 to 127, that play the pad; a note belongs to one pad only.
    pub midi_notes: Vec<u8>,
    /// Effect of the end of a MIDI note.
    pub note_off: NoteOff,
    /// Settings of the pad's trigger, if the pad has its own.
    ///
    /// If no pad of the kit has its own, each has its defaults ([`Settings::of_unset_pad`]). If
    /// some have their own, the others have neither piezo nor button.
    pub trigger: Option<Settings>,
}

impl Object {
    /// The object with another reference force, in newtons, and the same sound.
    ///
    /// Numbers that hold for a strike of the reference force are converted: a residual's weights,
    /// and a dynamic filter's noise and exciter. They may leave their ranges; building the kit
    /// tells.
    #[must_use]
    pub fn with_reference_force(&self, newtons: f32) -> Self {
        let ratio = f64::from(newtons) / f64::from(self.reference_force);
        let times = |x: &mut f32, factor: f64| *x = (f64::from(*x) * factor) as f32;
        let mut object = Self { reference_force: newtons, ..self.clone() };
        if let Some(residual) = &mut object.residual {
            residual.weight.iter_mut().for_each(|weight| times(weight, ratio));
        }
        if let Some(filter) = &mut object.dynamic_filter {
            // The noise becomes 1/ratio of what it was. The filter makes up for that, and so
            // amplifies all that goes into it: the loops and the modes are lowered by as much.
            for point in &mut filter.path {
                [&mut point.b0, &mut point.b1, &mut point.b2].into_iter().for_each(|b| times(b, ratio));
            }
            filter.loops.iter_mut().for_each(|round| times(&mut round.gain, 1.0 / ratio));
            if filter.modes == ModesGo::Through {
                for gain in object.modes.iter_mut().flat_map(|mode| &mut mode.gains) {
                    [&mut gain.sine, &mut gain.cosine].into_iter().for_each(|gain| times(gain, 1.0 / ratio));
                }
            }
            if let Some(exciter) = &mut filter.exciter {
                let moved = ratio.powf(f64::from(exciter.exponent));
                [&mut exciter.low_hz, &mut exciter.high_hz].into_iter().for_each(|edge| times(edge, moved));
            }
        }
        object
    }

    /// The object with its sound multiplied by a factor at each force.
    ///
    /// Numbers may leave their ranges; building the kit tells.
    #[must_use]
    pub fn with_gain(&self, factor: f64) -> Self {
        let times = |x: &mut f32| *x = (f64::from(*x) * factor) as f32;
        let mut object = self.clone();
        // Modes through a dynamic filter are amplified by the filter.
        let is_through = object.dynamic_filter.as_ref().is_some_and(|filter| filter.modes == ModesGo::Through);
        if !is_through {
            let gains = object.modes.iter_mut().flat_map(|mode| &mut mode.gains);
            gains.for_each(|gain| [&mut gain.sine, &mut gain.cosine].into_iter().for_each(times));
        }
        if let Acceleration::Factor(alpha) = &mut object.acceleration {
            times(alpha);
        }
        if let Some(residual) = &mut object.residual {
            residual.weight.iter_mut().for_each(times);
        }
        if let Some(filter) = &mut object.dynamic_filter {
            for point in &mut filter.path {
                [&mut point.b0, &mut point.b1, &mut point.b2].into_iter().for_each(times);
            }
            // What goes round a loop is to keep its size.
            filter.loops.iter_mut().for_each(|round| round.gain = (f64::from(round.gain) / factor) as f32);
        }
        // Biquads of a chain stand one behind the other, chains side by side.
        let chains = object.biquads.iter_mut().flat_map(|biquads| &mut biquads.chains);
        chains.filter_map(|chain| chain.first_mut()).for_each(|biquad| times(&mut biquad.gain));
        object
    }

    /// Number of positions at which gains are given: that of the first mode, 1 without modes.
    pub fn position_count(&self) -> usize {
        self.modes.first().map_or(1, |mode| mode.gains.len())
    }
}
