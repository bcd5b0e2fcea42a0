//! Faults of a written table: modes out of range, modes that cancel, partials without a mode.
//!
//! | column | definition |
//! | --- | --- |
//! | low | modes below 20 Hz |
//! | fast | modes whose decay exceeds that of the search |
//! | gains | modes whose gain (sine and cosine together) lies outside 0.001 to 100 |
//! | cancelling | pairs of modes within their widths that cancel by more than 6 dB |
//! | partials | how many of the five loudest audible partials are right |
//! | tonal | share of the first spectrum's power within three bins of its audible partials |
//! | too loud | largest level of a mode at velocity 0.5 and 0.25 over the force's own law, in dB |
//! | dip | largest rise of the contact's spectrum above a mode's frequency, in dB |
//! | wrong partials | partials that are not right, with the nearest mode and the level's error |
//!
//! Two modes lie within their widths if they are nearer than `(d1 + d2)/2π`. They cancel by more
//! than 6 dB if the sum of the gains is below half the sum of their magnitudes. A partial is right
//! if a mode lies within 0.5 % or half a bin, and the rendering's level is within 3 dB. A strike
//! whose partials have less than half of the power is noise.
//!
//! The force's own law is `v^(a+b)`, the impulse, at low frequencies; where the contact is long
//! against a period it is `v^(a-b)`. The limit is the louder of the two, `v^(a+b)` for b < 0.

use std::f64::consts::TAU;

use fit::contact;
use fit::hearing::Heard;
use fit::modes;
use fit::recording::Fitted;

/// Lowest frequency of a mode in Hz.
const LOWEST_HZ: f64 = 20.0;
/// Least and largest gain of a mode.
const GAINS: [f64; 2] = [1e-3, 100.0];
/// Number of partials that are looked for.
const PARTIALS: usize = 5;
/// Relative distance of a partial from its mode.
const NEAR: f64 = 0.005;
/// Softer strikes that are compared with one at velocity 1.
const VELOCITIES: [f64; 2] = [0.5, 0.25];
/// Highest frequency of the contact's spectrum that is compared with a mode's, in Hz.
const HIGHEST_HZ: f64 = 20_000.0;

/// Figures of a table.
pub(crate) struct Checks {
    pub(crate) low: usize,
    pub(crate) fast: usize,
    pub(crate) gains: usize,
    pub(crate) cancelling: usize,
    pub(crate) partials: usize,
    pub(crate) wanted_partials: usize,
    pub(crate) wrong: String,
    pub(crate) tonal: f64,
    pub(crate) too_loud_db: f64,
    pub(crate) dip_db: f64,
}

struct Mode {
    angular: f64,
    decay: f64,
    gain: (f64, f64),
}

impl Checks {
    /// Looks at a fitted table and its rendering.
    pub(crate) fn of(fitted: &Fitted, heard: &Heard) -> Self {
        let object = &fitted.table.objects[0];
        let striker = &fitted.table.strikers[0];
        let modes: Vec<Mode> = object
            .modes
            .iter()
            .map(|mode| {
                let gain = mode.gains[0];
                Mode {
                    angular: TAU * f64::from(mode.frequency_hz),
                    decay: f64::from(mode.decay_per_s),
                    gain: (f64::from(gain.sine), f64::from(gain.cosine)),
                }
            })
            .collect();
        let fastest = modes::Settings::default().fastest_decay_per_s;
        let size = |mode: &Mode| mode.gain.0.hypot(mode.gain.1);
        let [least, most] = GAINS;
        let (partials, wanted_partials, wrong) = partials(fitted, heard, &modes);
        let rate_hz = fitted.recording.rate_hz;
        let contact_s = f64::from(striker.contact_time_s);
        let spectrum = Spectrum::new(contact_s, rate_hz);
        let highest: Vec<f64> =
            (0..=200).map(|step| HIGHEST_HZ.min(0.45 * rate_hz) * f64::from(step) / 200.0).collect();
        let dip_db = |mode: &Mode| {
            let level = |hz: f64| spectrum.level_db(TAU * hz, 0.0);
            let hz = mode.angular / TAU;
            let later = highest.iter().filter(|later| **later > hz).map(|later| level(*later));
            later.fold(level(hz), f64::max) - level(hz)
        };
        let (a, b) = (f64::from(striker.peak_exponent), f64::from(striker.contact_exponent));
        let too_loud_db = |velocity: f64| {
            let softer = Spectrum::new(contact_s * velocity.powf(b), rate_hz);
            let force_db = 20.0 * a * velocity.log10();
            let law_db = 20.0 * (a + b).min(a - b) * velocity.log10();
            let over = |mode: &Mode| {
                softer.level_db(mode.angular, mode.decay) - spectrum.level_db(mode.angular, mode.decay) + force_db
                    - law_db
            };
            modes.iter().map(over).fold(f64::NEG_INFINITY, f64::max)
        };
        let cancel = |a: &Mode, b: &Mode| {
            (a.angular - b.angular).abs() < a.decay + b.decay
                && (a.gain.0 + b.gain.0).hypot(a.gain.1 + b.gain.1) < 0.5 * (size(a) + size(b))
        };
        Self {
            low: modes.iter().filter(|mode| mode.angular < TAU * LOWEST_HZ).count(),
            fast: modes.iter().filter(|mode| mode.decay > fastest * (1.0 + 1e-6)).count(),
            gains: modes.iter().filter(|mode| !(least..=most).contains(&size(mode))).count(),
            cancelling: (0..modes.len())
                .map(|k| modes[k + 1..].iter().filter(|other| cancel(&modes[k], other)).count())
                .sum(),
            partials,
            wanted_partials,
            wrong,
            tonal: heard.partials().tonal_share(),
            too_loud_db: VELOCITIES.map(too_loud_db).into_iter().fold(f64::NEG_INFINITY, f64::max),
            dip_db: modes.iter().map(dip_db).fold(0.0, f64::max),
        }
    }

    /// Head of the columns that [`Self::line`] prints.
    pub(crate) const HEAD: &str =
        "low | fast | gains | cancelling | partials | tonal | too loud, dB | dip, dB | wrong partials |";

    /// The figures as cells of a table.
    pub(crate) fn line(&self) -> String {
        format!(
            "{} | {} | {} | {} | {} of {} | {:.2} | {:+.1} | {:.1} | {} |",
            self.low,
            self.fast,
            self.gains,
            self.cancelling,
            self.partials,
            self.wanted_partials,
            self.tonal,
            self.too_loud_db,
            self.dip_db,
            self.wrong
        )
    }
}

/// Spectrum of a contact with a peak force of 1.
struct Spectrum {
    force: Vec<f64>,
    rate_hz: f64,
}

impl Spectrum {
    fn new(contact_s: f64, rate_hz: f64) -> Self {
        Self { force: contact::force(contact_s, rate_hz), rate_hz }
    }

    /// Level in dB at which the contact leaves a mode ringing.
    fn level_db(&self, angular: f64, decay: f64) -> f64 {
        let (mut re, mut im) = (0.0, 0.0);
        for (n, force) in self.force.iter().enumerate() {
            let time_s = (n as f64 - self.force.len() as f64) / self.rate_hz;
            let (sine, cosine) = (angular * time_s).sin_cos();
            let grown = force * (decay * time_s).exp();
            re += grown * cosine;
            im -= grown * sine;
        }
        20.0 * (re.hypot(im) / self.rate_hz).max(1e-30).log10()
    }
}

/// Number of the loudest partials that are right, the number of those looked for, and the others:
/// their frequency, that of the nearest mode, and the error of the level.
fn partials(fitted: &Fitted, heard: &Heard, modes: &[Mode]) -> (usize, usize, String) {
    let errors_db = heard.partials().errors_db(&fitted.whole);
    let bin_hz = heard.partials().bin_hz();
    let loudest = heard.partials().loudest(PARTIALS);
    let loudest: Vec<(f64, f64)> =
        loudest.iter().map(|(index, partial)| (partial.frequency_hz, errors_db[*index])).collect();
    let nearest = |hz: f64| {
        let distance = |mode: &&Mode| (mode.angular / TAU - hz).abs();
        modes.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).map_or(0.0, |mode| mode.angular / TAU)
    };
    let is_right = |&(hz, error_db): &(f64, f64)| {
        (nearest(hz) - hz).abs() <= (NEAR * hz).max(0.5 * bin_hz) && error_db.abs() <= 3.0
    };
    let wrong: Vec<String> = loudest
        .iter()
        .filter(|partial| !is_right(partial))
        .map(|&(hz, error_db)| format!("{hz:.0} Hz (mode {:.0}, {error_db:+.1} dB)", nearest(hz)))
        .collect();
    (loudest.len() - wrong.len(), loudest.len(), wrong.join(", "))
}
