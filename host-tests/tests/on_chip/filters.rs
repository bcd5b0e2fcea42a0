//! The dynamic filter and its loops on the virtual core: bits equal to the PC's, and their cycles.

use dsp_core::SampleRate;
use dsp_core::dynamic_filter::{Breakpoint, Exciter, Settings};
use dsp_core::waveguide::Loop;
use host_tests::dynamic_filter::{Ours, lent_filter};
use host_tests::on_chip::FiltersOnChip;
use host_tests::snr::Random;

fn path(b1: f64) -> [Breakpoint; 3] {
    let point = |time_s, b0: f64, a1| Breakpoint { time_s, a1, b0, b1: b1 * b0, ..Breakpoint::default() };
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

fn settings(
    order: u8,
    path: &[Breakpoint],
    loops: &[Loop],
    exciter: Option<Exciter>,
) -> Settings<impl Iterator<Item = Breakpoint> + Clone, impl Iterator<Item = Loop> + Clone> {
    Settings {
        seed: 9,
        rate_hz: 48_000.0,
        order,
        modes_through: false,
        exciter,
        path: path.iter().copied(),
        loops: loops.iter().copied(),
    }
}

/// Dynamic filter on the PC.
fn ours<P: Iterator<Item = Breakpoint> + Clone, L: Iterator<Item = Loop> + Clone>(settings: Settings<P, L>) -> Ours {
    let mut filter = lent_filter(&settings, SampleRate::HZ_48000).unwrap();
    filter.load(settings, SampleRate::HZ_48000, 9).unwrap();
    filter
}

#[test]
fn the_chip_has_the_bits_of_the_pc() {
    let mut chip = FiltersOnChip::new().unwrap();
    let (mut random, mut played) = (Random::new(5), 0);
    let band = Some(Exciter { low_hz: 80.0, high_hz: 5000.0, exponent: 0.3 });
    let narrow = Some(Exciter { low_hz: 900.0, high_hz: 1300.0, exponent: -0.4 });
    // Loud, quiet and steep paths together take all loops of the assembly.
    let cases = [
        (1, 1.0, 1.0, 0, None),
        (1, 0.4, 1.0, 0, None),
        (1, 1.0, 30.0, 0, None),
        (1, 0.4, 30.0, 0, None),
        (1, 1.0, 1000.0, 0, None),
        (1, 1.0, 1e-3, 0, band),
        (1, 0.4, 1.0, 0, narrow),
        (1, -1.0, 1.0, 4, None),
        (1, 1.0, 1.0, 3, band),
        (1, 1.0, 20.0, 2, None),
        (1, 0.4, 20.0, 2, None),
        (1, 1.0, 4.0, 2, None),
        (2, 1.0, 1.0, 2, None),
        (2, 0.4, 1.0, 0, None),
        (2, 0.4, 30.0, 0, None),
        // The next two filters have real poles.
        (2, -0.2, 1.0, 0, None),
        (2, -0.2, 30.0, 0, narrow),
        // The next two filters have a pole near -1.
        (1, 0.9, 0.5, 0, None),
        (1, 0.9, 0.5, 2, None),
    ];
    for (order, b1, gain, count, exciter) in cases {
        let mut path = path(b1);
        path.iter_mut().for_each(|point| (point.b0, point.b1) = (point.b0 * gain, point.b1 * gain));
        if order == 2 {
            let ratio = if b1 == -0.2 { 0.2 } else { 0.9 };
            path.iter_mut().for_each(|point| point.a2 = ratio * point.a1 * point.a1);
        }
        if b1 == 0.9 {
            path[0].a1 = 0.99;
        }
        // High frequencies need every shift, and one delay is short.
        let mut loops = loops(count);
        loops.iter_mut().zip([400.0, 5000.0, 9000.0, 15_000.0]).for_each(|(one, hz)| one.frequency_hz = hz);
        loops.iter_mut().for_each(|one| one.gain /= 2.0 * count as f64 * gain.max(1.0));
        if count == 4 {
            loops[2].delay_s = 11.5 / 48_000.0;
        }
        // Chip and PC both begin on a tick.
        chip.render(None, 32 - played % 32).unwrap();
        played = 0;
        chip.load_filter(order, &path, &loops, exciter).unwrap();
        let mut filter = ours(settings(order, &path, &loops, exciter));
        for strike in 0..4u32 {
            let level = [1.0, 0.3, 1.99, 0.01][strike as usize];
            filter.strike(level);
            chip.strike(level).unwrap();
            for _ in 0..12 {
                let frames = random.between(1.0, 90.0) as usize;
                played += frames;
                let mut expected = vec![0; frames];
                filter.render(None, &mut expected);
                assert_eq!(chip.render(None, frames).unwrap().0, expected, "{order} {b1} {gain} {count}");
            }
            played += 2000;
            let mut expected = vec![0; 2000];
            filter.render(None, &mut expected);
            assert_eq!(chip.render(None, 2000).unwrap().0, expected, "{order} {b1} {gain} {count}");
            assert!(expected.iter().any(|&sample| sample != 0));
        }
    }
}

#[test]
fn filter_and_loops_keep_their_cycles_and_cost_nothing_at_rest() {
    let mut chip = FiltersOnChip::new().unwrap();
    let mut cost = |order: u8, b1: f64, gain: f64, loops: &[Loop], exciter: Option<Exciter>| {
        let mut path = path(b1);
        path.iter_mut().for_each(|point| (point.b0, point.b1) = (point.b0 * gain, point.b1 * gain));
        if order == 2 {
            path.iter_mut().for_each(|point| point.a2 = 0.9 * point.a1 * point.a1);
        }
        let load = chip.load_filter(order, &path, loops, exciter).unwrap().nominal;
        println!("{} loops: loaded in {:.2} million cycles", loops.len(), load as f64 / 1e6);
        let at_rest = chip.render(None, 512).unwrap().1.nominal as f64 / 512.0;
        assert!(at_rest <= 0.3, "{at_rest}");
        let strike = chip.strike(1.0).unwrap().nominal;
        let ours = ours(settings(order, &path, loops, exciter));
        let told = f64::from(ours.cycles_a_tick()) / 32.0;
        // The engine renders tick by tick, too.
        let ticks = 64;
        let all: u64 = (0..ticks).map(|_| chip.render(None, 32).unwrap().1.nominal).sum();
        let measured = all as f64 / f64::from(ticks) / 32.0;
        println!("measured {measured:.1} cycles a frame, the budget counts {told:.1}");
        assert!((1.0..1.12).contains(&(told / measured)), "{told} for {measured}");
        (measured, strike)
    };
    let (plain, strike) = cost(1, 1.0, 1.0, &[], None);
    println!("eq. 17 with noise: {plain:.1} cycles a frame, a strike {strike}");
    let (loud, _) = cost(1, 1.0, 10.0, &[], None);
    println!("eq. 17 with noise, louder than the bus: {loud:.1}");
    let (two, _) = cost(1, 0.4, 1.0, &[], None);
    println!("with b1 of its own: {two:.1}");
    let (second, _) = cost(2, 0.4, 1.0, &[], None);
    println!("second order: {second:.1}");
    assert!(second <= 85.0, "{second}");
    let (excited, strike) = cost(1, 1.0, 1.0, &[], Some(Exciter { low_hz: 80.0, high_hz: 5000.0, exponent: 0.3 }));
    println!("with an exciter: {excited:.1}, a strike {strike}");
    assert!(excited <= 95.0, "{excited}");
    let (one, _) = cost(1, 1.0, 1.0, &loops(1), None);
    // More loops would take the chip minutes, because it checks their stability in software f64.
    let (four, _) = cost(1, 1.0, 1.0, &loops(4), None);
    println!("1 loop: {one:.1}, {:.1} with what it costs the filter", one - plain);
    println!("4 loops: {four:.1}, a loop beyond the first: {:.1}", (four - one) / 3.0);
    println!("4 loops, with what they cost the filter: {:.1} a loop", (four - plain) / 4.0);
    let mut of_short = |frames: f64| {
        let mut short = loops(4);
        short.iter_mut().for_each(|one| one.delay_s = (frames + 0.3) / 48_000.0);
        let (four, _) = cost(1, 1.0, 1.0, &short, None);
        println!("4 loops of {frames} frames: {four:.1}, {:.1} a loop", (four - plain) / 4.0);
        (four - plain) / 4.0
    };
    let short = [16.0, 8.0].map(&mut of_short);
    // The goal is 20 for any first order, 16 for a loop, and 30 for a loop of a short delay. A
    // single loop, and one of 16 frames, take a cycle more than before loops lay in lent memory:
    // their lengths are read, where they were constants.
    assert!(plain <= 20.0 && loud <= 20.0 && two <= 20.0, "{plain} {loud} {two}");
    assert!((four - one) / 3.0 <= 13.0 && (four - plain) / 4.0 <= 16.0 && one - plain <= 27.0, "{four} {one}");
    assert!(short[0] <= 21.0 && short[1] <= 30.5, "{short:?}");
}

/// The cycles by which the engine sheds must be at least the cost of a filter, and not much more.
/// This holds for all parts of a filter that the cases above do not have.
#[test]
fn the_budget_counts_levels_exciters_and_second_orders() {
    let mut chip = FiltersOnChip::new().unwrap();
    let wide = Some(Exciter { low_hz: 80.0, high_hz: 5000.0, exponent: 0.3 });
    // Columns: order, a2 over a1², b1 over b0, gain, true if the noise has levels, exciter, number
    // of loops, frames of each.
    let cases = [
        (1, 0.0, 1.0, 1.0, true, None, 0, 34.3),
        (1, 0.0, 0.4, 1.0, true, None, 0, 34.3),
        (1, 0.0, 0.4, 1.0, false, wide, 0, 34.3),
        (1, 0.0, 1.0, 1.0, true, None, 2, 34.3),
        (1, 0.0, 0.4, 1.0, false, wide, 2, 16.3),
        (2, 0.9, 0.4, 30.0, false, None, 0, 34.3),
        (2, 0.9, 0.4, 1.0, true, wide, 0, 34.3),
        (2, 0.2, 0.3, 30.0, false, None, 0, 34.3),
        (2, 0.2, 0.3, 1.0, false, None, 2, 8.3),
    ];
    for (order, ratio, b1, gain, levels, exciter, count, frames) in cases {
        let mut path = path(b1);
        for (point, level) in path.iter_mut().zip([1.0, 0.5, 0.0]) {
            (point.b0, point.b1, point.a2) = (point.b0 * gain, point.b1 * gain, ratio * point.a1 * point.a1);
            point.noise = if levels { level } else { 1.0 };
        }
        let mut loops = loops(count);
        loops.iter_mut().for_each(|one| one.delay_s = frames / 48_000.0);
        chip.load_filter(order, &path, &loops, exciter).unwrap();
        chip.strike(1.0).unwrap();
        let ours = ours(settings(order, &path, &loops, exciter));
        let ticks = 64;
        let all: u64 = (0..ticks).map(|_| chip.render(None, 32).unwrap().1.nominal).sum();
        let measured = all as f64 / f64::from(ticks);
        let over = f64::from(ours.cycles_a_tick()) / measured;
        println!(
            "order {order}, {ratio} {b1} {gain} {levels} {exciter:?} {count}: {measured:.0} cycles a tick, told {over:.3} of it"
        );
        assert!((1.0..1.12).contains(&over), "{over}");
    }
}

#[test]
fn blocks_of_many_ticks_cost_what_ticks_do() {
    let mut chip = FiltersOnChip::new().unwrap();
    let mut cost = |frames: usize| {
        chip.load_filter(1, &path(1.0), &[], None).unwrap();
        chip.strike(1.0).unwrap();
        chip.render(None, 20).unwrap();
        let blocks = 12_800 / frames;
        let all: u64 = (0..blocks).map(|_| chip.render(None, frames).unwrap().1.nominal).sum();
        all as f64 / (blocks * frames) as f64
    };
    let [ticks, long] = [32, 320].map(&mut cost);
    println!("blocks of 32 frames, off the tick: {ticks:.1} cycles a frame; of 320: {long:.1}");
    assert!(long <= 20.0, "{long}");
}
