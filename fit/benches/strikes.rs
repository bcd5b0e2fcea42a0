//! Measures the joint fit on synthetic recordings of many strikes, beside the Cramer-Rao bounds.
//!
//! `cargo bench -p fit --bench strikes` prints medians over six seeds of four sets;
//! `-- SEEDS FIRST` chooses the number of seeds and the first one, `-- SEEDS FIRST SET` one set of
//! `plain`, `clipped`, `places` and `room`; `-- time` prints how time and memory grow with the
//! length, and `-- time 30 1800` those of recordings of 30 s and of 30 minutes;
//! `-- twice SEEDS FIRST` prints how much longer 60 s take than 30 s.

use cpu_time::ProcessTime;
use fit::modes::Settings;
use fit::multi_strike::synthetic::{StruckOften, TrueMode, TrueStrike, at_places, in_room, plain};
use fit::multi_strike::{Estimate, Layout, ModeEstimate, StrikeEstimate, cramer_rao, estimate};
use fit::room::RoomBand;
use fit::score::quantile;

/// Largest distance in seconds of a found strike from the true one.
const NEAR_S: f64 = 0.01;
/// Largest distance in cents of a found mode from the true one.
const NEAR_CENTS: f64 = 12.0;
/// Bound of T60 in percent up to which a mode is heard.
const HEARD_PERCENT: f64 = 5.0;

/// Errors of a number over seeds, with the bounds and the stated deviations.
#[derive(Default)]
struct Errors {
    errors: Vec<f64>,
    bounds: Vec<f64>,
    within: usize,
}

impl Errors {
    fn add(&mut self, error: f64, bound: f64, stated: f64) {
        self.errors.push(error.abs());
        self.bounds.push(bound);
        self.within += usize::from(error.abs() <= stated);
    }

    fn print(&self, what: &str) {
        println!(
            "{what:28} median {:9.4}, 90 % below {:9.4}; bound {:9.4}; {:3.0} % within one stated deviation",
            quantile(&self.errors, 0.5),
            quantile(&self.errors, 0.9),
            quantile(&self.bounds, 0.5),
            100.0 * self.within as f64 / self.errors.len().max(1) as f64
        );
    }
}

#[derive(Default)]
struct Tally {
    found: usize,
    strikes: usize,
    spurious: usize,
    striker_right: usize,
    heard: usize,
    heard_found: usize,
    modes: usize,
    reported: usize,
    cents: Errors,
    t60_percent: Errors,
    middle_us: Errors,
    contact_percent: Errors,
    peak_db: Errors,
    left_db: Vec<f64>,
    /// T60 in percent and level in dB of rooms over the true ones.
    room: [Vec<f64>; 2],
    seconds: Vec<f64>,
}

impl Tally {
    fn add(&mut self, sound: &StruckOften, fit: &Estimate, bounds: &Estimate, seconds: f64) {
        self.seconds.push(seconds);
        self.left_db.push(fit.left_dbfs - 20.0 * sound.noise_rms.log10());
        if let Some([t60_percent, level_db]) = errors_of_room(sound, fit) {
            self.room[0].push(t60_percent.abs());
            self.room[1].push(level_db.abs());
        }
        self.modes += sound.modes.len();
        self.reported += fit.modes.len();
        for truth in &sound.modes {
            let is_own = |bound: &&ModeEstimate| (bound.frequency_hz / truth.frequency_hz - 1.0).abs() < 1e-9;
            let Some(bound) = bounds.modes.iter().find(is_own) else { continue };
            let cents = |mode: &ModeEstimate| 1200.0 * (mode.frequency_hz / truth.frequency_hz).log2();
            let nearest = fit.modes.iter().min_by(|a, b| cents(a).abs().total_cmp(&cents(b).abs()));
            let is_heard = 100.0 * bound.decay_per_s_sd / bound.decay_per_s < HEARD_PERCENT;
            self.heard += usize::from(is_heard);
            if let Some(mode) = nearest.filter(|mode| is_heard && cents(mode).abs() < NEAR_CENTS) {
                self.heard_found += 1;
                self.add_mode(truth, mode, bound);
            } else if is_heard {
                eprintln!("no mode within {NEAR_CENTS} cents of {:.1} Hz:", truth.frequency_hz);
            }
        }
        self.strikes += sound.strikes.len();
        let mut taken = vec![false; fit.strikes.len()];
        // Only ratios of peaks are told: the median ratio is the unit.
        let mut pairs = Vec::new();
        for (truth, bound) in sound.strikes.iter().zip(&bounds.strikes) {
            let apart = |strike: &StrikeEstimate| (strike.middle_s - truth.middle_s()).abs();
            let free = fit.strikes.iter().enumerate().filter(|(index, _)| !taken[*index]);
            let nearest = free.min_by(|a, b| apart(a.1).total_cmp(&apart(b.1)));
            if let Some((index, strike)) = nearest.filter(|(_, strike)| apart(strike) < NEAR_S) {
                taken[index] = true;
                pairs.push((truth, strike, bound));
            } else {
                let (at_s, peak_db) = (truth.middle_s(), 20.0 * truth.peak_force.log10());
                eprintln!("no strike within {:.0} ms of {at_s:.3} s, {peak_db:.1} dB:", 1e3 * NEAR_S);
            }
        }
        self.found += pairs.len();
        self.spurious += fit.strikes.len() - pairs.len();
        let ratio = |truth: &TrueStrike, strike: &StrikeEstimate| 20.0 * (strike.peak_force / truth.peak_force).log10();
        let ratios: Vec<f64> = pairs.iter().map(|(truth, strike, _)| ratio(truth, strike)).collect();
        let unit_db = quantile(&ratios, 0.5);
        for (truth, strike, bound) in pairs {
            self.striker_right += usize::from(truth.striker == strike.striker);
            self.middle_us.add(
                1e6 * (strike.middle_s - truth.middle_s()),
                1e6 * bound.middle_s_sd,
                1e6 * strike.middle_s_sd,
            );
            let percent = 100.0 / truth.contact_time_s;
            self.contact_percent.add(
                percent * (strike.contact_time_s - truth.contact_time_s),
                percent * bound.contact_time_s_sd,
                percent * strike.contact_time_s_sd,
            );
            let decibels = 20.0 / 10f64.ln();
            self.peak_db.add(
                ratio(truth, strike) - unit_db,
                decibels * bound.peak_force_sd / bound.peak_force,
                decibels * strike.peak_force_sd / strike.peak_force,
            );
        }
    }

    fn add_mode(&mut self, truth: &TrueMode, mode: &ModeEstimate, bound: &ModeEstimate) {
        let cents = |hz: f64| 1200.0 / 2f64.ln() * hz / truth.frequency_hz;
        self.cents.add(
            cents(mode.frequency_hz - truth.frequency_hz),
            cents(bound.frequency_hz_sd),
            cents(mode.frequency_hz_sd),
        );
        self.t60_percent.add(
            100.0 * (mode.t60_s() / truth.t60_s() - 1.0),
            100.0 * bound.decay_per_s_sd / bound.decay_per_s,
            100.0 * mode.decay_per_s_sd / mode.decay_per_s,
        );
    }

    fn print(&self) {
        let percent = |part: usize, whole: usize| 100.0 * part as f64 / whole.max(1) as f64;
        println!(
            "strikes found {:.1} %, false {:.1} %; heard modes found {:.1} % of {}, {:.2} reported for each true one",
            percent(self.found, self.strikes),
            percent(self.spurious, self.strikes),
            percent(self.heard_found, self.heard),
            self.heard,
            self.reported as f64 / self.modes.max(1) as f64
        );
        println!("striker right {:.1} %", percent(self.striker_right, self.found));
        self.cents.print("frequency, cents");
        self.t60_percent.print("T60, %");
        self.middle_us.print("middle of contact, µs");
        self.contact_percent.print("contact time, %");
        self.peak_db.print("peak, dB");
        if !self.room[0].is_empty() {
            let [t60, level] = [0, 1].map(|which| [0.5, 0.9].map(|share| quantile(&self.room[which], share)));
            println!(
                "{} rooms: T60 off by {:.1} %, 90 % below {:.1}; level {:.1} dB, {:.1}",
                self.room[0].len(),
                t60[0],
                t60[1],
                level[0],
                level[1]
            );
        }
        println!(
            "left over the noise {:.3} dB, at most {:.3}; {:.1} s of CPU time a fit, at most {:.1}",
            quantile(&self.left_db, 0.5),
            quantile(&self.left_db, 1.0),
            quantile(&self.seconds, 0.5),
            quantile(&self.seconds, 1.0)
        );
    }
}

/// T60 in percent and level in dB of a fitted room over those of the true one, if there are both;
/// the T60 is the geometric mean of the bands'.
fn errors_of_room(sound: &StruckOften, fit: &Estimate) -> Option<[f64; 2]> {
    let (truth, room) = (sound.room.as_ref()?, fit.room.as_ref()?);
    let ratio = |band: &RoomBand| {
        let [low, high] = band.edges_hz;
        (band.t60_s / truth.t60_s_at((low * high).sqrt())).ln()
    };
    let mean = room.bands.iter().map(ratio).sum::<f64>() / room.bands.len() as f64;
    Some([100.0 * (mean.exp() - 1.0), room.gain_db - truth.gain_db])
}

fn main() {
    let words: Vec<String> = std::env::args().collect();
    let numbers: Vec<u64> = words.iter().filter_map(|argument| argument.parse().ok()).collect();
    if words.iter().any(|word| word == "time") {
        return growth(if numbers.is_empty() { &[30, 60, 120] } else { &numbers });
    }
    let seeds = numbers.first().copied().unwrap_or(6);
    let first = numbers.get(1).copied().unwrap_or(101);
    let seeds = first..first + seeds;
    if words.iter().any(|word| word == "twice") {
        return twice(seeds);
    }
    let is_chosen = |set: &str| {
        words.iter().any(|word| word == set)
            || !["plain", "places", "room", "clipped"].iter().any(|any| words.iter().any(|word| word == any))
    };
    let one_place = Layout::default();
    if is_chosen("plain") {
        let of_plain = |seed: u64| plain(seed, 30.0, 50, -60.0);
        measure("plain: 50 strikes in 30 s, white noise -60 dBFS", seeds.clone(), one_place, WHOLE, of_plain);
    }
    if is_chosen("clipped") {
        let of_plain = |seed: u64| plain(seed, 30.0, 50, -60.0);
        for share in [0.7, 0.45] {
            let name = format!("clipped: plain, clipped at {share} of its peak; bounds without clipping");
            measure(&name, seeds.clone(), one_place, share, of_plain);
        }
    }
    if is_chosen("places") {
        let of_places = |seed: u64| at_places(seed, 60.0, 90);
        let layout = Layout { positions: 8, strikers: 2 };
        measure(
            "places: 90 strikes in 60 s, pink noise -60 dBFS; 8 positions",
            seeds.clone(),
            layout,
            WHOLE,
            of_places,
        );
    }
    if is_chosen("room") {
        let of_room = |seed: u64| in_room(seed, 30.0, 50);
        let name = "room: plain in a room, pink noise -56 dBFS; bounds without the room";
        measure(name, seeds, one_place, WHOLE, of_room);
    }
}

/// Prints how much more CPU time plain recordings of 60 s take than those of 30 s.
fn twice(seeds: std::ops::Range<u64>) {
    let mut ratios = Vec::new();
    for seed in seeds {
        let [half, whole] = [(30.0, 50), (60.0, 100)].map(|(seconds, strikes)| {
            let sound = plain(seed, seconds, strikes, -60.0);
            let start = ProcessTime::now();
            let fitted = estimate(&sound.samples, sound.rate_hz, Settings::default(), Layout::default(), |_| {});
            fitted.is_ok().then(|| start.elapsed().as_secs_f64())
        });
        match (half, whole) {
            (Some(half), Some(whole)) => {
                println!("seed {seed}: {half:.1} s of CPU time, then {whole:.1} s, {:.2} times as much", whole / half);
                ratios.push(whole / half);
            }
            _ => println!("seed {seed}: not fitted"),
        }
    }
    if !ratios.is_empty() {
        println!("median {:.2} times as much, 90 % below {:.2}", quantile(&ratios, 0.5), quantile(&ratios, 0.9));
    }
}

/// Prints CPU time and memory of plain recordings of 5 strikes in 3 s, of the given lengths in
/// seconds: each twice as long as the one before tells how time grows.
fn growth(lengths: &[u64]) {
    let mut before: Option<f64> = None;
    for &length in lengths {
        let sound = plain(101, length as f64, (length * 5 / 3) as usize, -60.0);
        let start = ProcessTime::now();
        let fitted = estimate(&sound.samples, sound.rate_hz, Settings::default(), Layout::default(), |_| {});
        let taken = start.elapsed().as_secs_f64();
        let outcome = match fitted {
            Ok(fit) => format!("{} strikes of {} found", fit.strikes.len(), sound.strikes.len()),
            Err(error) => error.to_string(),
        };
        let memory = peak_memory_mb().map_or(String::new(), |peak| {
            let a_sample = (peak - 64.0) * 1e6 / sound.samples.len() as f64;
            format!(", at most {peak:.0} MB of memory: 64 MB and {a_sample:.0} bytes a sample")
        });
        let growth = before.map_or(String::new(), |before| format!(", {:.2} times the one before", taken / before));
        println!("{length} s: {taken:.1} s of CPU time{growth}{memory}; {outcome}");
        before = Some(taken);
    }
}

/// Largest resident memory of this process so far, in units of 10^6 bytes; `None` but on Linux.
fn peak_memory_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()? * 1024.0 / 1e6)
}

/// Share of a sound's peak at which it is clipped so that nothing is.
const WHOLE: f64 = 1.0;

/// Fits a set of sounds that are clipped at a share of their peaks, and prints the errors.
fn measure(
    name: &str,
    seeds: std::ops::Range<u64>,
    layout: Layout,
    clipped_at: f64,
    sound: impl Fn(u64) -> StruckOften,
) {
    let mut tally = Tally::default();
    let (sets, mut fits) = (seeds.clone().count(), 0);
    for seed in seeds {
        let sound = sound(seed);
        let clipped = sound.clipped(clipped_at);
        let start = ProcessTime::now();
        let fitted = estimate(&clipped, sound.rate_hz, Settings::default(), layout, |_| {});
        let seconds = start.elapsed().as_secs_f64();
        match (fitted, cramer_rao(&sound)) {
            (Ok(fitted), Some(bounds)) => {
                eprintln!(
                    "seed {seed}: {} strikes of {}, {} modes of {}, {:+.3} dB over the noise{}, {seconds:.1} s",
                    fitted.strikes.len(),
                    sound.strikes.len(),
                    fitted.modes.len(),
                    sound.modes.len(),
                    fitted.left_dbfs - 20.0 * sound.noise_rms.log10(),
                    errors_of_room(&sound, &fitted).map_or(String::new(), |[t60_percent, level_db]| format!(
                        ", room T60 {t60_percent:+.0} %, level {level_db:+.1} dB"
                    ))
                );
                tally.add(&sound, &fitted, &bounds, seconds);
                fits += 1;
            }
            (Err(error), _) => println!("seed {seed}: {error}"),
            (_, None) => println!("seed {seed}: two modes cannot be told apart"),
        }
    }
    println!("{name}: {fits} of {sets} sets fitted; the others count nowhere below");
    if fits > 0 {
        tally.print();
    }
}
