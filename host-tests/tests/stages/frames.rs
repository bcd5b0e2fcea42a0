//! Banks in frames against the exact responses of their modes.

use std::path::{Path, PathBuf};

use dsp_core::SampleRate;
use dsp_core::frames::BLOCK_FRAMES;
use fit::audio::read;
use fit::bins;
use fit::modes::DampedSine;
use fit::segment::hits;
use host_tests::frames::{FramesOnPc, HeardMode, contact, prior};
use host_tests::snr::{Random, snr_db};

const RATE: SampleRate = SampleRate::HZ_44100;
const ONE: f64 = (1 << 27) as f64;

/// Sound of modes under a force that begins at a frame, and their exact response, from that frame
/// on.
fn both(modes: &[HeardMode], force: &[i32], start: usize, frames: usize) -> (Vec<i32>, Vec<f64>) {
    let mut whole = vec![0; start + frames];
    whole[start..start + force.len()].copy_from_slice(force);
    let sound = FramesOnPc::new(modes, RATE, false).render(&whole, 32);
    assert!(sound[..start].iter().all(|&y| y == 0), "sound before the strike");
    let force: Vec<f64> = force.iter().map(|&x| f64::from(x)).collect();
    let mut exact = vec![0.0; frames];
    modes.iter().for_each(|mode| mode.add_response(RATE, &force, &mut exact));
    (sound[start..].to_vec(), exact)
}

fn peak(exact: &[f64]) -> f64 {
    exact.iter().fold(0.0, |peak, y| peak.max(y.abs()))
}

/// Worst SNR of modes that one sample strikes at a random frame of a block, by T60, over at most 2
/// s; docs/frames.md has the figures.
#[test]
fn modes_in_frames_keep_the_snr_of_the_page() {
    let mut random = Random::new(1);
    let page = [
        (0.002, 124.4, 91.2),
        (0.005, 116.6, 101.0),
        (0.01, 108.5, 104.9),
        (0.02, 109.3, 104.1),
        (0.05, 105.2, 101.3),
        (0.2, 122.4, 117.0),
        (1.0, 119.4, 115.9),
        (5.0, 110.5, 111.3),
        (20.0, 105.8, 105.8),
    ];
    let mut off = Vec::new();
    for (t60_s, full_db, quieter_db) in page {
        for (level, stated_db) in [(1.0, full_db), (0.01, quieter_db)] {
            let [mut worst_db, mut of_bus_db, mut peak_db] = [f64::INFINITY; 3];
            for step in 0..160 {
                let frequency_hz = 20.0 * 1000f64.powf(f64::from(step) / 159.0);
                let phase = random.between(0.0, std::f64::consts::TAU);
                let mode = HeardMode { frequency_hz, t60_s, sine: phase.sin(), cosine: phase.cos() };
                let start = random.between(0.0, BLOCK_FRAMES as f64) as usize;
                let frames = (t60_s.min(2.0) * RATE.hz()) as usize;
                let (sound, exact) = both(&[mode], &[(ONE * level) as i32], start, frames);
                let bus: Vec<i32> = exact.iter().map(|y| y.round() as i32).collect();
                let (got_db, bus_db) = (snr_db(&exact, &sound), snr_db(&exact, &bus));
                if got_db < worst_db {
                    (worst_db, of_bus_db, peak_db) = (got_db, bus_db, 20.0 * (peak(&exact) / ONE).log10());
                }
            }
            println!(
                "T60 {t60_s} s, level {level}: worst {worst_db:.1} dB, where the bus's step leaves {of_bus_db:.1} dB of \
                 a sound that peaks at {peak_db:.1} dBFS"
            );
            off.extend((worst_db < stated_db - 1.5).then_some((t60_s, level, worst_db)));
            // Below 96 dB nothing but the step of the bus is in the way.
            off.extend((worst_db < 96.0 && worst_db < of_bus_db - 1.0).then_some((t60_s, level, of_bus_db)));
        }
    }
    assert!(off.is_empty(), "below the page: {off:.1?}");
}

#[test]
fn thousand_modes_sound_alike_at_every_frame_of_two_blocks() {
    let modes = prior(1025, [0.01, 3.0]);
    let (force, frames) = (contact(60), 6000);
    let (_, exact) = both(&modes, &force, 0, frames);
    let peak = peak(&exact);
    let mut worst = 0.0f64;
    for start in (0..2 * BLOCK_FRAMES).step_by(31).chain([255, 256, 257]) {
        let (sound, _) = both(&modes, &force, start, frames);
        worst = sound.iter().zip(&exact).fold(worst, |worst, (&y, exact)| worst.max((f64::from(y) - exact).abs()));
    }
    let worst_db = 20.0 * (worst / peak).log10();
    println!("largest error over all starts: {worst_db:.1} dB of the peak");
    assert!(worst_db < -119.0, "{worst_db:.1} dB");
}

#[test]
fn retired_modes_leave_silence_and_little_behind() {
    let modes = prior(300, [0.02, 0.5]);
    let mut force = contact(60);
    force.resize(3 * 44_100, 0);
    let mut frames = FramesOnPc::new(&modes, RATE, true);
    let sound = frames.render(&force, 32);
    let whole = FramesOnPc::new(&modes, RATE, false).render(&force, 32);
    let missing = sound.iter().zip(&whole).map(|(a, b)| f64::from(a - b).abs()).fold(0.0, f64::max);
    let missing_db = 20.0 * (missing / ONE).log10();
    println!("retirement adds {missing_db:.1} dBFS");
    assert!(missing_db < -100.0 && frames.is_silent());
    assert!(sound.iter().rev().take(1000).all(|&y| y == 0));
}

#[test]
fn long_tail_follows_the_law_for_ninety_decibels() {
    for t60_s in [20.0, 120.0] {
        let mode = HeardMode { frequency_hz: 440.3, t60_s, sine: 1.0, cosine: 0.0 };
        let frames = (t60_s * 1.5 * RATE.hz()) as usize;
        let mut force = vec![0; frames];
        force[0] = ONE as i32;
        let sound = FramesOnPc::new(&[mode], RATE, false).render(&force, 32);
        let decay_per_s = 1000f64.ln() / t60_s;
        let mut worst = 0.0f64;
        for (chunk, sound) in sound.chunks_exact(4410).enumerate().step_by(50) {
            let middle = decay_per_s * (chunk as f64 + 0.5) * 0.1;
            let rms = (sound.iter().map(|&y| f64::from(y).powi(2)).sum::<f64>() / sound.len() as f64).sqrt();
            // A tenth of a second holds 44.03 periods: the rms is that of a sine within 0.01 dB.
            let off_db = 20.0 * (rms * 2f64.sqrt() / ONE * middle.exp()).log10();
            worst = worst.max(off_db.abs());
        }
        println!("T60 {t60_s} s: envelope within {worst:.3} dB over 90 dB");
        assert!(worst < 0.05, "T60 {t60_s} s: {worst:.3} dB");
    }
}

#[test]
fn strikes_at_two_positions_sound_as_their_gains_say() {
    let first = prior(200, [0.01, 1.0]);
    let mut second = prior(201, [0.01, 1.0]);
    second.truncate(200);
    let between = |fraction: f64| -> Vec<HeardMode> {
        let mix = |a: f64, b: f64| a + (b - a) * fraction;
        let modes = first.iter().zip(&second);
        modes.map(|(a, b)| HeardMode { sine: mix(a.sine, b.sine), cosine: mix(a.cosine, b.cosine), ..*a }).collect()
    };
    let mut frames = FramesOnPc::with_positions(&[first.clone(), second.clone()], RATE, false);
    let (mut sound, length, hits) = (Vec::new(), 12_000, [(0.0, 0), (0.3, 100), (0.0, 400), (1.0, 3000), (0.55, 3200)]);
    let mut exact = vec![0.0; length];
    let force = contact(60);
    for (index, (position, start)) in hits.into_iter().enumerate() {
        let end = hits.get(index + 1).map_or(length, |next| next.1);
        let slot = frames.strike_at(position as f32).expect("a free slot");
        let mut run = vec![0; end - start];
        run[..60].copy_from_slice(&force);
        sound.extend(frames.render_in(slot, &run, 32));
        let mut whole = vec![0.0; length];
        whole.iter_mut().skip(start).zip(&force).for_each(|(x, &force)| *x = f64::from(force));
        between(position).iter().for_each(|mode| mode.add_response(RATE, &whole, &mut exact));
    }
    let snr_db = snr_db(&exact, &sound);
    println!("strikes at four positions: {snr_db:.1} dB");
    assert!(snr_db > 116.0, "{snr_db:.1} dB");
    assert_eq!(frames.strike_at(0.8), Some(0), "both are free again");
}

/// Modes of a recording's first strike over 0.25 s, as the bins estimator has them, and their exact
/// response to a force. They are so loud that it peaks between a quarter and a half of full scale.
fn bins_under(path: &Path, force: &[i32]) -> (Vec<HeardMode>, Vec<f64>) {
    let recording = read(path, None).expect("the recording is readable");
    assert_eq!(recording.rate_hz, RATE.hz());
    let (found, _) = hits(&recording).expect("it holds a strike");
    let end = (found[0].onset + 11_025).min(recording.samples.len());
    let modes = bins::estimate(&recording.samples[found[0].onset..end], recording.rate_hz);
    let heard = |mode: &DampedSine| {
        let t60_s = 1000f64.ln() / mode.decay_per_s;
        HeardMode { frequency_hz: mode.frequency_hz, t60_s, sine: mode.amplitude, cosine: 0.0 }
    };
    let mut modes: Vec<HeardMode> = modes.iter().map(heard).collect();
    let force: Vec<f64> = force.iter().map(|&x| f64::from(x)).collect();
    let mut exact = vec![0.0; force.len()];
    modes.iter().for_each(|mode| mode.add_response(RATE, &force, &mut exact));
    // A power of two changes no rounding of the gains.
    let scale = 2f64.powf((0.5 * ONE / peak(&exact)).log2().floor());
    modes.iter_mut().for_each(|mode| mode.sine *= scale);
    exact.iter_mut().for_each(|y| *y *= scale);
    (modes, exact)
}

/// Five strikes within half a second: contacts of 0.3 to 6 ms, two of them 1.2 ms apart across the
/// edge of a block.
fn strikes() -> Vec<i32> {
    let mut force = vec![0; 22_050];
    let edge = 9 * BLOCK_FRAMES;
    for (start, samples) in [(0, 44), (edge - 20, 13), (edge + 33, 100), (6000, 265), (13_000, 30)] {
        force[start..].iter_mut().zip(contact(samples)).for_each(|(force, x)| *force += x);
    }
    force
}

/// Largest error in dB of the peak, and worst SNR of 10 ms that are louder than -60 dB.
fn errors_db(exact: &[f64], sound: &[i32]) -> (f64, f64) {
    let peak = peak(exact);
    let largest = exact.iter().zip(sound).fold(0.0f64, |largest, (x, &y)| largest.max((x - f64::from(y)).abs()));
    let loud = exact.chunks(441).zip(sound.chunks(441)).filter(|(exact, _)| {
        let rms = (exact.iter().map(|x| x * x).sum::<f64>() / exact.len() as f64).sqrt();
        rms > peak * 1e-3
    });
    let worst = loud.map(|(exact, sound)| snr_db(exact, sound)).fold(f64::INFINITY, f64::min);
    (20.0 * (largest / peak).log10(), worst)
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn priors_of_all_recordings_stay_within_the_errors_of_the_page() {
    let data = Path::new(env!("SHARED_DATA"));
    let mut paths: Vec<PathBuf> = std::fs::read_dir(data.join("recordings"))
        .expect("the folder of the recordings")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "wav"))
        .collect();
    paths.sort();
    assert!(paths.len() >= 28, "{} recordings", paths.len());
    let hammer = read(&data.join("hammer/hammer_ceramic.wav"), Some(1)).expect("the recording is readable");
    let measured = hammer.force.expect("channel 1 holds the force");
    let measured: Vec<i32> = measured.iter().take(22_050).map(|x| (x * ONE) as i32).collect();
    let mut worst = [(f64::NEG_INFINITY, f64::INFINITY); 2];
    let mut most_modes = 0;
    for (index, path) in paths.iter().enumerate() {
        // The measured force on every fourth: it is the milder case by 12 dB.
        let forces = [Some(strikes()), index.is_multiple_of(4).then(|| measured.clone())];
        for (force, worst) in forces.into_iter().zip(&mut worst) {
            let Some(force) = force else { continue };
            let (modes, exact) = bins_under(path, &force);
            most_modes = most_modes.max(modes.len());
            let sound = FramesOnPc::new(&modes, RATE, false).render(&force, 32);
            let (largest_db, window_db) = errors_db(&exact, &sound);
            assert!(largest_db < -112.0 && window_db > 85.0, "{}: {largest_db:.1}, {window_db:.1}", path.display());
            *worst = (worst.0.max(largest_db), worst.1.min(window_db));
        }
    }
    let [struck, driven] = worst;
    println!("{} recordings, up to {most_modes} modes", paths.len());
    println!("five strikes: error {:.1} dB of the peak, 10 ms at least {:.1} dB", struck.0, struck.1);
    println!("measured force: error {:.1} dB of the peak, 10 ms at least {:.1} dB", driven.0, driven.1);
}

#[test]
fn any_table_under_any_force_ends_in_exact_silence_with_the_bits_of_any_run() {
    let mut random = Random::new(3);
    for case in 0..24 {
        let mode = |random: &mut Random| {
            let between = |random: &mut Random, low: f64, high: f64| low * (high / low).powf(random.between(0.0, 1.0));
            let edges = [1.0, 0.4999 * RATE.hz(), 5000.0, 5000.0, between(random, 1.0, 22_000.0)];
            let gain = between(random, 1e-6, 16_000.0);
            let phase = random.between(0.0, std::f64::consts::TAU);
            HeardMode {
                frequency_hz: edges[random.between(0.0, 5.0) as usize],
                t60_s: between(random, 0.0008, 0.2),
                sine: gain * phase.sin(),
                cosine: gain * phase.cos(),
            }
        };
        let modes: Vec<HeardMode> = (0..1 + case * 3).map(|_| mode(&mut random)).collect();
        let mut force = vec![0; 2 * 44_100];
        let start = random.between(0.0, 600.0) as usize;
        for x in &mut force[start..start + 1000] {
            *x = match random.between(0.0, 4.0) as u8 {
                0 => i32::MIN,
                1 => i32::MAX,
                2 => random.between(-1e9, 1e9) as i32,
                _ => 0,
            };
        }
        let mut ticks = FramesOnPc::new(&modes, RATE, true);
        let sound = ticks.render(&force, 32);
        assert!(ticks.is_silent() && sound.iter().rev().take(100).all(|&y| y == 0), "case {case} rings on");
        let run = random.between(1.0, 31.0) as usize;
        assert_eq!(FramesOnPc::new(&modes, RATE, true).render(&force, run), sound, "case {case}, runs of {run}");
    }
}

#[test]
fn mode_that_lives_in_the_head_alone_leaves_nothing_in_the_frames() {
    let mode = HeardMode { frequency_hz: 3000.0, t60_s: 0.002, sine: 0.7, cosine: 0.7 };
    let mut force = vec![0; 4000];
    force[200..260].copy_from_slice(&contact(60));
    let mut frames = FramesOnPc::new(&[mode], RATE, true);
    let sound = frames.render(&force, 32);
    let mut exact = vec![0.0; force.len()];
    mode.add_response(RATE, &force.iter().map(|&x| f64::from(x)).collect::<Vec<_>>(), &mut exact);
    let snr_db = snr_db(&exact, &sound);
    println!("in the head alone: {snr_db:.1} dB");
    assert!(snr_db > 115.0 && frames.is_silent(), "{snr_db:.1} dB");
}
