//! What each board's budget leaves of strikes on the demo kit, alone and in pairs.

use boards::{BlackpillF411, Board, Stm32f407gDisc1};
use dsp_core::event::{Event, Time};
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
    let mut most = vec![0; kit.pads().len()];
    let last = strikes.iter().map(|strike| strike.0).max().unwrap_or(0) / TICK_FRAMES as u64;
    for tick in 0..last + TICKS_BEHIND {
        let now = strikes.iter().filter(|strike| strike.0 / TICK_FRAMES as u64 == tick);
        let event = |&(frame, pad)| Event { time: Time::at_frame(frame), pad, velocity: 0.8, ..Event::default() };
        let events: Vec<Event> = now.map(event).collect();
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
    assert_eq!(of_disc1, [[55, 52, 1], [110, 100, 0], [110, 110, 0]]);
    let of_blackpill = [0, 48, 384].map(|gap| in_pairs::<BlackpillF411>(&kit, &modes, gap));
    assert_eq!(of_blackpill, [[55, 7, 24], [110, 32, 76], [110, 66, 18]]);
}
