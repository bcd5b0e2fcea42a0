//! Every pad of the demo kit, compared with the reference.

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::{Event, Time};
use host_tests::performance::{instrument, largest_difference, reference, snr_db};
use malleus::render::Performance;

const RATE: SampleRate = SampleRate::HZ_48000;

fn demo() -> kit::Loaded {
    kit::open("demo").expect("the shipped kit is valid")
}

/// Strikes from soft to hard, at several positions, between samples, with every striker of the pad.
fn strikes(kit: &kit::Kit, pad: usize) -> Vec<Event> {
    let strikers = kit.pads[pad].strikers.len();
    [(0.02, 0.0), (0.9, 0.3), (1.0, 1.0), (0.4, 0.77), (0.15, 0.5), (0.7, 0.1)]
        .into_iter()
        .enumerate()
        .map(|(index, (velocity, position))| Event {
            time: Time { frame: 100 + index as u64 * 7_001, fraction: (index as u32).wrapping_mul(0x6000_0001) },
            pad: pad as u8,
            velocity,
            position,
            striker: (index % strikers) as u8,
            ..Event::default()
        })
        .collect()
}

#[test]
fn impacts_on_every_pad_leave_at_least_103_db_to_the_reference_on_the_bus() {
    let loaded = demo();
    for (index, pad) in loaded.kit.pads.iter().enumerate() {
        let performance = Performance::new(strikes(&loaded.kit, index), None, &loaded.kit, RATE, Some(3.0));
        let (bus, reports) = instrument(&loaded, &performance, RATE, Skipping::Off);
        let expected = reference(&loaded, &performance, RATE);
        let snr = snr_db(&expected, &bus);
        println!("{}: {snr:.1} dB", pad.name);
        assert!(snr >= 103.0, "{}: {snr:.1} dB", pad.name);
        assert!(reports.iter().all(|report| report.decayed_mode_frames + report.unstruck_mode_frames == 0));
    }
}

#[test]
fn skipping_keeps_the_retirement_rule() {
    let loaded = demo();
    for (index, pad) in loaded.kit.pads.iter().enumerate() {
        let performance = Performance::new(strikes(&loaded.kit, index), None, &loaded.kit, RATE, None);
        let (all, _) = instrument(&loaded, &performance, RATE, Skipping::Off);
        let (skipped, reports) = instrument(&loaded, &performance, RATE, Skipping::On);
        let difference = largest_difference(&all, &skipped);
        println!("{}: {:.1} dBFS", pad.name, 20.0 * difference.log10());
        assert!(difference < 1e-5, "{}: {difference}", pad.name);
        assert!(reports.iter().all(|report| report.retired_amplitude < 1e-5));
        let retired: u32 = reports.iter().map(|report| report.retired_modes).sum();
        assert!(retired > 0, "{}: nothing retired", pad.name);
    }
}
