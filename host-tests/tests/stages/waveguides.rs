//! Banded waveguides against `f64`: long loops, stability, any block size, silence.

use dsp_core::SampleRate;
use dsp_core::dynamic_filter::{Breakpoint, DynamicFilterError, Exciter};
use dsp_core::waveguide::{Loop, LoopError};
use host_tests::dynamic_filter::{Table, play};
use host_tests::snr::snr_db;
use proptest::prelude::*;
use std::f64::consts::TAU;

const RATE: SampleRate = SampleRate::HZ_48000;

/// Magnitude `|F|` and phase of a first-order breakpoint at a frequency.
fn response(point: &Breakpoint, hz: f64) -> (f64, f64) {
    let omega = std::f64::consts::TAU * hz / 48_000.0;
    let of = |c0: f64, c1: f64| {
        let (re, im) = (c0 + c1 * omega.cos(), -c1 * omega.sin());
        (re.hypot(im), im.atan2(re))
    };
    let (above, below) = (of(point.b0, point.b1), of(1.0, point.a1));
    (above.0 / below.0, above.1 - below.1)
}

/// Delay in seconds by eq. 22, with the smallest p for which it has at least `frames` frames.
fn delay_s(point: &Breakpoint, hz: f64, frames: f64) -> f64 {
    let omega = std::f64::consts::TAU * hz / 48_000.0;
    let phase = response(point, hz).1;
    let turns = ((frames * omega - phase) / std::f64::consts::TAU).ceil();
    (phase + std::f64::consts::TAU * turns) / omega / 48_000.0
}

/// Path of a short burst of noise, after which the filter stays.
fn path() -> Vec<Breakpoint> {
    let point = |time_s, b0: f64, a1| Breakpoint { time_s, b0, b1: b0, a1, ..Breakpoint::default() };
    vec![point(0.0, 0.25, -0.5), point(0.02, 0.25, -0.5)]
}

/// Loops at frequencies in Hz that ring with a T60.
///
/// A pass of d seconds, the band's own delay included, has `γ |F| = 10^(-3 d / T60)`.
fn loops(hz: &[f64], t60_s: f64, frames: f64) -> Vec<Loop> {
    let last = path()[1];
    hz.iter()
        .map(|&frequency_hz| {
            let bandwidth_hz = 4.0;
            let delay_s = delay_s(&last, frequency_hz, frames);
            // A band-pass of Δf delays by 1/(π Δf) at its middle.
            let pass_s = delay_s + 1.0 / (std::f64::consts::PI * bandwidth_hz);
            let gain = 10f64.powf(-3.0 * pass_s / t60_s) / response(&last, frequency_hz).0;
            Loop { frequency_hz, bandwidth_hz, gain, delay_s }
        })
        .collect()
}

fn table(loops: Vec<Loop>) -> Table {
    Table { loops, ..Table::of_path(path()) }
}

#[test]
fn loops_that_ring_for_twenty_seconds_keep_ninety_db() {
    for (what, hz, frames) in [
        ("blocks of a tick", vec![110.0, 700.0, 1234.5, 3000.0, 7777.0], 32.0),
        ("high ones", vec![5000.0, 9000.0, 13_000.0, 20_000.0], 32.0),
        ("short delays", vec![700.0, 3000.0, 7777.0], 2.0),
        ("low ones", vec![80.0, 400.0], 32.0),
    ] {
        let table = table(loops(&hz, 20.0, frames));
        let mut ours = table.ours(RATE).unwrap();
        let out = play(&mut ours, &[(0, 1.0)], 48_000 * 5);
        let exact = table.exact(&[(0, 1.0)], ours.input_shift(), out.len(), RATE);
        // After the burst the loops are alone.
        let (whole, ringing) = (snr_db(&exact, &out), snr_db(&exact[4800..], &out[4800..]));
        let level = |s: &[f64]| 20.0 * (s.iter().fold(0.0f64, |peak, x| peak.max(x.abs())) / 134_217_728.0).log10();
        println!(
            "{what}: whole {whole:.1} dB, ringing alone {ringing:.1} dB; {:.1} dBFS at 0.5 s, {:.1} dBFS at 4.5 s",
            level(&exact[24_000..36_000]),
            level(&exact[216_000..])
        );
        assert!(whole >= 90.0, "{what}: {whole}");
        // The loops must ring: 60 dB in some 20 s.
        assert!(level(&exact[216_000..]) > level(&exact[24_000..36_000]) - 20.0, "{what}");
    }
}

/// The figures are those of the table in docs/kit-format.md: gain of a loop far from its middle,
/// over that at its middle, for a numerator of two terms.
#[test]
fn loops_pass_far_from_their_middle_what_the_page_says() {
    let rate = reference::SampleRate { numerator: 48_000, denominator: 1 };
    for (frequency_hz, bandwidth_hz, at_0, at_nyquist, at_tenth, of_eq_10) in [
        (100.0, 2.0, -68.1, -77.7, -53.7, -53.9),
        (500.0, 20.0, -48.1, -57.7, -45.0, -47.9),
        (2_000.0, 20.0, -48.4, -57.8, -48.1, -60.0),
        (2_000.0, 100.0, -34.4, -43.8, -34.1, -46.0),
        (8_000.0, 100.0, -39.3, -45.3, -39.2, -58.8),
    ] {
        let of = |numerator: [f64; 3], [c3, c4]: [f64; 2], hz: f64| {
            let section = reference::biquad::Biquad { numerator, denominator: [c3, c4] };
            20.0 * section.magnitude(hz / 48_000.0 * TAU).log10()
        };
        let mut worst = [f64::NEG_INFINITY; 3];
        let mut eq_10 = 0.0;
        for step in 0..=40 {
            let delay_s = (100.0 + 0.999 * f64::from(step) / 40.0) / 48_000.0;
            let one = reference::waveguide::Loop { frequency_hz, bandwidth_hz, gain: 1.0, delay_s };
            let tuned = one.tuned(rate);
            let [c0, c1] = tuned.numerator;
            assert!(of([c0, c1, 0.0], tuned.denominator, frequency_hz).abs() < 1e-9);
            for (worst, hz) in worst.iter_mut().zip([0.0, 24_000.0, frequency_hz / 10.0]) {
                *worst = worst.max(of([c0, c1, 0.0], tuned.denominator, hz));
            }
            // c0 = τ / (1 + τ) = (1 - c4) / 2.
            let c = (1.0 - tuned.denominator[1]) / 2.0;
            eq_10 = of([c, 0.0, -c], tuned.denominator, frequency_hz / 10.0);
        }
        for (found, said) in worst.into_iter().chain([eq_10]).zip([at_0, at_nyquist, at_tenth, of_eq_10]) {
            assert!((found - said).abs() < 0.1, "{frequency_hz} Hz, {bandwidth_hz} Hz: {found:.2} dB, said {said} dB");
        }
    }
}

#[test]
fn a_moving_filter_in_loops_keeps_ninety_db() {
    let point = |time_s, b0: f64, a1| Breakpoint { time_s, b0, b1: 0.6 * b0, a1, ..Breakpoint::default() };
    let path = [point(0.0, 0.3, -0.2), point(0.05, 0.1, -0.8), point(0.2, 0.02, -0.95)];
    let loops = loops(&[300.0, 1000.0, 4000.0], 5.0, 32.0).into_iter().map(|one| Loop { gain: 0.4, ..one }).collect();
    for (order, a2) in [(1, 0.0), (2, 0.5)] {
        let path = path.iter().map(|p| Breakpoint { a2: a2 * p.a1 * p.a1, ..*p }).collect();
        let table = Table { order, path, loops: Vec::clone(&loops), ..Table::of_path(Vec::new()) };
        let mut ours = table.ours(RATE).unwrap();
        let strikes = [(0, 1.0), (3000, 0.4)];
        let out = play(&mut ours, &strikes, 24_000);
        let snr = snr_db(&table.exact(&strikes, ours.input_shift(), out.len(), RATE), &out);
        println!("order {order}: {snr:.1} dB");
        assert!(snr >= 90.0, "{snr}");
    }
}

#[test]
fn unstable_and_impossible_loops_are_refused_by_name() {
    let refused = |loops: &[Loop]| match table(loops.to_vec()).ours(RATE).map(|_| ()) {
        Err(DynamicFilterError::Loop(error)) => error,
        other => panic!("{other:?}"),
    };
    let delay_s = delay_s(&path()[1], 1000.0, 32.0);
    let one = |frequency_hz, gain| Loop { frequency_hz, bandwidth_hz: 3.0, gain, delay_s };
    let limit = 1.0 / response(&path()[1], 1000.0).0;
    assert!(table(vec![one(1000.0, limit * 0.999)]).ours(RATE).is_ok());
    for gain in [limit * 1.001, -limit * 1.001, 50.0] {
        assert!(matches!(refused(&[one(1000.0, gain)]), LoopError::Unstable { .. }), "{gain}");
    }
    assert_eq!(refused(&[one(500.0, 0.1), one(24_000.0, 0.1)]), LoopError::Band { index: 1 });
    let good = one(500.0, 0.1);
    for bad in [
        one(f64::NAN, 0.1),
        one(500.0, f64::NAN),
        one(-5.0, 0.1),
        Loop { bandwidth_hz: 0.0, ..good },
        Loop { bandwidth_hz: 600.0, ..good },
        Loop { delay_s: 1e-6, ..good },
        Loop { delay_s: f64::NAN, ..good },
    ] {
        assert_eq!(refused(&[good, bad]), LoopError::Band { index: 1 }, "{bad:?}");
    }
    assert!(matches!(refused(&[Loop { delay_s: 0.2, ..good }]), LoopError::Delay { index: 0, room: 8192, .. }));
    assert_eq!(refused(&[good; 17]), LoopError::Count { given: 17, room: 16 });
}

#[test]
fn loops_that_only_a_narrow_pole_of_the_filter_makes_grow_are_refused_too() {
    // The filter's pole is 0.8 Hz wide, and the loop's band lies elsewhere.
    let around = |hz: f64, gain: f64| {
        let angle = std::f64::consts::TAU * hz / 48_000.0;
        let point =
            Breakpoint { a1: -2.0 * 0.9999 * angle.cos(), a2: 0.9999f64.powi(2), b0: 1e-3, ..Breakpoint::default() };
        let loops = vec![Loop { frequency_hz: 900.0, bandwidth_hz: 40.0, gain, delay_s: 0.002 }];
        Table { order: 2, loops, ..Table::of_path(vec![point, Breakpoint { time_s: 0.1, ..point }]) }.ours(RATE)
    };
    for hz in [20.0, 1000.3, 1023.4, 1039.0] {
        assert!(around(hz, 1e-9).is_ok(), "{hz}");
        let refused = around(hz, 8.0).map(|_| ());
        assert!(matches!(refused, Err(DynamicFilterError::Loop(LoopError::Unstable { .. }))), "{hz}: {refused:?}");
    }
    // This pole lies at 0 Hz, in first order.
    let point = Breakpoint { a1: -0.9999, b0: 0.05, ..Breakpoint::default() };
    let loops = vec![Loop { frequency_hz: 900.0, bandwidth_hz: 40.0, gain: 0.9, delay_s: 0.002 }];
    let refused =
        Table { loops, ..Table::of_path(vec![point, Breakpoint { time_s: 0.1, ..point }]) }.ours(RATE).map(|_| ());
    assert!(matches!(refused, Err(DynamicFilterError::Loop(LoopError::Unstable { .. }))), "{refused:?}");
}

#[test]
fn all_falls_silent_and_stays_so() {
    let mut ours = table(loops(&[220.0, 900.0, 5000.0], 2.0, 32.0)).ours(RATE).unwrap();
    ours.strike(1.0);
    ours.render(None, &mut vec![0; 48_000 * 8]);
    assert!(!ours.is_ringing());
    let mut tail = vec![0; 48_000];
    ours.render(None, &mut tail);
    assert!(tail.iter().all(|&word| word == 0));
}

#[test]
fn loops_round_a_filter_of_much_gain_fall_silent() {
    let point = |time_s| Breakpoint { time_s, b0: 0.5, b1: 0.5, a1: -0.9995, ..Breakpoint::default() };
    for hz in [10.0, 60.0, 1000.0] {
        let gain = response(&point(0.0), hz).0;
        let delay_s = delay_s(&point(0.0), hz, 32.0);
        let one = Loop { frequency_hz: hz, bandwidth_hz: 4.0, gain: 0.98 / gain, delay_s };
        let table = Table { loops: vec![one], ..Table::of_path(vec![point(0.0), point(0.05)]) };
        let mut ours = table.ours(RATE).unwrap();
        ours.strike(0.001);
        let (mut out, mut seconds) = (vec![0; 48_000], 0);
        while ours.is_ringing() && seconds < 120 {
            out.fill(0);
            ours.render(None, &mut out);
            seconds += 1;
        }
        let peak = out.iter().map(|word| word.unsigned_abs()).max().unwrap_or(0);
        println!("a gain of {gain:.0} at {hz} Hz: silent within {seconds} s, last peak {peak} steps of the bus");
        assert!(!ours.is_ringing(), "{hz} Hz rings on at {peak} steps");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 30, failure_persistence: None, ..ProptestConfig::default() })]

    /// Plays any stable loops round any path, jumps included, under modes of any size. The sound is
    /// bounded (debug assertions are on), and its bits are equal for any blocks.
    #[test]
    fn blocks_change_no_bit(
        raw in prop::collection::vec((1e-6f64..0.02, 0.01f64..1.0, -1.0f64..1.0, -0.9999f64..0.9999), 1..8),
        bands in prop::collection::vec((5.0f64..23_900.0, 0.01f64..0.9, -1.0f64..1.0, 1.0f64..3000.0), 1..8),
        strikes in prop::collection::vec((1usize..700, 0.0f32..2.0), 1..8),
        blocks in prop::collection::vec(1usize..90, 1..20),
        loud in any::<bool>(),
    ) {
        let mut time_s = 0.0;
        let path: Vec<Breakpoint> = raw
            .iter()
            .map(|&(step, gain, ratio, pole)| {
                let b0 = gain * (1.0 - pole.abs());
                let point = Breakpoint { time_s, a1: -pole, b0, b1: b0 * ratio, ..Breakpoint::default() };
                time_s += step;
                point
            })
            .collect();
        let count = bands.len() as f64;
        let loops = bands
            .iter()
            .map(|&(frequency_hz, part, gain, frames)| Loop {
                frequency_hz,
                bandwidth_hz: part * frequency_hz.min(4000.0),
                gain: gain / count / 4.0,
                delay_s: frames / 48_000.0,
            })
            .collect();
        let table = Table { loops, modes_through: true, ..Table::of_path(path) };
        let ours = table.ours(RATE);
        prop_assume!(ours.is_ok());
        let mut whole = ours.unwrap();
        let mut cut = table.ours(RATE).unwrap();
        for (frames, level) in strikes {
            whole.strike(level);
            cut.strike(level);
            let modes: Vec<i32> = (0..frames).map(|n| if loud { (n as i32 % 7 - 3) * 600_000_000 } else { 0 }).collect();
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
    }

    /// Compares whole ticks, which are done in a shorter way while nothing begins or ends, with odd
    /// blocks.
    ///
    /// Strikes and a hand come at any time, until the loops are cleared.
    #[test]
    fn whole_ticks_change_no_bit(
        corners in prop::collection::vec((1e-5f64..0.05, -0.99f64..0.99, 0.0f64..1.0), 1..5),
        order in 1u8..=2,
        bands in prop::collection::vec((40.0f64..20_000.0, 1.0f64..300.0, 0.01f64..0.9, 4.0f64..600.0), 0..4),
        excited in any::<bool>(),
        levels in any::<bool>(),
        runs in prop::collection::vec((1usize..9000, 0.0f32..2.0, any::<bool>()), 1..5),
        blocks in prop::collection::vec(1usize..90, 1..20),
    ) {
        let mut time_s = 0.0;
        let path: Vec<Breakpoint> = corners
            .iter()
            .map(|&(step, pole, noise)| {
                let b0 = 0.3 * (1.0 - pole.abs());
                let noise = if levels { noise } else { 1.0 };
                let a2 = if order == 2 { 0.9 * pole * pole } else { 0.0 };
                let point = Breakpoint { time_s, a1: -pole, a2, b0, b1: b0, noise, ..Breakpoint::default() };
                time_s += step;
                point
            })
            .collect();
        let share = 0.5 / bands.len() as f64;
        let loops = bands
            .iter()
            .map(|&(frequency_hz, hz, gain, frames)| Loop {
                frequency_hz,
                bandwidth_hz: hz.min(frequency_hz / 4.0),
                gain: gain * share,
                delay_s: frames / 48_000.0,
            })
            .collect();
        let exciter = excited.then_some(Exciter { low_hz: 100.0, high_hz: 3000.0, exponent: 0.5 });
        let table = Table { order, exciter, loops, ..Table::of_path(path) };
        let ours = table.ours(RATE);
        prop_assume!(ours.is_ok());
        let mut whole = ours.unwrap();
        let (mut cut, mut place, mut block) = (table.ours(RATE).unwrap(), 0, blocks.iter().cycle());
        let last = (40_000, 0.0, false);
        for (frames, level, hand) in runs.into_iter().chain([last]) {
            for filter in [&mut whole, &mut cut] {
                filter.strike(level);
                if hand {
                    filter.attenuate(1 << 28);
                }
            }
            let (mut expected, mut got) = (vec![0; frames], vec![0; frames]);
            let (mut at, mut from) = (0, 0);
            while at < frames {
                let end = (at + 32 - (place + at) % 32).min(frames);
                whole.render(None, &mut expected[at..end]);
                at = end;
            }
            while from < frames {
                let end = (from + block.next().unwrap()).min(frames);
                cut.render(None, &mut got[from..end]);
                from = end;
            }
            place += frames;
            prop_assert!(got == expected, "they differ from frame {:?} on", got.iter().zip(&expected).position(|(a, b)| a != b));
        }
        prop_assert_eq!(whole.is_ringing(), cut.is_ringing());
    }
}
