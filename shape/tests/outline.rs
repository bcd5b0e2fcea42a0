//! Outlines: areas, checks and drawings.

use shape::outline::{Outline, OutlineError, Point, Side};
use std::f64::consts::PI;

const SQUARE: [Point; 4] = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]];

fn hole(x: f64, y: f64, size: f64) -> Vec<Point> {
    vec![[x, y], [x + size, y], [x + size, y + size], [x, y + size]]
}

fn svg(inner: &str) -> String {
    format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="200" height="200">{inner}</svg>"#)
}

fn drawn(inner: &str) -> Result<Outline, OutlineError> {
    Outline::from_svg(&svg(inner), 0.001)
}

#[test]
fn a_polygon_of_either_direction_is_the_same_body() {
    let mut turned = SQUARE.to_vec();
    turned.reverse();
    for points in [SQUARE.to_vec(), turned] {
        let outline = Outline::polygon(&points, &[hole(0.03, 0.04, 0.02)]).unwrap();
        assert!((outline.area() - (0.01 - 0.0004)).abs() < 1e-15);
        assert_eq!(outline.bounds(), Some([[0.0, 0.0], [0.1, 0.1]]));
        assert!(outline.contains([0.01, 0.01]));
        assert!(!outline.contains([0.04, 0.05]), "in the hole");
        assert!(!outline.contains([0.11, 0.05]));
        assert!(!outline.is_curved());
        let sides = outline.sides();
        assert_eq!(sides.len(), 8);
        assert_eq!(sides[3].to, sides[0].from);
        assert_eq!(sides[4].ring, 1);
    }
}

#[test]
fn repeated_closing_points_are_dropped() {
    let mut points = SQUARE.to_vec();
    points.extend([SQUARE[0], SQUARE[0]]);
    assert_eq!(Outline::polygon(&points, &[]).unwrap().rings[0].len(), 4);
}

#[test]
fn polygons_that_are_no_body_are_named() {
    let polygon = |outer: &[Point], holes: &[Vec<Point>]| Outline::polygon(outer, holes).unwrap_err();
    assert_eq!(polygon(&[], &[]), OutlineError::Empty);
    let few = polygon(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]], &[]);
    assert_eq!(few, OutlineError::TooFewPoints { ring: 0, points: 2 });
    assert!(matches!(
        polygon(&[[0.0, 0.0], [f64::NAN, 0.0], [1.0, 1.0]], &[]),
        OutlineError::NotFinite { side: 1, .. }
    ));
    let flat = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]];
    assert!(matches!(polygon(&flat, &[]), OutlineError::NoArea { ring: 0, .. }));
    let bow = [[0.0, 0.0], [0.3, 0.2], [0.3, 0.0], [0.0, 0.1]];
    let found = polygon(&bow, &[]);
    assert!(matches!(found, OutlineError::Crosses { ring: 0, .. }), "{found}");
    let spike = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.1, 0.05], [0.0, 0.05]];
    assert!(matches!(polygon(&spike, &[]), OutlineError::Crosses { .. }));
    let touch = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.05, 0.0], [0.0, 0.1]];
    assert!(matches!(polygon(&touch, &[]), OutlineError::Crosses { .. }));
    let outside = polygon(&SQUARE, &[hole(0.2, 0.2, 0.02)]);
    assert!(matches!(outside, OutlineError::HoleOutside { ring: 1, .. }));
    let over = polygon(&SQUARE, &[hole(0.09, 0.02, 0.02)]);
    assert!(matches!(over, OutlineError::HoleTouches { ring: 1, other: 0, .. }));
    let on = polygon(&SQUARE, &[hole(0.08, 0.02, 0.02)]);
    assert!(matches!(on, OutlineError::HoleTouches { ring: 1, other: 0, .. }));
    let pair = polygon(&SQUARE, &[hole(0.02, 0.02, 0.02), hole(0.04, 0.03, 0.02)]);
    assert!(matches!(pair, OutlineError::HoleTouches { ring: 2, other: 1, .. }));
    let nested = polygon(&SQUARE, &[hole(0.02, 0.02, 0.06), hole(0.04, 0.04, 0.02)]);
    assert!(matches!(nested, OutlineError::HoleInHole { ring: 2, other: 1, .. }));
}

#[test]
fn outlines_that_cross_themselves_say_where_though_they_enclose_no_area() {
    let bow_tie = Outline::polygon(&[[0.0, 0.0], [0.2, 0.1], [0.2, 0.0], [0.0, 0.1]], &[]).unwrap_err();
    assert_eq!(bow_tie, OutlineError::Crosses { ring: 0, side: 0, other: 2, at: [0.1, 0.05] });
    let message = bow_tie.to_string();
    assert!(message.contains("sides 0 and 2") && message.contains("(0.100000, 0.050000) m"), "{message}");
    let within = |inner: &str, expected: Point| {
        let Err(OutlineError::Crosses { at, .. }) = drawn(inner) else { panic!("{inner}: {:?}", drawn(inner)) };
        assert!((at[0] - expected[0]).hypot(at[1] - expected[1]) < 1e-3, "{inner}: {at:?}");
    };
    within(r#"<path d="M10 10 L90 50 L90 10 L10 50 Z"/>"#, [0.05, -0.03]);
    // A figure of eight, and one curve that runs through a loop.
    within(r#"<path d="M50 50 C0 0 0 100 50 50 C100 0 100 100 50 50 Z"/>"#, [0.05, -0.05]);
    within(r#"<path d="M10 50 C140 0 -40 0 90 50 Z"/>"#, [0.05, -0.0305]);
    within(r#"<path d="M50 50 C0 0 0 100 50 50 L90 10 L90 90 Z"/>"#, [0.05, -0.05]);
    let looped = drawn(r#"<path d="M10 50 C140 0 -40 0 90 50 Z"/>"#).unwrap_err().to_string();
    assert!(looped.contains("side 0 of ring 0 crosses itself"), "{looped}");
}

#[test]
fn an_outline_of_another_origin_must_run_the_right_way() {
    let ring: Vec<Side> = SQUARE.iter().rev().map(|from| Side { from: *from, curve: None }).collect();
    assert_eq!(Outline { rings: vec![ring] }.check(), Err(OutlineError::WrongWay { ring: 0 }));
    assert_eq!(Outline { rings: vec![] }.check(), Err(OutlineError::Empty));
}

#[test]
fn messages_say_what_where_and_what_to_do() {
    let error = Outline::polygon(&SQUARE, &[hole(0.09, 0.02, 0.02)]).unwrap_err().to_string();
    assert!(
        error.contains("ring 1") && error.contains("(0.100000, 0.040000) m") && error.contains("leave material"),
        "{error}"
    );
}

#[test]
fn a_drawn_circle_is_sixteen_curves_and_its_area_right_to_a_millionth() {
    let disc = drawn(r#"<circle cx="60" cy="70" r="50"/>"#).unwrap();
    assert_eq!(disc.rings[0].len(), 16);
    assert!(disc.is_curved());
    assert!((disc.area() / (PI * 0.0025) - 1.0).abs() < 1e-6);
    let [low, high] = disc.bounds().unwrap();
    let expected = [0.01, -0.12, 0.11, -0.02];
    let found = [low[0], low[1], high[0], high[1]];
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}");
    for (far, inside) in [(0.0499, true), (0.0501, false)] {
        for k in 0..16 {
            let (sine, cosine) = (f64::from(k) * PI / 8.0).sin_cos();
            assert_eq!(disc.contains([0.06 + far * cosine, -0.07 + far * sine]), inside);
        }
    }
}

#[test]
fn drawn_ellipses_and_arcs_have_areas_right_to_a_millionth() {
    // Shape, area in square millimetres, number of sides.
    let drawings = [
        (r#"<ellipse cx="60" cy="70" rx="50" ry="20"/>"#, 1000.0 * PI, 16),
        (r#"<ellipse cx="60" cy="70" rx="2" ry="50"/>"#, 100.0 * PI, 16),
        (r#"<g transform="rotate(20) skewX(30) scale(1 0.5)"><circle cx="60" cy="70" r="50"/></g>"#, 1250.0 * PI, 16),
        // A reader parts an ellipse as large into eight cubics.
        (r#"<ellipse cx="600" cy="700" rx="500" ry="200"/>"#, 1e5 * PI, 16),
        (r#"<path d="M10 70 A50 20 0 0 0 110 70 Z"/>"#, 500.0 * PI, 9),
        (r#"<path d="M10 70 A50 20 0 0 0 110 70 L60 70 L60 50 A50 20 0 0 0 10 70 Z"/>"#, 750.0 * PI, 14),
        // From 60 degrees before an end of the ellipse to 60 degrees after it, and a chord.
        (r#"<path d="M85 52.679492 A50 20 0 0 1 85 87.320508 Z"/>"#, 1000.0 * (PI / 3.0 - 0.75_f64.sqrt() / 2.0), 7),
    ];
    for (shape, area, sides) in drawings {
        let outline = drawn(shape).unwrap();
        let off = outline.area() / (1e-6 * area) - 1.0;
        println!("{shape}: {} sides, {off:.1e}", outline.rings[0].len());
        assert!(off.abs() < 1e-6, "{shape}: {off}");
        assert_eq!(outline.rings[0].len(), sides, "{shape}");
    }
}

#[test]
fn cubics_of_quarter_ellipses_are_taken_back_without_a_command_that_names_them() {
    let quarters = "M110,70 C110,81.0456950 87.6142375,90 60,90 S10,81.0456950 10,70 \
        S32.3857625,50 60,50 S110,58.9543050 110,70 Z";
    let outline = drawn(&format!(r#"<path d="{quarters}"/>"#)).unwrap();
    assert_eq!(outline.rings[0].len(), 16);
    assert!((outline.area() / (1e-3 * PI) - 1.0).abs() < 1e-6, "{}", outline.area());
}

#[test]
fn curves_that_are_no_arcs_stay_as_they_are_drawn() {
    // A symmetric curve, whose control points are parallel to its ends, is near an ellipse.
    for (curve, area) in [
        ("M10 10 C60 60 120 60 170 10 Z", 4050.0),
        ("M10 10 C10 50 170 50 170 10 Z", 3840.0),
        ("M10 10 C40 60 110 70 170 10 Z", 4560.0),
    ] {
        let outline = drawn(&format!(r#"<path d="{curve}"/>"#)).unwrap();
        assert_eq!(outline.rings[0].len(), 2, "{curve}");
        assert!((outline.area() / (1e-6 * area) - 1.0).abs() < 1e-6, "{curve}: {}", outline.area());
    }
    let rounded = drawn(r#"<rect x="10" y="10" width="150" height="60" rx="12"/>"#).unwrap();
    assert_eq!(rounded.rings[0].len(), 8, "small corners stay");
}

#[test]
fn shapes_inside_the_largest_one_are_holes() {
    let plate = drawn(r#"<circle cx="30" cy="30" r="5"/><rect x="10" y="10" width="100" height="50"/>"#).unwrap();
    assert_eq!(plate.rings.len(), 2);
    assert_eq!(plate.rings[0].len(), 4);
    assert!((plate.area() - (0.005 - PI * 25e-6)).abs() < 1e-7);
    let ring = drawn(r#"<path fill-rule="evenodd" d="M10 10H90V90H10Z M30 30H60V60H30Z"/>"#).unwrap();
    assert!((ring.area() - (0.0064 - 0.0009)).abs() < 1e-8);
}

#[test]
fn subpaths_are_holes_where_the_fill_rule_leaves_them_empty() {
    let (outer, along, against) = ("M10 10H90V90H10Z", "M30 30H60V60H30Z", "M30 30V60H60V30Z");
    let (whole, pierced) = (0.0064, 0.0064 - 0.0009);
    for (attributes, inner, area) in [
        ("", along, whole),
        ("", against, pierced),
        (r#"fill-rule="nonzero""#, along, whole),
        (r#"fill-rule="evenodd""#, along, pierced),
        (r#"style="fill-rule:evenodd""#, against, pierced),
        // A line has no rule: each ring of it is seen.
        (r#"fill="none" stroke="black" fill-rule="nonzero""#, along, pierced),
        // A mirror turns both rings.
        (r#"transform="scale(-1 1)""#, along, whole),
        (r#"transform="scale(-1 1)""#, against, pierced),
    ] {
        let outline = drawn(&format!(r#"<path {attributes} d="{outer} {inner}"/>"#)).unwrap();
        assert!((outline.area() - area).abs() < 1e-8, "{attributes} {inner}: {}", outline.area());
    }
    // Two rings with filled parts on both sides, and one within them at which the fill ends.
    let hole_in_ring = drawn(&format!(r#"<path d="{outer} M20 20H80V80H20Z M30 30V60H60V30Z M40 40V50H50V40Z"/>"#));
    assert!((hole_in_ring.unwrap().area() - (whole - 0.0001)).abs() < 1e-8);
    let crossing = drawn(&format!(r#"<path d="{outer} M80 30H100V60H80Z"/>"#));
    assert!(matches!(crossing, Err(OutlineError::HoleTouches { .. })), "{crossing:?}");
}

#[test]
fn clip_paths_and_masks_that_cut_a_shape_are_named() {
    let body = r#"<rect x="10" y="10" width="100" height="60"/>"#;
    let page = r#"<clipPath id="page"><path d="M0 0H200V200H0Z"/></clipPath>"#;
    let bite = r#"<clipPath id="bite"><rect x="50" y="0" width="200" height="200"/></clipPath>"#;
    let round = r#"<clipPath id="round"><circle cx="60" cy="40" r="190"/></clipPath>"#;
    let soft = r#"<mask id="soft"><rect width="200" height="200" fill="white"/></mask>"#;
    let cut = |attribute: &str, id: &str| {
        drawn(&format!(
            r#"{page}{bite}{round}{soft}<g {attribute}="url(#{id})"><g transform="scale(1.2)">{body}</g></g>"#
        ))
    };
    assert!((cut("clip-path", "page").unwrap().area() - 1.44 * 0.006).abs() < 1e-8);
    for (attribute, id) in [("clip-path", "bite"), ("clip-path", "round"), ("mask", "soft")] {
        let error = cut(attribute, id).unwrap_err();
        assert!(matches!(&error, OutlineError::Cut { id: found, .. } if found == id), "{error}");
        let message = error.to_string();
        assert!(message.contains(&format!("cut by the {attribute} \"{id}\"")), "{message}");
    }
    // What is left out anyway may be cut.
    let ground = r#"<rect width="200" height="200" fill="white" clip-path="url(#bite)"/>"#;
    assert!((drawn(&format!("{bite}{ground}{body}")).unwrap().area() - 0.006).abs() < 1e-9);
}

#[test]
fn the_y_axis_of_a_drawing_is_turned_up() {
    let flag = drawn(r#"<path d="M0 0 L20 0 L0 10 Z"/>"#).unwrap();
    assert!(flag.contains([0.002, -0.001]) && !flag.contains([0.018, -0.009]));
}

#[test]
fn transforms_and_view_boxes_are_applied() {
    let plate = drawn(r#"<g transform="scale(2) translate(5 5)"><rect width="10" height="20"/></g>"#).unwrap();
    assert!((plate.area() - 0.0008).abs() < 1e-9);
    let text = r#"<svg xmlns="http://www.w3.org/2000/svg" width="210mm" height="297mm" viewBox="0 0 210 297">
        <rect x="10" y="10" width="100" height="200"/></svg>"#;
    assert!((Outline::from_svg(text, 0.001).unwrap().area() - 0.02).abs() < 1e-7);
}

#[test]
fn quadratic_curves_keep_their_area() {
    let lens = drawn(r#"<path d="M0 0 Q30 60 60 0 Z"/>"#).unwrap();
    assert!((lens.area() - 2.0 / 3.0 * 0.06 * 0.03).abs() < 1e-9);
}

#[test]
fn curves_that_cross_near_their_common_corner_or_themselves_are_named() {
    for path in [
        // Beyond the upright side by 0.3 of 160 units, within the first hundredth of the curve.
        "M10 90 L10 40 C9.7 80 150 80 170 40 L170 90 Z",
        // Loops.
        "M10 10 C190 60 -10 60 170 10 L170 120 L10 120 Z",
        "M10 10 C171 60 9 60 170 10 L170 120 L10 120 Z",
        // Two curves whose middles overlap by 0.02 units.
        "M10 10 C10 50 170 50 170 10 L170 69.98 C170 29.98 10 29.98 10 69.98 Z",
    ] {
        let found = drawn(&format!(r#"<path d="{path}"/>"#));
        assert!(matches!(found, Err(OutlineError::Crosses { ring: 0, .. })), "{path}: {found:?}");
    }
}

#[test]
fn curves_that_nearly_touch_are_a_body() {
    for path in [
        // Between the middles of two curves 0.02 units are left.
        "M10 10 C10 50 170 50 170 10 L170 70.02 C170 30.02 10 30.02 10 70.02 Z",
        // A crescent, 0.02 units wide where it is widest.
        "M10 100 A90 90 0 0 1 190 100 L189.99 100 A89.99 89.99 0 0 0 10.01 100 Z",
        // A tip between two arcs that have one tangent there.
        "M10 100 A90 90 0 0 1 190 100 A80 80 0 0 0 30 100 L10 100 Z",
    ] {
        drawn(&format!(r#"<path d="{path}"/>"#)).unwrap();
    }
}

#[test]
fn drawings_that_are_no_body_are_named() {
    assert!(matches!(drawn(r#"<path d="M0 0 L20 0 L0 10"/>"#), Err(OutlineError::OpenPath { path: 0, .. })));
    assert_eq!(drawn(""), Err(OutlineError::NoPath));
    assert_eq!(drawn(r#"<rect width="9" height="9" visibility="hidden"/>"#), Err(OutlineError::NoPath));
    assert!(matches!(Outline::from_svg("no drawing", 0.001), Err(OutlineError::Svg { .. })));
    assert!(matches!(Outline::from_svg(&svg(""), 0.0), Err(OutlineError::BadUnit { .. })));
    let two = r#"<rect width="9" height="9"/><rect x="20" width="5" height="5"/>"#;
    assert!(matches!(drawn(two), Err(OutlineError::TwoPieces { .. })));
    let over = r#"<rect width="9" height="9"/><rect x="5" y="3" width="6" height="5"/>"#;
    assert!(matches!(drawn(over), Err(OutlineError::HoleTouches { .. })));
}

#[test]
fn white_parts_of_a_drawing_are_its_ground_or_holes() {
    let body = r#"<rect x="10" y="10" width="100" height="60"/>"#;
    let area = |inner: &str| drawn(inner).unwrap_or_else(|error| panic!("{inner}: {error}")).area();
    for ground in [
        r#"<rect width="200" height="200" fill="white"/>"#,
        r##"<rect width="200" height="200" fill="#fdfdfd" stroke="none"/>"##,
        r#"<rect x="-5" y="-5" width="300" height="300" style="fill:#fff;stroke:#fff;stroke-width:2"/>"#,
        // Parts that nobody sees.
        r#"<rect width="200" height="200" fill="red" opacity="0"/>"#,
        r#"<rect width="200" height="200" fill="red" fill-opacity="0"/>"#,
        r#"<rect width="200" height="200" fill="none"/>"#,
        r#"<rect width="200" height="200" display="none"/>"#,
        r#"<g opacity="0"><rect width="200" height="200"/></g>"#,
        r#"<rect x="150" y="150" width="20" height="20" fill="white"/>"#,
    ] {
        assert!((area(&format!("{ground}{body}")) - 0.006).abs() < 1e-9, "{ground}");
    }
    let hole = r#"<rect x="40" y="30" width="20" height="10" fill="white"/>"#;
    let ground = r#"<rect width="200" height="200" fill="white"/>"#;
    assert!((area(&format!("{ground}{body}{hole}")) - 0.0058).abs() < 1e-9);
    // A bite is neither a hole nor the ground.
    let bite = drawn(&format!(r#"{ground}{body}<rect x="100" y="30" width="20" height="10" fill="white"/>"#));
    assert!(matches!(bite, Err(OutlineError::HoleTouches { .. })), "{bite:?}");
    // Strokes show what is filled white, and white shapes alone are the body.
    let stroked = r#"<rect width="100" height="60" fill="white" stroke="black"/>"#;
    assert!((area(&format!("{ground}{stroked}")) - 0.006).abs() < 1e-9);
    assert!((area(r#"<rect width="100" height="60" fill="white"/>"#) - 0.006).abs() < 1e-9);
    assert!((area(r#"<rect width="100" height="60" fill="none" stroke="black"/>"#) - 0.006).abs() < 1e-9);
}
