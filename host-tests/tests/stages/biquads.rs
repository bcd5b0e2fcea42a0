//! The bank of biquads in Q31 against `f64`: accuracy, refusals, bounds, and any block size.

use dsp_core::biquad::{Biquad, BiquadError, Root};
use host_tests::biquads::{Chains, FULL_SCALE, anywhere, bank, near, worst_of_depth};
use host_tests::snr::{Random, snr_db};
use proptest::prelude::*;

/// SNR in dB of a bank against `f64` over an input.
fn accuracy(chains: &Chains, input: &[i32]) -> f64 {
    let mut bank = bank(&chains.ours, chains.depth, 32).unwrap();
    let mut out = vec![0; input.len()];
    bank.render(Some(input), &mut out);
    snr_db(&chains.exact(input), &out)
}

#[test]
fn chains_of_every_depth_keep_ninety_db_over_all_poles_and_zeros() {
    for depth in 1..=4 {
        let worst = worst_of_depth(depth, depth as u64, anywhere, accuracy);
        println!("worst SNR under noise, chains of {depth}: {worst:.1} dB");
        assert!(worst >= 90.0, "{worst}");
    }
}

#[test]
fn chains_whose_poles_nearly_coincide_keep_ninety_db_too() {
    for depth in 2..=4 {
        for nearness in [0.0, 1e-3, 1.0, 4.0] {
            let seed = 77 + depth as u64;
            let worst = worst_of_depth(depth, seed, |random, count| near(random, count, depth, nearness), accuracy);
            println!("worst SNR, chains of {depth} within {nearness} widths: {worst:.1} dB");
            // The zeros of four poles behind one another leave little of each section's output.
            let floor = if depth == 4 { 86.0 } else { 90.0 };
            assert!(worst >= floor, "{worst}");
        }
    }
}

/// The strike is half a sine of 1 ms, and then rings. Each chain's gain is 1 at its loudest place.
/// A bank of which the strike's spectrum reaches next to nothing loses what its sound is quieter.
#[test]
fn strikes_and_their_ringing_keep_what_the_page_says() {
    let force = |n: usize| if n < 48 { (n as f64 / 48.0 * std::f64::consts::PI).sin() } else { 0.0 };
    let input: Vec<i32> = (0..48_000).map(|n| (force(n) * FULL_SCALE) as i32).collect();
    for (depth, (worst_said, median_said)) in (1..=4).zip([(92.0, 126.0), (78.0, 117.0), (85.0, 114.0), (79.0, 110.0)])
    {
        let mut all = Vec::new();
        for seed in 1..=8 {
            let mut random = Random::new(seed);
            for _ in 0..20 {
                let (poles, zeros) = anywhere(&mut random, 8 * depth);
                let chains = Chains::bounded(&poles, &zeros, depth);
                let mut bank = bank(&chains.ours, depth, 32).unwrap();
                let mut out = vec![0; input.len()];
                let (struck, rings) = out.split_at_mut(48);
                bank.render(Some(&input[..48]), struck);
                bank.render(None, rings);
                all.push(snr_db(&chains.exact(&input), &out));
            }
        }
        all.sort_by(f64::total_cmp);
        let (worst, median) = (all[0], all[all.len() / 2]);
        println!("SNR of strikes, chains of {depth}: worst {worst:.1} dB, median {median:.1} dB");
        assert!(worst >= worst_said - 1.0 && median >= median_said - 1.0, "{worst} dB, median {median} dB");
    }
}

#[test]
fn poles_on_or_outside_the_circle_and_other_bad_tables_are_refused_by_name() {
    let biquad = |radius| Biquad::from_roots(Root::polar(radius, 0.3), Root::default(), 1.0);
    let load = |biquads: &[Biquad], depth| bank(biquads, depth, 2).map(|_| ());
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

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// Plays any sections, and inputs of any size with jumps and gaps. Bits are equal for any
    /// blocks, and the end is silent.
    #[test]
    fn blocks_change_no_bit_and_all_falls_silent(
        sections in prop::collection::vec((0.0f64..4.5, 0.0f64..3.1, -2.0f64..2.0, -2.0f64..2.0, -30.0f64..20.0), 4),
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
        let (Ok(mut whole), Ok(mut cut)) = (bank(&biquads, depth, 4), bank(&biquads, depth, 4)) else { return Ok(()) };
        let mut random = Random::new(seed);
        // Each level lasts for 50 frames. Level 31 is all of i32, level 0 is nothing.
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
