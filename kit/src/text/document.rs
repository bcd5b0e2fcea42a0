//! Structure of one text file: its keys, their types and their defaults.

use std::fmt;

use serde::de::{self, Deserialize, Deserializer, SeqAccess, Visitor};
use toml::Spanned;

use super::filters::{BiquadsTable, DynamicFilterTable};
use super::pair::Pair;
use super::residual::{BackgroundTable, ResidualTable};
use super::surface::{RollTable, ScrapeTable, SurfaceOfTable, SurfaceTable};
use super::trigger::TriggerTable;
use crate::content::{Acceleration, NoteOff, Pulse, Striker};

/// Content of a text file, key by key.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Document {
    /// Format version, which has been checked before the rest of the file is read.
    #[serde(rename = "format")]
    _format: i64,
    pub(super) name: Option<Spanned<String>>,
    #[serde(default)]
    pub(super) include: Vec<Spanned<String>>,
    pub(super) headphone_db: Option<f32>,
    pub(super) background: Option<Spanned<BackgroundTable>>,
    #[serde(default)]
    pub(super) room: Vec<Spanned<RoomBandTable>>,
    #[serde(default)]
    pub(super) surface: Vec<Spanned<SurfaceTable>>,
    #[serde(default)]
    pub(super) surface_of: Vec<SurfaceOfTable>,
    #[serde(default)]
    pub(super) object: Vec<Spanned<ObjectTable>>,
    #[serde(default)]
    pub(super) striker: Vec<Spanned<StrikerTable>>,
    #[serde(default)]
    pub(super) pad: Vec<Spanned<PadTable>>,
}

/// Table `[[room]]`: a band of the room.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RoomBandTable {
    pub(super) from_hz: f32,
    pub(super) gain: f32,
    pub(super) decay_per_s: f32,
}

/// Table `[[object]]`.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObjectTable {
    pub(super) name: Spanned<String>,
    #[serde(default)]
    pub(super) source: String,
    #[serde(default)]
    pub(super) licence: String,
    #[serde(default = "one")]
    pub(super) reference_force: f32,
    #[serde(default = "no_acceleration", deserialize_with = "acceleration")]
    pub(super) acceleration: Acceleration,
    pub(super) modes: Vec<Spanned<ModeTable>>,
    pub(super) residual: Option<Spanned<ResidualTable>>,
    pub(super) dynamic_filter: Option<Spanned<DynamicFilterTable>>,
    pub(super) biquads: Option<Spanned<BiquadsTable>>,
    pub(super) surface: Option<String>,
    pub(super) size_m: Option<Pair>,
    pub(super) surface_level_db: Option<f32>,
}

/// Table `[[striker]]`.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StrikerTable {
    pub(super) name: Spanned<String>,
    #[serde(default)]
    pub(super) source: String,
    #[serde(default)]
    pub(super) licence: String,
    #[serde(default, deserialize_with = "pulse")]
    pub(super) pulse: Pulse,
    pub(super) peak_force: f32,
    #[serde(default = "usual_peak_exponent")]
    pub(super) peak_exponent: f32,
    pub(super) contact_time_s: f32,
    #[serde(default = "usual_contact_exponent")]
    pub(super) contact_exponent: f32,
    #[serde(default = "usual_restitution")]
    pub(super) restitution: f32,
    #[serde(default)]
    pub(super) modes: Vec<Spanned<ModeTable>>,
    pub(super) scrape: Option<Spanned<ScrapeTable>>,
    pub(super) roll: Option<Spanned<RollTable>>,
}

/// Element of the key `modes`.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ModeTable {
    pub(super) frequency_hz: f32,
    pub(super) decay_per_s: f32,
    pub(super) gain_sine: Option<Gains>,
    pub(super) gain_cosine: Option<Gains>,
}

/// Table `[[pad]]`.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PadTable {
    pub(super) name: Spanned<String>,
    pub(super) object: String,
    pub(super) strikers: Vec<String>,
    #[serde(default)]
    pub(super) level_db: f32,
    #[serde(default)]
    pub(super) pan: f32,
    #[serde(default = "one")]
    pub(super) striker_weight: f32,
    #[serde(default = "usual_choke_t60_s")]
    pub(super) choke_t60_s: f32,
    #[serde(default)]
    pub(super) midi_notes: Vec<i64>,
    #[serde(default, deserialize_with = "note_off")]
    pub(super) note_off: NoteOff,
    pub(super) trigger: Option<TriggerTable>,
}

/// Gains of a mode: in the text a number for one position, or an array for several.
pub(super) struct Gains(pub(super) Vec<f32>);

fn one() -> f32 {
    1.0
}

/// Default exponent of the peak force, which grows as v^1.2.
fn usual_peak_exponent() -> f32 {
    1.2
}

/// Default exponent of the contact time, which shrinks as v^-0.2.
fn usual_contact_exponent() -> f32 {
    -0.2
}

fn usual_restitution() -> f32 {
    Striker::DEFAULT_RESTITUTION
}

fn usual_choke_t60_s() -> f32 {
    0.1
}

fn no_acceleration() -> Acceleration {
    Acceleration::NONE
}

fn acceleration<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Acceleration, D::Error> {
    struct NumberOrWord;

    impl Visitor<'_> for NumberOrWord {
        type Value = Acceleration;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "a number or {:?}", Acceleration::BALANCE_KEY)
        }

        fn visit_f64<E: de::Error>(self, value: f64) -> Result<Acceleration, E> {
            Ok(Acceleration::Factor(value as f32))
        }

        fn visit_i64<E: de::Error>(self, value: i64) -> Result<Acceleration, E> {
            Ok(Acceleration::Factor(value as f32))
        }

        fn visit_str<E: de::Error>(self, word: &str) -> Result<Acceleration, E> {
            let balance = Acceleration::BALANCE_KEY;
            match word == balance {
                true => Ok(Acceleration::Balance),
                false => Err(de::Error::custom(format!("acceleration = {word:?}: must be a number or {balance:?}"))),
            }
        }
    }

    deserializer.deserialize_any(NumberOrWord)
}

fn note_off<'de, D: Deserializer<'de>>(deserializer: D) -> Result<NoteOff, D::Error> {
    let word = String::deserialize(deserializer)?;
    match word.as_str() {
        "nothing" => Ok(NoteOff::Nothing),
        "choke" => Ok(NoteOff::Choke),
        _ => Err(de::Error::custom(format!("note_off = {word:?}: must be \"nothing\" or \"choke\""))),
    }
}

fn pulse<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Pulse, D::Error> {
    let word = String::deserialize(deserializer)?;
    [Pulse::Hertz, Pulse::Gaussian].into_iter().find(|pulse| pulse.key() == word).ok_or_else(|| {
        de::Error::custom(format!("pulse = {word:?}: must be {:?} or {:?}", Pulse::Hertz.key(), Pulse::Gaussian.key()))
    })
}

impl<'de> Deserialize<'de> for Gains {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NumberOrArray;

        impl<'de> Visitor<'de> for NumberOrArray {
            type Value = Gains;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a number, or an array with a number for each position")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Gains, E> {
                Ok(Gains(vec![value as f32]))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Gains, E> {
                Ok(Gains(vec![value as f32]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut positions: A) -> Result<Gains, A::Error> {
                let mut gains = Vec::new();
                while let Some(gain) = positions.next_element()? {
                    gains.push(gain);
                }
                Ok(Gains(gains))
            }
        }

        deserializer.deserialize_any(NumberOrArray)
    }
}
