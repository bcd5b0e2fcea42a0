//! Dynamic filters with any path, under any strikes.

use dsp_core::dynamic_filter::limits::{MAX_GAIN, MAX_POLE, MIN_POLE};
use dsp_core::event::{Action, Event};
use host_tests::scene::{hand, load, strike};
use kit::{Breakpoint, DynamicFilter, ModesGo};
use proptest::prelude::*;

use crate::filters::{biquads, filter, filtered, is_idle, play, round};

/// Largest gain, summed over the impulse response, for which a filter gets a loop in these tests.
const LOUDEST_LOOPED: f32 = 64.0;

fn any_path() -> impl Strategy<Value = Vec<Breakpoint>> {
    // The pole is -a1, and a1 is in the range that the filter takes.
    let (lowest, highest) = (-0.9999 * MAX_POLE as f32, -0.9999 * MIN_POLE as f32);
    let a1 = prop_oneof![lowest..highest, Just(lowest), Just(highest), Just(0.0)];
    let b = prop_oneof![-1.0f32..1.0, -1e3f32..1e3, Just(0.0), Just(1e-30)];
    let step = prop_oneof![1e-6f32..1e-4, 1e-4f32..0.05];
    prop::collection::vec((step, a1, b.clone(), b), 1..8).prop_map(|points| {
        let mut time_s = 0.0;
        let mut path = Vec::new();
        for (step, a1, b0, b1) in points {
            // The nearer the pole is to the unit circle, the less gain the arithmetic allows.
            let limit = 0.97 * MAX_GAIN as f32 * (1.0 - a1.abs());
            let [b0, b1] = [b0, b1].map(|b: f32| b.clamp(-limit / 2.0, limit / 2.0));
            path.push(Breakpoint { time_s, noise: 1.0, a1, a2: 0.0, b0, b1, b2: 0.0 });
            time_s += step;
        }
        path
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Plays any path, jumps included, under any strikes, hands and levels. The sound stays within
    /// the bus, is silent in the end, and has equal bits for any block size.
    #[test]
    fn any_path_under_any_strikes_is_silent_in_the_end(
        path in any_path(), through: bool, gain in -1.0f32..1.0, level_db in -40.0f32..12.0,
        times in prop::collection::vec((0u64..9_600, 0.0f32..=1.0, 0usize..8), 1..12), block in 1usize..300,
    ) {
        let modes = if through { ModesGo::Through } else { ModesGo::Beside };
        // The loop is stable round the loudest point of the path.
        let loudest = path.iter().map(|p| (p.b0.abs() + p.b1.abs()) / (1.0 - p.a1.abs())).fold(1e-6, f32::max);
        let loops = if loudest <= LOUDEST_LOOPED { vec![round(0.5 * gain / loudest)] } else { vec![] };
        let mut kit = filtered(Some(DynamicFilter { path, loops, ..filter(modes) }), Some(biquads()));
        (kit.pads[0].level_db, kit.pads[0].choke_t60_s) = (level_db, 0.02);
        let loaded = load(kit);
        let mut events: Vec<Event> = times
            .iter()
            .map(|&(frame, velocity, what)| match what {
                0 => hand(frame, Action::Choke),
                1 => hand(frame, Action::Release),
                _ => strike(frame, velocity),
            })
            .collect();
        events.sort_by_key(|event| event.time.first_frame());
        // The slowest pole, of radius 0.9999, falls 120 dB in 3 s.
        let frames = 48_000 * 12;
        let (sound, reports) = play(&loaded, &events, frames, 4_800);
        prop_assert!(sound[frames - 320..].iter().all(|frame| *frame == [0, 0]));
        prop_assert!(reports.last().is_some_and(is_idle));
        let (same, _) = play(&loaded, &events, 24_000, block);
        prop_assert!(sound[..24_000] == same[..]);
    }
}
