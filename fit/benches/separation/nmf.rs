//! Non-negative matrix factorization told the same labels, to compare the separation with.
//!
//! Every thing, every striker and the noise have spectral templates. The spectrogram of a recording
//! is modelled by the templates of its thing, its striker and the noise, with gains in each frame.
//! Multiplicative updates lower the Kullback-Leibler divergence (Lee and Seung 2001). A stem is the
//! recording, each bin times the part's share of the modelled power (Wiener mask).

use fit::separate::synthetic::Blow;
use fourier::Complex;

/// Length of a frame in samples.
const FRAME: usize = 1024;
/// Samples from one frame to the next.
const HOP: usize = 256;
/// Number of templates of a thing, of a striker and of the noise.
const TEMPLATES: [usize; 3] = [6, 4, 1];
/// Number of updates.
const UPDATES: usize = 150;

type Spectrum = Vec<Vec<Complex<f64>>>;

/// Sounds of thing and striker in every recording.
pub(crate) fn nmf(set: &[Blow], things: usize, strikers: usize) -> Vec<[Vec<f64>; 2]> {
    let spectra: Vec<Spectrum> = set.iter().map(|blow| spectrum(&blow.samples)).collect();
    let bins = FRAME / 2 + 1;
    // Templates of things, then of strikers, then of the noise.
    let counts: Vec<usize> =
        (0..things).map(|_| TEMPLATES[0]).chain((0..strikers).map(|_| TEMPLATES[1])).chain([TEMPLATES[2]]).collect();
    let mut state = 0x9E37_79B9u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        0.1 + (state >> 33) as f64 / (1u64 << 31) as f64
    };
    let mut templates: Vec<Vec<Vec<f64>>> =
        counts.iter().map(|&count| (0..count).map(|_| (0..bins).map(|_| random()).collect()).collect()).collect();
    let parts = |blow: &Blow| [blow.object, things + blow.striker, things + strikers];
    // Activations of each recording: part, template, frame.
    let mut activations: Vec<Vec<Vec<Vec<f64>>>> = set
        .iter()
        .zip(&spectra)
        .map(|(blow, frames)| {
            let of_part = |part: usize| (0..counts[part]).map(|_| frames.iter().map(|_| 1.0).collect()).collect();
            parts(blow).map(of_part).to_vec()
        })
        .collect();
    // A start that differs from part to part, else all templates of a part would stay alike.
    activations.iter_mut().flatten().flatten().flatten().for_each(|x: &mut f64| *x *= random());
    for _ in 0..UPDATES {
        let mut above: Vec<Vec<Vec<f64>>> = counts.iter().map(|&count| vec![vec![0.0; bins]; count]).collect();
        let mut below: Vec<Vec<f64>> = counts.iter().map(|&count| vec![1e-12; count]).collect();
        for ((blow, frames), active) in set.iter().zip(&spectra).zip(&mut activations) {
            let parts = parts(blow);
            for (time, frame) in frames.iter().enumerate() {
                let ratio = |active: &[Vec<Vec<f64>>], templates: &[Vec<Vec<f64>>]| -> Vec<f64> {
                    let mut model = vec![1e-9; bins];
                    for (slot, &part) in parts.iter().enumerate() {
                        for (template, gain) in templates[part].iter().zip(&active[slot]) {
                            model.iter_mut().zip(template).for_each(|(sum, x)| *sum += x * gain[time]);
                        }
                    }
                    frame.iter().zip(&model).map(|(x, model)| x.norm() / model).collect()
                };
                let now = ratio(active, &templates);
                for (slot, &part) in parts.iter().enumerate() {
                    for (template, gain) in templates[part].iter().zip(&mut active[slot]) {
                        let sum: f64 = template.iter().sum::<f64>() + 1e-12;
                        gain[time] *= template.iter().zip(&now).map(|(x, ratio)| x * ratio).sum::<f64>() / sum;
                    }
                }
                let now = ratio(active, &templates);
                for (slot, &part) in parts.iter().enumerate() {
                    for (index, gain) in active[slot].iter().enumerate() {
                        let gain = gain[time];
                        below[part][index] += gain;
                        above[part][index].iter_mut().zip(&now).for_each(|(sum, ratio)| *sum += gain * ratio);
                    }
                }
            }
        }
        for ((templates, above), below) in templates.iter_mut().zip(&above).zip(&below) {
            for ((template, above), below) in templates.iter_mut().zip(above).zip(below) {
                template.iter_mut().zip(above).for_each(|(x, above)| *x = (*x * above / below).max(1e-12));
            }
        }
    }
    let stems = set.iter().zip(&spectra).zip(&activations).map(|((blow, frames), active)| {
        let parts = parts(blow);
        [0, 1].map(|wanted: usize| {
            let masked = frames.iter().enumerate().map(|(time, frame)| {
                let mut shares = [vec![1e-18; bins], vec![1e-18; bins], vec![1e-18; bins]];
                for (slot, &part) in parts.iter().enumerate() {
                    for (template, gain) in templates[part].iter().zip(&active[slot]) {
                        shares[slot].iter_mut().zip(template).for_each(|(sum, x)| *sum += x * gain[time]);
                    }
                }
                let mask = |bin: usize| {
                    let power = |slot: usize| shares[slot][bin].powi(2);
                    power(wanted) / (power(0) + power(1) + power(2))
                };
                frame.iter().enumerate().map(|(bin, x)| x * mask(bin)).collect::<Vec<Complex<f64>>>()
            });
            sound(&masked.collect::<Spectrum>(), blow.samples.len())
        })
    });
    stems.collect()
}

/// Window whose squares, a quarter of a frame apart, sum to 3/2.
fn window() -> Vec<f64> {
    (0..FRAME).map(|n| 0.5 - 0.5 * (std::f64::consts::TAU * n as f64 / FRAME as f64).cos()).collect()
}

fn spectrum(samples: &[f64]) -> Spectrum {
    let (transform, window) = (fourier::forward(FRAME), window());
    let frames = (samples.len() + FRAME) / HOP;
    let frame = |index: usize| {
        let mut input: Vec<f64> = (0..FRAME)
            .map(|n| (index * HOP + n).checked_sub(FRAME - HOP).and_then(|at| samples.get(at)).copied().unwrap_or(0.0))
            .zip(&window)
            .map(|(x, weight)| x * weight)
            .collect();
        let mut output = transform.make_output_vec();
        transform.process(&mut input, &mut output).expect("the lengths are those of the plan");
        output
    };
    (0..frames).map(frame).collect()
}

fn sound(frames: &Spectrum, length: usize) -> Vec<f64> {
    let (transform, window) = (fourier::inverse(FRAME), window());
    let mut samples = vec![0.0; length];
    for (index, frame) in frames.iter().enumerate() {
        let mut frame = frame.clone();
        frame[0].im = 0.0;
        frame[FRAME / 2].im = 0.0;
        let mut output = transform.make_output_vec();
        transform.process(&mut frame, &mut output).expect("the lengths are those of the plan");
        for (n, (x, weight)) in output.iter().zip(&window).enumerate() {
            if let Some(slot) = (index * HOP + n).checked_sub(FRAME - HOP).and_then(|at| samples.get_mut(at)) {
                *slot += x * weight / FRAME as f64 / 1.5;
            }
        }
    }
    samples
}
