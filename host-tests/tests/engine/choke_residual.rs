//! A hand on a residual: while it lies there, each band falls at its own rate or the hand's,
//! whichever is faster.

use dsp_core::SampleRate;
use dsp_core::noise::Sfc32;
use dsp_core::residual::{ResidualBand, Shaper};
use dsp_core::resonator::TICK_FRAMES;
use host_tests::lent;

const SEEDS: u32 = 60;

fn band(edges_hz: [f32; 2], decay_db_per_s: f32) -> ResidualBand {
    ResidualBand { edges_hz, weight: 0.1, decay_db_per_s }
}

/// Action at a frame.
#[derive(Clone, Copy)]
enum Act {
    Strike,
    Choke,
    Release,
}

/// Frame at which an action takes effect. A hand acts at the first tick after its event.
fn acts_at(frame: usize, act: Act) -> usize {
    if matches!(act, Act::Strike) { frame } else { (frame / TICK_FRAMES + 1) * TICK_FRAMES }
}

/// Power of each window in dB, averaged over seeds.
fn levels(
    bands: &[ResidualBand],
    hz: u32,
    choke_t60_s: f64,
    acts: &[(usize, Act)],
    windows: usize,
    window: usize,
) -> Vec<f64> {
    let mut powers = vec![0.0; windows];
    for seed in 0..SEEDS {
        let mut shaper = lent!(lender => Shaper::take(lender, bands.len()));
        let rate = SampleRate::new(hz, 1).unwrap();
        shaper.load_choked(bands.iter().copied(), rate, Sfc32::new(seed, 0), 1e-7, 60.0 / choke_t60_s);
        let sound = play(&mut shaper, acts, windows * window);
        for (power, window) in powers.iter_mut().zip(sound.chunks(window)) {
            *power += window.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>();
        }
    }
    powers.iter().map(|power| 10.0 * power.max(1e-9).log10()).collect()
}

fn play(shaper: &mut Shaper<'_>, acts: &[(usize, Act)], frames: usize) -> Vec<i32> {
    let mut out = vec![0; frames];
    let mut acts: Vec<_> = acts.iter().map(|&(frame, act)| (acts_at(frame, act), act)).collect();
    acts.sort_by_key(|(frame, _)| *frame);
    let mut acts = acts.into_iter().peekable();
    let mut at = 0;
    while at < frames {
        while let Some((_, act)) = acts.next_if(|(frame, _)| *frame <= at) {
            match act {
                Act::Strike => shaper.strike(1.0, at % TICK_FRAMES),
                Act::Choke => shaper.set_choked(true),
                Act::Release => shaper.set_choked(false),
            }
        }
        let tick_end = (at / TICK_FRAMES + 1) * TICK_FRAMES;
        let end = acts.peek().map_or(frames, |(frame, _)| *frame).min(tick_end).min(frames);
        shaper.render(&mut out[at..end]);
        if end == tick_end {
            shaper.end_tick(0);
        }
        at = end;
    }
    out
}

#[test]
fn a_choked_residual_falls_at_the_faster_of_both_rates() {
    for hz in [22_050usize, 48_000, 96_000] {
        for (own_db, choke_t60_s) in [(60.0f32, 0.1), (400.0, 0.1), (600.0, 0.1), (1_200.0, 0.1), (100.0, 0.4)] {
            let window = hz / 200;
            let bands = [band([500.0, 4_000.0], own_db), band([4_000.0, 9_000.0], own_db)];
            // The pad is struck before the hand comes, or under the hand.
            for acts in [[(3, Act::Strike), (4 * window + 13, Act::Choke)], [(3, Act::Choke), (17, Act::Strike)]] {
                let found = levels(&bands, hz as u32, choke_t60_s, &acts, 20, window);
                let (from, to) = (5, if own_db > 1_000.0 { 11 } else { 17 });
                let db_per_s = (found[from] - found[to]) / ((to - from) as f64 * window as f64 / hz as f64);
                let wanted = f64::from(own_db).max(60.0 / choke_t60_s);
                assert!(
                    (db_per_s / wanted - 1.0).abs() < 0.05,
                    "{hz} Hz, {own_db} dB/s, hand {choke_t60_s} s: {db_per_s:.1} dB/s"
                );
            }
        }
    }
}

#[test]
fn each_band_of_a_choked_residual_has_the_faster_of_both_rates() {
    // The table has a slow band and a fast one. Each is heard alone, because the other has no
    // weight.
    for (index, wanted) in [(0, 300.0), (1, 900.0)] {
        let mut bands = [band([500.0, 4_000.0], 30.0), band([6_000.0, 12_000.0], 900.0)];
        bands[1 - index].weight = 0.0;
        let found = levels(&bands, 48_000, 0.2, &[(0, Act::Strike), (1_000, Act::Choke)], 14, 240);
        let db_per_s = (found[5] - found[13]) / (8.0 * 0.005);
        assert!((db_per_s / wanted - 1.0).abs() < 0.05, "band {index}: {db_per_s:.1} dB/s");
    }
    // Both bands sound. Once the fast one has gone, the slow one must be where it would be alone.
    let bands = [band([500.0, 4_000.0], 30.0), band([6_000.0, 12_000.0], 900.0)];
    let acts = [(0, Act::Strike), (2_000, Act::Choke), (6_000, Act::Release)];
    let (both, slow) = (levels(&bands, 48_000, 0.2, &acts, 60, 240), levels(&bands[..1], 48_000, 0.2, &acts, 60, 240));
    for window in 40..60 {
        assert!((both[window] - slow[window]).abs() < 0.8, "window {window}: {:.2} {:.2}", both[window], slow[window]);
    }
    let seconds = (6_000.0 - 2_000.0) / 48_000.0;
    // The band falls at its own rate but for the time of the hand.
    let wanted = 30.0 * (50.0 * 0.005 - seconds) + 300.0 * seconds;
    let fallen = slow[0] - slow[50];
    assert!((fallen - wanted).abs() < 1.0, "{fallen:.2} dB, {wanted:.2} by the reference");
}

#[test]
fn a_residual_under_hands_has_the_powers_of_the_reference() {
    // The bands have equal decays. Otherwise a frame that is nearly made would follow the hand only
    // on average over the bands.
    let bands = [band([300.0, 2_000.0], 80.0), band([2_000.0, 10_000.0], 80.0)];
    let acts =
        [(0, Act::Strike), (3_000, Act::Choke), (6_010, Act::Release), (9_000, Act::Choke), (10_007, Act::Release)];
    let holds = [(3_000, 6_010), (9_000, 10_007)].map(|(from, to)| reference::residual::Hold {
        from_s: acts_at(from, Act::Choke) as f64 / 48e3,
        to_s: acts_at(to, Act::Release) as f64 / 48e3,
        t60_s: 0.15,
    });
    let of = |band: &ResidualBand| reference::residual::Band {
        edges_hz: band.edges_hz.map(f64::from),
        weight: f64::from(band.weight),
        decay_db_per_s: f64::from(band.decay_db_per_s),
    };
    let theirs = bands.each_ref().map(of);
    let rate = reference::SampleRate { numerator: 48_000, denominator: 1 };
    let (windows, window) = (50, 240);
    let mut powers = vec![0.0; windows];
    for seed in 0..u64::from(SEEDS) {
        let sound = reference::residual::render_held(&theirs, &holds, windows * window, rate, seed);
        for (power, window) in powers.iter_mut().zip(sound.chunks(window)) {
            *power += window.iter().map(|x| (x * f64::from(1 << 27)).powi(2)).sum::<f64>();
        }
    }
    let found = levels(&bands, 48_000, 0.15, &acts, windows, window);
    for (index, (found, power)) in found.iter().zip(powers).enumerate() {
        let wanted = 10.0 * f64::log10(power);
        // The scatter of 60 seeds of some 100 degrees of freedom each is 0.1 dB. The rest is for
        // frames that are rounded to ticks and have smeared edges.
        assert!((found - wanted).abs() < 0.8, "window {index}: {found:.2} dB, by the reference {wanted:.2}");
    }
}

#[test]
fn a_hand_comes_to_a_residual_and_goes_without_a_click() {
    let bands = [band([100.0, 300.0], 20.0)];
    let reference = |acts: &[(usize, Act)]| {
        let mut shaper = lent!(lender => Shaper::take(lender, bands.len()));
        shaper.load_choked(bands.iter().copied(), SampleRate::HZ_48000, Sfc32::new(1, 0), 1e-7, 600.0);
        play(&mut shaper, acts, 20_000)
    };
    let free = reference(&[(0, Act::Strike)]);
    let step = |sound: &[i32]| sound.windows(2).map(|pair| pair[0].abs_diff(pair[1])).max().unwrap_or(0);
    let largest = step(&free[1..]);
    for phase in 0..70 {
        let (comes, goes) = (5_000 + 11 * phase, 7_001 + 13 * phase);
        let held = reference(&[(0, Act::Strike), (comes, Act::Choke), (goes, Act::Release)]);
        assert!(held[..=comes] == free[..=comes]);
        // The allowance is -90 dBFS.
        assert!(
            step(&held[1..]) <= largest + (1 << 27) / 31_623,
            "phase {phase}: {} after {largest}",
            step(&held[1..])
        );
    }
}
