//! Page of a shape and its modes.

use std::fmt::Write;
use std::path::Path;

use shape::file::Kind;
use shape::solve::{Figure, Mode, Motion, Solved};

use super::chladni::chladni;
use super::deformed::{is_twist, revolve, sheet};
use super::document::document;
use super::error::ReportError;
use super::markup::{escaped, sound_uri};
use super::page::{significant, tile};
use super::plan::{Plan, bounds, drawing};
use super::shape_charts::{charts, hertz, largest_gain, t60_s};

/// Name of the page in its folder.
pub const SHAPE_PAGE_FILE: &str = "index.html";
/// End of the title of such a page.
const TITLE_ENDS: &str = ": shape</title>";
/// Width of the drawing of the body in its own units.
const WIDTH: f64 = 480.0;
/// Maximum height of the drawing of the body.
const HEIGHT: f64 = 300.0;
/// Maximum number of edges inside a body that are drawn.
const MOST_EDGES: usize = 20_000;

/// Content of the page of a shape.
#[derive(Clone, Copy, Debug)]
pub struct ShapePage<'a> {
    /// Title of the page.
    pub name: &'a str,
    /// Name of the shape file.
    pub file: &'a str,
    /// Name of the table.
    pub table: &'a str,
    /// Kind of the body.
    pub kind: Kind,
    /// Name of the material, if it has one.
    pub material: Option<&'a str>,
    /// Error of the frequencies that was asked for, as a share of them.
    pub error: f64,
    /// Modes, meshes and picture of the body.
    pub solved: &'a Solved,
    /// Sound of a strike at each position, full scale 1.
    pub sounds: &'a [Vec<f32>],
    /// Sample rate of the sounds in Hz.
    pub rate_hz: f64,
}

/// True for the text of a page that [`shape_html`] made.
pub fn is_shape_page(html: &str) -> bool {
    html.contains(TITLE_ENDS)
}

/// Makes the page of a shape, which is to be written to a path.
///
/// # Errors
/// [`ReportError`] with the path of the page.
pub fn shape_html(path: &Path, page: &ShapePage<'_>) -> Result<String, ReportError> {
    let mut body = format!(
        "<h1>{}</h1>\n<p class=\"muted\">{}{}; shape file {}, table {}</p>\n",
        escaped(page.name),
        kind_in_words(page.kind),
        page.material.map(|name| format!(" of {}", escaped(name))).unwrap_or_default(),
        escaped(page.file),
        escaped(page.table)
    );
    body += &tiles(page);
    body += &players(path, page)?;
    if let Some(figure) = &page.solved.figure {
        body += &format!("<h2>The body</h2>\n{}", picture(page, figure));
        body += &figures(path, page, figure)?;
    }
    body += &format!("<h2>Modes</h2>\n<div class=\"charts\">\n{}</div>\n", charts(page.solved, page.kind, page.error));
    body += &table(page);
    Ok(document(&format!("{}: shape", page.name), &body))
}

fn kind_in_words(kind: Kind) -> &'static str {
    match kind {
        Kind::Plate => "Plate",
        Kind::Sheet => "Sheet that moves in its plane",
        Kind::Membrane => "Membrane",
        Kind::Revolve => "Body of revolution",
        Kind::Solid => "Solid",
    }
}

fn tiles(page: &ShapePage<'_>) -> String {
    let solved = page.solved;
    let ends = |value: fn(&Mode) -> f64| {
        let values = solved.modes.iter().map(value);
        values.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], value| [low.min(value), high.max(value)])
    };
    let ([lowest, highest], [shortest, longest]) = (ends(|mode| mode.frequency_hz), ends(t60_s));
    let end = |t60_s: f64| if t60_s.is_finite() { significant(t60_s) + " s" } else { "no end".to_owned() };
    let t60 = if shortest < longest { format!("{} to {}", end(shortest), end(longest)) } else { end(longest) };
    let tiles = [
        ("Mass", grams(solved.mass_kg)),
        ("Modes", solved.modes.len().to_string()),
        ("Frequencies", format!("{} to {}", hertz(lowest), hertz(highest))),
        ("T60", t60),
        ("Largest estimated error", format!("{:.3} %", 100.0 * ends(|mode| mode.error)[1])),
        ("Unknowns", solved.unknowns.to_string()),
        ("Elements", solved.elements.to_string()),
        ("Rigid motions, left out", solved.rigid.to_string()),
        ("Counted by inertia, rigid ones too", format!("{} below {}", solved.counted, hertz(solved.counted_to_hz))),
    ];
    let cut = solved.cut_pair.then(|| ("Next mode, left out", "of the frequency of the last: half a pair".to_owned()));
    let tiles: String = tiles.iter().chain(&cut).map(|(term, value)| tile(term, value)).collect();
    format!("<dl class=\"tiles\">\n{tiles}</dl>\n")
}

fn grams(mass_kg: f64) -> String {
    if mass_kg < 1.0 { format!("{:.1} g", 1e3 * mass_kg) } else { format!("{mass_kg:.3} kg") }
}

fn players(path: &Path, page: &ShapePage<'_>) -> Result<String, ReportError> {
    let mut players = String::new();
    for (index, sound) in page.sounds.iter().enumerate() {
        let uri =
            sound_uri(sound, page.rate_hz).map_err(|cause| ReportError::Sound { path: path.to_owned(), cause })?;
        let name = format!("Position {}", index + 1);
        let strike = page.solved.figure.as_ref().and_then(|figure| figure.strikes.get(index));
        let place = strike.map_or_else(String::new, |[x, y]| format!("{:.1}, {:.1} mm", 1e3 * x, 1e3 * y));
        let _ = writeln!(
            players,
            "<div>{name} <span class=\"muted\">{place}</span><audio controls preload=\"auto\" src=\"{uri}\" aria-label=\"{name}\"></audio></div>"
        );
    }
    Ok(format!(
        "<h2>A strike at each position</h2>\n<div class=\"listen\">\n{players}</div>\n<p class=\"muted\">Rendered by the code that a board runs, with a hard mallet, all at one level.</p>\n"
    ))
}

/// Drawing of the outline, the mesh, the strikes and the point that is heard.
fn picture(page: &ShapePage<'_>, figure: &Figure) -> String {
    let box_of = bounds(figure.points.iter().copied());
    let plan = Plan::new(box_of, WIDTH, HEIGHT);
    let is_drawn = figure.inner_edges.len() <= MOST_EDGES;
    let edges = figure.inner_edges.iter().filter(|_| is_drawn);
    let mesh: String = edges.map(|ends| plan.along(*ends)).collect();
    let rim: String = figure.rim.iter().map(|row| plan.along(row.iter().map(|&at| figure.points[at]))).collect();
    let mut body = format!("<path class=\"mesh\" d=\"{mesh}\"/><path class=\"rim\" d=\"{rim}\"/>");
    let mut legend = String::from("<span class=\"key fit\">strikes</span> ");
    let places: Vec<[f64; 2]> = figure.strikes.iter().map(|&strike| plan.place(strike)).collect();
    for [x, y] in &places {
        let _ = write!(body, "<circle class=\"dot fit\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/>");
    }
    // Numbers between the first and the last one would overlap.
    if let [first, .., last] = places[..] {
        body += &number(1, first, last, plan.size);
        body += &number(places.len(), last, first, plan.size);
    }
    if let Some(heard) = figure.heard {
        let [x, y] = plan.place(heard);
        let _ = write!(body, "<circle class=\"dot hollow recording\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\"/>");
        legend += "<span class=\"key hollow recording\">heard</span>";
    }
    let [low, high] = box_of;
    let what =
        if page.kind == Kind::Revolve { "Profile and mesh; the axis is to the left" } else { "Outline and mesh" };
    let left_out = if is_drawn { "" } else { "; the mesh is too fine to be drawn" };
    format!(
        "<figure class=\"body\"><figcaption><strong>{what}</strong> {} &times; {}{left_out} {legend}</figcaption>{}</figure>\n",
        length(high[0] - low[0]),
        length(high[1] - low[1]),
        drawing(plan.size, what, &body)
    )
}

/// Number of a strike beside its dot, away from the other end of the path if the drawing has room.
fn number(number: usize, at: [f64; 2], other: [f64; 2], size: [f64; 2]) -> String {
    let way = [at[0] - other[0], at[1] - other[1]];
    let long = way[0].hypot(way[1]).max(f64::MIN_POSITIVE);
    let beside =
        [way.map(|x| x / long), [0.0, -1.0], [0.0, 1.0]].map(|to| [at[0] + 13.0 * to[0], at[1] + 13.0 * to[1]]);
    let has_room = |&[x, y]: &[f64; 2]| x > 6.0 && x < size[0] - 6.0 && y > 8.0 && y < size[1] - 8.0;
    let [x, y] = beside.into_iter().find(has_room).unwrap_or(at);
    format!("<text class=\"word\" text-anchor=\"middle\" x=\"{x:.1}\" y=\"{:.1}\">{number}</text>", y + 4.0)
}

fn length(metres: f64) -> String {
    if metres < 1.0 { format!("{:.1} mm", 1e3 * metres) } else { format!("{metres:.3} m") }
}

/// Chladni figures or deformed outlines of the lowest modes.
fn figures(path: &Path, page: &ShapePage<'_>, figure: &Figure) -> Result<String, ReportError> {
    let mut drawn = String::new();
    for (index, (motion, mode)) in figure.motions.iter().zip(&page.solved.modes).enumerate() {
        let label = format!("mode {}, {}", index + 1, hertz(mode.frequency_hz));
        let svg = match page.kind {
            Kind::Plate | Kind::Membrane | Kind::Solid => chladni(path, figure, motion, &label)?,
            Kind::Sheet => sheet(figure, motion, &label),
            Kind::Revolve => revolve(figure, motion, &label),
        };
        let waves = if page.kind == Kind::Revolve { format!(", {}", waves_in_words(motion)) } else { String::new() };
        let _ = writeln!(
            drawn,
            "<figure class=\"mode\"><figcaption><strong>{}</strong> {}{waves}</figcaption>{svg}</figure>",
            index + 1,
            hertz(mode.frequency_hz)
        );
    }
    let (title, told) = match page.kind {
        Kind::Plate | Kind::Membrane | Kind::Solid => (
            "Chladni figures",
            "Light parts move one way while dark parts move the other way. The lines between them rest: sand gathers there.",
        ),
        Kind::Sheet => ("Deformed outlines", "Thin: at rest. Thick: at one end of the motion, enlarged."),
        Kind::Revolve => (
            "Deformed sections",
            "Thin: at rest. Thick: at one end of the motion, enlarged. The circle shows the waves round the axis, and lines to where the body rests.",
        ),
    };
    Ok(format!("<h2>{title}</h2>\n<p class=\"muted\">{told}</p>\n<div class=\"modes\">\n{drawn}</div>\n"))
}

fn waves_in_words(motion: &Motion) -> String {
    match motion.waves {
        0 if is_twist(motion) => "twists round the axis".to_owned(),
        0 => "no waves".to_owned(),
        1 => "1 wave".to_owned(),
        waves => format!("{waves} waves"),
    }
}

/// Table of all modes.
fn table(page: &ShapePage<'_>) -> String {
    let modes = &page.solved.modes;
    let loudest = modes.iter().map(largest_gain).fold(f64::MIN_POSITIVE, f64::max);
    let row = |(index, mode): (usize, &Mode)| {
        let level = 20.0 * (largest_gain(mode) / loudest).log10();
        let level = if level > -200.0 { format!("{level:.1} dB") } else { "silent".to_owned() };
        let t60 = if mode.decay_per_s > 0.0 { format!("{} s", significant(t60_s(mode))) } else { "no end".to_owned() };
        format!(
            "<tr><td>{}</td><td>{}</td><td>{:.4} %</td><td>{:.3} 1/s</td><td>{t60}</td><td>{level}</td></tr>\n",
            index + 1,
            hertz(mode.frequency_hz),
            100.0 * mode.error,
            mode.decay_per_s
        )
    };
    let rows: String = modes.iter().enumerate().map(row).collect();
    format!(
        "<h2>All modes</h2>\n<div class=\"scroll\"><table>\n<tr><th>mode</th><th>frequency</th><th>estimated error</th><th>decay</th><th>T60</th><th>level, at the loudest position</th></tr>\n{rows}</table></div>\n"
    )
}

#[cfg(test)]
mod tests {
    use shape::gain::Gain;

    use super::*;

    #[test]
    fn page_of_a_body_without_a_picture_has_its_sounds_charts_and_modes() {
        let mode = Mode {
            frequency_hz: 440.0,
            error: 1e-4,
            decay_per_s: 0.0,
            gains: vec![Gain { sine: 0.0, cosine: 1.0 }, Gain::default()],
        };
        let solved = Solved {
            modes: vec![mode],
            rigid: 6,
            counted: 7,
            counted_to_hz: 441.0,
            cut_pair: true,
            unknowns: 100,
            elements: 0,
            mass_kg: 0.1,
            meshes: vec![],
            figure: None,
        };
        let sounds = [vec![0.0; 480], vec![0.5; 480]];
        let page = ShapePage {
            name: "block",
            file: "block.toml",
            table: "block-table.toml",
            kind: Kind::Plate,
            material: None,
            error: 1e-3,
            solved: &solved,
            sounds: &sounds,
            rate_hz: 48_000.0,
        };
        let html = shape_html(Path::new("index.html"), &page).expect("a page");
        assert!(is_shape_page(&html) && !html.contains("The body") && !html.contains(">inf"));
        assert_eq!(html.matches("<audio").count(), 2);
        // Without damping, and on one mesh, there are levels, gains and estimates alone.
        assert_eq!(html.matches("<svg").count(), 3);
        assert!(html.contains("440.00 Hz") && html.contains("no end") && html.contains("half a pair"));
    }
}
