//! The measured force of an impact hammer: every pad against the law, and the mug against its microphone.

use dsp_core::engine::Skipping;
use host_tests::data;
use host_tests::performance::{instrument, largest_difference, law, snr_db};
use malleus::render::Performance;
use malleus::wave::{Force, read_force};

const RECORDING: &str = "hammer/hammer_ceramic.wav";
/// The hit on the mug that its table was fitted to, in seconds.
const HIT_S: f64 = 0.4047;

fn demo() -> kit::Loaded {
    kit::open("demo").expect("the shipped kit is valid")
}

fn channel(channel: u16) -> Option<Force> {
    data::find(RECORDING).map(|path| read_force(&path, channel).expect("the recording is readable"))
}

#[test]
fn the_measured_force_on_every_pad_leaves_at_least_90_db_to_the_law() {
    let Some(force) = channel(1) else { return };
    let loaded = demo();
    for (index, pad) in (0u8..).zip(&loaded.kit.pads) {
        let direct = Some((index, force.samples.clone()));
        let performance = Performance::new(Vec::new(), direct, &loaded.kit, force.rate, Some(2.0));
        let (bus, _) = instrument(&loaded, &performance, force.rate, Skipping::Off);
        let expected = law(&loaded, &performance, force.rate);
        let snr = snr_db(&expected, &bus);
        let (skipped, reports) = instrument(&loaded, &performance, force.rate, Skipping::On);
        let difference = largest_difference(&bus, &skipped);
        println!("{}: {snr:.1} dB, skipping {:.1} dBFS", pad.name, 20.0 * difference.log10());
        assert!(snr >= 90.0, "{}: {snr:.1} dB", pad.name);
        assert!(difference < 1e-5, "{}: {difference}", pad.name);
        assert!(reports.iter().all(|report| report.retired_amplitude < 1e-5));
    }
}

/// What is left of `microphone` without the best fit of `sound` at the best delay, in dB.
fn residual_db(microphone: &[f64], sound: &[f64], longest_delay: usize) -> (f64, usize) {
    let frames = microphone.len().min(sound.len() - longest_delay);
    let energy: f64 = microphone[..frames].iter().map(|x| x * x).sum();
    (0..longest_delay)
        .map(|delay| {
            let delayed = &sound[longest_delay - delay..][..frames];
            let cross: f64 = microphone.iter().zip(delayed).map(|(x, y)| x * y).sum();
            let own: f64 = delayed.iter().map(|y| y * y).sum();
            (10.0 * (1.0 - cross * cross / (own * energy)).log10(), delay)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .expect("there is a delay")
}

#[test]
fn the_mug_under_its_measured_force_leaves_at_most_minus_26_db_of_the_microphone() {
    const LONGEST_DELAY: usize = 64;
    let (Some(microphone), Some(force)) = (channel(0), channel(1)) else { return };
    let loaded = demo();
    let mug = (0u8..).zip(&loaded.kit.pads).find(|(_, pad)| pad.name == "mug").expect("the kit has a mug").0;
    let rate = force.rate;
    let frame = |seconds: f64| (seconds * rate.hz()).round() as usize;
    // The hit alone: its force from 3 ms before the peak, and 0.3 s of sound.
    let (begin, length) = (frame(HIT_S - 0.003), frame(0.3));
    let hit = force.samples[begin..begin + length].to_vec();
    let microphone: Vec<f64> = microphone.samples[begin..begin + length].iter().map(|&x| f64::from(x)).collect();
    let performance = Performance::new(Vec::new(), Some((mug, hit)), &loaded.kit, rate, Some(0.1));
    let (bus, _) = instrument(&loaded, &performance, rate, Skipping::On);
    for (name, sound) in [("reference", law(&loaded, &performance, rate)), ("dsp-core", bus)] {
        let mut mono = vec![0.0; LONGEST_DELAY];
        mono.extend(sound.iter().map(|frame| frame[0] + frame[1]));
        let (residual, delay) = residual_db(&microphone, &mono, LONGEST_DELAY);
        println!("{name}: {residual:.2} dB of residual at a delay of {delay} samples");
        assert!(residual <= -26.0, "{name}: {residual:.2} dB");
    }
}
