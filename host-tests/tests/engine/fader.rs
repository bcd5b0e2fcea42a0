//! Level and silence of the whole sound: against the reference, in the caller's blocks, and what
//! remains.

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::{Action, Event, Time};
use host_tests::performance::{instrument, reference, snr_db};
use host_tests::scene::{hand, load, mode, one_pad, play, strike};
use malleus::render::Performance;

use crate::frames::thing;

const RATE: SampleRate = SampleRate::HZ_48000;
/// Frame of the order of silence.
const ORDER: u64 = 9_610;
/// Frames of 5 ms.
const LIMIT: usize = 240;

fn silence(frame: u64) -> Event {
    hand(frame, Action::Silence)
}

fn level(frame: u64, level: f32) -> Event {
    Event { time: Time::at_frame(frame), velocity: level, action: Action::Level, ..Event::default() }
}

/// Strike on a pad.
fn struck(pad: u8, frame: u64) -> Event {
    Event { pad, ..strike(frame, 0.9) }
}

/// Kit of one pad with modes in the bank.
fn small() -> kit::Kit {
    one_pad((1..=20).map(|n| mode(180.0 * f64::from(n), 1.5, 500.0, 200.0)).collect())
}

/// Kits that sound by every stage: bank, frames, residual, filters, biquads, loops, room.
fn kits() -> Vec<(&'static str, kit::Loaded)> {
    let mut frames = thing(1025, 2);
    frames.pads[0].choke_t60_s = 0.1;
    let mut demo = kit::open("demo").unwrap().kit;
    demo.room = vec![kit::RoomBand::new(0.0, 0.8, -12.0), kit::RoomBand::new(800.0, 0.5, -15.0)];
    let mut recorded = kit::open("recorded").unwrap().kit;
    recorded.background = None;
    let filters = kit::open("filters").unwrap().kit;
    vec![
        ("bank", load(small())),
        ("frames", load(frames)),
        ("demo in a room", load(demo)),
        ("recorded", load(recorded)),
        ("filters", load(filters)),
    ]
}

#[test]
fn all_sound_ends_as_exact_zeros_within_5_ms_and_does_not_come_back() {
    for (name, loaded) in kits() {
        let pads = loaded.kit.pads.len() as u8;
        let mut events: Vec<_> = (0..pads).map(|pad| struck(pad, 9_000 + u64::from(pad))).collect();
        events.extend([hand(9_300, Action::Choke), silence(ORDER)]);
        let (sound, reports) = play(&loaded, RATE, Skipping::On, &events, None, (24_000, &[128]));
        let last = sound.iter().rposition(|frame| *frame != [0; 2]).unwrap();
        let loud = sound[..ORDER as usize].iter().flatten().map(|x| x.unsigned_abs()).max().unwrap();
        // The fade is a line: no step is larger than that of the sound and its share of the line.
        let end = &sound[ORDER as usize - 1..last + 2];
        let step = end.windows(2).map(|pair| pair[0][0].abs_diff(pair[1][0])).max().unwrap();
        let before = &sound[ORDER as usize - 500..ORDER as usize];
        let usual = before.windows(2).map(|pair| pair[0][0].abs_diff(pair[1][0])).max().unwrap();
        println!(
            "{name}: silent {} frames behind the order, peak {loud}, largest step {step}, before {usual}",
            last + 1 - ORDER as usize
        );
        assert!(loud > 1 << 18 && last + 1 - ORDER as usize <= LIMIT, "{name}: {last}");
        assert!(step <= usual + loud / 100, "{name}: a step of {step}");
        let after = &reports[(ORDER as usize + 2 * LIMIT) / 32];
        assert_eq!((after.ringing_pads, after.residuals, after.filters, after.contacts), (0, 0, 0, 0), "{name}");
    }
}

/// In frames the turns of retirement go on while nothing sounds, which changes bits below -100
/// dBFS.
#[test]
fn a_strike_after_silence_sounds_as_on_a_new_engine() {
    let mut frames = thing(1025, 1);
    frames.pads[0].choke_t60_s = 0.1;
    for (name, loaded) in [("bank", load(small())), ("frames", load(frames))] {
        // Blocks of frames have 256: the strikes lie at the same place in one.
        let again = ORDER + 7 * 256;
        let events = [strike(100, 0.9), strike(8_000, 1.0), silence(ORDER), strike(again, 0.7)];
        let sound = play(&loaded, RATE, Skipping::On, &events, None, (24_000, &[64])).0;
        let new = play(&loaded, RATE, Skipping::On, &events[3..], None, (24_000, &[64])).0;
        assert!(sound[again as usize..].iter().any(|frame| frame[0].abs() > 1 << 18));
        let differs = |(a, b): (&[i32; 2], &[i32; 2])| a[0].abs_diff(b[0]).max(a[1].abs_diff(b[1]));
        let most = sound.iter().zip(&new).skip(again as usize).map(differs).max().unwrap();
        println!("{name}: differs by up to {most} of 2^27");
        // 2^27 is full scale: 1300 is -100 dBFS.
        assert!(most <= if name == "bank" { 0 } else { 1300 }, "{name}: {most}");
    }
}

#[test]
fn strikes_during_the_end_begin_behind_it_and_all_agrees_with_the_reference() {
    let mut frames = thing(300, 3);
    frames.pads[0].choke_t60_s = 0.1;
    for (name, kit, least) in [("bank", small(), 96.0), ("frames", frames, 110.0)] {
        let loaded = load(kit);
        let events = vec![
            strike(100, 0.9),
            level(3_000, 0.3),
            level(3_500, 0.8),
            strike(5_000, 0.5),
            silence(ORDER),
            strike(ORDER + 5, 0.6),
            strike(ORDER + 150, 0.4),
            strike(ORDER + 700, 0.4),
            level(ORDER + 2_000, 1.0),
            silence(ORDER + 4_000),
            hand(ORDER + 4_010, Action::Choke),
            strike(ORDER + 6_000, 0.9),
        ];
        let performance = Performance::new(events, None, &loaded.kit, RATE, Some(0.3));
        let bus = instrument(&loaded, &performance, RATE, Skipping::Off).0;
        let snr = snr_db(&reference(&loaded, &performance, RATE), &bus);
        println!("{name}: SNR {snr:.1} dB");
        assert!(snr >= least, "{name}: {snr:.1} dB");
    }
}

#[test]
fn levels_and_silence_give_equal_bits_in_blocks_of_any_length() {
    let (_, demo) = kits().remove(2);
    let mut events = vec![struck(0, 10), level(700, 0.25), struck(1, 1_203), silence(2_000), struck(2, 2_050)];
    events.extend([level(2_100, 0.5), struck(3, 3_000), silence(3_017), struck(4, 3_018), level(5_000, 0.0)]);
    let whole = play(&demo, RATE, Skipping::On, &events, None, (8_000, &[8_000])).0;
    assert!(whole[6_000..] == vec![[0; 2]; 2_000], "level 0 is exact silence");
    for blocks in [&[1usize][..], &[8], &[33], &[128], &[1_000], &[7, 300, 1]] {
        let sound = play(&demo, RATE, Skipping::On, &events, None, (8_000, blocks)).0;
        assert!(sound == whole, "blocks of {blocks:?}");
    }
}

#[test]
fn level_1_changes_no_bit() {
    let (_, demo) = kits().remove(2);
    let events = [struck(0, 10), level(400, 1.0), struck(3, 500)];
    let sound = play(&demo, RATE, Skipping::On, &events, None, (8_000, &[64])).0;
    let plain = play(&demo, RATE, Skipping::On, &[events[0], events[2]], None, (8_000, &[64])).0;
    assert!(sound == plain);
}
