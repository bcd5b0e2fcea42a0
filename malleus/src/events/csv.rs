//! Events as CSV: `sample|time_s,pad,velocity[,position,striker,action]`.

use dsp_core::SampleRate;
use dsp_core::event::{Action, Event, Time};
use dsp_core::table::{Kit, Pad};

use super::{EventList, EventsFault, time_from_seconds};

const COLUMNS: [&str; 7] = ["sample", "time_s", "pad", "velocity", "position", "striker", "action"];

/// Parses CSV bytes for a kit at a rate. Empty fields of `position`, `striker` and `action` mean 0, the pad's first striker and `strike`;
/// `velocity` may be empty for a choke or a release.
///
/// # Errors
/// [`EventsFault`] with line, column, value and what is allowed.
pub fn parse(bytes: &[u8], kit: &Kit<'_>, rate: SampleRate) -> Result<EventList, EventsFault> {
    let mut reader = ::csv::ReaderBuilder::new().trim(::csv::Trim::All).comment(Some(b'#')).from_reader(bytes);
    let columns = Columns::find(reader.headers()?)?;
    let mut list = EventList::default();
    for record in reader.records() {
        let record = record?;
        let row = Row { line: record.position().map_or(0, ::csv::Position::line), record: &record, columns: &columns };
        let event = row.event(kit, rate)?;
        if list.events.last().is_some_and(|last: &Event| last.time > event.time) {
            return Err(EventsFault::OutOfOrder { line: row.line });
        }
        list.events.push(event);
    }
    Ok(list)
}

/// Writes events for a kit at a rate such that [`parse`] gives the same events, bit for bit: by samples where all fall on samples, else by
/// seconds.
pub fn write(events: &[Event], kit: &Kit<'_>, rate: SampleRate) -> String {
    let whole = events.iter().all(|event| event.time.fraction == 0);
    let mut text = String::from(if whole { "sample" } else { "time_s" });
    text.push_str(",pad,velocity,position,striker,action\n");
    for event in events {
        let time = if whole { event.time.frame.to_string() } else { seconds(event.time, rate).to_string() };
        let line = match event.action {
            Action::Shed(groups) => format!("{time},,,,,shed {groups}\n"),
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

/// A time in seconds that reads back as the same time: the nearest one, or a neighbour of it, because the product with the rate is rounded.
fn seconds(time: Time, rate: SampleRate) -> f64 {
    let nearest = (time.frame as f64 + f64::from(time.fraction) / 4_294_967_296.0) / rate.hz();
    let neighbours = (0..16u64).flat_map(|step| [nearest.to_bits() + step, nearest.to_bits().saturating_sub(step)]);
    neighbours.map(f64::from_bits).find(|&seconds| time_from_seconds(seconds, rate) == Some(time)).unwrap_or(nearest)
}

/// Where each column stands.
struct Columns([Option<usize>; COLUMNS.len()]);

impl Columns {
    fn find(header: &::csv::StringRecord) -> Result<Self, EventsFault> {
        let mut found = [None; COLUMNS.len()];
        for (place, name) in header.iter().enumerate() {
            match COLUMNS.iter().position(|column| *column == name) {
                Some(column) if found[column].is_none() => found[column] = Some(place),
                Some(_) => return Err(EventsFault::Header(format!("column `{name}` is there twice"))),
                None => return Err(EventsFault::Header(format!("unknown column `{name}`"))),
            }
        }
        if found[0].is_some() == found[1].is_some() {
            return Err(EventsFault::Header("one of `sample` and `time_s` must be there".to_owned()));
        }
        for required in [2, 3] {
            if found[required].is_none() {
                return Err(EventsFault::Header(format!("column `{}` is missing", COLUMNS[required])));
            }
        }
        Ok(Self(found))
    }
}

/// One line.
struct Row<'a> {
    line: u64,
    record: &'a ::csv::StringRecord,
    columns: &'a Columns,
}

impl Row<'_> {
    fn event(&self, kit: &Kit<'_>, rate: SampleRate) -> Result<Event, EventsFault> {
        let time = self.time(rate)?;
        let action = match self.field("action") {
            "" | "strike" => Action::Strike,
            "choke" => Action::Choke,
            "release" => Action::Release,
            action => action
                .strip_prefix("shed ")
                .and_then(|groups| groups.parse().ok())
                .map(Action::Shed)
                .ok_or_else(|| self.fault("action", "must be strike, choke, release or shed N".to_owned()))?,
        };
        if let Action::Shed(_) = action {
            return Ok(Event { time, action, ..Event::NOTHING });
        }
        let (index, pad) = self.pad(kit)?;
        let velocity = match self.field("velocity") {
            "" if action != Action::Strike => 0.0,
            _ => self.unit("velocity")?,
        };
        let position = if self.field("position").is_empty() { 0.0 } else { self.unit("position")? };
        Ok(Event { time, pad: index, velocity, position, striker: self.striker(kit, pad)?, action })
    }

    fn time(&self, rate: SampleRate) -> Result<Time, EventsFault> {
        let sample = self.field("sample");
        if !sample.is_empty() {
            let frame = sample.parse().ok().filter(|frame| *frame < 1 << 53);
            return frame.map(Time::at_frame).ok_or_else(|| {
                self.fault("sample", "must be a whole number of samples from the start, 0 or more".to_owned())
            });
        }
        let column = if self.columns.0[0].is_some() { "sample" } else { "time_s" };
        let seconds = self.field("time_s").parse().ok();
        seconds
            .and_then(|seconds| time_from_seconds(seconds, rate))
            .ok_or_else(|| self.fault(column, "must be a number of 0 or more, counted from the start".to_owned()))
    }

    fn pad<'k>(&self, kit: &Kit<'k>) -> Result<(u8, Pad<'k>), EventsFault> {
        let name = self.field("pad");
        let found = (0u8..=254).zip(kit.pads()).find(|(_, pad)| pad.name() == name);
        found.ok_or_else(|| {
            let names: Vec<_> = kit.pads().map(|pad| pad.name()).collect();
            self.fault("pad", format!("unknown pad; the kit has {}", names.join(", ")))
        })
    }

    fn striker(&self, kit: &Kit<'_>, pad: Pad<'_>) -> Result<u8, EventsFault> {
        let name = self.field("striker");
        if name.is_empty() {
            return Ok(0);
        }
        let found = (0u8..).zip(kit.strikers_of(pad)).find(|(_, striker)| striker.name() == name);
        found.map(|(index, _)| index).ok_or_else(|| {
            let names: Vec<_> = kit.strikers_of(pad).map(|striker| striker.name()).collect();
            self.fault("striker", format!("unknown striker; pad {} has {}", pad.name(), names.join(", ")))
        })
    }

    fn unit(&self, column: &'static str) -> Result<f32, EventsFault> {
        let value = self.field(column).parse::<f32>().ok();
        value
            .filter(|value| (0.0..=1.0).contains(value))
            .ok_or_else(|| self.fault(column, "must be from 0 to 1".to_owned()))
    }

    fn field(&self, column: &str) -> &str {
        let place = COLUMNS.iter().position(|known| *known == column).and_then(|column| self.columns.0[column]);
        place.and_then(|place| self.record.get(place)).unwrap_or("")
    }

    fn fault(&self, column: &'static str, allowed: String) -> EventsFault {
        EventsFault::Field { line: self.line, column, value: self.field(column).to_owned(), allowed }
    }
}
