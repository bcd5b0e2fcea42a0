//! How well strikes are found in the generated set. `cargo test -p host-tests --test trigger_quality -- --nocapture` prints the table.

use dsp_core::SampleRate;
use dsp_core::trigger::{Report, Settings, Trigger};
use host_tests::trigger::set::{CHANNELS, KINDS, scenes};
use host_tests::trigger::{Found, Scene, Score, score};

fn find(scene: &Scene<CHANNELS>) -> Vec<Found> {
    let pads = (0..CHANNELS as u8).map(Settings::of_unset_pad);
    let mut trigger = Trigger::<CHANNELS>::new(pads, SampleRate::HZ_48000).expect("the defaults are valid");
    let mut found = Vec::new();
    for block in scene.counts().chunks(48) {
        trigger.process(block, |report| {
            if let Report::Strike(strike) = report {
                found.push(Found { frame: strike.frame, pad: strike.pad.into(), velocity: strike.velocity.into() });
            }
        });
    }
    found
}

fn print_row(name: &str, score: &Score) {
    let (least, most) = score.latency_ms();
    println!(
        "| {name} | {} | {:.1} | {:.1} | {:.1} | {least:.2} to {most:.2} |",
        score.played,
        score.found_percent(),
        score.false_percent(),
        score.within_1_db_percent(),
    );
}

#[test]
fn strikes_are_found_once_and_with_their_velocity() {
    println!("| scene | strikes | found % | false or double % | within 1 dB % | decided after ms |");
    println!("| --- | --- | --- | --- | --- | --- |");
    let mut all = Score::default();
    let set = scenes(std::env::var("SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(1), 8);
    for kind in KINDS {
        let mut of_kind = Score::default();
        for scene in set.iter().filter(|scene| scene.name == kind) {
            of_kind.add(&score(&scene.strikes, &find(scene)));
        }
        print_row(kind, &of_kind);
        all.add(&of_kind);
    }
    print_row("all", &all);
    assert!(all.played >= 500);
    assert!(all.found_percent() >= 99.0);
    assert!(all.false_percent() <= 0.5);
    assert!(all.within_1_db_percent() >= 95.0);
}
