//! The set *places*: gains that curve along the object, and two strikers.

use std::f64::consts::TAU;

use super::room::pink_noise;
use super::{RANGE_DB, StruckOften, TrueMode, TrueStrike, modes, render, strikes};
use crate::random::SplitMix64;

/// Contact times in seconds at the strongest strike of the hard and of the soft striker.
const CONTACT_TIMES_S: [f64; 2] = [0.5e-3, 1.6e-3];
/// Number of modes of the hard striker.
const STRIKER_MODES: usize = 3;
/// Level of the pink noise in dBFS rms.
const NOISE_DBFS: f64 = -60.0;

/// Many strikes at random positions of an object, with two strikers: the set *places*.
///
/// Object and gaps are made as those of [`super::plain`]. Mode k has the shape `cos(π (a x + b))`
/// along the object, a uniform from 0.2 to 1.5 and b from 0 to 1. Each strike has a position
/// uniform from 0 to 1 and one of two strikers, with contact times `τ1 m^(-1/6)` with 5 % of
/// scatter, τ1 0.5 and 1.6 ms, and peaks uniform over 30 dB. The hard striker has three modes of
/// its own from 1.2 to 6 kHz, with T60 from 0.08 to 0.25 s. Pink noise has -60 dBFS rms.
pub fn at_places(seed: u64, seconds: f64, count: usize) -> StruckOften {
    let mut random = SplitMix64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x91AC_E500);
    let mut modes = modes(&mut random);
    for mode in &mut modes {
        mode.shape = [0.2 + 1.3 * random.uniform(), random.uniform()];
    }
    let mut own: Vec<TrueMode> = Vec::new();
    while own.len() < STRIKER_MODES {
        let frequency_hz = 1_200.0 * 5f64.powf(random.uniform());
        let is_apart = |mode: &TrueMode| (frequency_hz / mode.frequency_hz).ln().abs() > super::APART.ln();
        if modes.iter().chain(&own).all(is_apart) {
            let phase = TAU * random.uniform();
            let level = 10f64.powf(-12.0 / 20.0 * random.uniform());
            own.push(TrueMode {
                frequency_hz,
                decay_per_s: 1000f64.ln() / (0.08 + 0.17 * random.uniform()),
                gain: [level * phase.cos(), level * phase.sin()],
                shape: [0.0; 2],
                striker: Some(0),
            });
        }
    }
    modes.extend(own);
    let mut strikes = strikes(&mut random, seconds, count);
    for strike in &mut strikes {
        strike.position = random.uniform();
        strike.striker = usize::from(random.uniform() < 0.5);
        strike.peak_force = 10f64.powf(-RANGE_DB / 20.0 * random.uniform());
        let law = CONTACT_TIMES_S[strike.striker] * strike.peak_force.powf(-1.0 / 6.0);
        strike.contact_time_s = law * (0.05 * random.normal()).exp();
    }
    let most = strikes.iter().map(|strike: &TrueStrike| strike.peak_force).fold(f64::MIN_POSITIVE, f64::max);
    strikes.iter_mut().for_each(|strike| strike.peak_force /= most);
    render(modes, strikes, seconds, NOISE_DBFS, |length| pink_noise(&mut random, length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_strikers_strike_and_only_the_hard_one_has_modes_of_its_own() {
        let sound = at_places(3, 10.0, 15);
        let soft = sound.strikes.iter().filter(|strike| strike.striker == 1).count();
        assert!((1..15).contains(&soft) && sound.strikes.len() == 15);
        let own: Vec<&TrueMode> = sound.modes.iter().filter(|mode| mode.striker.is_some()).collect();
        assert!(own.len() == STRIKER_MODES && own.iter().all(|mode| mode.striker == Some(0)));
        assert!(sound.strikes.iter().all(|strike| (0.0..1.0).contains(&strike.position)));
    }
}
