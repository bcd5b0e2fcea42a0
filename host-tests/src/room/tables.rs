//! Tables of rooms to measure: even ones, and reproducible random ones.

use dsp_core::table::layout::RoomBandRecord;

/// A room's bands, from the lowest up.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Bands from the lowest up.
    pub bands: Vec<TableBand>,
}

/// Band of a room's table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableBand {
    /// Lower edge in Hz.
    pub from_hz: f64,
    /// T60 in seconds.
    pub t60_s: f64,
    /// Initial gain in 1/√s.
    pub gain: f64,
}

impl Table {
    /// Table whose bands lie between the edges and all have one T60 and one gain.
    pub fn even(edges_hz: &[f64], t60_s: f64, gain: f64) -> Self {
        let from = std::iter::once(0.0).chain(edges_hz.iter().copied());
        Self { bands: from.map(|from_hz| TableBand { from_hz, t60_s, gain }).collect() }
    }

    /// Bands as a kit's binary form has them.
    pub fn records(&self) -> Vec<RoomBandRecord> {
        let record = |band: &TableBand| RoomBandRecord {
            from_hz: (band.from_hz as f32).into(),
            gain: (band.gain as f32).into(),
            decay_per_s: ((1000f64.ln() / band.t60_s) as f32).into(),
        };
        self.bands.iter().map(record).collect()
    }

    /// Upper edge of a band in Hz.
    pub fn to_hz(&self, band: usize, rate_hz: f64) -> f64 {
        self.bands.get(band + 1).map_or(rate_hz / 2.0, |next| next.from_hz)
    }
}

/// Random tables of `bands` bands.
///
/// Edges are two octaves apart for four bands, one for eight, each moved by up to a third of an
/// octave. T60s are from 0.2 to 6 s, neighbours within a factor of `neighbours`. Gains are within
/// ±`gains_db`.
pub fn random_tables(bands: usize, count: usize, neighbours: f64, gains_db: f64, seed: u64) -> Vec<Table> {
    let mut random = random(seed);
    let (lowest_hz, step) = if bands <= 4 { (500.0, 2.0) } else { (125.0, 1.0) };
    let tables = (0..count).map(|_| {
        let mut t60_s = 0.2 * 30f64.powf(random());
        let band = |band: usize| {
            let from_hz = match band {
                0 => 0.0,
                _ => lowest_hz * 2f64.powf(step * (band - 1) as f64 + (random() - 0.5) * 2.0 / 3.0),
            };
            if band > 0 {
                t60_s = (t60_s * neighbours.powf(2.0 * random() - 1.0)).clamp(0.2, 6.0);
            }
            TableBand { from_hz, t60_s, gain: 10f64.powf((2.0 * random() - 1.0) * gains_db / 20.0) }
        };
        Table { bands: (0..bands).map(band).collect() }
    });
    tables.collect()
}

/// Tables of 4 and of 8 bands of octaves, with one T60 and a gain of 1.
pub fn octave_tables(t60_s: f64) -> [Table; 2] {
    let octaves: Vec<f64> = (0..7).map(|octave| 125.0 * 2f64.powi(octave)).collect();
    [Table::even(&[500.0, 2000.0, 8000.0], t60_s, 1.0), Table::even(&octaves, t60_s, 1.0)]
}

/// Generator of numbers from 0 to 1 (xorshift).
pub(super) fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed ^ 0x2545_f491_4f6c_dd1d;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}
