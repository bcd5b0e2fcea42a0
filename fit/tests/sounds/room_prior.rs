//! Rooms of diffimpact's optimiser, against its formulas worked by hand and against its own
//! rendering.

use fit::render::{by_instrument, playable};
use fit::room_prior::{MOST_BANDS, MOST_ROOM_BANDS, Scalings, ScalingsError, room_of_scalings};
use kit::{Kit, Object, Pulse, RoomBand, Striker};

/// A pad that answers a strike with the contact's pulse alone, in a room.
fn click(room: Vec<RoomBand>) -> Kit {
    let (name, source, licence) = ("click".to_owned(), String::new(), String::new());
    Kit {
        name: name.clone(),
        objects: vec![Object {
            name: name.clone(),
            source: source.clone(),
            licence: licence.clone(),
            reference_force: 1.0,
            acceleration: kit::Acceleration::Factor(0.5),
            modes: vec![],
            residual: None,
            dynamic_filter: None,
            biquads: None,
            surface: None,
        }],
        strikers: vec![Striker {
            name,
            source,
            licence,
            pulse: Pulse::Hertz,
            peak_force: 1.0,
            peak_exponent: 1.2,
            contact_time_s: 2e-4,
            contact_exponent: -0.2,
            restitution: Striker::DEFAULT_RESTITUTION,
            scrape: None,
            roll: None,
            modes: vec![],
        }],
        pads: vec![],
        background: None,
        room,
        headphone_db: None,
        surfaces: Vec::new(),
    }
}

fn accepted(room: &[RoomBand]) -> bool {
    kit::binary::build(&playable(&click(room.to_vec()))).is_ok()
}

/// Uniform number between -1 and 1, from a counter (SplitMix64).
fn even(seed: u64, n: u64) -> f64 {
    let mut bits = seed.wrapping_mul(0xd134_2543_de82_ef95).wrapping_add(n.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn energy(sound: &[f64]) -> f64 {
    sound.iter().map(|x| x * x).sum()
}

#[test]
fn bands_follow_the_papers_formulas_worked_by_hand() {
    // sigmoid(-4)^2.302585 = 0.0179862^2.302585 = 9.5907e-5, twice that and 1e-7: 1.91914e-4; times
    // √(88200/3) = 171.464: 0.0329064. 2 + e⁴ = 56.5982. sigmoid(-3) = 0.0474259: 1.788409e-3,
    // 0.306648; 2 + e³ = 22.0855. sigmoid(-1) = 0.268941: 0.0972229, 16.67026; 2 + e = 4.71828.
    let room = room_of_scalings(&[0.0, 1.0, 3.0], &[0.0, -1.0, -3.0], 88_200.0).expect("right values");
    // A third of 44.1 kHz each; the third band begins at 29.4 kHz, which no player at 44.1 kHz
    // reproduces.
    let expected = [(0.0, 0.032_906_4, 56.598_15), (14_700.0, 0.306_648_3, 22.085_537)];
    assert_eq!(room.len(), expected.len());
    for (band, (from_hz, gain, decay_per_s)) in room.iter().zip(expected) {
        assert_eq!(f64::from(band.from_hz), from_hz);
        assert!((f64::from(band.gain) / gain - 1.0).abs() < 1e-5, "{band:?}");
        assert!((f64::from(band.decay_per_s) / decay_per_s - 1.0).abs() < 1e-6, "{band:?}");
    }
    let third = Scalings::default();
    assert!((third.gain(3.0) - 0.097_222_9).abs() < 1e-7 && (third.decay(-3.0) - 4.718_282).abs() < 1e-6);
    assert!(accepted(&room));
}

#[test]
fn other_hyperparameters_move_gain_and_decay_as_the_formulas_say() {
    let plain = Scalings { gain_bias: 0.0, decay_bias: 0.0, noise_rms: 1.0, time_unit_s: 2.0 };
    let room = plain.room(&[0.0], &[0.0], 10_000.0).expect("right values");
    // 2 · 0.5^2.302585 + 1e-7 = 0.4053993; times √10000. (2 + 1)/2 per second.
    assert!((room[0].gain - 40.539_93).abs() < 1e-4 && room[0].decay_per_s == 1.5, "{room:?}");
}

#[test]
fn equal_neighbours_are_merged_first() {
    // Ten bands of 1 kHz, equal from 3 to 6 kHz.
    let raw_gain = [0.0, 0.4, 0.8, 2.0, 2.0, 2.0, 1.5, 1.1, 0.7, 0.3];
    let raw_decay = [-1.0, -1.1, -1.2, -1.3, -1.3, -1.3, -1.4, -1.5, -1.6, -1.7];
    let room = room_of_scalings(&raw_gain, &raw_decay, 20_000.0).expect("right values");
    let from_hz: Vec<f32> = room.iter().map(|band| band.from_hz).collect();
    assert_eq!(from_hz, [0.0, 1_000.0, 2_000.0, 3_000.0, 6_000.0, 7_000.0, 8_000.0, 9_000.0]);
    let one = Scalings::default().room(&[2.0], &[-1.3], 20_000.0).expect("right values");
    assert_eq!((room[3].gain, room[3].decay_per_s), (one[0].gain, one[0].decay_per_s));
}

#[test]
fn merging_keeps_power_and_energy_and_the_loud_bands_apart() {
    let (rate_hz, bands) = (32_000.0, 64);
    let raw_gain: Vec<f64> = (0..bands).map(|n| 1.5 * even(1, n) + if n == 20 { 4.0 } else { 0.0 }).collect();
    let raw_decay: Vec<f64> = (0..bands).map(|n| -1.5 + even(2, n)).collect();
    let room = room_of_scalings(&raw_gain, &raw_decay, rate_hz).expect("right values");
    assert_eq!(room.len(), MOST_ROOM_BANDS);
    let ends = room.iter().skip(1).map(|band| f64::from(band.from_hz)).chain([rate_hz / 2.0]);
    let (mut power, mut held) = (0.0, 0.0);
    for (band, end_hz) in room.iter().zip(ends) {
        let of_band = f64::from(band.gain).powi(2) * (end_hz - f64::from(band.from_hz));
        power += of_band;
        held += of_band / (2.0 * f64::from(band.decay_per_s));
    }
    let (mut all_power, mut all_held) = (0.0, 0.0);
    for (gain, decay) in raw_gain.iter().zip(&raw_decay) {
        let scalings = Scalings::default();
        let of_band = scalings.gain(*gain).powi(2) * rate_hz / 3.0 * (rate_hz / 2.0 / bands as f64);
        all_power += of_band;
        all_held += of_band / (2.0 * scalings.decay(*decay));
    }
    assert!((power / all_power - 1.0).abs() < 1e-5, "{power} {all_power}");
    assert!((held / all_held - 1.0).abs() < 1e-5, "{held} {all_held}");
    // Band 20, of 250 Hz as all others, has nearly all the energy.
    let edges: Vec<f32> = room.iter().map(|band| band.from_hz).collect();
    assert!(edges.contains(&5_000.0) && edges.contains(&5_250.0), "{edges:?}");
}

#[test]
fn a_learned_room_has_the_energy_and_t60_of_the_papers_noise() {
    const RATE_HZ: f64 = 44_100.0;
    let (raw_gain, raw_decay) = ([2.0; 16], [-1.5; 16]);
    let room = room_of_scalings(&raw_gain, &raw_decay, RATE_HZ).expect("right values");
    assert!(accepted(&room));
    let frames = 30_000;
    let play = |room| by_instrument(&click(room), 0.5, RATE_HZ, frames).expect("a right table");
    let dry = play(vec![]);
    let ours: Vec<f64> = play(room).iter().zip(&dry).map(|(wet, dry)| wet - dry).collect();
    // Eq. 19 with equal bands, which together are the noise itself, sample by sample; convolved
    // with the dry sound.
    let pulse = dry.iter().rposition(|x| *x != 0.0).map_or(&dry[..0], |last| &dry[..=last]);
    let scalings = Scalings::default();
    let (gain, decay) = (scalings.gain(2.0), scalings.decay(-1.5));
    let theirs = |seed: u64| -> Vec<f64> {
        let mut sound = vec![0.0; frames];
        for n in 0..frames {
            let response = gain * (-decay * n as f64 / RATE_HZ).exp() * even(seed, n as u64);
            sound.iter_mut().skip(n).zip(pulse).for_each(|(out, dry)| *out += response * dry);
        }
        sound
    };
    let draws: Vec<Vec<f64>> = (1..=8).map(theirs).collect();
    // Bounds for a room: energy within 1 dB, T60 within 5 %. The network's first echoes may shift
    // energy in time.
    let level_db = |sound: &[f64], from_s: f64, to_s: f64| {
        let part = sound.get((from_s * RATE_HZ) as usize..(to_s * RATE_HZ) as usize);
        10.0 * part.map_or(0.0, energy).log10()
    };
    let mean_db = |from_s: f64, to_s: f64| {
        draws.iter().map(|draw| level_db(draw, from_s, to_s)).sum::<f64>() / draws.len() as f64
    };
    let energy_db = level_db(&ours, 0.0, 0.65) - mean_db(0.0, 0.65);
    let (early, late) = ((0.05, 0.2), (0.25, 0.4));
    let fall_db = level_db(&ours, early.0, early.1) - level_db(&ours, late.0, late.1);
    let their_fall_db = mean_db(early.0, early.1) - mean_db(late.0, late.1);
    println!("energy {energy_db:.2} dB of theirs, fall over 0.2 s {fall_db:.2} dB, theirs {their_fall_db:.2} dB");
    assert!(energy_db.abs() < 1.0, "{energy_db} dB");
    assert!((fall_db / their_fall_db - 1.0).abs() < 0.05, "{fall_db} dB, theirs {their_fall_db} dB");
}

#[test]
fn any_finite_values_make_a_room_that_a_kit_accepts() {
    for gain in [f64::MIN, -800.0, -3.0, 8.0, 800.0, f64::MAX] {
        for decay in [f64::MIN, -800.0, 0.0, 1.5, 800.0, f64::MAX] {
            for bands in [1, 8, 9, 40] {
                let raw_gain: Vec<f64> = (0..bands).map(|n| if n % 3 == 0 { gain } else { 0.0 }).collect();
                let raw_decay: Vec<f64> = (0..bands).map(|n| if n % 2 == 0 { decay } else { 0.0 }).collect();
                for time_unit_s in [1e-3, 1.0, 1e3] {
                    let scalings = Scalings { time_unit_s, ..Scalings::default() };
                    let room = scalings.room(&raw_gain, &raw_decay, 88_200.0).expect("finite values");
                    assert!(accepted(&room), "{gain} {decay} {time_unit_s}: {room:?}");
                }
            }
        }
    }
    let most = room_of_scalings(&[0.0; MOST_BANDS], &[0.0; MOST_BANDS], 4_000.0).expect("narrow bands");
    assert!(most.len() == MOST_ROOM_BANDS && accepted(&most));
}

#[test]
fn a_clamped_decay_keeps_its_energy_and_gains_are_at_most_100() {
    // 2 + e^6 = 405.43 1/s, clamped to 150: gain² falls by their ratio.
    let fast = &room_of_scalings(&[3.0], &[2.0], 44_100.0).expect("right values")[0];
    let gain = 0.097_222_94 * (44_100f64 / 3.0).sqrt() * (150f64 / 405.428_79).sqrt();
    assert!(fast.decay_per_s == 150.0 && (f64::from(fast.gain) / gain - 1.0).abs() < 1e-5, "{fast:?}");
    assert_eq!(room_of_scalings(&[8.0], &[-2.0], 88_200.0).expect("right values")[0].gain, 100.0);
}

#[test]
fn raw_values_that_make_no_room_are_refused_by_name() {
    let refusal = |gain: &[f64], decay: &[f64], rate_hz| room_of_scalings(gain, decay, rate_hz).expect_err("no room");
    assert_eq!(refusal(&[0.0, 1.0], &[0.0], 88_200.0), ScalingsError::Lengths { gains: 2, decays: 1 });
    assert_eq!(refusal(&[], &[], 88_200.0), ScalingsError::Bands { found: 0 });
    let many = [0.0; MOST_BANDS + 1];
    assert_eq!(refusal(&many, &many, 88_200.0), ScalingsError::Bands { found: MOST_BANDS + 1 });
    assert_eq!(
        refusal(&[0.0, f64::INFINITY], &[0.0, 0.0], 88_200.0).to_string(),
        "raw gain of band 1 (counted from 0) is inf: give a finite number"
    );
    assert!(refusal(&[0.0], &[f64::NAN], 88_200.0).to_string().starts_with("raw decay of band 0"));
    assert_eq!(refusal(&[0.0], &[0.0], 0.0), ScalingsError::Rate { rate_hz: 0.0 });
    for (scalings, named) in [
        (Scalings { gain_bias: f64::NAN, ..Scalings::default() }, "gain_bias"),
        (Scalings { noise_rms: 0.0, ..Scalings::default() }, "noise_rms"),
        (Scalings { time_unit_s: -1.0, ..Scalings::default() }, "time_unit_s"),
    ] {
        let error = scalings.room(&[0.0], &[0.0], 88_200.0).expect_err("a wrong setting");
        assert!(error.to_string().starts_with(named), "{error}");
    }
}
