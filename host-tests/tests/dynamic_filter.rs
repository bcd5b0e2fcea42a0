//! The dynamic filter against `f64` fed the same noise: slow and fast paths, strikes, refusals, blocks of any size, silence.

use dsp_core::SampleRate;
use dsp_core::biquad::butterworth::{Exciter, band_pass};
use dsp_core::dynamic_filter::{Breakpoint, Filter, Path, PathError};
use dsp_core::noise::Sfc32;
use host_tests::snr::{Random, snr_db};
use proptest::prelude::*;

const RATE: reference::SampleRate = reference::SampleRate { numerator: 48_000, denominator: 1 };
const POINTS: usize = 16;

fn path(points: &[Breakpoint]) -> Path<POINTS> {
    Path::new(points.iter().copied(), SampleRate::HZ_48000).unwrap()
}

fn theirs(points: &[Breakpoint]) -> Vec<reference::dynamic_filter::Breakpoint> {
    let same = |&Breakpoint { time_s, b0, b1, a1, .. }: &Breakpoint| reference::dynamic_filter::Breakpoint {
        time_s,
        b0,
        b1,
        a1,
    };
    points.iter().map(same).collect()
}

/// The noise that a filter of this seed draws.
fn noise(seed: u32, stream: u32, frames: usize) -> Vec<i32> {
    let mut generator = Sfc32::new(seed, stream);
    let mut halves = || {
        let word = generator.draw();
        [word >> 16, word & 0xffff].map(|half| i32::from(half as u16 as i16) << 12)
    };
    (0..frames.div_ceil(2)).flat_map(|_| halves()).take(frames).collect()
}

/// Breakpoints as eq. 17 with random corners: a decaying gain, a pole from mild to 0.9999, steps from `shortest` seconds.
fn random_points(random: &mut Random, count: usize, shortest: f64, longest: f64) -> Vec<Breakpoint> {
    let mut time_s = 0.0;
    let mut points: Vec<Breakpoint> = (0..count)
        .map(|index| {
            let pole = 1.0 - 10f64.powf(-random.between(0.0, 4.0));
            let pole = if random.between(0.0, 1.0) < 0.2 { -pole * 0.9 } else { pole };
            let gain = 10f64.powf(-random.between(0.0, 0.5) * index as f64) * (1.0 - pole.abs()).sqrt();
            let b1 = gain * random.between(-1.0, 1.0);
            let point = Breakpoint { time_s, b0: gain, b1, a1: -pole, a2: 0.0, b2: 0.0 };
            time_s += shortest * (longest / shortest).powf(random.between(0.0, 1.0));
            point
        })
        .collect();
    points.iter_mut().step_by(2).for_each(|point| point.b1 = point.b0);
    points
}

#[test]
fn fast_and_slow_paths_keep_ninety_db() {
    let mut random = Random::new(3);
    for (what, shortest, longest) in [("fast", 3e-5, 2e-3), ("slow", 0.1, 2.0)] {
        let mut worst = f64::INFINITY;
        for case in 0..60u32 {
            let points = random_points(&mut random, 2 + case as usize % 10, shortest, longest);
            let end = (points.last().unwrap().time_s * 48_000.0).ceil() as usize;
            let again = (end / 3).clamp(1, 48_000);
            let frames = (again + end + 4800).min(144_000);
            let mut filter = Filter::new(path(&points), case, 1);
            let mut out = vec![0; frames];
            filter.strike(1.0);
            filter.render(None, &mut out[..again]);
            filter.strike(0.5);
            filter.render(None, &mut out[again..]);
            let mut input: Vec<f64> = noise(case, 1, frames).into_iter().map(f64::from).collect();
            input.iter_mut().skip(again + end).for_each(|e| *e = 0.0);
            let gain = f64::from((0.5 * f64::from(i32::MAX)) as i32) / f64::exp2(31.0);
            let exact = reference::dynamic_filter::filter(&theirs(&points), &[(0, 1.0), (again, gain)], &input, RATE);
            let snr = snr_db(&exact, &out);
            if snr < worst {
                worst = snr;
            }
            assert!(snr >= 90.0, "{what}, {snr:.1} dB: {points:?}");
        }
        println!("{what} paths: worst {worst:.1} dB");
    }
}

#[test]
fn bad_paths_are_refused_by_name() {
    let point = |time_s, b0, a1| Breakpoint { time_s, b0, b1: b0, a1, a2: 0.0, b2: 0.0 };
    let refused =
        |points: &[Breakpoint]| Path::<3>::new(points.iter().copied(), SampleRate::HZ_48000).map(|_| ()).unwrap_err();
    assert_eq!(refused(&[]), PathError::Count { given: 0, room: 3 });
    assert_eq!(refused(&[point(0.0, 1.0, 0.0); 4]), PathError::Count { given: 4, room: 3 });
    assert_eq!(refused(&[point(0.1, 1.0, 0.0)]), PathError::Order { breakpoint: 0, time_s: 0.1 });
    let backward = [point(0.0, 1.0, 0.0), point(0.2, 1.0, 0.0), point(0.2, 1.0, 0.0)];
    assert_eq!(refused(&backward), PathError::Order { breakpoint: 2, time_s: 0.2 });
    for a1 in [1.0, -1.0, -1.5, f64::NAN] {
        assert!(matches!(
            refused(&[point(0.0, 1.0, 0.0), point(0.1, 0.0, a1)]),
            PathError::Unstable { breakpoint: 1, .. }
        ));
    }
    assert!(matches!(refused(&[point(0.0, f64::INFINITY, 0.0)]), PathError::Gain { breakpoint: 0, .. }));
    assert!(matches!(refused(&[point(0.0, 1e4, 0.9999)]), PathError::Gain { breakpoint: 0, .. }));
    assert!(
        band_pass(200.0, 100.0, SampleRate::HZ_48000).is_err()
            && band_pass(1.0, 24_000.0, SampleRate::HZ_48000).is_err()
    );
}

#[test]
fn the_exciters_band_is_a_fourth_order_butterworths_and_follows_the_strike() {
    let exciter = Exciter { low_hz: 200.0, high_hz: 1800.0, exponent: 0.5 };
    for (strength, low, high) in [(0.25, 100.0, 900.0), (0.5, 141.421_356, 1272.792_206), (1.0, 200.0, 1800.0)] {
        let sections = exciter.sections(strength, SampleRate::HZ_48000).unwrap();
        let level = |hz: f64| -> f64 {
            let of = |biquad: &dsp_core::biquad::Biquad| {
                let denominator = [-2.0 * biquad.pole.real, biquad.pole.square()];
                let theirs = reference::biquad::Biquad { numerator: biquad.numerator, denominator };
                20.0 * theirs.magnitude(std::f64::consts::TAU * hz / 48_000.0).log10()
            };
            sections.iter().map(of).sum()
        };
        // |H|² = 1 / (1 + ((w² - w0²) / (B w))⁴) with warped frequencies.
        let warp = |hz: f64| (std::f64::consts::PI * hz / 48_000.0).tan();
        for hz in [20.0, low, 300.0, 1000.0, high, 20_000.0] {
            let (w, middle, width) = (warp(hz), warp(low) * warp(high), warp(high) - warp(low));
            let exact = -10.0 * (1.0 + ((w * w - middle) / (width * w)).powi(4)).log10();
            assert!((level(hz) - exact).abs() < 1e-3, "{strength}, {hz} Hz: {} dB, {exact} dB", level(hz));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any path with any jumps, any strikes, modes of any size: bounded, the same bits in any blocks, and silence in the end.
    #[test]
    fn blocks_change_no_bit_and_all_falls_silent(
        raw in prop::collection::vec((1e-6f64..0.02, -30.0f64..8.0, -1.0f64..1.0, -0.99999f64..0.99999), 1..12),
        strikes in prop::collection::vec((1usize..400, 0.0f32..1.0), 1..12),
        blocks in prop::collection::vec(1usize..90, 1..20),
        loud in any::<bool>(),
        seed in 1u64..1000,
    ) {
        let mut time_s = 0.0;
        let points: Vec<Breakpoint> = raw
            .iter()
            .map(|&(step, bits, ratio, a1)| {
                let b0 = bits.exp2() * (1.0 - a1.abs());
                let point = Breakpoint { time_s, b0, b1: b0 * ratio, a1, a2: 0.0, b2: 0.0 };
                time_s += step;
                point
            })
            .collect();
        let filter = Filter::new(path(&points), 1, 2);
        let (mut whole, mut cut) = (filter.clone(), filter);
        let mut random = Random::new(seed);
        for (frames, gain) in strikes {
            whole.strike(gain);
            cut.strike(gain);
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
        for _ in 0..120 {
            whole.render(None, &mut tail);
        }
        prop_assert!(!whole.is_ringing());
        tail.fill(0);
        whole.render(None, &mut tail);
        prop_assert!(tail.iter().all(|&word| word == 0));
    }
}
