use std::f64::consts::PI;

use super::numbers::{A_LOOP, Ringing};
use crate::bark::{Centroids, DampingBand, DampingLaw, frequency_hz};
use crate::dynamic_filter::damping::mean_law;
use crate::dynamic_filter::delay::SHORTEST_DELAY;
use crate::dynamic_filter::lattice::{Lattice, WIDEST};
use crate::dynamic_filter::model::{Form, Loop, RATE_HZ};
use crate::dynamic_filter::objective::Objective;
use crate::dynamic_filter::sound::render;
use crate::dynamic_filter::stability::{MOST_LOOP_GAIN, loop_gain};
use crate::dynamic_filter::table::of_model;
use crate::dynamic_filter::times::times_s;
use crate::random::SplitMix64;
use crate::table::Provenance;

/// A law with one band for each decay, from 5 Bark on, all of one level.
fn law(decays_per_s: &[f64]) -> DampingLaw {
    let band = |(index, decay_per_s): (usize, &f64)| {
        let bark = 5.0 + index as f64;
        DampingBand { bark, centre_hz: frequency_hz(bark), gain: 0.1, decay_per_s: *decay_per_s }
    };
    let centroids = Centroids { whole_hz: 1500.0, below_hz: 600.0, above_hz: 3500.0, highest_hz: 9000.0 };
    DampingLaw { bands: decays_per_s.iter().enumerate().map(band).collect(), centroids }
}

/// Loops round a filter that stands still, with noise that falls at a decay rate.
///
/// Each loop has its centre in Hz and its numbers `[x, ln width]`.
fn still(
    times_s: &[f64],
    filter: &Lattice,
    noise_decay_per_s: f64,
    loops: &[(f64, [f64; A_LOOP])],
    bands: usize,
) -> Ringing {
    let knots = Ringing::knots_until(times_s.len() - 1);
    let of_knot = |time: &usize| {
        let level = -noise_decay_per_s * times_s[*time];
        std::iter::once(level).chain(filter.free.iter().copied())
    };
    let mut free: Vec<f64> = knots.iter().flat_map(of_knot).collect();
    loops.iter().for_each(|(_, numbers)| free.extend(numbers));
    free.resize(free.len() + bands, 0.0);
    let period = |frequency_hz: f64| RATE_HZ / frequency_hz;
    let delay = |hz: f64| ((SHORTEST_DELAY / period(hz)).ceil() * period(hz)).floor();
    let loops = loops.iter().map(|(hz, _)| (*hz, delay(*hz))).collect();
    let filters = vec![filter.coefficients(); knots.len()];
    Ringing { form: filter.form(), knots, loops, free }.with_gains_of(times_s, &filters)
}

#[test]
fn loops_in_each_others_skirts_decay_as_the_closed_loops_poles_predict() {
    let law = law(&[20.0; 18]);
    let times_s = times_s(&law);
    let objective = Objective::new(&law, &times_s);
    let filter = Lattice::of(Form::FirstOrder, vec![(0.1f64).ln(), -0.5]);
    // Centre in Hz, decay and half-width in 1/s; the middle two are in each other's skirts.
    let wanted = [(1000.0, 12.0, 70.0), (2303.0, 20.0, 110.0), (3212.0, 25.0, 140.0), (6416.0, 40.0, 250.0)];
    let numbers = |(hz, decay, half): (f64, f64, f64)| (hz, [f64::ln(decay / half), (half / PI).ln()]);
    let ringing = still(&times_s, &filter, 120.0, &wanted.map(numbers), objective.lawful());
    let model = ringing.model(&times_s);
    // The sound after the noise, which falls by 83 dB in 80 ms.
    let rung = |seed| render(&model, 96_000, seed).split_off(3_840);
    let heard = mean_law(&(1..=8).map(rung).collect::<Vec<_>>()).expect("it decays");
    let decoded = ringing.decoded(&times_s);
    let lowered = |(guide, gain): (&Loop, &f64)| guide.gain < 0.9999 * gain;
    assert!(!model.loops.iter().zip(&decoded.gains).any(lowered), "too crowded for this test");
    for (frequency_hz, decay_per_s, _) in wanted {
        let places = ringing.places(&decoded, frequency_hz);
        let predicted = places.last().expect("a pole").decay_per_s;
        let found = heard.decay_per_s(frequency_hz);
        println!("{frequency_hz} Hz, {decay_per_s} 1/s alone: predicted {predicted:.2}, heard {found:.2}");
        assert!((predicted / found - 1.0).abs() < 0.1, "{frequency_hz} Hz: predicted {predicted}, heard {found}");
    }
}

#[test]
fn any_free_numbers_give_loops_that_the_instrument_accepts_as_stable() {
    let law = law(&[40.0, 20.0, 60.0, 30.0, 90.0]);
    let times_s = times_s(&law);
    let provenance = Provenance { name: "any".into(), source: "synthetic".into(), licence: "CC0".into() };
    let mut random = SplitMix64(11);
    for round in 0..40 {
        let form = [Form::FirstOrder, Form::OnePoleOneZero][round % 2];
        let mut loops = Vec::new();
        for index in 0..1 + round % 8 {
            let frequency_hz = 400.0 * 1.6f64.powi(index as i32) * (1.0 + 0.2 * random.uniform());
            loops.push((frequency_hz, [-6.0 * random.uniform(), (400.0f64 * random.uniform()).max(1.0).ln()]));
        }
        let mut ringing = still(&times_s, &Lattice::flat(form, 0.2), 80.0, &loops, law.bands.len());
        let (a_knot, knots) = (ringing.a_knot(), ringing.knots.len());
        for (index, number) in ringing.free.iter_mut().enumerate().take(a_knot * knots) {
            match index % a_knot {
                0 => *number -= 3.0 * random.uniform(),
                1 => *number -= random.uniform(),
                _ => *number = 0.4 * WIDEST * (2.0 * random.uniform() - 1.0),
            }
        }
        ringing.bound();
        let model = ringing.model(&times_s);
        let gain = loop_gain(&model.path, &model.loops);
        assert!(gain <= MOST_LOOP_GAIN + 1e-9, "{round}: {gain}");
        assert!(model.path.points.iter().all(|point| (0.0..=1.0).contains(&point.noise)));
        let table = of_model(&model, &provenance, 1);
        let played = crate::render::by_instrument(&table, 0.0, RATE_HZ, 4_800);
        assert!(played.is_ok(), "{round}: {:?}", played.err());
    }
}

#[test]
fn free_numbers_without_loops_give_a_model_of_noise_alone() {
    let law = law(&[40.0, 20.0, 60.0]);
    let times_s = times_s(&law);
    let model = still(&times_s, &Lattice::flat(Form::FirstOrder, 0.2), 80.0, &[], law.bands.len()).model(&times_s);
    assert!(model.loops.is_empty());
    assert!(model.path.points.iter().all(|point| (0.0..=1.0).contains(&point.noise)));
}
