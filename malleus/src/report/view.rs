//! The part of a fit that a page shows: the loudest strike, its sounds at one level, its spectra.

use fit::distance::{frame_distances_db, lead, lsd_window};
use fit::recording::Fitted;

/// Longest sound in a page, in seconds.
const LONGEST_S: f64 = 20.0;
/// Power relative to the loudest frame at which the recording counts as over: 60 dB down.
///
/// Pictures end where the recording falls below it for good.
const DIED_AWAY: f64 = 1e-6;
/// Shortest time that a picture shows, in seconds.
const SHORTEST_S: f64 = 0.3;
/// Peak of the recording in a page, 1.0 = full scale.
const PEAK: f64 = 0.9;
/// Window of the error over time, in samples.
const WINDOW: usize = 2048;

/// The loudest strike from its onset, as recorded and as rendered.
pub(super) struct View<'a> {
    /// Fit that the page is about.
    pub(super) fitted: &'a Fitted,
    /// Sample rate of all sounds in Hz.
    pub(super) rate_hz: f64,
    /// Samples of the recording before the onset.
    before: &'a [f64],
    /// Samples of the recording.
    pub(super) heard: &'a [f64],
    /// Samples of the instrument's rendering of the modes, as many as of the recording.
    pub(super) modes: &'a [f64],
    /// Samples of the instrument's rendering of modes and residual, as many as of the recording.
    pub(super) with_residual: &'a [f64],
    /// Number of samples that the pictures show.
    pub(super) shown: usize,
}

impl<'a> View<'a> {
    /// Takes the loudest strike out of a fit.
    pub(super) fn of(fitted: &'a Fitted) -> Self {
        let rate_hz = fitted.report.rate_hz;
        let hit = fitted.fit.strikes.get(fitted.fit.loudest).map_or(0..0, |strike| strike.hit.onset..strike.hit.end);
        let before = fitted.recording.samples.get(..hit.start).unwrap_or(&[]);
        let heard = fitted.recording.samples.get(hit).unwrap_or(&[]);
        let length =
            heard.len().min(fitted.rendering.len()).min(fitted.whole.len()).min((LONGEST_S * rate_hz) as usize);
        let heard = &heard[..length];
        let frame = ((0.02 * rate_hz) as usize).max(1);
        let power: Vec<f64> = heard.chunks(frame).map(|frame| frame.iter().map(|x| x * x).sum()).collect();
        let loudest = power.iter().copied().fold(0.0, f64::max);
        let last = power.iter().rposition(|power| *power > loudest * DIED_AWAY).map_or(0, |last| (last + 1) * frame);
        let shown = (last + last / 20).max((SHORTEST_S * rate_hz) as usize).min(length);
        Self {
            fitted,
            rate_hz,
            before,
            heard,
            modes: &fitted.rendering[..length],
            with_residual: &fitted.whole[..length],
            shown,
        }
    }

    /// Sounds of the recording, of the modes, and of the modes with the residual.
    ///
    /// All have the gain that puts the recording's peak at 0.9 of full scale.
    pub(super) fn sounds(&self) -> [Vec<f32>; 3] {
        let peak = self.heard.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
        let scale = if peak > 0.0 { PEAK / peak } else { 1.0 };
        [self.heard, self.modes, self.with_residual].map(|sound| sound.iter().map(|x| (x * scale) as f32).collect())
    }

    /// Time that the pictures show, in seconds.
    pub(super) fn shown_s(&self) -> f64 {
        self.shown as f64 / self.rate_hz
    }

    /// True if the fit has a residual.
    pub(super) fn has_residual(&self) -> bool {
        !self.fitted.report.residual_bands.is_empty()
    }

    /// Log-spectral distance of a rendering from the recording over time, as (seconds, dB).
    ///
    /// There is one value per frame of 2048 samples; a frame begins every 512 samples, the first
    /// half a frame before the onset.
    pub(super) fn distance_over_time(&self, rendering: &[f64]) -> Vec<(f64, f64)> {
        let lead = lead(self.before, WINDOW / 2);
        let [heard, given] = [self.heard, rendering].map(|sound| [&lead, &sound[..self.shown]].concat());
        let middle = |frame: usize| (frame * WINDOW / 4) as f64 / self.rate_hz;
        frame_distances_db(&heard, &given, WINDOW)
            .into_iter()
            .enumerate()
            .map(|(frame, db)| (middle(frame), db))
            .collect()
    }

    /// Loudness that the fit with its residual has too much (above 0) or too little, by gammatone
    /// band and frame of 2 ms, relative to the largest error.
    pub(super) fn loudness_errors(&self) -> Vec<Vec<f64>> {
        let loudness = self.fitted.heard.loudness();
        let length = loudness.length().min(self.fitted.whole.len()).min(self.shown);
        let (mut map, _) = loudness.compared(&self.fitted.whole[..length]);
        let most = map.iter().flatten().fold(1e-9, |most: f64, error| most.max(error.abs()));
        map.iter_mut().flatten().for_each(|error| *error /= most);
        map
    }

    /// End of the stretch over which the page's log-spectral distance is taken, in seconds from the
    /// onset.
    pub(super) fn lsd_end_s(&self) -> f64 {
        lsd_window(self.heard, self.rate_hz).end as f64 / self.rate_hz
    }

    /// Magnitudes of the spectrum of the shown part of a sound, and the distance of its bins in Hz.
    pub(super) fn spectrum(&self, sound: &[f64]) -> (Vec<f64>, f64) {
        let size = self.shown.next_power_of_two().max(4096) * 2;
        let transform = fourier::forward(size);
        let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
        for (slot, x) in input.iter_mut().zip(&sound[..self.shown]) {
            *slot = *x;
        }
        let magnitudes = match transform.process(&mut input, &mut output) {
            Ok(()) => output.iter().map(|bin| bin.norm()).collect(),
            Err(_) => Vec::new(),
        };
        (magnitudes, self.rate_hz / size as f64)
    }
}

/// Envelope of a spectrum, as (frequency in Hz, dB relative to `reference`).
///
/// The range of frequencies is divided into `count` equal ratios. Each gives the level of its
/// loudest bin, at its middle.
pub(super) fn envelope_db(
    (magnitudes, bin_hz): &(Vec<f64>, f64),
    range_hz: (f64, f64),
    count: usize,
    reference: f64,
) -> Vec<(f64, f64)> {
    let edge = |index: f64| range_hz.0 * (range_hz.1 / range_hz.0).powf(index / count as f64);
    (0..count)
        .filter_map(|index| {
            let first = (edge(index as f64) / bin_hz).round() as usize;
            let last = ((edge(index as f64 + 1.0) / bin_hz).round() as usize).max(first + 1);
            let loudest = magnitudes.get(first..last)?.iter().copied().fold(0.0, f64::max);
            Some((edge(index as f64 + 0.5), 20.0 * (loudest / reference).max(1e-15).log10()))
        })
        .collect()
}
