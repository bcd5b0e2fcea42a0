//! Whole kits with dynamic filters, loops, biquads, hands and a room, by the instrument and by the
//! `f64` reference. A room is compared with its arithmetic twin.

use dsp_core::SampleRate;
use dsp_core::engine::{Setup, Skipping};
use dsp_core::event::{Action, Event, Time};
use dsp_core::fixed::ONE_Q27;
use dsp_core::table::Kit;
use kit::{Breakpoint, DynamicFilter, Exciter, Loop, ModesGo, Order};
use malleus::render::instrument::{Output, Settings};
use malleus::render::{Performance, instrument, reference};
use proptest::prelude::*;

/// Frames (left, right) of the reference's sound and of the instrument's bus.
fn rendered(kit: &kit::Kit, events: Vec<Event>, rate: SampleRate, seconds: f64) -> (Vec<[f64; 2]>, Vec<[i32; 2]>) {
    let binary = kit::binary::build(kit).expect("a right kit");
    let performance = Performance::new(events, None, kit, rate, Some(seconds));
    // The reference's own room is another noise, so that samples are compared with the network's
    // twin.
    let expected =
        reference::render_in(reference::Room::NetworkTwin, kit, &performance, rate, |_| {}).expect("right events");
    let table = Kit::parse(&binary).expect("a loaded kit is valid");
    let settings =
        Settings { setup: Setup { skipping: Skipping::Off, ..Setup::new(rate) }, block: 128, budget_cycles: None };
    let bus = instrument::render(&table, &performance, settings, Output::Bus, |_| {}).expect("the kit fits");
    (expected, bus)
}

/// Rms levels in dBFS of the reference's sound, and of the instrument's difference from it.
fn heard_and_error_dbfs((expected, bus): &(Vec<[f64; 2]>, Vec<[i32; 2]>)) -> (f64, f64) {
    let (mut signal, mut noise) = (0.0, 0.0);
    for (expected, &got) in expected.iter().flatten().zip(bus.iter().flatten()) {
        signal += expected * expected;
        noise += (f64::from(got) / f64::from(ONE_Q27) - expected).powi(2);
    }
    let values = 2.0 * expected.len() as f64;
    (10.0 * (signal / values).log10(), 10.0 * (noise / values).log10())
}

/// SNR in dB of the instrument's sound against the reference's.
fn snr_db(kit: kit::Kit, events: Vec<Event>, rate: SampleRate, seconds: f64) -> f64 {
    let (heard, error) = heard_and_error_dbfs(&rendered(&kit, events, rate, seconds));
    heard - error
}

fn event(action: Action, pad: usize, frame: u64, velocity: f32) -> Event {
    Event { time: Time { frame, fraction: 0x3000_0000 }, pad: pad as u8, velocity, action, ..Event::default() }
}

/// Strikes of a pad, one of them after the end of its noise. Between them a hand chokes the pad,
/// releases it, and chokes it for good.
fn played(pad: usize) -> Vec<Event> {
    use Action::{Choke, Release, Strike};
    let events = [
        (Strike, 1_003, 1.0),
        (Strike, 4_000, 0.6),
        (Choke, 9_000, 0.0),
        (Strike, 11_017, 0.9),
        (Release, 13_333, 0.0),
        (Strike, 90_000, 0.3),
        (Choke, 95_000, 0.0),
        (Strike, 140_000, 0.8),
    ];
    events.into_iter().map(|(action, frame, velocity)| event(action, pad, frame, velocity)).collect()
}

fn filters() -> kit::Kit {
    kit::open("filters").expect("the shipped kit is valid").kit
}

#[test]
fn each_pad_of_the_filters_kit_has_96_db_of_snr_to_the_reference() {
    for rate in [SampleRate::HZ_48000, SampleRate::new(44_100, 1).expect("a right rate")] {
        for (index, pad) in filters().pads.iter().enumerate() {
            let snr_db = snr_db(filters(), played(index), rate, 1.0);
            println!("{} at {} Hz: {snr_db:.1} dB", pad.name, rate.hz());
            assert!(snr_db >= 96.0, "{} at {} Hz: {snr_db:.1} dB", pad.name, rate.hz());
        }
    }
}

#[test]
fn instrument_has_90_db_of_snr_to_the_twin_of_a_room_that_falls_silent() {
    let mut kit = filters();
    kit.room = [(0.0, 0.5, -9.0), (500.0, 0.4, -12.0), (2_000.0, 0.3, -15.0), (8_000.0, 0.2, -20.0)]
        .map(|(from_hz, t60_s, energy_db)| kit::RoomBand::new(from_hz, t60_s, energy_db))
        .into();
    let strikes = [(0, 5_003), (1, 20_000), (4, 250_031)];
    let events = strikes.map(|(pad, frame)| event(Action::Strike, pad, frame, 0.9)).into();
    let snr_db = snr_db(kit, events, SampleRate::HZ_48000, 2.0);
    println!("with a room: {snr_db:.1} dB");
    assert!(snr_db >= 90.0, "{snr_db:.1} dB");
}

/// Loops whose delay is shorter than a tick keep some 100 steps of the bus by rounding, until
/// silence ends them. A room as loud as the dry sound doubles the power of what it is given.
#[test]
fn room_adds_no_error_of_its_own_to_loops_that_fade() {
    let rate = SampleRate::new(32_000, 1).expect("a right rate");
    let error_dbfs = |room: Vec<kit::RoomBand>| {
        let kit = kit::Kit { room, ..filters() };
        let events = vec![event(Action::Strike, 2, 0, 0.05), event(Action::Strike, 0, 98_186, 0.593_423_66)];
        heard_and_error_dbfs(&rendered(&kit, events, rate, 0.8)).1
    };
    let dry = error_dbfs(Vec::new());
    let wet = error_dbfs(vec![kit::RoomBand { from_hz: 0.0, gain: 8.311_291, decay_per_s: 34.538_776 }]);
    println!("error {dry:.1} dBFS dry, {wet:.1} dBFS in a room");
    assert!(dry < -120.0 && wet < dry + 3.2, "error {dry} dBFS dry, {wet} dBFS in a room");
}

/// A choke ends with a tick, and noise is drawn up to its end. Which tick it is may hang on a
/// rounding.
#[test]
fn strike_after_a_choke_sounds_the_same_whichever_tick_the_choke_ended_in() {
    let sound = |choke_t60_s: f32| {
        let mut kit = filters();
        kit.pads.truncate(1);
        kit.pads[0].choke_t60_s = choke_t60_s;
        kit.objects[0].modes.clear();
        let point = |time_s: f32| Breakpoint { time_s, noise: 1.0, a1: -0.5, a2: 0.0, b0: 0.2, b1: 0.1, b2: 0.0 };
        kit.objects[0].dynamic_filter = Some(DynamicFilter {
            seed: 1,
            modes: ModesGo::Beside,
            rate_hz: 48_000.0,
            exciter: None,
            order: Order::First,
            path: vec![point(0.0), point(1.0)],
            loops: Vec::new(),
        });
        let events =
            [(Action::Strike, 1_000), (Action::Choke, 2_000), (Action::Release, 20_000), (Action::Strike, 20_100)];
        let events = events.map(|(action, frame)| event(action, 0, frame, 0.9)).into();
        let both = rendered(&kit, events, SampleRate::HZ_48000, 0.5);
        let (heard, error) = heard_and_error_dbfs(&both);
        assert!(heard - error >= 90.0, "T60 {choke_t60_s} s: {:.1} dB", heard - error);
        both.1[20_100..].to_vec()
    };
    let after = sound(0.08);
    assert!(after.iter().any(|&frame| frame != [0, 0]));
    for n in 1..20 {
        let choke_t60_s = 0.08 + 0.0005 * n as f32;
        assert_eq!(sound(choke_t60_s), after, "T60 {choke_t60_s} s");
    }
}

/// Coefficients a1 and a2 of any poles whose magnitude is at most `largest`.
///
/// In a filter of first order a2 is 0; one of second order has a pair of conjugate poles.
fn any_poles(order: Order, largest: f32) -> BoxedStrategy<(f32, f32)> {
    match order {
        Order::First => (-largest..largest).prop_map(|a1| (a1, 0.0)).boxed(),
        Order::Second => (0.05f32..largest, 0.1f32..3.0).prop_map(|(r, angle)| (-2.0 * r * angle.cos(), r * r)).boxed(),
    }
}

prop_compose! {
    fn any_path(order: Order, levels: bool)(
        points in prop::collection::vec((0.0005f32..0.1, any_poles(order, 0.99), -0.3f32..0.3, -0.3f32..0.3, 0.0f32..1.0), 1..8),
    ) -> Vec<Breakpoint> {
        let mut end_s = 0.0;
        points
            .into_iter()
            .map(|(step_s, (a1, a2), b0, b1, noise)| {
                let time_s = end_s;
                end_s += step_s;
                // A quarter of the breakpoints are silent.
                let noise = if levels { (4.0 / 3.0 * noise - 1.0 / 3.0).max(0.0) } else { 1.0 };
                Breakpoint { time_s, noise, a1, a2, b0, b1, b2: 0.0 }
            })
            .collect()
    }
}

prop_compose! {
    fn any_filter()(order in prop_oneof![Just(Order::First), Just(Order::Second)], levels in any::<bool>())(
        path in any_path(order, levels),
        order in Just(order),
        seed in any::<u32>(),
        through in any::<bool>(),
        exciter in prop::option::of((50.0f32..2_000.0, 1.2f32..8.0, -0.8f32..0.8)),
        loops in prop::collection::vec((80.0f32..8_000.0, 2.0f32..200.0, -0.9f32..0.9, 0.0003f32..0.02), 0..4),
    ) -> DynamicFilter {
        // The sum of all gains round the loops stays below 0.9, so that the filter is stable on its
        // path.
        let gain_at = |point: &Breakpoint| (0..400).map(|n| point.magnitude(60.0 * f64::from(n), 48_000.0)).fold(0.0, f64::max);
        let loudest = path.iter().map(gain_at).fold(1e-3, f64::max) as f32;
        let count = loops.len() as f32;
        DynamicFilter {
            seed,
            modes: if through { ModesGo::Through } else { ModesGo::Beside },
            rate_hz: 48_000.0,
            exciter: exciter.map(|(low_hz, ratio, exponent)| Exciter { low_hz, high_hz: ratio * low_hz, exponent }),
            order,
            path,
            loops: loops
                .into_iter()
                .map(|(frequency_hz, bandwidth_hz, gain, delay_s)| Loop {
                    frequency_hz,
                    bandwidth_hz: bandwidth_hz.min(0.5 * frequency_hz),
                    gain: gain / count / (4.0 * loudest).max(1.0),
                    delay_s,
                })
                .collect(),
        }
    }
}

/// True if the error lies 90 dB below the sound, or below -120 dBFS, where nobody hears it.
fn is_right(heard_dbfs: f64, error_dbfs: f64) -> bool {
    heard_dbfs - error_dbfs >= 90.0 || error_dbfs < -120.0
}

/// Events of pad 0 in order of time, from (frame, velocity, kind).
///
/// Kind 0 is a choke, 1 a release, and any other a strike.
fn hands(times: Vec<(u64, f32, usize)>) -> Vec<Event> {
    let what = |what: usize| [Action::Choke, Action::Release].get(what).copied().unwrap_or(Action::Strike);
    let mut events: Vec<Event> =
        times.into_iter().map(|(frame, velocity, of)| event(what(of), 0, frame, velocity)).collect();
    events.sort_by_key(|event| event.time.frame);
    events
}

fn any_rate() -> impl Strategy<Value = SampleRate> {
    let ratios = [(44_100, 1), (48_000, 1), (86_000_000, 1_792), (32_000, 1), (96_000, 1)];
    prop::sample::select(ratios.to_vec())
        .prop_map(|(numerator, denominator)| SampleRate::new(numerator, denominator).expect("a right rate"))
}

/// Any bands of a room, from the lowest up. They begin below 10 kHz, an octave and more apart.
fn any_room() -> impl Strategy<Value = Vec<kit::RoomBand>> {
    let band = (1.0f64..2.0, 0.2f64..6.0, -30.0f64..0.0);
    prop::collection::vec(band, 1..=8).prop_map(|bands| {
        let mut from_hz = 0.0;
        let mut next = |octaves: f64| {
            let from = from_hz;
            from_hz = if from == 0.0 { 60.0 * octaves } else { from * octaves.exp2() };
            from
        };
        let bands = bands.into_iter().map(|(octaves, t60_s, energy_db)| (next(octaves), t60_s, energy_db));
        bands
            .filter(|band| band.0 < 10_000.0)
            .map(|(from_hz, t60_s, db)| kit::RoomBand::new(from_hz, t60_s, db))
            .collect()
    })
}

/// Any biquad bank whose biquads have a gain of about 1 at their pole.
fn any_biquads() -> impl Strategy<Value = kit::Biquads> {
    // Angles stay below the Nyquist frequency of the slowest rate.
    let section = (-4.0f64..-0.3, 0.02f64..2.0, 0.0f64..1.0, 0.0f64..2.0, 0.3f64..1.0);
    (1usize..=4).prop_flat_map(move |depth| {
        let chain = prop::collection::vec(section.clone(), depth);
        prop::collection::vec(chain, 1..6).prop_map(|chains| {
            let root = |radius: f64, angle: f64| [(radius * angle.cos()) as f32, (radius * angle.sin()) as f32];
            let biquad = |(bits, angle, zero, at, level): (f64, f64, f64, f64, f64)| {
                let distance = 10f64.powf(bits);
                kit::Biquad {
                    pole: root(1.0 - distance, angle),
                    zero: root(zero, at),
                    gain: (level * distance * angle.sin()) as f32,
                }
            };
            let chains = chains.into_iter().map(|chain| chain.into_iter().map(biquad).collect()).collect();
            kit::Biquads { rate_hz: 48_000.0, chains }
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    /// The kit has any dynamic filter, and any strikes and hands.
    #[test]
    fn dynamic_filter_has_90_db_of_snr_to_the_reference_or_an_inaudible_error(
        filter in any_filter(),
        times in prop::collection::vec((0u64..30_000, 0.05f32..=1.0, 0usize..8), 1..8),
        rate in any_rate(),
    ) {
        let mut kit = filters();
        kit.pads.truncate(1);
        kit.objects[0].dynamic_filter = Some(filter);
        let events = hands(times);
        let (heard, error) = heard_and_error_dbfs(&rendered(&kit, events, rate, 0.8));
        println!("{heard:.1} dBFS, error {error:.1} dBFS, {:.1}", heard - error);
        prop_assert!(is_right(heard, error), "{heard:.1} dBFS, error {error:.1} dBFS");
    }

    /// The kit has any room, and strikes with silence between them.
    #[test]
    fn room_has_90_db_of_snr_to_its_twin_or_an_inaudible_error(
        room in any_room(),
        times in prop::collection::vec((0u64..200_000, 0.05f32..=1.0, 0usize..5), 1..5),
        rate in any_rate(),
    ) {
        let kit = kit::Kit { room, ..filters() };
        let mut events: Vec<Event> =
            times.into_iter().map(|(frame, velocity, pad)| event(Action::Strike, pad, frame, velocity)).collect();
        events.sort_by_key(|event| event.time.frame);
        let (heard, error) = heard_and_error_dbfs(&rendered(&kit, events, rate, 0.8));
        println!("{heard:.1} dBFS, error {error:.1} dBFS, {:.1}", heard - error);
        // A room as loud as the dry sound doubles the power of an error of -120 dBFS.
        prop_assert!(heard - error >= 90.0 || error < -117.0, "{heard:.1} dBFS, error {error:.1} dBFS");
    }

    /// The kit has any biquads, and any strikes and hands.
    #[test]
    fn biquads_have_86_db_of_snr_to_the_reference_or_an_inaudible_error(
        biquads in any_biquads(),
        times in prop::collection::vec((0u64..30_000, 0.05f32..=1.0, 0usize..8), 1..8),
        rate in any_rate(),
    ) {
        let mut kit = filters();
        kit.pads.truncate(1);
        kit.objects[0].modes.clear();
        (kit.objects[0].dynamic_filter, kit.objects[0].biquads) = (None, Some(biquads));
        let events = hands(times);
        let (heard, error) = heard_and_error_dbfs(&rendered(&kit, events, rate, 0.8));
        println!("{heard:.1} dBFS, error {error:.1} dBFS, {:.1}", heard - error);
        prop_assert!(heard - error >= 86.0 || error < -120.0, "{heard:.1} dBFS, error {error:.1} dBFS");
    }
}
