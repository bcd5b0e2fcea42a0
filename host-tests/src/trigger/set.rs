//! Random scenes of each kind.

use super::piezo::{Attack, Ring, Scene, Strike};
use super::random::Random;

/// Number of channels of each scene.
pub const CHANNELS: usize = 4;
/// Start of the strikes in seconds: a trigger has learnt offset, hum and noise by then.
const START_S: f64 = 0.25;

/// Names of the kinds of scenes.
pub const KINDS: [&str; 9] = [
    "singles over 40 dB",
    "rolls to 25 Hz",
    "flams of 20 ms",
    "long rings (to 60 ms)",
    "noisy (3 counts rms)",
    "mains hum (10 counts)",
    "drifting offset",
    "crosstalk at -20 dB",
    "all at once",
];

/// Scenes of each kind, `scenes` of each.
pub fn scenes(seed: u64, scenes: usize) -> Vec<Scene<CHANNELS>> {
    (0..scenes * KINDS.len())
        .map(|index| scene(index % KINDS.len(), seed.wrapping_mul(1_000_003) + index as u64))
        .collect()
}

fn ring(random: &mut Random, longest_s: f64) -> (Ring, f64) {
    let attack = match random.choice(4) {
        0 => Attack::Sine,
        1 => Attack::Cosine,
        2 => Attack::Contact(random.between_log(0.000_25, 0.001)),
        _ => Attack::Soft(random.between_log(0.000_02, 0.000_2)),
    };
    let ring = Ring {
        frequency_hz: random.between_log(200.0, 8000.0),
        decay_s: random.between_log(0.005, longest_s),
        attack,
        second: (random.between(1.3, 3.1), random.between(0.0, 0.35)),
    };
    (ring, if random.choice(2) == 0 { 1.0 } else { -1.0 })
}

fn scene(kind: usize, seed: u64) -> Scene<CHANNELS> {
    let mut random = Random::new(seed);
    let random = &mut random;
    let name = KINDS[kind];
    let longest_s = if matches!(kind, 3 | 8) { 0.06 } else { 0.02 };
    // An inexact ADC clock moves the mains, too: its frequency may be off by 0.1 Hz.
    let mains_hz = [50.0, 60.0][random.choice(2)] + random.between(-0.1, 0.1);
    let noise_counts = match kind {
        4 => 3.0,
        8 => random.between(0.3, 2.0),
        _ => random.between(0.3, 1.0),
    };
    let strikes = match kind {
        1 => rolls(random),
        2 => flams(random),
        8 => mixed(random),
        _ => singles(random, if matches!(kind, 3 | 7) { 0.3 } else { 0.12 }, if kind == 4 { 0.02 } else { 0.01 }),
    };
    let length_s = strikes.last().map_or(START_S, |strike| strike.time_s) + 0.3;
    Scene {
        name,
        strikes,
        rings: std::array::from_fn(|_| ring(random, longest_s)),
        noise_counts,
        hum: (if matches!(kind, 5 | 8) { random.between(3.0, 10.0) } else { 0.0 }, mains_hz),
        offset: (random.between(-60.0, 60.0), if matches!(kind, 6 | 8) { 40.0 } else { 0.0 }),
        crosstalk: if matches!(kind, 7 | 8) { (0.1, random.between(0.0, 0.001)) } else { (0.0, 0.0) },
        length_s,
        seed,
    }
}

/// Strikes at least `apart_s` apart, each on any pad, evenly in the logarithm from `softest` to
/// 0.99.
fn singles(random: &mut Random, apart_s: f64, softest: f64) -> Vec<Strike> {
    let mut time_s = START_S;
    (0..20)
        .map(|_| {
            time_s += apart_s * random.between(1.0, 2.0);
            Strike { time_s, pad: random.choice(CHANNELS), velocity: random.between_log(softest, 0.99) }
        })
        .collect()
}

/// Rolls of ten strikes on one pad, 12 to 25 a second, each within 3 dB of the roll's velocity.
fn rolls(random: &mut Random) -> Vec<Strike> {
    let mut strikes = Vec::new();
    let mut time_s = START_S;
    for _ in 0..3 {
        let (pad, velocity, rate_hz) =
            (random.choice(CHANNELS), random.between_log(0.015, 0.7), random.between(12.0, 25.0));
        for _ in 0..10 {
            let loudness = random.between_log(0.71, 1.41);
            strikes.push(Strike { time_s, pad, velocity: velocity * loudness });
            time_s += 1.0 / rate_hz;
        }
        time_s += 0.3;
    }
    strikes
}

/// Two strikes on one pad 20 ms apart, the second up to 6 dB softer and 12 dB louder than the
/// first.
fn flams(random: &mut Random) -> Vec<Strike> {
    let mut strikes = Vec::new();
    let mut time_s = START_S;
    for _ in 0..10 {
        time_s += random.between(0.3, 0.4);
        let (pad, velocity) = (random.choice(CHANNELS), random.between_log(0.012, 0.24));
        strikes.push(Strike { time_s, pad, velocity });
        strikes.push(Strike { time_s: time_s + 0.02, pad, velocity: velocity * random.between_log(0.5, 4.0) });
    }
    strikes
}

/// Singles, a roll and flams, one after the other.
fn mixed(random: &mut Random) -> Vec<Strike> {
    let mut strikes = singles(random, 0.3, 0.01);
    for more in [rolls(random), flams(random)] {
        let behind = strikes.last().map_or(0.0, |strike| strike.time_s);
        strikes.extend(more.into_iter().map(|strike| Strike { time_s: strike.time_s + behind, ..strike }));
    }
    strikes
}
