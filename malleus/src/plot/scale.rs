//! Scales of axes: they map a value to a place, and choose the values to label.

/// Spacing of the values along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spacing {
    /// Equal differences take equal lengths.
    Linear,
    /// Equal ratios take equal lengths.
    Logarithmic,
}

/// Value that an axis marks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    /// Marked value.
    pub(super) value: f64,
    /// Text of the label; empty for a tick between labels.
    pub(super) label: String,
}

/// Range and spacing of an axis; `low < high`, and both are positive if the spacing is logarithmic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// Value at the left or lower end.
    pub(super) low: f64,
    /// Value at the right or upper end.
    pub(super) high: f64,
    /// Spacing of the values between the ends.
    pub(super) spacing: Spacing,
}

impl Scale {
    /// Creates a linear scale.
    pub(super) const fn linear(low: f64, high: f64) -> Self {
        Self { low, high, spacing: Spacing::Linear }
    }

    /// Creates a logarithmic scale.
    pub(super) const fn logarithmic(low: f64, high: f64) -> Self {
        Self { low, high, spacing: Spacing::Logarithmic }
    }

    /// Creates the logarithmic scale that holds `low` to `high` and at least a factor of 4, and
    /// that ends at 1, 2 or 5 times a power of ten.
    pub(super) fn logarithmic_round(low: f64, high: f64) -> Self {
        let middle = (low * high).sqrt();
        Self::logarithmic(one_two_five_below(low.min(middle / 2.0)), one_two_five_above(high.max(middle * 2.0)))
    }

    /// Place of `value` along the axis: 0 at `low`, 1 at `high`, beyond 0 and 1 outside of them.
    pub(super) fn share(&self, value: f64) -> f64 {
        match self.spacing {
            Spacing::Linear => (value - self.low) / (self.high - self.low),
            Spacing::Logarithmic => (value / self.low).ln() / (self.high / self.low).ln(),
        }
    }

    /// Ticks for an axis of `length_px` pixels whose labels are at least `gap_px` pixels apart.
    ///
    /// A linear axis has labels at round steps. A logarithmic axis has labels at 1, 2 and 5 of each
    /// decade, or at the decades alone where those would be too close, and ticks without labels
    /// between them.
    pub(super) fn ticks(&self, length_px: f32, gap_px: f32) -> Vec<Tick> {
        match self.spacing {
            Spacing::Linear => {
                let most = (length_px / gap_px).max(1.0);
                let step = one_two_five_above((self.high - self.low) / f64::from(most));
                self.stepped(step, |value| decimal(value, step))
            }
            Spacing::Logarithmic => self.decade_ticks(length_px, gap_px),
        }
    }

    /// Ticks for a time axis in seconds; from two minutes on, their labels are minutes and seconds.
    pub(super) fn time_ticks(&self, length_px: f32, gap_px: f32) -> Vec<Tick> {
        if !in_minutes(self.high) {
            return self.ticks(length_px, gap_px);
        }
        let least = (self.high - self.low) / f64::from((length_px / gap_px).max(1.0));
        let step = [5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0]
            .into_iter()
            .find(|step| *step >= least)
            .unwrap_or_else(|| 600.0 * one_two_five_above(least / 600.0));
        self.stepped(step, minutes_and_seconds)
    }

    fn stepped(&self, step: f64, label: impl Fn(f64) -> String) -> Vec<Tick> {
        let slack = 1e-9 * (self.high - self.low) / step;
        let first = (self.low / step - slack).ceil() as i64;
        let last = (self.high / step + slack).floor() as i64;
        (first..=last)
            .map(|index| {
                let value = index as f64 * step;
                Tick { value, label: label(value) }
            })
            .collect()
    }

    fn decade_ticks(&self, length_px: f32, gap_px: f32) -> Vec<Tick> {
        let decades = (self.high / self.low).log10();
        let decade_px = f64::from(length_px) / decades;
        let gap_px = f64::from(gap_px);
        // The narrowest gap between 1, 2, 5 and 10 is a factor of 2. If even decades are too close,
        // every second, third or further one has a label.
        let with_two_and_five = decade_px * 2.0_f64.log10() >= gap_px;
        let every = ((gap_px / decade_px).ceil() as i32).max(1);
        let mut ticks = Vec::new();
        for exponent in self.low.log10().floor() as i32..=self.high.log10().ceil() as i32 {
            for digit in 1..10 {
                let value = f64::from(digit) * 10.0_f64.powi(exponent);
                if value < self.low * (1.0 - 1e-9) || value > self.high * (1.0 + 1e-9) {
                    continue;
                }
                let labelled = match digit {
                    1 => exponent.rem_euclid(every) == 0,
                    2 | 5 => with_two_and_five,
                    _ => false,
                };
                ticks.push(Tick { value, label: if labelled { short(value) } else { String::new() } });
            }
        }
        ticks
    }
}

/// True if the labels of a time axis of this length are minutes and seconds.
pub(super) fn in_minutes(duration_s: f64) -> bool {
    duration_s >= 120.0
}

/// Largest number of the form 1, 2 or 5 times a power of ten that is at most `value`, a positive
/// one.
fn one_two_five_below(value: f64) -> f64 {
    let decade = 10.0_f64.powf(value.log10().floor());
    [10.0, 5.0, 2.0, 1.0]
        .into_iter()
        .map(|digit| digit * decade)
        .find(|step| *step <= value * (1.0 + 1e-9))
        .unwrap_or(decade)
}

/// Smallest number of the form 1, 2 or 5 times a power of ten that is at least `value`, a positive
/// one.
pub(super) fn one_two_five_above(value: f64) -> f64 {
    let decade = 10.0_f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|digit| digit * decade)
        .find(|step| *step >= value * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// Writes `value` with as many decimals as `step` needs, and with a true minus sign.
fn decimal(value: f64, step: f64) -> String {
    let decimals = (-(step * (1.0 + 1e-9)).log10().floor()).max(0.0) as usize;
    let text = format!("{:.decimals$}", if value == 0.0 { 0.0 } else { value });
    text.replace('-', "−")
}

/// Writes a positive round value in few characters, such as 0.05, 2, 500 or 10k.
fn short(value: f64) -> String {
    if value >= 999.5 {
        format!("{}k", (value / 1000.0 * 1e6).round() / 1e6)
    } else {
        format!("{}", (value * 1e9).round() / 1e9)
    }
}

fn minutes_and_seconds(time_s: f64) -> String {
    let seconds = time_s.round() as i64;
    format!("{}:{:02}", seconds / 60, seconds % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().map(|tick| tick.label.as_str()).filter(|label| !label.is_empty()).collect()
    }

    #[test]
    fn linear_axis_is_labelled_in_round_steps_that_fit() {
        let ticks = Scale::linear(0.0, 14.2).ticks(1400.0, 90.0);
        assert_eq!(labels(&ticks), ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14"]);
        let ticks = Scale::linear(-0.1, 0.1).ticks(100.0, 30.0);
        assert_eq!(labels(&ticks), ["−0.1", "0.0", "0.1"]);
    }

    #[test]
    fn frequency_axis_is_labelled_at_one_two_and_five() {
        let ticks = Scale::logarithmic(50.0, 20_000.0).ticks(380.0, 20.0);
        assert_eq!(labels(&ticks), ["50", "100", "200", "500", "1k", "2k", "5k", "10k", "20k"]);
    }

    #[test]
    fn short_logarithmic_axis_is_labelled_at_the_decades_only() {
        let ticks = Scale::logarithmic(20.0, 20_000.0).ticks(150.0, 30.0);
        assert_eq!(labels(&ticks), ["100", "1k", "10k"]);
    }

    #[test]
    fn long_time_axis_is_labelled_in_minutes() {
        let ticks = Scale::linear(0.0, 300.0).time_ticks(1400.0, 90.0);
        assert_eq!(labels(&ticks)[..4], ["0:00", "0:30", "1:00", "1:30"]);
    }

    #[test]
    fn round_logarithmic_axis_holds_its_values_and_two_labels() {
        for (low, high) in [(0.3, 0.31), (0.02, 7.0), (1.0, 1.0), (0.99, 21.0)] {
            let scale = Scale::logarithmic_round(low, high);
            assert!(scale.low <= low && high <= scale.high && scale.high >= 3.9 * scale.low);
            assert!(labels(&scale.ticks(300.0, 20.0)).len() >= 2);
        }
    }
}
