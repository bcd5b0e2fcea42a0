//! Conversion of a kit to its text form.

use std::fmt::{self, Display, Formatter};

use super::number::shortest_decimal;
use super::source::FORMAT;
use crate::content::{Acceleration, Gain, Kit, Mode, NoteOff, Object, Pad, Pulse, RoomBand, Striker};
use crate::surface::{ObjectSurface, Surface};

/// Writes a kit as text. Equal kits give equal texts.
///
/// The text has all keys, no includes, and one line per mode. Each number is the shortest decimal
/// from which its f32 is read back. [`crate::text::parse`] reads the text of a valid kit, one that
/// [`crate::binary::build`] accepts, back as an equal kit, bit for bit.
pub fn write(kit: &Kit) -> String {
    format!("{}", Text(kit))
}

/// Wrapper of a value that is written as TOML.
struct Text<T>(T);

impl Display for Text<&Kit> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Kit { name, objects, strikers, pads, background, room, headphone_db, surfaces } = self.0;
        writeln!(f, "format = {FORMAT}\nname = {}", Text(name.as_str()))?;
        headphone_db.iter().try_for_each(|volume_db| writeln!(f, "headphone_db = {}", Text(*volume_db)))?;
        background.iter().try_for_each(|background| write!(f, "{}", super::residual::Text(background)))?;
        room.iter().try_for_each(|band| write!(f, "{}", Text(band)))?;
        surfaces.iter().try_for_each(|surface| write!(f, "{}", Text(surface)))?;
        objects.iter().try_for_each(|object| write!(f, "{}", Text(object)))?;
        strikers.iter().try_for_each(|striker| write!(f, "{}", Text(striker)))?;
        pads.iter().try_for_each(|pad| write!(f, "{}", Text(pad)))
    }
}

impl Display for Text<&RoomBand> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let RoomBand { from_hz, gain, decay_per_s } = self.0;
        writeln!(f, "\n[[room]]\nfrom_hz = {}\ngain = {}", Text(*from_hz), Text(*gain))?;
        writeln!(f, "decay_per_s = {}", Text(*decay_per_s))
    }
}

impl Display for Text<&Object> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Object {
            name,
            source,
            licence,
            reference_force,
            acceleration,
            modes,
            residual,
            dynamic_filter,
            biquads,
            surface,
        } = self.0;
        writeln!(f, "\n[[object]]\nname = {}", Text(name.as_str()))?;
        writeln!(f, "source = {}\nlicence = {}", Text(source.as_str()), Text(licence.as_str()))?;
        writeln!(f, "reference_force = {}", Text(*reference_force))?;
        writeln!(f, "acceleration = {}", Text(*acceleration))?;
        surface.iter().try_for_each(|surface| write!(f, "{}", Text(surface)))?;
        write!(f, "{}", Text(modes.as_slice()))?;
        residual.iter().try_for_each(|residual| write!(f, "{}", super::residual::Text(residual)))?;
        dynamic_filter.iter().try_for_each(|filter| write!(f, "{}", super::filters::Text(filter)))?;
        biquads.iter().try_for_each(|biquads| write!(f, "{}", super::filters::Text(biquads)))
    }
}

impl Display for Text<&Striker> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Striker {
            name,
            source,
            licence,
            pulse,
            peak_force,
            peak_exponent,
            contact_time_s,
            contact_exponent,
            restitution,
            modes,
            scrape,
            roll,
        } = self.0;
        writeln!(f, "\n[[striker]]\nname = {}", Text(name.as_str()))?;
        writeln!(f, "source = {}\nlicence = {}", Text(source.as_str()), Text(licence.as_str()))?;
        writeln!(f, "pulse = {}", Text(pulse.key()))?;
        writeln!(f, "peak_force = {}\npeak_exponent = {}", Text(*peak_force), Text(*peak_exponent))?;
        writeln!(f, "contact_time_s = {}", Text(*contact_time_s))?;
        writeln!(f, "contact_exponent = {}", Text(*contact_exponent))?;
        // A Gaussian pulse has no restitution. A kit that gives one is invalid, and its text must
        // be, too.
        if *pulse == Pulse::Hertz || *restitution != Striker::DEFAULT_RESTITUTION {
            writeln!(f, "restitution = {}", Text(*restitution))?;
        }
        write!(f, "{}", Text(modes.as_slice()))?;
        scrape.iter().try_for_each(|scrape| write!(f, "{}", super::surface::Text(scrape)))?;
        roll.iter().try_for_each(|roll| write!(f, "{}", super::surface::Text(roll)))
    }
}

impl Display for Text<&Surface> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Surface { name, source, licence, step_m, rows, unit_m, shortest_m, heights } = self.0;
        writeln!(f, "\n[[surface]]\nname = {}", Text(name.as_str()))?;
        writeln!(f, "source = {}\nlicence = {}", Text(source.as_str()), Text(licence.as_str()))?;
        writeln!(f, "step_m = {}\nrows = {rows}", Text(*step_m))?;
        writeln!(f, "unit_m = {}\nshortest_m = {}", Text(*unit_m), Text(*shortest_m))?;
        writeln!(f, "heights = [")?;
        for line in heights.chunks(16) {
            let line: Vec<String> = line.iter().map(i16::to_string).collect();
            writeln!(f, "    {},", line.join(", "))?;
        }
        writeln!(f, "]")
    }
}

impl Display for Text<&ObjectSurface> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let ObjectSurface { surface, size_m: [x, y], level_db } = self.0;
        writeln!(f, "surface = {}", Text(surface.as_str()))?;
        writeln!(f, "size_m = [{}, {}]", shortest_decimal(*x), shortest_decimal(*y))?;
        writeln!(f, "surface_level_db = {}", Text(*level_db))
    }
}

impl Display for Text<&Pad> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Pad { name, object, strikers, level_db, pan, striker_weight, choke_t60_s, midi_notes, note_off, trigger } =
            self.0;
        let strikers: Vec<String> = strikers.iter().map(|name| Text(name.as_str()).to_string()).collect();
        let midi_notes: Vec<String> = midi_notes.iter().map(u8::to_string).collect();
        writeln!(f, "\n[[pad]]\nname = {}", Text(name.as_str()))?;
        writeln!(f, "object = {}\nstrikers = [{}]", Text(object.as_str()), strikers.join(", "))?;
        writeln!(f, "level_db = {}\npan = {}", Text(*level_db), Text(*pan))?;
        writeln!(f, "striker_weight = {}\nchoke_t60_s = {}", Text(*striker_weight), Text(*choke_t60_s))?;
        writeln!(f, "midi_notes = [{}]", midi_notes.join(", "))?;
        if *note_off == NoteOff::Choke {
            writeln!(f, "note_off = \"choke\"")?;
        }
        trigger.iter().try_for_each(|trigger| write!(f, "{}", super::trigger::Text(trigger)))
    }
}

impl Display for Text<&[Mode]> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return writeln!(f, "modes = []");
        }
        writeln!(f, "modes = [")?;
        for Mode { frequency_hz, decay_per_s, gains } in self.0 {
            let sine = gain_text(gains, |gain| gain.sine);
            let cosine = gain_text(gains, |gain| gain.cosine);
            let (frequency_hz, decay_per_s) = (Text(*frequency_hz), Text(*decay_per_s));
            writeln!(
                f,
                "    {{ frequency_hz = {frequency_hz}, decay_per_s = {decay_per_s}, gain_sine = {sine}, gain_cosine = {cosine} }},"
            )?;
        }
        writeln!(f, "]")
    }
}

/// Text of a mode's gains: a number for one position, an array for any other count.
fn gain_text(gains: &[Gain], phase: impl Fn(&Gain) -> f32) -> String {
    match gains {
        [gain] => shortest_decimal(phase(gain)),
        gains => {
            let gains: Vec<String> = gains.iter().map(|gain| shortest_decimal(phase(gain))).collect();
            format!("[{}]", gains.join(", "))
        }
    }
}

impl Display for Text<f32> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&shortest_decimal(self.0))
    }
}

impl Display for Text<Acceleration> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self.0 {
            Acceleration::Factor(factor) => write!(f, "{}", Text(factor)),
            Acceleration::Balance => write!(f, "{}", Text(Acceleration::BALANCE_KEY)),
        }
    }
}

impl Display for Text<&str> {
    /// Writes a TOML basic string on one line.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "\"")?;
        for character in self.0.chars() {
            match character {
                '"' => write!(f, "\\\"")?,
                '\\' => write!(f, "\\\\")?,
                '\n' => write!(f, "\\n")?,
                '\t' => write!(f, "\\t")?,
                control if control.is_control() => write!(f, "\\u{:04X}", u32::from(control))?,
                other => write!(f, "{other}")?,
            }
        }
        write!(f, "\"")
    }
}
