//! The damping law on the Bark scale, for sounds whose law is known.

use std::f64::consts::{FRAC_PI_2, SQRT_2, TAU};

use fit::bark::{EMERGENT_DB, bark, damping_law, emergence_db, frequency_hz};
use fit::modes::DampedSine;
use fit::residual::{Band, render};
use fit::synthetic::of_these;

const RATE_HZ: f64 = 44_100.0;

/// Damping in 1/s of an object by Rayleigh's law: faster towards higher frequencies.
fn law_per_s(frequency_hz: f64) -> f64 {
    6.0 + 6e-7 * frequency_hz * frequency_hz
}

fn sine(frequency_hz: f64, decay_per_s: f64, amplitude: f64) -> DampedSine {
    DampedSine { frequency_hz, decay_per_s, amplitude, phase: 0.4 }
}

/// Noise whose bands decay by that law.
fn noise_of_the_law(seed: u64) -> Vec<f64> {
    let edges: Vec<f64> = (0..=120).map(|step| 60.0 * (16_000f64 / 60.0).powf(f64::from(step) / 120.0)).collect();
    let bands: Vec<Band> = edges
        .windows(2)
        .map(|edge| Band {
            edges_hz: [edge[0], edge[1]],
            // Equal power per Hz.
            weight: 1e-3 * (edge[1] - edge[0]).sqrt(),
            decay_db_per_s: 20.0 / 10f64.ln() * law_per_s((edge[0] * edge[1]).sqrt()),
        })
        .collect();
    render(&bands, 66_150, RATE_HZ, seed)
}

#[test]
fn a_mode_in_each_third_band_gives_its_decay_and_amplitude() {
    let modes: Vec<DampedSine> =
        (2..23).step_by(3).map(|rate| frequency_hz(f64::from(rate))).map(|f| sine(f, law_per_s(f), 0.1)).collect();
    let sound = of_these(modes, 66_150, 1, -100.0);
    let law = damping_law(&sound.samples, RATE_HZ).expect("it decays");
    for mode in &sound.modes {
        let decay = law.decay_per_s(mode.frequency_hz) / mode.decay_per_s;
        let gain = law.gain(mode.frequency_hz) / mode.amplitude;
        println!("{:.0} Hz: decay {decay:.4}, gain {gain:.4}", mode.frequency_hz);
        assert!((decay - 1.0).abs() < 0.002 && (gain - 1.0).abs() < 0.006, "{mode:?}: {decay}, {gain}");
    }
}

#[test]
fn noise_that_decays_by_a_law_shows_that_law() {
    let (mut errors, mut sum, mut count) = (Vec::new(), 0.0, 0.0);
    for seed in 1..=4 {
        let law = damping_law(&noise_of_the_law(seed), RATE_HZ).expect("it decays");
        assert!(law.bands.len() >= 20, "{} bands", law.bands.len());
        for band in law.bands.iter().filter(|band| (200.0..12_000.0).contains(&band.centre_hz)) {
            let ratio = (band.decay_per_s / law_per_s(band.centre_hz)).ln();
            errors.push(ratio.abs());
            sum += ratio;
            count += 1.0;
        }
    }
    let worst = errors.iter().copied().fold(0.0, f64::max);
    let mean = errors.iter().sum::<f64>() / count;
    println!(
        "decay of noise: mean error {:.1} %, worst {:.1} %, bias {:+.1} %",
        100.0 * mean,
        100.0 * worst,
        100.0 * sum / count
    );
    assert!(mean < 0.06 && worst < 0.30 && (sum / count).abs() < 0.05);
}

#[test]
fn the_gain_of_noise_is_its_rms_in_the_band_times_the_root_of_two() {
    let sound = of_these(Vec::new(), 88_200, 3, -20.0);
    let faded: Vec<f64> =
        sound.samples.iter().enumerate().map(|(n, x)| x * (-8.0 * n as f64 / RATE_HZ).exp()).collect();
    let law = damping_law(&faded, RATE_HZ).expect("it decays");
    // White noise of rms r has the power r²/(fs/2) per Hz; a Gaussian band of σ = half a Bark
    // passes √π σ of it.
    for band in law.bands.iter().filter(|band| band.bark >= 6.0 && band.bark <= 22.0) {
        let width_hz = std::f64::consts::PI.sqrt() * 0.5 * fit::bark::width_hz(band.centre_hz);
        let expected = SQRT_2 * 0.1 * (width_hz / (RATE_HZ / 2.0)).sqrt();
        let db = 20.0 * (band.gain / expected).log10();
        assert!(db.abs() < 2.5, "{} Bark: {db:+.2} dB", band.bark);
    }
}

#[test]
fn the_centroids_lie_where_the_energy_is() {
    // Energy A²/4α each, equal for these. They begin at a zero, because a step would spread over
    // the whole spectrum.
    let modes = [300.0, 900.0, 3000.0, 5400.0].map(|f| DampedSine { phase: -FRAC_PI_2, ..sine(f, 20.0, 0.2) });
    let sound = of_these(modes.to_vec(), 88_200, 5, -110.0);
    let centroids = damping_law(&sound.samples, RATE_HZ).expect("it decays").centroids;
    println!("{centroids:?}");
    assert!((centroids.whole_hz / 2400.0 - 1.0).abs() < 0.03);
    assert!((centroids.below_hz / 600.0 - 1.0).abs() < 0.06);
    assert!((centroids.above_hz / 4200.0 - 1.0).abs() < 0.03);
    assert!(centroids.highest_hz > 5400.0 && centroids.highest_hz < 18_000.0);
}

#[test]
fn modes_above_noise_emerge_and_modes_within_it_do_not() {
    let loud = [420.0, 1500.0, 4100.0];
    let quiet = [700.0, 2300.0, 6200.0];
    let mut modes: Vec<DampedSine> = loud.map(|f| sine(f, law_per_s(f), 0.3)).to_vec();
    modes.extend(quiet.map(|f| sine(f, law_per_s(f), 0.0005)));
    let noise = noise_of_the_law(9);
    let sound: Vec<f64> = noise
        .iter()
        .enumerate()
        .map(|(n, x)| {
            let t = n as f64 / RATE_HZ;
            let ring = |mode: &DampedSine| {
                mode.amplitude * (-mode.decay_per_s * t).exp() * (TAU * mode.frequency_hz * t + mode.phase).cos()
            };
            x + modes.iter().map(ring).sum::<f64>()
        })
        .collect();
    let emergence = emergence_db(&modes, &sound, RATE_HZ);
    println!("{emergence:.1?}");
    assert!(emergence[..3].iter().all(|db| *db >= EMERGENT_DB), "{emergence:?}");
    assert!(emergence[3..].iter().all(|db| *db < EMERGENT_DB), "{emergence:?}");
}

#[test]
fn silence_and_steady_sounds_have_no_damping_law() {
    assert!(damping_law(&vec![0.0; 44_100], RATE_HZ).is_none());
    assert!(damping_law(&[], RATE_HZ).is_none());
    let steady = of_these(Vec::new(), 44_100, 2, -20.0).samples;
    let law = damping_law(&steady, RATE_HZ);
    let dying = law.iter().flat_map(|law| &law.bands).filter(|band| band.t60_s() < 1.0).count();
    assert_eq!(dying, 0, "{law:?}");
    assert!(bark(1000.0) > 8.0);
}
