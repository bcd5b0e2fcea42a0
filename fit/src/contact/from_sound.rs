//! Contact time from the spectrum of a strike.
//!
//! The spectrum of a strike is the contact's spectrum times the object's response. That response
//! has peaks at the modes, but rises steadily between them, by about 3 dB an octave. (Measured on
//! strikes of an impact hammer on a mug and a wooden holder: the median over the bins of a third
//! octave follows that line within some 8 dB from 0.5 to 12 kHz.) The pulse falls by 12 dB an
//! octave above its corner. So the estimate is the contact time whose third-octave levels, tilted
//! by 3 dB an octave, fit best.

use super::pulse::pulse_power;

/// Shortest and longest contact time that are tried, in seconds.
const RANGE_S: (f64, f64) = (1e-4, 4e-3);
/// Number of contact times that are tried.
const TRIED: usize = 160;
/// Range of the third-octave bands in Hz, as far as the sample rate allows.
const BANDS_HZ: (f64, f64) = (500.0, 12_000.0);
/// Rise of an object's response between its modes, as a power of frequency: 3 dB an octave.
const TILT: f64 = 1.0;
/// Rises that an object's response may have, as powers of frequency: -3 to 9 dB an octave.
const TILTS: [f64; 9] = [-1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0];
/// Share of the likelihood on either side of an interval.
const OUTSIDE: f64 = 0.05;
/// Factor by which an interval is wider on either side than the likelihood has it.
const MODEL_ERROR: f64 = 1.7;
/// Length of the sound that is analysed, in seconds.
const LENGTH_S: f64 = 0.18;
/// Scatter of a band's level about the line, in dB.
const SCATTER_DB: f64 = 8.0;
/// Power below which the spectrum is no longer the contact's: 50 dB under its maximum.
const LEAST_POWER: f64 = 1e-5;

/// Contact time of a strike in seconds, from its sound alone, which begins at the onset.
///
/// `None` if there is too little sound or bandwidth for five bands.
///
/// The force's width at half maximum is half of this time ([`super::pulse::PULSE_FWHM`]). On the 18
/// strikes of the two impact-hammer recordings it is within 20 % of the measured width on 15 or
/// more (`cargo test -p fit --test sounds hammer -- --nocapture`). Tilt, bands and scatter were
/// chosen on those strikes; other objects are untried.
pub fn contact_time_s(strike: &[f64], rate_hz: f64) -> Option<f64> {
    let bands = Bands::new(strike, rate_hz)?;
    // The mean over all contact times, weighted by likelihood, lies between two minima side by
    // side.
    let tried: Vec<(f64, f64)> = tried_s().map(|time_s| (bands.misfits(time_s, [TILT])[0], time_s.ln())).collect();
    let least = tried.iter().map(|(misfit, _)| *misfit).fold(f64::INFINITY, f64::min);
    let (mut weights, mut sum) = (0.0, 0.0);
    for (misfit, log_time) in tried {
        let weight = (-0.5 * (misfit - least) / SCATTER_DB.powi(2)).exp();
        weights += weight;
        sum += weight * log_time;
    }
    Some((sum / weights).exp())
}

/// Interval of contact times, in seconds, that agree with the sound of a strike.
///
/// `None` if there is too little sound or bandwidth for five bands.
///
/// The object's response may fall by 3 dB an octave, rise by 9 dB, or lie between them: each of
/// nine tilts is equally likely. Levels of bands scatter by 8 dB. By this likelihood the interval
/// holds 90 % of the contact times that are tried. Its ends then move out by a factor of 1.7,
/// because a real response is no straight line.
///
/// The interval holds the measured contact times of all 18 strikes of the two impact-hammer
/// recordings (`cargo test -p fit --test sounds hammer -- --nocapture`). The factor was chosen on
/// these strikes. The interval is about a factor of ten wide. It can be too short if the response
/// falls with frequency.
pub fn contact_interval_s(strike: &[f64], rate_hz: f64) -> Option<[f64; 2]> {
    let bands = Bands::new(strike, rate_hz)?;
    let misfits: Vec<(f64, [f64; 9])> = tried_s().map(|time_s| (time_s, bands.misfits(time_s, TILTS))).collect();
    let least = misfits.iter().flat_map(|tried| tried.1).fold(f64::INFINITY, f64::min);
    let weight = |misfit: &f64| (-0.5 * (misfit - least) / SCATTER_DB.powi(2)).exp();
    let weights: Vec<(f64, f64)> =
        misfits.iter().map(|(time_s, misfits)| (*time_s, misfits.iter().map(weight).sum())).collect();
    let all: f64 = weights.iter().map(|(_, weight)| weight).sum();
    let quantile = |share: f64| {
        let mut sum = 0.0;
        let reached = weights.iter().find(|(_, weight)| {
            sum += weight;
            sum >= share * all
        });
        reached.or(weights.last()).map(|(time_s, _)| *time_s)
    };
    Some([quantile(OUTSIDE)? / MODEL_ERROR, quantile(1.0 - OUTSIDE)? * MODEL_ERROR])
}

/// Contact times in seconds that are tried.
fn tried_s() -> impl Iterator<Item = f64> {
    (0..TRIED).map(|step| RANGE_S.0 * (RANGE_S.1 / RANGE_S.0).powf(step as f64 / (TRIED - 1) as f64))
}

/// Median levels of a strike's spectrum in third octaves.
struct Bands {
    bin_hz: f64,
    /// Bins of each band, and its level in dB.
    levels_db: Vec<(std::ops::Range<usize>, f64)>,
}

impl Bands {
    /// Levels of a strike; `None` if there is too little sound or bandwidth for five bands.
    fn new(strike: &[f64], rate_hz: f64) -> Option<Self> {
        let length = strike.len().min((LENGTH_S * rate_hz) as usize);
        if length < 256 {
            return None;
        }
        let size = ((2.0 * LENGTH_S * rate_hz) as usize).next_power_of_two();
        let transform = fourier::forward(size);
        let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
        for (n, (slot, x)) in input.iter_mut().zip(&strike[..length]).enumerate() {
            *slot = x * (0.5 + 0.5 * (std::f64::consts::PI * n as f64 / length as f64).cos());
        }
        transform.process(&mut input, &mut output).ok()?;
        let bin_hz = rate_hz / size as f64;
        let edges: Vec<f64> = (0..)
            .map(|third| BANDS_HZ.0 * 2f64.powf(f64::from(third) / 3.0))
            .take_while(|edge| *edge <= BANDS_HZ.1.min(0.46 * rate_hz))
            .collect();
        let levels_db = edges.windows(2).map(|edge| {
            let bins = (edge[0] / bin_hz).ceil() as usize..(edge[1] / bin_hz).ceil() as usize;
            let mut power: Vec<f64> = output[bins.clone()].iter().map(|bin| bin.norm_sqr()).collect();
            let middle = power.len() / 2;
            let (_, median, _) = power.select_nth_unstable_by(middle, f64::total_cmp);
            (bins, decibels(*median))
        });
        let levels_db: Vec<_> = levels_db.collect();
        (levels_db.len() >= 5).then_some(Self { bin_hz, levels_db })
    }

    /// Sums over bands of the squared error in dB of a contact's spectrum under a tilt.
    ///
    /// There is one sum for each power of frequency in `tilts`.
    fn misfits<const N: usize>(&self, contact_time_s: f64, tilts: [f64; N]) -> [f64; N] {
        let power = |bin: usize| pulse_power(bin as f64 * self.bin_hz, contact_time_s) + LEAST_POWER;
        let flat = self.levels_db.iter().map(|(bins, level_db)| {
            let mean = bins.clone().map(power).sum::<f64>() / bins.len() as f64;
            let centre_hz = (bins.start + bins.end) as f64 / 2.0 * self.bin_hz;
            (level_db - decibels(mean), decibels(centre_hz))
        });
        let flat: Vec<(f64, f64)> = flat.collect();
        tilts.map(|tilt| {
            let differences = flat.iter().map(|(difference, octaves)| difference - tilt * octaves);
            let mean = differences.clone().sum::<f64>() / flat.len() as f64;
            differences.map(|difference| (difference - mean).powi(2)).sum::<f64>()
        })
    }
}

fn decibels(power: f64) -> f64 {
    10.0 * power.max(1e-30).log10()
}
