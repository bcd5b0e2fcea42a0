//! A hand on biquads and dynamic filters, in instrument and reference alike. Sounds slower than the
//! hand fall at the hand's T60, faster ones at their own, and nothing clicks.

use dsp_core::SampleRate;
use dsp_core::engine::{Direct, Skipping};
use dsp_core::event::{Action, Event};
use dsp_core::fixed::ONE_Q27;
use dsp_core::table::Kit as KitView;
use host_tests::lent;
use host_tests::scene::{hand, load, mode, one_pad, strike};
use host_tests::snr::snr_db;
use kit::{Biquad, Biquads, Breakpoint, DynamicFilter, Exciter, Kit, Loop, ModesGo, Order};

/// Left channel of the instrument, in bus steps.
fn instrument(kit: &Kit, hz: u32, events: &[Event], force: Option<&[i32]>, frames: usize, block: usize) -> Vec<i32> {
    play(kit, hz, events, force, (frames, block, Skipping::Off))
}

fn play(
    kit: &Kit,
    hz: u32,
    events: &[Event],
    force: Option<&[i32]>,
    (frames, block, skipping): (usize, usize, Skipping),
) -> Vec<i32> {
    let loaded = load(kit.clone());
    let view = KitView::parse(&loaded.binary).expect("a right kit");
    let mut engine = lent::engine(&view, SampleRate::new(hz, 1).unwrap(), skipping).expect("it can be played");
    let (mut out, mut events) = (vec![[0; 2]; frames], events);
    for chunk in out.chunks_mut(block) {
        let start = engine.now() as usize;
        let due = events.iter().take_while(|event| event.time.first_frame() < (start + chunk.len()) as u64).count();
        let direct = force.map(|force| Direct { pad: 0, force: &force[start..start + chunk.len()] });
        engine.render_bus(&events[..due], direct, chunk, |_| {}).expect("right events");
        events = &events[due..];
    }
    out.iter().map(|frame| frame[0]).collect()
}

/// Left channel of the reference, in bus steps.
fn reference(kit: &Kit, hz: u32, events: &[Event], frames: usize) -> Vec<f64> {
    let pads = malleus::render::reference::pads(kit, SampleRate::new(hz, 1).unwrap());
    let action = |action| match action {
        Action::Choke => reference::Action::Choke,
        Action::Release => reference::Action::Release,
        _ => reference::Action::Strike,
    };
    let of = |event: &Event| reference::Event {
        time_samples: event.time.frame as f64,
        pad: 0,
        velocity: f64::from(event.velocity),
        position: 0.0,
        striker: 0,
        action: action(event.action),
    };
    let events: Vec<_> = events.iter().map(of).collect();
    let rate = reference::SampleRate { numerator: hz, denominator: 1 };
    let sound = reference::render(&pads, &events, None, rate, frames).expect("right events");
    sound.iter().map(|[left, _]| left * f64::from(ONE_Q27)).collect()
}

/// Kit of one pad with a choke T60.
fn kit(choke_t60_s: f32, filter: Option<DynamicFilter>, biquads: Option<Biquads>) -> Kit {
    let mut kit = one_pad(Vec::new());
    kit.objects[0].dynamic_filter = filter;
    kit.objects[0].biquads = biquads;
    kit.pads[0].choke_t60_s = choke_t60_s;
    kit
}

/// Pole pair with a frequency and a T60 at 48 kHz, and a gain that makes a strike well audible.
fn pole(frequency_hz: f64, t60_s: f64, gain: f32) -> Biquad {
    let (radius, angle) = ((-1000f64.ln() / (t60_s * 48e3)).exp(), frequency_hz / 48e3 * std::f64::consts::TAU);
    Biquad { pole: [(radius * angle.cos()) as f32, (radius * angle.sin()) as f32], zero: [0.0, 0.0], gain }
}

fn bank(chains: Vec<Vec<Biquad>>) -> Biquads {
    Biquads { rate_hz: 48_000.0, chains }
}

fn point(time_s: f32, a1: f32, b: f32) -> Breakpoint {
    Breakpoint { time_s, a1, b0: b, b1: b, ..Breakpoint::default() }
}

fn path(path: Vec<Breakpoint>) -> DynamicFilter {
    DynamicFilter {
        seed: 5,
        modes: ModesGo::Beside,
        rate_hz: 48_000.0,
        exciter: None,
        order: Order::First,
        path,
        loops: Vec::new(),
    }
}

/// Path of an exponential decay, in 31 pieces.
fn falling(t60_s: f32, length_s: f32) -> DynamicFilter {
    let at = |index: usize| {
        let time_s = length_s * index as f32 / 31.0;
        point(time_s, -0.7, 0.2 * 1000f32.powf(-time_s / t60_s))
    };
    path((0..32).map(at).collect())
}

/// Power in a window, in dB.
fn level(sound: &[i32], at: usize, frames: usize) -> f64 {
    10.0 * sound[at..at + frames].iter().map(|&x| (f64::from(x)).powi(2)).sum::<f64>().log10()
}

/// T60 in seconds, from the fall of a sound between two windows of `window` frames.
fn t60_s(sound: &[i32], hz: u32, [from, to]: [usize; 2], window: usize) -> f64 {
    60.0 * (to - from) as f64 / f64::from(hz) / (level(sound, from, window) - level(sound, to, window))
}

fn largest_step(sound: &[i32]) -> i32 {
    sound.windows(2).map(|pair| pair[0].abs_diff(pair[1]) as i32).max().unwrap_or(0)
}

/// Largest step of a hand that is no click: -90 dBFS.
const STEP: i32 = ONE_Q27 / 31_623;

#[test]
fn a_choked_biquad_falls_at_the_faster_of_both_rates() {
    for hz in [22_050, 48_000, 96_000] {
        for (own, choke) in [(2.0, 0.1f32), (0.1, 0.1), (0.05, 0.1), (0.3, 0.02)] {
            let kit = kit(choke, None, Some(bank(vec![vec![pole(1_000.0, own, 0.05)]])));
            let start = hz as usize / 50;
            let frames = hz as usize / 4;
            let wanted = own.min(f64::from(choke));
            let (from, to) = (start + hz as usize / 500, start + (wanted * f64::from(hz) * 0.6) as usize);
            let events = [strike(0, 1.0), hand(start as u64, Action::Choke)];
            let got = t60_s(&instrument(&kit, hz, &events, None, frames, 128), hz, [from, to], hz as usize / 100);
            assert!((got / wanted - 1.0).abs() < 0.02, "{hz} Hz, own {own} s, hand {choke} s: {got:.4} s");
            let expected: Vec<i32> = reference(&kit, hz, &events, frames).iter().map(|&x| x as i32).collect();
            let got = t60_s(&expected, hz, [from, to], hz as usize / 100);
            assert!((got / wanted - 1.0).abs() < 0.02, "reference, {hz} Hz, own {own} s, hand {choke} s: {got:.4} s");
            // A sound that is struck under the hand falls as fast.
            let under = [hand(0, Action::Choke), strike(start as u64, 1.0)];
            let got = t60_s(&instrument(&kit, hz, &under, None, frames, 128), hz, [from, to], hz as usize / 100);
            assert!((got / wanted - 1.0).abs() < 0.02, "struck under it, own {own} s, hand {choke} s: {got:.4} s");
        }
    }
}

/// Hands, with strikes under them and after them, at odd frames.
fn events(hz: u32) -> Vec<Event> {
    let at = |s: f64| (s * f64::from(hz)) as u64;
    vec![
        strike(3, 1.0),
        hand(at(0.05), Action::Choke),
        strike(at(0.0771), 0.9),
        hand(at(0.1203), Action::Release),
        strike(at(0.1307), 0.7),
        hand(at(0.1909), Action::Choke),
        hand(at(0.2101), Action::Release),
    ]
}

#[test]
fn choked_biquads_of_every_depth_keep_86_db_against_the_reference() {
    let all = [
        bank((1..30).map(|n| vec![pole(110.0 * f64::from(n), 0.02 * f64::from(n), 0.01)]).collect()),
        bank(vec![
            vec![pole(300.0, 1.0, 0.1), pole(900.0, 0.05, 0.1)],
            vec![pole(9_000.0, 0.5, 0.1), pole(20_000.0, 0.2, 0.5)],
        ]),
        // These poles coincide or nearly coincide.
        bank(vec![
            vec![pole(500.0, 0.2, 0.02), pole(500.0, 0.2, 0.02)],
            vec![pole(4_000.0, 0.1, 0.3), pole(4_001.0, 0.12, 0.3)],
        ]),
        bank(vec![vec![
            pole(700.0, 0.1, 0.02),
            pole(701.0, 0.1, 0.02),
            pole(700.0, 0.11, 0.05),
            pole(2_000.0, 0.3, 0.5),
        ]]),
    ];
    for (index, bank) in all.into_iter().enumerate() {
        for hz in [22_050, 48_000, 96_000] {
            if hz == 22_050 && index == 1 {
                continue; // 20 kHz lies beyond half the rate
            }
            for choke in [0.002f32, 0.05, 1.0] {
                let mut kit = kit(choke, None, Some(bank.clone()));
                let frames = hz as usize / 4;
                let exact = reference(&kit, hz, &events(hz), frames);
                // The bank plays as loud as it may.
                let peak = exact.iter().fold(0.0f64, |peak, x| peak.max(x.abs())) / f64::from(ONE_Q27);
                for chain in &mut kit.objects[0].biquads.as_mut().unwrap().chains {
                    chain[0].gain *= (0.5 / peak) as f32;
                }
                let exact = reference(&kit, hz, &events(hz), frames);
                let own = instrument(&kit, hz, &events(hz), None, frames, 128);
                let snr = snr_db(&exact, &own);
                println!("bank {index}, {hz} Hz, hand {choke} s: {snr:.1} dB");
                assert!(snr >= 86.0, "bank {index}, {hz} Hz, hand {choke} s: {snr:.1} dB");
            }
        }
    }
}

#[test]
fn a_choked_dynamic_filter_falls_at_the_faster_of_both_rates() {
    for hz in [22_050, 48_000, 96_000] {
        for (own, choke) in [(1.0f32, 0.1f32), (0.15, 0.1), (0.1, 0.1), (0.05, 0.1)] {
            let kit = kit(choke, Some(falling(own, 1.3 * own)), None);
            let start = hz as usize / 50;
            let wanted = f64::from(own.min(choke));
            let (from, to) = (start, start + (wanted * f64::from(hz) * 0.7) as usize);
            let events = [strike(0, 1.0), hand(start as u64, Action::Choke)];
            let window = hz as usize / 100;
            // The level of noise scatters. So it is measured against the level of equal noise
            // without a hand, whose fall is known.
            let free = instrument(&kit, hz, &events[..1], None, hz as usize / 2, 128);
            let choked = instrument(&kit, hz, &events, None, hz as usize / 2, 128);
            let expected = reference(&kit, hz, &events, hz as usize / 2);
            let seconds = (to - from) as f64 / f64::from(hz);
            let extra = |sound: &[i32]| {
                let under = |at: usize| level(&free, at, window) - level(sound, at, window);
                (under(to) - under(from)) / seconds
            };
            for (name, sound) in [("instrument", choked), ("reference", expected.iter().map(|&x| x as i32).collect())] {
                let got = 60.0 / (60.0 / f64::from(own) + extra(&sound));
                // A piece of the path falls by 2.5 dB, more slowly at its beginning than at its
                // end.
                assert!((got / wanted - 1.0).abs() < 0.05, "{name}, {hz} Hz, own {own} s, hand {choke} s: {got:.4} s");
            }
        }
    }
}

#[test]
fn choked_dynamic_filters_keep_80_db_against_the_reference() {
    let second = |time_s, b: f32| Breakpoint { time_s, noise: 1.0, a1: -1.7, a2: 0.9, b0: b, b1: 0.0, b2: -b };
    let real = |time_s, b: f32| Breakpoint { time_s, noise: 1.0, a1: -1.2, a2: 0.35, b0: b, b1: 0.0, b2: 0.0 };
    let round = Loop { frequency_hz: 500.0, bandwidth_hz: 5.0, gain: 0.6, delay_s: 0.004 };
    let levels = |time_s, noise| Breakpoint { noise, ..point(time_s, -0.5, 0.25) };
    let all = [
        ("exponential", falling(0.2, 0.3)),
        ("one piece to 0", path(vec![point(0.0, -0.5, 0.3), point(0.25, -0.98, 0.0)])),
        ("slow pole", path(vec![point(0.0, -0.999, 0.01), point(0.03, -0.999, 0.0)])),
        ("swelling", path(vec![point(0.0, -0.5, 0.0), point(0.03, -0.5, 0.3), point(0.25, -0.9, 0.01)])),
        ("levels", path(vec![levels(0.0, 1.0), levels(0.1, 0.2), levels(0.2, 0.0), levels(0.3, 0.0)])),
        ("second order", DynamicFilter { order: Order::Second, ..path(vec![second(0.0, 0.1), second(0.2, 0.01)]) }),
        ("real poles", DynamicFilter { order: Order::Second, ..path(vec![real(0.0, 0.2), real(0.2, 0.01)]) }),
        (
            "exciter",
            DynamicFilter {
                exciter: Some(Exciter { low_hz: 300.0, high_hz: 4_000.0, exponent: 0.3 }),
                ..falling(0.2, 0.3)
            },
        ),
        ("loop", DynamicFilter { loops: vec![round], ..path(vec![levels(0.0, 1.0), levels(0.05, 0.0)]) }),
        ("modes through", DynamicFilter { modes: ModesGo::Through, ..falling(0.3, 0.4) }),
        (
            "modes through a slow pole",
            DynamicFilter { modes: ModesGo::Through, ..path(vec![point(0.0, -0.99, 0.01), point(0.3, -0.99, 0.0001)]) },
        ),
    ];
    for (name, filter) in all {
        for hz in [22_050, 48_000, 96_000] {
            for choke in [0.01f32, 0.05, 1.0] {
                let mut kit = kit(choke, Some(filter.clone()), None);
                if filter.modes == ModesGo::Through {
                    kit.objects[0].modes = vec![mode(440.0, 0.5, 300.0, 0.0), mode(3_000.0, 0.04, 300.0, 0.0)];
                }
                let frames = hz as usize / 4;
                let exact = reference(&kit, hz, &events(hz), frames);
                let own = instrument(&kit, hz, &events(hz), None, frames, 128);
                let snr = snr_db(&exact, &own);
                println!("{name}, {hz} Hz, hand {choke} s: {snr:.1} dB");
                // The bank of modes follows a choke to within some 60 dB of its own sound.
                let floor = if filter.modes == ModesGo::Through { 55.0 } else { 80.0 };
                assert!(snr >= floor, "{name}, {hz} Hz, hand {choke} s: {snr:.1} dB");
            }
        }
    }
}

#[test]
fn a_hand_comes_and_goes_without_a_click() {
    let chains =
        vec![vec![pole(220.0, 3.0, 0.1), pole(600.0, 0.5, 0.1)], vec![pole(400.0, 1.0, 0.1), pole(400.5, 1.0, 0.02)]];
    let tone = DynamicFilter {
        loops: vec![Loop { frequency_hz: 200.0, bandwidth_hz: 2.0, gain: 2.2, delay_s: 0.005 }],
        path: vec![
            point(0.0, -0.99, 0.005),
            Breakpoint { noise: 0.0, ..point(0.03, -0.99, 0.005) },
            Breakpoint { noise: 0.0, ..point(1.0, -0.99, 0.005) },
        ],
        ..path(vec![])
    };
    // The chains play at half of full scale.
    let loud = |mut kit: Kit| {
        let exact = reference(&kit, 48_000, &[strike(0, 1.0)], 7_000);
        let peak = exact.iter().fold(0.0f64, |peak, x| peak.max(x.abs())) / f64::from(ONE_Q27);
        for chain in &mut kit.objects[0].biquads.as_mut().unwrap().chains {
            chain[0].gain *= (0.5 / peak) as f32;
        }
        kit
    };
    // This is a resonance at 200 Hz with a T60 of 0.3 s, rung by 10 ms of noise.
    let at = |time_s, noise| Breakpoint { time_s, noise, a1: -1.998_315, a2: 0.999_0, b0: 2e-4, b1: 0.0, b2: 0.0 };
    let ring = DynamicFilter { order: Order::Second, ..path(vec![at(0.0, 1.0), at(0.01, 0.0), at(1.0, 0.0)]) };
    for kit_of in [
        &|choke| loud(kit(choke, None, Some(bank(chains.clone())))),
        &|choke| kit(choke, Some(tone.clone()), None),
        &|choke| kit(choke, Some(ring.clone()), None),
    ] as [&dyn Fn(f32) -> Kit; 3]
    {
        for choke in [0.005f32, 0.1, 2.0] {
            let kit = kit_of(choke);
            let free = instrument(&kit, 48_000, &[strike(0, 1.0)], None, 12_000, 128);
            for phase in [0, 7, 31, 100] {
                let (comes, goes) = (6_000 + phase, 6_400 + phase);
                let events = [strike(0, 1.0), hand(comes, Action::Choke), hand(goes, Action::Release)];
                let held = instrument(&kit, 48_000, &events, None, 12_000, 128);
                let [comes, goes] = [comes as usize, goes as usize];
                // Both are equal up to the hand, and at its first sample but for rounding.
                assert!(held[..comes] == free[..comes] && held[comes].abs_diff(free[comes]) <= 16);
                assert!(free.iter().all(|x| x.abs() < 2 * ONE_Q27), "it clips");
                let loudest = free[comes - 600..comes + 600].iter().map(|x| x.abs()).max();
                assert!(loudest > Some(ONE_Q27 / 10_000), "hand {choke} s: {loudest:?}");
                // The reference steps too when a fast hand takes its part of a sample. That step is
                // at most this part of the loudest sample.
                let taken = 1.0 - (-1000f64.ln() / (f64::from(choke) * 48e3)).exp();
                let of_hand = if choke < 0.05 { (f64::from(loudest.unwrap_or(0)) * taken) as i32 } else { 0 };
                assert!(choke > 0.3 || held[goes - 300..goes] != free[goes - 300..goes]);
                let (before, at) =
                    (largest_step(&free[comes - 600..comes]), largest_step(&held[comes - 2..comes + 40]));
                assert!(at <= before + of_hand + STEP, "hand {choke} s comes: {at} after {before}");
                // The reference only multiplies states, so it has no other step. The instrument
                // must be where the reference is, before the hand goes and after.
                let exact = reference(&kit, 48_000, &events, goes + 600);
                for (n, exact) in exact.iter().enumerate().skip(comes - 100) {
                    let off = (f64::from(held[n]) - exact).abs();
                    assert!(off <= f64::from(STEP), "hand {choke} s, frame {n}, {goes}: off by {off}");
                }
            }
        }
    }
}

#[test]
fn hands_on_stages_give_the_same_bits_for_any_block_size() {
    let round = Loop { frequency_hz: 500.0, bandwidth_hz: 5.0, gain: 0.3, delay_s: 0.004 };
    let filter = DynamicFilter {
        modes: ModesGo::Through,
        loops: vec![],
        ..path(vec![point(0.0, -0.5, 0.3), point(0.0777, -0.9, 0.05), point(0.25, -0.98, 0.0)])
    };
    let chains = vec![
        vec![pole(220.0, 3.0, 0.02), pole(221.0, 2.0, 0.02)],
        vec![pole(900.0, 0.05, 0.05), pole(5_000.0, 1.0, 0.1)],
    ];
    for loops in [vec![], vec![round]] {
        let mut kit = kit(0.05, Some(DynamicFilter { loops, ..filter.clone() }), Some(bank(chains.clone())));
        kit.objects[0].modes = vec![mode(440.0, 0.5, 300.0, 0.0)];
        let force: Vec<i32> =
            (0..12_000).map(|n: i32| if (3_000..3_050).contains(&n) { ONE_Q27 / 4 } else { 0 }).collect();
        let whole = instrument(&kit, 48_000, &events(48_000), Some(&force), 12_000, 12_000);
        for block in [1, 7, 32, 100] {
            assert!(
                instrument(&kit, 48_000, &events(48_000), Some(&force), 12_000, block) == whole,
                "blocks of {block}"
            );
        }
        let skipping = play(&kit, 48_000, &events(48_000), Some(&force), (12_000, 128, Skipping::On));
        assert!(skipping == whole, "what rests is left out");
    }
}

#[test]
fn zeros_that_another_rate_moves_sound_alike_in_instrument_and_reference() {
    for zero in [[1.0, 0.0], [-1.0, 0.0], [-0.8, 0.3], [-1.5, 0.0], [0.0, 1.0], [-0.999, 0.01]] {
        let biquad = Biquad { pole: [0.99, 0.05], zero, gain: 0.0003 };
        let mut kit = kit(0.1, None, Some(bank(vec![vec![biquad]])));
        kit.objects[0].modes = vec![mode(440.0, 0.23, 300.0, 0.0)];
        for hz in [48_000, 44_100, 96_000, 22_050] {
            let exact = reference(&kit, hz, &events(hz), 9_600);
            let own = instrument(&kit, hz, &events(hz), None, 9_600, 128);
            let worst = own.iter().zip(&exact).map(|(own, exact)| (f64::from(*own) - exact).abs()).fold(0.0, f64::max);
            // A step of 24 bits is 16 bus steps.
            println!("zero {zero:?}, {hz} Hz: {:.2} steps", worst / 16.0);
            assert!(snr_db(&exact, &own) >= 86.0, "zero {zero:?}, {hz} Hz");
        }
    }
}
