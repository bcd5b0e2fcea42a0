//! Chains of biquads played as modes and a direct term in the modal bank, compared with the bank of
//! biquads.
//!
//! Prints the table of `docs/biquads.md`, "Why a chain is not played as modes":
//! `cargo bench -p host-tests --bench biquads_as_modes`. A number as argument is the number of
//! banks in each row.

mod bank;
mod fit;
mod plan;

use dsp_core::SampleRate;
use fit::{Chain, Fit, log_of, on_grid};
use fourier::Complex;
use host_tests::biquads::{Chains, Roots, anywhere, near, noise, root};
use host_tests::snr::{Random, snr_db};
use std::f64::consts::PI;

/// Number of frames of noise, and of frames without input after it.
const FRAMES: usize = 24_000;

/// Draws poles and zeros of a number of sections, in chains of a given depth.
type Place = fn(&mut Random, usize, usize) -> (Roots, Roots);

/// Rows of the table. "Held" poles are those that a table of modes can hold in its `f32`.
const CLASSES: [(&str, Place); 9] = [
    ("radius above 0.72, held", |random, count, _| held(above(random, count, 0.72))),
    ("radius above 0.72", |random, count, _| above(random, count, 0.72)),
    ("any, held", |random, count, _| held(anywhere(random, count))),
    ("all of a chain equal, held", |random, count, depth| held(near(random, count, depth, 0.0))),
    ("within one width, held", |random, count, depth| held(near(random, count, depth, 1.0))),
    ("within four widths, held", |random, count, depth| held(near(random, count, depth, 4.0))),
    ("radius below 0.7", |random, count, _| {
        with_poles(random, count, |random| (random.between(0.0, 0.7), random.between(0.0, PI)))
    }),
    ("real, 0 to 0.9999", |random, count, _| with_poles(random, count, |random| (near_circle(random), 0.0))),
    ("real, -0.9999 to 0", |random, count, _| with_poles(random, count, |random| (near_circle(random), PI))),
];

fn with_poles(random: &mut Random, count: usize, pole: impl Fn(&mut Random) -> (f64, f64)) -> (Roots, Roots) {
    let (_, zeros) = anywhere(random, count);
    ((0..count).map(|_| pole(random)).collect(), zeros)
}

/// Draws a radius of 0 to 0.9999, evenly in the logarithm of its distance from 1.
fn near_circle(random: &mut Random) -> f64 {
    1.0 - 10f64.powf(-random.between(0.0, 4.0))
}

/// Draws poles of more than a given radius, as [`anywhere`] draws them.
fn above(random: &mut Random, count: usize, radius: f64) -> (Roots, Roots) {
    with_poles(random, count, |random| {
        loop {
            let found = root(random, 5.0);
            if found.0 > radius {
                return found;
            }
        }
    })
}

/// Moves poles to the nearest ones that a table of modes can hold. Poles that decay too fast for
/// the modal bank stay.
fn held((poles, zeros): (Roots, Roots)) -> (Roots, Roots) {
    let hold = |(radius, angle): (f64, f64)| {
        let Some(log) = log_of(radius, angle) else { return (radius, angle) };
        let nearest = on_grid(log, SampleRate::HZ_48000.hz());
        let is_rounding = (nearest - log).norm() < 1e-2 * log.re.abs();
        if is_rounding { (nearest.re.exp(), nearest.im) } else { (radius, angle) }
    };
    (poles.into_iter().map(hold).collect(), zeros)
}

/// Chains of a bank, given by the logarithms of their roots.
fn chains_of((poles, zeros): &(Roots, Roots), bank: &Chains) -> Vec<Chain> {
    let log = |roots: &[(f64, f64)]| -> Vec<Option<Complex<f64>>> {
        roots.iter().map(|&(radius, angle)| log_of(radius, angle)).collect()
    };
    let gains = bank.ours.chunks(bank.depth).map(|chain| chain.iter().map(|biquad| biquad.numerator[0]).product());
    let roots = poles.chunks(bank.depth).zip(zeros.chunks(bank.depth));
    roots.zip(gains).map(|((poles, zeros), gain)| Chain { poles: log(poles), zeros: log(zeros), gain }).collect()
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn main() {
    let banks = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(20);
    println!(
        "| poles | M | biquads, dB | modes, dB | without the bank's noise, dB | banks below 86 dB | modes a chain: mean, most |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (name, place) in CLASSES {
        for depth in 1..=4 {
            row(name, place, depth, banks);
        }
    }
}

/// Measures and prints the banks of one class and depth.
fn row(name: &str, place: Place, depth: usize, banks: usize) {
    let mut random = Random::new(77 + depth as u64);
    let (mut as_biquads, mut as_modes, mut fitted, mut counts) = (vec![], vec![], vec![], vec![]);
    for case in 0..banks {
        let roots = place(&mut random, depth * (1 + case % 3), depth);
        let mut input = noise(&mut random, FRAMES);
        input.resize(2 * FRAMES, 0);
        let chains = Chains::loud(&roots.0, &roots.1, depth, &input);
        let exact = chains.exact(&input);
        let mut out = vec![0; input.len()];
        host_tests::biquads::bank(&chains.ours, depth, 32)
            .expect("a bank that is accepted")
            .render(Some(&input), &mut out);
        as_biquads.push(snr_db(&exact, &out));
        let fits: Vec<Fit> = chains_of(&roots, &chains).iter().map(plan::modes_of).collect();
        fitted.extend(fits.iter().map(|fit| -10.0 * fit.missed.log10()));
        counts.extend(fits.iter().map(|fit| fit.modes.len() as f64));
        as_modes.push(snr_db(&exact, &bank::render(&fits, &input[..FRAMES], input.len())));
    }
    println!(
        "| {name} | {depth} | {:.0} | {:.0} | {:.0} | {} of {banks} | {:.1}, {:.0} |",
        least(&as_biquads),
        least(&as_modes),
        least(&fitted),
        as_modes.iter().filter(|&&db| db < 86.0).count(),
        counts.iter().sum::<f64>() / counts.len() as f64,
        counts.iter().copied().fold(0.0, f64::max),
    );
}
