//! Hands: chokes and releases against the reference, under the budgets of the boards, and their
//! effect on other sounds.

use boards::{BlackpillF411, Board, Stm32f407gDisc1};
use dsp_core::SampleRate;
use dsp_core::engine::{CostItem, Setup, Skipping};
use dsp_core::event::{Action, Event, Time};
use dsp_core::table::Kit as KitView;
use host_tests::performance::{self, reference, snr_db};
use host_tests::scene::{hand, load, mode, one_pad, strike};
use host_tests::sweeps::hands::{CHOKE, play_from};
use host_tests::sweeps::{self, Extent};
use kit::Mode;
use malleus::render::instrument::{Output, Settings};
use malleus::render::{Performance, instrument};
use proptest::prelude::*;

const RATE: SampleRate = SampleRate::HZ_48000;

fn snr_to_the_reference(loaded: &kit::Loaded, events: Vec<Event>) -> f64 {
    let performance = Performance::new(events, None, &loaded.kit, RATE, Some(0.4));
    let (bus, _) = performance::instrument(loaded, &performance, RATE, Skipping::Off);
    snr_db(&reference(loaded, &performance, RATE), &bus)
}

#[test]
fn a_choke_and_its_release_keep_the_last_two_samples_of_each_mode() {
    // The mode lies below fs/12. It is choked so fast that its phase would show any other decay.
    let mut kit = one_pad(vec![mode(120.0, 2.0, 300.0, 200.0)]);
    kit.pads[0].choke_t60_s = 0.02;
    let loaded = load(kit);
    let events = vec![strike(0, 1.0), hand(1_500, Action::Choke), strike(1_700, 1.0), hand(1_900, Action::Release)];
    let snr = snr_to_the_reference(&loaded, events);
    println!("{snr:.1} dB");
    assert!(snr >= 120.0, "{snr:.1} dB");
}

fn ringing_modes() -> impl Strategy<Value = Vec<Mode>> {
    let any = (0.0f64..1.0, 0.02f64..3.0, -1.0f64..1.0, -1.0f64..1.0);
    prop::collection::vec(any, 1..80).prop_map(|modes| {
        let of = |(place, t60_s, sine, cosine): (f64, f64, f64, f64)| {
            mode(40.0 * 590f64.powf(place), t60_s, 100.0 * sine, 100.0 * cosine)
        };
        // The last mode is never silent.
        modes.into_iter().map(of).chain([mode(700.0, 0.5, 100.0, 0.0)]).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, max_shrink_iters: 100, ..ProptestConfig::default() })]

    #[test]
    fn hands_at_any_time_on_any_table_play_as_the_law_says(
        modes in ringing_modes(),
        of_striker in ringing_modes(),
        choke_t60_s in 0.005f32..0.5,
        mut frames in prop::collection::vec(0u64..6_000, 8),
    ) {
        let mut kit = one_pad(modes);
        (kit.pads[0].choke_t60_s, kit.pads[0].striker_weight) = (choke_t60_s, 0.3);
        kit.strikers[0].modes = of_striker;
        let loaded = load(kit);
        frames.sort_unstable();
        let mut events = vec![strike(0, 1.0)];
        for (index, &frame) in frames.iter().enumerate() {
            events.push(match index % 3 {
                0 => hand(frame, Action::Choke),
                1 => strike(frame, 0.9),
                _ => hand(frame, Action::Release),
            });
        }
        let snr = snr_to_the_reference(&loaded, events);
        prop_assert!(snr >= 96.0, "{snr:.1} dB");
    }
}

#[test]
fn any_shipped_pad_is_choked_and_released_without_click_and_shedding() {
    sweeps::hands::every_pad(Extent::Tenth);
}

/// Fall in dB of the demo kit's bell within 60 ms of a choke, and the number of groups that a
/// budget left out.
fn choked_bell<B: Board>() -> (f64, u32) {
    let loaded = kit::open("demo").expect("the kit ships with the project");
    let view = KitView::parse(&loaded.binary).expect("it is valid");
    let bell = loaded.kit.pads.iter().position(|pad| pad.name == "bell").expect("the kit has a bell") as u8;
    let events = [
        Event { pad: bell, ..strike(0, 0.8) },
        Event { pad: bell, time: Time::at_frame(CHOKE), action: Action::Choke, ..Event::NOTHING },
    ];
    // The smaller board has no time for the strike itself beside the kit's stages.
    let played = play_from::<B>(&view, &events, CHOKE - 64);
    let rms_db = |from: usize| {
        let part = &played.sound[from..from + 960];
        10.0 * (part.iter().flatten().map(|x| x * x).sum::<f64>() / 1920.0).log10()
    };
    (rms_db(CHOKE as usize - 960) - rms_db(CHOKE as usize + 1_920), played.shed_groups)
}

#[test]
fn a_choked_bell_of_the_demo_kit_falls_by_its_t60_under_a_boards_budget() {
    for (board, (fall_db, shed_groups)) in [
        (Stm32f407gDisc1::NAME, choked_bell::<Stm32f407gDisc1>()),
        (BlackpillF411::NAME, choked_bell::<BlackpillF411>()),
    ] {
        println!("{board}: {fall_db:.1} dB in 60 ms, {shed_groups} groups shed");
        // The middles of the two parts are 50 to 60 ms apart, in which 60 dB in 0.25 s make 12 dB.
        assert!(shed_groups == 0 && (9.0..18.0).contains(&fall_db), "{board}: {fall_db:.1} dB, {shed_groups} groups");
    }
}

/// A choke or a release of each of the demo kit's pads at a frame.
fn hands_on_all_pads(frame: u64, action: Action) -> impl Iterator<Item = Event> {
    let pads = kit::open("demo").expect("the kit ships with the project").kit.pads.len() as u8;
    (0..pads).map(move |pad| Event { pad, ..hand(frame, action) })
}

#[test]
fn hands_on_all_silent_pads_change_no_bit_of_a_strike_that_follows() {
    let loaded = kit::open("demo").expect("the kit ships with the project");
    let play_with = |mut events: Vec<Event>, direct: Option<(u8, Vec<i32>)>| {
        events.sort_by_key(|event| event.time.frame);
        let performance = Performance::new(events, direct, &loaded.kit, RATE, Some(0.1));
        performance::instrument(&loaded, &performance, RATE, Skipping::On).0
    };
    let play = |events: Vec<Event>| play_with(events, None);
    for pad in 0..loaded.kit.pads.len() as u8 {
        for frame in [40, 100, 230, 400] {
            let strike = Event { pad, ..strike(frame, 0.8) };
            let hands = [(5, Action::Choke), (150, Action::Release)];
            let on_all = hands.into_iter().flat_map(|(frame, action)| hands_on_all_pads(frame, action));
            let on_one = hands.map(|(frame, action)| Event { pad, ..hand(frame, action) });
            let (all, one) =
                (play(on_all.chain([strike]).collect()), play(on_one.into_iter().chain([strike]).collect()));
            assert!(all == one, "pad {pad}, struck at frame {frame}");
        }
    }
    // No hand waits while a direct force is given.
    let force: Vec<i32> = (0..4_800).map(|n| if n < 64 { 0 } else { (n - 64) * 20_000 % 9_000_000 }).collect();
    let with_force = |hands: Vec<Event>| play_with(hands, Some((10, force.clone())));
    let on_one = vec![Event { pad: 10, ..hand(5, Action::Choke) }];
    assert!(with_force(hands_on_all_pads(5, Action::Choke).collect()) == with_force(on_one), "a direct force");
}

#[test]
fn hands_on_all_silent_pads_at_each_tick_take_a_fifth_of_the_smaller_boards_budget() {
    let loaded = kit::open("demo").expect("the kit ships with the project");
    let view = KitView::parse(&loaded.binary).expect("it is valid");
    let actions = [Action::Choke, Action::Release].into_iter().cycle();
    let events: Vec<Event> =
        (0..120).zip(actions).flat_map(|(tick, action)| hands_on_all_pads(32 * tick + 5, action)).collect();
    let performance = Performance::new(events, None, &loaded.kit, RATE, Some(0.1));
    let budget = BlackpillF411::BUDGET_CYCLES;
    let settings = Settings { setup: Setup::new(RATE), block: 32, budget_cycles: Some(budget) };
    let mut dearest = 0;
    instrument::render(&view, &performance, settings, Output::Samples24, |report| {
        dearest = dearest.max(report.predicted_cycles());
    })
    .expect("the kit fits");
    println!("{dearest} of {budget} cycles");
    assert!(dearest <= budget / 5, "{dearest} of {budget} cycles");
}

#[test]
fn no_tick_of_the_demo_piece_with_a_hand_is_planned_beyond_its_budget() {
    // The budget is 80 % of 168 MHz. The piece chokes pads while others ring.
    const BUDGET: u32 = 89_600;
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../tables/demo-piece.csv");
    let loaded = kit::open("demo").expect("the kit ships with the project");
    let view = KitView::parse(&loaded.binary).expect("it is valid");
    let events = malleus::events::read(&path, &view, RATE).expect("the piece is valid").events;
    let hands = events.iter().filter(|event| matches!(event.action, Action::Choke | Action::Release)).count();
    let performance = Performance::new(events, None, &loaded.kit, RATE, Some(1.0));
    let settings = Settings { setup: Setup::new(RATE), block: 32, budget_cycles: Some(BUDGET) };
    let (mut dearest, mut held, mut shed_groups) = ((0, 0), 0, 0);
    instrument::render(&view, &performance, settings, Output::Samples24, |report| {
        dearest = dearest.max((report.predicted_cycles(), report.frame));
        if report.counts.of(CostItem::ChokedMode) > 0 {
            held = held.max(report.predicted_cycles());
            shed_groups += report.shed.groups;
        }
        if report.shed.groups > 0 {
            println!("{} groups shed at frame {}: {:?}", report.shed.groups, report.frame, report.counts.all());
        }
    })
    .expect("the kit fits");
    println!("{hands} hands: {held} of {BUDGET} cycles, {shed_groups} groups shed; dearest tick of all {dearest:?}");
    assert!(hands > 0 && held > 0 && held <= BUDGET && shed_groups == 0, "{held} cycles, {shed_groups} groups shed");
}
