//! Measures the separation on synthetic sets of 4 strikers, 4 things and 2 blows each, beside a
//! non-negative matrix factorization told the same labels.
//!
//! `cargo bench -p fit --bench separation` prints two sets; `-- SETS FIRST` chooses the number of
//! sets and the first seed, and `-- 0` prints the robot's clips alone.

mod nmf;
mod robot;

use std::time::Instant;

use fit::modes::Settings;
use fit::score::quantile;
use fit::separate::synthetic::{Blow, RATE_HZ, set};
use fit::separate::{Clip, Known, separate};

/// SI-SDR in dB: energy of the true sound at its best gain over that of the error (Le Roux et al.
/// 2019), for the whole recording.
fn si_sdr_db(estimate: &[f64], truth: &[f64]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let scale = dot(estimate, truth) / dot(truth, truth);
    let target = scale * scale * dot(truth, truth);
    let distance: f64 = estimate.iter().zip(truth).map(|(a, b)| (a - scale * b).powi(2)).sum();
    10.0 * (target.max(1e-30) / distance.max(1e-30)).log10()
}

fn print(what: &str, values: &[f64]) {
    println!("{what:24} median {:6.2} dB, worst tenth below {:6.2} dB", quantile(values, 0.5), quantile(values, 0.1));
}

fn main() {
    let numbers: Vec<u64> = std::env::args().skip(1).filter_map(|argument| argument.parse().ok()).collect();
    let (sets, first) = (numbers.first().copied().unwrap_or(2), numbers.get(1).copied().unwrap_or(1));
    let mut ours = [Vec::new(), Vec::new()];
    let mut theirs = [Vec::new(), Vec::new()];
    let mut left = Vec::new();
    for seed in first..first + sets {
        let set: Vec<Blow> = set(seed, 4, 4, 2);
        let clips: Vec<Clip<'_>> = set
            .iter()
            .map(|blow| Clip { samples: &blow.samples, rate_hz: RATE_HZ, object: blow.object, striker: blow.striker })
            .collect();
        let start = Instant::now();
        let separation =
            separate(&clips, &Known::default(), Settings::default(), &|_| {}).expect("the set can be separated");
        let seconds = start.elapsed().as_secs_f64();
        let [thing, striker] = [0, 1].map(|part: usize| {
            let each = separation.stems.iter().zip(&set).map(|(stems, blow)| match part {
                0 => si_sdr_db(&stems.object, &blow.of_object),
                _ => si_sdr_db(&stems.striker, &blow.of_striker),
            });
            each.collect::<Vec<f64>>()
        });
        println!(
            "set {seed}: thing {:.2} dB, striker {:.2} dB, {seconds:.1} s",
            quantile(&thing, 0.5),
            quantile(&striker, 0.5)
        );
        left.extend(separation.stems.iter().map(|stems| stems.left_db));
        ours[0].extend(thing);
        ours[1].extend(striker);
        for (stems, blow) in nmf::nmf(&set, 4, 4).iter().zip(&set) {
            theirs[0].push(si_sdr_db(&stems[0], &blow.of_object));
            theirs[1].push(si_sdr_db(&stems[1], &blow.of_striker));
        }
    }
    if sets > 0 {
        print("thing", &ours[0]);
        print("striker", &ours[1]);
        print("thing, NMF", &theirs[0]);
        print("striker, NMF", &theirs[1]);
        println!("left of the recordings   median {:6.2} dB", quantile(&left, 0.5));
    }
    robot::print();
}
