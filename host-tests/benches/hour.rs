//! Rolls on every stage for an hour: `cargo bench -p host-tests --bench hour [-- SECONDS]`.
//!
//! Prints the strikes, the peak, the levels of the loudest and the softest minute, and the time to
//! silence. Also prints if blocks of 32 and of 480 frames gave equal bits.

use std::thread;

use host_tests::rolls::roll;
use indicatif::{ProgressBar, ProgressStyle};

fn main() {
    let seconds = std::env::args().find_map(|argument| argument.parse().ok()).unwrap_or(3600.0);
    let bar = ProgressBar::new(seconds as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos} of {len} s played, {eta} left") {
        bar.set_style(style);
    }
    let other = thread::spawn(move || roll(seconds, 480, |_| {}));
    let rolled = roll(seconds, 32, |played_s| bar.set_position(played_s as u64));
    bar.finish_and_clear();
    let same = other.join().is_ok_and(|other| other.hash == rolled.hash);
    let loudest = rolled.minute_rms.iter().copied().fold(0.0, f64::max);
    let softest = rolled.minute_rms.iter().copied().fold(f64::INFINITY, f64::min);
    println!(
        "{} strikes in {seconds} s; peak {:.3} of full scale; rms of a minute {:.2} to {:.2} dBFS; {}; blocks of 32 and 480 frames: {}",
        rolled.strikes,
        rolled.peak,
        20.0 * softest.log10(),
        20.0 * loudest.log10(),
        rolled
            .silent_after_s
            .map_or("NOT SILENT within a minute".into(), |s| format!("silent {s:.1} s after the last strike")),
        if same { "the same bits" } else { "NOT the same bits" }
    );
}
