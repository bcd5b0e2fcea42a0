//! Third octaves of forces, and how far two forces lie apart in them.

use fourier::Complex;

/// Middle frequencies of the third octaves from 50 Hz to 16 kHz.
pub fn middles_hz() -> impl Iterator<Item = f64> {
    (-13..=12).map(|third| 1000.0 * 2f64.powf(f64::from(third) / 3.0))
}

/// Energies of a force in third octaves about frequencies, under a Hann window.
pub fn energies(force: &[f64], rate_hz: f64, middles_hz: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let transform = fourier::forward(force.len());
    let turn = std::f64::consts::TAU / force.len() as f64;
    let mut windowed: Vec<f64> =
        force.iter().enumerate().map(|(n, x)| x * (0.5 - 0.5 * (turn * n as f64).cos())).collect();
    let mut bins = transform.make_output_vec();
    transform.process(&mut windowed, &mut bins).expect("slices of the plan's lengths");
    let bin_hz = rate_hz / force.len() as f64;
    let half = 2f64.powf(1.0 / 6.0);
    let energy = |middle_hz: f64| {
        let from = (middle_hz / half / bin_hz).ceil() as usize;
        let to = ((middle_hz * half / bin_hz).ceil() as usize).min(bins.len());
        bins[from.min(to)..to].iter().map(Complex::norm_sqr).sum::<f64>() / (force.len() as f64).powi(2)
    };
    middles_hz.into_iter().map(energy).collect()
}

/// Differences in dB of third octaves within 40 dB of the loudest: rms, and the largest.
#[derive(Clone, Copy, Debug)]
pub struct Apart {
    /// Root of the mean square in dB.
    pub rms_db: f64,
    /// Largest in size in dB.
    pub most_db: f64,
}

/// Compares the energies of a force with exact ones.
pub fn apart(exact: &[f64], energies: &[f64]) -> Apart {
    let loudest = exact.iter().copied().fold(0.0, f64::max);
    let pairs = exact.iter().zip(energies).filter(|(exact, _)| **exact > 1e-4 * loudest);
    let errors: Vec<f64> = pairs.map(|(exact, energy)| 10.0 * (energy / exact).log10()).collect();
    let square: f64 = errors.iter().map(|error| error * error).sum();
    Apart {
        rms_db: (square / errors.len() as f64).sqrt(),
        most_db: errors.iter().copied().fold(0.0, |most, error| most.max(error.abs())),
    }
}
