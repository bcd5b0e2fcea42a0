//! The trigger on the virtual Cortex-M4F: strikes equal to the PC's, its cost, and no way to panic.
//! `cargo test -p host-tests --test on_chip trigger -- --nocapture` prints the cycles.

use dsp_core::SampleRate;
use dsp_core::trigger::{Report, Settings, Trigger};
use host_tests::trigger::on_chip::TriggerOnChip;
use host_tests::trigger::set::{CHANNELS, scenes};

#[test]
fn the_chip_finds_the_same_strikes_as_the_pc_bit_for_bit() {
    let scene = scenes(3, 1).into_iter().find(|scene| scene.name == "crosstalk at -20 dB").expect("a scene");
    let counts = scene.counts();
    let counts = &counts[..counts.len().min(72_000)];
    let pads = (0..CHANNELS as u8).map(Settings::of_unset_pad);
    let mut trigger = Trigger::<CHANNELS>::new(pads, SampleRate::HZ_48000).expect("the defaults are valid");
    let mut on_pc = Vec::new();
    trigger.process(counts, |report| {
        if let Report::Strike(strike) = report {
            on_pc.push((strike.frame, usize::from(strike.pad), f64::from(strike.velocity)));
        }
    });
    let mut chip = TriggerOnChip::new(false).unwrap();
    let mut on_chip = Vec::new();
    for block in counts.chunks(48) {
        let (found, _) = chip.process(block).unwrap();
        on_chip.extend(found.into_iter().map(|found| (found.frame, found.pad, found.velocity)));
    }
    assert!(on_pc.len() >= 3, "{} strikes", on_pc.len());
    assert_eq!(on_chip, on_pc);
}

#[test]
fn a_channel_costs_17_cycles_a_sample_in_silence_and_41_under_strikes() {
    let mut chip = TriggerOnChip::new(false).unwrap();
    // The figures are those of dsp-core/src/trigger/mod.rs, with a slack of 3 %.
    println!("state of {CHANNELS} channels: {} bytes", chip.state_bytes().unwrap());
    assert!(chip.state_bytes().unwrap() <= 920);
    let block = 32;
    // The trigger first learns offset, hum and noise.
    let silence = vec![[2048u16, 2047, 2049, 2050]; 4800];
    chip.process(&silence[..768]).unwrap();
    chip.process(&silence[..768]).unwrap();
    // The struck part is half a second of the crosstalk scene, loud and quiet.
    let scene = scenes(3, 1).into_iter().find(|scene| scene.name == "crosstalk at -20 dB").expect("a scene");
    let counts = scene.counts();
    for (what, counts, mean, limit) in
        [("silent", &silence[..], 17.0, 20.0), ("struck", &counts[9600..33_600], 41.0, 163.0)]
    {
        let mut worst = 0.0f64;
        let (mut sum, mut blocks) = (0.0, 0.0);
        for frames in counts.chunks_exact(block) {
            let (_, call) = chip.process(frames).unwrap();
            let per = call.cost.nominal as f64 / (block * CHANNELS) as f64;
            worst = worst.max(per);
            sum += per;
            blocks += 1.0;
        }
        println!("{what}: {:.1} cycles a channel and sample, worst block {worst:.1}", sum / blocks);
        assert!(worst <= 1.03 * limit && (sum / blocks - mean).abs() <= 0.03 * mean + 0.5, "{what}: {worst}");
    }
}

#[test]
fn direct_drive_costs_at_most_89_cycles_a_sample() {
    let mut chip = TriggerOnChip::new(true).unwrap();
    let (mut driven, mut silent) = (0, 0);
    for block in 0..200u32 {
        let counts: Vec<[u16; CHANNELS]> = (0..48)
            .map(|n| {
                let wave = if block > 100 && (n / 6) % 2 == 0 { 2448 } else { 2048 };
                [2048, 2048, 2048, wave]
            })
            .collect();
        chip.process(&counts).unwrap();
        let (_, call) = chip.force(47).unwrap();
        if block == 90 {
            silent = call.cost.nominal;
        }
        if block == 190 {
            driven = call.cost.nominal;
        }
    }
    let per = |cycles: u64| cycles as f64 / 47.0;
    println!("resampler: silent {:.1}, driven {:.1} cycles a sample", per(silent), per(driven));
    assert!(driven > silent);
    assert!(per(driven) <= 89.0);
}

#[test]
fn the_image_has_no_code_that_panics() {
    let chip = TriggerOnChip::new(true).unwrap();
    let names = chip.function_names();
    assert!(names.iter().any(|name| name == "trigger_process"));
    let panicking: Vec<_> = names.iter().filter(|name| name.contains("panic")).collect();
    assert!(panicking.is_empty(), "{panicking:?}");
}
