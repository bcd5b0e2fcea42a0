//! Any surface, motion and table: bounded, silent in the end, and the same bits again.

use dsp_core::SampleRate;
use dsp_core::scrape::{Contact, MAX_SPEED_M_PER_S, Motion, MotionError, Scraper};
use dsp_core::time::TICK_FRAMES;
use host_tests::scrape::map::Waves;
use host_tests::scrape::{RATE, Scrapes, along, render};
use proptest::prelude::*;

/// Ticks until a scraper that is lifted is silent; none of them may be louder than the bus.
fn silent_after(scraper: &mut Scraper<'_>) -> usize {
    let mut frames = [0; TICK_FRAMES];
    for tick in 0..200 {
        scraper.render(Motion::default(), &mut frames).expect("at rest");
        if scraper.is_silent() {
            return tick;
        }
    }
    panic!("still sounds");
}

#[test]
fn speeds_above_10_m_per_s_and_numbers_that_are_none_are_refused_and_move_nothing() {
    let scrapes = Scrapes::new();
    let contact = scrapes.contact("mug", "stick", false, [0.0, 1.0]);
    let (mut scraper, mut untouched) = (Scraper::new(contact, RATE), Scraper::new(contact, RATE));
    let mut frames = [7; TICK_FRAMES];
    for velocity_m_per_s in [[10.01, 0.0], [8.0, 8.0], [f32::NAN, 0.0], [0.0, f32::INFINITY]] {
        let motion = Motion { velocity_m_per_s, normal_n: 1.0 };
        let refused = scraper.render(motion, &mut frames).expect_err("too fast");
        assert!(matches!(refused, MotionError::Speed { .. }));
    }
    let motion = Motion { velocity_m_per_s: [1.0, 0.0], normal_n: f32::NAN };
    assert_eq!(scraper.render(motion, &mut frames), Err(MotionError::NormalForce));
    assert_eq!(frames, [7; TICK_FRAMES]);
    let motion = Motion { velocity_m_per_s: [MAX_SPEED_M_PER_S, 0.0], normal_n: 1.0 };
    let mut others = [0; TICK_FRAMES];
    scraper.render(motion, &mut frames).expect("the highest speed");
    untouched.render(motion, &mut others).expect("the highest speed");
    assert_eq!(frames, others);
}

#[test]
fn minute_at_10_m_per_s_ends_in_silence() {
    let scrapes = Scrapes::new();
    for (striker, rolls) in [("stick", false), ("ball", true)] {
        let mut scraper = Scraper::new(scrapes.contact("marimba", striker, rolls, [0.0, 1.0]), RATE);
        let mut frames = [0; TICK_FRAMES];
        for tick in 0..60 * 1500 {
            let normal_n = (tick % 11) as f32 / 10.0;
            scraper.render(Motion { velocity_m_per_s: [10.0, 0.0], normal_n }, &mut frames).expect("possible");
        }
        assert!(silent_after(&mut scraper) < 40);
    }
}

#[test]
fn hour_at_rest_is_silent_and_the_stroke_behind_it_sounds_as_at_first() {
    let scrapes = Scrapes::new();
    let contact = scrapes.contact("mug", "stick", false, [0.0, 1.0]);
    let stroke = along((0..100).map(|_| 0.3), 0.5);
    let mut scraper = Scraper::new(contact, RATE);
    let mut frames = [0; TICK_FRAMES];
    for _ in 0..3600 * 1500 {
        scraper.render(Motion { velocity_m_per_s: [0.0; 2], normal_n: 0.5 }, &mut frames).expect("at rest");
        assert_eq!(frames, [0; TICK_FRAMES]);
    }
    let mut force = Vec::new();
    for motion in &stroke {
        scraper.render(*motion, &mut frames).expect("possible");
        force.extend(frames);
    }
    assert_eq!(force, render(contact, &stroke));
}

/// Smoothing in seconds, seed, whether the contact rolls, and the normal forces.
type Rest = (f32, u32, bool, [f32; 2]);

/// Parameters of a contact over the whole range of a kit: pad, numbers of the force, limits α, and
/// the rest. The pad `pan` has a map, the others profiles.
fn parameters() -> impl Strategy<Value = (&'static str, [f32; 4], [f32; 2], Rest)> {
    let pad = prop::sample::select(vec!["mug", "marimba", "pan", "glockenspiel"]);
    let force = (1e-6..100.0f32, 0.0..1e4f32, 0.25..4.0f32, 0.05..8.0f32).prop_map(<[f32; 4]>::from);
    let limits = (-6.0..0.0f32, 0.0..4.0f32).prop_map(|(least, more)| {
        let least_m = 10f32.powf(least);
        [least_m, (least_m * 10f32.powf(more)).min(1.0)]
    });
    let rest = (0.0..2e-4f32, any::<u32>(), any::<bool>(), prop_oneof![Just([0.0, 1.0]), Just([1.0, 1.0])]);
    (pad, force, limits, rest)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn any_contact_and_motion_is_bounded_and_ends_in_silence(
        (pad, force, alpha_m, (smoothing_s, seed, rolls, normal_n)) in parameters(),
        motions in prop::collection::vec((-7.0..7.0f32, -7.0..7.0f32, -0.5..2.0f32), 1..200),
        rate in prop::sample::select(vec![SampleRate::HZ_48000, SampleRate::HZ_44100]),
    ) {
        let scrapes = Scrapes::with_map("pan", Waves::new().surface("waves"));
        let contact = scrapes.contact(pad, if rolls { "ball" } else { "stick" }, rolls, normal_n);
        let [mass_kg, gain, exponent, alpha_exponent] = force;
        let contact = Contact { mass_kg, slope: [gain, exponent], alpha_m, alpha_exponent, smoothing_s, seed, ..contact };
        let mut scraper = Scraper::new(contact, rate);
        let mut frames = [0; TICK_FRAMES];
        for &(x, y, normal_n) in &motions {
            scraper.render(Motion { velocity_m_per_s: [x, y], normal_n }, &mut frames).expect("possible");
        }
        prop_assert!(silent_after(&mut scraper) < 60);
    }
}
