//! Motions as CSV: `time_s|sample,pad,action,striker,x_m,y_m,normal_n`.

use dsp_core::SampleRate;
use dsp_core::table::{Kit, Pad};

use super::builder::{Builder, Line, Step};
use super::error::MotionFault;
use super::path::{Action, Motion};
use crate::csv_text::{self, Columns, Row, TextFault};

/// Columns that a file may have, in the order in which [`super::trials`] writes them.
pub(super) const COLUMNS: [&str; 8] = ["sample", "time_s", "pad", "action", "striker", "x_m", "y_m", "normal_n"];

/// Farthest place from the pad's origin in metres, along each axis.
const MOST_PLACE_M: f64 = 1e6;
/// Largest normal force in newtons.
const MOST_FORCE_N: f64 = 1e6;
/// Latest time in seconds, 11.6 days. A nanosecond is more than the rounding of an `f64` there.
const MOST_TIME_S: f64 = 1e6;

/// Parses CSV bytes into a motion over the pads of a kit. Samples count at `rate`.
///
/// - `time_s` in seconds, or `sample` in samples, 0 or more, each later than on the line before.
/// - `pad`: a pad's name, or its number counted from 0, for which no name stands.
/// - `action`: `scrape` or `roll`, with the place where the tool is, or `lift`.
/// - `striker`: empty for the contact's own, which is the pad's first if the touch names none.
/// - `x_m`, `y_m`: place in metres, from -1e6 to 1e6. An empty `y_m` is 0. A lift may leave both
///   empty: then the contact ends at the line before.
/// - `normal_n`: force with which the tool is pressed down, 0 to 1e6 N, or empty.
///
/// Lines that begin with `#` are comments. At most [`super::MOST_SPEED_M_PER_S`] on the whole path.
///
/// # Errors
/// [`MotionFault`] for the first thing that is wrong.
pub fn parse(bytes: &[u8], kit: &Kit<'_>, rate: SampleRate) -> Result<Motion, MotionFault> {
    csv_text::check_text(bytes)?;
    let bytes = &csv_text::tidied(bytes)[..];
    let mut reader = csv_text::reader(bytes);
    let columns = columns(reader.headers().map_err(|error| csv_text::of_reader(&error, bytes))?)?;
    let mut builder = Builder::default();
    for record in reader.records() {
        let record = record.map_err(|error| csv_text::of_reader(&error, bytes))?;
        builder.add(&MotionRow(Row::new(&record, &columns, bytes)).line(kit, rate)?)?;
    }
    builder.finish()
}

/// Columns of the header, of which one of `sample` and `time_s` and all of `pad`, `action` and
/// `x_m` must be there.
fn columns(header: &::csv::StringRecord) -> Result<Columns<'static>, MotionFault> {
    let found = Columns::find(header, &COLUMNS)?;
    if found.has("sample") == found.has("time_s") {
        return Err(MotionFault::Header("exactly one of the columns `sample` and `time_s` must be there".to_owned()));
    }
    for required in ["pad", "action", "x_m"] {
        if !found.has(required) {
            return Err(MotionFault::Header(format!("the column `{required}` is missing")));
        }
    }
    Ok(found)
}

impl From<TextFault> for MotionFault {
    fn from(fault: TextFault) -> Self {
        match fault {
            TextFault::NotText { offset } => Self::NotText { offset },
            TextFault::FieldCount { line, found, expected } => Self::FieldCount { line, found, expected },
            TextFault::Header(what) => Self::Header(what),
        }
    }
}

/// One line of the file behind the header.
struct MotionRow<'a>(Row<'a>);

impl MotionRow<'_> {
    fn line<'k>(&self, kit: &Kit<'k>, rate: SampleRate) -> Result<Line<'k>, MotionFault> {
        let time_s = self.time_s(rate)?;
        let (index, pad) = self.pad(kit)?;
        let striker = match self.0.field("striker") {
            "" => None,
            name => Some(csv_text::striker_named(kit, pad, name).map_err(|allowed| self.fault("striker", allowed))?),
        };
        let step = match self.0.field("action") {
            "scrape" => Step::Touch(Action::Scrape, self.position_m()?),
            "roll" => Step::Touch(Action::Roll, self.position_m()?),
            "lift" if self.0.field("x_m").is_empty() && self.0.field("y_m").is_empty() => Step::Lift(None),
            "lift" => Step::Lift(Some(self.position_m()?)),
            _ => return Err(self.fault("action", "must be scrape, roll or lift".to_owned())),
        };
        let most = format!("must be a number of newtons from 0 to {MOST_FORCE_N:e}, or empty");
        let normal_n = self.number("normal_n", 0.0..=MOST_FORCE_N, most)?;
        Ok(Line { line: self.0.line, time_s, pad: (index, pad.name()), striker, step, normal_n })
    }

    fn time_s(&self, rate: SampleRate) -> Result<f64, MotionFault> {
        let allowed = |unit: &str| format!("must be a {unit} from the start, at least 0 and at most {MOST_TIME_S:e} s");
        if self.0.columns.has("sample") {
            let sample = self.0.field("sample").parse::<u64>().ok().map(|sample| sample as f64 / rate.hz());
            return sample
                .filter(|time_s| *time_s <= MOST_TIME_S)
                .ok_or_else(|| self.fault("sample", allowed("whole number of samples")));
        }
        let time_s = self.number("time_s", 0.0..=MOST_TIME_S, allowed("number of seconds"))?;
        time_s.ok_or_else(|| self.fault("time_s", allowed("number of seconds")))
    }

    /// Pad by its name, else by its number.
    fn pad<'k>(&self, kit: &Kit<'k>) -> Result<(u8, Pad<'k>), MotionFault> {
        let text = self.0.field("pad");
        csv_text::pad_named(kit, text).or_else(|allowed| {
            let numbered = text.parse::<u8>().ok().and_then(|index| Some((index, kit.pads().nth(index.into())?)));
            numbered.ok_or_else(|| self.fault("pad", allowed))
        })
    }

    fn position_m(&self) -> Result<[f64; 2], MotionFault> {
        let allowed = || format!("must be a number of metres from -{MOST_PLACE_M:e} to {MOST_PLACE_M:e}");
        let place = |column| self.number(column, -MOST_PLACE_M..=MOST_PLACE_M, allowed());
        let x_m = place("x_m")?.ok_or_else(|| self.fault("x_m", allowed()))?;
        Ok([x_m, place("y_m")?.unwrap_or(0.0)])
    }

    /// A number of a column; `None` for an empty field.
    fn number(
        &self,
        column: &'static str,
        range: std::ops::RangeInclusive<f64>,
        allowed: String,
    ) -> Result<Option<f64>, MotionFault> {
        let text = self.0.field(column);
        if text.is_empty() {
            return Ok(None);
        }
        let number = text.parse().ok().filter(|number| range.contains(number));
        number.map(Some).ok_or_else(|| self.fault(column, allowed))
    }

    fn fault(&self, column: &'static str, allowed: String) -> MotionFault {
        MotionFault::Field { line: self.0.line, column, value: self.0.field(column).to_owned(), allowed }
    }
}
