//! The room on the virtual core: bits equal to the PC's, and its cost.

use dsp_core::SampleRate;
use dsp_core::fixed::ONE_Q27;
use dsp_core::resonator::TICK_FRAMES;
use host_tests::on_chip::RoomOnChip;
use host_tests::room::{LARGE, Table, octave_tables, random_tables, room};

/// Generator of noise at full scale.
fn noise(seed: u32) -> impl FnMut() -> i32 {
    let mut state = seed | 1;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state as i32) >> 4
    }
}

/// Nominal cycles a frame, as (mean, worst tick), under noise `quieter_bits` bits below full scale.
///
/// The noise lasts long enough for the room to raise its level now and then.
fn cycles(chip: &mut RoomOnChip, table: &Table, quieter_bits: u32) -> (f64, f64) {
    chip.load(table, 48_000).unwrap();
    let mut noise = noise(1);
    let mut ticks = Vec::new();
    for tick in 0..1600 {
        let mut out = [[0; 2]; TICK_FRAMES];
        out.fill_with(|| [noise() >> quieter_bits; 2]);
        let cost = chip.render(&mut out).unwrap();
        if tick >= 60 {
            ticks.push(cost.nominal as f64 / TICK_FRAMES as f64);
        }
    }
    (ticks.iter().sum::<f64>() / ticks.len() as f64, ticks.iter().fold(0.0, |most: f64, &tick| most.max(tick)))
}

#[test]
fn four_bands_cost_at_most_289_cycles_a_frame_and_eight_at_most_366() {
    let mut chip = RoomOnChip::new().unwrap();
    let [four, eight] = octave_tables(3.0);
    for (table, most) in [(four, 289.0), (eight, 366.0)] {
        for quieter_bits in [3, 0] {
            let (mean, worst) = cycles(&mut chip, &table, quieter_bits);
            println!(
                "{} bands, -{} dB: {mean:.1} nominal cycles a frame, worst tick {worst:.1}",
                table.bands.len(),
                6 * quieter_bits
            );
            assert!(
                mean <= most && worst <= 600.0,
                "{} bands: {mean:.1} cycles a frame, {worst:.1}",
                table.bands.len()
            );
        }
    }
}

#[test]
fn edges_anywhere_keep_to_the_cycles_that_are_stated() {
    let mut chip = RoomOnChip::new().unwrap();
    // The T60s are far apart. The splits then get as many sections as there are cycles for.
    let far_apart = |edges_hz: &[f64]| {
        let mut table = Table::even(edges_hz, 0.4, 1.0);
        table.bands.iter_mut().step_by(2).for_each(|band| band.t60_s = 3.0);
        table
    };
    let plans: [(&[f64], f64); 5] = [
        (&[250.0, 1000.0, 4000.0], 288.0),
        (&[500.0, 2000.0, 8000.0], 294.0),
        (&[1000.0, 4000.0, 12_000.0], 360.0),
        (&[125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0], 424.0),
        (&[500.0, 1000.0, 2000.0, 4000.0, 8000.0, 11_000.0, 15_000.0], 650.0),
    ];
    for (edges_hz, most) in plans {
        let (mean, worst) = cycles(&mut chip, &far_apart(edges_hz), 3);
        println!("edges {edges_hz:?}: {mean:.1} nominal cycles a frame, worst tick {worst:.1}");
        assert!(mean <= most, "edges {edges_hz:?}: {mean:.1} cycles a frame");
    }
}

#[test]
fn the_chip_gives_the_bits_of_the_pc_for_any_run_length() {
    let mut chip = RoomOnChip::new().unwrap();
    for table in random_tables(4, 2, 4.0, 6.0, 5).into_iter().chain(random_tables(8, 1, 4.0, 6.0, 6)) {
        chip.load(&table, 48_000).unwrap();
        let mut room = room::<i16>(&table, SampleRate::HZ_48000, LARGE).unwrap();
        let mut noise = noise(7);
        for run in 0..800 {
            let frames = 1 + run % TICK_FRAMES;
            let level = 27 - (run / 30) as u32;
            let mut on_chip = vec![[0; 2]; frames];
            on_chip.fill_with(|| match run % 7 {
                0 => [noise() >> (27 - level), noise() >> (27 - level)],
                _ => [0; 2],
            });
            let mut on_pc = on_chip.clone();
            chip.render(&mut on_chip).unwrap();
            room.render(&mut on_pc);
            assert_eq!(on_chip, on_pc, "run {run}");
        }
    }
}

#[test]
fn a_silent_room_costs_next_to_nothing_and_its_memory_is_stated() {
    let mut chip = RoomOnChip::new().unwrap();
    chip.load(&octave_tables(0.2)[0], 48_000).unwrap();
    let mut out = [[0; 2]; TICK_FRAMES];
    out[0] = [ONE_Q27; 2];
    chip.render(&mut out).unwrap();
    let mut last = f64::MAX;
    for _ in 0..600 {
        let mut out = [[0; 2]; TICK_FRAMES];
        last = chip.render(&mut out).unwrap().nominal as f64 / TICK_FRAMES as f64;
    }
    println!("silent: {last:.1} cycles a frame; {} bytes with 48 KB of delay", chip.bytes().unwrap());
    assert!(last <= 13.5, "{last} cycles a frame");
    assert!(chip.bytes().unwrap() <= 49_152 + 10_240);
}
