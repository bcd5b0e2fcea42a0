//! Biquads on the virtual core: bits equal to the PC's, and their cycles.

use dsp_core::biquad::{Biquad, Root, TickKind};
use float_forms::biquads::FloatBank;
use host_tests::biquads::bank;
use host_tests::on_chip::BiquadsOnChip;
use host_tests::snr::Random;

fn biquads(count: usize, random: &mut Random) -> Vec<Biquad> {
    let mut biquad = || {
        let radius = 1.0 - 10f64.powf(-random.between(0.1, 5.0));
        let angle = random.between(0.001, 3.1);
        Biquad::from_roots(Root::polar(radius, angle), Root::polar(random.between(0.0, 0.9), angle * 0.7), 1.0 - radius)
    };
    (0..count).map(|_| biquad()).collect()
}

#[test]
fn the_chip_has_the_bits_of_the_pc_in_blocks_of_any_size() {
    let mut chip = BiquadsOnChip::new().unwrap();
    let mut random = Random::new(5);
    for (depth, coincident) in [(1, false), (2, false), (3, false), (4, false), (2, true), (3, true), (4, true)] {
        let mut all = biquads(12, &mut random);
        if coincident {
            // The poles of each chain are equal, so that its sections cannot be parted.
            for at in 0..12 {
                all[at].pole = all[at / depth * depth].pole;
            }
        }
        chip.load(&all, depth).unwrap();
        let mut bank = bank(&all, depth, 64).unwrap();
        for block in 0..60 {
            let frames = [32, 1, 7, 48, 256, 16, 33][block % 7];
            let level = [0.0, 28.0, 24.0, 10.0, 30.0, 1.0][block % 6];
            let input: Vec<i32> = (0..frames).map(|_| (random.between(-1.0, 1.0) * f64::exp2(level)) as i32).collect();
            let input = (block % 11 != 3).then_some(&input[..]);
            let mut expected = vec![0; frames];
            bank.render(input, &mut expected);
            let (got, _) = chip.render(input, frames).unwrap();
            assert_eq!(got, expected, "depth {depth}, block {block}");
        }
    }
}

#[test]
fn the_chip_has_the_bits_of_the_pc_in_single_precision_too() {
    let mut chip = BiquadsOnChip::new().unwrap();
    let mut random = Random::new(6);
    for (depth, coincident) in [(1, false), (2, false), (4, false), (2, true)] {
        let mut all = biquads(20, &mut random);
        if coincident {
            for at in (0..20).step_by(2) {
                all[at + 1].pole = all[at].pole;
            }
        }
        chip.load_float(&all, depth).unwrap();
        let mut bank = FloatBank::<20>::EMPTY;
        bank.load(&all, depth).unwrap();
        for block in 0..60 {
            let frames = [32, 1, 7, 48, 256, 16, 33][block % 7];
            let level = [0.0, 1.0, 0.1, 1e-4, 8.0, 1e-7][block % 6];
            let input: Vec<f32> = (0..frames).map(|_| (random.between(-1.0, 1.0) * level) as f32).collect();
            let input = (block % 11 != 3).then_some(&input[..]);
            let mut expected = vec![0.0; frames];
            bank.render(input, &mut expected);
            let (got, _) = chip.render_float(input, frames).unwrap();
            let bits = |out: &[f32]| out.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&got), bits(&expected), "depth {depth}, block {block}");
        }
    }
}

#[test]
fn a_biquad_in_single_precision_keeps_its_cycles() {
    let mut chip = BiquadsOnChip::new().unwrap();
    let mut random = Random::new(8);
    let noise: Vec<f32> = (0..4096).map(|_| random.between(-0.5, 0.5) as f32).collect();
    for (count, depth) in [(64, 1), (64, 2), (64, 4), (32, 2), (16, 1), (16, 4)] {
        chip.load_float(&modes(count, &mut random), depth).unwrap();
        let (_, at_rest) = chip.render_float(None, 256).unwrap();
        let (_, driven) = chip.render_float(Some(&noise), 4096).unwrap();
        let (_, free) = chip.render_float(None, 1024).unwrap();
        let per = |cycles: u64, frames: usize| cycles as f64 / (frames * count) as f64;
        let (driven, free) = (per(driven.nominal, 4096), per(free.nominal, 1024));
        println!(
            "f32, {count} biquads in chains of {depth}: driven {driven:.2} cycles a biquad and frame, free {free:.2}; at rest {} a block",
            at_rest.nominal
        );
        assert!(at_rest.nominal <= 80, "{}", at_rest.nominal);
        assert!(driven <= if count == 64 { 11.0 } else { 13.0 }, "{driven}");
    }
}

/// Biquads of typical modes: radii of T60 20 ms to 10 s, angles of 50 Hz to 18 kHz.
fn modes(count: usize, random: &mut Random) -> Vec<Biquad> {
    let mut biquad = || {
        let radius = (-6.9 / (48_000.0 * 10f64.powf(random.between(-1.7, 1.0)))).exp();
        let angle = 50.0 * 360f64.powf(random.between(0.0, 1.0)) * std::f64::consts::TAU / 48_000.0;
        let zero = Root::polar(random.between(0.0, 0.9), angle * 0.7);
        Biquad::from_roots(Root::polar(radius, angle), zero, 1.0 - radius)
    };
    (0..count).map(|_| biquad()).collect()
}

#[test]
fn a_biquad_keeps_its_cycles_and_one_at_rest_costs_nothing() {
    let mut chip = BiquadsOnChip::new().unwrap();
    let mut random = Random::new(7);
    let noise: Vec<i32> = (0..4096).map(|_| (random.between(-0.5, 0.5) * f64::exp2(27.0)) as i32).collect();
    // The pulse is half a sine of 2 ms, like that of a contact.
    let pulse: Vec<i32> =
        (0..96).map(|n| ((f64::from(n) / 96.0 * std::f64::consts::PI).sin() * f64::exp2(27.0)) as i32).collect();
    for (count, depth) in [(64, 1), (64, 2), (64, 4), (32, 2), (16, 1), (16, 2), (16, 4)] {
        let all = modes(count, &mut random);
        let loading = chip.load(&all, depth).unwrap();
        let (_, at_rest) = chip.render(None, 256).unwrap();
        let mut dearest = 0;
        for tick in pulse.chunks(32) {
            let (_, cost) = chip.render(Some(tick), 32).unwrap();
            dearest = dearest.max(cost.nominal);
        }
        let (_, free) = chip.render(None, 1024).unwrap();
        chip.render(Some(&noise), 4096).unwrap();
        let (_, driven) = chip.render(Some(&noise), 4096).unwrap();
        let per = |cycles: u64, frames: usize| cycles as f64 / (frames * count) as f64;
        println!(
            "{count} biquads in chains of {depth}: driven {:.2} cycles a biquad and frame, free {:.2}, dearest tick of a strike {:.2}; \
             at rest {} a block; loading {}",
            per(driven.nominal, 4096),
            per(free.nominal, 1024),
            per(dearest, 32),
            at_rest.nominal,
            loading.nominal
        );
        let mut bank = bank(&all, depth, 64).unwrap();
        assert_eq!(bank.cycles(TickKind::Free), 0, "at rest");
        bank.render(Some(&pulse), &mut [0; 96]);
        for (kind, cycles) in
            [(TickKind::Struck, dearest), (TickKind::Driven, driven.nominal / 128), (TickKind::Free, free.nominal / 32)]
        {
            assert!(cycles <= u64::from(bank.cycles(kind)), "{kind:?}: {cycles}, reckoned {}", bank.cycles(kind));
        }
        assert!(at_rest.nominal <= 80, "{}", at_rest.nominal);
        assert!(per(driven.nominal, 4096) <= if count >= 32 { 11.0 } else { 13.0 }, "{}", per(driven.nominal, 4096));
    }
}
