//! Rows of the objective: one level asked for in one band at one time.

/// A level asked for.
pub(crate) struct Row {
    /// Index of the band.
    pub(crate) band: usize,
    /// Index of the time.
    time: usize,
    /// Weight of the squared error.
    pub(crate) weight: f64,
    /// Level asked for in dB.
    level_db: f64,
    /// True if only a level above the one asked for is an error.
    ceiling: bool,
}

impl Row {
    /// Error in dB of powers `[time][band]`, in a band whose level may be off by `offset_db` at all
    /// times.
    pub(crate) fn error_db(&self, powers: &[Vec<f64>], offset_db: f64) -> f64 {
        let power = powers.get(self.time).and_then(|powers| powers.get(self.band)).copied().unwrap_or(0.0);
        let error = 10.0 * power.max(1e-30).log10() - self.level_db - offset_db;
        if self.ceiling { error.max(0.0) } else { error }
    }
}

/// An interval in which the levels of one band are asked for.
pub(super) struct Span {
    /// Index of the band.
    pub(super) band: usize,
    /// Start in seconds after the strike.
    pub(super) from_s: f64,
    /// End in seconds after the strike.
    pub(super) to_s: f64,
    /// Sum of the rows' weights if the times fill the interval.
    pub(super) weight: f64,
    /// True if only levels above the one asked for are errors.
    pub(super) ceiling: bool,
}

impl Span {
    /// Rows at those of `times_s` inside the interval, each with the weight of the time that it
    /// stands for.
    pub(super) fn rows(&self, times_s: &[f64], level_db: impl Fn(f64) -> f64) -> Vec<Row> {
        let Self { band, from_s, to_s, weight, ceiling } = *self;
        let inside = |time: usize| times_s.get(time).copied().filter(|time_s| (from_s..to_s).contains(time_s));
        let length_s = to_s - from_s;
        let rows = (0..times_s.len()).filter_map(|time| {
            let time_s = inside(time)?;
            let before = time.checked_sub(1).and_then(|before| times_s.get(before)).map_or(from_s, |t| t.max(from_s));
            let after = times_s.get(time + 1).map_or(to_s, |t| t.min(to_s));
            let share = 0.5 * (after - before) / length_s;
            Some(Row { band, time, weight: weight * share, level_db: level_db(time_s), ceiling })
        });
        rows.collect()
    }
}
