//! Surfaces of the tests, and faults of surfaces.

use std::f64::consts::{FRAC_PI_4, TAU};

use proptest::prelude::*;
use shape::surface::{Point, Surface, SurfaceError};

/// Vertices and triangles.
pub(crate) type Mesh = (Vec<Point>, Vec<[usize; 3]>);

/// Corners of a cube's faces, counter-clockwise seen from outside.
const FACES: [[usize; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

pub(crate) fn cuboid(extents: Point) -> Mesh {
    let corner = |bits: usize| [0, 1, 2].map(|axis| if bits >> axis & 1 == 1 { extents[axis] } else { 0.0 });
    let triangles = FACES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

/// Turns a body about the three axes, by angles in radians.
pub(crate) fn turned((points, triangles): Mesh, angles: Point) -> Mesh {
    let turn = |mut at: Point| {
        for (axis, angle) in angles.into_iter().enumerate() {
            let (sine, cosine) = angle.sin_cos();
            let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
            (at[a], at[b]) = (cosine * at[a] - sine * at[b], sine * at[a] + cosine * at[b]);
        }
        at
    };
    (points.into_iter().map(turn).collect(), triangles)
}

/// Ball of squares on the six sides of a cube that is blown up.
pub(crate) fn ball(radius: f64, steps: usize) -> Mesh {
    let (cube, _) = cuboid([2.0; 3]);
    let (mut points, mut triangles) = (vec![], vec![]);
    let part = |step: usize| (FRAC_PI_4 * (2.0 * step as f64 / steps as f64 - 1.0)).tan();
    for [a, b, _, d] in FACES.map(|face| face.map(|corner| cube[corner].map(|part| part - 1.0))) {
        let first = points.len();
        for (row, column) in (0..=steps).flat_map(|row| (0..=steps).map(move |column| (row, column))) {
            let [u, v] = [row, column].map(|step| (1.0 + part(step)) / 2.0);
            let at = [0, 1, 2].map(|axis| a[axis] + u * (b[axis] - a[axis]) + v * (d[axis] - a[axis]));
            let length = at.iter().map(|part| part * part).sum::<f64>().sqrt();
            points.push(at.map(|part| radius * part / length));
        }
        for (row, column) in (0..steps).flat_map(|row| (0..steps).map(move |column| (row, column))) {
            let corner = first + row * (steps + 1) + column;
            let across = corner + steps + 1;
            triangles.extend([[corner, across, across + 1], [corner, across + 1, corner + 1]]);
        }
    }
    (points, triangles)
}

/// Cylinder along the third axis, of flat sides.
pub(crate) fn cylinder(radius: f64, length: f64, sides: usize) -> Mesh {
    let mut points = vec![[0.0; 3], [0.0, 0.0, length]];
    let mut triangles = vec![];
    for side in 0..sides {
        let (sine, cosine) = (TAU * side as f64 / sides as f64).sin_cos();
        points.extend([[radius * cosine, radius * sine, 0.0], [radius * cosine, radius * sine, length]]);
        let [low, next] = [side, (side + 1) % sides].map(|side| 2 + 2 * side);
        triangles.extend([[low, next, next + 1], [low, next + 1, low + 1], [0, next, low], [1, low + 1, next + 1]]);
    }
    (points, triangles)
}

/// Tube along the third axis, open at both ends, of flat sides.
pub(crate) fn tube(radii: [f64; 2], length: f64, sides: usize) -> Mesh {
    let (mut points, mut triangles) = (vec![], vec![]);
    for side in 0..sides {
        let (sine, cosine) = (TAU * side as f64 / sides as f64).sin_cos();
        // Inner and outer circle below, then above.
        for (radius, z) in [(radii[0], 0.0), (radii[1], 0.0), (radii[0], length), (radii[1], length)] {
            points.push([radius * cosine, radius * sine, z]);
        }
        let [here, next] = [side, (side + 1) % sides].map(|side| 4 * side);
        for [a, b] in [[1, 3], [3, 2], [2, 0], [0, 1]] {
            triangles.extend([[here + a, next + a, next + b], [here + a, next + b, here + b]]);
        }
    }
    (points, triangles)
}

/// Puts two surfaces together, the second turned inside out: a cavity.
pub(crate) fn with_cavity((mut points, mut triangles): Mesh, (others, inner): Mesh) -> Mesh {
    let first = points.len();
    points.extend(others);
    triangles.extend(inner.iter().map(|&[a, b, c]| [a + first, c + first, b + first]));
    (points, triangles)
}

/// Bytes of a binary STL file of a surface.
pub(crate) fn stl((points, triangles): &Mesh) -> Vec<u8> {
    let vertex = |point: usize| stl_io::Vertex::new(points[point].map(|part| part as f32));
    let triangle = |corners: &[usize; 3]| stl_io::Triangle {
        normal: stl_io::Normal::new([0.0; 3]),
        vertices: corners.map(vertex),
    };
    let mut bytes = Vec::new();
    stl_io::write_stl(&mut bytes, triangles.iter().map(triangle).collect::<Vec<_>>().iter()).expect("memory");
    bytes
}

#[test]
fn surfaces_that_close_no_body_are_refused_by_name() {
    let cube = cuboid([0.1; 3]);
    let with = |change: &dyn Fn(&mut Mesh)| {
        let mut changed = cube.clone();
        change(&mut changed);
        Surface::new(&changed.0, &changed.1).unwrap_err()
    };
    assert!(matches!(with(&|mesh| mesh.1.truncate(11)), SurfaceError::Gap(_)));
    assert!(matches!(with(&|mesh| mesh.1[3].swap(0, 1)), SurfaceError::Turned(_)));
    assert_eq!(with(&|mesh| mesh.1.iter_mut().for_each(|triangle| triangle.swap(0, 1))), SurfaceError::InsideOut);
    assert!(matches!(with(&|mesh| mesh.1.push([0, 2, 3])), SurfaceError::Branched(_)));
    assert_eq!(with(&|mesh| mesh.1.clear()), SurfaceError::Empty);
    assert_eq!(with(&|mesh| mesh.0[5][1] = f64::NAN), SurfaceError::NotFinite(5));
    assert_eq!(with(&|mesh| mesh.1[0][0] = 8), SurfaceError::Vertex(8));
    let twice = |mesh: &mut Mesh| {
        let second: Vec<Point> = mesh.0.iter().map(|point| [point[0] + 0.3, point[1], point[2]]).collect();
        mesh.0.extend(second);
        let second: Vec<_> = mesh.1.iter().map(|triangle| triangle.map(|vertex| vertex + 8)).collect();
        mesh.1.extend(second);
    };
    assert_eq!(with(&twice), SurfaceError::Pieces(2));
}

#[test]
fn stl_and_obj_files_give_the_same_body_in_metres() {
    let mesh = cuboid([30.0, 40.0, 50.0]);
    let of_stl = Surface::from_stl(&stl(&mesh), 0.001).unwrap();
    let mut text = String::new();
    mesh.0.iter().for_each(|point| text += &format!("v {} {} {}\n", point[0], point[1], point[2]));
    // Faces of four corners.
    FACES
        .iter()
        .for_each(|face| text += &format!("f {} {} {} {}\n", face[0] + 1, face[1] + 1, face[2] + 1, face[3] + 1));
    let of_obj = Surface::from_obj(text.as_bytes(), 0.001).unwrap();
    for surface in [of_stl, of_obj] {
        assert!((surface.volume_m3() / 6e-5 - 1.0).abs() < 1e-6, "{}", surface.volume_m3());
        assert_eq!(surface.triangles().len(), 12);
    }
    assert!(matches!(Surface::from_stl(b"no surface", 1.0), Err(SurfaceError::Text(_))));
    assert!(matches!(Surface::from_obj(b"f 1 2 3\n", 1.0), Err(SurfaceError::Text(_))));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn cut_and_spoilt_files_are_read_or_refused(length in 0_usize..700, at in 84_usize..700, byte in any::<u8>()) {
        let mut bytes = stl(&cuboid([0.1, 0.2, 0.3]));
        let place = at % bytes.len();
        bytes[place] = byte;
        let _ = Surface::from_stl(&bytes, 1.0);
        bytes.truncate(length);
        let _ = Surface::from_stl(&bytes, 1.0);
        let _ = Surface::from_obj(&bytes, 1.0);
    }
}
