//! The bank of biquads against `f64`: accuracy, refusals, bounds, and blocks of any size.

use dsp_core::SampleRate;
use dsp_core::biquad::{Bank, Biquad, BiquadError, Root};
use host_tests::snr::{Random, snr_db};
use proptest::prelude::*;

const FULL_SCALE: f64 = 134_217_728.0;

/// Chains in both worlds, each section's largest gain on the circle 1.
fn chains(
    poles: &[(f64, f64)],
    zeros: &[(f64, f64)],
    depth: usize,
) -> (Vec<Biquad>, Vec<Vec<reference::biquad::Biquad>>) {
    let mut ours = Vec::new();
    let mut theirs = Vec::new();
    for (&(radius, angle), &(zero_radius, zero_angle)) in poles.iter().zip(zeros) {
        let (pole, zero) = (Root::polar(radius, angle), Root::polar(zero_radius, zero_angle));
        let plain =
            |k| reference::biquad::Biquad::from_roots((pole.real, pole.imaginary), (zero.real, zero.imaginary), k);
        let peak = plain(1.0).magnitude(angle).max(plain(1.0).magnitude(0.0)).max(plain(1.0).magnitude(3.14));
        theirs.push(plain(1.0 / peak));
        ours.push(Biquad::from_roots(pole, zero, 1.0 / peak));
    }
    (ours, theirs.chunks(depth).map(<[_]>::to_vec).collect())
}

/// Gives each section a gain such that what it hands on is at -20 dBFS rms: far poles and zeros in a chain leave next to nothing otherwise.
fn make_loud(ours: &mut [Biquad], theirs: &mut [Vec<reference::biquad::Biquad>], input: &[i32]) {
    let input: Vec<f64> = input.iter().map(|&x| f64::from(x)).collect();
    for (ours, theirs) in ours.chunks_mut(theirs[0].len()).zip(theirs) {
        let mut signal = input.clone();
        for (ours, theirs) in ours.iter_mut().zip(theirs) {
            signal = theirs.filter(&signal);
            let rms = (signal.iter().map(|y| y * y).sum::<f64>() / signal.len() as f64).sqrt();
            let gain = 0.1 * FULL_SCALE / rms;
            signal.iter_mut().for_each(|y| *y *= gain);
            ours.numerator.iter_mut().for_each(|b| *b *= gain);
            theirs.numerator.iter_mut().for_each(|b| *b *= gain);
        }
    }
}

/// SNR in dB of a bank against `f64` over an input.
fn accuracy(biquads: &[Biquad], chains: &[Vec<reference::biquad::Biquad>], depth: usize, input: &[i32]) -> f64 {
    let mut bank = Bank::<32>::new(biquads, depth).unwrap();
    let mut out = vec![0; input.len()];
    bank.render(Some(input), &mut out);
    let exact = reference::biquad::filter(chains, &input.iter().map(|&x| f64::from(x)).collect::<Vec<_>>());
    snr_db(&exact, &out)
}

/// Worst SNR under noise of 50 banks of a depth, whose poles and zeros `place` chooses.
fn worst_of_depth(depth: usize, seed: u64, place: impl Fn(&mut Random, usize) -> (Pairs, Pairs)) -> f64 {
    let mut random = Random::new(seed);
    let mut worst = f64::INFINITY;
    for case in 0..50 {
        let (poles, zeros) = place(&mut random, depth * (1 + case % 3));
        let (mut ours, mut theirs) = chains(&poles, &zeros, depth);
        let noise: Vec<i32> = (0..48_000).map(|_| (random.between(-0.9, 0.9) * FULL_SCALE) as i32).collect();
        make_loud(&mut ours, &mut theirs, &noise);
        let snr = accuracy(&ours, &theirs, depth, &noise);
        worst = worst.min(snr);
    }
    worst
}

/// Radius and angle, one for each section.
type Pairs = Vec<(f64, f64)>;

/// A radius from 0 to `1 - 10^-largest`, evenly in the logarithm of its distance from 1, and an angle of 20 Hz to 23 kHz.
fn root(random: &mut Random, largest: f64) -> (f64, f64) {
    let radius = 1.0 - 10f64.powf(-random.between(0.0, largest));
    let hz = 20.0 * 1150f64.powf(random.between(0.0, 1.0));
    (radius, hz * std::f64::consts::TAU / 48_000.0)
}

#[test]
fn chains_of_every_depth_keep_ninety_db_over_all_poles_and_zeros() {
    for depth in 1..=4 {
        let worst = worst_of_depth(depth, depth as u64, |random, count| {
            let mut all = |largest| (0..count).map(|_| root(random, largest)).collect();
            (all(5.0), all(2.0))
        });
        println!("worst SNR under noise, chains of {depth}: {worst:.1} dB");
        assert!(worst >= 90.0, "{worst}");
    }
}

#[test]
fn chains_whose_poles_nearly_coincide_keep_ninety_db_too() {
    for depth in 2..=4 {
        for nearness in [0.0, 1e-6, 1e-3, 0.1, 1.0, 4.0] {
            let worst = worst_of_depth(depth, 77 + depth as u64, |random, count| {
                let mut poles = Vec::new();
                for _ in 0..count / depth {
                    let (radius, angle) = root(random, 5.0);
                    let width = 1.0 - radius;
                    let mut near = |_| {
                        let radius = (radius + width * nearness * random.between(-0.2, 0.2)).clamp(0.0, 0.999_99);
                        (radius, (angle + width * nearness * random.between(-1.0, 1.0)).clamp(0.0, 3.14))
                    };
                    poles.extend((0..depth).map(&mut near));
                }
                (poles, (0..count).map(|_| root(random, 2.0)).collect())
            });
            println!("worst SNR, chains of {depth} within {nearness} widths: {worst:.1} dB");
            // Three or four narrow poles a few of their widths apart: each part is ten times larger than their sum.
            let floor = if nearness > 1.0 && depth > 2 { 85.0 } else { 90.0 };
            assert!(worst >= floor, "{worst}");
        }
    }
}

#[test]
fn poles_on_or_outside_the_circle_and_other_bad_tables_are_refused_by_name() {
    let biquad = |radius| Biquad::from_roots(Root::polar(radius, 0.3), Root::default(), 1.0);
    let load = |biquads: &[Biquad], depth| Bank::<2>::new(biquads, depth).map(|_| ());
    for radius in [1.0, 1.5, 0.999_999_999_9] {
        let error = load(&[biquad(0.5), biquad(radius)], 1).unwrap_err();
        assert!(matches!(error, BiquadError::UnstablePole { biquad: 1, .. }), "{error:?}");
        assert!(error.to_string().contains("does not decay"), "{error}");
    }
    let nan = Biquad { numerator: [f64::NAN, 0.0, 0.0], ..biquad(0.5) };
    assert_eq!(load(&[nan], 1), Err(BiquadError::NotFinite { biquad: 0 }));
    let loud = Biquad { numerator: [1e12, 0.0, 0.0], ..biquad(0.5) };
    assert!(matches!(load(&[loud], 1), Err(BiquadError::UnboundedGain { biquad: 0, .. })));
    assert_eq!(load(&[biquad(0.5); 3], 2), Err(BiquadError::Depth { depth: 2, sections: 3 }));
    assert_eq!(load(&[biquad(0.5); 5], 5), Err(BiquadError::Depth { depth: 5, sections: 5 }));
    assert_eq!(load(&[biquad(0.5); 5], 1), Err(BiquadError::Full { sections: 5, room: 2 }));
}

#[test]
fn a_mode_is_a_biquad_and_comes_back() {
    let rate = SampleRate::HZ_48000;
    for (frequency, decay, sine, cosine) in [(55.0, 0.4, 3.0, 0.0), (440.0, 7.0, -2.0, 5.0), (15_000.0, 60.0, 0.0, 1.0)]
    {
        let biquad = Biquad::from_mode(frequency, decay, sine, cosine, rate);
        let mode = biquad.to_mode(rate).unwrap();
        for (got, given) in [(mode.0, frequency), (mode.1, decay), (mode.2, sine), (mode.3, cosine)] {
            assert!((got - given).abs() < 1e-6 * (1.0 + given.abs()), "{mode:?}");
        }
        // And it rings as the mode does: an impulse through the bank.
        let mut impulse = vec![0; 9600];
        impulse[0] = 1 << 27;
        let mut out = vec![0; impulse.len()];
        let loud = Biquad { numerator: biquad.numerator.map(|b| b * 20_000.0), ..biquad };
        Bank::<1>::new(&[loud], 1).unwrap().render(Some(&impulse), &mut out);
        let exact: Vec<f64> = (0..out.len())
            .map(|n| {
                let (time, half) = (n as f64 / 48_000.0, if n == 0 { 0.5 } else { 1.0 });
                let phase = std::f64::consts::TAU * frequency * time;
                (-decay * time).exp() * (sine * phase.sin() + cosine * phase.cos()) * half * 20_000.0 / 48_000.0
                    * FULL_SCALE
            })
            .collect();
        let snr = snr_db(&exact, &out);
        assert!(snr >= 90.0, "{frequency} Hz: {snr} dB");
    }
}

#[test]
fn zeros_come_back_as_they_were_given() {
    let biquad = Biquad::from_roots(Root::polar(0.9, 1.0), Root::polar(0.8, 2.0), -3.0);
    let (gain, [zero, other]) = biquad.roots().unwrap();
    assert!((gain + 3.0).abs() < 1e-12 && (zero.square().sqrt() - 0.8).abs() < 1e-12);
    assert!((zero.imaginary.atan2(zero.real) - 2.0).abs() < 1e-12 && other.imaginary == -zero.imaginary);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any sections, inputs of any size with jumps and gaps, any blocks: the same bits, and silence in the end.
    #[test]
    fn blocks_change_no_bit_and_all_falls_silent(
        sections in prop::collection::vec((0.0f64..4.5, 0.0f64..3.14, -2.0f64..2.0, -2.0f64..2.0, -30.0f64..20.0), 4),
        depth in prop::sample::select(vec![1usize, 2, 4]),
        levels in prop::collection::vec(0u32..32, 1..40),
        blocks in prop::collection::vec(1usize..100, 1..30),
        seed in 1u64..1000,
    ) {
        let biquads: Vec<Biquad> = sections
            .iter()
            .map(|&(near, angle, real, imaginary, gain_bits)| {
                Biquad::from_roots(Root::polar(1.0 - 10f64.powf(-near), angle), Root { real, imaginary }, gain_bits.exp2())
            })
            .collect();
        let Ok(bank) = Bank::<4>::new(&biquads, depth) else { return Ok(()) };
        let (mut whole, mut cut) = (bank.clone(), bank);
        let mut random = Random::new(seed);
        // Each level for 50 frames: all of i32 at 31, at 0 nothing.
        let input: Vec<i32> = levels
            .iter()
            .flat_map(|&level| std::iter::repeat_n(level, 50))
            .map(|level| (random.between(-2.0, 2.0) * f64::from(level).exp2() * if level == 0 { 0.0 } else { 1.0 }) as i32)
            .collect();
        let mut expected = vec![0; input.len()];
        whole.render(Some(&input), &mut expected);
        let mut got = vec![0; input.len()];
        let (mut at, mut block) = (0, blocks.iter().cycle());
        while at < input.len() {
            let end = (at + block.next().unwrap()).min(input.len());
            cut.render(Some(&input[at..end]), &mut got[at..end]);
            at = end;
        }
        prop_assert_eq!(&got, &expected);
        // A radius of 1 - 10^-4.5 loses 2^-100 in 2.2 million frames.
        let mut tail = vec![0; 48_000];
        for _ in 0..60 {
            if !whole.is_ringing() {
                break;
            }
            whole.render(None, &mut tail);
        }
        prop_assert!(!whole.is_ringing());
        tail.fill(0);
        whole.render(None, &mut tail);
        prop_assert!(tail.iter().all(|&word| word == 0));
    }
}
