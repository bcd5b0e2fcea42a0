//! d
use host_tests::on_chip::{EngineOnChip, budget_scenes};
use dsp_core::SampleRate;
#[test]
fn dbg() {
    let mut chip = EngineOnChip::new().unwrap();
    let s = budget_scenes::storm_scene(4);
    chip.load(&s.kit, SampleRate::HZ_48000).unwrap();
    chip.set_budget(89600).unwrap();
    for t in 0..9 {
        chip.machine().clear_counts();
        let (ev, _) = s.tick(t);
        let (_, call) = chip.render(&ev, None, 32).unwrap();
        let told = chip.told().unwrap();
        println!("tick {t} {} told {:?} shed {} stack {}", call.cost.nominal, told.predicted_cycles, told.shed_groups, call.stack_bytes);
        if t==0||t==7 { for l in chip.machine().profile().iter().take(29) { println!("   {} {} ({} ins)", l.name, l.cost.nominal, l.cost.instructions); } }
    }
}
