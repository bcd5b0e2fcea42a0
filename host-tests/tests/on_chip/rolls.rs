//! The whole engine with every stage: bits equal on PC and chip.

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::table::Kit;
use host_tests::lent;
use host_tests::on_chip::EngineOnChip;
use host_tests::rolls::{Hands, kit};

const RATE: SampleRate = SampleRate::HZ_48000;

#[test]
fn a_roll_on_every_stage_has_the_same_bits_on_the_chip() {
    let loaded = kit();
    let mut chip = EngineOnChip::new().unwrap();
    chip.load(&loaded.binary, RATE).unwrap();
    let view = Kit::parse(&loaded.binary).unwrap();
    let mut engine = lent::engine(&view, RATE, Skipping::On).unwrap();
    let mut hands = Hands::new();
    let (mut loud, mut blocks) = (0, [32, 32, 17, 1, 64, 128, 3, 75].into_iter().cycle());
    // A quarter of a second has strikes and hands, another quarter only rings.
    while engine.now() < 24_000 {
        let frames = blocks.next().unwrap_or(32);
        let events = hands.until((engine.now() + frames as u64).min(12_000));
        let mut expected = vec![[0; 2]; frames];
        let at = engine.now();
        engine.render(&events, None, &mut expected).unwrap();
        let (got, _) = chip.render(&events, None, frames).unwrap();
        assert!(got == expected, "frames {at} to {}", engine.now());
        loud += expected.as_flattened().iter().filter(|sample| sample.abs() > 1 << 16).count();
    }
    assert!(loud > 24_000, "{loud} samples above -42 dBFS");
}
