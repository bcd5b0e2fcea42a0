//! Conversion of biquads to modes and back, and to another rate.

use dsp_core::SampleRate;
use dsp_core::biquad::{Biquad, BiquadError, ModalForm, Partial, Root};
use host_tests::biquads::{FULL_SCALE, bank};
use host_tests::snr::{Random, snr_db};

fn impulse(frames: usize) -> Vec<f64> {
    let mut impulse = vec![0.0; frames];
    impulse[0] = 1.0;
    impulse
}

/// Impulse response of a chain in `f64`.
fn response(chain: &[Biquad], frames: usize) -> Vec<f64> {
    let plain = |biquad: &Biquad| reference::biquad::Biquad {
        numerator: biquad.numerator,
        denominator: [-2.0 * biquad.pole.real, biquad.pole.square()],
    };
    reference::biquad::filter(&[chain.iter().map(plain).collect()], &impulse(frames))
}

#[test]
fn a_mode_is_a_biquad_and_comes_back() {
    let rate = SampleRate::HZ_48000;
    for (frequency_hz, decay_per_s, sine, cosine) in
        [(55.0, 0.4, 3.0, 0.0), (440.0, 7.0, -2.0, 5.0), (15_000.0, 60.0, 0.0, 1.0)]
    {
        let mode = Partial { frequency_hz, decay_per_s, sine, cosine };
        let biquad = mode.to_biquad(rate);
        let form = ModalForm::of(&[biquad], rate).unwrap();
        let got = form.modes[0];
        let largest = sine.abs().max(cosine.abs());
        assert!((got.frequency_hz / frequency_hz - 1.0).abs() < 1e-9, "{got:?}");
        assert!((got.decay_per_s / decay_per_s - 1.0).abs() < 1e-9, "{got:?}");
        assert!((got.sine - sine).abs() < 1e-9 * largest && (got.cosine - cosine).abs() < 1e-9 * largest, "{got:?}");
        assert!(form.direct.abs() < 1e-9 * largest, "{}", form.direct);
        // An impulse through the bank must ring as the mode does.
        let mut force = vec![0; 9600];
        force[0] = 1 << 27;
        let mut out = vec![0; force.len()];
        let loud = Biquad { numerator: biquad.numerator.map(|b| b * 20_000.0), ..biquad };
        bank(&[loud], 1, 1).unwrap().render(Some(&force), &mut out);
        let exact: Vec<f64> = (0..out.len())
            .map(|n| {
                let (time, half) = (n as f64 / 48_000.0, if n == 0 { 0.5 } else { 1.0 });
                let phase = std::f64::consts::TAU * frequency_hz * time;
                let size = (-decay_per_s * time).exp() * half * 20_000.0 / 48_000.0 * FULL_SCALE;
                size * (sine * phase.sin() + cosine * phase.cos())
            })
            .collect();
        let snr = snr_db(&exact, &out);
        println!("{frequency_hz} Hz: {snr:.1} dB");
        assert!(snr >= 90.0, "{frequency_hz} Hz: {snr} dB");
    }
}

#[test]
fn a_chain_is_the_sum_of_its_modes_and_what_goes_straight_through() {
    let rate = SampleRate::HZ_48000;
    let mut random = Random::new(11);
    let mut worst = 0.0f64;
    for depth in 1..=4 {
        for _ in 0..20 {
            let chain: Vec<Biquad> = (0..depth)
                .map(|index| {
                    let pole =
                        Root::polar(random.between(0.9, 0.999), 0.1 + 0.7 * (index as f64 + random.between(0.0, 0.8)));
                    Biquad::from_roots(pole, Root::polar(random.between(0.0, 1.0), random.between(0.0, 3.1)), 0.5)
                })
                .collect();
            let form = ModalForm::of(&chain, rate).unwrap();
            assert_eq!(form.count, depth);
            let mut sum = impulse(2000);
            sum[0] *= form.direct;
            for mode in &form.modes[..depth] {
                sum.iter_mut().zip(response(&[mode.to_biquad(rate)], 2000)).for_each(|(sum, h)| *sum += h);
            }
            let whole = response(&chain, 2000);
            let largest = whole.iter().fold(0.0f64, |largest, h| largest.max(h.abs()));
            let off = whole.iter().zip(&sum).fold(0.0f64, |off, (a, b)| off.max((a - b).abs()));
            worst = worst.max(off / largest);
        }
    }
    println!("modes of a chain against the chain: {worst:.1e} of its peak");
    assert!(worst < 1e-9, "{worst:e}");
}

#[test]
fn what_has_no_mode_is_named() {
    let rate = SampleRate::HZ_48000;
    let at = |pole| Biquad::from_roots(pole, Root::default(), 1.0);
    let real = at(Root { real: 0.9, imaginary: 0.0 });
    let bell = at(Root::polar(0.99, 1.0));
    assert_eq!(ModalForm::of(&[bell, real], rate), Err(BiquadError::NoMode { biquad: 1 }));
    assert!(matches!(ModalForm::of(&[bell, bell], rate), Err(BiquadError::NoMode { .. })));
    assert!(matches!(ModalForm::of(&[at(Root::polar(1.0, 1.0))], rate), Err(BiquadError::UnstablePole { .. })));
    assert!(matches!(ModalForm::of(&[], rate), Err(BiquadError::Depth { .. })));
}

#[test]
fn zeros_come_back_as_they_were_given() {
    let biquad = Biquad::from_roots(Root::polar(0.9, 1.0), Root::polar(0.8, 2.0), -3.0);
    let (gain, [zero, other]) = biquad.roots().unwrap();
    assert!((gain + 3.0).abs() < 1e-12 && (zero.square().sqrt() - 0.8).abs() < 1e-12);
    assert!((zero.imaginary.atan2(zero.real) - 2.0).abs() < 1e-12 && other.imaginary == -zero.imaginary);
}

#[test]
fn at_another_rate_frequency_decay_and_level_of_a_resonance_stay() {
    let mode = Partial { frequency_hz: 3000.0, decay_per_s: 12.0, sine: 2.0, cosine: 1.0 };
    for hz in [44_100, 96_000] {
        let rate = SampleRate::new(hz, 1).unwrap();
        let carried = mode.to_biquad(SampleRate::HZ_48000).carried(0, 48_000.0, rate).unwrap();
        let got = ModalForm::of(&[carried], rate).unwrap().modes[0];
        assert!(
            (got.frequency_hz / 3000.0 - 1.0).abs() < 1e-9 && (got.decay_per_s / 12.0 - 1.0).abs() < 1e-9,
            "{got:?}"
        );
        let level = |mode: &Partial| 20.0 * mode.sine.hypot(mode.cosine).log10();
        assert!((level(&got) - level(&mode)).abs() < 0.1, "{got:?}");
    }
    // The chain's zeros and poles move with the rate: the response at each resonance keeps its
    // level.
    let section = Biquad::from_roots(Root::polar(0.995, 0.8), Root::polar(1.0, 2.4), 0.3);
    let rate = SampleRate::new(96_000, 1).unwrap();
    let carried = section.carried(0, 48_000.0, rate).unwrap();
    let plain = |biquad: &Biquad| reference::biquad::Biquad {
        numerator: biquad.numerator,
        denominator: [-2.0 * biquad.pole.real, biquad.pole.square()],
    };
    let (before, after) = (plain(&section).magnitude(0.8), plain(&carried).magnitude(0.4));
    assert!((after / before - 1.0).abs() < 1e-9, "{before} {after}");
    assert!(plain(&carried).magnitude(1.2) < 1e-9, "the zero is at half its angle");
    let same = section.carried(0, 48_000.0, SampleRate::HZ_48000).unwrap();
    assert_eq!(same, section);
}

#[test]
fn a_pole_beyond_half_the_rate_is_refused_and_one_just_below_it_is_kept() {
    let high = Biquad::from_roots(Root::polar(0.99, 3.0), Root::default(), 1.0);
    let error = high.carried(3, 48_000.0, SampleRate::new(44_100, 1).unwrap()).unwrap_err();
    assert!(matches!(error, BiquadError::BeyondNyquist { biquad: 3, .. }), "{error:?}");
    assert!(error.to_string().contains("of half this rate"), "{error}");
    let highest = Biquad::from_roots(Root::polar(0.99, 0.999_97 * std::f64::consts::PI), Root::default(), 1.0);
    let carried = highest.carried(0, 48_000.0, SampleRate::new(86_000_000, 1792).unwrap()).unwrap();
    assert!(carried.pole.imaginary == 0.0 && carried.pole.real < 0.0);
}
