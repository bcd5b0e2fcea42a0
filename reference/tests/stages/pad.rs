//! Pad: all that one struck object and its strikers radiate (eq. 1).

use reference::contact::Impact;
use reference::pad::render_mono;
use reference::{Acceleration, Action, Bank, Direct, Event, Gain, Mode, Object, Pad, Pulse, Striker};

use crate::build::{
    RATE, choke, hertz_striker, largest_difference, mode, noise, pad, peak, release, some_modes, strike,
};

fn mono(pad: &Pad, events: &[Event], length: usize) -> Vec<f64> {
    mono_with_direct(pad, events, &[], length)
}

fn mono_with_direct(pad: &Pad, events: &[Event], force: &[f64], length: usize) -> Vec<f64> {
    let direct = Some(Direct { pad: 0, force });
    render_mono(std::slice::from_ref(pad), 0, events, direct, RATE, length).expect("a valid scene")
}

fn bank_sound(modes: &[Mode], force: &[f64]) -> Vec<f64> {
    let mut sound = vec![0.0; force.len()];
    Bank::new(modes, RATE).expect("even gains").add_sound(force, &mut sound);
    sound
}

fn force(impacts: &[Impact], length: usize) -> Vec<f64> {
    let mut force = vec![0.0; length];
    impacts.iter().for_each(|impact| impact.add_force(0, RATE, &mut force));
    force
}

/// A pad whose object and two strikers all ring.
fn full_pad() -> Pad {
    let stick = Striker { modes: vec![mode(2_500.0, 200.0, 0.5, 0.1)], ..hertz_striker() };
    let mallet = Striker {
        pulse: Pulse::Gaussian,
        contact_time_s: 0.003,
        modes: vec![mode(800.0, 300.0, 0.2, 0.0), mode(1_900.0, 400.0, 0.0, 0.3)],
        ..hertz_striker()
    };
    Pad {
        object: Object {
            modes: some_modes(),
            acceleration: Acceleration::Factor(0.002),
            biquads: vec![],
            dynamic_filter: None,
        },
        striker_weight: 0.4,
        ..pad(vec![], vec![stick, mallet])
    }
}

#[test]
fn a_pad_radiates_object_strikers_and_acceleration_as_equation_1_says() {
    let pad = full_pad();
    let events = [strike(20.5, 0, 0.9), Event { striker: 1, ..strike(45.25, 0, 0.6) }];
    let direct: Vec<f64> = noise(300).iter().map(|f| 5.0 * f).collect();
    let length = 1_000;

    let impact = |event: &Event| pad.strikers[event.striker].strike(event.velocity, event.time_samples);
    let mut by_stick = force(&[impact(&events[0]).expect("a strike")], length);
    by_stick.iter_mut().zip(&direct).for_each(|(sum, f)| *sum += f);
    let by_mallet = force(&[impact(&events[1]).expect("a strike")], length);
    let all: Vec<f64> = by_stick.iter().zip(&by_mallet).map(|(a, b)| a + b).collect();
    let object = bank_sound(&pad.object.modes, &all);
    let stick = bank_sound(&pad.strikers[0].modes, &by_stick);
    let mallet = bank_sound(&pad.strikers[1].modes, &by_mallet);
    let equation_1: Vec<f64> = (0..length).map(|n| object[n] + 0.4 * (stick[n] + mallet[n]) + 0.002 * all[n]).collect();

    let sound = mono_with_direct(&pad, &events, &direct, length);
    assert!(peak(&sound) > 0.01);
    assert!(largest_difference(&sound, &equation_1) < 1e-13);
}

#[test]
fn without_modes_a_pad_gives_the_force_itself() {
    let pad = Pad {
        object: Object {
            modes: vec![],
            acceleration: Acceleration::Factor(1.0),
            biquads: vec![],
            dynamic_filter: None,
        },
        ..pad(vec![], vec![hertz_striker()])
    };
    let events = [strike(3.75, 0, 0.5), strike(20.25, 0, 1.0)];
    let impacts = events.map(|event| hertz_striker().strike(event.velocity, event.time_samples).expect("a strike"));
    assert_eq!(mono(&pad, &events, 500), force(&impacts, 500));
}

#[test]
fn a_strike_is_first_heard_at_the_sample_after_its_time() {
    let pad = pad(vec![mode(440.0, 5.0, 1.0, 0.0)], vec![hertz_striker()]);
    let sound = mono(&pad, &[strike(99.5, 0, 1.0)], 200);
    assert!(sound[..100].iter().all(|y| *y == 0.0));
    assert_ne!(sound[101], 0.0);
}

#[test]
fn strikes_add_to_what_rings() {
    let pad = full_pad();
    let [first, second] = [strike(0.0, 0, 0.7), strike(300.5, 0, 0.4)];
    let apart: Vec<f64> =
        mono(&pad, &[first], 2_000).iter().zip(mono(&pad, &[second], 2_000)).map(|(a, b)| a + b).collect();
    assert!(largest_difference(&mono(&pad, &[first, second], 2_000), &apart) < 1e-13);
}

#[test]
fn a_strike_at_velocity_0_does_nothing_not_even_move_the_contact() {
    let mut pad = pad(vec![mode(440.0, 5.0, 1.0, 0.0)], vec![hertz_striker()]);
    pad.object.modes[0].gains.push(Gain { sine: 0.0, cosine: 0.0 });
    let nothing = Event { position: 1.0, ..strike(10.0, 0, 0.0) };
    let real = strike(0.0, 0, 1.0);
    assert_eq!(mono(&pad, &[real, nothing], 500), mono(&pad, &[real], 500));
    assert_eq!(peak(&mono(&pad, &[nothing], 500)), 0.0);
}

#[test]
fn each_contact_drives_its_own_gains_and_a_direct_force_those_of_the_latest() {
    let gains = [1.0, 3.0].map(|cosine| Gain { sine: 0.0, cosine });
    // A mode that decays within a sample: its sound is the present force times the gain.
    let forgetful = Mode { frequency_hz: 0.0, decay_per_s: 1e9, gains: gains.to_vec() };
    let pad = pad(vec![forgetful], vec![hertz_striker()]);
    let events = [strike(5.0, 0, 1.0), Event { position: 0.5, ..strike(20.3, 0, 1.0) }];
    let direct = vec![2.0; 200];
    let sound = mono_with_direct(&pad, &events, &direct, 200);
    let forces = events.map(|event| {
        let impact = hertz_striker().strike(1.0, event.time_samples).expect("a strike");
        force(&[impact], 200)
    });
    for n in 0..200 {
        let direct = if n >= 21 { 2.0 * 2.0 } else { 2.0 };
        let expected = (forces[0][n] + 2.0 * forces[1][n] + direct) / (2.0 * RATE.hz());
        assert!((sound[n] - expected).abs() < 1e-15, "sample {n}");
    }
}

#[test]
fn a_choke_acts_from_the_tick_after_it_on_and_is_continuous() {
    let pad = full_pad();
    let free = mono(&pad, &[strike(0.0, 0, 1.0)], 2_000);
    let choked = mono(&pad, &[strike(0.0, 0, 1.0), choke(699.2)], 2_000);
    assert_eq!(free[..704], choked[..704]);
    assert_ne!(free[704], choked[704]);
    // One step of a decay of ln(1000)/0.05 = 138 per second takes 0.3 % from the amplitude.
    assert!((free[704] - choked[704]).abs() < 0.003 * peak(&free));
    // An event on a tick acts at the next one; a choke that is released before that does nothing.
    assert_eq!(mono(&pad, &[strike(0.0, 0, 1.0), choke(672.0)], 2_000), choked);
    assert_eq!(mono(&pad, &[strike(0.0, 0, 1.0), choke(673.0), release(690.0)], 2_000), free);
}

#[test]
fn a_choked_pad_falls_by_60_db_in_the_choke_time() {
    let pad = pad(vec![mode(1_000.0, 0.5, 1.0, 0.0)], vec![hertz_striker()]);
    let sound = mono(&pad, &[strike(0.0, 0, 1.0), choke(1_000.0)], 4_000);
    // 1000 Hz has 48 samples a period, and the choke time of 50 ms is 50 periods.
    let ratio = sound[1_030 + 2_400] / sound[1_030];
    assert!((ratio / 1e-3 - 1.0).abs() < 1e-6);
}

#[test]
fn a_strike_on_a_choked_pad_sounds_choked() {
    let choked = pad(vec![mode(1_000.0, 0.5, 1.0, 0.0)], vec![hertz_striker()]);
    let t60 = 1000_f64.ln() / choked.choke_t60_s;
    // A force injects the same two samples as without the hand: the sine's gain is multiplied by
    // the radii's ratio.
    let ratio = (-(t60 - 0.5) / RATE.hz()).exp();
    let dull = pad(vec![mode(1_000.0, t60, ratio, 0.0)], vec![hertz_striker()]);
    let sound = mono(&choked, &[choke(0.0), strike(50.5, 0, 1.0)], 1_000);
    let expected = mono(&dull, &[strike(50.5, 0, 1.0)], 1_000);
    assert!(largest_difference(&sound, &expected) < 1e-12 * peak(&expected));
}

#[test]
fn a_choke_also_stops_the_strikers() {
    let mut pad = full_pad();
    pad.object.modes.clear();
    pad.strikers[0].modes = vec![mode(1_000.0, 0.5, 1.0, 0.0)];
    let sound = mono(&pad, &[strike(0.0, 0, 1.0), choke(1_000.0)], 4_000);
    assert!((sound[1_030 + 2_400] / sound[1_030] / 1e-3 - 1.0).abs() < 1e-6);
}

#[test]
fn a_release_gives_the_modes_their_own_decay_back() {
    let pad = pad(vec![mode(1_000.0, 0.5, 1.0, 0.0)], vec![hertz_striker()]);
    let events = [strike(0.0, 0, 1.0), choke(500.0), release(740.0)];
    let sound = mono(&pad, &events, 6_000);
    let ratio = sound[1_010 + 4_800] / sound[1_010];
    assert!((ratio / (-0.5 * 0.1_f64).exp() - 1.0).abs() < 1e-6);
    // Choked from the tick at 512 to that at 768: periods of 48 samples from 560 to 752.
    let ratio = sound[560 + 192] / sound[560];
    assert!((ratio / 1000_f64.powf(-0.004 / 0.05) - 1.0).abs() < 1e-6, "{ratio}");
}

#[test]
fn a_direct_force_needs_no_striker() {
    let pad = pad(some_modes(), vec![]);
    let force = noise(700);
    assert_eq!(mono_with_direct(&pad, &[], &force, 700), bank_sound(&some_modes(), &force));
}

#[test]
fn a_direct_force_is_over_at_its_end() {
    let pad = pad(some_modes(), vec![]);
    let mut force = noise(400);
    let cut = mono_with_direct(&pad, &[], &force, 1_000);
    force.resize(1_000, 0.0);
    assert_eq!(cut, bank_sound(&some_modes(), &force));
}

#[test]
fn events_of_other_pads_are_ignored() {
    let pads = [full_pad(), full_pad()];
    let for_pad_1 =
        [strike(0.0, 0, 1.0), strike(10.5, 1, 0.5), Event { action: Action::Choke, ..strike(50.0, 0, 0.0) }];
    let sound = render_mono(&pads, 1, &for_pad_1, None, RATE, 500).expect("a valid scene");
    assert_eq!(sound, mono(&pads[0], &[strike(10.5, 0, 0.5)], 500));
}
