//! Maps: the instrument against the reference, and the reference against the continuous law.

use std::f64::consts::TAU;

use dsp_core::scrape::{Contact, Motion};
use dsp_core::time::TICK_FRAMES;
use host_tests::scrape::bands::{apart, energies, middles_hz};
use host_tests::scrape::law::OVERSAMPLING;
use host_tests::scrape::map::{MapLaw, Waves};
use host_tests::scrape::{RATE, Scrapes, render, twin};
use host_tests::snr::snr_db;

/// Speed up to which a map is read true: an eighth of its shortest wave a frame.
fn fastest(contact: &Contact<'_>) -> f64 {
    f64::from(contact.surface.shortest_m()) * RATE.hz() / 8.0
}

/// Motions on a line at an angle, or on a circle at so many turns a second.
fn motions(ticks: usize, speed: f64, angle: f64, turns_hz: f64) -> Vec<Motion> {
    let motion = |tick: usize| {
        let angle = angle + TAU * turns_hz * ((tick + 1) * TICK_FRAMES) as f64 / RATE.hz();
        let velocity_m_per_s = [speed * angle.cos(), speed * angle.sin()].map(|v| v as f32);
        Motion { velocity_m_per_s, normal_n: 0.5 }
    };
    (0..ticks).map(motion).collect()
}

/// Contact of one limit, 0 the least and 1 the largest.
fn with_limit<'k>(contact: &Contact<'k>, between: f32) -> (Contact<'k>, f64) {
    let alpha_m = contact.alpha_m[0] + between * (contact.alpha_m[1] - contact.alpha_m[0]);
    let mean_m = 0.5 * (contact.alpha_m[0] + contact.alpha_m[1]);
    let smoothing_s = contact.smoothing_s * alpha_m / mean_m;
    (Contact { alpha_m: [alpha_m; 2], smoothing_s, reference_force_n: 1e3, ..*contact }, alpha_m.into())
}

#[test]
fn scrapes_on_maps_are_those_of_the_reference_at_any_angle() {
    let scrapes = Scrapes::with_map("mug", Waves::new().surface("waves"));
    let contact = scrapes.contact("mug", "stick", false, [0.0, 1.0]);
    let mut worst = [f64::INFINITY; 2];
    for share in [0.1, 0.5, 1.0, 2.0, 8.0] {
        for (angle, turns_hz) in [(0.0, 0.0), (0.5, 0.0), (0.25 * TAU, 0.0), (2.5, 0.0), (0.0, 7.0)] {
            let motions = motions(600, share * fastest(&contact), angle, turns_hz);
            let loudest = twin(contact, &motions).iter().fold(0.0_f64, |most, force| most.max(force.abs()));
            let contact =
                Contact { reference_force_n: contact.reference_force_n * (loudest / 2f64.powi(28)) as f32, ..contact };
            let ratio_db = snr_db(&twin(contact, &motions), &render(contact, &motions));
            println!("{share} of the fastest, {angle:.1} rad, {turns_hz} Hz: {ratio_db:.1} dB");
            let which = usize::from(share > 1.0);
            worst[which] = worst[which].min(ratio_db);
        }
    }
    let [slow, fast] = worst;
    println!("maps: at least {slow:.1} dB, beyond the fastest {fast:.1} dB");
    assert!(slow > 112.0 && fast > 93.0, "{slow:.1} and {fast:.1} dB");
}

#[test]
fn third_octaves_on_a_map_are_those_of_the_law_at_any_angle() {
    let waves = Waves::new();
    let scrapes = Scrapes::with_map("mug", waves.surface("waves"));
    let contact = scrapes.contact("mug", "stick", false, [1.0, 1.0]);
    let (mut rms_db, mut most_db) = (0.0_f64, 0.0_f64);
    for between in [0.0, 1.0] {
        let (contact, alpha_m) = with_limit(&contact, between);
        let law = MapLaw::new(&contact, &waves, alpha_m);
        for (share, angle, turns_hz) in
            [(0.2, 0.7, 0.0), (1.0, 0.0, 0.0), (1.0, 0.8, 0.0), (1.0, 1.9, 0.0), (0.6, 0.0, 4.0)]
        {
            let motions = motions(450, share * fastest(&contact), angle, turns_hz);
            let exact = energies(&law.force(&contact, &motions), RATE.hz() * OVERSAMPLING as f64, middles_hz());
            let unit = f64::from(contact.reference_force_n) / f64::from(dsp_core::fixed::ONE_Q27);
            let force: Vec<f64> = twin(contact, &motions).into_iter().map(|force| force * unit).collect();
            let own = apart(&exact, &energies(&force, RATE.hz(), middles_hz()));
            println!(
                "limit {between}, {share} of the fastest, {angle:.1} rad, {turns_hz} Hz: {:.2} dB rms, at most {:.2}",
                own.rms_db, own.most_db
            );
            (rms_db, most_db) = (rms_db.max(own.rms_db), most_db.max(own.most_db));
        }
    }
    println!("maps: at most {rms_db:.2} dB rms, {most_db:.2} dB in a third of an octave");
    assert!(rms_db < 0.3 && most_db < 1.1, "{rms_db:.2} dB rms, at most {most_db:.2}");
}
