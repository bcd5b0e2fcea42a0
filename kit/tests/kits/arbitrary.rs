//! Arbitrary valid kits that the binary form can hold, of sizes that a test can afford.

use dsp_core::table::range;
use dsp_core::trigger::{Mode as TriggerMode, Settings};
use kit::{Acceleration, Background, Gain, Kit, Mode, Object, Pad, Pulse, Residual, RoomBand, Striker};
use proptest::prelude::*;
use proptest::sample::subsequence;

use crate::arbitrary_filters::{biquads, dynamic_filter};
use crate::arbitrary_number::number;
use crate::arbitrary_surfaces::{object_surface, roll, scrape, surface};

fn name() -> impl Strategy<Value = String> {
    let edge = "[!#-+\\--~]";
    let inside = "[ !#-+\\--~]";
    proptest::string::string_regex(&format!("{edge}({inside}{{0,22}}{edge})?")).expect("a regular expression")
}

fn names(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<String>> {
    prop::collection::hash_set(name(), count).prop_map(|names| names.into_iter().collect())
}

/// Any text, often with characters that TOML must escape.
fn text() -> impl Strategy<Value = String> {
    prop_oneof![Just(String::new()), any::<String>(), "[\"'\\\\\n\r\t\u{0}\u{7}\u{7f}\u{85}\u{2028}\u{feff}é𝄞 a]{0,40}"]
}

fn modes(positions: usize) -> impl Strategy<Value = Vec<Mode>> {
    let gain = (number(range::GAIN), number(range::GAIN)).prop_map(|(sine, cosine)| Gain { sine, cosine });
    let gains = prop::collection::vec(gain, positions);
    let mode = (number(range::FREQUENCY_HZ), number(range::DECAY_PER_S), gains);
    prop::collection::vec(
        mode.prop_map(|(frequency_hz, decay_per_s, gains)| Mode { frequency_hz, decay_per_s, gains }),
        0..5,
    )
}

fn acceleration() -> impl Strategy<Value = Acceleration> {
    prop_oneof![number(range::ACCELERATION).prop_map(Acceleration::Factor), Just(Acceleration::Balance)]
}

fn object(name: String, surfaces: &[String]) -> BoxedStrategy<Object> {
    let modes = (1..4usize).prop_flat_map(modes);
    let filters = (prop::option::of(dynamic_filter()), prop::option::of(biquads()));
    let sound = (modes, prop::option::of(residual()), filters, object_surface(surfaces));
    (text(), text(), number(range::REFERENCE_FORCE), acceleration(), sound)
        .prop_map(
            move |(
                source,
                licence,
                reference_force,
                acceleration,
                (modes, residual, (dynamic_filter, biquads), surface),
            )| Object {
                name: name.clone(),
                source,
                licence,
                reference_force,
                acceleration,
                modes,
                residual,
                dynamic_filter,
                biquads,
                surface,
            },
        )
        .boxed()
}

/// Rising edges of `bands` bands: one more edge than bands.
fn edges_hz(bands: usize) -> impl Strategy<Value = Vec<f32>> {
    prop::collection::vec(1.0f32..900.0, bands + 1).prop_map(|widths| {
        let mut edge = 0.0;
        widths
            .into_iter()
            .map(|width| {
                edge += width + 0.5;
                edge
            })
            .collect()
    })
}

fn residual() -> impl Strategy<Value = Residual> {
    (1..=100usize, any::<u32>()).prop_flat_map(|(bands, seed)| {
        let weight = prop::collection::vec(number(range::WEIGHT), bands);
        let decay = prop::collection::vec(number(range::DECAY_DB_PER_S), bands);
        (edges_hz(bands), weight, decay).prop_map(move |(edges_hz, weight, decay_db_per_s)| Residual {
            seed,
            edges_hz,
            weight,
            decay_db_per_s,
        })
    })
}

fn background() -> impl Strategy<Value = Background> {
    (1..=100usize, any::<u32>()).prop_flat_map(|(bands, seed)| {
        let weight = prop::collection::vec(number(range::WEIGHT), bands);
        (edges_hz(bands), weight).prop_map(move |(edges_hz, weight)| Background { seed, edges_hz, weight })
    })
}

fn room() -> impl Strategy<Value = Vec<RoomBand>> {
    (0..=8usize).prop_flat_map(|bands| {
        let gain = prop::collection::vec(number(range::ROOM_GAIN), bands);
        let decay = prop::collection::vec(number(range::ROOM_DECAY_PER_S), bands);
        (edges_hz(bands), gain, decay).prop_map(|(edges_hz, gain, decay)| {
            let from_hz = std::iter::once(0.0).chain(edges_hz);
            let bands = from_hz.zip(gain.into_iter().zip(decay));
            bands.map(|(from_hz, (gain, decay_per_s))| RoomBand { from_hz, gain, decay_per_s }).collect()
        })
    })
}

fn striker(name: String) -> impl Strategy<Value = Striker> {
    // A Gaussian pulse has no restitution, and its striker keeps the default.
    let usual = Striker::DEFAULT_RESTITUTION;
    let hertz = prop_oneof![2 => number(range::RESTITUTION), 1 => Just(usual)].prop_map(|e| (Pulse::Hertz, e));
    let pulse = prop_oneof![hertz, Just((Pulse::Gaussian, usual))];
    let peak = (number(range::PEAK_FORCE), number(range::PEAK_EXPONENT));
    let contact = (number(range::CONTACT_TIME_S), number(range::CONTACT_EXPONENT));
    let scrape = prop::option::of((scrape(), prop::option::of(roll())));
    (text(), text(), pulse, peak, contact, modes(1), scrape).prop_map(
        move |(
            source,
            licence,
            (pulse, restitution),
            (peak_force, peak_exponent),
            (contact_time_s, contact_exponent),
            modes,
            scrape,
        )| {
            let (scrape, roll) = scrape.map_or((None, None), |(scrape, roll)| (Some(scrape), roll));
            Striker {
                name: name.clone(),
                source,
                licence,
                pulse,
                peak_force,
                peak_exponent,
                contact_time_s,
                contact_exponent,
                restitution,
                modes,
                scrape,
                roll,
            }
        },
    )
}

fn pad(
    (name, midi_notes): (String, Vec<u8>),
    objects: Vec<String>,
    strikers: Vec<String>,
) -> impl Strategy<Value = Pad> {
    let most = strikers.len().min(4);
    let strikers = subsequence(strikers, 1..=most).prop_shuffle();
    let choke_t60_s = prop_oneof![4 => number(range::CHOKE_T60_S), 1 => Just(0.0), 1 => Just(-0.0)];
    let numbers = (number(range::LEVEL_DB), number(range::PAN), number(range::STRIKER_WEIGHT), choke_t60_s);
    (prop::sample::select(objects), strikers, numbers).prop_map(
        move |(object, strikers, (level_db, pan, striker_weight, choke_t60_s))| Pad {
            name: name.clone(),
            object,
            strikers,
            level_db,
            pan,
            striker_weight,
            choke_t60_s,
            midi_notes: midi_notes.clone(),
            note_off: kit::NoteOff::Nothing,
            trigger: None,
        },
    )
}

/// Pads of a kit with these objects and strikers, without repeated MIDI notes.
fn pads(objects: Vec<String>, strikers: Vec<String>) -> BoxedStrategy<Vec<Pad>> {
    if objects.is_empty() || strikers.is_empty() {
        return Just(Vec::new()).boxed();
    }
    let notes = subsequence((0..128u8).collect::<Vec<_>>(), 16).prop_shuffle();
    (names(0..4), notes, prop::collection::vec(0..=4usize, 4))
        .prop_flat_map(move |(names, notes, counts)| {
            let notes = notes.chunks(4).zip(counts).map(|(notes, count)| notes.iter().copied().take(count).collect());
            let heads: Vec<(String, Vec<u8>)> = names.into_iter().zip(notes).collect();
            let pads: Vec<_> = heads.into_iter().map(|head| pad(head, objects.clone(), strikers.clone())).collect();
            let triggers: Vec<_> = (0..pads.len()).map(|index| prop::option::of(trigger(index as u8))).collect();
            (pads, triggers)
        })
        .prop_map(|(pads, triggers)| {
            let with = |(pad, trigger): (Pad, Option<Settings>)| Pad {
                trigger: trigger
                    .map(|trigger| Settings { rim_striker: trigger.rim_striker % pad.strikers.len() as u8, ..trigger }),
                ..pad
            };
            pads.into_iter().zip(triggers).map(with).collect()
        })
        .boxed()
}

/// Trigger settings of one of four pads, with inputs that no other pad has.
fn trigger(pad: u8) -> impl Strategy<Value = Settings> {
    let mode = prop::sample::select(vec![TriggerMode::Velocity, TriggerMode::Direct, TriggerMode::Off]);
    let input = |input| prop::sample::select(vec![None, Some(input)]);
    let inputs = (input(15 - pad), 0..4u8, input(pad), prop::option::of(0..16u8));
    let times = (number(range::SCAN_TIME_S), number(range::MASK_TIME_S), number(range::MASK_DECAY_PER_S));
    let levels =
        (number(range::THRESHOLD), number(range::FULL_SCALE), number(range::CROSSTALK_DB), number(range::RIM_DB));
    let laws = (number(range::VELOCITY_EXPONENT), number(range::DIRECT_GAIN), number(range::BUTTON_VELOCITY));
    (mode, inputs, times, levels, laws).prop_map(move |(mode, inputs, times, levels, laws)| {
        let (rim_channel, rim_striker, button, choke_button) = inputs;
        let (scan_time_s, mask_time_s, mask_decay_per_s) = times;
        let (threshold, full_scale, crosstalk_db, rim_db) = levels;
        let (velocity_exponent, direct_gain, button_velocity) = laws;
        Settings {
            mode,
            channel: pad,
            rim_channel,
            rim_striker,
            threshold,
            scan_time_s,
            mask_time_s,
            mask_decay_per_s,
            full_scale,
            velocity_exponent,
            crosstalk_db,
            rim_db,
            direct_gain,
            button,
            button_velocity,
            choke_button,
        }
    })
}

/// Any valid kit.
pub(crate) fn kit() -> impl Strategy<Value = Kit> {
    (name(), names(0..4), names(0..6), names(0..3)).prop_flat_map(|(name, objects, strikers, surfaces)| {
        let pads = pads(objects.clone(), strikers.clone());
        let objects: Vec<_> = objects.into_iter().map(|name| object(name, &surfaces)).collect();
        let surfaces: Vec<_> = surfaces.into_iter().map(|name| surface(name, text(), text())).collect();
        let strikers: Vec<_> = strikers.into_iter().map(striker).collect();
        let around = (prop::option::of(background()), room(), prop::option::of(number(range::HEADPHONE_DB)));
        (objects, strikers, pads, surfaces, around).prop_map(move |(objects, strikers, pads, surfaces, around)| {
            let (background, room, headphone_db) = around;
            Kit { name: name.clone(), objects, strikers, pads, surfaces, background, room, headphone_db }
        })
    })
}
