//! The dynamic filter and waveguides on the virtual core: the bits of the PC, and their cycles.

use dsp_core::SampleRate;
use dsp_core::dynamic_filter::{Breakpoint, DynamicFilter, Path};
use dsp_core::waveguide::{Band, Waveguides};
use host_tests::on_chip::FiltersOnChip;

fn path(b1: f64) -> [Breakpoint; 3] {
    let point = |time_s, b0: f64, a1| Breakpoint { time_s, b0, b1: b1 * b0, a1 };
    [point(0.0, 0.25, -0.3), point(0.11, 0.1, -0.7), point(0.53, 0.02, -0.9)]
}

#[test]
fn the_chip_has_the_bits_of_the_pc() {
    let rate = SampleRate::HZ_48000;
    let bands = [200.0, 1500.0, 6000.0].map(|frequency_hz| Band { frequency_hz, bandwidth_hz: 4.0, gain: 0.3 });
    let mut chip = FiltersOnChip::new().unwrap();
    for b1 in [1.0, 0.4] {
        let path = path(b1);
        chip.load_filter(&path, &bands).unwrap();
        let mut filter = DynamicFilter::<16>::new(Path::new(&path, rate).unwrap(), 9, 9);
        let mut guides = Waveguides::<16, 10, 2048>::new(filter.clone(), &path, &path[2], &bands, rate).unwrap();
        for strike in 0..4 {
            filter.strike(1.0);
            guides.strike(1.0);
            chip.strike(false).unwrap();
            chip.strike(true).unwrap();
            for frames in [32, 1, 77, 4000, 16].into_iter().skip(strike) {
                let (mut of_filter, mut of_guides) = (vec![0; frames], vec![0; frames]);
                filter.render(None, &mut of_filter);
                guides.render(&mut of_guides);
                assert_eq!(chip.render(false, frames).unwrap().0, of_filter);
                assert_eq!(chip.render(true, frames).unwrap().0, of_guides);
            }
        }
    }
}

#[test]
fn filter_and_loops_keep_their_cycles_and_cost_nothing_at_rest() {
    let mut chip = FiltersOnChip::new().unwrap();
    let band = |n: usize| Band { frequency_hz: 150.0 + 700.0 * n as f64, bandwidth_hz: 4.0, gain: 0.3 };
    let mut costs = Vec::new();
    for (what, b1, bands, guides) in [
        ("eq. 17 with noise", 1.0, 0, false),
        ("with b1", 0.4, 0, false),
        ("no loops", 1.0, 0, true),
        ("10 loops", 1.0, 10, true),
    ] {
        let bands: Vec<Band> = (0..bands).map(band).collect();
        chip.load_filter(&path(b1), &bands).unwrap();
        let at_rest = chip.render(guides, 512).unwrap().1.nominal as f64 / 512.0;
        chip.strike(guides).unwrap();
        chip.render(guides, 512).unwrap();
        let cost = chip.render(guides, 512).unwrap().1.nominal as f64 / 512.0;
        println!("{what}: {cost:.1} cycles a frame, {at_rest:.1} at rest");
        costs.push(cost);
        assert!(guides || at_rest <= 1.0, "{at_rest}");
    }
    // The goals are 20 for the filter and 16 a loop: this is plain Rust, without assembly yet.
    println!("a loop: {:.1} cycles", (costs[3] - costs[2]) / 10.0);
    assert!(costs[0] <= 110.0 && costs[1] <= 120.0, "{costs:?}");
}
