//! What a kit holds, as plain owned values that mirror the keys of the text form.
//!
//! Nothing here is checked; [`crate::binary::build`] judges. Valid ranges are those of [`dsp_core::table::range`].

use dsp_core::trigger::Settings;

use crate::{Biquads, DynamicFilter, ModesGo};

/// A kit: objects and strikers, bound to pads.
#[derive(Clone, Debug, PartialEq)]
pub struct Kit {
    /// The kit's name: 1 to 24 printable ASCII characters without comma and quote, no space at its ends. The same holds for
    /// every other name, and no two items of one kind share theirs.
    pub name: String,
    /// What is struck.
    pub objects: Vec<Object>,
    /// What strikes.
    pub strikers: Vec<Striker>,
    /// What is played.
    pub pads: Vec<Pad>,
    /// Stationary noise behind all pads (diffimpact §3.4), if any.
    pub background: Option<Background>,
    /// The room round all pads (diffimpact §3.4), band by band from the lowest up; without bands there is none.
    pub room: Vec<RoomBand>,
}

/// A band of the room's answer to an impulse: noise with the power `gain² e^(−2 decay_per_s t)`, of the energy `gain²/(2 decay_per_s)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoomBand {
    /// Where it begins, in Hz; 0 for the first. It ends where the next one begins, the last one at Nyquist.
    pub from_hz: f32,
    /// Initial gain g, 1/√s.
    pub gain: f32,
    /// Decay rate d in 1/s; T60 = ln(1000)/d.
    pub decay_per_s: f32,
}

impl RoomBand {
    /// The band of a T60 in seconds and an energy in dB over that of the direct sound in the band.
    pub fn new(from_hz: f64, t60_s: f64, energy_db: f64) -> Self {
        let decay_per_s = 1000f64.ln() / t60_s;
        let gain = (2.0 * decay_per_s * 10f64.powf(energy_db / 10.0)).sqrt();
        Self { from_hz: from_hz as f32, gain: gain as f32, decay_per_s: decay_per_s as f32 }
    }

    /// T60 in seconds.
    pub fn t60_s(&self) -> f64 {
        1000f64.ln() / f64::from(self.decay_per_s)
    }

    /// Energy in dB over that of the direct sound in the band.
    pub fn energy_db(&self) -> f64 {
        10.0 * (f64::from(self.gain).powi(2) / (2.0 * f64::from(self.decay_per_s))).log10()
    }
}

/// What an object sounds beside its modes: bands of decaying noise (physics-diffusion eq. 5, 6), started by each strike.
#[derive(Clone, Debug, PartialEq)]
pub struct Residual {
    /// Seed of the noise; two objects with the same one differ all the same.
    pub seed: u32,
    /// Edges of the bands in Hz, rising: one more than bands, at most 101.
    pub edges_hz: Vec<f32>,
    /// Rms w of each band at t = 0 (1.0 = full scale) of a strike whose peak force is the reference force.
    pub weight: Vec<f32>,
    /// Decay γ of each band in dB/s.
    pub decay_db_per_s: Vec<f32>,
}

/// Stationary noise with per-band gains.
#[derive(Clone, Debug, PartialEq)]
pub struct Background {
    /// Seed of the noise.
    pub seed: u32,
    /// Edges of the bands in Hz, rising: one more than bands, at most 101.
    pub edges_hz: Vec<f32>,
    /// Rms of each band (1.0 = full scale).
    pub weight: Vec<f32>,
}

/// The acceleration sound α of an object, output per newton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Acceleration {
    /// A number.
    Factor(f32),
    /// Derived from the modes at the rate at which they are rendered, so that a constant force makes no sound
    /// ([`dsp_core::radiation`]); the strikers' own modes are balanced with the object's.
    Balance,
}

impl Acceleration {
    /// No acceleration sound.
    pub const NONE: Self = Self::Factor(0.0);

    /// The word in the text form that stands for [`Acceleration::Balance`].
    pub const BALANCE_KEY: &str = "balance";

    /// The number, where it is one.
    pub fn factor(self) -> Option<f32> {
        match self {
            Self::Factor(factor) => Some(factor),
            Self::Balance => None,
        }
    }
}

/// A struck object: a modal bank (diffimpact eq. 1, `IR_object`) and its acceleration sound.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its name.
    pub name: String,
    /// Where the numbers come from; at most 65535 bytes of UTF-8.
    pub source: String,
    /// The licence of the numbers; at most 65535 bytes of UTF-8.
    pub licence: String,
    /// The force in newtons (1 where uncalibrated) that 1.0 on the force bus stands for.
    pub reference_force: f32,
    /// Acceleration sound (diffimpact eq. 1).
    pub acceleration: Acceleration,
    /// Its modes, all with the same number of gains.
    pub modes: Vec<Mode>,
    /// What it sounds beside them, if anything.
    pub residual: Option<Residual>,
    /// Noise, or its modes, through a filter that moves, if any.
    pub dynamic_filter: Option<DynamicFilter>,
    /// A biquad bank beside the modes, if any.
    pub biquads: Option<Biquads>,
}

/// A striker: its contact pulse and its own modal bank (diffimpact eq. 1, `IR_striker`).
#[derive(Clone, Debug, PartialEq)]
pub struct Striker {
    /// Its name.
    pub name: String,
    /// Where the numbers come from; at most 65535 bytes of UTF-8.
    pub source: String,
    /// The licence of the numbers; at most 65535 bytes of UTF-8.
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
    /// Coefficient of restitution of a Hertz pulse, 0.1 to 1; [`Striker::DEFAULT_RESTITUTION`] for a Gaussian.
    pub restitution: f32,
    /// The striker's own modes, each with exactly one gain.
    pub modes: Vec<Mode>,
}

impl Striker {
    /// Restitution of a striker that does not say its own.
    pub const DEFAULT_RESTITUTION: f32 = dsp_core::table::range::DEFAULT_RESTITUTION;
}

/// Shape of a contact pulse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pulse {
    /// Spheres in contact that lose energy, by the striker's restitution; begins at its onset.
    #[default]
    Hertz,
    /// Gaussian (diffimpact eq. 2); begins where it is 100 dB down.
    Gaussian,
}

impl Pulse {
    /// The word in the text form.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Hertz => "hertz",
            Self::Gaussian => "gaussian",
        }
    }
}

/// One mode: `h(t) = e^{-d t} (sine · sin 2πft + cosine · cos 2πft)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Frequency f in Hz.
    pub frequency_hz: f32,
    /// Decay rate d in 1/s; T60 = ln(1000)/d.
    pub decay_per_s: f32,
    /// Gains, one at each position along the object.
    pub gains: Vec<Gain>,
}

/// A mode's gain at one position, output per newton-second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gain {
    /// Gain gs of the sine phase.
    pub sine: f32,
    /// Gain gc of the cosine phase.
    pub cosine: f32,
}

/// A pad: what it plays and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Pad {
    /// Its name.
    pub name: String,
    /// Name of the object that it plays.
    pub object: String,
    /// Names of 1 to 4 strikers, the default one first.
    pub strikers: Vec<String>,
    /// Level in dB.
    pub level_db: f32,
    /// Constant-power pan, -1 (left) to 1 (right).
    pub pan: f32,
    /// Weight η of the strikers' own banks.
    pub striker_weight: f32,
    /// T60 in seconds that a choke imposes; 0 for a pad that cannot be choked.
    pub choke_t60_s: f32,
    /// Up to 4 MIDI notes, 0 to 127, that play it; each belongs to one pad only.
    pub midi_notes: Vec<u8>,
    /// How it is triggered. In a kit in which no pad says so, each has its defaults ([`Settings::of_unset_pad`]); in one in which
    /// some do, the others have neither piezo nor button.
    pub trigger: Option<Settings>,
}

impl Object {
    /// The object with another reference force, in newtons, and the same sound: what its numbers
    /// say for a strike of the reference force (a residual's weights, a dynamic filter's noise and
    /// exciter) is carried over. Numbers may leave their ranges: build the kit to know.
    #[must_use]
    pub fn with_reference_force(&self, newtons: f32) -> Self {
        let ratio = f64::from(newtons) / f64::from(self.reference_force);
        let times = |x: &mut f32, factor: f64| *x = (f64::from(*x) * factor) as f32;
        let mut object = Self { reference_force: newtons, ..self.clone() };
        if let Some(residual) = &mut object.residual {
            residual.weight.iter_mut().for_each(|weight| times(weight, ratio));
        }
        if let Some(filter) = &mut object.dynamic_filter {
            // The noise becomes 1/ratio of what it was, and the filter makes up for it: of all that
            // goes in.
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

    /// The number of positions at which gains are given: that of the first mode, 1 for an object without modes.
    pub fn position_count(&self) -> usize {
        self.modes.first().map_or(1, |mode| mode.gains.len())
    }
}
