//! The room against its reference, against its arithmetic twin in `f64`, and under stress.

use dsp_core::SampleRate;
use dsp_core::room::RoomError;
use host_tests::room::{
    Answer, LARGE, SMALL, Table, answer, crest_db, echo_density_per_s, energy, frames_needed, impulse_response,
    mean_and_rms, octave_tables, random_tables, room,
};
use host_tests::sweeps::{self, Extent};
use proptest::prelude::*;
use reference::RoomBand;

const RATE: SampleRate = SampleRate::HZ_48000;

/// SNR in dB of a room against its arithmetic twin in `f64`, both sides together.
fn snr_db(table: &Table, answers: [Vec<f64>; 2], dry: &[f64], samples: usize) -> f64 {
    let bands: Vec<RoomBand> = table
        .records()
        .iter()
        .map(|band| RoomBand {
            from_hz: f64::from(band.from_hz.get()),
            gain: f64::from(band.gain.get()),
            decay_per_s: f64::from(band.decay_per_s.get()),
        })
        .collect();
    let rate = reference::SampleRate { numerator: 48_000, denominator: 1 };
    let twin = reference::network_twin(&bands, [dry, dry], rate, samples);
    let (mut signal, mut noise) = (0.0, 0.0);
    for (twin, answer) in twin.iter().zip(&answers) {
        signal += energy(twin);
        noise += twin.iter().zip(answer).map(|(twin, answer)| (twin - answer).powi(2)).sum::<f64>();
    }
    10.0 * (signal / noise).log10()
}

#[test]
fn room_follows_its_twin_to_90_db_in_32_bits_and_to_its_storage_in_16() {
    const FRAMES: usize = 48_000;
    let at = |frame: usize| frame as f64 / RATE.hz();
    let mut seed = 1u32;
    let mut random = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(seed as i32) / 2_147_483_648.0
    };
    // The tones outlast the room, so they keep its delay lines full while its level falls.
    let tones = |hz: &[f64], frame: usize| {
        let sum: f64 = hz.iter().map(|hz| (std::f64::consts::TAU * hz * at(frame)).sin()).sum();
        0.4 / hz.len() as f64 * (-0.7 * at(frame)).exp() * sum
    };
    let sounds: [(&str, Vec<f64>); 4] = [
        ("an impulse", (0..FRAMES).map(|frame| if frame == 0 { 0.9 } else { 0.0 }).collect()),
        ("noise", (0..FRAMES).map(|frame| if frame < 24_000 { 0.5 * random() } else { 0.0 }).collect()),
        ("a tone", (0..FRAMES).map(|frame| tones(&[523.25], frame)).collect()),
        ("four tones", (0..FRAMES).map(|frame| tones(&[523.25, 1413.0, 2719.0, 4421.0], frame)).collect()),
    ];
    let [four, eight] = octave_tables(6.0);
    let [short, _] = octave_tables(0.3);
    let tables =
        [four, eight, short, Table::even(&[], 20.0, 1.0), Table::even(&[], 0.5, 3.0), Table::even(&[1000.0], 0.2, 3.0)];
    let mut worst = [f64::MAX; 2];
    for (table, (sound, dry)) in tables.iter().flat_map(|table| sounds.iter().map(move |sound| (table, sound))) {
        let wide = snr_db(table, answer::<i32, LARGE>(table, RATE, dry).unwrap(), dry, LARGE);
        let narrow = snr_db(table, answer::<i16, LARGE>(table, RATE, dry).unwrap(), dry, LARGE);
        println!(
            "{} bands, T60 {} s, {sound}: 32 bits {wide:.1} dB, 16 bits {narrow:.1} dB",
            table.bands.len(),
            table.bands[0].t60_s
        );
        worst = [worst[0].min(wide), worst[1].min(narrow)];
    }
    assert!(worst[0] >= 90.0 && worst[1] >= 49.0, "{worst:?}");
}

#[test]
fn decays_and_energies_follow_the_table_as_far_as_an_ideal_room_does() {
    sweeps::room::decays_and_energies(Extent::Tenth);
}

#[test]
fn echoes_are_dense_within_100_ms_and_late_spectra_near_noise() {
    let hz = RATE.hz();
    for table in octave_tables(6.0) {
        let large = impulse_response::<i16, LARGE>(&table, RATE, 120_000).unwrap();
        let small = impulse_response::<i16, SMALL>(&table, RATE, 120_000).unwrap();
        let density = echo_density_per_s(&large[0][3840..4800], hz);
        let crest = |sides: &[Vec<f64>; 2]| {
            let sum: f64 = sides
                .iter()
                .flat_map(|side| [48_000, 72_000].map(|start| &side[start..start + 48_000]))
                .map(|window| crest_db(window, 100.0, 20_000.0, hz))
                .sum();
            sum / 4.0
        };
        // Noise of this length has 10.4 dB. The limit is 3 dB more with 48 KB, and 6 dB more with
        // 16 KB.
        println!(
            "{} bands: {density:.0} echoes a second; crest {:.1} and {:.1} dB",
            table.bands.len(),
            crest(&large),
            crest(&small)
        );
        assert!(density >= 1000.0 && crest(&large) <= 13.4 && crest(&small) <= 16.4);
    }
}

#[test]
fn bad_tables_are_refused_by_name() {
    let refusal = |bands: &[(f64, f64, f64)]| {
        let bands = bands.iter().map(|&(from_hz, t60_s, gain)| host_tests::room::TableBand { from_hz, t60_s, gain });
        room::<i16>(&Table { bands: bands.collect() }, RATE, SMALL).unwrap_err()
    };
    let fine = (0.0, 1.0, 1.0);
    assert!(matches!(refusal(&[(100.0, 1.0, 1.0)]), RoomError::EdgesOutOfOrder { band: 0, .. }));
    assert!(matches!(
        refusal(&[fine, (900.0, 1.0, 1.0), (800.0, 1.0, 1.0)]),
        RoomError::EdgesOutOfOrder { band: 2, .. }
    ));
    assert!(matches!(refusal(&[fine, (f64::NAN, 1.0, 1.0)]), RoomError::EdgesOutOfOrder { band: 1, .. }));
    assert!(matches!(refusal(&[fine, (24_000.0, 1.0, 1.0)]), RoomError::EdgeAboveNyquist { band: 1, .. }));
    assert!(matches!(refusal(&[(0.0, -1.0, 1.0)]), RoomError::Decay { band: 0, .. }));
    assert!(matches!(refusal(&[(0.0, 0.0, 1.0)]), RoomError::Decay { .. }));
    assert!(matches!(refusal(&[(0.0, 1.0, f64::NAN)]), RoomError::Gain { .. }));
    let many: Vec<_> = (0..9).map(|band| (f64::from(band) * 100.0, 1.0, 1.0)).collect();
    assert!(matches!(refusal(&many), RoomError::TooManyBands { bands: 9, capacity: 8 }));
    assert!(matches!(
        room::<i16>(&octave_tables(1.0)[0], RATE, 100),
        Err(RoomError::TooFewSamples { capacity: 100, .. })
    ));
}

/// Tables of all kinds that a kit may hold, also at the edges of its ranges.
fn any_table() -> impl Strategy<Value = Table> {
    let value = |low: f64, high: f64| prop_oneof![2 => (0.0..1.0f64).prop_map(move |part| low * (high / low).powf(part)), 1 => Just(low), 1 => Just(high)];
    let band = (1.02..6.0f64, value(0.0461, 22.9), value(1e-3, 99.0));
    (20.0..4000.0f64, prop::collection::vec(band, 1..=8)).prop_map(|(lowest_hz, bands)| {
        let mut from_hz = 0.0;
        let mut next = |ratio: f64| {
            let now = from_hz;
            from_hz = if now == 0.0 { lowest_hz } else { now * ratio };
            now
        };
        let bands = bands.into_iter().map(|(ratio, t60_s, gain)| host_tests::room::TableBand {
            from_hz: next(ratio),
            t60_s,
            gain,
        });
        Table { bands: bands.take_while(|band| band.from_hz < 23_000.0).collect() }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn any_table_under_any_noise_stays_bounded_and_gives_the_same_bits_for_any_block(
        table in any_table(), level in 0u32..=31, block in 1usize..200, seed: u32,
    ) {
        let mut state = seed | 1;
        // The noise is up to the whole range of the bus. Debug builds check every addition.
        let dry: Vec<[i32; 2]> = (0..6000).map(|frame| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let x = (state as i32) >> (31 - level);
            if frame % 1500 < 700 { [x, if seed % 2 == 0 { x } else { -(x / 2) }] } else { [0; 2] }
        }).collect();
        let play = |block: usize| {
            room::<i16>(&table, RATE, SMALL).map(|mut room| {
                let mut out = dry.clone();
                out.chunks_mut(block).for_each(|block| room.render(block));
                out
            })
        };
        match (play(usize::MAX), play(block)) {
            (Ok(whole), Ok(cut)) => prop_assert_eq!(whole, cut),
            (whole, cut) => prop_assert_eq!(whole.is_err(), cut.is_err()),
        }
    }
}

#[test]
fn loud_and_long_input_is_bounded_and_its_tail_ends_in_exact_silence() {
    for t60_s in [0.05, 2.0] {
        let table = Table::even(&[200.0, 3000.0], t60_s, 1.0);
        let mut wide = room::<i32>(&table, RATE, SMALL).unwrap();
        let mut room = room::<i16>(&table, RATE, SMALL).unwrap();
        for frame in 0..48_000 {
            // The input is a square wave at the very edge of the bus.
            let x = if frame / 100 % 2 == 0 { i32::MAX } else { i32::MIN };
            room.render(&mut [[x; 2]]);
            wide.render(&mut [[x; 2]]);
        }
        let mut out = vec![[0; 2]; (48_000.0 * (t60_s * 3.0 + 1.0)) as usize];
        room.render(&mut out);
        assert!(room.is_silent() && out.ends_with(&[[0; 2]; 4000]), "T60 {t60_s}: {:?}", out.last());
        out.fill([0; 2]);
        wide.render(&mut out);
        assert!(wide.is_silent(), "32 bits, T60 {t60_s}");
    }
}

#[test]
fn an_impulse_of_full_scale_does_not_clip() {
    // Twice the impulse gives twice the answer, unless it clips.
    for table in octave_tables(6.0) {
        let mut dry = vec![0.0; 24_000];
        dry[0] = 0.5;
        let half = answer::<i32, LARGE>(&table, RATE, &dry).unwrap();
        dry[0] = 1.0;
        let whole = answer::<i32, LARGE>(&table, RATE, &dry).unwrap();
        let difference = whole[0].iter().zip(&half[0]).map(|(whole, half)| (whole - 2.0 * half).powi(2)).sum::<f64>();
        let db = 10.0 * (energy(&whole[0]) / difference).log10();
        println!("{} bands: {db:.1} dB", table.bands.len());
        assert!(db >= 70.0, "{db}");
    }
}

/// Frames of impulses that meet the network's moving angle at different places.
const STARTS: [usize; 4] = [0, 3000, 13_000, 21_000];

#[test]
fn wet_energy_does_not_depend_on_the_pan() {
    let mut worst = [0.0f64; 2];
    for table in random_tables(4, 3, 4.0, 6.0, 8) {
        let frames = frames_needed(&table, RATE.hz());
        let of = |pan| Answer::of_instrument(&table, RATE, pan, 0, frames);
        let sides = [-1.0, 1.0].map(|pan| of(pan).energy());
        let side = 0.5 * (sides[0] + sides[1]);
        let balance = of(-1.0).balance_db();
        for pan in [-1.0, -0.5, 0.0, 0.3, 1.0] {
            let answer = of(pan);
            let db = 10.0 * (answer.energy() / side).log10();
            println!("pan {pan}: {db:.2} dB, left above right {:.2} dB", answer.balance_db());
            worst = [worst[0].max(db.abs()), worst[1].max((answer.balance_db() - balance).abs())];
        }
    }
    println!("a pan's effect: energy {:.2} dB, balance {:.2} dB", worst[0], worst[1]);
    assert!(worst[0] <= 0.6 && worst[1] <= 0.3, "{worst:?}");
}

#[test]
fn left_and_right_are_within_0_3_db_in_the_mean_over_random_tables() {
    for bands in [4, 8] {
        let mut balances = Vec::new();
        for table in random_tables(bands, 3, 4.0, 6.0, 9) {
            let frames = frames_needed(&table, RATE.hz());
            for start in STARTS {
                balances.push(Answer::of_instrument(&table, RATE, 0.0, start, frames).balance_db());
            }
        }
        let (mean, rms) = mean_and_rms(&balances);
        println!("{bands} bands: left above right {mean:.2} dB in the mean, {rms:.2} dB rms; {balances:.2?}");
        assert!(mean.abs() <= 0.3 && rms <= 1.0, "{bands} bands: {mean:.2}, {rms:.2} dB");
    }
}

#[test]
fn wet_sound_begins_when_the_docs_say() {
    // Columns: rate in Hz, onsets in ms for T60s of 0.3, 1 and 3 s.
    for (numerator, ms) in [(44_100, [11.9, 26.3, 27.8]), (48_000, [11.2, 24.7, 27.2]), (96_000, [8.6, 22.7, 24.7])] {
        let rate = SampleRate::new(numerator, 1).unwrap();
        for (t60_s, expected_ms) in [0.3, 1.0, 3.0].into_iter().zip(ms) {
            for table in octave_tables(t60_s) {
                let answer = Answer::of_instrument(&table, rate, 0.0, 0, numerator as usize / 10);
                let ms = 1000.0 * answer.onset_s(rate.hz());
                println!("{numerator} Hz, {} bands, T60 {t60_s} s: {ms:.1} ms", table.bands.len());
                assert!((ms - expected_ms).abs() <= 0.5, "{ms:.1} ms");
            }
        }
    }
}

#[test]
fn instrument_and_law_agree_in_decay_energy_balance_and_correlation() {
    let hz = RATE.hz();
    // For instrument and reference: errors of T60, errors of energy, balances, correlations.
    let mut all = [(); 2].map(|()| [(); 4].map(|()| Vec::new()));
    for (index, table) in random_tables(4, 4, 2.0, 6.0, 10).into_iter().enumerate() {
        let frames = frames_needed(&table, hz);
        let answers = [
            Answer::of_instrument(&table, RATE, 0.4, STARTS[index % 4], frames),
            Answer::of_reference(&table, RATE, 0.4, frames, index as u64),
        ];
        for (answer, [t60s, energies, balances, correlations]) in answers.iter().zip(&mut all) {
            for error in answer.band_errors(&table, hz).iter().filter(|error| error.samples >= 300.0) {
                t60s.push(error.t60);
                energies.push(error.energy_db);
            }
            balances.push(answer.balance_db());
            correlations.push(answer.correlation());
        }
    }
    for (who, figures) in ["instrument", "reference"].iter().zip(&all) {
        let [t60, energy, balance, correlation] = figures.each_ref().map(|values| mean_and_rms(values));
        println!(
            "{who}: T60 {:+.1} %, rms {:.1} %; energy {:+.2} dB, rms {:.2}; balance {:+.2} dB, rms {:.2}; correlation {:+.3}, rms {:.3}",
            100.0 * t60.0,
            100.0 * t60.1,
            energy.0,
            energy.1,
            balance.0,
            balance.1,
            correlation.0,
            correlation.1
        );
        assert!(t60.0.abs() <= 0.02 && t60.1 <= 0.05, "{who}: T60 {t60:?}");
        assert!(energy.0.abs() <= 0.5 && energy.1 <= 0.7, "{who}: energy {energy:?}");
        assert!(balance.0.abs() <= 0.4 && balance.1 <= 0.7, "{who}: balance {balance:?}");
        assert!(correlation.1 <= 0.12, "{who}: correlation {correlation:?}");
    }
}
