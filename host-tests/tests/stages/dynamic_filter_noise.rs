//! Noise of the dynamic filter: its level along the path. Its bands, decays and onset over 200
//! seeds are compared with the expectation in `f64`.

use dsp_core::SampleRate;
use dsp_core::dynamic_filter::{Breakpoint, DynamicFilterError, PathError};
use dsp_core::waveguide::Loop;
use host_tests::dynamic_filter::{Table, play};
use host_tests::snr::{Random, snr_db};
use host_tests::sweeps::dynamic_filter::{SEEDS, of_seed, point};
use host_tests::sweeps::{self, Extent};

const RATE: SampleRate = SampleRate::HZ_48000;

#[test]
fn levels_of_the_noise_keep_ninety_db_with_everything_round_them() {
    let mut random = Random::new(21);
    let exciter = Some(dsp_core::dynamic_filter::Exciter { low_hz: 90.0, high_hz: 6000.0, exponent: 0.0 });
    let one = |frequency_hz| Loop { frequency_hz, bandwidth_hz: 4.0, gain: 0.5, delay_s: 41.3 / 48_000.0 };
    let looped = || vec![one(300.0), one(2100.0)];
    for (what, order, loops, exciter) in [
        ("alone", 1, Vec::new(), None),
        ("second order", 2, Vec::new(), None),
        ("loops", 1, looped(), None),
        ("loops of a second order", 2, looped(), None),
        ("exciter", 1, Vec::new(), exciter),
        ("exciter and loops", 1, looped(), exciter),
    ] {
        let mut worst = f64::INFINITY;
        for case in 0..8 {
            let mut time_s = 0.0;
            let path = (0..5)
                .map(|n| {
                    let pole = random.between(0.1, 0.95);
                    let a2 = if order == 2 { 0.6 * pole * pole } else { 0.0 };
                    let quiet = n > 0 && random.between(0.0, 1.0) < 0.4;
                    let noise = if quiet { 0.0 } else { random.between(0.2, 1.0) };
                    let point = Breakpoint { a2, noise, ..point(time_s, 0.3 * (1.0 - pole), -pole) };
                    time_s += if case % 2 == 0 { random.between(2e-4, 2e-3) } else { random.between(0.02, 0.2) };
                    point
                })
                .collect::<Vec<_>>();
            let table = Table { order, loops: loops.clone(), exciter, ..Table::of_path(path) };
            let mut ours = table.ours(RATE).unwrap();
            let strikes = [(0, 1.0), (900, 0.6)];
            // The exciter of the reference has only one level, so it gets only one strike.
            let strikes = if exciter.is_some() { &strikes[..1] } else { &strikes[..] };
            // After these frames, sound below -96 dBFS would be cleared.
            let out = play(&mut ours, strikes, 12_000);
            let exact = table.exact(strikes, ours.input_shift(), out.len(), RATE);
            if exact.iter().all(|x| *x == 0.0) {
                continue;
            }
            worst = worst.min(snr_db(&exact, &out));
        }
        println!("levels, {what}: worst {worst:.1} dB");
        assert!((90.0..1000.0).contains(&worst), "{what}: {worst}");
    }
}

#[test]
fn a_level_of_the_noise_that_is_none_is_refused_by_name() {
    for noise in [-0.1, 1.5, f64::NAN, f64::INFINITY] {
        let path = vec![point(0.0, 0.2, -0.5), Breakpoint { noise, ..point(0.1, 0.2, -0.5) }];
        let refused = Table::of_path(path).ours(RATE).map(|_| ()).unwrap_err();
        assert!(matches!(refused, DynamicFilterError::Path(PathError::Noise { breakpoint: 1, .. })), "{refused}");
    }
}

#[test]
fn noise_may_end_while_loops_ring_on() {
    let silent = |time_s| Breakpoint { noise: 0.0, ..point(time_s, 0.25, -0.5) };
    let path = vec![point(0.0, 0.25, -0.5), silent(0.01), silent(2.0)];
    let ring = Loop { frequency_hz: 440.0, bandwidth_hz: 3.0, gain: 0.99, delay_s: 108.5 / 48_000.0 };
    let mut rings = Table { loops: vec![ring], ..Table::of_path(path.clone()) }.ours(RATE).unwrap();
    let mut alone = Table::of_path(path).ours(RATE).unwrap();
    let [rings, alone] = [&mut rings, &mut alone].map(|filter| play(filter, &[(0, 1.0)], 48_000));
    let energy = |out: &[i32]| out.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>();
    assert!(alone[960..].iter().all(|&word| word == 0));
    assert!(energy(&rings[24_000..]) > 1e-6 * energy(&rings[..480]), "{}", energy(&rings[24_000..]));
}

#[test]
fn bands_of_a_standing_filter_are_those_of_its_response() {
    sweeps::dynamic_filter::standing_bands(Extent::Tenth);
}

#[test]
fn decays_are_those_of_the_reference() {
    sweeps::dynamic_filter::decays(Extent::Tenth);
}

#[test]
fn every_strike_sounds_at_its_frame_and_none_before() {
    let table = Table::of_path(vec![point(0.0, 0.3, -0.5), point(0.1, 0.05, -0.9)]);
    for seed in 0..SEEDS {
        let start = 1 + seed as usize * 7 % 97;
        let out = play(&mut of_seed(&table, seed), &[(start, 1.0)], start + 2);
        assert!(out[..start].iter().all(|&word| word == 0), "seed {seed}: a sound before the strike");
        assert!(out[start..].iter().any(|&word| word != 0), "seed {seed}: no sound within a frame of the strike");
    }
}

#[test]
fn the_tick_rate_is_not_heard() {
    sweeps::dynamic_filter::tick_lines(Extent::Tenth);
}

#[test]
fn a_zero_nearly_cancelled_at_nyquist_keeps_ninety_db() {
    // The path is that of metal as it is estimated in its first milliseconds: all frequencies pass,
    // through a1 near 1.
    let path = vec![point(0.0, 0.999, 0.998), point(0.01, 0.95, 0.9), point(0.05, 0.3, -0.3), point(0.4, 0.02, -0.95)];
    for loops in
        [Vec::new(), vec![Loop { frequency_hz: 700.0, bandwidth_hz: 4.0, gain: 0.5, delay_s: 41.3 / 48_000.0 }]]
    {
        let table = Table { loops, ..Table::of_path(path.clone()) };
        let mut ours = table.ours(RATE).unwrap();
        let out = play(&mut ours, &[(0, 1.0), (4800, 0.3)], 24_000);
        let snr = snr_db(&table.exact(&[(0, 1.0), (4800, 0.3)], ours.input_shift(), out.len(), RATE), &out);
        println!("pole and zero near Nyquist, {} loops: {snr:.1} dB", table.loops.len());
        assert!(snr >= 90.0, "{snr}");
    }
}
