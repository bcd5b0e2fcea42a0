//! Scraping and rolling on the virtual Cortex-M4F: the PC's bits, its cost, and no way to panic.
//! `cargo test -p host-tests --test on_chip scrape -- --nocapture` prints the cycles.

use dsp_core::scrape::{Motion, Scraper};
use dsp_core::time::TICK_FRAMES;
use host_tests::scrape::map::Waves;
use host_tests::scrape::on_chip::ScraperOnChip;
use host_tests::scrape::{RATE, Scrapes};

/// Cycles a frame of contacts at a speed: the mean and the dearest tick.
fn cycles(scrapes: &Scrapes, striker: &str, rolls: bool, velocity_m_per_s: [f32; 2]) -> [f64; 2] {
    let (kit, number) = scrapes.alone("mug", striker);
    let mut chip = ScraperOnChip::new(&kit, (0, number, rolls), [0.0, 1.0]).unwrap();
    let (mut sum, mut worst) = (0.0, 0.0_f64);
    for tick in 0..320 {
        let normal_n = 0.5 + 0.3 * (tick as f32 * 0.1).sin();
        let (_, call) = chip.render(Motion { velocity_m_per_s, normal_n }).unwrap();
        let frame = call.cost.nominal as f64 / TICK_FRAMES as f64;
        // The first ticks fill the caches and the history.
        if tick >= 20 {
            sum += frame;
            worst = worst.max(frame);
        }
    }
    // The parts of docs/scraping.md: by function, each without those that it calls. The kit's check
    // comes before the first tick.
    let parts = chip.machine().profile();
    let parts = parts.iter().filter(|part| part.name.contains("scrape") && !part.name.contains("Powers::new"));
    for part in parts.take(8) {
        println!("  {}: {:.1}", part.name, part.cost.nominal as f64 / (320 * TICK_FRAMES) as f64);
    }
    [sum / 300.0, worst]
}

#[test]
fn chip_makes_the_force_of_the_pc_bit_for_bit() {
    let scrapes = Scrapes::with_map("pan", Waves::new().surface("waves"));
    let contacts = [
        ("mug", "stick", false),
        ("marimba", "stick", false),
        ("glass", "ball", true),
        ("pan", "stick", false),
        ("pan", "ball", true),
    ];
    for (pad, striker, rolls) in contacts {
        let (kit, number) = scrapes.alone(pad, striker);
        let mut chip = ScraperOnChip::new(&kit, (0, number, rolls), [0.1, 1.0]).unwrap();
        let contact = dsp_core::scrape::Contact { seed: 0, ..scrapes.contact(pad, striker, rolls, [0.1, 1.0]) };
        let mut scraper = Scraper::new(contact, RATE);
        for tick in 0..400 {
            let angle = tick as f32 * 0.02;
            let velocity_m_per_s = [1.5 * angle.sin(), 0.3 * (2.0 * angle).cos()];
            let normal_n = if tick % 100 > 90 { 0.0 } else { 0.5 + 0.4 * angle.cos() };
            let motion = Motion { velocity_m_per_s, normal_n };
            let mut frames = [0; TICK_FRAMES];
            scraper.render(motion, &mut frames).expect("a possible motion");
            assert_eq!(chip.render(motion).unwrap().0, frames, "{pad}, tick {tick}");
        }
    }
}

#[test]
fn frame_costs_what_docs_scraping_says() {
    let scrapes = Scrapes::new();
    // Striker, whether it rolls, speed in m/s, cycles a frame on average and at most.
    for (striker, rolls, speed, mean, worst) in [
        ("stick", false, 0.2, 165.0, 310.0),
        ("stick", false, 0.9, 221.0, 393.0),
        ("stick", false, 2.0, 237.0, 442.0),
        ("ball", true, 0.2, 270.0, 405.0),
    ] {
        let [found, dearest] = cycles(&scrapes, striker, rolls, [speed, 0.0]);
        println!("{striker} at {speed} m/s: {found:.0} cycles a frame, at most {dearest:.0}");
        assert!((found - mean).abs() < 0.03 * mean && dearest < 1.03 * worst, "{striker} at {speed} m/s");
    }
    let map = Scrapes::with_map("mug", Waves::new().surface("waves"));
    for (speed, mean, worst) in [(0.2, 347.0, 596.0), (0.35, 528.0, 864.0)] {
        let [found, dearest] = cycles(&map, "stick", false, [0.8 * speed, 0.6 * speed]);
        println!("stick on a map at {speed} m/s: {found:.0} cycles a frame, at most {dearest:.0}");
        assert!((found - mean).abs() < 0.03 * mean && dearest < 1.03 * worst, "map at {speed} m/s");
    }
    let [rest, _] = cycles(&scrapes, "stick", false, [0.0; 2]);
    println!("at rest: {rest:.1} cycles a frame");
    assert!(rest < 8.0);
}

#[test]
fn chip_has_no_way_to_panic_while_it_scrapes() {
    let scrapes = Scrapes::new();
    let (kit, number) = scrapes.alone("mug", "stick");
    let chip = ScraperOnChip::new(&kit, (0, number, false), [0.0, 1.0]).unwrap();
    let names = chip.function_names();
    let panicking: Vec<_> = names.iter().filter(|name| name.contains("panic")).collect();
    assert!(panicking.is_empty(), "{panicking:?}");
}
