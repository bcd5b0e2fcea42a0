//! Random modes and strikes: the fit ends with an error or with numbers that replay the recording.

use proptest::prelude::*;

use super::synthetic::{StruckOften, TrueMode, TrueStrike, add_response, render};
use super::{Estimate, Layout, StrikesError, estimate};
use crate::modes::Settings;
use crate::random::SplitMix64;

/// Largest difference in dB of what a replay leaves from what the fit says that it leaves.
const AS_SAID_DB: f64 = 0.01;

/// Modes of any frequency and T60, close ones included.
fn modes() -> impl Strategy<Value = Vec<TrueMode>> {
    let mode = (150.0f64..9_000.0, 0.04f64..2.5, -1.0f64..1.0, -1.0f64..1.0).prop_map(
        |(frequency_hz, t60_s, sine, cosine)| TrueMode {
            frequency_hz,
            decay_per_s: 1000f64.ln() / t60_s,
            gain: [sine, cosine],
            shape: [0.0; 2],
            striker: None,
        },
    );
    prop::collection::vec(mode, 1..9)
}

/// Strikes with gaps from 15 ms on, contact times from 0.1 to 4 ms and peaks over 40 dB.
fn strikes() -> impl Strategy<Value = Vec<TrueStrike>> {
    let strike = (0.015f64..0.7, 0.1e-3f64..4e-3, -40.0f64..0.0);
    prop::collection::vec(strike, 1..10).prop_map(|strikes| {
        let mut at_s = 0.0;
        let placed = strikes.into_iter().map(|(gap_s, contact_time_s, peak_db)| {
            at_s += gap_s;
            let peak_force = 10f64.powf(peak_db / 20.0);
            TrueStrike { at_s, contact_time_s, peak_force, position: 0.0, striker: 0 }
        });
        placed.collect()
    })
}

fn sound() -> impl Strategy<Value = StruckOften> {
    (modes(), strikes(), -80.0f64..-35.0, any::<u64>()).prop_map(|(modes, strikes, noise_dbfs, seed)| {
        let seconds = strikes[strikes.len() - 1].at_s + 0.4;
        let mut random = SplitMix64(seed);
        render(modes, strikes, seconds, noise_dbfs, |length| (0..length).map(|_| random.normal()).collect())
    })
}

fn fitted(sound: &StruckOften, layout: Layout) -> Result<Estimate, StrikesError> {
    estimate(&sound.samples, sound.rate_hz, Settings::default(), layout, |_| {})
}

/// Level in dB of full scale of what is left when a fit's modes are struck anew.
fn left_by_replay_dbfs(sound: &StruckOften, fit: &Estimate) -> f64 {
    let mut replay = vec![0.0; sound.samples.len()];
    for strike in &fit.strikes {
        let again = TrueStrike {
            at_s: strike.at_s,
            contact_time_s: strike.contact_time_s,
            peak_force: strike.peak_force,
            position: 0.0,
            striker: 0,
        };
        for mode in &fit.modes {
            let (frequency_hz, decay_per_s, gain) = (mode.frequency_hz, mode.decay_per_s, mode.gain);
            let mode = TrueMode { frequency_hz, decay_per_s, gain, shape: [0.0; 2], striker: None };
            add_response(&mode, &again, &mut replay);
        }
        for (n, x) in replay.iter_mut().enumerate() {
            let since = (n as f64 / sound.rate_hz - strike.at_s) / strike.contact_time_s;
            if (0.0..1.0).contains(&since) {
                *x += fit.acceleration * strike.peak_force * (std::f64::consts::PI * since).sin();
            }
        }
    }
    let energy: f64 = sound.samples.iter().zip(&replay).map(|(x, y)| (x - y) * (x - y)).sum();
    10.0 * (energy / replay.len() as f64).log10()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn replay_of_any_fitted_strikes_leaves_what_the_fit_says(sound in sound()) {
        if let Ok(fit) = fitted(&sound, Layout::default()) {
            let left = left_by_replay_dbfs(&sound, &fit);
            prop_assert!((left - fit.left_dbfs).abs() < AS_SAID_DB, "{left} dBFS are left, not {}", fit.left_dbfs);
            let said = fit.strikes.iter().flat_map(|strike| [strike.middle_s_sd, strike.contact_time_s_sd]);
            prop_assert!(said.chain(fit.modes.iter().map(|mode| mode.decay_per_s_sd)).all(|sd| sd >= 0.0));
        }
    }

    #[test]
    fn any_strikes_end_in_an_error_or_a_fit_with_positions_and_strikers(
        sound in sound(), positions in 1usize..7, strikers in 1usize..4
    ) {
        if let Ok(fit) = fitted(&sound, Layout { positions, strikers }) {
            prop_assert!(fit.left_dbfs.is_finite() && fit.strikes.len() >= 2 && !fit.modes.is_empty());
            for strike in &fit.strikes {
                prop_assert!(strike.striker < strikers && (0.0..=1.0).contains(&strike.position));
                prop_assert!(strike.peak_force > 0.0 && strike.peak_force <= 1.0 + 1e-9);
            }
        }
    }
}
