//! Scenes by which the budget's prediction is fitted and judged.

use dsp_core::event::{Action, Event, Time};
use dsp_core::resonator::TICK_FRAMES;

use super::scenes::{choked_pads, pads, pads_of, pads_with_positions, strikes};

/// A scene, played a tick a call.
#[derive(Clone, Debug)]
pub struct BudgetScene {
    /// Its name.
    pub name: &'static str,
    /// A kit, binary.
    pub kit: Vec<u8>,
    /// Events and forces of the scene.
    pub events: Vec<Event>,
    /// A force for pad 0, as long as the scene.
    pub direct: Option<Vec<i32>>,
    /// Length in ticks.
    pub ticks: usize,
    /// Cycles a tick.
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

/// Every pad at full velocity, again every 5 ms.
pub fn storm(pads: usize, times: u64) -> Vec<Event> {
    (0..times).flat_map(|n| strikes(pads, n * 240, 1.0)).collect()
}

/// Every pad struck, choked and released, one after the other, some of them in one tick.
pub fn hands_on(pads: u8) -> Vec<Event> {
    let mut events = strikes(pads.into(), 5, 0.8);
    for (frame, action) in [(1_000, Action::Choke), (1_900, Action::Release)] {
        let at = |pad: u8| Time::at_frame(frame + 13 * u64::from(pad));
        events.extend((0..pads).map(|pad| Event { time: at(pad), pad, action, ..Event::NOTHING }));
    }
    events
}

/// Every pad struck at two places within a contact, four times.
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

/// The bench's scenes, without a limit: what they cost is to be predicted.
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
    ]
}

/// 80 % of 168 MHz at 48 kHz, cycles a tick.
pub const STORM_BUDGET: u32 = 89_600;

/// Every pad struck at full velocity, again every 5 ms, 1024 modes, 80 % of 168 MHz.
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

/// Four pads of the demo kit, struck 28 times a second each wherever in a tick it falls, at so many
/// cycles a tick.
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

/// All of them.
pub fn all() -> Vec<BudgetScene> {
    let mut scenes = unlimited();
    scenes.extend([storm_scene(8), storm_scene(4), playing_scene(33_000), playing_scene(50_000)]);
    scenes
}
