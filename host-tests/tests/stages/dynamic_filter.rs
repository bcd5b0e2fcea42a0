//! The dynamic filter against `f64` with equal noise: slow and fast paths, both orders, the
//! exciter, other rates, strikes, refusals, silence.

use dsp_core::SampleRate;
use dsp_core::dynamic_filter::{Breakpoint, DynamicFilterError, Exciter, PathError};
use host_tests::dynamic_filter::{Table, play};
use host_tests::snr::{Random, snr_db};
use proptest::prelude::*;

const RATE: SampleRate = SampleRate::HZ_48000;

/// Random path of the first order: poles from mild to the edge of the range, decaying gains, steps
/// from `shortest` to `longest` seconds.
fn random_path(random: &mut Random, count: usize, shortest: f64, longest: f64) -> Vec<Breakpoint> {
    let (mut time_s, equal) = (0.0, random.between(0.0, 1.0) < 0.5);
    // Half of the paths come near -1.
    let lowest = if count.is_multiple_of(2) { 1.0 } else { 4.0 };
    (0..count)
        .map(|index| {
            let pole = if random.between(0.0, 1.0) < 0.2 {
                10f64.powf(-random.between(0.0, lowest)) - 1.0
            } else {
                1.0 - 10f64.powf(-random.between(0.0, 4.0))
            };
            let pole = pole.clamp(-0.9999, 0.9999);
            let b0 = 10f64.powf(-random.between(0.0, 0.5) * index as f64) * (1.0 - pole.abs()).sqrt();
            let b1 = if equal { b0 } else { b0 * random.between(-1.0, 1.0) };
            let point = Breakpoint { time_s, a1: -pole, b0, b1, ..Breakpoint::default() };
            time_s += shortest * (longest / shortest).powf(random.between(0.0, 1.0));
            point
        })
        .collect()
}

/// Random path of the second order: conjugate or real poles, gains such that the bus does not clip.
fn random_second_order(random: &mut Random, count: usize, shortest: f64, longest: f64) -> Vec<Breakpoint> {
    let (mut time_s, conjugate) = (0.0, random.between(0.0, 1.0) < 0.5);
    (0..count)
        .map(|index| {
            let mut radius = || 1.0 - 10f64.powf(-random.between(0.3, 4.0));
            let (r, other) = (radius().min(0.9999), radius().min(0.9999));
            let angle = 0.01 * 300f64.powf(random.between(0.0, 1.0));
            let (a1, a2, size) = if conjugate {
                (-2.0 * r * angle.cos(), r * r, (1.0 - r).sqrt() * angle.sin())
            } else {
                (-(r + other), r * other, (1.0 - r).max(1.0 - other).sqrt() * (1.0 - r).min(1.0 - other))
            };
            let gain = 10f64.powf(-random.between(0.0, 0.5) * index as f64) * size;
            let [b0, b1, b2] = [(); 3].map(|()| gain * random.between(-1.0, 1.0));
            let point = Breakpoint { time_s, a1, a2, b0, b1, b2, ..Breakpoint::default() };
            time_s += shortest * (longest / shortest).powf(random.between(0.0, 1.0));
            point
        })
        .collect()
}

/// SNR in dB of two strikes, the second within the path.
fn snr(table: &Table, levels: [f32; 2], rate: SampleRate) -> f64 {
    let mut filter = table.ours(rate).unwrap_or_else(|error| panic!("{error}: {table:?}"));
    let end = (table.path.last().unwrap().time_s * rate.hz()).ceil() as usize;
    let again = (end / 3).clamp(1, 48_000);
    let frames = (again + end + 4800).min(144_000);
    let strikes = [(0, levels[0]), (again, levels[1])];
    let out = play(&mut filter, &strikes, frames);
    snr_db(&table.exact(&strikes, filter.input_shift(), frames, rate), &out)
}

#[test]
fn fast_and_slow_paths_keep_ninety_db_in_both_orders() {
    let mut random = Random::new(3);
    for order in [1, 2] {
        for (what, shortest, longest) in [("fast", 3e-5, 2e-3), ("slow", 0.1, 2.0)] {
            let mut worst = f64::INFINITY;
            for case in 0..40 {
                let make = if order == 1 { random_path } else { random_second_order };
                let path = make(&mut random, 2 + case % 10, shortest, longest);
                let table = Table { order, ..Table::of_path(path) };
                let snr = snr(&table, [1.0, 0.5], RATE);
                worst = worst.min(snr);
                assert!(snr >= 90.0, "order {order}, {what}, {snr:.1} dB: {table:?}");
            }
            println!("order {order}, {what} paths: worst {worst:.1} dB");
        }
    }
}

#[test]
fn edges_of_the_range_keep_ninety_db() {
    for (what, order, a1, a2) in [
        ("slowest pole", 1, -0.9999, 0.0),
        ("fast alternation", 1, 0.9, 0.0),
        ("slowest alternation", 1, 0.9999, 0.0),
        ("no pole", 1, 0.0, 0.0),
        ("slowest conjugate poles", 2, -1.9997, 0.9998),
        ("slowest real poles", 2, -1.9997, 0.999_700_02),
        ("small poles, nearly all in b1", 2, -0.5, 0.06),
    ] {
        for b1 in [1.0, -0.5] {
            let small = a2 == 0.06;
            let b1 = if small { 1e5 * b1 } else { b1 };
            let b0 = if order == 1 { 0.2 * (1.0 - f64::abs(a1)).sqrt() } else { 1e-6 };
            let point = |time_s| Breakpoint { time_s, a1, a2, b0, b1: b1 * b0, ..Breakpoint::default() };
            let table = Table { order, ..Table::of_path(vec![point(0.0), point(1.0)]) };
            let snr = snr(&table, [1.0, 1.99], RATE);
            println!("{what}, b1/b0 {b1}: {snr:.1} dB");
            assert!(snr >= 90.0, "{what}, {snr:.1} dB");
        }
    }
}

#[test]
fn coefficients_are_carried_to_other_rates() {
    let mut random = Random::new(8);
    let mut worst = f64::INFINITY;
    for order in [1, 2] {
        for (from, to) in [(48_000.0, 96_000), (96_000.0, 48_000), (44_100.0, 48_000)] {
            let make = if order == 1 { random_path } else { random_second_order };
            let path = make(&mut random, 4, 0.01, 0.1);
            // Poles near the edge may move beyond it at another rate, so they are made tamer.
            let tame = |p: Breakpoint| Breakpoint { a1: p.a1 * 0.99, a2: p.a2 * 0.9801, ..p };
            let path = path.into_iter().map(tame).collect();
            let table = Table { order, rate_hz: from, ..Table::of_path(path) };
            let snr = snr(&table, [0.7, 0.5], SampleRate::new(to, 1).unwrap());
            worst = worst.min(snr);
            assert!(snr >= 90.0, "{from} Hz to {to} Hz, {snr:.1} dB: {table:?}");
        }
    }
    println!("other rates: worst {worst:.1} dB");
}

#[test]
fn at_twice_the_rate_noise_has_the_same_density() {
    let point = |time_s| Breakpoint { time_s, a1: -0.9, b0: 0.01, b1: 0.01, ..Breakpoint::default() };
    let table = Table::of_path(vec![point(0.0), point(4.0)]);
    let power = |hz: u32| {
        let out = play(&mut table.ours(SampleRate::new(hz, 1).unwrap()).unwrap(), &[(0, 0.9)], 4 * hz as usize);
        out.iter().map(|&s| f64::from(s).powi(2)).sum::<f64>() / out.len() as f64
    };
    // The pole lies far below both Nyquist frequencies, so equal density is equal power.
    let change_db = 10.0 * (power(96_000) / power(48_000)).log10();
    assert!(change_db.abs() < 0.3, "{change_db} dB");
}

#[test]
fn the_exciters_band_is_a_fourth_order_butterworths_and_follows_the_strike() {
    let mut worst = f64::INFINITY;
    for (low_hz, high_hz, exponent) in
        [(80.0, 9000.0, 0.3), (200.0, 230.0, 0.5), (3000.0, 6000.0, 0.0), (20.0, 20_000.0, 1.0), (80.0, 84.0, -0.2)]
    {
        for level in [1.0, 0.3, 0.05] {
            let point = |time_s| Breakpoint { time_s, a1: 0.0, b0: 0.5, ..Breakpoint::default() };
            let exciter = Some(Exciter { low_hz, high_hz, exponent });
            let table = Table { exciter, ..Table::of_path(vec![point(0.0), point(0.5)]) };
            let mut filter = table.ours(RATE).unwrap();
            let strikes = [(0, level)];
            let out = play(&mut filter, &strikes, 28_800);
            let snr = snr_db(&table.exact(&strikes, filter.input_shift(), out.len(), RATE), &out);
            println!("{low_hz} to {high_hz} Hz, exponent {exponent}, level {level}: {snr:.1} dB");
            worst = worst.min(snr + 20.0 * f64::from(1.0 / level).log10());
        }
    }
    assert!(worst >= 90.0, "{worst:.1} dB at full level");
}

/// Sums of products of samples with later ones, for all lags, by way of the power spectrum.
fn autocorrelation(samples: &[f64]) -> Vec<f64> {
    // As many zeros follow, so that the end does not meet the beginning.
    let length = 2 * samples.len();
    let (forward, inverse) = (fourier::forward(length), fourier::inverse(length));
    let mut padded = samples.to_vec();
    padded.resize(length, 0.0);
    let mut spectrum = forward.make_output_vec();
    forward.process(&mut padded, &mut spectrum).unwrap();
    spectrum.iter_mut().for_each(|bin| *bin = fourier::Complex::new(bin.norm_sqr(), 0.0));
    let mut sums = vec![0.0; length];
    inverse.process(&mut spectrum, &mut sums).unwrap();
    sums
}

#[test]
fn noise_is_white_and_a_strikes_level_is_its_rms() {
    let point = |time_s| Breakpoint { time_s, b0: 1.0, ..Breakpoint::default() };
    let mut filter = Table::of_path(vec![point(0.0), point(30.0)]).ours(RATE).unwrap();
    let out = play(&mut filter, &[(0, 0.5)], 1 << 20);
    let samples: Vec<f64> = out.iter().map(|&s| f64::from(s) / 134_217_728.0).collect();
    let power = samples.iter().map(|s| s * s).sum::<f64>() / samples.len() as f64;
    assert!((power.sqrt() - 0.5 / 3f64.sqrt()).abs() < 1e-3, "{}", power.sqrt());
    // Correlations at lags up to and beyond ticks are 1/sqrt(2^20) each. The largest of 5000 may be
    // five deviations.
    let correlations = autocorrelation(&samples);
    let largest = correlations[1..5000].iter().fold(0.0, |most: f64, r| most.max((r / correlations[0]).abs()));
    println!("largest correlation {largest:.2e}");
    assert!(largest < 5.0 / 1024.0, "{largest}");
}

#[test]
fn bad_tables_are_refused_by_name() {
    let point = |time_s, b0, a1| Breakpoint { time_s, b0, b1: b0, a1, ..Breakpoint::default() };
    let refused = |table: &Table| match table.ours(RATE).map(|_| ()).unwrap_err() {
        DynamicFilterError::Path(error) => error,
        other => panic!("{other}"),
    };
    let of = |path: &[Breakpoint]| refused(&Table::of_path(path.to_vec()));
    assert_eq!(of(&[]), PathError::Count { given: 0, room: 32 });
    assert_eq!(of(&[point(0.0, 1.0, 0.0); 33]), PathError::Count { given: 33, room: 32 });
    assert_eq!(of(&[point(0.1, 1.0, 0.0)]), PathError::Order { breakpoint: 0, time_s: 0.1 });
    let backward = [point(0.0, 1.0, 0.0), point(0.2, 1.0, 0.0), point(0.2, 1.0, 0.0)];
    assert_eq!(of(&backward), PathError::Order { breakpoint: 2, time_s: 0.2 });
    for a1 in [1.0, 0.99995, -1.0, -0.99995, -1.5, f64::NAN] {
        let path = [point(0.0, 1.0, 0.0), point(0.1, 0.0, a1)];
        assert!(matches!(of(&path), PathError::Unstable { breakpoint: 1, .. }), "{a1}");
    }
    assert!(matches!(of(&[point(0.0, f64::INFINITY, 0.0)]), PathError::Gain { breakpoint: 0, .. }));
    assert!(matches!(of(&[point(0.0, 1.0, -0.9999)]), PathError::Gain { breakpoint: 0, .. }));

    let second = |a: &[[f64; 2]]| {
        let point = |(n, &[a1, a2]): (usize, &[f64; 2])| Breakpoint { a1, a2, ..point(n as f64, 0.1, 0.0) };
        refused(&Table { order: 2, ..Table::of_path(a.iter().enumerate().map(point).collect()) })
    };
    assert!(matches!(second(&[[0.0, 1.1]]), PathError::Unstable { breakpoint: 0, .. }));
    assert!(matches!(second(&[[-2.5, 1.0]]), PathError::Unstable { breakpoint: 0, .. }));
    assert_eq!(second(&[[0.0, 0.5], [0.0, -0.5]]), PathError::PolesMeet { breakpoint: 1 });
    assert!(matches!(second(&[[-1.0, 0.25 + 1e-12]]), PathError::Gain { breakpoint: 0, .. }));
    let third = Table { order: 3, ..Table::of_path(vec![point(0.0, 1.0, 0.0)]) };
    assert_eq!(refused(&third), PathError::FilterOrder { order: 3 });

    let with = |low_hz, high_hz, exponent| {
        let exciter = Some(Exciter { low_hz, high_hz, exponent });
        Table { exciter, ..Table::of_path(vec![point(0.0, 1.0, 0.0)]) }.ours(RATE).map(|_| ()).unwrap_err()
    };
    for (low, high) in [(200.0, 100.0), (0.0, 100.0), (100.0, 24_000.0), (100.0, 101.0), (f64::NAN, 100.0)] {
        assert!(matches!(with(low, high, 0.0), DynamicFilterError::Exciter(_)), "{low} {high}");
    }
    assert_eq!(with(100.0, 200.0, 5.0), DynamicFilterError::Exponent { exponent: 5.0 });
    let rate = Table { rate_hz: 0.0, ..Table::of_path(vec![point(0.0, 1.0, 0.0)]) };
    assert_eq!(rate.ours(RATE).map(|_| ()).unwrap_err(), DynamicFilterError::Rate { rate_hz: 0.0 });
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// Plays any path with any jumps, under any strikes and modes of any size. The sound is
    /// bounded, its bits are equal for any blocks, and the end is silent.
    #[test]
    fn blocks_change_no_bit_and_all_falls_silent(
        order in 1u8..=2,
        raw in prop::collection::vec((1e-6f64..0.02, -30.0f64..8.0, -1.0f64..1.0, -0.9999f64..0.9999, 0.001f64..3.1), 1..12),
        conjugate in any::<bool>(),
        strikes in prop::collection::vec((1usize..400, 0.0f32..2.5), 1..12),
        blocks in prop::collection::vec(1usize..90, 1..20),
        loud in any::<bool>(),
        excited in any::<bool>(),
        levels in any::<bool>(),
        seed in 1u64..1000,
    ) {
        let mut time_s = 0.0;
        let path: Vec<Breakpoint> = raw
            .iter()
            .map(|&(step, bits, ratio, pole, angle)| {
                let (a1, a2, unit) = match (order, conjugate) {
                    (1, _) => (-pole, 0.0, 1.0 - pole.abs()),
                    (_, true) => (-2.0 * pole.abs() * angle.cos(), pole * pole, (1.0 - pole.abs()) * angle.sin()),
                    _ => {
                        let pole = pole.max(-0.9);
                        (-(pole + pole.abs() / 2.0), pole * pole.abs() / 2.0, (1.0 - pole.abs()).powi(2))
                    }
                };
                let b0 = bits.exp2() * unit;
                let noise = if levels { pole.abs() } else { 1.0 };
                let point = Breakpoint { time_s, a1, a2, b0, b1: b0 * ratio, b2: 0.0, noise };
                time_s += step;
                point
            })
            .collect();
        let exciter = excited.then_some(Exciter { low_hz: 100.0, high_hz: 3000.0, exponent: 0.5 });
        let table = Table { order, exciter, modes_through: loud, ..Table::of_path(path) };
        let filter = table.ours(RATE);
        // A filter between two breakpoints may be louder than at both.
        let is_refused = |error: &DynamicFilterError| {
            matches!(error, DynamicFilterError::Path(PathError::PolesMeet { .. } | PathError::Gain { .. }))
        };
        prop_assume!(!filter.as_ref().is_err_and(is_refused));
        let mut whole = filter.unwrap();
        let mut cut = table.ours(RATE).unwrap();
        let mut random = Random::new(seed);
        for (frames, level) in strikes {
            whole.strike(level);
            cut.strike(level);
            let modes: Vec<i32> = (0..frames).map(|_| if loud { random.between(-2.1e9, 2.1e9) as i32 } else { 0 }).collect();
            let (mut expected, mut got) = (vec![0; frames], vec![0; frames]);
            whole.render(Some(&modes), &mut expected);
            let (mut at, mut block) = (0, blocks.iter().cycle());
            while at < frames {
                let end = (at + block.next().unwrap()).min(frames);
                cut.render(Some(&modes[at..end]), &mut got[at..end]);
                at = end;
            }
            prop_assert_eq!(got, expected);
        }
        let mut tail = vec![0; 48_000];
        for _ in 0..20 {
            whole.render(None, &mut tail);
        }
        prop_assert!(!whole.is_ringing());
        tail.fill(0);
        whole.render(None, &mut tail);
        prop_assert!(tail.iter().all(|&word| word == 0));
    }
}
