//! d
use host_tests::on_chip::{EngineOnChip, scenes};
use dsp_core::SampleRate;
#[test]
fn dbg() {
    let mut chip = EngineOnChip::new().unwrap();
    for (budget, pads) in [(u32::MAX,8), (89600, 8)] {
        let kit = scenes::pads_of(pads, 2);
        chip.load(&kit.binary, SampleRate::HZ_48000).unwrap();
        chip.set_budget(budget).unwrap();
        chip.machine().clear_counts();
        let (_, call) = chip.render(&scenes::strikes(pads, 0, 1.0), None, 32).unwrap();
        println!("budget {budget} pads {pads}: strike tick {} told {:?}", call.cost.nominal, chip.told().unwrap());
        for l in chip.machine().profile().iter().take(22) { println!("   {} {} ({} ins)", l.name, l.cost.nominal, l.cost.instructions); }
        for _ in 0..3 {
        chip.machine().clear_counts();
        let (_, call) = chip.render(&[], None, 32).unwrap();
        println!("  free tick {} told {:?}", call.cost.nominal, chip.told().unwrap().predicted_cycles);
        for l in chip.machine().profile().iter().take(9) { println!("   {} {} ({} ins)", l.name, l.cost.nominal, l.cost.instructions); }
        }
    }
}
