//! d
use host_tests::on_chip::{EngineOnChip, scenes};
#[test]
fn dbg() {
    let mut chip = EngineOnChip::new().unwrap();
    println!("{:?}", chip.footprint().unwrap());
    for count in [0,4, 8] {
        let kit = scenes::pads(count.max(1));
        let free = scenes::measure(&mut chip, &kit.binary, &scenes::strikes(count, 5, 0.8), None, (64, 65)).unwrap();
        chip.machine().clear_counts();
        let free = scenes::measure(&mut chip, &kit.binary, &scenes::strikes(count, 5, 0.8), None, (64, 192)).unwrap();
        let f = free.ticks as f64*32.;
        println!("{count} pads: per frame {:.1} with flash {:.1} share168 {:.4} share96 {:.4} dearest {} stack {}", free.total.nominal as f64/f, free.total.flash_168 as f64/f, free.total.nominal as f64/f/3500., free.total.nominal as f64/f/2000., free.dearest_tick.nominal, free.stack_bytes);
        // profile from a further run
        chip.machine().clear_counts();
        for _ in 0..16 { chip.render(&[], None, 32).unwrap(); }
        let total: u64 = chip.machine().profile().iter().map(|p| p.cost.nominal).sum();
        println!("  per tick {}", total/16);
        for l in chip.machine().profile().iter().take(22) { println!("   {} {} ({} ins)", l.name, l.cost.nominal/16, l.cost.instructions/16); }
    }
}
