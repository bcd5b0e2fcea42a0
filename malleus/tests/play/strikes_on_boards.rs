//! What each board's budget leaves of strikes on the demo kit, alone and in pairs.

use boards::{BlackpillF411, Board, Stm32f407gDisc1};
use dsp_core::event::{Action, Event, Time};
use dsp_core::memory::{Memory, Word};
use dsp_core::table::Kit;
use dsp_core::time::TICK_FRAMES;

/// Frame at the beginning of a tick by which the board is idle.
const FROM: u64 = 10 * TICK_FRAMES as u64;

/// Number of ticks behind the last strike: contacts are over by then.
const TICKS_BEHIND: u64 = 40;

/// Plays strikes of velocity 0.8, each a frame and a pad, on a silent board. Returns the largest
/// number of modes that each pad left out.
fn left_out<B: Board>(kit: &Kit<'_>, strikes: &[(u64, u8)]) -> Vec<usize> {
    let [mut fast, mut bulk] = [B::WORDS.fast, B::WORDS.bulk].map(|words| vec![Word::uninit(); words]);
    let mut engine = B::engine(kit, Memory::new(&mut fast, &mut bulk), &mut |_| {}).unwrap();
    engine.set_budget(Some(B::BUDGET_CYCLES));
    let (mut most, mut postponed) = (vec![0; kit.pads().len()], Vec::new());
    let last = strikes.iter().map(|strike| strike.0).max().unwrap_or(0) / TICK_FRAMES as u64;
    for tick in 0..last + TICKS_BEHIND {
        let now = strikes.iter().filter(|strike| strike.0 / TICK_FRAMES as u64 == tick);
        let event = |&(frame, pad)| Event { time: Time::at_frame(frame), pad, velocity: 0.8, ..Event::default() };
        let mut events: Vec<Event> = postponed.into_iter().chain(now.map(event)).collect();
        engine.postpone(&mut events, None);
        let end = (tick + 1) * TICK_FRAMES as u64;
        postponed = events.split_off(events.iter().take_while(|event| event.time.frame < end).count());
        engine.render(&events, None, &mut [[0; 2]; TICK_FRAMES]).unwrap();
        most.iter_mut().zip(0..).for_each(|(most, pad)| *most = engine.shed_mode_count(pad).max(*most));
    }
    most
}

/// Returns for each pad of the demo kit its number of modes, the number of the 32 places in a tick
/// at which a strike has all modes, and the most modes that are left out.
fn alone<B: Board>(kit: &Kit<'_>) -> Vec<(usize, usize, usize)> {
    let pads = 0..kit.pads().len() as u8;
    let of_pad = |pad: u8| {
        let [mut fast, mut bulk] = [B::WORDS.fast, B::WORDS.bulk].map(|words| vec![Word::uninit(); words]);
        let engine = B::engine(kit, Memory::new(&mut fast, &mut bulk), &mut |_| {}).unwrap();
        let modes = engine.mode_count(pad.into());
        let left = (FROM..FROM + TICK_FRAMES as u64).map(|frame| left_out::<B>(kit, &[(frame, pad)])[usize::from(pad)]);
        let left: Vec<usize> = left.collect();
        println!("{}: pad {pad} of {modes} modes leaves out {left:?}", B::NAME);
        (modes, left.iter().filter(|&&left| left == 0).count(), left.into_iter().max().unwrap_or(0))
    };
    pads.map(of_pad).collect()
}

/// Returns the number of pairs of pads, of those with all modes, and of those in which a pad loses
/// all modes; the second pad is struck `gap` frames behind the first.
fn in_pairs<B: Board>(kit: &Kit<'_>, modes: &[usize], gap: u64) -> [usize; 3] {
    let pads = kit.pads().len() as u8;
    let [mut pairs, mut whole, mut silent] = [0; 3];
    for (first, second) in (0..pads).flat_map(|first| (0..pads).map(move |second| (first, second))) {
        if first == second || gap == 0 && second < first {
            continue;
        }
        let left = left_out::<B>(kit, &[(FROM + 10, first), (FROM + 10 + gap, second)]);
        let of = |pad: u8| (left[usize::from(pad)], modes[usize::from(pad)]);
        pairs += 1;
        whole += usize::from([first, second].map(of).iter().all(|&(left, _)| left == 0));
        silent += usize::from([first, second].map(of).iter().any(|&(left, all)| left == all));
    }
    println!("{}, {gap} frames apart: {pairs} pairs, {whole} whole, {silent} with a silent pad", B::NAME);
    [pairs, whole, silent]
}

/// The figures are those of docs/hardware.md.
#[test]
fn strikes_on_boards_are_never_silent_alone_and_in_pairs_as_the_page_says() {
    let demo = kit::open("demo").unwrap();
    let kit = Kit::parse(&demo.binary).unwrap();
    let places = TICK_FRAMES;
    let (disc1, blackpill) = (alone::<Stm32f407gDisc1>(&kit), alone::<BlackpillF411>(&kit));
    assert!(disc1.iter().all(|&(_, whole, _)| whole == places), "{disc1:?}");
    assert!(blackpill.iter().all(|&(modes, _, left)| left < modes), "{blackpill:?}");
    let whole: Vec<usize> = blackpill.iter().map(|pad| pad.1).collect();
    assert_eq!(whole, [32, 32, 32, 32, 32, 32, 14, 32, 32, 32, 32]);
    let modes: Vec<usize> = disc1.iter().map(|pad| pad.0).collect();
    let of_disc1 = [0, 48, 384].map(|gap| in_pairs::<Stm32f407gDisc1>(&kit, &modes, gap));
    let of_blackpill = [0, 48, 384].map(|gap| in_pairs::<BlackpillF411>(&kit, &modes, gap));
    assert_eq!(of_disc1, [[55, 52, 1], [110, 100, 0], [110, 110, 0]]);
    assert_eq!(of_blackpill, [[55, 42, 2], [110, 84, 5], [110, 66, 18]]);
}

#[test]
fn strikes_without_time_wait_for_a_few_ticks_at_most_and_events_keep_their_order() {
    type B = BlackpillF411;
    let demo = kit::open("demo").unwrap();
    let kit = Kit::parse(&demo.binary).unwrap();
    let event =
        |frame, pad, action| Event { time: Time::at_frame(frame), pad, velocity: 0.8, action, ..Event::default() };
    let asked = [
        event(FROM, 6, Action::Strike),
        event(FROM + 40, 2, Action::Strike),
        event(FROM + 41, 2, Action::Choke),
        event(FROM + 42, 0, Action::Strike),
    ];
    let happened = |budget: Option<u32>| {
        let [mut fast, mut bulk] = [B::WORDS.fast, B::WORDS.bulk].map(|words| vec![Word::uninit(); words]);
        let mut engine = B::engine(&kit, Memory::new(&mut fast, &mut bulk), &mut |_| {}).unwrap();
        engine.set_budget(budget);
        let (mut waiting, mut happened) = (asked.to_vec(), Vec::new());
        while !waiting.is_empty() {
            engine.postpone(&mut waiting, None);
            let end = engine.now() + TICK_FRAMES as u64;
            let later = waiting.split_off(waiting.iter().take_while(|event| event.time.frame < end).count());
            engine.render(&waiting, None, &mut [[0; 2]; TICK_FRAMES]).unwrap();
            happened.append(&mut waiting);
            waiting = later;
        }
        happened
    };
    assert_eq!(happened(None), asked, "nothing waits without a budget");
    assert_eq!(happened(Some(1_000_000)), asked, "nothing waits where there is time");
    let late = happened(Some(12_000));
    println!("{:?}", late.iter().map(|event| event.time.frame).collect::<Vec<u64>>());
    let kinds = |events: &[Event]| events.iter().map(|event| (event.pad, event.action)).collect::<Vec<_>>();
    assert_eq!(kinds(&late), kinds(&asked));
    assert_eq!(late[0], asked[0], "a strike at a tick's first frame on a silent board does not wait");
    // To the tick's end, and for four ticks; the last one for as long again.
    assert!(late[1].time.frame > asked[1].time.frame && late[1].time.frame <= FROM + 64 + 4 * 32, "{late:?}");
    assert!(late[3].time.frame <= late[1].time.frame + 5 * 32, "{late:?}");
}
