//! Banks in frames against the exact responses of their modes.

use dsp_core::SampleRate;
use dsp_core::frames::BLOCK_FRAMES;
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
        (0.002, 124.1, 91.2),
        (0.005, 116.2, 101.0),
        (0.01, 110.9, 105.1),
        (0.02, 109.5, 104.7),
        (0.05, 105.3, 101.3),
        (0.2, 119.4, 115.5),
        (1.0, 117.4, 112.8),
        (5.0, 110.4, 110.4),
        (20.0, 105.3, 105.8),
    ];
    let mut off = Vec::new();
    for (t60_s, full_db, quieter_db) in page {
        for (level, stated_db) in [(1.0, full_db), (0.01, quieter_db)] {
            let mut worst_db = f64::INFINITY;
            for step in 0..160 {
                let frequency_hz = 20.0 * 1000f64.powf(f64::from(step) / 159.0);
                let phase = random.between(0.0, std::f64::consts::TAU);
                let mode = HeardMode { frequency_hz, t60_s, sine: phase.sin(), cosine: phase.cos() };
                let start = random.between(0.0, BLOCK_FRAMES as f64) as usize;
                let frames = (t60_s.min(2.0) * RATE.hz()) as usize;
                let (sound, exact) = both(&[mode], &[(ONE * level) as i32], start, frames);
                worst_db = worst_db.min(snr_db(&exact, &sound));
            }
            println!("T60 {t60_s} s, level {level}: worst {worst_db:.1} dB");
            off.extend((worst_db < stated_db - 1.5).then_some((t60_s, level, worst_db)));
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
    assert!(worst_db < -115.0, "{worst_db:.1} dB");
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
    assert!(snr_db > 112.0, "{snr_db:.1} dB");
    assert_eq!(frames.strike_at(0.8), Some(0), "both are free again");
}
