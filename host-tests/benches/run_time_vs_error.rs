//! scratch

use host_tests::on_chip::BankOnChip;
use host_tests::run_time::{chip::*, rivals, rows::Driven};
use host_tests::single_mode::*;
use dsp_core::SampleRate;
fn main() {
    let mut chip = BankOnChip::new().unwrap();
    let cases: Vec<Case> = (0..240).map(|i| Case { frequency_hz: 100.0 + 14.0 * f64::from(i), t60_s: 5.0, rate: SampleRate::HZ_48000, level: 0.001 }.exact()).collect();
    let show = |n: &str, m: Measured| { let k = m.mode_samples; println!("{n:45} best {:.2} nom {:.2} worst {:.2} flash {:.2} instr {:.2} loop {}", m.cost.best as f64/k, m.cost.nominal as f64/k, m.cost.worst as f64/k, m.cost.flash_168 as f64/k, m.cost.instructions as f64/k, m.loop_bytes) };
    for driven in [Driven::Free, Driven::Gain, Driven::GainAndPhase] {
        for block in [32, 16, 8] {
        let m = measure_bank(&mut chip, &BankUse { cases: &cases, driven, block }).unwrap();
        show(&format!("bank {driven:?} {block}"), m);
        }
        let m = measure_bookkeeping(&mut chip, &BankUse { cases: &cases, driven, block: 32 }).unwrap();
        show("tick", m);
    }
    for driven in [Driven::Free, Driven::Gain] {
    let r = Resonators { function: "float", words: cases[..64].iter().map(|c| vec![(c.frequency_hz as f32).to_bits(), (c.decay_per_s() as f32).to_bits(), 0.001f32.to_bits()]).collect(), force_word: |x| (x as f32).to_bits() };
    show(&format!("float {driven:?}"), r.measure(chip.machine(), driven, 32).unwrap());
    for rival in rivals::all() {
        let r = Resonators { function: rival.function, words: cases[..64].iter().map(|c| rival.words.of(c).to_vec()).collect(), force_word: rival.force_word };
        show(&format!("{} {driven:?}", rival.form), r.measure(chip.machine(), driven, 32).unwrap());
    }
    }
}
