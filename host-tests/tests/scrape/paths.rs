//! What a path does to its force: speed, direction, and places that come again.

use dsp_core::scrape::Contact;
use host_tests::scrape::bands::energies;
use host_tests::scrape::{RATE, Scrapes, along, twin};

/// Force of the reference in newtons at a constant speed.
fn force_at(contact: Contact<'_>, speed: f64, ticks: usize) -> Vec<f64> {
    let contact = Contact { reference_force_n: 1e3, ..contact };
    let unit = 1e3 / f64::from(dsp_core::fixed::ONE_Q27);
    twin(contact, &along((0..ticks).map(|_| speed), 1.0)).into_iter().map(|force| force * unit).collect()
}

#[test]
fn force_grows_by_12_db_where_the_speed_doubles() {
    let scrapes = Scrapes::new();
    for (pad, speeds) in [("mug", [0.1, 0.2]), ("mug", [0.4, 0.8]), ("marimba", [0.1, 0.2]), ("marimba", [0.3, 0.6])] {
        let contact = scrapes.contact(pad, "stick", false, [1.0, 1.0]);
        let contact = Contact { smoothing_s: 0.0, ..contact };
        // Both go over the same 0.6 m, so that their waves are the same ones.
        let [slow, fast] = [(speeds[0], 1.0), (speeds[1], 2.0)].map(|(speed, ratio)| {
            let ticks = (0.6 / speed * RATE.hz() / 32.0) as usize;
            let middles = (0..13).map(|third| 250.0 * ratio * 2f64.powf(f64::from(third) / 3.0));
            energies(&force_at(contact, speed, ticks), RATE.hz(), middles)
        });
        for (third, (slow, fast)) in slow.iter().zip(&fast).enumerate() {
            let grown_db = 10.0 * (fast / slow).log10();
            assert!((grown_db - 12.04).abs() < 0.5, "{pad}, {speeds:?} m/s, third {third}: {grown_db:.2} dB");
        }
    }
}

#[test]
fn vertical_force_on_the_way_back_is_that_of_the_way_there_within_40_db() {
    let scrapes = Scrapes::new();
    for (pad, speed) in [("mug", 0.2), ("mug", 1.0), ("marimba", 0.1), ("marimba", 0.6)] {
        let contact = scrapes.contact(pad, "stick", false, [1.0, 1.0]);
        let contact = Contact { smoothing_s: 0.0, slope: [0.0, 1.0], ..contact };
        let turn = |tick: usize| speed * (std::f64::consts::PI * (tick + 1) as f64 / 1000.0).sin();
        let contact = Contact { reference_force_n: 1e3, ..contact };
        let force = twin(contact, &along((0..2000).map(turn), 1.0));
        let (there, back) = force.split_at(force.len() / 2);
        let signal: f64 = there.iter().map(|x| x * x).sum();
        let error: f64 = there.iter().zip(back.iter().rev()).map(|(a, b)| (a - b).powi(2)).sum();
        let ratio_db = 10.0 * (error / signal).log10();
        assert!(ratio_db < -40.0, "{pad} at {speed} m/s: {ratio_db:.1} dB");
        println!("{pad} at {speed} m/s: {ratio_db:.1} dB");
    }
}

#[test]
fn no_pitch_is_heard_over_2_m() {
    let scrapes = Scrapes::new();
    for (pad, speed) in [("mug", 0.5), ("marimba", 0.5), ("pan", 1.0), ("glass", 0.3)] {
        let contact = scrapes.contact(pad, "stick", false, [1.0, 1.0]);
        let force = force_at(contact, speed, (2.0 / speed * RATE.hz() / 32.0) as usize);
        let largest = autocorrelation_beyond(&force, (0.01 / speed * RATE.hz()) as usize);
        println!("{pad}: {largest:.3}");
        assert!(largest < 0.1, "{pad}: {largest:.3}");
    }
}

/// Largest autocorrelation, relative to that at 0, beyond a lag up to half the signal.
fn autocorrelation_beyond(force: &[f64], lag: usize) -> f64 {
    let mean = force.iter().sum::<f64>() / force.len() as f64;
    let mut padded: Vec<f64> = force.iter().map(|x| x - mean).collect();
    padded.resize((2 * force.len()).next_power_of_two(), 0.0);
    let forward = fourier::forward(padded.len());
    let mut bins = forward.make_output_vec();
    forward.process(&mut padded, &mut bins).expect("slices of the plan's lengths");
    bins.iter_mut().for_each(|bin| *bin = fourier::Complex::new(bin.norm_sqr(), 0.0));
    fourier::inverse(padded.len()).process(&mut bins, &mut padded).expect("slices of the plan's lengths");
    padded[lag..force.len() / 2].iter().fold(0.0_f64, |most, x| most.max(x.abs())) / padded[0]
}
