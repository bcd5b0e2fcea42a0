//! One mode over its whole life: SNR, frequency, decay, and the end of the tail.

use dsp_core::SampleRate;
use dsp_core::resonator::TICK_FRAMES;
use host_tests::single_mode::float_forms::FloatForm;
use host_tests::single_mode::q31::{self, StruckMode};
use host_tests::single_mode::{Case, grid, snr_db, worst_and_median};

/// The figures are those of the README's table: worst and median SNR in dB, at full scale and 40 dB
/// below.
#[test]
fn every_mode_keeps_the_snr_of_the_readme_at_full_scale_and_40_db_below() {
    for (level, worst, median) in [(1.0, 101.8, 120.2), (0.01, 100.6, 116.7)] {
        let snr = |case: Case| snr_db(case.reference(), q31::render(&case));
        let measured = worst_and_median(grid(40, level).iter().map(Case::exact).map(snr).collect());
        println!("{level}: worst {:.1} dB, median {:.1} dB", measured.0, measured.1);
        assert!(measured.0 >= worst - 1.0 && (measured.1 - median).abs() <= 1.0, "{level}: {measured:.1?}");
    }
}

/// The figures are those of the other forms in the README's table.
#[test]
fn single_precision_forms_lose_what_the_readme_says() {
    let readme =
        [(1.0, [(6.4, 63.8), (57.0, 83.4), (39.0, 103.4)]), (0.01, [(6.4, 64.1), (57.0, 83.4), (39.0, 102.7)])];
    for (level, readme) in readme {
        let mut snr: [Vec<f64>; 3] = Default::default();
        for case in grid(40, level).iter().map(Case::exact) {
            let reference: Vec<f64> = case.reference().take(case.frames()).collect();
            for (snr, form) in snr.iter_mut().zip(FloatForm::ALL) {
                snr.push(snr_db(reference.iter().copied(), form.render(&case)));
            }
        }
        for ((form, snr), (worst, median)) in FloatForm::ALL.into_iter().zip(snr).zip(readme) {
            let measured = worst_and_median(snr);
            println!("{}, {level}: worst {:.1} dB, median {:.1} dB", form.name(), measured.0, measured.1);
            let near = |measured: f64, readme: f64| (measured - readme).abs() <= 1.0;
            assert!(near(measured.0, worst) && near(measured.1, median), "{}, {level}: {measured:.1?}", form.name());
        }
    }
}

/// Phase in turns, and logarithm of the amplitude, of a decaying sine about a time.
///
/// They come from least squares on the two phases of the reference.
fn analyse(case: &Case, sound: &[f64], from: usize, length: usize) -> (f64, f64) {
    let (fs, d, f) = (case.rate.hz(), case.decay_per_s(), case.frequency_hz);
    let (mut ss, mut cc, mut sc, mut sy, mut cy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (n, &y) in sound.iter().enumerate().skip(from).take(length) {
        let t = n as f64 / fs;
        let (sin, cos) = (std::f64::consts::TAU * (f * t).fract()).sin_cos();
        let y = y * (d * t).exp();
        (ss, cc, sc, sy, cy) = (ss + sin * sin, cc + cos * cos, sc + sin * cos, sy + y * sin, cy + y * cos);
    }
    let determinant = ss * cc - sc * sc;
    let (sine, cosine) = ((sy * cc - cy * sc) / determinant, (cy * ss - sy * sc) / determinant);
    (cosine.atan2(sine) / std::f64::consts::TAU, sine.hypot(cosine).ln())
}

#[test]
fn frequency_stays_within_0_0004_cent_and_t60_within_a_hundred_thousandth() {
    let (mut worst_cent, mut worst_t60) = (0.0f64, 0.0f64);
    for case in grid(12, 1.0).iter().map(Case::exact) {
        // The two windows are a fifth of the sound each, three fifths apart.
        let sound = q31::render(&case);
        let (length, gap) = (sound.len() / 5, sound.len() * 3 / 5);
        let (early, late) = (analyse(&case, &sound, 1, length), analyse(&case, &sound, 1 + gap, length));
        let seconds = gap as f64 / case.rate.hz();
        let turns = late.0 - early.0;
        let cent = 1200.0 / std::f64::consts::LN_2 * (turns - turns.round()) / seconds / case.frequency_hz;
        let t60 = (late.1 - early.1) / seconds / case.decay_per_s();
        (worst_cent, worst_t60) = (worst_cent.max(cent.abs()), worst_t60.max(t60.abs()));
        assert!(cent.abs() < 4e-4, "{cent} cent: {case:?}");
        assert!(t60.abs() < 1e-5, "{t60}: {case:?}");
    }
    println!("worst: {worst_cent:.5} cent, T60 {:.5} %", 100.0 * worst_t60);
}

#[test]
fn tails_of_up_to_120_s_follow_the_law_for_90_db_and_end_in_exact_zero() {
    let mut worst = 0.0f64;
    for frequency_hz in [25.0, 440.0, 4_500.0, 7_000.0, 11_000.0, 13_000.0, 20_000.0, 23_000.0] {
        for t60_s in [1.0, 20.0, 120.0] {
            for level in [1.0, 0.01, 0.001] {
                let case = Case { frequency_hz, t60_s, rate: SampleRate::HZ_48000, level }.exact();
                let mut mode = StruckMode::new(&case);
                let tick_s = TICK_FRAMES as f64 / case.rate.hz();
                let mut frames = 0u64;
                while !mode.is_zero() || frames == 0 {
                    mode.tick();
                    frames += TICK_FRAMES as u64;
                    // The state is that of the mode at the last frame of the tick.
                    let t = (frames - 1) as f64 / case.rate.hz();
                    let down_db = 60.0 * t / case.t60_s;
                    if down_db <= 90.0 {
                        let reference = level * (-case.decay_per_s() * t).exp();
                        let error_db = 20.0 * (mode.amplitude() / reference).log10();
                        worst = worst.max(error_db.abs());
                        assert!(error_db.abs() < 0.01, "{error_db} dB, {down_db:.1} dB down: {case:?}");
                    }
                    assert!(t < 5.0 * case.t60_s + tick_s, "never ends: {case:?}");
                }
            }
        }
    }
    println!("worst: {worst:.4} dB");
}
