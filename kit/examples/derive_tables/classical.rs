//! Objects from the classical equations of bars, a ring and a membrane, and a bell from the
//! partials that founders name.

use kit::{Acceleration, Mode, Object};

use crate::level::{Contact, mode};
use crate::{bar, membrane};

/// All objects of this file.
pub(crate) fn all() -> Vec<Object> {
    vec![marimba(), glockenspiel(), bell(), bowl(), claves(), drum()]
}

fn object(name: &str, source: &str, modes: Vec<Mode>) -> Object {
    Object {
        name: name.to_owned(),
        source: source.to_owned(),
        licence: "CC0-1.0".to_owned(),
        reference_force: 1.0,
        acceleration: Acceleration::Balance,
        modes,
        residual: None,
        dynamic_filter: None,
        biquads: None,
        surface: None,
    }
}

/// Marimba bar A3, undercut to 1 : 4 : 10. Its higher modes are spaced as those of a uniform bar.
fn marimba() -> Object {
    let contact = Contact { time_s: 0.0024, peak: 1.0 };
    let ratios = [1.0, 4.0, 10.0, 10.0 * bar::ratio(4) / bar::ratio(3), 10.0 * bar::ratio(5) / bar::ratio(3)];
    // (T60 in s, amplitude): wood damps as f², and the resonator tube makes the first mode the
    // longest and the loudest.
    let sounds = [(1.6, 0.30), (0.55, 0.16), (0.22, 0.07), (0.11, 0.04), (0.07, 0.02)];
    let modes = (1..).zip(ratios.into_iter().zip(sounds)).map(|(n, (ratio, (t60_s, amplitude)))| {
        mode(220.0 * ratio, t60_s, amplitude, &bar::five_positions(n), contact)
    });
    object(
        "marimba",
        "free-free bar (Euler-Bernoulli mode shapes at five positions from the middle to an end), tuned 1 : 4 : 10, 220 Hz; T60 1.6 s falling as in wood, chosen by ear",
        modes.collect(),
    )
}

/// Glockenspiel bar C6: an untuned steel bar.
fn glockenspiel() -> Object {
    let contact = Contact { time_s: 0.0002, peak: 1.0 };
    let modes = (1..=6).map(|n| {
        let ratio = bar::ratio(n);
        let amplitude = [0.26, 0.16, 0.10, 0.06, 0.04, 0.03][n as usize - 1];
        mode(1046.5 * ratio, 5.0 * ratio.powf(-0.8), amplitude, &bar::five_positions(n), contact)
    });
    object(
        "glockenspiel",
        "uniform free-free steel bar (Euler-Bernoulli: 1 : 2.757 : 5.404 ..., mode shapes at five positions from the middle to an end), 1046.5 Hz (a measured glockenspiel has 1 : 2.88 : 5.41); T60 5 s falling as f^-0.8, chosen by ear",
        modes.collect(),
    )
}

/// Church bell of strike note 440 Hz. Each partial is a pair, because no bell is perfectly round.
fn bell() -> Object {
    let contact = Contact { time_s: 0.0007, peak: 1.0 };
    // (ratio to the prime, T60 in s, amplitude, split of the pair in parts per thousand)
    let partials = [
        (0.5, 12.0, 0.10, 1.6),
        (1.0, 8.0, 0.09, 0.9),
        (1.2, 7.0, 0.12, 0.7),
        (1.5, 4.0, 0.05, 1.1),
        (2.0, 4.5, 0.12, 0.5),
        (2.51, 2.6, 0.05, 0.9),
        (2.66, 2.4, 0.06, 0.8),
        (3.01, 2.0, 0.07, 0.4),
        (4.16, 1.5, 0.06, 0.4),
        (5.43, 1.0, 0.05, 0.3),
        (6.79, 0.8, 0.04, 0.3),
        (8.21, 0.6, 0.03, 0.3),
        (9.7, 0.45, 0.02, 0.2),
    ];
    let modes = partials.into_iter().flat_map(|(ratio, t60_s, amplitude, split)| {
        let pair = [(1.0 - 0.0005 * split, 0.62, 1.0), (1.0 + 0.0005 * split, 0.38, 0.93)];
        pair.map(|(detune, share, shorter)| {
            mode(440.0 * ratio * detune, t60_s * shorter, amplitude * share, &[1.0], contact)
        })
    });
    object(
        "bell",
        "minor-third bell: hum 0.5, prime 1, tierce 1.2, quint 1.5, nominal 2 and higher partials of a 440 Hz strike note, each a beating pair; ratios as founders name them, T60 and splits chosen by ear",
        modes.collect(),
    )
}

/// Bronze singing bowl whose rim is a thin ring; each of its modes is a beating pair.
///
/// A ring's modes of n = 2, 3 ... waves round it have `f_n ~ n (n² - 1) / sqrt(n² + 1)` (Hoppe, in
/// Rayleigh's *Theory of Sound* § 233).
fn bowl() -> Object {
    let contact = Contact { time_s: 0.0024, peak: 1.0 };
    let ring = |n: f64| n * (n * n - 1.0) / (n * n + 1.0).sqrt();
    let sounds = [(14.0, 0.20), (9.0, 0.14), (5.0, 0.08), (3.0, 0.05), (1.8, 0.03), (1.1, 0.02), (0.7, 0.012)];
    let modes = (2..).zip(sounds).flat_map(|(n, (t60_s, amplitude))| {
        let frequency_hz = 196.0 * ring(f64::from(n)) / ring(2.0);
        let pair = [(-0.5, 0.6, 1.0), (0.5, 0.4, 0.95)];
        // The two modes of a pair lie 0.9 Hz apart at the lowest pair, and further at higher ones.
        pair.map(|(side, share, shorter)| {
            let beat_hz = 0.9 * f64::from(n).sqrt() / 2f64.sqrt();
            mode(frequency_hz + side * beat_hz, t60_s * shorter, amplitude * share, &[1.0], contact)
        })
    });
    object(
        "bowl",
        "inextensional modes of a thin ring (Hoppe), n = 2 to 8, 196 Hz, each a beating pair; T60 14 s falling with n, chosen by ear",
        modes.collect(),
    )
}

/// Claves: a hardwood rod.
fn claves() -> Object {
    let contact = Contact { time_s: 0.0007, peak: 1.0 };
    let modes = (1..=3).map(|n| {
        let (t60_s, amplitude) = [(0.14, 0.30), (0.06, 0.12), (0.03, 0.05)][n as usize - 1];
        mode(2400.0 * bar::ratio(n), t60_s, amplitude, &[1.0], contact)
    });
    object(
        "claves",
        "free-free wooden rod (Euler-Bernoulli), 2400 Hz; T60 0.14 s falling with frequency, chosen by ear",
        modes.collect(),
    )
}

/// Drum: an ideal membrane at 98 Hz, struck between its middle and its rim.
///
/// Its reference force is 4 N.
fn drum() -> Object {
    let contact = Contact { time_s: 0.0024, peak: 1.0 };
    let first = membrane::zero(0, 1);
    let mut zeros: Vec<(u32, f64)> =
        (0..6).flat_map(|m| (1..=3).map(move |n| (m, membrane::zero(m, n)))).filter(|(_, zero)| *zero < 12.5).collect();
    zeros.sort_by(|a, b| a.1.total_cmp(&b.1));
    let modes = zeros.into_iter().map(|(m, zero)| {
        let ratio = zero / first;
        // Axisymmetric modes move air and lose their energy to it; the others ring longer.
        let t60_s = if m == 0 { 0.45 / ratio } else { 0.75 / ratio.powf(0.7) };
        mode(98.0 * ratio, t60_s, 0.42 / ratio.sqrt(), &membrane::five_positions(m, zero), contact)
    });
    Object {
        reference_force: 4.0,
        ..object(
            "drum",
            "ideal circular membrane (zeros of J_m, shapes J_m(j r) at five positions from the middle to 90 % of the radius), 98 Hz; T60 0.45 s and less for axisymmetric modes, 0.75 s for the others, chosen by ear",
            modes.collect(),
        )
    }
}
