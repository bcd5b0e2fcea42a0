//! Section and picture of cycles over modes.

use dsp_core::frames::FEWEST_MODES;
use malleus::plot::{Axis, CrossingsPicture, Curve, Level, Mark, StrokeKind};

use super::cycles_over_modes::{Crossing, OverModes, PadForm, Play};
use crate::on_chip::lone_pad::RATE;

/// Clocks of the picture's levels, in MHz.
const CLOCKS_MHZ: [u32; 2] = [168, 96];

/// Whole cycles that a clock has in a frame.
fn cycles_of_a_frame(clock_mhz: u32) -> f64 {
    (f64::from(clock_mhz) * 1e6 / RATE.hz()).floor()
}

/// Markdown of the section: picture, crossings, what is measured, table.
pub(super) fn section(over_modes: &OverModes) -> String {
    let OverModes { pads, engine_beside_stage: [ringing, strike, direct, sines], crossings } = over_modes;
    let mut section =
        "\n## Cycles over modes\n\n![Cycles a frame over the number of modes](images/cycles_over_modes.png)\n\n"
            .to_owned();
    crossings.iter().for_each(|crossing| section += &format!("- {crossing}\n"));
    section += &format!(
        "\n\
Nominal cycles a frame of the whole engine with one pad, to its 24-bit stereo output at 44.1 kHz, by the number of modes and the form that
plays them. The modes lie at even distances up to 20 kHz, with a T60 of 3 to 20 s. *Strike* is the dearest tick of one strike; the direct
force never rests. The modes have a sine and a cosine gain; in the last two columns they have a sine gain alone, which takes the bank one
product less. A choke that is too short for frames keeps the pad's modes in the bank. The engine plays fewer than {FEWEST_MODES} modes in the bank
alone. There, marked by ~, *frames* are the stage without the engine, and the cycles that the engine takes beside the stage with
{FEWEST_MODES} modes are added: {ringing:.0} ringing, {strike:.0} for a strike, {direct:.0} under a direct force, {sines:.0} with sine gains. 168 MHz have {:.0} cycles a frame, 96 MHz {:.0}.

| modes | ringing: bank | ringing: frames | strike: bank | strike: frames | direct force: bank | direct force: frames | sine gains: bank | sine gains: frames |
| --- | --- | --- | --- | --- | --- | --- | --- | --- |
",
        cycles_of_a_frame(168),
        cycles_of_a_frame(96),
    );
    for pair in pads.chunks(2) {
        let [bank, frames] = pair else { continue };
        let mark = if frames.is_whole_engine { "" } else { "~" };
        section += &format!("| {} |", bank.modes);
        for (bank, frames) in bank.cycles.iter().zip(frames.cycles) {
            section += &format!(" {bank:.0} | {mark}{frames:.0} |");
        }
        section += "\n";
    }
    section
}

/// Picture of cycles over modes, without the pads with sine gains alone.
pub(super) fn picture(over_modes: &OverModes) -> CrossingsPicture {
    let curves = [PadForm::Bank, PadForm::Frames].into_iter().flat_map(|form| curves(over_modes, form));
    let level = |mhz| {
        let value = cycles_of_a_frame(mhz);
        Level { value, name: format!("{mhz} MHz: {value:.0} cycles") }
    };
    let mark = |crossing: &Crossing| Mark {
        place: [crossing.modes, crossing.cycles],
        name: format!("{:.0} modes", crossing.modes.ceil()),
    };
    let axis = |label: &str, range| Axis { label: label.into(), range, logarithmic: true };
    CrossingsPicture {
        title: "Cycles over modes".into(),
        remark: format!(
            "one pad in the whole engine, 44.1 kHz; dashed: frames as a stage and the engine's own cycles, below {FEWEST_MODES} modes"
        ),
        x: axis("modes of the pad", [16.0, 1100.0]),
        y: axis("cycles a frame (Cortex-M4F, nominal)", [150.0, 12_000.0]),
        curves: curves.collect(),
        levels: CLOCKS_MHZ.map(level).into(),
        marks: over_modes.crossings.iter().filter(|one| one.play != Play::SineDirectForce).map(mark).collect(),
    }
}

/// Curves of a form, one for each way to play. The part of frames that the engine does not play is
/// dashed.
fn curves(over_modes: &OverModes, form: PadForm) -> Vec<Curve> {
    let mut curves = Vec::new();
    let colour = if form == PadForm::Frames { 0 } else { 1 };
    for (index, play) in Play::ALL.into_iter().enumerate().filter(|(_, play)| *play != Play::SineDirectForce) {
        let points = over_modes.curve(form, index);
        let in_engine = |[modes, _]: &[f64; 2]| form == PadForm::Bank || *modes >= FEWEST_MODES as f64;
        let first = points.iter().position(in_engine).unwrap_or(points.len());
        let dashed = points[..points.len().min(first + 1)].to_vec();
        if first > 0 {
            curves.push(Curve { name: String::new(), colour, stroke: StrokeKind::Dashed, points: dashed });
        }
        let name = format!("{}: {}", form.name(), play.name());
        curves.push(Curve { name, colour, stroke: StrokeKind::Solid, points: points[first..].to_vec() });
    }
    curves
}
