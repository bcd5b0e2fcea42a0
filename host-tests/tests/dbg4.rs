//! d
use host_tests::on_chip::{EngineOnChip, scenes};
use dsp_core::SampleRate;
#[test]
fn dbg() {
    let mut chip = EngineOnChip::new().unwrap();
    for (budget, pads) in [(0u32,8usize),(u32::MAX,8), (89600,16), (89600, 8)] {
        let kit = scenes::pads(pads);
        chip.load(&kit.binary, SampleRate::HZ_48000).unwrap();
        chip.set_budget(budget).unwrap();
        chip.machine().clear_counts();
        let (_, call) = chip.render(&scenes::strikes(pads, 0, 1.0), None, 32).unwrap();
        println!("budget {budget} pads {pads}: strike tick {}", call.cost.nominal);
        for l in chip.machine().profile().iter().take(22) { println!("   {} {} ({} ins)", l.name, l.cost.nominal, l.cost.instructions); }
        for _ in 0..8 { chip.render(&[], None, 32).unwrap(); }
        chip.machine().clear_counts();
        let (_, call) = chip.render(&[], None, 32).unwrap();
        println!("  free tick {} told {:?}", call.cost.nominal, chip.told().unwrap().predicted_cycles);
        for l in chip.machine().profile().iter().take(12) { println!("   {} {} ({} ins)", l.name, l.cost.nominal, l.cost.instructions); }
    }
}
