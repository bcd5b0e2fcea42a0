//! Contact: pulses, and the law from velocity to force (eq. 2, 3).

use std::f64::consts::PI;

use reference::contact::Impact;
use reference::{Pulse, SampleRate, Striker};

use crate::build::{RATE, hertz_striker};

const PEAK_FORCE: f64 = 30.0;
const CONTACT_TIME_S: f64 = 0.002;

fn impact(pulse: Pulse, onset_samples: f64) -> Impact {
    Impact { onset_samples, pulse, peak_force: PEAK_FORCE, contact_time_s: CONTACT_TIME_S }
}

/// `∫ F dt` in newton-seconds, sampled finely.
fn area(pulse: Pulse) -> f64 {
    let fine = SampleRate { numerator: 48_000_000, denominator: 1 };
    let impact = impact(pulse, 0.0);
    (0..400_000).map(|sample| impact.force(sample, fine)).sum::<f64>() / fine.hz()
}

#[test]
fn a_half_sine_has_the_area_of_a_half_sine() {
    let expected = 2.0 * CONTACT_TIME_S * PEAK_FORCE / PI;
    assert!((area(Pulse::HertzHalfSine) / expected - 1.0).abs() < 1e-9);
}

#[test]
fn a_gaussian_has_its_area_but_for_the_tails_below_100_db() {
    const ERF_OF_CUT: f64 = 0.999_998_401_623_680_6; // erf(√ln 10⁵)
    let expected = PEAK_FORCE * CONTACT_TIME_S * (PI / 6.0).sqrt() * ERF_OF_CUT;
    // The cut leaves steps of 10⁻⁵ at both ends, which limit a sum in place of the integral.
    assert!((area(Pulse::Gaussian) / expected - 1.0).abs() < 1e-9);
}

#[test]
fn a_half_sine_peaks_in_the_middle_and_is_zero_outside() {
    let middle = CONTACT_TIME_S / 2.0;
    assert_eq!(Pulse::HertzHalfSine.shape(middle, CONTACT_TIME_S), 1.0);
    assert_eq!(Pulse::HertzHalfSine.shape(-1e-9, CONTACT_TIME_S), 0.0);
    assert_eq!(Pulse::HertzHalfSine.shape(CONTACT_TIME_S + 1e-9, CONTACT_TIME_S), 0.0);
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
    let impact = impact(Pulse::HertzHalfSine, 10.25);
    assert_eq!(impact.force(10, RATE), 0.0);
    let since_onset_s = 0.75 / 48_000.0;
    let expected = PEAK_FORCE * (PI * since_onset_s / CONTACT_TIME_S).sin();
    assert!((impact.force(11, RATE) - expected).abs() < 1e-12);
}

#[test]
fn a_contact_is_over_once_its_force_stays_zero() {
    let impact = impact(Pulse::HertzHalfSine, 0.5);
    assert!(!impact.is_over(96, RATE));
    assert!(impact.force(96, RATE) > 0.0);
    assert!(impact.is_over(97, RATE));
    assert_eq!(impact.force(97, RATE), 0.0);
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
