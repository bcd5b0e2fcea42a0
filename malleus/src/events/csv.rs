//! Events as CSV: `sample|time_s,pad,velocity[,position,striker,action,peak_force,contact_time_s]`.

use dsp_core::SampleRate;
use dsp_core::contact::law::{MAX_CONTACT_TIME_S, MIN_CONTACT_TIME_S};
use dsp_core::event::{Action, Event, Shedding, Time};
use dsp_core::table::Kit;

use super::error::EventsFault;
use super::list::{EventList, OwnForce, time_from_seconds};
use crate::csv_text::{self, Columns, Row, TextFault};

const COLUMNS: [&str; 9] =
    ["sample", "time_s", "pad", "velocity", "position", "striker", "action", "peak_force", "contact_time_s"];

/// Largest peak force in newtons.
const MOST_FORCE: f64 = 1e6;
/// Shortest and longest contact time in seconds.
const CONTACT_TIMES_S: std::ops::RangeInclusive<f64> = MIN_CONTACT_TIME_S..=MAX_CONTACT_TIME_S;

/// Action that leaves out all register groups but the first of each object.
const ALL_BUT_FIRST: &str = "shed all but first";

/// Parses CSV bytes into events for a kit at a sample rate.
///
/// An empty `position` means 0, an empty `striker` the pad's first one, and an empty `action` a
/// strike. `velocity` may be empty for a choke or a release. A strike with `peak_force` (newtons)
/// or `contact_time_s` has them instead of what its striker's law makes of the velocity; all such
/// strikes are on one pad. Lines that begin with `#` are comments.
///
/// # Errors
/// [`EventsFault`] for bytes that are not text in UTF-8, and for the first wrong field, with its
/// line, column and value and the values that are allowed there.
pub fn parse(bytes: &[u8], kit: &Kit<'_>, rate: SampleRate) -> Result<EventList, EventsFault> {
    csv_text::check_text(bytes)?;
    let bytes = &csv_text::tidied(bytes)[..];
    let mut reader = csv_text::reader(bytes);
    let columns = columns(reader.headers().map_err(|error| csv_text::of_reader(&error, bytes))?)?;
    let (mut list, mut last) = (EventList::default(), None);
    for record in reader.records() {
        let record = record.map_err(|error| csv_text::of_reader(&error, bytes))?;
        let row = EventRow(Row::new(&record, &columns, bytes));
        let event = row.event(kit, rate)?;
        if last.is_some_and(|last| last > event.time) {
            return Err(EventsFault::OutOfOrder { line: row.0.line });
        }
        last = Some(event.time);
        match row.own_force(event)? {
            Some(strike) if list.strikes.first().is_some_and(|first: &OwnForce| first.pad != strike.pad) => {
                return Err(row.fault("pad", "all strikes with a force of their own must be on one pad".to_owned()));
            }
            Some(strike) => list.strikes.push(strike),
            None => list.events.push(event),
        }
    }
    Ok(list)
}

/// Writes events as CSV from which [`parse`] reads them back, bit for bit, at the same rate.
///
/// Times are whole samples if all events fall on samples, else seconds.
pub fn write(events: &[Event], kit: &Kit<'_>, rate: SampleRate) -> String {
    let whole = events.iter().all(|event| event.time.fraction == 0);
    let mut text = String::from(if whole { "sample" } else { "time_s" });
    text.push_str(",pad,velocity,position,striker,action\n");
    for event in events {
        let time = if whole { event.time.frame.to_string() } else { seconds(event.time, rate).to_string() };
        let line = match event.action {
            Action::Shed(Shedding::Quietest(groups)) => format!("{time},,,,,shed {groups}\n"),
            Action::Shed(Shedding::AllButFirst) => format!("{time},,,,,{ALL_BUT_FIRST}\n"),
            Action::Level => format!("{time},,{},,,level\n", event.velocity),
            Action::Silence => format!("{time},,,,,silence\n"),
            action => {
                let pad = kit.pads().nth(usize::from(event.pad));
                let striker = pad.and_then(|pad| kit.strikers_of(pad).nth(usize::from(event.striker)));
                let striker = striker.as_ref().map_or("", |striker| striker.name());
                let action = match action {
                    Action::Choke => "choke",
                    Action::Release => "release",
                    _ => "strike",
                };
                let name = pad.as_ref().map_or("", |pad| pad.name());
                format!("{time},{name},{},{},{striker},{action}\n", event.velocity, event.position)
            }
        };
        text.push_str(&line);
    }
    text
}

/// A number of seconds that [`time_from_seconds`] converts back to exactly `time`.
///
/// The quotient by the rate alone may miss it, because the product with the rate is rounded again:
/// then one of the quotient's neighbours serves.
fn seconds(time: Time, rate: SampleRate) -> f64 {
    let nearest = (time.frame as f64 + f64::from(time.fraction) / 4_294_967_296.0) / rate.hz();
    let neighbours = (0..16u64).flat_map(|step| [nearest.to_bits() + step, nearest.to_bits().saturating_sub(step)]);
    neighbours.map(f64::from_bits).find(|&seconds| time_from_seconds(seconds, rate) == Some(time)).unwrap_or(nearest)
}

/// Columns of the header, of which one of `sample` and `time_s` and all of `pad` and `velocity`
/// must be there.
fn columns(header: &::csv::StringRecord) -> Result<Columns<'static>, EventsFault> {
    let found = Columns::find(header, &COLUMNS)?;
    if found.has("sample") == found.has("time_s") {
        return Err(EventsFault::Header("exactly one of the columns `sample` and `time_s` must be there".to_owned()));
    }
    for required in ["pad", "velocity"] {
        if !found.has(required) {
            return Err(EventsFault::Header(format!("the column `{required}` is missing")));
        }
    }
    Ok(found)
}

impl From<TextFault> for EventsFault {
    fn from(fault: TextFault) -> Self {
        match fault {
            TextFault::NotText { offset } => Self::NotText { offset },
            TextFault::FieldCount { line, found, expected } => Self::FieldCount { line, found, expected },
            TextFault::Header(what) => Self::Header(what),
        }
    }
}

/// One line of the file behind the header.
struct EventRow<'a>(Row<'a>);

impl EventRow<'_> {
    fn event(&self, kit: &Kit<'_>, rate: SampleRate) -> Result<Event, EventsFault> {
        let time = self.time(rate)?;
        let action = match self.field("action") {
            "" | "strike" => Action::Strike,
            "choke" => Action::Choke,
            "release" => Action::Release,
            "level" => Action::Level,
            "silence" => Action::Silence,
            ALL_BUT_FIRST => Action::Shed(Shedding::AllButFirst),
            action => {
                let groups = action.strip_prefix("shed ").and_then(|groups| groups.parse().ok());
                let allowed = || format!("must be strike, choke, release, level, silence, shed N or {ALL_BUT_FIRST}");
                Action::Shed(Shedding::Quietest(groups.ok_or_else(|| self.fault("action", allowed()))?))
            }
        };
        match action {
            Action::Shed(_) | Action::Silence => return Ok(Event { time, action, ..Event::NOTHING }),
            Action::Level => {
                let velocity = self.unit("velocity")?;
                return Ok(Event { time, velocity, action, ..Event::NOTHING });
            }
            _ => {}
        }
        let found = csv_text::pad_named(kit, self.field("pad"));
        let (index, pad) = found.map_err(|allowed| self.fault("pad", allowed))?;
        let velocity = match self.field("velocity") {
            "" if action != Action::Strike => 0.0,
            _ => self.unit("velocity")?,
        };
        let position = if self.field("position").is_empty() { 0.0 } else { self.unit("position")? };
        let striker = csv_text::striker_named(kit, pad, self.field("striker"));
        let striker = striker.map_err(|allowed| self.fault("striker", allowed))?;
        Ok(Event { time, pad: index, velocity, position, striker, action })
    }

    /// The strike with a force of its own; `None` for an event without one.
    fn own_force(&self, event: Event) -> Result<Option<OwnForce>, EventsFault> {
        let peak_force = self.number("peak_force", f64::MIN_POSITIVE..=MOST_FORCE)?;
        let contact_time_s = self.number("contact_time_s", CONTACT_TIMES_S)?;
        let Some(column) = peak_force.map(|_| "peak_force").or(contact_time_s.map(|_| "contact_time_s")) else {
            return Ok(None);
        };
        if event.action != Action::Strike {
            return Err(self.fault(column, "only a strike has a force of its own".to_owned()));
        }
        let Event { time, pad, velocity, striker, position, .. } = event;
        Ok(Some(OwnForce { time, pad, striker, position, velocity, peak_force, contact_time_s }))
    }

    /// A number of a column that may be empty.
    fn number(&self, column: &'static str, range: std::ops::RangeInclusive<f64>) -> Result<Option<f64>, EventsFault> {
        let text = self.field(column);
        if text.is_empty() {
            return Ok(None);
        }
        let number = text.parse().ok().filter(|number| range.contains(number));
        let allowed = || format!("must be above 0, from {:e} to {:e}", range.start(), range.end());
        number.map(Some).ok_or_else(|| self.fault(column, allowed()))
    }

    fn time(&self, rate: SampleRate) -> Result<Time, EventsFault> {
        let sample = self.field("sample");
        if !sample.is_empty() {
            let frame = sample.parse().ok().filter(|frame| *frame < 1 << 53);
            return frame.map(Time::at_frame).ok_or_else(|| {
                self.fault("sample", "must be a whole number of samples from the start, 0 or more".to_owned())
            });
        }
        let column = if self.0.columns.has("sample") { "sample" } else { "time_s" };
        let seconds = self.field("time_s").parse().ok();
        seconds
            .and_then(|seconds| time_from_seconds(seconds, rate))
            .ok_or_else(|| self.fault(column, "must be a number of 0 or more, counted from the start".to_owned()))
    }

    fn unit(&self, column: &'static str) -> Result<f32, EventsFault> {
        let value = self.field(column).parse::<f32>().ok();
        value
            .filter(|value| (0.0..=1.0).contains(value))
            .ok_or_else(|| self.fault(column, "must be from 0 to 1".to_owned()))
    }

    fn field(&self, column: &str) -> &str {
        self.0.field(column)
    }

    fn fault(&self, column: &'static str, allowed: String) -> EventsFault {
        EventsFault::Field { line: self.0.line, column, value: self.field(column).to_owned(), allowed }
    }
}
