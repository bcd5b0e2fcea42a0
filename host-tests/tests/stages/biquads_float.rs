//! The bank of biquads in single precision against `f64`: accuracy, any block size, and silence in
//! the end.

use dsp_core::biquad::{Biquad, BiquadError, Root};
use float_forms::biquads::FloatBank;
use host_tests::biquads::{Chains, FULL_SCALE, anywhere, near, worst_of_depth};
use proptest::prelude::*;

fn bank(biquads: &[Biquad], depth: usize) -> Result<FloatBank<16>, BiquadError> {
    let mut bank = FloatBank::EMPTY;
    bank.load(biquads, depth).map(|()| bank)
}

/// SNR in dB of a bank against `f64` over an input.
fn accuracy(chains: &Chains, input: &[i32]) -> f64 {
    let mut bank = bank(&chains.ours, chains.depth).unwrap();
    let x: Vec<f32> = input.iter().map(|&x| (f64::from(x) / FULL_SCALE) as f32).collect();
    let mut out = vec![0.0; x.len()];
    bank.render(Some(&x), &mut out);
    let exact = chains.exact(input);
    let signal: f64 = exact.iter().map(|y| y * y).sum();
    let error: f64 = exact.iter().zip(&out).map(|(y, &got)| (y - f64::from(got) * FULL_SCALE).powi(2)).sum();
    10.0 * (signal / error).log10()
}

#[test]
fn chains_of_every_depth_keep_fifty_db_over_all_poles_and_zeros() {
    for depth in 1..=4 {
        let worst = worst_of_depth(depth, depth as u64, anywhere, accuracy);
        println!("worst SNR of f32 under noise, chains of {depth}: {worst:.1} dB");
        assert!(worst >= 50.0, "{worst}");
    }
}

#[test]
fn chains_whose_poles_nearly_coincide_keep_fifty_db_too() {
    for depth in 2..=4 {
        for nearness in [0.0, 1e-3, 1.0] {
            let seed = 77 + depth as u64;
            let worst = worst_of_depth(depth, seed, |random, count| near(random, count, depth, nearness), accuracy);
            println!("worst SNR of f32, chains of {depth} within {nearness} widths: {worst:.1} dB");
            assert!(worst >= 50.0, "{worst}");
        }
    }
}

#[test]
fn bad_tables_are_refused_by_name() {
    let at = |radius| Biquad::from_roots(Root::polar(radius, 0.3), Root::default(), 1.0);
    assert!(matches!(bank(&[at(0.5), at(1.0)], 1), Err(BiquadError::UnstablePole { biquad: 1, .. })));
    let nan = Biquad { numerator: [f64::NAN, 0.0, 0.0], ..at(0.5) };
    assert!(matches!(bank(&[nan], 1), Err(BiquadError::NotFinite { biquad: 0 })));
    assert!(matches!(bank(&[at(0.5); 3], 2), Err(BiquadError::Depth { .. })));
    assert!(matches!(bank(&[at(0.5); 80], 1), Err(BiquadError::Full { sections: 80, room: 16 })));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    /// Plays any sections, and inputs with jumps and gaps. The sound is finite, its bits are equal
    /// for any blocks, and the end is silent.
    #[test]
    fn blocks_change_no_bit_and_all_falls_silent(
        sections in prop::collection::vec((0.0f64..4.5, 0.0f64..3.1, -2.0f64..2.0, -2.0f64..2.0, -30.0f64..20.0), 4),
        depth in prop::sample::select(vec![1usize, 2, 4]),
        input in prop::collection::vec(-4.0f32..4.0, 1..900),
        blocks in prop::collection::vec(1usize..100, 1..30),
    ) {
        let section = |&(near, angle, real, imaginary, gain_bits): &(f64, f64, f64, f64, f64)| {
            let pole = Root::polar(1.0 - 10f64.powf(-near), angle);
            Biquad::from_roots(pole, Root { real, imaginary }, gain_bits.exp2())
        };
        let biquads: Vec<Biquad> = sections.iter().map(section).collect();
        let mut whole = bank(&biquads, depth).unwrap();
        let mut cut = whole.clone();
        let mut expected = vec![0.0; input.len()];
        whole.render(Some(&input), &mut expected);
        prop_assert!(expected.iter().all(|x| x.is_finite()));
        let mut got = vec![0.0; input.len()];
        let (mut at, mut block) = (0, blocks.iter().cycle());
        while at < input.len() {
            let end = (at + block.next().unwrap()).min(input.len());
            cut.render(Some(&input[at..end]), &mut got[at..end]);
            at = end;
        }
        let bits = |out: &[f32]| out.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(&got), bits(&expected));
        let mut tail = vec![0.0; 48_000];
        for _ in 0..120 {
            if !whole.is_ringing() {
                break;
            }
            whole.render(None, &mut tail);
        }
        prop_assert!(!whole.is_ringing());
        tail.fill(0.0);
        whole.render(None, &mut tail);
        prop_assert!(tail.iter().all(|&x| x == 0.0));
    }
}
