//! Builders of small objects, strikers and events for the tests.

use reference::{Acceleration, Action, Event, Gain, Mode, Object, Pad, Pulse, SampleRate, Striker};

pub(crate) const RATE: SampleRate = SampleRate { numerator: 48_000, denominator: 1 };

pub(crate) fn mode(frequency_hz: f64, decay_per_s: f64, sine: f64, cosine: f64) -> Mode {
    Mode { frequency_hz, decay_per_s, gains: vec![Gain { sine, cosine }] }
}

/// Modes of low and high frequency, long and short decay, and every phase.
pub(crate) fn some_modes() -> Vec<Mode> {
    vec![
        mode(0.0, 40.0, 0.0, 3.0),
        mode(21.0, 0.4, 2.0, -1.0),
        mode(440.0, 5.0, 1.0, 0.0),
        mode(1_234.5, 12.0, -0.5, 0.25),
        mode(7_000.0, 90.0, 0.0, 1.5),
        mode(23_900.0, 300.0, 0.7, 0.7),
    ]
}

pub(crate) fn hertz_striker() -> Striker {
    Striker {
        pulse: Pulse::Hertz { restitution: 0.45 },
        peak_force: 80.0,
        peak_exponent: Striker::HERTZ_PEAK_EXPONENT,
        contact_time_s: 0.001,
        contact_exponent: Striker::HERTZ_CONTACT_EXPONENT,
        modes: vec![],
    }
}

pub(crate) fn pad(modes: Vec<Mode>, strikers: Vec<Striker>) -> Pad {
    Pad {
        object: Object { modes, acceleration: Acceleration::Factor(0.0), biquads: vec![], dynamic_filter: None },
        strikers,
        striker_weight: 0.0,
        level_db: 0.0,
        pan: 0.0,
        choke_t60_s: 0.05,
        is_in_frames: false,
    }
}

pub(crate) fn strike(time_samples: f64, pad: usize, velocity: f64) -> Event {
    Event { time_samples, pad, velocity, position: 0.0, striker: 0, action: Action::Strike }
}

pub(crate) fn choke(time_samples: f64) -> Event {
    Event { action: Action::Choke, ..strike(time_samples, 0, 0.0) }
}

pub(crate) fn release(time_samples: f64) -> Event {
    Event { action: Action::Release, ..strike(time_samples, 0, 0.0) }
}

/// Returns `length` pseudo-random numbers from -1 to 1, equal in every call.
pub(crate) fn noise(length: usize) -> Vec<f64> {
    let mut state = 1_u64;
    let next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    std::iter::repeat_with(next).take(length).collect()
}

/// Largest difference between two signals of equal length.
pub(crate) fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Largest magnitude in a signal.
pub(crate) fn peak(signal: &[f64]) -> f64 {
    signal.iter().fold(0.0, |peak, y| peak.max(y.abs()))
}
