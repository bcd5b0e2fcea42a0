//! Meshes: they cover the body, conform, and follow its sides.

use proptest::prelude::*;
use shape::mesh::{Mesh, MeshError, Sizing};
use shape::outline::{FlatSide, Outline, OutlineError, Point, Side};
use std::collections::{HashMap, HashSet};
use std::f64::consts::PI;
use std::time::Instant;

const L_SHAPE: [Point; 6] = [[0.0, 0.0], [0.3, 0.0], [0.3, 0.1], [0.1, 0.1], [0.1, 0.2], [0.0, 0.2]];

fn square_hole(x: f64, y: f64, size: f64) -> Vec<Point> {
    vec![[x, y], [x + size, y], [x + size, y + size], [x, y + size]]
}

fn drawn(inner: &str) -> Outline {
    let text = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="200" height="200">{inner}</svg>"#);
    Outline::from_svg(&text, 0.001).unwrap()
}

fn layered(size_m: f64, layer_m: f64, sides: usize) -> Sizing {
    Sizing { size_m, layer_m: Some(layer_m), layered: vec![true; sides], corners_m: vec![] }
}

fn far(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Checks what holds for each mesh, and gives it.
fn checked(outline: &Outline, sizing: &Sizing) -> Mesh {
    let begin = Instant::now();
    let mesh = Mesh::over(outline, sizing).unwrap();
    let ms = begin.elapsed().as_secs_f64() * 1e3;
    let (count, angle) = (mesh.triangles.len(), mesh.smallest_angle_deg());
    println!("{count} triangles, smallest angle {angle:.1} degrees, {ms:.1} ms");
    let tolerance = if outline.is_curved() { 1e-9 } else { 1e-12 };
    assert!((mesh.area() - outline.area()).abs() < tolerance * outline.area(), "area");
    assert!((0..count).all(|triangle| mesh.triangle_area(triangle) > 0.0), "a triangle is turned over");
    // A band's diagonals are longer than its pieces, and its corners lengthen those beside them.
    let band = if sizing.layered.contains(&true) { 4.0 * sizing.layer_m.unwrap_or(0.0) } else { 0.0 };
    assert!(mesh.longest_edge_m() <= sizing.size_m * (1.0 + 1e-6) + band, "{} m", mesh.longest_edge_m());
    assert_conforming(&mesh);
    assert_sides_covered(outline, &mesh);
    let used: HashSet<usize> = mesh.triangles.iter().flatten().copied().collect();
    assert_eq!(used.len(), mesh.points.len(), "each point is a vertex");
    assert_eq!(mesh, Mesh::over(outline, sizing).unwrap(), "each run gives the same");
    mesh
}

/// Each edge belongs to two triangles, or to one and to the outline.
fn assert_conforming(mesh: &Mesh) {
    let mut edges = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for edge in [[a, b], [b, c], [c, a]] {
            assert_eq!(edges.insert(edge, ()), None, "edge {edge:?} twice in one direction");
        }
    }
    let outer: HashSet<[usize; 2]> = mesh.edges.iter().map(|edge| edge.vertices).collect();
    assert_eq!(outer.len(), mesh.edges.len());
    for &[a, b] in edges.keys() {
        assert_eq!(edges.contains_key(&[b, a]), !outer.contains(&[a, b]), "edge {a} {b}");
    }
    assert!(outer.iter().all(|edge| edges.contains_key(edge)));
    // A body with h holes: V - E + T = 1 - h, without vertices that hang in edges.
    let count = (edges.len() + outer.len()) / 2;
    let rings = rings_of(mesh);
    assert_eq!(mesh.points.len() + mesh.triangles.len() + rings, count + 2);
}

/// Counts the closed ways along the edges on the outline.
fn rings_of(mesh: &Mesh) -> usize {
    let next: HashMap<usize, usize> = mesh.edges.iter().map(|edge| (edge.vertices[0], edge.vertices[1])).collect();
    let mut left: HashSet<usize> = next.keys().copied().collect();
    let mut count = 0;
    while let Some(&first) = left.iter().next() {
        count += 1;
        let mut at = first;
        while left.remove(&at) {
            at = next[&at];
        }
    }
    count
}

/// The edges on each side lead from its begin to its end, on the side.
fn assert_sides_covered(outline: &Outline, mesh: &Mesh) {
    for (index, side) in outline.sides().iter().enumerate() {
        let edges: Vec<_> = mesh.edges.iter().filter(|edge| edge.side == index).collect();
        let mut next: HashMap<usize, _> = edges.iter().map(|edge| (edge.vertices[0], *edge)).collect();
        let size = far(side.from, side.to);
        let mut at = *next.keys().find(|v| far(mesh.points[**v], side.from) < 1e-9 * size).unwrap();
        while let Some(edge) = next.remove(&at) {
            at = edge.vertices[1];
            assert_eq!(edge.curve.is_some(), side.curve.is_some());
            let [from, to] = edge.vertices.map(|vertex| mesh.points[vertex]);
            let part = FlatSide { ring: 0, from, to, curve: edge.curve };
            for t in [0.0, 0.5, 1.0] {
                assert!(gap(side, part.point(t)) < 1e-9 * size, "off the side by {}", gap(side, part.point(t)));
            }
        }
        assert!(next.is_empty(), "side {index} has edges apart");
        assert!(far(mesh.points[at], side.to) < 1e-9 * size, "side {index} is not covered to its end");
    }
}

/// Gives the distance of a point from a side: halves that are further away than another are left
/// out until chords are as good as curves.
fn gap(side: &FlatSide, point: Point) -> f64 {
    let mut nearest = f64::INFINITY;
    let mut pieces = vec![*side];
    while let Some(piece) = pieces.pop() {
        let [a, b, c, d] = piece.controls();
        let third = |share: f64| [0, 1].map(|axis| a[axis] + share * (d[axis] - a[axis]));
        let off = far(b, third(1.0 / 3.0)).max(far(c, third(2.0 / 3.0)));
        let way = [d[0] - a[0], d[1] - a[1]];
        let along = (point[0] - a[0]) * way[0] + (point[1] - a[1]) * way[1];
        let share = along / (way[0] * way[0] + way[1] * way[1]).max(f64::MIN_POSITIVE);
        let from_chord = far(point, third(share.clamp(0.0, 1.0)));
        if from_chord - off < nearest {
            nearest = nearest.min(from_chord + off);
            if off > 1e-15 {
                pieces.extend(piece.split(0.5));
            }
        }
    }
    nearest
}

/// Tells whether each point has a partner under a map.
fn maps_onto_itself(mesh: &Mesh, map: impl Fn(Point) -> Point) -> bool {
    let near = |p: Point| mesh.points.iter().any(|q| far(p, *q) < 1e-8);
    mesh.points.iter().all(|p| near(map(*p)))
}

#[test]
fn an_l_shape_is_covered_by_well_formed_triangles() {
    let outline = Outline::polygon(&L_SHAPE, &[]).unwrap();
    let mesh = checked(&outline, &Sizing::even(0.02));
    assert!(mesh.smallest_angle_deg() > 24.9, "{}", mesh.smallest_angle_deg());
}

#[test]
fn holes_stay_free() {
    let holes = [square_hole(0.02, 0.02, 0.03), square_hole(0.2, 0.03, 0.04)];
    let outline = Outline::polygon(&L_SHAPE, &holes).unwrap();
    let mesh = checked(&outline, &Sizing::even(0.02));
    assert_eq!(rings_of(&mesh), 3);
    assert!(mesh.smallest_angle_deg() > 24.9);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| mesh.points[vertex]);
        assert!(outline.contains([(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0]));
    }
}

#[test]
fn a_layer_lies_along_all_sides_of_an_l_shape() {
    let outline = Outline::polygon(&L_SHAPE, &[square_hole(0.02, 0.02, 0.03)]).unwrap();
    let mesh = checked(&outline, &layered(0.02, 0.002, 10));
    let boundary: HashSet<usize> = mesh.edges.iter().flat_map(|edge| edge.vertices).collect();
    let sides = outline.sides();
    let depth = |v: usize| sides.iter().map(|side| gap(side, mesh.points[v])).fold(f64::INFINITY, f64::min);
    for triangle in mesh.triangles.iter().filter(|triangle| triangle.iter().any(|v| boundary.contains(v))) {
        for vertex in triangle.iter().filter(|v| !boundary.contains(v)) {
            // Corners that point into the body are a mitre away.
            assert!((0.002 - 1e-9..0.002 * 2f64.sqrt() + 1e-9).contains(&depth(*vertex)), "{}", depth(*vertex));
        }
    }
}

#[test]
fn a_layer_along_some_sides_ends_on_their_neighbours() {
    let outline = Outline::polygon(&L_SHAPE, &[]).unwrap();
    for kept in 0..6 {
        let mut sizing = layered(0.02, 0.002, 6);
        sizing.layered[kept] = false;
        sizing.layered[(kept + 2) % 6] = false;
        checked(&outline, &sizing);
        let sizing = Sizing { layered: (0..6).map(|side| side == kept).collect(), ..sizing };
        checked(&outline, &sizing);
    }
}

#[test]
fn a_layer_that_does_not_fit_is_left_out() {
    let wedge = [[0.0, 0.0], [0.3, 0.0], [0.3, 0.06], [0.1, 0.02], [0.0, 0.01]];
    let outline = Outline::polygon(&wedge, &[]).unwrap();
    for layer in [0.001, 0.004, 0.01, 0.05] {
        checked(&outline, &layered(0.02, layer, 5));
    }
}

#[test]
fn a_rectangle_has_a_symmetric_mesh() {
    for sizing in [Sizing::even(0.013), layered(0.02, 0.003, 4)] {
        let outline = Outline::polygon(&square_hole(-0.05, -0.05, 0.1), &[]).unwrap();
        let mesh = checked(&outline, &sizing);
        assert!(maps_onto_itself(&mesh, |[x, y]| [-x, y]));
        assert!(maps_onto_itself(&mesh, |[x, y]| [y, x]));
        let (sine, cosine) = 0.7f64.sin_cos();
        let turn = |x: f64, y: f64| [cosine * x - sine * y, sine * x + cosine * y];
        let turned = [turn(-0.1, -0.04), turn(0.1, -0.04), turn(0.1, 0.04), turn(-0.1, 0.04)];
        let mesh = checked(&Outline::polygon(&turned, &[]).unwrap(), &sizing);
        assert!(maps_onto_itself(&mesh, |[x, y]| [-x, -y]));
    }
}

#[test]
fn a_rectangle_has_rows_of_the_layers_width_along_its_layered_sides() {
    let outline = Outline::polygon(&[[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.0, 0.1]], &[]).unwrap();
    let sizing =
        Sizing { size_m: 0.02, layer_m: Some(0.002), layered: vec![true, false, false, true], corners_m: vec![] };
    let mesh = checked(&outline, &sizing);
    let rows = |axis: usize, at: f64| mesh.points.iter().filter(|p| (p[axis] - at).abs() < 1e-12).count();
    assert!(rows(1, 0.002) > 5 && rows(0, 0.002) > 5);
    assert!(rows(1, 0.098) == 0 && rows(0, 0.198) == 0);
}

#[test]
fn a_disc_has_a_mesh_that_a_quarter_turn_keeps() {
    let disc = drawn(r#"<circle cx="0" cy="0" r="100"/>"#);
    let sides = disc.sides().len();
    for sizing in [Sizing::even(0.02), Sizing::even(0.5), layered(0.02, 0.002, sides)] {
        let mesh = checked(&disc, &sizing);
        assert!((mesh.area() / (PI * 0.01) - 1.0).abs() < 1e-3);
        assert!(maps_onto_itself(&mesh, |[x, y]| [-y, x]));
        assert!(maps_onto_itself(&mesh, |[x, y]| [-x, y]));
    }
}

#[test]
fn a_disc_with_a_concentric_hole_has_a_mesh_that_a_quarter_turn_keeps() {
    let ring = drawn(r#"<circle cx="0" cy="0" r="100"/><circle cx="0" cy="0" r="20"/>"#);
    let sides = ring.sides().len();
    for sizing in [Sizing::even(0.02), layered(0.02, 0.002, sides)] {
        let mesh = checked(&ring, &sizing);
        assert!((mesh.area() / (PI * 0.0096) - 1.0).abs() < 1e-3);
        assert!(maps_onto_itself(&mesh, |[x, y]| [-y, x]));
    }
}

#[test]
fn a_disc_has_at_most_2_1_times_the_triangles_of_a_square_of_its_area() {
    let disc = drawn(r#"<circle cx="0" cy="0" r="100"/>"#);
    for size_m in [0.0242, 0.0154, 0.007] {
        let count = checked(&disc, &Sizing::even(size_m)).triangles.len();
        let of_square = 4.0 * PI * 0.01 / (size_m * size_m);
        println!("{count} triangles, {of_square:.0} in a square");
        assert!(count as f64 <= 2.1 * of_square, "{count} triangles, {of_square} in a square");
    }
}

#[test]
fn rings_around_a_small_hole_grow_with_their_distance_from_it() {
    let ring = drawn(r#"<circle cx="0" cy="0" r="75"/><circle cx="0" cy="0" r="2"/>"#);
    let disc = drawn(r#"<circle cx="0" cy="0" r="75"/>"#);
    let [with_hole, without] = [ring, disc].map(|outline| checked(&outline, &Sizing::even(0.0115)).triangles.len());
    println!("{with_hole} triangles with the hole, {without} without");
    assert!(with_hole <= 2 * without, "{with_hole} triangles with the hole, {without} without");
}

#[test]
fn curved_sides_are_followed_around_holes_and_in_layers() {
    let shapes = [
        r#"<circle cx="90" cy="90" r="80"/><circle cx="70" cy="60" r="20"/>"#,
        r#"<ellipse cx="90" cy="90" rx="80" ry="30"/>"#,
        r#"<rect x="10" y="10" width="150" height="60" rx="12"/>"#,
        r#"<path d="M10 10 C60 60 120 60 170 10 L170 100 C120 70 60 70 10 100 Z"/>"#,
        r#"<path d="M10 10 Q60 90 160 10 L160 20 Q60 120 10 20 Z"/>"#,
    ];
    for shape in shapes {
        let outline = drawn(shape);
        let sides = outline.sides().len();
        for size in [0.05, 0.02, 0.005] {
            let mesh = checked(&outline, &Sizing::even(size));
            assert!(mesh.smallest_angle_deg() > 15.0, "{shape}");
        }
        for layer in [0.0005, 0.002, 0.02] {
            checked(&outline, &layered(0.02, layer, sides));
        }
    }
}

#[test]
fn curves_stay_clear_of_their_triangles_other_corners() {
    let outline = drawn(r#"<path d="M10 10 C60 60 120 60 170 10 L170 100 C120 70 60 70 10 100 Z"/>"#);
    let mesh = checked(&outline, &layered(0.05, 0.001, 4));
    for edge in &mesh.edges {
        let triangle = mesh.triangles.iter().find(|t| edge.vertices.iter().all(|v| t.contains(v))).unwrap();
        let apex = mesh.points[*triangle.iter().find(|v| !edge.vertices.contains(v)).unwrap()];
        let [from, to] = edge.vertices.map(|vertex| mesh.points[vertex]);
        let side = FlatSide { ring: 0, from, to, curve: edge.curve };
        for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
            let (way, at) = (side.derivative(t), side.point(t));
            assert!(way[0] * (apex[1] - at[1]) > way[1] * (apex[0] - at[0]));
        }
    }
}

#[test]
fn thin_necks_between_curves_are_covered() {
    for width in [3.0, 0.3, 0.03] {
        let [above, below] = [1.0, -1.0].map(|side: f64| (side * width / 2.0 * 8.0 - side * 60.0) / 6.0 + 50.0);
        let neck = format!("M10 20 C70 {below} 90 {below} 150 20 L150 80 C80 {above} 80 {above} 10 80 Z");
        let outline = drawn(&format!(r#"<path d="{neck}"/>"#));
        for size in [0.1, 0.01] {
            checked(&outline, &Sizing::even(size));
            checked(&outline, &layered(size, 0.001, 4));
        }
    }
}

#[test]
fn curves_that_leave_a_corner_in_nearly_one_direction_are_covered() {
    // Corners of 8 and 1 degrees between curves that bend one way.
    for (first, second) in [("60 40 120 60", "100 40 60 22"), ("60 40 120 60", "100 40 60 39")] {
        let outline = drawn(&format!(r#"<path d="M10 10 C{first} 150 30 L150 5 C{second} 10 10 Z"/>"#));
        let mesh = checked(&outline, &Sizing::even(0.02));
        assert!(mesh.triangles.len() < 3000, "{} triangles", mesh.triangles.len());
    }
}

#[test]
fn an_acute_corner_ends() {
    let outline = Outline::polygon(&[[0.0, 0.0], [0.3, 0.0], [0.3, 0.03]], &[]).unwrap();
    checked(&outline, &Sizing::even(0.02));
    checked(&outline, &layered(0.02, 0.001, 3));
}

#[test]
fn sizes_that_make_no_mesh_are_named() {
    let outline = Outline::polygon(&L_SHAPE, &[]).unwrap();
    let error = |sizing: &Sizing| Mesh::over(&outline, sizing).unwrap_err();
    assert!(matches!(error(&Sizing::even(0.0)), MeshError::BadSize { .. }));
    assert!(matches!(error(&Sizing::even(f64::NAN)), MeshError::BadSize { .. }));
    assert!(matches!(error(&layered(0.01, -1.0, 6)), MeshError::BadSize { .. }));
    assert!(matches!(error(&Sizing::even(1e-6)), MeshError::TooFine { .. }));
    let empty = Mesh::over(&Outline { rings: vec![] }, &Sizing::even(0.1));
    assert_eq!(empty, Err(MeshError::Outline(OutlineError::Empty)));
}

fn star() -> impl Strategy<Value = Vec<Point>> {
    prop::collection::vec((0.3f64..1.0, 0.1f64..0.9), 3..14).prop_map(|corners| {
        let count = corners.len() as f64;
        let point = |(k, (radius, shift)): (usize, &(f64, f64))| {
            let (sine, cosine) = (2.0 * PI * (k as f64 + shift) / count).sin_cos();
            [0.1 * radius * cosine, 0.1 * radius * sine]
        };
        corners.iter().enumerate().map(point).collect()
    })
}

/// Star with curves for sides that bend by up to a share of its size. Some cross themselves.
fn curved_star() -> impl Strategy<Value = Vec<Side>> {
    let bends = prop::collection::vec((any::<bool>(), [-1.0f64..1.0, -1.0..1.0, -1.0..1.0, -1.0..1.0]), 14);
    (star(), bends, 0.005f64..0.05).prop_map(|(points, bends, share)| {
        let side = |(k, from): (usize, &Point)| {
            let (to, (is_curved, bend)) = (points[(k + 1) % points.len()], bends[k]);
            let control = |along: f64, [x, y]: [f64; 2]| {
                [from[0] + along * (to[0] - from[0]) + share * x, from[1] + along * (to[1] - from[1]) + share * y]
            };
            let curve = [control(0.33, [bend[0], bend[1]]), control(0.67, [bend[2], bend[3]])];
            Side { from: *from, curve: is_curved.then_some(curve) }
        };
        points.iter().enumerate().map(side).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn any_star_of_curves_is_covered_if_it_is_a_body(star in curved_star(), size in 0.01f64..0.2) {
        let outline = Outline { rings: vec![star] };
        prop_assume!(outline.check().is_ok());
        checked(&outline, &Sizing::even(size));
        checked(&outline, &layered(size, 0.002, 14));
    }

    #[test]
    fn any_star_is_covered(points in star(), size in 0.01f64..0.2) {
        checked(&Outline::polygon(&points, &[]).unwrap(), &Sizing::even(size));
    }

    #[test]
    fn any_star_with_a_layer_is_covered(points in star(), layer in 0.0005f64..0.02, sides in any::<[bool; 14]>()) {
        let sizing = Sizing { size_m: 0.02, layer_m: Some(layer), layered: sides.to_vec(), corners_m: vec![] };
        checked(&Outline::polygon(&points, &[]).unwrap(), &sizing);
    }
}
