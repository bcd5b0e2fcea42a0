use host_tests::on_chip::BankOnChip;
#[test]
fn dbg() {
    let mut chip = BankOnChip::new().unwrap();
    for (hz, cosine) in [(500.0f32,0.0f32),(500.0,1.0),(4600.0,0.0),(6700.,0.),(10000.,1.0),(14000.,0.)] {
    let n=510;
    let modes:Vec<_>=(0..n).map(|i|dsp_core::table::layout::ModeRecord{frequency_hz:(hz+i as f32).into(),decay_per_s:2.0.into()}).collect();
    let gains:Vec<_>=(0..n).map(|_|dsp_core::table::layout::GainRecord{sine:3.0e7.into(),cosine:(cosine*1e7).into()}).collect();
    chip.load(&modes,&gains,48000).unwrap();
    chip.tick(true).unwrap();
    let f:Vec<i32>=(0..32).map(|i|1000+i*10).collect();
    chip.render(Some(&f), 32).unwrap();
    let per=|c:virtual_core::Cost| format!("ins {:.3} best {:.3} nom {:.3} worst {:.3} flash {:.3}", c.instructions as f64/n as f64/32., c.best as f64/n as f64/32.,c.nominal as f64/n as f64/32.,c.worst as f64/n as f64/32.,c.flash_168 as f64/n as f64/32.);
    chip.machine().clear_counts(); let t=chip.tick(true).unwrap().1; 
    println!("{hz} {cosine} driven tick {}", per(t)); for l in chip.machine().profile().iter().take(8) { println!("   {} {}", l.name, l.cost.nominal); }
    chip.machine().clear_counts();
    println!("driven {}", per(chip.render(Some(&f),32).unwrap().1));
    for l in chip.machine().loops().iter().take(3) { println!("   {l:x?}"); }
    for l in chip.machine().profile().iter().take(5) { println!("   {} {}", l.name, l.cost.nominal); }
    chip.tick(true).unwrap(); chip.tick(true).unwrap(); chip.render(None,32).unwrap();chip.machine().clear_counts();
    let mut tick=virtual_core::Cost::default(); for _ in 0..32 { tick+=chip.tick(true).unwrap().1; }
    for l in chip.machine().profile().iter().take(8) { println!("   {} {}", l.name, l.cost.nominal); }    chip.machine().clear_counts();
    println!("free {}", per(chip.render(None,32).unwrap().1));
    for l in chip.machine().loops().iter().take(3) { println!("   {l:x?}"); }
    for l in chip.machine().profile().iter().take(5) { println!("   {} {}", l.name, l.cost.nominal); }
    println!("32 free ticks {}", per(tick));
    println!("cut 16 {}", per(chip.render(None,16).unwrap().1));
    }
}
