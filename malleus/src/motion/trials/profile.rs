//! Distance over time of a tool that starts and ends smoothly.

use std::f64::consts::PI;

/// Longest time of the start, and of the end, in seconds.
const RAMP_S: f64 = 0.1;

/// Constant speed between a start and an end in which the speed follows a raised cosine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Profile {
    speed: f64,
    pub(super) ramp_s: f64,
    pub(super) seconds: f64,
}

impl Profile {
    /// Profile over a length at a speed, both above 0 and in the units of choice.
    pub(super) fn over(length: f64, speed: f64) -> Self {
        let ramp_s = RAMP_S.min(length / speed);
        Self { speed, ramp_s, seconds: length / speed + ramp_s }
    }

    /// Distance from the beginning at a time from 0 to `seconds`.
    pub(super) fn distance(&self, time_s: f64) -> f64 {
        let Self { speed, ramp_s, seconds } = *self;
        // The speed of the ramp is speed/2 (1 - cos(πt/ramp)); this is its integral.
        let ramp = |time_s: f64| 0.5 * speed * (time_s - ramp_s / PI * (PI * time_s / ramp_s).sin());
        if time_s < ramp_s {
            ramp(time_s)
        } else if time_s > seconds - ramp_s {
            speed * (seconds - ramp_s) - ramp(seconds - time_s)
        } else {
            speed * (time_s - 0.5 * ramp_s)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profile_ends_at_its_length_and_begins_and_ends_at_rest() {
        for (length, speed) in [(1.0, 0.5), (0.01, 1.0), (0.05, 0.5)] {
            let profile = Profile::over(length, speed);
            assert_eq!(profile.distance(0.0), 0.0);
            assert!((profile.distance(profile.seconds) - length).abs() < 1e-12 * length);
            let step = 1e-4 * profile.seconds;
            for n in 1..10_000 {
                let at = |n: i32| profile.distance(f64::from(n) * step);
                let found = (at(n) - at(n - 1)) / step;
                assert!((0.0..=speed * 1.000_001).contains(&found), "{found} at step {n}");
            }
            assert!(profile.distance(step) < 1e-3 * speed * step);
        }
    }
}
