//! Banks in frames against the exact responses of their modes.

use dsp_core::SampleRate;
use dsp_core::frames::BLOCK_FRAMES;
use host_tests::frames::{FramesOnPc, HeardMode};
use host_tests::snr::{Random, snr_db};

const ONE: f64 = (1 << 27) as f64;

/// SNR of a mode that is struck by one sample at an offset in a block, over at most 2 s.
fn snr_of(mode: HeardMode, rate: SampleRate, offset: usize, level: f64) -> f64 {
    let frames = (mode.t60_s.min(2.0) * rate.hz()) as usize;
    let mut force = vec![0; offset + frames];
    force[offset] = (ONE * level) as i32;
    let sound = FramesOnPc::new(&[mode], rate, false).render(&force, 32);
    let mut exact = vec![0.0; force.len()];
    mode.add_response(rate, &force.iter().map(|&x| f64::from(x)).collect::<Vec<_>>(), &mut exact);
    assert!(sound[..offset].iter().all(|&y| y == 0), "sound before the strike");
    snr_db(&exact[offset..], &sound[offset..])
}

#[test]
fn frames_hold_each_mode_at_every_offset() {
    let rate = SampleRate::HZ_44100;
    let mut random = Random::new(1);
    let mut worst = [f64::INFINITY; 2];
    for t60_s in [0.002, 0.005, 0.01, 0.02, 0.05, 0.2, 1.0, 5.0, 20.0] {
        let mut of_t60 = [f64::INFINITY; 2];
        for step in 0..16 {
            let frequency_hz = 20.0 * 1000f64.powf(f64::from(step) / 15.0);
            for (level, worst) in [1.0, 0.001].into_iter().zip(&mut of_t60) {
                let phase = random.between(0.0, std::f64::consts::TAU);
                let mode = HeardMode { frequency_hz, t60_s, sine: phase.sin(), cosine: phase.cos() };
                let offset = random.between(0.0, BLOCK_FRAMES as f64) as usize;
                *worst = worst.min(snr_of(mode, rate, offset, level));
            }
        }
        println!("T60 {t60_s} s: {:.1} dB at full scale, {:.1} dB at -60 dB", of_t60[0], of_t60[1]);
        worst = [worst[0].min(of_t60[0]), worst[1].min(of_t60[1])];
    }
    println!("worst {:.1} and {:.1} dB", worst[0], worst[1]);
    assert!(worst[0] > 96.0 && worst[1] > 96.0);
}
