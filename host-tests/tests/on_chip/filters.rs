//! The dynamic filter and its loops on the virtual core: the bits of the PC, and their cycles.

use dsp_core::SampleRate;
use dsp_core::dynamic_filter::{Breakpoint, DynamicFilter, Settings};
use dsp_core::waveguide::Loop;
use host_tests::on_chip::FiltersOnChip;

fn path(b1: f64) -> [Breakpoint; 3] {
    let point = |time_s, b0: f64, a1| Breakpoint { time_s, a1, a2: 0.0, b0, b1: b1 * b0, b2: 0.0 };
    [point(0.0, 0.25, -0.3), point(0.11, 0.1, -0.7), point(0.53, 0.02, -0.9)]
}

fn loops(count: usize) -> Vec<Loop> {
    let one = |n| Loop {
        frequency_hz: 150.0 + 700.0 * f64::from(n),
        bandwidth_hz: 4.0,
        gain: 0.3,
        delay_s: (34.3 + f64::from(n)) / 48_000.0,
    };
    (0..count as u32).map(one).collect()
}

#[test]
fn the_chip_has_the_bits_of_the_pc() {
    let mut chip = FiltersOnChip::new().unwrap();
    for (b1, loops) in [(1.0, loops(0)), (0.4, loops(0)), (1.0, loops(3)), (0.4, loops(7))] {
        let path = path(b1);
        chip.load_filter(1, &path, &loops, None).unwrap();
        let mut filter = Box::new(DynamicFilter::<16, 10, 2048>::EMPTY);
        let settings = Settings {
            seed: 9,
            rate_hz: 48_000.0,
            order: 1,
            modes_through: false,
            exciter: None,
            path: path.iter().copied(),
            loops: loops.iter().copied(),
        };
        filter.load(settings, SampleRate::HZ_48000, 9).unwrap();
        for strike in 0..4 {
            filter.strike(1.0);
            chip.strike(1.0).unwrap();
            for frames in [32, 1, 77, 4000, 16].into_iter().skip(strike) {
                let mut expected = vec![0; frames];
                filter.render(None, &mut expected);
                assert_eq!(chip.render(None, frames).unwrap().0, expected);
            }
        }
    }
}

#[test]
fn filter_and_loops_keep_their_cycles_and_cost_nothing_at_rest() {
    let mut chip = FiltersOnChip::new().unwrap();
    let mut costs = Vec::new();
    for (what, b1, count) in
        [("eq. 17 with noise", 1.0, 0), ("with b1", 0.4, 0), ("1 loop", 1.0, 1), ("10 loops", 1.0, 10)]
    {
        chip.load_filter(1, &path(b1), &loops(count), None).unwrap();
        let at_rest = chip.render(None, 512).unwrap().1.nominal as f64 / 512.0;
        chip.strike(1.0).unwrap();
        chip.render(None, 512).unwrap();
        let cost = chip.render(None, 512).unwrap().1.nominal as f64 / 512.0;
        println!("{what}: {cost:.1} cycles a frame, {at_rest:.1} at rest");
        costs.push(cost);
    }
    println!("a loop: {:.1} cycles", (costs[3] - costs[2]) / 9.0);
    assert!(costs[0] <= 110.0 && costs[1] <= 120.0, "{costs:?}");
}
