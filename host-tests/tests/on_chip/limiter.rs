//! The limiter on the virtual core: bits equal to the PC's, and its cycles.

use dsp_core::SampleRate;
use dsp_core::engine::{Engine, Plan, Setup};
use dsp_core::limiter::TICK_CYCLES;
use dsp_core::table::Kit;
use dsp_core::time::TICK_FRAMES;
use host_tests::lent;
use host_tests::on_chip::EngineOnChip;
use host_tests::on_chip::scenes::{pads, strikes};

const RATE: SampleRate = SampleRate::HZ_48000;
const CEILING_DB: f32 = -30.0;

/// Sound of 40 ticks on the chip, and nominal cycles of each tick.
fn play(ceiling_db: Option<f32>) -> (Vec<[i32; 2]>, Vec<u64>) {
    let mut chip = EngineOnChip::new().unwrap();
    if let Some(ceiling_db) = ceiling_db {
        chip.set_ceiling(ceiling_db).unwrap();
    }
    chip.load(&pads(4).binary, RATE).unwrap();
    let (mut sound, mut cycles) = (Vec::new(), Vec::new());
    for tick in 0..40 {
        let events = if tick == 2 { strikes(4, 70, 1.0) } else { Vec::new() };
        let (block, call) = chip.render(&events, None, TICK_FRAMES).unwrap();
        sound.extend(block);
        cycles.push(call.cost.nominal);
    }
    (sound, cycles)
}

#[test]
fn the_limiter_has_the_bits_of_the_pc_and_keeps_its_cycles() {
    let (free, without) = play(None);
    let (limited, with) = play(Some(CEILING_DB));
    let loaded = pads(4);
    let kit = Kit::parse(&loaded.binary).unwrap();
    let (ceiling_db, frame_cycles) = (Some(CEILING_DB), Some(lent::FRAME_CYCLES));
    let setup = Setup { ceiling_db, frame_cycles, room_samples: lent::ROOM_SAMPLES, ..Setup::new(RATE) };
    let words = Plan::of::<i16>(&kit, setup).unwrap().words;
    let mut engine = Engine::<i16>::new(&kit, setup, lent::memory(words)).unwrap();
    let mut expected = vec![[0; 2]; limited.len()];
    engine.render(&strikes(4, 70, 1.0), None, &mut expected).unwrap();
    assert_eq!(limited, expected);
    assert_ne!(limited[64..], free[..free.len() - 64], "the ceiling is below the peak");
    let dearest = with.iter().zip(&without).skip(3).map(|(with, without)| with.saturating_sub(*without)).max().unwrap();
    println!("a tick of the limiter: at most {dearest} cycles, the budget counts {TICK_CYCLES}");
    assert!(dearest <= u64::from(TICK_CYCLES) && u64::from(TICK_CYCLES) <= dearest * 5 / 4);
    assert_eq!(with[1], without[1], "silence costs nothing");
}
