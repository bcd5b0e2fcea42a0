//! The shipped kit `recorded`: its tables are fits, they play, and they are near their recordings.
//!
//! The recordings lie in `../shared/data/recordings`, beside the project. Without them the tests
//! that need them are ignored. One test needs none: it compares the modes of each table with the
//! reference's sound of these modes, to which noise is added.

#[path = "../../examples/recorded_kit/nearness.rs"]
mod nearness;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use dsp_core::SampleRate;
use dsp_core::engine::{Setup, Skipping};
use dsp_core::event::{Event, Time};
use dsp_core::fixed::ONE_Q27;
use dsp_core::table::Kit;
use fit::audio::Recording;
use fit::distance::RecordedLevels;
use malleus::render::instrument::{Output, Settings};
use malleus::render::{Performance, board, instrument, reference};
use virtual_board::Board;

const RATE: SampleRate = SampleRate::HZ_48000;

fn recorded() -> kit::Loaded {
    kit::open("recorded").expect("the shipped kit is valid")
}

/// The kit without residuals, whose noise the reference leaves out.
fn modes_alone() -> kit::Loaded {
    let mut loaded = recorded();
    loaded.kit.objects.iter_mut().for_each(|object| object.residual = None);
    loaded.binary = kit::binary::build(&loaded.kit).expect("a kit without residuals is valid");
    loaded
}

fn strike(pad: usize, frame: u64, velocity: f32) -> Event {
    Event { time: Time { frame, fraction: 0x5000_0000 }, pad: pad as u8, velocity, ..Event::default() }
}

/// Stereo bus of a performance by the instrument, 1.0 = full scale.
fn play(loaded: &kit::Loaded, performance: &Performance, skipping: Skipping) -> Vec<[f64; 2]> {
    let table = Kit::parse(&loaded.binary).expect("a loaded kit is valid");
    let settings = Settings { setup: Setup { skipping, ..Setup::new(RATE) }, block: 128, budget_cycles: None };
    let bus = instrument::render(&table, performance, settings, Output::Bus, |_| {}).expect("the kit fits");
    bus.into_iter().map(|frame| frame.map(|x| f64::from(x) / f64::from(ONE_Q27))).collect()
}

fn decibels(power_ratio: f64) -> f64 {
    10.0 * power_ratio.log10()
}

fn peak_dbfs(sound: &[[f64; 2]]) -> f64 {
    decibels(sound.iter().flatten().fold(0.0, |peak: f64, x| peak.max(x * x)))
}

#[test]
fn recorded_kit_has_twelve_instruments_whose_licences_ask_for_no_credit() {
    let loaded = recorded();
    assert!(loaded.kit.pads.len() >= 12, "{}", loaded.kit.pads.len());
    let modes: usize = loaded.kit.objects.iter().map(|object| object.modes.len()).sum();
    assert!(modes <= 512, "{modes}");
    for object in &loaded.kit.objects {
        assert!(object.source.contains(".wav, strike at"), "{}: {}", object.name, object.source);
        assert!(["CC0-1.0", "MIT", "BSD-2-Clause"].contains(&object.licence.as_str()), "{}", object.licence);
    }
}

#[test]
fn each_pad_at_velocity_1_neither_clips_nor_whispers_and_softer_strikes_are_softer() {
    let loaded = recorded();
    for (index, pad) in loaded.kit.pads.iter().enumerate() {
        let peaks = [1.0, 0.8, 0.6, 0.4, 0.2, 0.1].map(|velocity| {
            let performance = Performance::new(vec![strike(index, 10, velocity)], None, &loaded.kit, RATE, Some(1.0));
            peak_dbfs(&play(&loaded, &performance, Skipping::On))
        });
        println!("{}: {peaks:.1?} dBFS", pad.name);
        // Pads are equally loud, so that one that rings for 9 s peaks 20 dB below one that lasts
        // 0.1 s. The test kit_balance compares the loudness itself.
        assert!((-24.5..=-2.5).contains(&peaks[0]), "{}: {peaks:.1?}", pad.name);
        assert!(peaks.is_sorted_by(|louder, softer| louder > softer), "{}: {peaks:.1?}", pad.name);
    }
}

#[test]
fn all_pads_played_together_stay_below_full_scale() {
    let loaded = recorded();
    let all = |gap: u64| (0..loaded.kit.pads.len()).map(move |pad| strike(pad, 10 + gap * pad as u64, 1.0)).collect();
    // All at once, and then one after another at 30 strikes per second.
    for gap in [0, 1_600] {
        let performance = Performance::new(all(gap), None, &loaded.kit, RATE, Some(1.0));
        let peak = peak_dbfs(&play(&loaded, &performance, Skipping::On));
        println!("{gap} frames apart: {peak:.1} dBFS");
        assert!(peak < 0.0, "{gap} frames apart: {peak:.1} dBFS");
    }
}

#[test]
fn modes_of_each_pad_have_90_db_of_snr_to_the_reference() {
    let loaded = modes_alone();
    for (index, pad) in loaded.kit.pads.iter().enumerate() {
        let strikes = [0.02, 0.9, 1.0, 0.4, 0.15, 0.7];
        let events = strikes.into_iter().enumerate().map(|(at, v)| strike(index, 100 + at as u64 * 7_001, v)).collect();
        let performance = Performance::new(events, None, &loaded.kit, RATE, Some(2.0));
        let expected = reference::render(&loaded.kit, &performance, RATE, |_| {}).expect("the events are valid");
        let got = play(&loaded, &performance, Skipping::Off);
        let power: f64 = expected.iter().flatten().map(|x| x * x).sum();
        let error: f64 = expected.iter().flatten().zip(got.iter().flatten()).map(|(a, b)| (a - b).powi(2)).sum();
        println!("{}: {:.1} dB", pad.name, decibels(power / error));
        assert!(decibels(power / error) >= 90.0, "{}: {:.1} dB", pad.name, decibels(power / error));
    }
}

/// Log-spectral distance in dB from a recording's first strike to the instrument's sound of a
/// table.
pub(crate) fn distance_db(recording: &Recording, table: &kit::Kit) -> f64 {
    let (found, _) = fit::segment::hits(recording).expect("it holds a strike");
    let (before, heard) = recording.samples[..found[0].end].split_at(found[0].onset);
    let sound = fit::render::by_instrument(table, 0.0, recording.rate_hz, heard.len()).expect("it plays");
    RecordedLevels::new(before, heard, recording.rate_hz).lsd_db(&sound)
}

/// Does work on a large stack, on which the engine that renders a single table is built.
pub(crate) fn on_a_large_stack(work: impl FnOnce() + Send + 'static) {
    let working = std::thread::Builder::new().stack_size(64 << 20).spawn(work);
    working.expect("a thread starts").join().expect("every table is near its sound");
}

/// Recording of the strike of a table's modes by the reference, with noise 70 dB below its peak.
///
/// A tenth of a second of silence precedes the strike, which lasts 3 s.
fn by_reference_with_noise(table: &kit::Kit) -> Recording {
    const RATE_HZ: f64 = 44_100.0;
    let sound = fit::render::by_reference(table, 0.0, RATE_HZ, 132_300).expect("it plays");
    let peak = sound.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let mut samples = vec![0.0; 4_410];
    samples.extend(sound.iter().map(|x| 0.5 * x / peak));
    let mut state = 1u64;
    for sample in &mut samples {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // Uniform noise with an rms of 1.
        let noise = ((state >> 33) as f64 / (1u64 << 31) as f64 - 0.5) * 12f64.sqrt();
        *sample += 0.5 * 10f64.powf(-70.0 / 20.0) * noise;
    }
    Recording { samples, offset: 0.0, force: None, flat_tops: Vec::new(), rate_hz: RATE_HZ, notes: Vec::new() }
}

#[test]
fn modes_of_each_table_are_nearer_to_their_own_noisy_sound_than_another_table() {
    on_a_large_stack(|| {
        let names: Vec<String> = recorded().kit.objects.into_iter().map(|object| object.name).collect();
        let mut tables: Vec<kit::Kit> =
            names.iter().map(|name| kit::load(&table_path(name)).expect("a table").kit).collect();
        tables.iter_mut().flat_map(|table| &mut table.objects).for_each(|object| object.residual = None);
        for (index, (name, table)) in names.iter().zip(&tables).enumerate() {
            let recording = by_reference_with_noise(table);
            let [own, other] = [index, (index + 1) % tables.len()].map(|index| distance_db(&recording, &tables[index]));
            println!("{name}: LSD {own:.2} dB, of another table {other:.2} dB");
            assert!(own <= 0.6 && other > 2.0, "{name}: {own:.2} dB, of another table {other:.2} dB");
        }
    });
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn each_table_is_within_3_5_db_of_its_recording() {
    on_a_large_stack(|| {
        for object in recorded().kit.objects {
            let (file, _) = object.source.split_once(',').expect("the source begins with the file");
            let path = Path::new(env!("SHARED_DATA")).join("recordings").join(file);
            let recording = fit::audio::read(&path, None).expect("the recording is readable");
            let table = kit::load(&table_path(&object.name)).expect("the table is in the repository");
            let lsd_db = distance_db(&recording, &table.kit);
            println!("{}: LSD {lsd_db:.2} dB", object.name);
            assert!(lsd_db <= 3.5, "{}: {lsd_db:.2} dB", object.name);
        }
    });
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn tables_have_a_median_erb_distance_of_0_6_db_and_a_loudness_error_of_0_08() {
    on_a_large_stack(|| {
        let (mut erb_db, mut loudness) = (Vec::new(), Vec::new());
        for object in recorded().kit.objects {
            let table = kit::load(&table_path(&object.name)).expect("the table is in the repository").kit;
            let near = nearness::of(&table, &Path::new(env!("SHARED_DATA")).join("recordings")).expect("both play");
            let scores = near.scores;
            println!(
                "{}: ERB distance {:.2} dB, loudness error {:.3}, LSD {:.2} dB, peak {:+.1} dB, first 3 ms {:+.1} dB",
                object.name, scores.erb_db, scores.loudness_error, scores.lsd_db, near.peak_db, near.attack_db
            );
            // A click at the start would be louder than that of the recording.
            assert!(near.attack_db <= 3.0 && near.peak_db <= 4.0, "{}: {near:.1?}", object.name);
            erb_db.push(scores.erb_db);
            loudness.push(scores.loudness_error);
        }
        let [erb_db, median] = [&erb_db, &loudness].map(|values| fit::score::quantile(values, 0.5));
        let worst = loudness.into_iter().fold(0.0, f64::max);
        println!("medians: ERB distance {erb_db:.2} dB, loudness error {median:.3}; at worst {worst:.3}");
        assert!(erb_db <= 0.60 && median <= 0.080 && worst <= 0.245, "{erb_db:.2} dB, {median:.3}, {worst:.3}");
    });
}

/// Names of the pads whose residual a board leaves out, by its plan.
fn pads_without_noise_on(board: Board) -> Vec<String> {
    let loaded = recorded();
    let plan = board::plan(board, &Kit::parse(&loaded.binary).expect("a loaded kit is valid")).expect("the kit plays");
    let reasons: Vec<String> = plan.left_out.iter().map(ToString::to_string).collect();
    let left_out = |pad: usize| reasons.iter().any(|reason| reason.starts_with(&format!("pad {pad}, residual")));
    let pads: Vec<usize> = (0..loaded.kit.pads.len()).filter(|&pad| left_out(pad)).collect();
    assert_eq!(pads.len(), reasons.len(), "only residuals are left out: {reasons:?}");
    pads.into_iter().map(|pad| loaded.kit.pads[pad].name.clone()).collect()
}

#[test]
fn f407_board_plays_noise_of_the_first_five_pads_and_blackpill_of_none() {
    let names: Vec<String> = recorded().kit.pads.into_iter().map(|pad| pad.name).collect();
    assert_eq!(pads_without_noise_on(Board::Stm32f407gDisc1), names[5..]);
    assert_eq!(pads_without_noise_on(Board::BlackpillF411), names);
    let check =
        Command::new(env!("CARGO_BIN_EXE_malleus")).args(["kit", "check", "recorded"]).output().expect("it runs");
    let text = String::from_utf8_lossy(&check.stdout);
    assert!(check.status.success() && !text.contains("refuses") && !text.contains("clip"), "{text}");
    for (board, count) in [("stm32f407g-disc1", 9), ("blackpill-f411", 14)] {
        let said = text.matches(&format!("recorded: {board} leaves out: pad ")).count();
        assert_eq!(said, count, "{text}");
    }
}

#[cfg(not(has_shared_data))]
#[test]
fn recordings_are_absent_as_they_were_when_this_was_built() {
    let data = Path::new(env!("SHARED_DATA"));
    assert!(!data.is_dir(), "{} is there now: run `touch build/shared_data.rs` and test again", data.display());
}

fn table_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tables/recorded").join(format!("{name}.toml"))
}

#[test]
fn program_plays_the_recorded_kit_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let (strikes, sound) = (folder.path().join("s.csv"), folder.path().join("out.wav"));
    fs::write(&strikes, "time_s,pad,velocity\n0,tabla,1\n0.2,handbell,0.7\n").expect("it is written");
    let output = Command::new(env!("CARGO_BIN_EXE_malleus"))
        .args(["play", "--kit", "recorded", "--tail", "0.5", "--strikes"])
        .args([strikes.as_os_str(), "-o".as_ref(), sound.as_os_str()])
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let loudest = hound::WavReader::open(&sound).expect("a WAV file").into_samples::<i32>().map_while(Result::ok);
    assert!(loudest.map(i32::abs).max() > Some(1 << 20));
}
