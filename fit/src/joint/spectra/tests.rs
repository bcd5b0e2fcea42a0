use super::super::grid::{Cells, Frame};
use super::*;
use crate::distance::Spectrogram;
use crate::modes::{Basis, Pole, Stretch};

const RATE_HZ: f64 = 44_100.0;

fn force() -> Vec<f64> {
    crate::contact::force(8e-4, RATE_HZ)
}

fn grid(size: usize) -> Grid {
    let frame = |start: i64| Frame { start, weight: 1.0, loudness_weight: 0.0 };
    let hop = size as i64 / 4;
    let frames = (-3..4).map(|index| frame(index * hop)).collect();
    Grid::new(&vec![0.0; 8_192], 1_024, size, frames, Cells::Bins)
}

#[test]
fn closed_form_spectra_are_those_of_the_rendered_modes() {
    let force = force();
    let modes =
        [(120.0, 30.0, 1.0, 0.3), (1_000.0, 2.0, 0.5, -0.2), (9_000.0, 900.0, 0.1, 1.0), (21_500.0, 20.0, 0.2, 0.1)];
    for size in [128, 512, 1024, 2048] {
        let mut rendered = vec![0.0; 8_192];
        let silence = vec![0.0; 8_192 - 1_024];
        let stretch = Stretch { samples: &silence, force: Some(&force) };
        let (mut gains, mut responses) = (Vec::new(), Vec::new());
        for (frequency_hz, decay_per_s, re, im) in modes {
            let pole = Pole::new(frequency_hz, decay_per_s, RATE_HZ);
            Basis::new(pole, &stretch).add(Complex::new(re, im), &mut rendered[1_024..]);
            gains.push(Complex::new(re, im));
            responses.push(Response::new(Complex::new(-pole.decay, pole.angular), &force));
        }
        for (sound, force) in rendered[1_024..].iter_mut().zip(&force) {
            *sound += 0.7 * force;
        }
        let grid = grid(size);
        let mut spectra = Spectra::new(&grid, &force);
        let shapes: Vec<Shape> = responses.iter().map(|response| spectra.shape(response)).collect();
        spectra.sum(&shapes, &gains, 0.7);
        let spectrogram = Spectrogram::new(size);
        let loudest = spectrogram.power(&rendered).into_iter().fold(0.0, f64::max).sqrt();
        for (index, frame) in grid.frames.iter().enumerate() {
            // Frames that begin within the force are approximated.
            if (0..force.len() as i64).contains(&frame.start) {
                continue;
            }
            let from = (1_024 + frame.start).max(0) as usize;
            let mut samples = vec![0.0; usize::try_from(-(1_024 + frame.start)).unwrap_or(0)];
            samples.extend(&rendered[from..from + size - samples.len()]);
            let expected = spectrogram.complex(&samples);
            let given = spectra.folded(index);
            for (bin, expected) in expected.iter().enumerate() {
                let given = given.at(bin);
                let error = Complex::new(f64::from(given.re), f64::from(given.im)) - expected;
                assert!(error.norm() < 3e-4 * loudest, "{size} {} {bin}: {given} {expected}", frame.start);
            }
        }
    }
}
