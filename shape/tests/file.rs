//! Shape files: keys and numbers that are refused by name.

use shape::file::{FileError, ShapeFile};
use shape::outline::Outline;
use shape::solve::{self, Wanted};

const PLATE: &str = "format = 1
name = \"x\"
[shape]
kind = \"plate\"
polygon_m = [[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]]
thickness_m = 0.004
[material]
name = \"steel\"
";

const MEMBRANE: &str = "format = 1
name = \"x\"
[shape]
kind = \"membrane\"
polygon_m = [[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]]
tension_n_per_m = 1000
density_kg_per_m2 = 0.25
[material]
loss_factor = 0.001
";

const BELL: &str = "format = 1
name = \"x\"
[shape]
kind = \"revolve\"
profile_m = [[0.1, 0], [0.11, 0], [0.11, 0.2], [0.1, 0.2]]
[material]
name = \"bronze\"
";

fn refused(text: &str) -> String {
    ShapeFile::parse(text).expect_err(text).to_string()
}

/// Adds a line behind that of a key.
fn with(text: &str, behind: &str, line: &str) -> String {
    let (begin, end) = text.split_once(behind).expect(behind);
    let (rest, end) = end.split_once('\n').expect("a line");
    format!("{begin}{behind}{rest}\n{line}\n{end}")
}

#[test]
fn keys_and_tables_that_every_file_needs_are_named_where_they_are_missing() {
    let (material, thickness) = ("[material]\nname = \"steel\"\n", "thickness_m = 0.004\n");
    for (text, named) in [
        (PLATE.replace(material, ""), "[material] is missing; give this table the name of a material"),
        (PLATE.replace("format = 1\n", ""), "format is missing; give format = 1"),
        (PLATE.replacen("name = \"x\"\n", "", 1), "name is missing; give the object a name"),
        (PLATE.replace("kind = \"plate\"\n", ""), "shape.kind is missing; give plate, sheet"),
        (PLATE.replace(thickness, ""), "shape.thickness_m is missing"),
        (format!("format = 1\nname = \"x\"\n{material}"), "[shape] is missing; give this table the kind"),
    ] {
        let message = refused(&text);
        assert!(message.starts_with(named) && !message.contains("line 1"), "{text}{message}");
    }
}

#[test]
fn points_of_three_numbers_are_refused_by_their_line() {
    let message = refused(&PLATE.replace("[0.2, 0]", "[0.2, 0, 0]"));
    assert!(message.contains("line 5") && message.contains("two numbers") && message.contains("has 3"), "{message}");
    let message = refused(&BELL.replace("[0.11, 0]", "[0.11]"));
    assert!(message.contains("line 5") && message.contains("has 1"), "{message}");
    let hole = with(PLATE, "polygon_m", "holes_m = [[[0.1, 0.05, 1], [0.12, 0.05], [0.1, 0.06]]]");
    let message = refused(&hole);
    assert!(message.contains("line 6") && message.contains("has 3"), "{message}");
    let hole = ShapeFile::parse(&hole.replace("0.05, 1]", "0.05]")).unwrap();
    assert_eq!(hole.shape.holes_m, [[[0.1, 0.05], [0.12, 0.05], [0.1, 0.06]]]);
    assert_eq!(ShapeFile::parse(BELL).unwrap().shape.profile_m.unwrap()[3], [0.1, 0.2]);
}

#[test]
fn keys_that_the_kind_of_body_does_not_use_are_refused_by_line() {
    let sheet = PLATE.replace("\"plate\"", "\"sheet\"");
    let solid = PLATE.replace("\"plate\"", "\"solid\"");
    ShapeFile::parse(&with(&sheet, "thickness_m", "plane = \"strain\"")).unwrap();
    ShapeFile::parse(&with(BELL, "profile_m", "split = 0.01")).unwrap();
    for (text, line, named) in [
        (with(BELL, "profile_m", "thickness_m = 0.001"), 6, "shape.thickness_m is not used by a body of revolution"),
        (with(MEMBRANE, "polygon_m", "thickness_m = 0.001"), 6, "shape.thickness_m is not used by a membrane"),
        (with(PLATE, "thickness_m", "tension_n_per_m = 100"), 7, "shape.tension_n_per_m is not used by a plate"),
        (with(&sheet, "kind", "density_kg_per_m2 = 1"), 5, "shape.density_kg_per_m2 is not used by a sheet"),
        (with(PLATE, "thickness_m", "split = 0.01"), 7, "shape.split is not used by a plate"),
        (with(&solid, "thickness_m", "split = 0.01"), 7, "shape.split is not used by a solid"),
        (with(PLATE, "thickness_m", "plane = \"stress\""), 7, "shape.plane is not used by a plate"),
        (with(PLATE, "thickness_m", "profile_m = [[0, 0]]"), 7, "shape.profile_m is not used by a plate"),
        (with(BELL, "kind", "polygon_m = [[0, 0]]"), 5, "shape.polygon_m is not used by a body of revolution"),
        (with(PLATE, "thickness_m", "unit_m = 0.001"), 7, "shape.unit_m is not used by a body with corners"),
        (with(PLATE, "thickness_m", "surface = \"a.stl\""), 7, "shape.surface is not used by a plate"),
        (with(PLATE, "name = \"steel", "shear_modulus_pa = 80e9"), 9, "material.shear_modulus_pa is not used"),
        (with(PLATE, "name = \"steel", "grain_deg = 45"), 9, "material.grain_deg is not used"),
        (with(PLATE, "name = \"steel", "[sound]\ndirection = [0, 0, 1]"), 10, "sound.direction is not used"),
    ] {
        let message = refused(&text);
        assert!(message.contains(&format!("line {line}: {named}")), "{text}\n{message}");
    }
    let drawn =
        PLATE.replace("polygon_m = [[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]]", "outline = \"a.svg\"\nunit_m = 1");
    ShapeFile::parse(&drawn).unwrap();
    let message = refused(&with(&drawn, "unit_m", "holes_m = []"));
    assert!(message.contains("line 7: shape.holes_m") && message.contains("draw its holes"), "{message}");
    let inline = "format = 1\nname = \"x\"\nshape = { kind = \"membrane\", polygon_m = [[0, 0], [1, 0], [0, 1]], \
        tension_n_per_m = 1, density_kg_per_m2 = 1, thickness_m = 1 }\nmaterial = { loss_factor = 0 }\n";
    assert!(refused(inline).contains("line 3: shape.thickness_m"), "{}", refused(inline));
}

#[test]
fn directions_in_the_plane_of_a_plate_are_refused() {
    for kind in [PLATE, MEMBRANE] {
        let strike = format!("{kind}[strike]\ndirection = [1, 0, 0]\n");
        assert_eq!(ShapeFile::parse(&strike), Err(FileError::InPlane { key: "strike.direction" }));
        ShapeFile::parse(&strike.replace("0, 0]", "0, 0.01]")).unwrap();
        let heard = format!("{kind}[sound]\nreadout = \"velocity\"\nat_m = [0.1, 0.05]\ndirection = [0.5, -2, 1e-9]\n");
        assert_eq!(ShapeFile::parse(&heard), Err(FileError::InPlane { key: "sound.direction" }));
    }
    let sideways = format!("{}[strike]\ndirection = [1, 0, 0]\n", PLATE.replace("\"plate\"", "\"solid\""));
    ShapeFile::parse(&sideways).unwrap();
}

#[test]
fn pressure_is_heard_above_the_surface_alone() {
    let at = |text: &str, z: &str| {
        ShapeFile::parse(&format!("{text}[sound]\nreadout = \"pressure\"\nat_m = [0.1, 0.05, {z}]\n"))
    };
    for (text, above_m, wrong, right) in
        [(PLATE, 0.002, ["-1", "0", "0.001", "nan"], "0.0021"), (MEMBRANE, 0.0, ["-1", "0", "-0.1", "nan"], "0.0001")]
    {
        for z in wrong {
            let Err(FileError::NotAbove { above_m: found, .. }) = at(text, z) else { panic!("{z}: {:?}", at(text, z)) };
            assert_eq!(found, above_m);
        }
        at(text, right).unwrap();
    }
}

#[test]
fn materials_whose_unit_is_forgotten_are_refused_and_real_ones_pass() {
    let of = |density: f64, modulus: &str| {
        let numbers = format!(
            "density_kg_per_m3 = {density}\nyoungs_modulus_pa = {modulus}\nshear_modulus_pa = 1e9\npoisson = 0.2\n\
             loss_factor = 0.01\n"
        );
        let is_wood = modulus.starts_with('[');
        let numbers = if is_wood { numbers } else { numbers.replace("shear_modulus_pa = 1e9\n", "") };
        ShapeFile::parse(&PLATE.replace("name = \"steel\"\n", &numbers)).map(|_| ())
    };
    // Foam, silica aerogel, gel, rubber, balsa, beryllium, diamond, carbon fibre, osmium.
    for (density, modulus) in [
        (10.0, "1e6"),
        (3.0, "1e5"),
        (1000.0, "1e4"),
        (1100.0, "2e6"),
        (100.0, "[3e9, 1e8]"),
        (1850.0, "287e9"),
        (3515.0, "1.2e12"),
        (1600.0, "9e11"),
        (22_590.0, "560e9"),
    ] {
        of(density, modulus).unwrap_or_else(|error| panic!("{density}, {modulus}: {error}"));
    }
    for (density, modulus, words) in [
        (0.7, "1e9", "1 to 30000 kg/m3"),
        (7.85e6, "200e9", "1 to 30000 kg/m3"),
        (7.85, "200e9", "kg/m3"),
        (7850.0, "200", "1e4 to 2e12 Pa"),
        (7850.0, "200e12", "1e4 to 2e12 Pa"),
        (450.0, "[12, 0.8]", "1e4 to 2e12 Pa"),
    ] {
        let message = of(density, modulus).unwrap_err().to_string();
        assert!(message.contains(words) && message.contains("Steel has"), "{density}, {modulus}: {message}");
    }
    // The modulus of a shipped material counts, too.
    let message = refused(&PLATE.replace("\"steel\"", "\"steel\"\ndensity_kg_per_m3 = 7.85"));
    assert!(message.contains("160 km/s"), "{message}");
    let shear = "name = \"spruce\"\nshear_modulus_pa = 0.7";
    assert!(refused(&PLATE.replace("name = \"steel\"", shear)).contains("1e3 to 2e12 Pa"));
}

#[test]
fn supports_follow_the_sides_of_the_file_though_its_corners_run_clockwise() {
    let lowest = |corners: &[[f64; 2]], edges: &str| {
        let text = PLATE.replace("[[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]]", &format!("{corners:?}"));
        let file = ShapeFile::parse(&format!("{text}[support]\nedges = {edges}\n")).unwrap();
        let outline = Outline::polygon(corners, &[]).unwrap();
        solve::solve(&file, &outline, vec![], Wanted::Lowest(1), 0.02, &mut |_| {}).unwrap().modes[0].frequency_hz
    };
    let mut corners = [[0.0, 0.0], [0.2, 0.0], [0.15, 0.1], [0.0, 0.1]];
    let clamped_below = lowest(&corners, r#"["clamped", "free", "free", "free"]"#);
    let clamped_left = lowest(&corners, r#"["free", "free", "free", "clamped"]"#);
    corners.reverse();
    // From the upper left corner: upper, right, lower and left side.
    let turned = lowest(&corners, r#"["free", "free", "clamped", "free"]"#);
    assert!((turned / clamped_below - 1.0).abs() < 1e-3, "{turned} {clamped_below} {clamped_left}");
    let turned = lowest(&corners, r#"["free", "free", "free", "clamped"]"#);
    assert!((turned / clamped_left - 1.0).abs() < 1e-3, "{turned} {clamped_below} {clamped_left}");
    assert!(clamped_below > 2.0 * clamped_left);
}

#[test]
fn wrong_number_of_supports_tells_the_sides_of_the_outline_in_their_order() {
    let text =
        PLATE.replace("polygon_m = [[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]]", "outline = \"a.svg\"\nunit_m = 0.001");
    let file = ShapeFile::parse(&format!("{text}[support]\nedges = [\"clamped\", \"free\", \"free\"]\n")).unwrap();
    // A quarter of a disc, with a square hole.
    let drawing = r#"<svg xmlns="http://www.w3.org/2000/svg" width="200" height="200">
        <path d="M10 190 H190 A180 180 0 0 0 10 10 Z M40 160 V130 H70 V160 Z"/></svg>"#;
    let outline = Outline::from_svg(drawing, 0.001).unwrap();
    let solved = solve::solve(&file, &outline, vec![], Wanted::Lowest(1), 0.1, &mut |_| {});
    let message = solved.unwrap_err().to_string();
    let expected =
        "has 3 entries, and the outline 10 sides: 1 straight, 4 curved, 1 straight; then a hole of 4 straight";
    assert!(message.contains(expected), "{message}");
}
