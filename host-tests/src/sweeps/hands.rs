//! Sweep of hands: chokes and releases of every shipped pad, under the budgets of the boards.

use boards::{BlackpillF411, Board, Stm32f407gDisc1};
use dsp_core::engine::{CYCLES, CostItem};
use dsp_core::event::{Action, Event};
use dsp_core::table::Kit as KitView;
use kit::Loaded;

use super::Extent;
use crate::lent;
use crate::scene::{hand, load, strike};

/// Sound of a board's engine in 24 bits, and the omissions of its budget.
#[derive(Clone, Debug)]
pub struct Played {
    /// Samples, 1.0 = full scale.
    pub sound: Vec<[f64; 2]>,
    /// Number of register groups that the budget left out.
    pub shed_groups: u32,
    /// Predicted cycles of the dearest tick with a hand on a pad, and the part that hands take.
    dearest: (u32, u32),
}

fn play<B: Board>(view: &KitView<'_>, events: &[Event]) -> Played {
    play_from::<B>(view, events, 0)
}

/// Plays events on the engine of a board, whose budget holds from frame `limited_from` on.
///
/// # Panics
/// If the board refuses the kit or an event.
pub fn play_from<B: Board>(view: &KitView<'_>, events: &[Event], limited_from: u64) -> Played {
    let mut engine = B::engine(view, lent::memory(B::WORDS), &mut |_| {}).expect("the board plays the kit");
    let (mut sound, mut rest) = (Vec::new(), events);
    let (mut shed_groups, mut dearest) = (0, (0, 0));
    while sound.len() < FRAMES {
        let end = engine.now() + 32;
        engine.set_budget((engine.now() >= limited_from).then_some(B::BUDGET_CYCLES));
        let due = rest.iter().take_while(|event| event.time.first_frame() < end).count();
        let mut block = [[0; 2]; 32];
        engine
            .render_observed(&rest[..due], None, &mut block, |report| {
                shed_groups += report.shed.groups;
                let hands = report.counts.of(CostItem::ChokedMode) * CYCLES[CostItem::ChokedMode as usize];
                if hands > 0 {
                    dearest = dearest.max((report.predicted_cycles(), hands));
                }
            })
            .expect("the events are valid");
        sound.extend(block.map(|frame| frame.map(|x| f64::from(x) / f64::from(1 << 23))));
        rest = &rest[due..];
    }
    Played { sound, shed_groups, dearest }
}

const FRAMES: usize = 9_600;
/// Frame of the choke: contacts are over by then.
pub const CHOKE: u64 = 3_200;
/// Frame of the release.
const RELEASE: u64 = 6_400;

/// Largest difference of neighbouring samples around a frame.
fn largest_step(sound: &[[f64; 2]], frame: u64) -> f64 {
    let near = &sound[frame as usize - 160..frame as usize + 320];
    let steps = near.windows(2).flat_map(|pair| [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]]);
    steps.fold(0.0, |largest, step| largest.max(step.abs()))
}

/// Chokes and releases every pad of a kit while all others ring, at `phases` within a tick.
///
/// Steps are not judged if `has_noise` is true.
fn choke_every_pad<B: Board>(name: &str, loaded: &Loaded, has_noise: bool, phases: &[u64]) {
    let (mut loudest_step, mut dearest_share) = (f64::NEG_INFINITY, 0.0f64);
    let view = KitView::parse(&loaded.binary).expect("it is valid");
    let strikes: Vec<Event> =
        (0..loaded.kit.pads.len()).map(|pad| Event { pad: pad as u8, ..strike(10 + 96 * pad as u64, 0.8) }).collect();
    let free = play::<B>(&view, &strikes);
    for pad in 0..loaded.kit.pads.len() as u8 {
        for &phase in phases {
            let at = |frame: u64, action| Event { pad, ..hand(frame + phase, action) };
            let mut events = strikes.clone();
            events.extend([at(CHOKE, Action::Choke), at(RELEASE, Action::Release)]);
            let held = play::<B>(&view, &events);
            let place = format!("{name}, {}, pad {pad}, phase {phase}", B::NAME);
            for frame in [CHOKE + phase, RELEASE + phase] {
                let step = largest_step(&held.sound, frame) - largest_step(&free.sound, frame);
                loudest_step = loudest_step.max(step);
                assert!(has_noise || step <= 3.2e-5, "{place}, {frame}: {step}");
            }
            assert!(held.shed_groups <= free.shed_groups, "{place}: {} groups", held.shed_groups);
            assert!(held.dearest.0 <= B::BUDGET_CYCLES, "{place}: {:?} cycles", held.dearest);
            dearest_share = dearest_share.max(f64::from(held.dearest.0) / f64::from(B::BUDGET_CYCLES));
        }
    }
    println!(
        "{name}, {}: {} groups shed by the strikes, largest step beyond the free ring {loudest_step:e}, dearest tick with a hand {:.1} % of the budget",
        B::NAME,
        free.shed_groups,
        100.0 * dearest_share
    );
}

/// Chokes and releases every pad of every shipped kit on both boards.
///
/// No hand may click, shed modes or exceed the budget.
///
/// # Panics
/// If a limit is broken.
pub fn every_pad(extent: Extent) {
    let every: Vec<u64> = (0..32).collect();
    let phases = extent.pick(&[0, 13][..], &every[..]);
    let shipped = |name: &str| kit::open(name).expect("the kit ships with the project");
    let mut modes_alone = shipped("recorded").kit;
    modes_alone.objects.iter_mut().for_each(|object| object.residual = None);
    // Noise has steps of its own: the residuals of the kit `recorded`, and the filters of the last.
    let kits = [
        ("demo", shipped("demo"), false),
        ("recorded without residuals", load(modes_alone), false),
        ("recorded", shipped("recorded"), true),
        ("filters", shipped("filters"), true),
    ];
    for (name, loaded, has_noise) in &kits {
        choke_every_pad::<Stm32f407gDisc1>(name, loaded, *has_noise, phases);
        choke_every_pad::<BlackpillF411>(name, loaded, *has_noise, phases);
    }
}
