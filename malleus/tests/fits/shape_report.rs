//! `malleus shape --report`: the page of a shape opens in a browser, sounds, and shows the lines
//! that stay at rest.

use std::f64::consts::TAU;
use std::path::Path;

use tempfile::TempDir;

use crate::page::{assert_sounds_play, assert_well_formed_and_self_contained, findings, list, read, tags};
use crate::shape::{BAR, shape, with_bar};

/// Circle of radius 1.
const CIRCLE: &str =
    r#"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="4"><circle cx="2" cy="2" r="1"/></svg>"#;

/// Text of a thin steel plate.
fn plate(outline: &str, edge: &str) -> String {
    format!(
        "format = 1\nname = \"plate\"\nshape = {{ kind = \"plate\", {outline}, thickness_m = 0.001 }}\n\
         material = {{ name = \"steel\" }}\nsupport = {{ edge = \"{edge}\" }}\nstrike = {{ positions = 2 }}\n"
    )
}

/// Page of a shape; `words` are further options.
fn page(text: &str, words: &str) -> String {
    let folder = TempDir::new().expect("a folder");
    std::fs::write(folder.path().join("body.toml"), text).expect("written");
    std::fs::write(folder.path().join("circle.svg"), CIRCLE).expect("written");
    let done = shape(folder.path(), &format!("body.toml -o table.toml --report pages {words}"));
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    read(&folder.path().join("pages/index.html"))
}

/// Straight parts of a path of the page.
type Segments = Vec<[[f64; 2]; 2]>;

/// Nodal lines and outline of each mode's drawing on a page, in the units of the drawing.
fn drawings(html: &str) -> Vec<[Segments; 2]> {
    let mut drawings: Vec<[Segments; 2]> = Vec::new();
    for tag in tags(html).into_iter().filter(|tag| !tag.closes) {
        let attribute = |name: &str| tag.attributes.iter().find(|(key, _)| key == name).map_or("", |(_, value)| value);
        let class = attribute("class");
        match tag.name.as_str() {
            "svg" if attribute("aria-label").starts_with("mode ") => drawings.push([vec![], vec![]]),
            "path" if class.contains("nodal") => {
                if let Some(last) = drawings.last_mut() {
                    last[0].extend(segments(attribute("d")));
                }
            }
            "path" if class == "rim" => {
                if let Some(last) = drawings.last_mut() {
                    last[1].extend(segments(attribute("d")));
                }
            }
            _ => {}
        }
    }
    drawings
}

fn segments(data: &str) -> Segments {
    let point = |text: &str| {
        let (x, y) = text.split_once(' ').expect("two numbers");
        [x, y].map(|number| number.parse::<f64>().expect("a number"))
    };
    let lines = data.split('M').skip(1).map(|line| line.split('L').map(point).collect::<Vec<_>>());
    lines.flat_map(|line| line.windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>()).collect()
}

/// Number of segments that cross the way along points.
fn crossings(segments: &Segments, way: &[[f64; 2]]) -> usize {
    let side = |[a, b]: [[f64; 2]; 2], p: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) > (b[1] - a[1]) * (p[0] - a[0]);
    let cross = |s: [[f64; 2]; 2], t: [[f64; 2]; 2]| side(s, t[0]) != side(s, t[1]) && side(t, s[0]) != side(t, s[1]);
    let steps = way.windows(2).map(|step| [step[0], step[1]]);
    steps.map(|step| segments.iter().filter(|segment| cross(**segment, step)).count()).sum()
}

/// Corners of the smallest upright rectangle around an outline.
fn bounds(outline: &Segments) -> [[f64; 2]; 2] {
    let pick = |pick: fn(f64, f64) -> f64, start: f64| {
        [0, 1].map(|axis| outline.iter().flatten().map(|point| point[axis]).fold(start, pick))
    };
    [pick(f64::min, f64::INFINITY), pick(f64::max, f64::NEG_INFINITY)]
}

/// Numbers of nodal lines along both axes of a rectangle, off its symmetric places.
fn lines_across([nodal, outline]: &[Segments; 2]) -> [usize; 2] {
    let [low, high] = bounds(outline);
    let at = |x: f64, y: f64| [low[0] + x * (high[0] - low[0]), low[1] + y * (high[1] - low[1])];
    let along_x = crossings(nodal, &[at(0.0043, 0.123), at(0.9957, 0.117)]);
    let along_y = crossings(nodal, &[at(0.123, 0.0043), at(0.117, 0.9957)]);
    [along_x, along_y]
}

#[test]
fn nodal_lines_of_hinged_plates_are_those_of_the_closed_form() {
    let rectangle = page(&plate("polygon_m = [[0, 0], [0.37, 0], [0.37, 0.3], [0, 0.3]]", "hinged"), "--modes 12");
    let mut waves: Vec<[usize; 2]> = (1..8).flat_map(|m| (1..8).map(move |n| [m, n])).collect();
    let square = |[m, n]: &[usize; 2]| (*m as f64 / 0.37).powi(2) + (*n as f64 / 0.3).powi(2);
    waves.sort_by(|a, b| square(a).total_cmp(&square(b)));
    let drawn = drawings(&rectangle);
    assert_eq!(drawn.len(), 12);
    for (number, (drawing, [m, n])) in drawn.iter().zip(waves).enumerate() {
        assert_eq!(lines_across(drawing), [m - 1, n - 1], "mode {}", number + 1);
    }
    // The modes of a square that are no pairs.
    let square = page(&plate("polygon_m = [[0, 0], [0.3, 0], [0.3, 0.3], [0, 0.3]]", "hinged"), "--modes 11");
    let drawn = drawings(&square);
    for (index, lines) in [(0, 0), (3, 1), (10, 2)] {
        assert_eq!(lines_across(&drawn[index]), [lines; 2], "mode {}", index + 1);
    }
}

/// Numbers of nodal diameters and circles of a disc.
fn diameters_and_circles([nodal, outline]: &[Segments; 2]) -> [usize; 2] {
    let [low, high] = bounds(outline);
    let middle = [0, 1].map(|axis| (low[axis] + high[axis]) / 2.0);
    let radius = (high[0] - low[0]) / 2.0;
    let at = |share: f64, turn: f64| {
        [middle[0] + share * radius * (TAU * turn).cos(), middle[1] + share * radius * (TAU * turn).sin()]
    };
    let ring: Vec<[f64; 2]> = (0..=720).map(|step| at(0.97, f64::from(step) / 720.0 + 1e-4)).collect();
    // A way outwards along a diameter may cross it by rounding, that beside it does not.
    let ways = (0..48).map(|step| f64::from(step) / 48.0 + 1.7e-3);
    let outwards = ways.map(|turn| crossings(nodal, &[at(0.03, turn), at(0.995, turn)]));
    [crossings(nodal, &ring) / 2, outwards.min().unwrap_or(0)]
}

#[test]
fn nodal_diameters_and_circles_of_discs_are_the_known_ones() {
    // Diameters and circles of the lowest modes, pairs twice (Leissa, Vibration of Plates).
    let clamped = [[0, 0], [1, 0], [1, 0], [2, 0], [2, 0], [0, 1], [3, 0], [3, 0], [1, 1], [1, 1]];
    let free = [[2, 0], [2, 0], [0, 1], [3, 0], [3, 0], [1, 1], [1, 1], [4, 0], [4, 0]];
    for (edge, expected) in [("clamped", &clamped[..]), ("free", &free[..])] {
        let words = format!("--modes {} --error 0.01", expected.len());
        let html = page(&plate("outline = \"circle.svg\", unit_m = 0.15", edge), &words);
        let drawn = drawings(&html);
        assert_eq!(drawn.len(), expected.len());
        for (number, (drawing, expected)) in drawn.iter().zip(expected).enumerate() {
            assert_eq!(diameters_and_circles(drawing), *expected, "mode {} of the {edge} disc", number + 1);
        }
    }
}

#[test]
fn pages_of_a_sheet_and_of_a_glass_show_how_they_deform() {
    let sheet = BAR.replace("\"plate\"", "\"sheet\"").replace("[[0.1, 0.015], [0.0, 0.015]]", "[[0.1, 0], [0, 0]]");
    let html = page(&sheet, "--modes 5 --error 0.01");
    assert_well_formed_and_self_contained(&html);
    assert_eq!(drawings(&html).len(), 5);
    let glass = "format = 1\nname = \"<b>glass\"\n[shape]\nkind = \"revolve\"\n\
        profile_m = [[0, 0], [0.03, 0], [0.04, 0.08], [0.037, 0.08], [0.028, 0.003], [0, 0.003]]\n\
        [material]\nname = \"glass\"\n[strike]\npositions = 2\n";
    let html = page(glass, "--modes 4 --error 0.01");
    assert_well_formed_and_self_contained(&html);
    assert!(!html.contains("<b>"), "names are text, not markup");
    // A glass rings with two waves round its rim first, then with three; each rests at twice as
    // many meridians.
    let meridians: Vec<usize> = drawings(&html).iter().map(|drawing| drawing[0].len()).collect();
    assert_eq!(meridians, [4, 4, 6, 6]);
    assert_eq!((html.matches(", 2 waves").count(), html.matches(", 3 waves").count()), (2, 2));
}

#[test]
fn page_of_a_bar_has_its_charts_sounds_and_figures() {
    let folder = with_bar();
    let done = shape(folder.path(), "bar.toml -o table.toml --modes 6 --error 0.002 --report pages --json");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let report: serde_json::Value = serde_json::from_slice(&done.stdout).expect("a report");
    assert_eq!(report["page"].as_str().map(Path::new), Some(Path::new("pages/index.html")));
    let html = read(&folder.path().join("pages/index.html"));
    assert_well_formed_and_self_contained(&html);
    let count = |name: &str| tags(&html).iter().filter(|tag| tag.name == name && !tag.closes).count();
    // Outline, six modes, and five charts.
    assert_eq!((count("audio"), count("svg"), count("image"), count("tr")), (3, 12, 6, 7));
    for title in [
        "Outline and mesh",
        "Chladni figures",
        "Level of each mode",
        "Gain by position",
        "T60, s",
        "Estimated error of each frequency",
        "Change of the frequencies from mesh to mesh",
        "1032.6 Hz",
        "200.0 mm",
    ] {
        assert!(html.contains(title), "{title} is missing");
    }
    // The page of a shape is written over, and leaves nothing beside it.
    let again = shape(folder.path(), "bar.toml -o table.toml --modes 2 --error 0.01 --report pages");
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
    assert_eq!(drawings(&read(&folder.path().join("pages/index.html"))).len(), 2);
    assert_eq!(std::fs::read_dir(folder.path().join("pages")).expect("a folder").count(), 1);
}

#[test]
fn report_that_cannot_be_written_is_refused_before_a_table_is_made() {
    let folder = with_bar();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("file"), "a file").expect("written");
    std::fs::create_dir(path("fits")).expect("made");
    std::fs::write(path("fits/index.html"), "<title>Fits</title>").expect("written");
    for (words, reason) in [
        ("bar.toml -o t.toml --report file", "is a file"),
        ("bar.toml -o t.toml --report fits", "would be lost"),
        ("bar.toml -o t.toml --report file/below", "file"),
        ("--benchmarks --report pages", "--report"),
        ("--benchmarks --render x.wav", "--render"),
        ("bar.toml -o t.toml --report pages --modes 0", "--modes"),
    ] {
        let done = shape(folder.path(), words);
        let message = String::from_utf8_lossy(&done.stderr);
        assert!(!done.status.success() && message.contains(reason), "{words}: {message}");
        assert!(!message.contains("panicked"), "{words}: {message}");
        assert!(!path("t.toml").exists() && !path("pages").exists(), "{words} leaves a file");
    }
    assert_eq!(read(&path("fits/index.html")), "<title>Fits</title>");
}

#[test]
#[cfg_attr(not(has_chromium), ignore = "needs Chromium; the page is checked by parsing alone, in the other tests")]
fn page_of_a_shape_in_a_browser_plays_its_strikes_and_fetches_nothing() {
    let html = page(BAR, "--modes 4 --error 0.01");
    for found in findings(&html) {
        assert_eq!(list(&found, "sounds").len(), 3, "{found}");
        assert_sounds_play(&found, 0.29..2.01);
        let pictures = list(&found, "pictures");
        assert!(pictures.len() == 4 && pictures.iter().all(|width| width.as_u64() == Some(240)), "{found}");
        // Outline, four modes, and five charts.
        let charts = list(&found, "charts");
        assert!(charts.len() == 10 && charts.iter().all(|height| height.as_f64() > Some(30.0)), "{found}");
    }
}
