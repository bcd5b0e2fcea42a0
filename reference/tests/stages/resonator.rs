//! Resonator: modes driven by a force (§3.3).

use std::f64::consts::{PI, TAU};

use reference::{Bank, Gain, Mode, SampleRate};

use crate::build::{RATE, largest_difference, mode, noise, peak, some_modes};

/// Impulse response `h(n/fs)` of §3.3, with a cosine gain beside the sine, written out.
fn impulse_response(modes: &[Mode], n: usize, rate: SampleRate) -> f64 {
    let t = n as f64 / rate.hz();
    let of_mode = |mode: &Mode| {
        let Gain { sine, cosine } = mode.gains[0];
        let phase = TAU * mode.frequency_hz * t;
        (-mode.decay_per_s * t).exp() * (sine * phase.sin() + cosine * phase.cos())
    };
    modes.iter().map(of_mode).sum()
}

fn sound(modes: &[Mode], force: &[f64], rate: SampleRate) -> Vec<f64> {
    let mut sound = vec![0.0; force.len()];
    bank(modes, rate).add_sound(force, &mut sound);
    sound
}

fn bank(modes: &[Mode], rate: SampleRate) -> Bank<'_> {
    Bank::new(modes, rate).expect("even gains")
}

/// A force of one newton-second in a single sample.
fn unit_impulse(length: usize, rate: SampleRate) -> Vec<f64> {
    let mut force = vec![0.0; length];
    force[0] = rate.hz();
    force
}

#[test]
fn an_impulse_gives_the_impulse_response_with_half_weight_at_its_start() {
    let modes = some_modes();
    let sound = sound(&modes, &unit_impulse(48_000, RATE), RATE);
    let mut expected: Vec<f64> = (0..48_000).map(|n| impulse_response(&modes, n, RATE)).collect();
    expected[0] /= 2.0;
    assert!(largest_difference(&sound, &expected) < 1e-10);
}

#[test]
fn the_recursion_equals_the_convolution() {
    let modes = some_modes();
    let mut force = noise(2_000);
    force[700..1_100].fill(0.0);
    let half_weight = |lag: usize| if lag == 0 { 0.5 } else { 1.0 };
    let h: Vec<f64> = (0..2_000).map(|lag| half_weight(lag) * impulse_response(&modes, lag, RATE)).collect();
    let convolution: Vec<f64> =
        (0..2_000).map(|n| (0..=n).map(|m| force[m] * h[n - m]).sum::<f64>() / RATE.hz()).collect();
    assert!(largest_difference(&sound(&modes, &force, RATE), &convolution) < 1e-12);
}

#[test]
fn a_mode_falls_by_60_db_in_its_t60() {
    let modes = [mode(440.0, 1000_f64.ln() / 0.75, 1.0, 0.0)];
    let mut bank = bank(&modes, RATE);
    bank.add_sound(&unit_impulse(1, RATE), &mut [0.0]);
    let at_start = bank.amplitudes().next().expect("one mode");
    bank.add_sound(&vec![0.0; 36_000], &mut vec![0.0; 36_000]);
    let after_t60 = bank.amplitudes().next().expect("one mode");
    assert!((at_start - 1.0).abs() < 1e-12);
    assert!((after_t60 / at_start / 1e-3 - 1.0).abs() < 1e-9);
}

#[test]
fn a_mode_rings_at_its_frequency() {
    let rate = SampleRate { numerator: 86_000_000, denominator: 1_792 };
    let modes = [mode(440.0, 0.0, 1.0, 0.0)];
    let sound = sound(&modes, &unit_impulse(480_000, rate), rate);
    let rising_s: Vec<f64> = (1..sound.len())
        .filter(|n| sound[n - 1] < 0.0 && sound[*n] >= 0.0)
        .map(|n| (n as f64 - sound[n] / (sound[n] - sound[n - 1])) / rate.hz())
        .collect();
    let periods = (rising_s.len() - 1) as f64;
    let frequency_hz = periods / (rising_s[rising_s.len() - 1] - rising_s[0]);
    assert!((frequency_hz / 440.0 - 1.0).abs() < 1e-8);
}

#[test]
fn the_energy_of_a_ringing_mode_is_that_of_the_damped_sine() {
    // ∫ e^(-2dt) sin² ωt dt = (1/d - d/(d² + ω²))/4
    let (frequency_hz, decay_per_s) = (700.0, 9.0);
    let omega = TAU * frequency_hz;
    let expected = 0.25 * (1.0 / decay_per_s - decay_per_s / (decay_per_s * decay_per_s + omega * omega));
    let modes = [mode(frequency_hz, decay_per_s, 1.0, 0.0)];
    let sound = sound(&modes, &unit_impulse(4 * 48_000, RATE), RATE);
    let energy = sound.iter().map(|y| y * y).sum::<f64>() / RATE.hz();
    assert!((energy / expected - 1.0).abs() < 1e-6);
}

#[test]
fn half_weight_at_the_start_keeps_a_cosine_mode_true_to_its_spectrum() {
    // The spectrum of e^(pt), p = -d + i2πf, sampled with half weight at 0, is coth((iω -
    // p)/2fs)/2fs: 1/(iω - p) but for terms in the square of frequency over rate. With full weight,
    // the error would be 1/2fs at every frequency.
    let (frequency_hz, decay_per_s) = (400.0, 60.0);
    let modes = [mode(frequency_hz, decay_per_s, 0.0, 1.0)];
    let sound = sound(&modes, &unit_impulse(48_000, RATE), RATE);
    let probe_hz = 2_000.0;
    let spectrum = |n: usize| -TAU * probe_hz * n as f64 / RATE.hz();
    let re = sound.iter().enumerate().map(|(n, y)| y * spectrum(n).cos()).sum::<f64>() / RATE.hz();
    let im = sound.iter().enumerate().map(|(n, y)| y * spectrum(n).sin()).sum::<f64>() / RATE.hz();
    // (iω + d)/((iω + d)² + (2πf)²), the transfer function of e^(-dt) cos 2πft.
    let (omega, omega_0, d) = (TAU * probe_hz, TAU * frequency_hz, decay_per_s);
    let (below_re, below_im) = (d * d - omega * omega + omega_0 * omega_0, 2.0 * omega * d);
    let below = below_re * below_re + below_im * below_im;
    let expected_re = (d * below_re + omega * below_im) / below;
    let expected_im = (omega * below_re - d * below_im) / below;
    let error = (re - expected_re).hypot(im - expected_im);
    assert!(error < 0.01 * expected_re.hypot(expected_im));
    assert!(error < 0.05 / (2.0 * RATE.hz()));
}

#[test]
fn modes_sound_the_same_at_every_rate() {
    // A force without sharp edges, over by 10 ms, so that every rate can carry it.
    let at_48_khz = |times: u32| -> Vec<f64> {
        let rate = SampleRate { numerator: 48_000 * times, denominator: 1 };
        let force_at = |n: u32| (-((f64::from(n) / rate.hz() - 0.005) / 0.0008).powi(2)).exp();
        let force: Vec<f64> = (0..4_800 * times).map(force_at).collect();
        sound(&some_modes()[..4], &force, rate).into_iter().step_by(times as usize).collect()
    };
    let [single, double, quadruple] = [1, 2, 4].map(at_48_khz);
    let scale = peak(&quadruple);
    let (under_force, ringing) = (..480, 480..);
    assert!(largest_difference(&single[ringing.clone()], &double[ringing]) < 1e-11 * scale);
    // While the force acts, half weight at h[0] makes the sum a trapezoid rule: twice the rate has
    // a quarter of the error.
    let error = largest_difference(&single[under_force], &double[under_force]);
    let error_at_double = largest_difference(&double[under_force], &quadruple[under_force]);
    assert!(error < 2e-5 * scale);
    assert!((error / error_at_double - 4.0).abs() < 0.1);
}

#[test]
fn a_mode_at_or_above_nyquist_is_never_rendered() {
    for frequency_hz in [24_000.0, 24_000.1, 50_000.0] {
        let modes = [mode(frequency_hz, 1.0, 1.0, 1.0)];
        let mut bank = bank(&modes, RATE);
        let mut sound = vec![0.0; 100];
        bank.add_sound(&unit_impulse(100, RATE), &mut sound);
        assert!(sound.iter().all(|y| *y == 0.0));
        assert_eq!(bank.amplitudes().collect::<Vec<_>>(), [0.0]);
    }
    assert!(peak(&sound(&[mode(23_999.9, 1.0, 1.0, 1.0)], &unit_impulse(100, RATE), RATE)) > 0.5);
}

#[test]
fn a_bank_rendered_in_pieces_gives_the_same_bits() {
    let modes = some_modes();
    let mut force = noise(3_000);
    force[500..2_500].fill(0.0);
    force[1_000] = 1.0;
    let whole = sound(&modes, &force, RATE);
    for block in [1, 7, 64, 999] {
        let mut bank = bank(&modes, RATE);
        let mut pieces = vec![0.0; 3_000];
        for (force, sound) in force.chunks(block).zip(pieces.chunks_mut(block)) {
            bank.add_sound(force, sound);
        }
        assert_eq!(pieces, whole, "blocks of {block}");
    }
}

#[test]
fn a_bank_comes_to_rest_instead_of_ringing_among_subnormal_numbers() {
    let modes = [mode(3_000.0, 5_000.0, 1.0, 0.0)];
    let sound = sound(&modes, &unit_impulse(10_000, RATE), RATE);
    assert!(sound.iter().all(|y| *y == 0.0 || y.abs() > f64::MIN_POSITIVE));
    assert_eq!(sound[9_999], 0.0);
}

#[test]
fn gains_between_two_positions_are_interpolated() {
    let gains = [(1.0, 0.0), (3.0, -2.0), (0.0, 4.0)].map(|(sine, cosine)| Gain { sine, cosine });
    let mode = Mode { gains: gains.to_vec(), ..mode(100.0, 1.0, 0.0, 0.0) };
    let at = |position| mode.gain_at(position).map(|gain| (gain.sine, gain.cosine));
    assert_eq!(at(0.0), Some((1.0, 0.0)));
    assert_eq!(at(0.25), Some((2.0, -1.0)));
    assert_eq!(at(0.5), Some((3.0, -2.0)));
    assert_eq!(at(0.875), Some((0.75, 2.5)));
    assert_eq!(at(1.0), Some((0.0, 4.0)));
}

#[test]
fn moving_the_contact_changes_the_force_to_come_and_not_what_rings() {
    let gains = [1.0, 0.0].map(|sine| Gain { sine, cosine: 0.0 });
    let modes = [Mode { gains: gains.to_vec(), ..mode(500.0, 2.0, 0.0, 0.0) }];
    let mut bank = bank(&modes, RATE);
    let mut sound = vec![0.0; 1_000];
    bank.add_sound(&unit_impulse(500, RATE), &mut sound[..500]);
    bank.set_position(1.0); // a node of this mode: no force moves it any more
    bank.add_sound(&noise(500), &mut sound[500..]);
    let modes_at_0 = [mode(500.0, 2.0, 1.0, 0.0)];
    assert!(largest_difference(&sound, &self::sound(&modes_at_0, &unit_impulse(1_000, RATE), RATE)) < 1e-12);
}

#[test]
fn a_hand_keeps_the_last_two_samples_of_a_mode() {
    let modes = [mode(900.0, 4.0, 0.0, 1.0)];
    let mut bank = bank(&modes, RATE);
    let mut sound = vec![0.0; 300];
    bank.add_sound(&unit_impulse(100, RATE), &mut sound[..100]);
    bank.choke(0.02);
    bank.reach();
    bank.add_sound(&[0.0; 100], &mut sound[100..200]);
    bank.release();
    bank.reach();
    bank.add_sound(&[0.0; 100], &mut sound[200..]);
    // Each sample follows from the two before it by the pole that the mode has then: from 100 to
    // 199 the choked one. The first one has half its weight.
    for n in 3..300 {
        let decay_per_s = if (100..200).contains(&n) { 1000_f64.ln() / 0.02 } else { 4.0 };
        let radius = (-decay_per_s / RATE.hz()).exp();
        let cosine = (2.0 * PI * 900.0 / RATE.hz()).cos();
        let expected = 2.0 * radius * cosine * sound[n - 1] - radius * radius * sound[n - 2];
        assert!((sound[n] - expected).abs() < 1e-12, "sample {n}: {} for {expected}", sound[n]);
    }
}

#[test]
fn a_choke_leaves_a_mode_that_decays_faster_alone() {
    let modes = [mode(900.0, 500.0, 1.0, 0.0)];
    let mut choked = bank(&modes, RATE);
    choked.choke(1.0);
    choked.reach();
    let mut choked_sound = vec![0.0; 200];
    choked.add_sound(&unit_impulse(200, RATE), &mut choked_sound);
    assert_eq!(choked_sound, sound(&modes, &unit_impulse(200, RATE), RATE));
}

#[test]
fn a_bank_with_uneven_gains_is_refused_and_names_the_mode() {
    let mut modes = some_modes();
    modes[2].gains.push(Gain { sine: 1.0, cosine: 1.0 });
    let error = Bank::new(&modes, RATE).expect_err("uneven gains");
    assert_eq!((error.mode, error.found, error.expected), (2, 2, 1));
    modes[0].gains.clear();
    let error = Bank::new(&modes, RATE).expect_err("no gains");
    assert_eq!((error.mode, error.found, error.expected), (0, 0, 1));
}
