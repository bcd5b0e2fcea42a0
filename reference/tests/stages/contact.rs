//! Contact: pulses, and the power laws from velocity to force and contact time (eq. 2, 3).

use std::f64::consts::PI;

use reference::contact::Impact;
use reference::{Pulse, SampleRate, Striker};

use crate::build::{RATE, hertz_striker};

const PEAK_FORCE: f64 = 30.0;
const CONTACT_TIME_S: f64 = 0.002;
const HALF_SINE: Pulse = Pulse::Hertz { restitution: 1.0 };

fn impact(pulse: Pulse, onset_samples: f64) -> Impact {
    Impact { onset_samples, pulse, peak_force: PEAK_FORCE, contact_time_s: CONTACT_TIME_S }
}

/// Impulse `∫ F dt` in newton-seconds, from fine samples.
fn area(pulse: Pulse) -> f64 {
    let fine = SampleRate { numerator: 48_000_000, denominator: 1 };
    let impact = impact(pulse, 0.0);
    (0..400_000).map(|sample| impact.force(sample, fine)).sum::<f64>() / fine.hz()
}

#[test]
fn a_half_sine_has_the_area_of_a_half_sine() {
    let expected = 2.0 * CONTACT_TIME_S * PEAK_FORCE / PI;
    assert!((area(HALF_SINE) / expected - 1.0).abs() < 1e-9);
}

/// Scale N of the pulse, from a search for its peak, and skew A.
fn scale_and_skew(restitution: f64) -> (f64, f64) {
    let slopes = restitution.powf(4.6);
    let skew = (1.0 - slopes) / (1.0 + slopes);
    let shape = |x: f64| (PI * x).sin() * (1.0 + skew * (PI * x).cos());
    let peak = (0..1_000_000).map(|n| shape(f64::from(n) / 1e6)).fold(0.0, f64::max);
    (1.0 / peak, skew)
}

#[test]
fn a_hertz_pulse_follows_its_law_with_a_peak_of_1() {
    for restitution in [0.1, 0.3, 0.45, 0.8, 1.0] {
        let pulse = Pulse::Hertz { restitution };
        let (scale, skew) = scale_and_skew(restitution);
        for step in 0..=100 {
            let x = f64::from(step) / 100.0;
            let expected = scale * (PI * x).sin() * (1.0 + skew * (PI * x).cos());
            let got = pulse.shape(x * CONTACT_TIME_S, CONTACT_TIME_S);
            assert!((got - expected).abs() < 1e-10, "e = {restitution}, x = {x}: {got} {expected}");
        }
        let slope = |x: f64| pulse.shape(x * CONTACT_TIME_S, CONTACT_TIME_S) * 1e7;
        let ratio = slope(1.0 - 1e-7) / slope(1e-7);
        assert!((ratio / restitution.powf(4.6) - 1.0).abs() < 1e-2, "e = {restitution}: {ratio}");
    }
}

#[test]
fn a_hertz_sample_is_the_mean_of_the_force_over_its_interval() {
    for restitution in [0.1, 0.45, 1.0] {
        let pulse = Pulse::Hertz { restitution };
        for (contact_time_s, since_start_s) in [
            (0.002, 1e-3),
            (0.002, 1e-5),
            (0.002, 2.01e-3),
            (2e-5, 1.1e-5),
            (2e-5, 2.5e-5),
            (2e-5, 4e-5),
            (1e-5, 1.5e-5),
        ] {
            let mean = (0..100_000)
                .map(|n| {
                    let back_s = (f64::from(n) + 0.5) / 100_000.0 / RATE.hz();
                    pulse.shape(since_start_s - back_s, contact_time_s)
                })
                .sum::<f64>()
                / 100_000.0;
            let got = pulse.sample(since_start_s, contact_time_s, RATE);
            assert!(
                (got - mean).abs() < 1e-6,
                "e = {restitution}, {contact_time_s} s, {since_start_s} s: {got} {mean}"
            );
        }
    }
}

#[test]
fn the_spectrum_of_a_hertz_pulse_is_the_documented_one() {
    let fine = SampleRate { numerator: 10_000_000, denominator: 1 };
    for restitution in [0.3, 0.45, 0.8, 1.0] {
        let (scale, skew) = scale_and_skew(restitution);
        let pulse = Pulse::Hertz { restitution };
        for frequency_hz in [10.0, 333.0, 760.0, 1_240.0, 2_250.0, 7_777.0] {
            let (mut re, mut im) = (0.0, 0.0);
            for n in 0..20_001 {
                let t = f64::from(n) / fine.hz();
                let (sine, cosine) = (2.0 * PI * frequency_hz * t).sin_cos();
                let share = pulse.shape(t, CONTACT_TIME_S) / (CONTACT_TIME_S * fine.hz());
                (re, im) = (re + share * cosine, im + share * sine);
            }
            let x = frequency_hz * CONTACT_TIME_S;
            let (s, c) = (PI * x).sin_cos();
            let even = c / (1.0 - 4.0 * x * x);
            let odd = skew / 4.0 * s / (1.0 - x * x);
            let law = (scale * 2.0 / PI).powi(2) * (even * even + odd * odd);
            assert!((re * re + im * im - law).abs() < 1e-6 * law + 1e-12, "e = {restitution}, {frequency_hz} Hz");
        }
    }
}

/// Hunt and Crossley's ratio of the force's last slope to its first: `e^1.5 (1-μe)/(1+μ)`, where
/// `μ (1+e) = ln((1+μ)/(1-μe))`.
fn hunt_and_crossley_slopes(restitution: f64) -> f64 {
    let e = restitution;
    let (mut low, mut high) = (1e-9, 1.0 / e - 1e-12);
    for _ in 0..200 {
        let mu = (low + high) / 2.0;
        // Below the root the logarithm is the smaller.
        if ((1.0 + mu) / (1.0 - mu * e)).ln() < mu * (1.0 + e) { low = mu } else { high = mu }
    }
    e.powf(1.5) * (1.0 - low * e) / (1.0 + low)
}

#[test]
fn slopes_follow_hunt_and_crossley_within_4_percent_from_e_0_45_on() {
    for step in 45u32..100 {
        let restitution = f64::from(step) / 100.0;
        let ratio = restitution.powf(4.6) / hunt_and_crossley_slopes(restitution);
        assert!((ratio - 1.0).abs() < 0.04, "e = {restitution}: {ratio}");
    }
}

#[test]
fn a_gaussian_has_its_area_but_for_the_tails_below_100_db() {
    const ERF_OF_CUT: f64 = 0.999_998_401_623_680_6; // erf(√ln 10⁵)
    let expected = PEAK_FORCE * CONTACT_TIME_S * (PI / 6.0).sqrt() * ERF_OF_CUT;
    // The cut leaves steps of 10⁻⁵ at both ends, which limit the accuracy of a sum as an integral.
    assert!((area(Pulse::Gaussian) / expected - 1.0).abs() < 1e-9);
}

#[test]
fn a_half_sine_peaks_in_the_middle_and_is_zero_outside() {
    let middle = CONTACT_TIME_S / 2.0;
    assert_eq!(HALF_SINE.shape(middle, CONTACT_TIME_S), 1.0);
    assert_eq!(HALF_SINE.shape(-1e-9, CONTACT_TIME_S), 0.0);
    assert_eq!(HALF_SINE.shape(CONTACT_TIME_S + 1e-9, CONTACT_TIME_S), 0.0);
}

#[test]
fn a_gaussian_starts_and_ends_100_db_below_its_peak() {
    let centre = CONTACT_TIME_S * (1e5_f64.ln() / 6.0).sqrt();
    assert_eq!(Pulse::Gaussian.shape(centre, CONTACT_TIME_S), 1.0);
    for edge in [0.0, 2.0 * centre] {
        assert!((Pulse::Gaussian.shape(edge, CONTACT_TIME_S) / 1e-5 - 1.0).abs() < 1e-12);
    }
    assert_eq!(Pulse::Gaussian.shape(-1e-12, CONTACT_TIME_S), 0.0);
    assert_eq!(Pulse::Gaussian.shape(2.0 * centre + 1e-12, CONTACT_TIME_S), 0.0);
}

#[test]
fn a_gaussian_is_equation_2_with_its_onset_half_a_contact_time_before_the_centre() {
    let centre = CONTACT_TIME_S * (1e5_f64.ln() / 6.0).sqrt();
    let t_i = centre - CONTACT_TIME_S / 2.0;
    for step in 0..100 {
        let t = f64::from(step) * centre / 50.0;
        let equation_2 = (-6.0 / CONTACT_TIME_S.powi(2) * (t - t_i - CONTACT_TIME_S / 2.0).powi(2)).exp();
        assert!((Pulse::Gaussian.shape(t, CONTACT_TIME_S) - equation_2).abs() < 1e-12);
    }
}

#[test]
fn a_contact_starts_at_a_fraction_of_a_sample() {
    let impact = impact(HALF_SINE, 10.25);
    assert_eq!(impact.force(10, RATE), 0.0);
    // Mean over the interval, of which the contact fills three quarters.
    let since_onset_s = 0.75 / 48_000.0;
    let area = CONTACT_TIME_S / PI * (1.0 - (PI * since_onset_s / CONTACT_TIME_S).cos());
    assert!((impact.force(11, RATE) - PEAK_FORCE * area * 48_000.0).abs() < 1e-9);
}

#[test]
fn a_contact_is_over_once_its_force_stays_zero() {
    // The last force is that of the interval in which the contact ends, at 96.5 samples.
    let impact = impact(HALF_SINE, 0.5);
    assert!(!impact.is_over(97, RATE));
    assert!(impact.force(97, RATE) > 0.0);
    assert!(impact.is_over(98, RATE));
    assert_eq!(impact.force(98, RATE), 0.0);
}

#[test]
fn a_short_contact_keeps_its_impulse_at_any_onset() {
    let pulses = [HALF_SINE, Pulse::Hertz { restitution: 0.45 }, Pulse::Gaussian];
    for (pulse, limit_db) in pulses.into_iter().zip([1e-6_f64, 1e-6, 0.2]) {
        let whole = area(pulse) / PEAK_FORCE / CONTACT_TIME_S;
        for contact_time_s in [1e-5, 2e-5, 5e-5, 1.6e-4] {
            for onset in 0..50 {
                let onset_samples = f64::from(onset) / 50.0;
                let impact = Impact { onset_samples, pulse, peak_force: 1.0, contact_time_s };
                let sum: f64 = (0..200).map(|sample| impact.force(sample, RATE)).sum();
                let error_db: f64 = 20.0 * (sum / RATE.hz() / contact_time_s / whole).log10();
                assert!(error_db.abs() < limit_db, "{pulse:?}, {contact_time_s} s: {error_db} dB");
            }
        }
    }
}

#[test]
fn contact_times_are_held_between_10_us_and_a_quarter_of_a_second() {
    let longer = Striker { contact_exponent: -1.0, ..hertz_striker() };
    let shorter = Striker { contact_exponent: 1.0, ..hertz_striker() };
    let time_s = |striker: Striker| striker.strike(1e-3, 0.0).expect("a velocity above 0").contact_time_s;
    assert_eq!((time_s(longer), time_s(shorter)), (0.25, 1e-5));
}

#[test]
fn contacts_in_flight_add_up() {
    let [first, second] = [0.0, 40.3].map(|onset| impact(Pulse::Gaussian, onset));
    let mut force = vec![0.0; 300];
    first.add_force(0, RATE, &mut force);
    second.add_force(0, RATE, &mut force);
    for (sample, force) in (0..).zip(force) {
        assert_eq!(force, first.force(sample, RATE) + second.force(sample, RATE));
    }
}

#[test]
fn a_harder_strike_is_stronger_and_shorter_by_the_strikers_exponents() {
    let striker = Striker { peak_exponent: 1.5, contact_exponent: -0.25, ..hertz_striker() };
    let impact = striker.strike(0.5, 7.5).expect("a velocity above 0 strikes");
    assert_eq!(impact.onset_samples, 7.5);
    assert!((impact.peak_force - 80.0 * 0.5_f64.powf(1.5)).abs() < 1e-12);
    assert!((impact.contact_time_s - 0.001 * 0.5_f64.powf(-0.25)).abs() < 1e-15);
}

#[test]
fn at_velocity_1_a_strike_has_the_strikers_own_force_and_time() {
    let impact = hertz_striker().strike(1.0, 0.0).expect("a velocity above 0 strikes");
    assert_eq!((impact.peak_force, impact.contact_time_s), (80.0, 0.001));
}

#[test]
fn velocity_0_is_no_strike() {
    assert_eq!(hertz_striker().strike(0.0, 0.0), None);
}
