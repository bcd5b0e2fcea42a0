//! The residual on the virtual core: bits equal to the PC's, and its cycles.

use dsp_core::residual::ResidualBand;
use dsp_core::resonator::TICK_FRAMES;
use host_tests::on_chip::ResidualOnChip;
use host_tests::residual::{SILENCE, Spacing, edges_hz, play, shaper};

/// Number of ticks: a fifth of a second, in which noise for the next strike is made, and a steady
/// part.
const TICKS: usize = 420;

fn bands(spacing: Spacing) -> Vec<ResidualBand> {
    let edges = edges_hz(spacing, 100, [50.0, 23_500.0]);
    let band = |(index, edges): (usize, &[f64])| ResidualBand {
        edges_hz: [edges[0] as f32, edges[1] as f32],
        weight: 0.003,
        decay_db_per_s: 100.0 + 3.0 * index as f32,
    };
    edges.windows(2).enumerate().map(band).collect()
}

/// Cycles of each tick. The sound must have the PC's bits.
fn run(bands: &[ResidualBand], strikes: &[(usize, f32)]) -> Vec<u64> {
    let mut chip = ResidualOnChip::new().expect("the image builds");
    chip.load(bands, 1, SILENCE).expect("the bands fit");
    let pc = play(&mut shaper(bands, 1), strikes, TICKS * TICK_FRAMES);
    (0..TICKS)
        .map(|tick| {
            let strike = strikes.iter().find(|strike| strike.0 / TICK_FRAMES == tick);
            let (out, cost) =
                chip.tick(strike.map(|&(frame, strength)| (frame % TICK_FRAMES, strength))).expect("it runs");
            assert_eq!(out, pc[tick * TICK_FRAMES..(tick + 1) * TICK_FRAMES], "tick {tick}");
            cost.nominal
        })
        .collect()
}

#[test]
fn a_hundred_bands_cost_less_than_250_cycles_a_frame_and_give_the_same_bits() {
    // These are the figures of docs/residual.md: mean, steady mean, dearest steady tick, dearest
    // tick.
    for (spacing, page) in
        [(Spacing::Erb, [218.0, 206.0, 246.0, 280.0]), (Spacing::Linear, [222.0, 210.0, 269.0, 290.0])]
    {
        let cycles = run(&bands(spacing), &[(0, 1.0)]);
        let a_frame = |cycles: u64| cycles as f64 / TICK_FRAMES as f64;
        let steady = &cycles[340..412];
        let mean = a_frame(cycles.iter().sum::<u64>()) / cycles.len() as f64;
        let steady_mean = a_frame(steady.iter().sum::<u64>()) / steady.len() as f64;
        let (steady_worst, worst) =
            (steady.iter().max().copied().unwrap_or(0), cycles.iter().max().copied().unwrap_or(0));
        println!(
            "{spacing:?}: {mean:.0} cycles a frame from a strike on; steady {steady_mean:.0}, worst tick {:.0}; worst tick after a strike {:.0}",
            a_frame(steady_worst),
            a_frame(worst)
        );
        let measured = [mean, steady_mean, a_frame(steady_worst), a_frame(worst)];
        let near = measured.iter().zip(page).all(|(measured, page)| (measured / page - 1.0).abs() <= 0.03);
        assert!(near, "{spacing:?}: {measured:.0?} cycles a frame, {page:.0?} in docs/residual.md");
    }
}

/// Limit of the cycles a frame of the dearest tick of strikes on strikes, 3 % above the figure of
/// docs/residual.md.
const WORST_OF_STRIKES: f64 = 320.0;

#[test]
fn strikes_on_strikes_give_the_same_bits() {
    let bands = bands(Spacing::Erb);
    let strikes = [(0, 1.0), (40, 0.2), (100, 3.0), (800, 0.5), (811, 0.0), (1_500, 0.9), (2_999, 0.4), (4_000, 1e-4)];
    // The strikes of this roll have the dearest distance: each comes when the last one's own frame
    // ends.
    let roll: Vec<(usize, f32)> = (0..8).map(|strike| (strike * 770, 0.5)).collect();
    for strikes in [&strikes[..], &roll] {
        let worst = run(&bands, strikes).iter().max().copied().unwrap_or(0) as f64 / TICK_FRAMES as f64;
        println!("strikes on strikes: worst tick {worst:.0} cycles a frame");
        assert!(worst < WORST_OF_STRIKES, "{worst}");
    }
}

#[test]
fn silence_costs_next_to_nothing() {
    let cycles = run(&bands(Spacing::Erb), &[]);
    println!("a silent tick: {} cycles, calls included", cycles[0]);
    assert!(cycles.iter().all(|&cycles| cycles < 160), "{cycles:?}");
}
