//! Measures of an impulse response in `f64`: energy, T60, crest, echo density.

/// Band of frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Lower edge in Hz.
    pub from_hz: f64,
    /// Upper edge in Hz.
    pub to_hz: f64,
}

impl Band {
    /// The band less a sixth of an octave at each edge, where the slopes of neighbours reach.
    ///
    /// An edge at 0 or at half the rate stays.
    pub fn inside(self, rate_hz: f64) -> Self {
        let from_hz = if self.from_hz > 0.0 { self.from_hz * 2f64.powf(1.0 / 6.0) } else { 0.0 };
        let to_hz = if self.to_hz < rate_hz / 2.0 { self.to_hz / 2f64.powf(1.0 / 6.0) } else { self.to_hz };
        Self { from_hz, to_hz }
    }
}

/// Filter by which a checker cuts a band out of a response.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// Sets the spectrum to 0 outside the band and within a sixth of an octave of its edges.
    Inside,
    /// Sets the spectrum to 0 outside the band, exactly at its edges.
    Whole,
    /// High-pass and low-pass at the edges: Butterworth of fourth order, run forwards and
    /// backwards.
    Butterworth,
}

impl Look {
    /// Magnitude of the filter at a frequency.
    fn gain(self, band: Band, rate_hz: f64, hz: f64) -> f64 {
        let within = |band: Band| f64::from((band.from_hz..=band.to_hz).contains(&hz));
        match self {
            Self::Inside => within(band.inside(rate_hz)),
            Self::Whole => within(band),
            Self::Butterworth => {
                let high_pass =
                    if band.from_hz > 0.0 { 1.0 / (1.0 + (band.from_hz / hz.max(1e-3)).powi(8)) } else { 1.0 };
                let low_pass = if band.to_hz < rate_hz / 2.0 { 1.0 / (1.0 + (hz / band.to_hz).powi(8)) } else { 1.0 };
                high_pass * low_pass
            }
        }
    }
}

/// Spectrum of a response, padded with at least as many zeros as it has frames.
pub struct Spectrum {
    bins: Vec<fourier::Complex<f64>>,
    rate_hz: f64,
    frames: usize,
}

impl Spectrum {
    /// Transforms a response.
    pub fn new(response: &[f64], rate_hz: f64) -> Self {
        let length = (2 * response.len()).next_power_of_two();
        let forward = fourier::forward(length);
        let mut signal = response.to_vec();
        signal.resize(length, 0.0);
        let mut bins = forward.make_output_vec();
        forward.process(&mut signal, &mut bins).expect("lengths are the plan's");
        Self { bins, rate_hz, frames: response.len() }
    }

    /// Part of the response in a band.
    pub fn band(&self, look: Look, band: Band) -> Vec<f64> {
        let length = 2 * (self.bins.len() - 1);
        let mut bins = self.bins.clone();
        for (bin, value) in bins.iter_mut().enumerate() {
            *value *= look.gain(band, self.rate_hz, bin as f64 * self.rate_hz / length as f64) / length as f64;
        }
        // The first and the last bin of a real signal's spectrum are real.
        bins[0].im = 0.0;
        bins[length / 2].im = 0.0;
        let inverse = fourier::inverse(length);
        let mut signal = inverse.make_output_vec();
        inverse.process(&mut bins, &mut signal).expect("lengths are the plan's");
        signal.truncate(self.frames);
        signal
    }
}

/// Energy of a response.
pub fn energy(response: &[f64]) -> f64 {
    response.iter().map(|x| x * x).sum()
}

/// T60 in seconds from Schroeder's backward integral.
///
/// It is that of the best line between two levels, in dB below the beginning.
pub fn t60_s(response: &[f64], from_db: f64, to_db: f64, rate_hz: f64) -> f64 {
    let mut left = energy(response);
    let all = left;
    let (mut n, mut sum_x, mut sum_y, mut sum_xx, mut sum_xy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (frame, x) in response.iter().enumerate() {
        let db = 10.0 * (left / all).max(1e-30).log10();
        if db < -to_db {
            break;
        }
        if db < -from_db {
            let t = frame as f64 / rate_hz;
            (n, sum_x, sum_y, sum_xx, sum_xy) = (n + 1.0, sum_x + t, sum_y + db, sum_xx + t * t, sum_xy + t * db);
        }
        left -= x * x;
    }
    -60.0 * (n * sum_xx - sum_x * sum_x) / (n * sum_xy - sum_x * sum_y)
}

/// Largest power of a spectrum over its mean, in dB, between `from_hz` and `to_hz`.
///
/// The spectrum is that of the whole of `window` under a Hann window.
pub fn crest_db(window: &[f64], from_hz: f64, to_hz: f64, rate_hz: f64) -> f64 {
    let forward = fourier::forward(window.len());
    let turn = std::f64::consts::TAU / window.len() as f64;
    let mut signal: Vec<f64> =
        window.iter().enumerate().map(|(n, x)| x * (0.5 - 0.5 * (turn * n as f64).cos())).collect();
    let mut spectrum = forward.make_output_vec();
    forward.process(&mut signal, &mut spectrum).expect("lengths are the plan's");
    let hz = rate_hz / window.len() as f64;
    let bins = (from_hz / hz) as usize..(to_hz / hz) as usize;
    let power: Vec<f64> = spectrum[bins].iter().map(|value| value.norm_sqr()).collect();
    let mean = power.iter().sum::<f64>() / power.len() as f64;
    10.0 * (power.iter().fold(0.0, |most: f64, &x| most.max(x)) / mean).log10()
}

/// Echoes a second in a stretch of a response.
///
/// An echo is a local maximum of the magnitude that is at most 20 dB below the stretch's rms.
pub fn echo_density_per_s(stretch: &[f64], rate_hz: f64) -> f64 {
    let floor = (energy(stretch) / stretch.len() as f64).sqrt() * 0.1;
    let peaks = stretch.windows(3).filter(|at| {
        let [before, here, after] = [at[0].abs(), at[1].abs(), at[2].abs()];
        here > floor && here > before && here >= after
    });
    peaks.count() as f64 * rate_hz / stretch.len() as f64
}
