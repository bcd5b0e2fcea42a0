//! The engine with residuals and background: idle cost, chokes, block sizes, refusals.

use dsp_core::SampleRate;
use dsp_core::engine::{Engine, LoadError, Plan, Setup, Skipping, Stage, TickReport};
use dsp_core::event::{Action, Event};
use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::Kit as KitView;
use host_tests::lent;
use host_tests::scene::{hand, load, mode, one_pad, strike};
use kit::{Background, Kit, Loaded, Residual};

fn residual(decay_db_per_s: f32) -> Residual {
    let edges_hz: Vec<f32> = (0..21).map(|edge| 200.0 + 1_000.0 * edge as f32).collect();
    Residual { seed: 4, edges_hz, weight: vec![0.01; 20], decay_db_per_s: vec![decay_db_per_s; 20] }
}

fn background() -> Background {
    Background { seed: 1, edges_hz: vec![100.0, 1_000.0, 10_000.0], weight: vec![0.003, 0.001] }
}

fn noisy(decay_db_per_s: f32) -> Kit {
    let mut kit = one_pad(vec![mode(440.0, 0.05, 0.001, 0.0)]);
    kit.objects[0].residual = Some(residual(decay_db_per_s));
    kit
}

/// Sound and reports in blocks of `block` frames.
fn play(loaded: &Loaded, events: &[Event], frames: usize, block: usize) -> (Vec<[i32; 2]>, Vec<TickReport>) {
    let kit = KitView::parse(&loaded.binary).expect("a right kit");
    let mut engine = lent::engine(&kit, SampleRate::HZ_48000, Skipping::On).expect("it can be played");
    let (mut out, mut reports, mut events) = (vec![[0; 2]; frames], Vec::new(), events);
    for chunk in out.chunks_mut(block) {
        let end = engine.now() + chunk.len() as u64;
        let due = events.iter().take_while(|event| event.time.first_frame() < end).count();
        engine.render_bus(&events[..due], None, chunk, |report| reports.push(*report)).expect("right events");
        events = &events[due..];
    }
    (out, reports)
}

fn power(sound: &[[i32; 2]]) -> f64 {
    sound.iter().flatten().map(|&x| (f64::from(x) / 2f64.powi(27)).powi(2)).sum::<f64>() / sound.len() as f64
}

#[test]
fn nothing_is_computed_before_the_first_strike_nor_after_the_last_tail() {
    let (sound, reports) = play(&load(noisy(300.0)), &[strike(4_800, 1.0)], 72_000, 128);
    let is_idle = |report: &TickReport| {
        (report.residual_frames, report.background_frames, report.residuals, report.ringing_pads) == (0, 0, 0, 0)
    };
    assert!(reports[..150].iter().all(is_idle) && sound[..4_800].iter().all(|frame| *frame == [0, 0]));
    assert!(reports[150..300].iter().all(|report| report.residual_frames == TICK_FRAMES as u32));
    // At 300 dB/s, 80 dB take a quarter of a second; the last noise frames come after that.
    let end = 1_200;
    assert!(reports[end..].iter().all(is_idle) && sound[end * 32..].iter().all(|frame| *frame == [0, 0]));
}

#[test]
fn a_kit_without_background_costs_none_and_one_with_it_sounds_from_the_start_on() {
    let (_, reports) = play(&load(noisy(300.0)), &[], 9_600, 128);
    assert!(reports.iter().all(|report| report.background_frames == 0 && report.residuals == 0));
    let mut kit = noisy(300.0);
    kit.background = Some(background());
    let (sound, reports) = play(&load(kit), &[], 96_000, 128);
    assert!(reports.iter().all(|report| report.background_frames == 32 && report.residual_frames == 0));
    // A background in the middle has half its power on each side, and equal sides.
    let db = 10.0 * (power(&sound[9_600..]) / (0.003f64.powi(2) + 0.001f64.powi(2))).log10();
    assert!(db.abs() < 0.5, "{db:.2} dB");
    assert!(sound.iter().all(|[left, right]| (left - right).abs() <= 1));
}

#[test]
fn the_block_size_cannot_change_a_bit() {
    let mut kit = noisy(150.0);
    kit.background = Some(background());
    let loaded = load(kit);
    let events = [
        strike(3, 1.0),
        strike(40, 0.3),
        strike(1_999, 0.8),
        hand(5_000, Action::Choke),
        hand(5_555, Action::Release),
        strike(5_600, 0.5),
    ];
    let (whole, reports) = play(&loaded, &events, 12_000, 12_000);
    for block in [1, 7, 32, 100, 1_024] {
        let (sound, same) = play(&loaded, &events, 12_000, block);
        // The bits and the sounding stages must be equal. The number of driven frames may differ,
        // because it depends on the cuts of a tick.
        let noise = |reports: &[TickReport]| -> Vec<[u32; 3]> {
            reports.iter().map(|tick| [tick.residual_frames, tick.background_frames, tick.residuals]).collect()
        };
        assert!(sound == whole && noise(&reports) == noise(&same), "blocks of {block}");
    }
}

#[test]
fn a_hand_on_the_pad_takes_its_residual_away() {
    let mut kit = noisy(20.0);
    kit.pads[0].choke_t60_s = 0.1;
    let loaded = load(kit);
    let ringing = play(&loaded, &[strike(0, 1.0)], 48_000, 128).0;
    let choked = play(&loaded, &[strike(0, 1.0), hand(9_600, Action::Choke)], 48_000, 128).0;
    assert!(ringing[..9_600] == choked[..9_600]);
    let fallen_db = |from: usize| 10.0 * (power(&choked[from..from + 480]) / power(&ringing[from..from + 480])).log10();
    // The hand takes 600 dB/s.
    let (early, late) = (fallen_db(9_600 + 2_160), fallen_db(9_600 + 4_560));
    assert!((early + 30.0).abs() < 4.0 && (late + 60.0).abs() < 4.0, "{early:.1} dB, {late:.1} dB");
    // After a release the next strike sounds as before.
    let events = [strike(0, 1.0), hand(9_600, Action::Choke), hand(24_000, Action::Release), strike(24_000, 1.0)];
    let again = play(&loaded, &events, 48_000, 128).0;
    let db = 10.0 * (power(&again[24_000..28_800]) / power(&ringing[..4_800])).log10();
    assert!(db.abs() < 1.0, "{db:.2} dB");
}

#[test]
fn noise_that_the_rate_or_the_memory_does_not_hold_is_refused_by_name() {
    let binary = |kit: &Kit| kit::binary::build(kit).expect("a right kit");
    let mut kit = noisy(100.0);
    kit.objects[0].residual.as_mut().expect("it has one").edges_hz[20] = 23_000.0;
    let bytes = binary(&kit);
    let view = KitView::parse(&bytes).expect("a right kit");
    let error = lent::engine(&view, SampleRate::HZ_44100, Skipping::On).expect_err("22 050 Hz is Nyquist");
    assert!(matches!(error, LoadError::BeyondNyquist { stage: Stage::Residual(0), .. }));
    assert_eq!(
        error.to_string(),
        "pad 0, residual of its object: edges_hz = 23000: must be at most 22050 Hz at 44100 Hz; leave out the bands above"
    );
    assert!(lent::engine(&view, SampleRate::HZ_48000, Skipping::On).is_ok());

    let setup = Setup::new(SampleRate::HZ_48000);
    let two = words(&view, setup);
    let pad = kit.pads[0].clone();
    kit.pads.push(kit::Pad { name: "second".into(), ..pad });
    let bytes = binary(&kit);
    let view = KitView::parse(&bytes).expect("a right kit");
    let error = Engine::<i16>::new(&view, setup, lent::memory(two)).expect_err("two do not fit the memory of one");
    assert!(matches!(error, LoadError::Memory { .. }), "{error}");
    assert!(error.to_string().contains("bytes of memory are missing"), "{error}");
}

fn words(view: &KitView<'_>, setup: Setup) -> dsp_core::memory::Words {
    Plan::of::<i16>(view, setup).expect("it can be played").words
}

#[test]
fn a_residual_takes_24_kb_and_a_kit_without_takes_none_of_it() {
    let bytes = |kit: Kit| {
        let loaded = load(kit);
        let view = KitView::parse(&loaded.binary).expect("a right kit");
        words(&view, Setup::new(SampleRate::HZ_48000)).bytes()
    };
    let without =
        bytes(Kit { objects: vec![kit::Object { residual: None, ..noisy(1.0).objects[0].clone() }], ..noisy(1.0) });
    let with = bytes(noisy(1.0)) - without;
    println!("a residual of 20 bands takes {with} bytes");
    assert!((20_000..24_500).contains(&with), "{with}");
}
