//! Sweeps of the dynamic filter's noise: bands, decays, spectral lines at the tick rate.

use dsp_core::SampleRate;
use dsp_core::dynamic_filter::Breakpoint;
use dsp_core::waveguide::Loop;

use super::Extent;
use crate::dynamic_filter::{Ours, Table, play};
use crate::snr::Random;

const RATE: SampleRate = SampleRate::HZ_48000;
/// Number of seeds over which figures are averaged.
pub const SEEDS: u32 = 200;
/// Bus value of 1.0.
const ONE: f64 = 134_217_728.0;

/// Breakpoint of the first order with b1 = b0.
pub fn point(time_s: f64, b0: f64, a1: f64) -> Breakpoint {
    Breakpoint { time_s, b0, b1: b0, a1, ..Breakpoint::default() }
}

/// Filter of a table with another seed than the table's own.
///
/// # Panics
/// If the table is refused.
pub fn of_seed(table: &Table, seed: u32) -> Box<Ours> {
    table.with_seed(seed, RATE).expect("a valid table")
}

/// Sounds of a table under the seeds from 0 on, struck at the first frame.
fn sounds(table: &Table, seeds: u32, frames: usize) -> impl Iterator<Item = Vec<f64>> {
    (0..seeds).map(move |seed| {
        let out = play(&mut of_seed(table, seed), &[(0, 1.0)], frames);
        out.iter().map(|&word| f64::from(word) / ONE).collect()
    })
}

/// Powers of the bins of a frame of 2^n samples, through a Hann window whose squares sum to 1.
fn powers(frame: &[f64]) -> Vec<f64> {
    let length = frame.len() as f64;
    let window =
        |n: usize| (std::f64::consts::PI * (n as f64 + 0.5) / length).sin().powi(2) * (8.0 / 3.0 / length).sqrt();
    let mut input: Vec<f64> = frame.iter().enumerate().map(|(n, x)| x * window(n)).collect();
    let forward = fourier::forward(frame.len());
    let mut spectrum = forward.make_output_vec();
    forward.process(&mut input, &mut spectrum).expect("the frame has the length of the transform");
    spectrum.iter().map(|bin| bin.norm_sqr()).collect()
}

/// Mean of values, and the standard error of the mean.
fn mean(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (square / count).sqrt())
}

/// Squared magnitude `|F|²` of a first-order breakpoint at a frequency.
fn response(point: &Breakpoint, hz: f64) -> f64 {
    let (sine, cosine) = (std::f64::consts::TAU * hz / 48_000.0).sin_cos();
    let square = |c0: f64, c1: f64| (c0 + c1 * cosine).powi(2) + (c1 * sine).powi(2);
    square(point.b0, point.b1) / square(1.0, point.a1)
}

/// Compares energies of bands of noise through four standing filters with their responses.
///
/// The limit is 0.5 dB and three standard errors.
///
/// # Panics
/// If the limit is broken.
pub fn standing_bands(extent: Extent) {
    let seeds = extent.pick(20, SEEDS);
    let length = 8192;
    for (b0, b1, a1) in [(1.0, 0.0, 0.0), (0.1, 0.1, -0.8), (0.3, -0.25, 0.4), (0.02, 0.02, -0.99)] {
        let standing = |time_s| Breakpoint { b1, ..point(time_s, b0, a1) };
        let table = Table::of_path(vec![standing(0.0), standing(1.0)]);
        // Bands an octave wide whose edges rise by 1/3.4 octave, then adjacent bands of 600 Hz.
        let thirds = (0..24).map(|n| [100.0, 200.0].map(|hz: f64| hz * 2f64.powf(f64::from(n) / 3.4)));
        let equal = (0..40).map(|n| [0.0, 600.0].map(|hz: f64| hz + 600.0 * f64::from(n)));
        let bands: Vec<[f64; 2]> = thirds.chain(equal).filter(|band| band[1] <= 24_000.0).collect();
        let mut energies = vec![Vec::new(); bands.len()];
        let bins = |band: [f64; 2]| {
            let [from, to] = band.map(|hz| (hz / 48_000.0 * length as f64) as usize);
            from.max(2)..to.min(length / 2 - 1)
        };
        for sound in sounds(&table, seeds, 3000 + length) {
            let powers = powers(&sound[3000..]);
            for (energies, &band) in energies.iter_mut().zip(&bands) {
                energies.push(powers[bins(band)].iter().sum::<f64>());
            }
        }
        let mut worst = 0.0f64;
        for (energies, &band) in energies.iter().zip(&bands) {
            // The input is uniform noise with a standard deviation of 1/√3.
            let expected: f64 =
                bins(band).map(|bin| response(&standing(0.0), bin as f64 * 48_000.0 / length as f64) / 3.0).sum();
            let (mean, error) = mean(energies);
            let off_db = 10.0 * (mean / expected).log10();
            let allowed = 0.5 + 3.0 * 10.0 * (1.0 + error / mean).log10();
            worst = worst.max(off_db.abs());
            assert!(off_db.abs() <= allowed, "{band:?} Hz of {a1}: {off_db:.2} dB, {allowed:.2} allowed");
        }
        println!("a1 {a1}: {} bands within {worst:.2} dB", bands.len());
    }
}

/// Compares decays of noise through a moving filter with the reference's, within 3 %.
///
/// # Panics
/// If the limit is broken.
pub fn decays(extent: Extent) {
    // Fewer than 120 seeds scatter more than the test allows.
    let seeds = extent.pick(120, SEEDS);
    let path: Vec<_> = (0..=8)
        .map(|n| point(0.05 * f64::from(n), 0.3 * 10f64.powf(-0.3 * f64::from(n)), -0.3 - 0.07 * f64::from(n)))
        .collect();
    let table = Table::of_path(path.clone());
    let (length, hop) = (1024, 1024);
    let frames: usize = 18_432;
    // Slope in dB a second of three bands' energies, by a line through the frames' levels.
    let slopes = |sounds: &mut dyn Iterator<Item = Vec<f64>>| {
        let bands = [20..60, 60..160, 160..400usize];
        let mut energies = vec![vec![0.0; frames / hop]; bands.len()];
        let mut parts = Vec::new();
        for (seed, sound) in sounds.enumerate() {
            if seed % 20 == 0 {
                parts.push(energies.clone());
            }
            for (at, frame) in sound.chunks_exact(hop).enumerate() {
                let powers = powers(&frame[..length]);
                for (band, energies) in bands.iter().zip(parts.last_mut().expect("a part begins with its first seed")) {
                    energies[at] += powers[band.clone()].iter().sum::<f64>();
                }
            }
            energies.iter_mut().for_each(|of_band| of_band.fill(0.0));
        }
        let slope = |energies: &Vec<f64>| {
            let middle = (energies.len() as f64 - 1.0) / 2.0;
            let x = |n: usize| n as f64 - middle;
            let above: f64 = energies.iter().enumerate().map(|(n, e)| x(n) * 10.0 * e.log10()).sum();
            let below: f64 = (0..energies.len()).map(|n| x(n).powi(2)).sum();
            above / below * 48_000.0 / hop as f64
        };
        let of_band = |band: usize| mean(&parts.iter().map(|part| slope(&part[band])).collect::<Vec<_>>());
        [of_band(0), of_band(1), of_band(2)]
    };
    let theirs = reference::SampleRate { numerator: 48_000, denominator: 1 };
    let of_reference = |p: &Breakpoint| {
        let Breakpoint { time_s, a1, a2, b0, b1, b2, noise } = *p;
        reference::dynamic_filter::Breakpoint { time_s, noise, a1, a2, b0, b1, b2 }
    };
    let path: Vec<_> = path.iter().map(of_reference).collect();
    let mut random = Random::new(77);
    let mut exact = (0..seeds).map(|_| {
        let noise: Vec<f64> = (0..frames).map(|_| random.between(-1.0, 1.0)).collect();
        reference::dynamic_filter::Filter::new(1, &path, theirs).run(&[0], &noise)
    });
    let (ours, exact) = (slopes(&mut sounds(&table, seeds, frames)), slopes(&mut exact));
    for (band, ((ours, of_ours), (exact, of_exact))) in ours.into_iter().zip(exact).enumerate() {
        let allowed = 0.03 * exact.abs() + 3.0 * of_ours.hypot(of_exact);
        println!("band {band}: {ours:.2} dB/s against {exact:.2} dB/s, {allowed:.2} allowed");
        assert!((ours - exact).abs() <= allowed, "band {band}: {ours} against {exact}");
        assert!(exact < -20.0 && allowed < 0.1 * exact.abs(), "the test must be able to fail");
    }
}

/// Checks the power of four tables' noise for lines at multiples of the tick rate; -50 dB at most.
///
/// # Panics
/// If the limit is broken.
pub fn tick_lines(extent: Extent) {
    let tables = extent.pick(1, 4);
    let levels = |noise, time_s| Breakpoint { noise, ..point(time_s, 0.2, -0.6) };
    let ring = Loop { frequency_hz: 1000.0, bandwidth_hz: 400.0, gain: 0.3, delay_s: 32.5 / 48_000.0 };
    let looped = Table { loops: vec![ring; 2], ..Table::of_path(vec![point(0.0, 0.2, -0.6), point(2.0, 0.2, -0.6)]) };
    let exciter = Some(dsp_core::dynamic_filter::Exciter { low_hz: 90.0, high_hz: 9000.0, exponent: 0.0 });
    for (what, table) in [
        ("a moving filter", Table::of_path(vec![point(0.0, 0.4, -0.1), point(1.0, 0.05, -0.8), point(2.0, 0.2, 0.3)])),
        ("a moving level", Table::of_path(vec![levels(1.0, 0.0), levels(0.1, 0.4), levels(0.7, 2.0)])),
        ("loops", looped),
        ("an exciter", Table { exciter, ..Table::of_path(vec![point(0.0, 0.2, -0.6), point(2.0, 0.1, -0.3)]) }),
    ]
    .into_iter()
    .take(tables)
    {
        let frames = 90_000;
        let mut envelope = vec![0.0; frames];
        for sound in sounds(&table, SEEDS, frames) {
            envelope.iter_mut().zip(&sound).for_each(|(power, x)| *power += x * x);
        }
        let all: f64 = envelope.iter().sum();
        // This window keeps the spectrum of the sound's two ends far below the lines.
        let window = |n: usize| (std::f64::consts::PI * (n as f64 + 0.5) / frames as f64).sin().powi(4);
        let line_db = |hz: f64| {
            let (mut re, mut im, mut whole) = (0.0, 0.0, 0.0);
            for (n, power) in envelope.iter().enumerate() {
                let (sine, cosine) = (std::f64::consts::TAU * hz / 48_000.0 * n as f64).sin_cos();
                let power = power * window(n);
                (re, im, whole) = (re + power * cosine, im + power * sine, whole + power);
            }
            20.0 * (f64::hypot(re, im) / whole).log10()
        };
        let worst = (1..=8).map(|k| line_db(1500.0 * f64::from(k))).fold(f64::NEG_INFINITY, f64::max);
        println!("{what}: lines at multiples of the tick rate below {worst:.1} dB");
        assert!(all > 0.0 && worst < -50.0, "{what}: {worst}");
    }
}
