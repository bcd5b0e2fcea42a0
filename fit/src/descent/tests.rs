//! Analytic derivatives against central differences, for every kind of parameter.

use super::loss::Loss;
use super::model::{Draw, Model};
use super::parameters::Kind;
use crate::random::SplitMix64;

const LENGTH: usize = 3_000;
const RATE_HZ: f64 = 16_000.0;

/// Relative difference of two gradients by the numbers of one kind.
fn apart(stated: &[f64], differences: &[f64]) -> f64 {
    let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
    let size = norm(&mut differences.iter().copied());
    assert!(size > 1e-9, "the numbers act on the sound: {size}");
    norm(&mut stated.iter().zip(differences).map(|(a, b)| a - b)) / size
}

/// Central differences of fourth order by up to 40 numbers of a kind, and the numbers' places.
fn differences(model: &Model, kind: Kind, at: &[f64], value: &dyn Fn(&[f64]) -> f64) -> (Vec<usize>, Vec<f64>) {
    const STEP: f64 = 1e-4;
    let places: Vec<usize> = model.places.of(kind).take(40).collect();
    let of_place = |place: &usize| {
        let moved = |step: f64| {
            let mut near = at.to_vec();
            near[*place] += step;
            value(&near)
        };
        (8.0 * (moved(STEP) - moved(-STEP)) - (moved(2.0 * STEP) - moved(-2.0 * STEP))) / (12.0 * STEP)
    };
    let slopes = places.iter().map(of_place).collect();
    (places, slopes)
}

fn random_model(seed: u64) -> (Model, Vec<f64>, Draw) {
    let mut random = SplitMix64(seed);
    let model = Model::new(LENGTH, RATE_HZ, 11, &mut random);
    let mut parameters = model.start(&mut random);
    // Louder room and noise than a start has, so that every kind acts on the sound.
    for kind in [Kind::RoomGain, Kind::NoiseGain] {
        parameters[model.places.of(kind)].iter_mut().for_each(|x| *x += 3.0);
    }
    let draw = model.draw(&mut random);
    (model, parameters, draw)
}

#[test]
fn derivatives_of_the_sound_by_every_kind_are_central_differences() {
    for seed in 1..4 {
        let (model, parameters, draw) = random_model(seed);
        let mut random = SplitMix64(seed ^ 0xABCD);
        let weights: Vec<f64> = (0..LENGTH).map(|_| random.normal()).collect();
        let value = |parameters: &[f64]| {
            let sound = model.render(parameters, &draw).sound;
            sound.iter().zip(&weights).map(|(x, weight)| x * weight).sum::<f64>()
        };
        let gradient = model.gradient(&parameters, &draw, &model.render(&parameters, &draw), &weights);
        assert_eq!(gradient.len(), model.places.total());
        for kind in Kind::ALL {
            let (places, slopes) = differences(&model, kind, &parameters, &value);
            let stated: Vec<f64> = places.iter().map(|place| gradient[*place]).collect();
            assert!(apart(&stated, &slopes) < 1e-6, "{seed} {kind:?}: {}", apart(&stated, &slopes));
        }
    }
}

#[test]
fn derivative_of_the_loss_by_samples_is_a_central_difference() {
    let mut random = SplitMix64(9);
    let mut noise = || (0..LENGTH).map(|_| random.normal()).collect::<Vec<f64>>();
    let (recording, sound, toward) = (noise(), noise(), noise());
    let loss = Loss::new(&recording);
    let mut gradient = vec![0.0; LENGTH];
    assert!(loss.at(&recording, &mut gradient.clone()) < 1e-9);
    loss.at(&sound, &mut gradient);
    let stated: f64 = gradient.iter().zip(&toward).map(|(slope, x)| slope * x).sum();
    // Short enough that next to no bin passes the recording's, where the loss has an edge.
    let moved = |step: f64| {
        let near: Vec<f64> = sound.iter().zip(&toward).map(|(x, toward)| x + step * toward).collect();
        loss.at(&near, &mut vec![0.0; LENGTH])
    };
    let difference = (moved(1e-7) - moved(-1e-7)) / 2e-7;
    assert!((difference / stated - 1.0).abs() < 1e-6, "{difference} {stated}");
}
