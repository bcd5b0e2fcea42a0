//! The instrument against the reference, which reads the same places of the same tables in `f64`.

use dsp_core::scrape::{Contact, Motion};
use host_tests::scrape::{Scrapes, along, render, twin};
use host_tests::snr::snr_db;
use proptest::prelude::*;

/// Ratio in dB of the reference's force and the instrument's distance from it, without force that
/// leaves the bus.
fn ratio_db(contact: Contact<'_>, motions: &[Motion]) -> f64 {
    // No force comes near the bus's end, 16.
    let loudest = twin(contact, motions).iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    let reference_force_n = contact.reference_force_n * (loudest / 2f64.powi(28)) as f32;
    if loudest == 0.0 {
        // No force is equal to none.
        return if render(contact, motions).iter().all(|&force| force == 0) { f64::INFINITY } else { 0.0 };
    }
    let contact = Contact { reference_force_n, ..contact };
    snr_db(&twin(contact, motions), &render(contact, motions))
}

#[test]
fn scrapes_are_within_107_db_of_the_reference_at_each_speed_and_limit() {
    let scrapes = Scrapes::new();
    let mut worst = f64::INFINITY;
    for pad in ["mug", "marimba", "pan"] {
        for speed in [0.05, 0.2, 0.5, 1.0, 2.0] {
            for normal_n in [0.0, 0.4, 1.0] {
                let contact = scrapes.contact(pad, "stick", false, [0.0, 1.0]);
                // Nothing is pressed down at 0: the least force is a little more.
                let ratio_db = ratio_db(contact, &along((0..600).map(|_| speed), normal_n + 1e-6));
                worst = worst.min(ratio_db);
                assert!(ratio_db > 107.0, "{pad} at {speed} m/s, {normal_n} N: {ratio_db:.1} dB");
            }
        }
    }
    println!("scrapes: at least {worst:.1} dB");
}

#[test]
fn rolls_are_within_103_db_of_the_reference() {
    let scrapes = Scrapes::new();
    let mut worst = f64::INFINITY;
    for pad in ["mug", "marimba", "pan", "drum"] {
        for speed in [0.05, 0.2, 0.5, 1.0] {
            let weight_n = 0.022 * 9.80665;
            let contact = scrapes.contact(pad, "ball", true, [weight_n; 2]);
            let ratio_db = ratio_db(contact, &along((0..1000).map(|_| speed), weight_n));
            worst = worst.min(ratio_db);
            assert!(ratio_db > 103.0, "{pad} at {speed} m/s: {ratio_db:.1} dB");
        }
    }
    println!("rolls: at least {worst:.1} dB");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_scrape_with_reversals_is_within_90_db_of_the_reference(
        speeds in prop::collection::vec(-2.0..2.0f64, 4..40),
        hold in 1..40usize,
        normal_n in 0.01..1.0f32,
        exponent in prop_oneof![Just(1.0f32), 0.5..3.0f32],
        pad in prop::sample::select(vec!["mug", "marimba", "glass", "drum"]),
    ) {
        let scrapes = Scrapes::new();
        let contact = scrapes.contact(pad, "stick", false, [0.0, 1.0]);
        let contact = Contact { slope: [contact.slope[0], exponent], ..contact };
        let motions = along(speeds.iter().flat_map(|speed| std::iter::repeat_n(*speed, hold)), normal_n);
        let ratio_db = ratio_db(contact, &motions);
        prop_assert!(ratio_db > 90.0, "{ratio_db:.1} dB");
    }
}
