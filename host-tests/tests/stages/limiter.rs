//! The limiter: its ceiling, its silence, and its independence of the caller's blocks.

use dsp_core::SampleRate;
use dsp_core::engine::{Engine, Plan, Setup};
use dsp_core::event::Event;
use dsp_core::fixed::ONE_Q27;
use dsp_core::limiter::Limiter;
use dsp_core::table::Kit;
use dsp_core::time::TICK_FRAMES;
use host_tests::lent;
use host_tests::on_chip::scenes::{pads, strikes};
use proptest::prelude::*;

const RATE: SampleRate = SampleRate::HZ_48000;

/// Sound of a limiter for whole ticks, cut into runs of at most `run` frames.
fn limited(sound: &[[i32; 2]], ceiling_db: f32, run: usize) -> Vec<[i32; 2]> {
    let mut limiter = Limiter::new(ceiling_db, RATE);
    let mut out = sound.to_vec();
    for tick in out.chunks_mut(TICK_FRAMES) {
        let mut frame = 0;
        for run in tick.chunks_mut(run) {
            limiter.render(frame, run);
            frame += run.len();
        }
    }
    out
}

fn ceiling(db: f32) -> f64 {
    f64::from(ONE_Q27) * 10f64.powf(f64::from(db) / 20.0)
}

proptest! {
    #[test]
    fn no_sample_exceeds_the_ceiling_and_runs_change_no_bit(
        peaks in prop::collection::vec((0u32..=31, any::<u64>()), 4..40),
        ceiling_db in -40.0f32..=0.0,
        run in 1usize..=32,
    ) {
        let mut sound = Vec::new();
        for (bits, seed) in peaks {
            let mut state = seed | 1;
            for _ in 0..TICK_FRAMES {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                sound.push([(state >> 32) as i32 >> (31 - bits), (state as i32) >> (31 - bits)]);
            }
        }
        let out = limited(&sound, ceiling_db, TICK_FRAMES);
        let largest = out.iter().flatten().map(|x| x.unsigned_abs()).max().unwrap();
        prop_assert!(f64::from(largest) <= ceiling(ceiling_db), "{largest}");
        prop_assert_eq!(limited(&sound, ceiling_db, run), out);
    }
}

#[test]
fn sound_below_the_ceiling_comes_out_bit_for_bit_two_ticks_later() {
    let sound: Vec<_> = (0..3200).map(|n| [n * 1000 - 1_600_000, 7 - n * 900]).collect();
    let out = limited(&sound, -20.0, TICK_FRAMES);
    assert_eq!(out[2 * TICK_FRAMES..], sound[..sound.len() - 2 * TICK_FRAMES]);
    assert!(out[..2 * TICK_FRAMES].iter().all(|frame| *frame == [0; 2]));
}

#[test]
fn the_gain_returns_to_one_within_two_seconds_of_a_peak() {
    let mut sound = vec![[1_000_001, -1_000_001]; 96_000];
    sound[100] = [i32::MAX, i32::MIN];
    let out = limited(&sound, -6.0, TICK_FRAMES);
    assert!(out[150][0] < 500_000, "the gain falls before the peak leaves: {:?}", out[150]);
    let back = out.iter().rposition(|frame| *frame != sound[0]).unwrap();
    println!("the gain is 1 again {:.2} s after the peak", (back - 100) as f64 / 48_000.0);
    assert!(back < 96_000 - 1, "the gain is not back at the end");
    // The largest step between frames is 1/32 of the gain's way.
    let step = out[64..].windows(2).filter(|pair| pair[0][0].abs() < 2_000_000 && pair[1][0].abs() < 2_000_000);
    let step = step.map(|pair| (pair[1][0] - pair[0][0]).abs()).max().unwrap();
    assert!(f64::from(step) <= 1_000_001.0 / 32.0 + 1.0, "{step}");
}

fn render(kit: &Kit<'_>, ceiling_db: Option<f32>, events: &[Event], frames: usize, block: usize) -> Vec<[i32; 2]> {
    let setup = Setup { ceiling_db, room_samples: lent::ROOM_SAMPLES, ..Setup::new(RATE) };
    let words = Plan::of::<i16>(kit, setup).unwrap().words;
    let mut engine = Engine::<i16>::new(kit, setup, lent::memory(words)).unwrap();
    assert_eq!(engine.words(), words);
    let mut out = vec![[0; 2]; frames];
    let mut start = 0;
    for block in out.chunks_mut(block) {
        let end = start + block.len() as u64;
        let now: Vec<_> =
            events.iter().filter(|event| (start..end).contains(&event.time.first_frame())).copied().collect();
        engine.render(&now, None, block).unwrap();
        start = end;
    }
    out
}

#[test]
fn pads_struck_together_stay_below_the_ceiling_of_an_engine() {
    let scene = pads(8);
    let kit = Kit::parse(&scene.binary).unwrap();
    let events = strikes(8, 5, 1.0);
    let free = render(&kit, None, &events, 48_000, 128);
    let peak = |sound: &[[i32; 2]]| sound.iter().flatten().map(|x| f64::from(x.unsigned_abs())).fold(0.0, f64::max);
    let ceiling_db = (20.0 * (peak(&free) / 8_388_608.0).log10() - 12.0) as f32;
    let out = render(&kit, Some(ceiling_db), &events, 48_000, 128);
    println!(
        "peak {:.1} dBFS, with the ceiling at {ceiling_db:.1}: {:.1}",
        20.0 * (peak(&free) / 8_388_608.0).log10(),
        20.0 * (peak(&out) / 8_388_608.0).log10()
    );
    assert!(peak(&out) <= 8_388_608.0 * 10f64.powf(f64::from(ceiling_db) / 20.0) + 1.0);
    assert!(peak(&out) > 0.7 * 8_388_608.0 * 10f64.powf(f64::from(ceiling_db) / 20.0));
    assert_eq!(render(&kit, Some(ceiling_db), &events, 48_000, 37), out);
}
