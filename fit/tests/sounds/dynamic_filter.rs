//! Estimation of the dynamic filter: stability, decays of loops, and the damping of recordings that
//! it keeps.

use std::f64::consts::PI;
use std::path::Path as FilePath;
use std::sync::Mutex;

use fit::bark::{Centroids, DampingBand, DampingLaw, damping_law, frequency_hz};
use fit::dynamic_filter::study::{Way, heard_in, resynthesis};
use fit::dynamic_filter::{
    Breakpoint, Coefficients, Comparison, Criterion, Form, Loop, MOST_BREAKPOINTS, MOST_MODES, Model, Path, RATE_HZ,
    average, by_average_filter, compare, loop_gain, mean_law, noise_alone, render,
};
use fit::modes::DampedSine;
use fit::score::quantile;
use fit::synthetic::struck;

/// Noise of 20 ms through a low-pass that stands still.
fn burst() -> Path {
    let coefficients = Coefficients { a: [-0.3, 0.0], b: [0.2, 0.1, 0.0] };
    let point = |time_s| Breakpoint { time_s, coefficients, noise: 1.0 };
    Path { points: vec![point(0.0), point(0.02)] }
}

/// A loop whose gain round the filter is `gain`, in phase (eq. 22).
fn tuned(path: &Path, frequency_hz: f64, bandwidth_hz: f64, gain: f64) -> Loop {
    let angular = std::f64::consts::TAU * frequency_hz / RATE_HZ;
    let filter = average(path, angular);
    let period = RATE_HZ / frequency_hz;
    let first = filter.arg() / std::f64::consts::TAU * period;
    let delay = first + period * ((32.0 - first) / period).ceil();
    Loop { frequency_hz, bandwidth_hz, gain: gain / filter.norm(), delay_s: delay / RATE_HZ }
}

#[test]
fn a_loop_left_to_itself_decays_by_its_width_and_gain() {
    for (frequency, bandwidth, gain) in
        [(440.0, 10.0, 0.9), (2055.0, 24.0, 0.916), (5963.0, 100.0, 0.9), (9529.0, 60.0, 0.8)]
    {
        let path = burst();
        let guide = tuned(&path, frequency, bandwidth, gain);
        assert!((loop_gain(&path, &[guide]) / gain - 1.0).abs() < 0.01, "{}", loop_gain(&path, &[guide]));
        let model = Model { path, loops: vec![guide], ..Model::default() };
        let sound = render(&model, 96_000, 1);
        let law = damping_law(&sound[1200..], RATE_HZ).expect("it decays");
        // Eq. 10 and 11 make a band narrower by sin ω/ω.
        let angular = std::f64::consts::TAU * frequency / RATE_HZ;
        let beta = PI * bandwidth * angular.sin() / angular;
        let expected = beta * (1.0 - gain) / (1.0 + beta * gain * guide.delay_s);
        let ratio = law.decay_per_s(frequency) / expected;
        println!("{frequency} Hz: {:.2} for {expected:.2} 1/s", law.decay_per_s(frequency));
        // The delay's effect is taken to first order.
        assert!((ratio - 1.0).abs() < 0.05, "{frequency} Hz: {ratio}");
    }
}

/// A law of 18 bands whose decays and gains scatter like those of recordings.
fn scattered_law(seed: u64) -> DampingLaw {
    let mut state = seed;
    let mut uniform = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as f64 / (1u64 << 31) as f64
    };
    let bands = (4..22).map(f64::from).map(|bark| DampingBand {
        bark,
        centre_hz: frequency_hz(bark),
        gain: 10f64.powf(-1.0 - 1.5 * uniform()),
        decay_per_s: 8.0 * 1.12f64.powf(bark) * (0.8 * (uniform() - 0.5)).exp(),
    });
    let centroids = Centroids { whole_hz: 1500.0, below_hz: 600.0, above_hz: 3500.0, highest_hz: 9000.0 };
    DampingLaw { bands: bands.collect(), centroids }
}

#[test]
fn any_law_gives_a_stable_path_and_loops_below_a_gain_of_one() {
    for seed in 1..=2 {
        let law = scattered_law(seed);
        for criterion in
            [Criterion::ThreeBands, Criterion::AllBands(Form::FirstOrder), Criterion::AllBands(Form::SecondOrder)]
        {
            let path = noise_alone(&law, criterion);
            assert!((2..=MOST_BREAKPOINTS).contains(&path.points.len()), "{} breakpoints", path.points.len());
            assert!(path.points.windows(2).all(|pair| pair[0].time_s < pair[1].time_s) && path.points[0].time_s == 0.0);
            for point in &path.points {
                let [a1, a2] = point.coefficients.a;
                assert!(a2.abs() < 1.0 && a1.abs() < 1.0 + a2, "{point:?}");
            }
            let modes = [300.0, 310.0, 1200.0, 1205.0, 4000.0].map(|frequency_hz| DampedSine {
                frequency_hz,
                decay_per_s: 20.0,
                amplitude: 0.1,
                phase: 0.0,
            });
            let loops = by_average_filter(&path, &modes, &[40.0; 5], 5.0);
            assert!(loops.len() == 5 && loop_gain(&path, &loops) < 1.0, "{}", loop_gain(&path, &loops));
            assert!(loops.iter().all(|guide| guide.gain > 0.0 && guide.delay_s * RATE_HZ >= 31.999));
        }
    }
}

#[test]
fn more_coefficients_and_more_bands_follow_a_law_better_than_three_bands_do() {
    let law = scattered_law(7);
    let off = |criterion| {
        let path = noise_alone(&law, criterion);
        let model = Model { path, ..Model::default() };
        let sounds: Vec<Vec<f64>> = (1..=3).map(|seed| render(&model, 36_000, seed)).collect();
        let errors: Vec<f64> = compare(&law, mean_law(&sounds).as_ref()).iter().map(Comparison::error).collect();
        quantile(&errors, 0.5)
    };
    let three = off(Criterion::ThreeBands);
    let first = off(Criterion::AllBands(Form::FirstOrder));
    let second = off(Criterion::AllBands(Form::SecondOrder));
    println!("median error: three bands {three:.3}, all bands first order {first:.3}, second order {second:.3}");
    assert!(first < three && second < 0.2 && first < 0.25);
}

/// Number of Bark bands within 15 % of the strike's damping, number of all bands, and median error.
///
/// The resynthesis has at most ten modes beside the filter.
fn kept_damping(file: &FilePath) -> (usize, usize, f64) {
    let heard = heard_in(file).expect("a strike");
    let shares = Mutex::new(Vec::new());
    let told = |share: f64| shares.lock().expect("no thread panics").push(share);
    let model = Way::Additive(Form::FirstOrder).model(&heard, &told);
    let shares = shares.into_inner().expect("no thread panics");
    assert!(shares.len() > 3 && shares.is_sorted() && shares.iter().all(|share| (0.0..=1.0).contains(share)));
    assert!(model.modes.len() <= MOST_MODES && model.path.points.len() <= MOST_BREAKPOINTS);
    let compared = compare(&heard.law, mean_law(&resynthesis(&model, &heard)).as_ref());
    let errors: Vec<f64> = compared.iter().map(Comparison::error).collect();
    let within = errors.iter().filter(|error| **error <= 0.15).count();
    println!("{within} of {} bands within 15 %, median {:.1} %", errors.len(), 100.0 * quantile(&errors, 0.5));
    (within, errors.len(), quantile(&errors, 0.5))
}

#[test]
fn a_synthetic_mug_keeps_its_damping_with_ten_modes_beside_the_filter() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mug.wav");
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 44_100,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut wave = hound::WavWriter::create(&file, spec).expect("the file is new");
    for sample in struck(3, -70.0).samples {
        wave.write_sample(sample as f32).expect("it is written");
    }
    wave.finalize().expect("it is written");
    let (within, bands, median) = kept_damping(&file);
    assert!(bands >= 12 && within + 1 >= bands && median < 0.02);
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn a_ceramic_mug_keeps_its_damping_with_ten_modes_beside_the_filter() {
    let (within, bands, median) =
        kept_damping(&FilePath::new(env!("SHARED_DATA")).join("recordings/ceramic_mug_1.wav"));
    assert!(bands >= 12 && within + 1 >= bands && median < 0.032);
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn what_moves_slower_than_20_hz_is_no_mode_of_the_strike() {
    for name in ["wood_block_1", "ceramic_mug_1"] {
        let file = FilePath::new(env!("SHARED_DATA")).join("recordings").join(name).with_extension("wav");
        let heard = heard_in(&file).expect("a strike");
        let slowest = heard.modes.iter().map(|mode| mode.frequency_hz).fold(f64::INFINITY, f64::min);
        assert!(slowest >= 20.0 && slowest.is_finite(), "{name}: {slowest} Hz");
        assert_eq!(heard.emergence_db.len(), heard.modes.len());
    }
}
