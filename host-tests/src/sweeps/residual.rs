//! Sweeps of the residual stage: energies, decays, flatness, sums of strikes, long rolls.

use dsp_core::noise::Sfc32;
use dsp_core::residual::ResidualBand;
use dsp_core::resonator::TICK_FRAMES;

use super::Extent;
use crate::residual::spectrum::{between, energy_spectrum};
use crate::residual::statistics::{Measured, decays, energies as energies_of, ideal_sound, mean_and_error, sounds};
use crate::residual::{Spacing, edges_hz, play, shaper};

/// Number of seeds over which figures are averaged.
pub const SEEDS: u32 = 200;
/// Number of frames of a sound: 1.4 s.
const FRAMES: usize = 65_536;

/// Bands of equal density. `decay` gives the decay in dB/s of the band with a number.
pub fn bands(
    spacing: Spacing,
    count: usize,
    range_hz: [f64; 2],
    mut decay: impl FnMut(usize) -> f64,
) -> Vec<ResidualBand> {
    let edges = edges_hz(spacing, count, range_hz);
    let mut band = |(index, edges): (usize, &[f64])| ResidualBand {
        edges_hz: [edges[0] as f32, edges[1] as f32],
        weight: (0.003 * ((edges[1] - edges[0]) / 100.0).sqrt()) as f32,
        decay_db_per_s: decay(index) as f32,
    };
    edges.windows(2).enumerate().map(&mut band).collect()
}

/// Largest error less three standard errors, in dB.
fn worst(measured: &[Measured]) -> f64 {
    measured.iter().map(|m| m.error.abs() - 3.0 * m.standard_error).fold(0.0, f64::max)
}

/// Source of random decays between 20 and 400 dB/s, evenly distributed.
fn random_decays(seed: u32) -> impl FnMut(usize) -> f64 {
    let mut random = Sfc32::new(seed, 77);
    move |_| 20.0 + 380.0 * f64::from(random.draw()) / 2f64.powi(32)
}

/// Number of bands whose error less three standard errors is above half a dB.
fn misses(measured: &[Measured]) -> usize {
    measured.iter().filter(|m| m.error.abs() - 3.0 * m.standard_error > 0.5).count()
}

/// Measures energies of a hundred smooth bands in either spacing.
///
/// The limit is 0.5 dB beyond three standard errors.
///
/// # Panics
/// If the limit is broken.
pub fn energies(extent: Extent) {
    let seeds = extent.pick(20, SEEDS);
    for (spacing, range_hz) in [(Spacing::Erb, [50.0, 23_500.0]), (Spacing::Linear, [50.0, 23_500.0])] {
        let bands = bands(spacing, 100, range_hz, |index| 120.0 + 2.0 * index as f64);
        let measured = energies_of(&bands, &sounds(&bands, seeds, FRAMES));
        let mean = measured.iter().map(|m| m.error.abs()).sum::<f64>() / 100.0;
        println!("{spacing:?}: mean |error| {mean:.2} dB, worst beyond 3 s.e. {:.2} dB", worst(&measured));
        assert!(worst(&measured) < 0.5, "{spacing:?}: {measured:?}");
    }
}

/// Measures energies of a hundred bands of random decays, for several tables in either spacing.
///
/// # Panics
/// If the limit is broken.
pub fn energies_beside_longer_ones(extent: Extent) {
    let tables = extent.pick(1, 6);
    // Spectral lines of a frame are 48 000/1024 Hz apart.
    const WIDE_HZ: f32 = 2.0 * 48_000.0 / 1_024.0;
    // A wide band between two lines may be 0.6 dB off, if a neighbour of 2.5 lines lasts ten times
    // as long.
    for (spacing, most_misses) in [(Spacing::Linear, 0), (Spacing::Erb, 1)] {
        let mut missed = 0;
        for seed in 0..tables {
            let bands = bands(spacing, 100, [50.0, 23_500.0], random_decays(seed));
            let measured = energies_of(&bands, &sounds(&bands, SEEDS, FRAMES));
            let (wide, narrow): (Vec<_>, Vec<_>) =
                bands.iter().zip(measured).partition(|(band, _)| band.edges_hz[1] - band.edges_hz[0] > WIDE_HZ);
            let only =
                |part: &[(&ResidualBand, Measured)]| part.iter().map(|(_, measured)| *measured).collect::<Vec<_>>();
            let (wide, narrow) = (only(&wide), only(&narrow));
            println!(
                "{spacing:?}, seed {seed}: {} bands of 94 Hz and more, worst {:.2} dB beyond 3 s.e.; of {} narrower ones {} miss, worst {:.2}",
                wide.len(),
                worst(&wide),
                narrow.len(),
                misses(&narrow),
                worst(&narrow)
            );
            missed += misses(&wide);
            assert!(missed <= most_misses && worst(&wide) < 0.7, "{spacing:?}, seed {seed}: {wide:?}");
        }
    }
}

/// Measures energies of 10, 30 and 100 bands of random decays and densities, for several tables.
///
/// # Panics
/// If the limit is broken.
pub fn energies_beside_louder_ones(extent: Extent) {
    let tables = extent.pick(1, 12);
    // The bands are 50, 16 and 5 lines wide. A band of five lines is a dB off if it has 20 dB less
    // than its neighbour and the neighbour lasts ten times as long.
    for (count, most_misses) in [(10, 0), (30, 0), (100, 1)] {
        let mut missed = 0;
        for seed in 0..tables {
            let mut random = Sfc32::new(seed, 78);
            let mut bands = bands(Spacing::Linear, count, [100.0, 23_500.0], random_decays(seed));
            // Densities lie within 20 dB of each other.
            for band in &mut bands {
                band.weight *= 10f64.powf(f64::from(random.draw()) / 2f64.powi(32) - 0.5) as f32;
            }
            let measured = energies_of(&bands, &sounds(&bands, SEEDS, FRAMES));
            println!("{count} bands, seed {seed}: worst {:.2} dB beyond 3 s.e.", worst(&measured));
            missed += misses(&measured);
            assert!(missed <= most_misses && worst(&measured) < 1.0, "{count} bands, seed {seed}: {measured:?}");
        }
    }
}

/// Measures decays of eight bands beside faster and slower ones; they hold within 3 %.
///
/// # Panics
/// If the limit is broken.
pub fn decays_beside_others(extent: Extent) {
    let seeds = extent.pick(20, SEEDS);
    let decays_db_per_s = [400.0, 60.0, 250.0, 100.0, 400.0, 150.0, 300.0, 60.0];
    let bands = bands(Spacing::Linear, 8, [500.0, 20_500.0], |index| decays_db_per_s[index]);
    let measured = decays(&bands, &sounds(&bands, seeds, FRAMES), 0.0, 20.0);
    println!("{decays_db_per_s:?} dB/s: {measured:.3?}");
    for measured in measured {
        assert!((measured.error - 1.0).abs() < 0.03 + 3.0 * measured.standard_error, "{measured:?}");
    }
}

/// Measures decays of eight equal bands at 60, 200 and 600 dB/s; they hold within 3 %.
///
/// # Panics
/// If the limit is broken.
pub fn decays_of_equal_bands(extent: Extent) {
    let seeds = extent.pick(20, SEEDS);
    for decay_db_per_s in [60.0, 200.0, 600.0] {
        let bands = bands(Spacing::Linear, 8, [500.0, 20_500.0], |_| decay_db_per_s);
        let sounds = sounds(&bands, seeds, FRAMES);
        let measured = decays(&bands, &sounds, 0.0, 20.0);
        println!("{decay_db_per_s} dB/s: {measured:.3?}");
        for measured in measured {
            assert!(
                (measured.error - 1.0).abs() < 0.03 + 3.0 * measured.standard_error,
                "{decay_db_per_s}: {measured:?}"
            );
        }
    }
}

/// Compares decays of a hundred bands with those of the reference's own noise, within 3 %.
///
/// # Panics
/// If the limit is broken.
pub fn decays_of_a_hundred_bands(extent: Extent) {
    let seeds = extent.pick(20, SEEDS);
    // A sharp cut of a narrow band smears its beginning, in the reference's noise as in
    // `dsp-core`'s.
    const FRAMES: usize = 32_768;
    let (tables, ideal_seeds) = extent.pick((1, 8), (2, 30));
    let smooth = |index: usize| 120.0 + 2.0 * index as f64;
    let all = [
        ("linear, at random", bands(Spacing::Linear, 100, [50.0, 23_500.0], random_decays(3))),
        ("ERB, smooth", bands(Spacing::Erb, 100, [50.0, 23_500.0], smooth)),
    ];
    for (name, bands) in all.into_iter().take(tables) {
        let ours = decays(&bands, &sounds(&bands, seeds, FRAMES), 0.0, 20.0);
        let ideal: Vec<Vec<f64>> = (0..ideal_seeds).map(|seed| ideal_sound(&bands, seed, FRAMES)).collect();
        let ideal = decays(&bands, &ideal, 0.0, 20.0);
        let beyond = ours.iter().zip(&ideal).map(|(ours, ideal)| {
            let standard_error = ours.standard_error.hypot(ideal.standard_error) / ideal.error;
            (ours.error / ideal.error - 1.0).abs() - 3.0 * standard_error
        });
        let worst = beyond.fold(0.0, f64::max);
        println!("decays of a hundred bands, {name}: worst {:.1} % beyond 3 s.e. of the reference's", 100.0 * worst);
        assert!(worst < 0.03, "{name}: {worst}");
    }
}

/// Measures the flatness of a band of 10 kHz in twenty parts; it holds within 1 dB.
///
/// # Panics
/// If the limit is broken.
pub fn flatness(extent: Extent) {
    let seeds = extent.pick(20, SEEDS);
    let bands = bands(Spacing::Linear, 1, [2_000.0, 12_000.0], |_| 100.0);
    let spectra: Vec<Vec<f64>> = sounds(&bands, seeds, FRAMES).iter().map(|sound| energy_spectrum(sound)).collect();
    // The twenty parts cover the inner nine tenths, because the edges are blurred by 70 Hz.
    let parts: Vec<f64> = (0..20)
        .map(|part| {
            let from = 2_500.0 + 450.0 * f64::from(part);
            let each: Vec<f64> = spectra.iter().map(|spectrum| between(spectrum, [from, from + 450.0])).collect();
            10.0 * mean_and_error(&each).0.log10()
        })
        .collect();
    let mean = parts.iter().sum::<f64>() / 20.0;
    let worst = parts.iter().map(|part| (part - mean).abs()).fold(0.0, f64::max);
    println!("flat within {worst:.2} dB");
    assert!(worst < 1.0, "{parts:?}");
}

/// Compares the energy of three strikes at several gaps with their sum, within 0.04 dB.
///
/// # Panics
/// If the limit is broken.
pub fn strikes_add(extent: Extent) {
    let gaps: &[usize] = extent.pick(&[20], &[3, 20, 100, 500, 767, 800, 1_000, 3_000]);
    let bands = bands(Spacing::Linear, 4, [1_000.0, 9_000.0], |_| 100.0);
    let energy = |strikes: &[(usize, f32)]| {
        let of = |seed| play(&mut shaper(&bands, seed), strikes, 48_000);
        (0..SEEDS).flat_map(of).map(|x| f64::from(x).powi(2)).sum::<f64>()
    };
    let single = energy(&[(0, 1.0)]);
    for &gap in gaps {
        let sum = energy(&[(0, 1.0), (gap, 0.5), (2 * gap, 0.7)]) / (single * (1.0 + 0.25 + 0.49));
        println!("three strikes {gap} frames apart: {:.2} dB", 10.0 * sum.log10());
        assert!((10.0 * sum.log10()).abs() < 0.04, "{gap}: {sum}");
    }
}

/// Plays as many strikes as an hour of rolls at ten a second, but only eight ticks apart.
///
/// The sound is bounded, and silent in the end.
///
/// # Panics
/// If the limit is broken.
pub fn rolls(extent: Extent) {
    let strikes = extent.pick(3_600, 36_000);
    // Number of strikes: an hour at ten a second, or a tenth of it.
    let bands = bands(Spacing::Erb, 20, [50.0, 23_500.0], |index| 5.0 + 40.0 * index as f64);
    let mut shaper = shaper(&bands, 1);
    let (mut loudest, mut random) = (0, Sfc32::new(5, 5));
    for _ in 0..strikes {
        shaper.strike(1.0, (random.draw() % 32) as usize);
        for _ in 0..8 {
            let mut out = [0; TICK_FRAMES];
            shaper.render(&mut out);
            shaper.end_tick(0);
            loudest = out.iter().map(|x| x.unsigned_abs()).fold(loudest, u32::max);
        }
    }
    assert!(loudest < 1 << 30, "{loudest}");
    // At 5 dB/s the slowest band takes half a minute to -110 dBFS.
    let end = play(&mut shaper, &[], 40 * 48_000);
    assert!(!shaper.is_active() && end[39 * 48_000..].iter().all(|&x| x == 0));
}
