//! Scenes to which the budget's prediction is fitted, and by which it is judged.

use dsp_core::event::{Action, Event, Time};
use dsp_core::resonator::TICK_FRAMES;
use dsp_core::scrape::Motion;

use super::scenes::{choked_pads, pads, pads_of, pads_with_positions, strikes};
use crate::scrape::Scrapes;

/// Scene that is played one tick at a time.
#[derive(Clone, Debug)]
pub struct BudgetScene {
    /// Name of the scene.
    pub name: &'static str,
    /// Kit of the scene in its binary form.
    pub kit: Vec<u8>,
    /// Events of the scene.
    pub events: Vec<Event>,
    /// Force on pad 0, as long as the scene.
    pub direct: Option<Vec<i32>>,
    /// Length in ticks.
    pub ticks: usize,
    /// Budget in cycles a tick.
    pub budget: u32,
}

impl BudgetScene {
    /// Events and force of a tick.
    pub fn tick(&self, tick: usize) -> (Vec<Event>, Option<&[i32]>) {
        let frames = (tick * TICK_FRAMES) as u64..((tick + 1) * TICK_FRAMES) as u64;
        let now = self.events.iter().filter(|event| frames.contains(&event.time.first_frame())).copied();
        (now.collect(), self.direct.as_ref().map(|force| &force[tick * TICK_FRAMES..][..TICK_FRAMES]))
    }
}

/// Strikes on every pad at full velocity, every 5 ms, `times` times.
pub fn storm(pads: usize, times: u64) -> Vec<Event> {
    (0..times).flat_map(|n| strikes(pads, n * 240, 1.0)).collect()
}

/// Strikes, then chokes, then releases of every pad, 13 frames apart, so that some share a tick.
pub fn hands_on(pads: u8) -> Vec<Event> {
    let mut events = strikes(pads.into(), 5, 0.8);
    for (frame, action) in [(1_000, Action::Choke), (1_900, Action::Release)] {
        let at = |pad: u8| Time::at_frame(frame + 13 * u64::from(pad));
        events.extend((0..pads).map(|pad| Event { time: at(pad), pad, action, ..Event::NOTHING }));
    }
    events
}

/// Two strikes on every pad at two positions within one contact, four times.
pub fn at_two_places(pads: u8) -> Vec<Event> {
    let strike = |frame: u64, position: f32, pad: u8| Event {
        time: Time::at_frame(frame),
        velocity: 0.8,
        position,
        pad,
        ..Event::default()
    };
    let pair = |n: u64, pad: u8| [strike(400 * n + 8, 0.1, pad), strike(400 * n + 40, 0.8, pad)];
    let mut events: Vec<Event> = (0..4).flat_map(|n| (0..pads).flat_map(move |pad| pair(n, pad))).collect();
    events.sort_by_key(|event| event.time);
    events
}

/// Touch of a striker on pad 0, its motion in each of `ticks` ticks, and its lift. The speed swings
/// between 0 and `speed` m/s, the normal force between 0.1 and 1 N.
pub fn rubbed(striker: u8, rolls: bool, speed: f32, ticks: usize) -> Vec<Event> {
    let event = |tick: usize, action| Event {
        time: Time::at_frame((tick * TICK_FRAMES) as u64),
        striker,
        position: 0.5,
        action,
        ..Event::NOTHING
    };
    let moved = |tick: usize| {
        let turn = tick as f32 * 0.05;
        let velocity_m_per_s = [speed * turn.sin(), 0.0];
        event(tick, Action::Move(Motion { velocity_m_per_s, normal_n: 0.55 + 0.45 * (0.7 * turn).cos() }))
    };
    let mut events = vec![event(0, Action::Touch { rolls, normal_n: [0.1, 1.0] })];
    events.extend((0..ticks).map(moved));
    events.push(event(ticks, Action::Lift));
    events
}

/// Scenes without a limit, by which the predicted costs are compared with the modelled ones.
///
/// # Panics
/// If the demo kit that ships with the project is broken.
pub fn unlimited() -> Vec<BudgetScene> {
    let demo = kit::open("demo").expect("the demo kit ships with the project");
    let all = demo.kit.pads.len();
    let scene = |name, kit: &[u8], events, ticks| BudgetScene {
        name,
        kit: kit.to_vec(),
        events,
        direct: None,
        ticks,
        budget: u32::MAX,
    };
    let force = (0..80 * TICK_FRAMES).map(|n| ((n as f64 * 0.37).sin() * 2e6) as i32).collect();
    let choke = Event { time: Time::at_frame(900), pad: 1, action: Action::Choke, ..Event::NOTHING };
    let scrapes = Scrapes::new();
    let [(mug, stick), (bowl, ball), (drum, _)] =
        [("mug", "stick"), ("bowl", "ball"), ("drum", "pen")].map(|(pad, striker)| scrapes.alone(pad, striker));
    let mut hands = strikes(all, 5, 0.6);
    hands.push(choke);
    vec![
        scene("silence", &demo.binary, Vec::new(), 20),
        scene("one strike of the demo kit", &demo.binary, strikes(1, 5, 0.8), 120),
        scene("every pad of the demo kit", &demo.binary, strikes(all, 5, 0.8), 120),
        scene("every pad of the demo kit, one choked", &demo.binary, hands, 60),
        BudgetScene { direct: Some(force), ..scene("direct drive", &demo.binary, Vec::new(), 80) },
        scene("four pads of 64 modes", &pads(4).binary, strikes(4, 5, 0.8), 100),
        scene("eight pads of 64 modes", &pads(8).binary, strikes(8, 5, 0.8), 100),
        scene("eight pads of 64 modes, struck thrice", &pads(8).binary, storm(8, 3), 60),
        scene("four pads of 64 modes, choked and released", &choked_pads(4).binary, hands_on(4), 100),
        scene("four pads of 64 modes, struck at two places", &pads_with_positions(4).binary, at_two_places(4), 60),
        scene("mug, scraped slowly", &mug, rubbed(stick as u8, false, 0.3, 150), 170),
        scene("mug, scraped fast", &mug, rubbed(stick as u8, false, 2.5, 150), 170),
        scene("bowl, rolled over", &bowl, rubbed(ball as u8, true, 0.4, 150), 200),
        scene("drum, scraped", &drum, rubbed(stick as u8, false, 0.8, 150), 170),
    ]
}

/// Budget of 80 % of 168 MHz at 48 kHz, in cycles a tick.
pub const STORM_BUDGET: u32 = 89_600;

/// Scene in which every pad is struck at full velocity every 5 ms: 1024 modes, 80 % of 168 MHz.
pub fn storm_scene(pads: usize) -> BudgetScene {
    BudgetScene {
        name: "storm",
        kit: pads_of(pads, 16 / pads).binary,
        events: storm(pads, 12),
        direct: None,
        ticks: 100,
        budget: STORM_BUDGET,
    }
}

/// Scene of four pads of the demo kit, each struck 28 times a second at any frame of a tick.
///
/// `budget` is in cycles a tick.
///
/// # Panics
/// If the demo kit that ships with the project is broken.
pub fn playing_scene(budget: u32) -> BudgetScene {
    let demo = kit::open("demo").expect("the demo kit ships with the project");
    let strike = |n: u64, pad: u64| Event {
        time: Time::at_frame(320 + n * 1680 + pad * 144 + (n * 7 + pad * 11) % 32),
        velocity: 0.9,
        pad: pad as u8,
        ..Event::default()
    };
    BudgetScene {
        name: "four pads played",
        kit: demo.binary,
        events: (0..5).flat_map(|n| (0..4).map(move |pad| strike(n, pad))).collect(),
        direct: None,
        ticks: 280,
        budget,
    }
}

/// All scenes: those of [`unlimited`], two storms, and two played scenes.
pub fn all() -> Vec<BudgetScene> {
    let mut scenes = unlimited();
    scenes.extend([storm_scene(8), storm_scene(4), playing_scene(33_000), playing_scene(50_000)]);
    scenes
}
