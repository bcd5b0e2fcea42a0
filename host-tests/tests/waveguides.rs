//! Banded waveguides against `f64`: long loops, stability, blocks of any size, silence.

use dsp_core::SampleRate;
use dsp_core::dynamic_filter::{Breakpoint, Filter, Path};
use dsp_core::noise::Sfc32;
use dsp_core::waveguide::{Loop, LoopError, Waveguides};
use host_tests::snr::snr_db;

type Guides = Waveguides<4, 10, 4096>;

const RATE: reference::SampleRate = reference::SampleRate { numerator: 48_000, denominator: 1 };

fn gain_at(point: &Breakpoint, hz: f64) -> f64 {
    let omega = std::f64::consts::TAU * hz / 48_000.0;
    let of = |c0: f64, c1: f64| (c0 + c1 * omega.cos()).hypot(c1 * omega.sin());
    of(point.b0, point.b1) / of(1.0, point.a1)
}

/// Eq. 22 with the smallest p for a delay of a tick at least.
fn delay_s(point: &Breakpoint, hz: f64) -> f64 {
    let omega = std::f64::consts::TAU * hz / 48_000.0;
    let of = |c0: f64, c1: f64| (-c1 * omega.sin()).atan2(c0 + c1 * omega.cos());
    let phase = of(point.b0, point.b1) - of(1.0, point.a1);
    let turns = ((32.0 * omega - phase) / std::f64::consts::TAU).ceil();
    (phase + std::f64::consts::TAU * turns) / omega / 48_000.0
}

/// A short burst of noise, then a filter that stays.
fn path() -> Vec<Breakpoint> {
    let point = |time_s, b0: f64, a1| Breakpoint { time_s, b0, b1: b0, a1, a2: 0.0, b2: 0.0 };
    vec![point(0.0, 0.25, -0.5), point(0.02, 0.25, -0.5)]
}

/// Loops at frequencies in Hz that ring with a T60: per pass of d frames, `γ |F| = 10^(-3 d / (fs T60))`, the band's own delay counted.
fn bands(hz: &[f64], t60_s: f64) -> Vec<Loop> {
    let last = path()[1];
    hz.iter()
        .map(|&frequency_hz| {
            let bandwidth_hz = 4.0;
            // A band-pass of Δf delays by 1/(π Δf) at its middle.
            let pass_s = 32.0 / 48_000.0 + 1.0 / (std::f64::consts::PI * bandwidth_hz);
            let gain = 10f64.powf(-3.0 * pass_s / t60_s) / gain_at(&last, frequency_hz);
            Loop { frequency_hz, bandwidth_hz, gain, delay_s: delay_s(&last, frequency_hz) }
        })
        .collect()
}

fn guides(bands: &[Loop]) -> Result<Guides, LoopError> {
    let path = path();
    let filter = Filter::new(Path::new(path.iter().copied(), SampleRate::HZ_48000).unwrap(), 9, 9);
    Guides::new(filter, path.iter().copied(), bands.iter().copied(), SampleRate::HZ_48000)
}

#[test]
fn loops_that_ring_for_twenty_seconds_keep_ninety_db() {
    let bands = bands(&[110.0, 700.0, 1234.5, 3000.0, 7777.0], 20.0);
    let mut ours = guides(&bands).unwrap();
    let mut out = vec![0; 48_000 * 10];
    ours.strike(1.0);
    ours.render(None, &mut out);
    let mut generator = Sfc32::new(9, 9);
    let mut input: Vec<f64> = (0..480)
        .flat_map(|_| {
            let word = generator.draw();
            [word >> 16, word & 0xffff].map(|half| f64::from(half as u16 as i16) * 4096.0)
        })
        .collect();
    input.resize(out.len(), 0.0);
    let loops: Vec<reference::waveguide::Loop> = bands
        .iter()
        .map(|band| {
            let (delay, biquad) = band.derive(0, SampleRate::HZ_48000).unwrap();
            let denominator = [-2.0 * biquad.pole.real, biquad.pole.square()];
            reference::waveguide::Loop {
                delay,
                band: reference::biquad::Biquad { numerator: biquad.numerator, denominator },
            }
        })
        .collect();
    let same = |&Breakpoint { time_s, b0, b1, a1, .. }: &Breakpoint| reference::dynamic_filter::Breakpoint {
        time_s,
        b0,
        b1,
        a1,
    };
    let theirs: Vec<_> = path().iter().map(same).collect();
    let exact = reference::waveguide::filter(&theirs, &loops, &input, RATE);
    // From the end of the burst on, where the loops are alone.
    let (whole, ringing) = (snr_db(&exact, &out), snr_db(&exact[4800..], &out[4800..]));
    let level = |s: &[f64]| 20.0 * (s.iter().fold(0.0f64, |peak, x| peak.max(x.abs())) / 134_217_728.0).log10();
    println!(
        "whole {whole:.1} dB, ringing alone {ringing:.1} dB; {:.1} dBFS at 1 s, {:.1} dBFS at 9 s",
        level(&exact[48_000..96_000]),
        level(&exact[432_000..])
    );
    assert!(whole >= 90.0, "{whole}");
    // They do ring: 60 dB in some 20 s.
    assert!(level(&exact[432_000..]) > level(&exact[48_000..96_000]) - 40.0);
}

#[test]
fn unstable_and_impossible_loops_are_refused_by_name() {
    let band =
        |frequency_hz, gain| Loop { frequency_hz, bandwidth_hz: 3.0, gain, delay_s: delay_s(&path()[1], 1000.0) };
    let limit = 1.0 / gain_at(&path()[1], 1000.0);
    assert!(guides(&[band(1000.0, limit * 0.999)]).is_ok());
    for gain in [limit * 1.001, -limit * 1.001, 50.0] {
        assert!(matches!(guides(&[band(1000.0, gain)]), Err(LoopError::Unstable { .. })), "{gain}");
    }
    assert!(matches!(guides(&[band(500.0, 0.1), band(24_000.0, 0.1)]), Err(LoopError::Band { index: 1 })));
    assert!(matches!(guides(&[band(f64::NAN, 0.1)]), Err(LoopError::Band { index: 0 })));
    assert!(matches!(guides(&[band(500.0, f64::NAN)]), Err(LoopError::Band { index: 0 })));
    let long = Loop { delay_s: 0.2, ..band(5.0, 0.1) };
    assert!(matches!(guides(&[long]), Err(LoopError::Room { needed: 9600, .. })));
    assert!(matches!(guides(&[band(500.0, 0.1); 11]), Err(LoopError::Room { needed: 11, room: 10 })));
}

#[test]
fn blocks_change_no_bit_and_all_falls_silent() {
    let new = || guides(&bands(&[220.0, 900.0, 5000.0], 2.0)).unwrap();
    let (mut whole, mut cut) = (new(), new());
    for strike in 0..8usize {
        let frames = [1000, 31, 4097, 500][strike % 4];
        let (mut expected, mut got) = (vec![0; frames], vec![0; frames]);
        whole.strike((strike + 1) as f32 / 8.0);
        cut.strike((strike + 1) as f32 / 8.0);
        whole.render(None, &mut expected);
        let mut at = 0;
        while at < frames {
            let end = (at + [1, 32, 7, 100][at % 4]).min(frames);
            cut.render(None, &mut got[at..end]);
            at = end;
        }
        assert_eq!(got, expected, "strike {strike}");
        assert!(got.iter().any(|&word| word != 0));
    }
    let mut tail = vec![0; 48_000 * 8];
    whole.render(None, &mut tail);
    assert!(!whole.is_ringing());
    tail.fill(0);
    whole.render(None, &mut tail);
    assert!(tail.iter().all(|&word| word == 0));
}
