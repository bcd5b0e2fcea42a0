//! Finite elements against motions and frequencies that are known.

use std::f64::consts::PI;

use faer::{Mat, Side};
use shape::element::{
    Discrete, Elasticity, Error, Material, Membrane, Nodes, PlaneState, Plate, Revolve, Sheet, Support,
};
use shape::mesh::{BoundaryEdge, Mesh};

const FREE: [Support; 4] = [Support::Free; 4];
const HINGED: [Support; 4] = [Support::Hinged; 4];
const CLAMPED: [Support; 4] = [Support::Clamped; 4];

/// Unit square in cells, each parted in four triangles, moved by a map. Sides: bottom, right, top,
/// left. Only cells for which `keep` is true.
fn grid(columns: usize, rows: usize, keep: impl Fn(usize, usize) -> bool, map: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
    let mut points: Vec<[f64; 2]> = Vec::new();
    let mut numbers = std::collections::HashMap::new();
    let mut vertex = |x: usize, y: usize| {
        *numbers.entry([x, y]).or_insert_with(|| {
            points.push(map([x as f64 / (2 * columns) as f64, y as f64 / (2 * rows) as f64]));
            points.len() - 1
        })
    };
    let mut triangles = Vec::new();
    let mut edges = Vec::new();
    for row in 0..rows {
        for column in (0..columns).filter(|column| keep(*column, row)) {
            let [x, y] = [2 * column, 2 * row];
            let corners = [vertex(x, y), vertex(x + 2, y), vertex(x + 2, y + 2), vertex(x, y + 2)];
            let centre = vertex(x + 1, y + 1);
            let outside = |column: usize, row: usize| column >= columns || row >= rows || !keep(column, row);
            let open = [
                row == 0 || outside(column, row - 1),
                outside(column + 1, row),
                outside(column, row + 1),
                column == 0 || outside(column - 1, row),
            ];
            for side in 0..4 {
                let ends = [corners[side], corners[(side + 1) % 4]];
                triangles.push([ends[0], ends[1], centre]);
                if open[side] {
                    edges.push(BoundaryEdge { vertices: ends, side, curve: None });
                }
            }
        }
    }
    Mesh { points, triangles, edges }
}

fn rectangle(columns: usize, rows: usize, width: f64, height: f64) -> Mesh {
    grid(columns, rows, |_, _| true, |[x, y]| [width * x, height * y])
}

/// Sector of a disc around the origin, parted in equal triangles with cubic arcs on side 0; the
/// straight edges at both ends, if it is no full disc, are side 1.
fn sector(radius: f64, from: f64, to: f64, parts: usize) -> Mesh {
    let step = (to - from) / parts as f64;
    let full = (to - from - 2.0 * PI).abs() < 1e-12;
    let around = if full { parts } else { parts + 1 };
    let ring = |radius: f64, index: usize| {
        let (sine, cosine) = (from + step * index as f64).sin_cos();
        [radius * cosine, radius * sine]
    };
    let mut points = vec![[0.0, 0.0]];
    points.extend((0..around).map(|index| ring(0.5 * radius, index)));
    points.extend((0..around).map(|index| ring(radius, index)));
    // On the axis of revolution the cosine of a right angle is not zero.
    points.iter_mut().filter(|point| point[0].abs() < 1e-12).for_each(|point| point[0] = 0.0);
    let mut triangles = Vec::new();
    let mut edges = Vec::new();
    let handle = 4.0 / 3.0 * (step / 4.0).tan();
    for part in 0..parts {
        let [a, b] = [1 + part, 1 + (part + 1) % around];
        let [c, d] = [a + around, b + around];
        triangles.extend([[0, a, b], [a, c, d], [a, d, b]]);
        let [begin, end] = [points[c], points[d]];
        let curve = [
            [begin[0] - handle * begin[1], begin[1] + handle * begin[0]],
            [end[0] + handle * end[1], end[1] - handle * end[0]],
        ];
        edges.push(BoundaryEdge { vertices: [c, d], side: 0, curve: Some(curve) });
    }
    if !full {
        let last = around;
        for vertices in [[0, 1], [1, 1 + around], [last + around, last], [last, 0]] {
            edges.push(BoundaryEdge { vertices, side: 1, curve: None });
        }
    }
    Mesh { points, triangles, edges }
}

/// Matrices of stiffness and mass with all entries.
fn dense(discrete: &Discrete) -> [Mat<f64>; 2] {
    let problem = &discrete.problem;
    [&problem.stiffness, &problem.mass].map(|entries| {
        let mut matrix = Mat::zeros(problem.size, problem.size);
        for column in 0..problem.size {
            assert_eq!(problem.rows[problem.starts[column]], column);
            for entry in problem.starts[column]..problem.starts[column + 1] {
                matrix[(problem.rows[entry], column)] = entries[entry];
                matrix[(column, problem.rows[entry])] = entries[entry];
            }
        }
        matrix
    })
}

/// Angular frequencies above zero, from the lowest, after as many zeros as there are rigid motions.
fn frequencies(discrete: &Discrete) -> Vec<f64> {
    let [stiffness, mass] = dense(discrete);
    let factor = mass.llt(Side::Lower).expect("the mass is positive definite").L().to_owned();
    let mut reduced = stiffness;
    for _ in 0..2 {
        faer::linalg::triangular_solve::solve_lower_triangular_in_place(
            factor.as_ref(),
            reduced.as_mut(),
            faer::Par::Seq,
        );
        reduced = reduced.transpose().to_owned();
    }
    let squares = reduced.self_adjoint_eigenvalues(Side::Lower).expect("the eigenvalues converge");
    let (rigid, bending) = squares.split_at(discrete.rigid);
    let lowest = bending.first().copied().unwrap_or(0.0);
    assert!(lowest > 0.0 && rigid.iter().all(|square| square.abs() < 1e-3 * lowest), "{rigid:?} {lowest}");
    bending.iter().map(|square| square.sqrt()).collect()
}

fn assert_near(found: &[f64], expected: &[f64], bound: f64) {
    let errors: Vec<f64> = found.iter().zip(expected).map(|(found, expected)| found / expected - 1.0).collect();
    println!("{:?} against {expected:?}: {errors:?}", &found[..expected.len()]);
    assert!(errors.len() == expected.len() && errors.iter().all(|error| error.abs() < bound), "{errors:?}");
}

fn energy(discrete: &Discrete, entries: usize, motion: impl Fn([f64; 2]) -> [f64; 3]) -> f64 {
    let vector = discrete.vector(motion);
    let matrix = &dense(discrete)[entries];
    let sum = |row: usize| (0..vector.len()).map(|column| matrix[(row, column)] * vector[column]).sum::<f64>();
    (0..vector.len()).map(|row| vector[row] * sum(row)).sum::<f64>() / 2.0
}

fn steel() -> Material {
    Material::isotropic(200e9, 0.3, 8000.0)
}

/// Bending stiffness of a plate of steel, N m.
fn rigidity(thickness: f64) -> f64 {
    200e9 * thickness.powi(3) / (12.0 * (1.0 - 0.09))
}

fn skewed([x, y]: [f64; 2]) -> [f64; 2] {
    [2.0 * x + 0.4 * y + 0.1 * x * y, 1.5 * y - 0.2 * x]
}

#[test]
fn plates_with_constant_curvature_have_its_energy() {
    let plate = Plate { material: steel(), thickness: 0.1 };
    // On curved elements the square of a coordinate is no polynomial of order 4.
    for (mesh, bound) in [(grid(2, 2, |_, _| true, skewed), 1e-9), (sector(1.0, 0.0, 2.0 * PI, 8), 1e-4)] {
        let discrete = plate.discretise(&mesh, 4, &FREE).unwrap();
        assert_eq!(discrete.rigid, 3);
        let area = energy(&discrete, 1, |_| [1.0, 0.0, 0.0]) * 2.0 / 800.0;
        let rigid = energy(&discrete, 0, |[x, y]| [0.3 + 2.0 * x - y, 2.0, -1.0]);
        // w = x²/2 + xy: the curvatures are 1, 0 and 2.
        let bent = energy(&discrete, 0, |[x, y]| [x * x / 2.0 + x * y, x + y, x]);
        let exact = area * rigidity(0.1) * (1.0 + 0.35 * 4.0) / 2.0;
        assert!(rigid.abs() < 1e-9 * bent, "{rigid} {bent}");
        assert!((bent / exact - 1.0).abs() < bound, "{bent} {exact}");
    }
}

#[test]
fn sheets_with_constant_strain_have_its_energy() {
    let sheet = Sheet { material: steel(), thickness: 0.1, state: PlaneState::Stress };
    for order in [1, 2, 3, 4] {
        for mesh in [grid(2, 2, |_, _| true, skewed), sector(1.0, 0.0, 2.0 * PI, 8)] {
            let discrete = sheet.discretise(&mesh, order, &FREE).unwrap();
            let area = energy(&discrete, 1, |_| [1.0, 0.0, 0.0]) * 2.0 / 800.0;
            let rigid = energy(&discrete, 0, |[x, y]| [2.0 - y, x, 0.0]);
            let strained = energy(&discrete, 0, |[x, y]| [x + 2.0 * y, 0.0, 0.0]);
            let exact = area * 0.1 * 200e9 / 0.91 * (1.0 + 0.35 * 4.0) / 2.0;
            assert!(rigid.abs() < 1e-12 * strained, "{rigid} {strained}");
            assert!((strained / exact - 1.0).abs() < 1e-12, "{strained} {exact}");
        }
    }
}

#[test]
fn orthotropic_stiffness_turns_with_the_grain() {
    let energy_at = |grain: f64, shear: f64| {
        let elasticity =
            Elasticity::Orthotropic { young: [10e9, 1e9], poisson: 0.3, shear, transverse: [0.7e9, 0.05e9], grain };
        let plate = Plate { material: Material { elasticity, density: 500.0 }, thickness: 0.01 };
        let discrete = plate.discretise(&rectangle(1, 1, 1.0, 1.0), 2, &FREE).unwrap();
        // Curvature along the grain only, and shear across it only.
        let (sine, cosine) = grain.sin_cos();
        let along = |[x, y]: [f64; 2]| cosine * x + sine * y;
        let bent = energy(&discrete, 0, |at| [along(at).powi(2) / 2.0, cosine * along(at), sine * along(at)]);
        let sheared = energy(&discrete, 0, |_| [0.0, -sine, cosine]);
        (bent, sheared)
    };
    for grain in [0.0, 0.4, 1.7] {
        let (bent, sheared) = energy_at(grain, 0.6e9);
        assert!((bent / (10e9 / (1.0 - 0.009) * 1e-6 / 12.0 / 2.0) - 1.0).abs() < 1e-9);
        assert!((sheared / (PI * PI / 12.0 * 0.05e9 * 0.01 / 2.0) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn discs_of_cubic_arcs_have_their_area_and_points() {
    let membrane = Membrane { tension: 1.0, density: 1.0 };
    let discrete = membrane.discretise(&sector(2.0, 0.0, 2.0 * PI, 8), 4, &FREE).unwrap();
    let area = 2.0 * energy(&discrete, 1, |_| [1.0, 0.0, 0.0]);
    assert!((area / (4.0 * PI) - 1.0).abs() < 1e-5);
    let vector = discrete.vector(|[x, y]| [x - 3.0 * y, 0.0, 0.0]);
    for index in 0..200 {
        let (sine, cosine) = (0.1 * f64::from(index)).sin_cos();
        let radius = 2.0 * f64::from(index) / 200.0;
        let point = [radius * cosine, radius * sine];
        let value = discrete.value(&vector, point).unwrap()[0];
        assert!((value - (point[0] - 3.0 * point[1])).abs() < 1e-9);
        let (triangle, local) = discrete.nodes.locate(point).unwrap();
        let found = discrete.nodes.position(triangle, local);
        assert!((found[0] - point[0]).hypot(found[1] - point[1]) < 1e-9);
        assert!(discrete.value(&vector, [2.001 * cosine, 2.001 * sine]).is_none());
    }
    assert!(discrete.value(&vector, [f64::NAN, 0.0]).is_none());
    assert_eq!(discrete.nodes.on_side(0).len(), 32);
}

#[test]
fn clamped_disc_of_membrane_has_the_zeros_of_bessel_functions() {
    let membrane = Membrane { tension: 4.0, density: 1.0 };
    let discrete = membrane.discretise(&sector(2.0, 0.0, 2.0 * PI, 8), 4, &CLAMPED).unwrap();
    let found = frequencies(&discrete);
    assert_near(&found, &[2.404826, 3.831706, 3.831706, 5.135622, 5.135622, 5.520078], 2e-4);
}

#[test]
fn square_and_l_shaped_membranes_have_known_frequencies() {
    let membrane = Membrane { tension: 9.0, density: 0.25 };
    let found = frequencies(&membrane.discretise(&rectangle(2, 2, 1.0, 1.0), 4, &CLAMPED).unwrap());
    let sums = [2.0f64, 5.0, 5.0, 8.0, 10.0, 10.0];
    assert_near(&found, &sums.map(|sum| PI * sum.sqrt() * 6.0), 1e-3);
    let free = membrane.discretise(&rectangle(2, 2, 1.0, 1.0), 4, &FREE).unwrap();
    assert_eq!(free.rigid, 1);
    assert_near(&frequencies(&free), &[1.0f64, 1.0, 2.0, 4.0, 4.0].map(|sum| PI * sum.sqrt() * 6.0), 1e-3);

    let unit = Membrane { tension: 1.0, density: 1.0 };
    let mesh = grid(4, 4, |column, row| column < 2 || row < 2, |[x, y]| [2.0 * x, 2.0 * y]);
    let found: Vec<f64> =
        frequencies(&unit.discretise(&mesh, 4, &CLAMPED).unwrap()).iter().map(|frequency| frequency.powi(2)).collect();
    assert_near(&found, &[9.6397238, 15.197252, 19.739209], 5e-3);
}

#[test]
fn hinged_thin_square_has_the_frequencies_of_kirchhoff() {
    let plate = Plate { material: steel(), thickness: 0.001 };
    let scale = PI * PI * (rigidity(0.001) / 8.0).sqrt();
    let expected = [2.0, 5.0, 5.0, 8.0].map(|sum| sum * scale);
    let discrete = plate.discretise(&rectangle(3, 3, 1.0, 1.0), 4, &HINGED).unwrap();
    assert_eq!(discrete.rigid, 0);
    assert_near(&frequencies(&discrete), &expected, 1e-3);
    // The same plate askew, so that nodes on its sides have axes of their own.
    let askew = grid(3, 3, |_, _| true, |[x, y]| [0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y]);
    let discrete = plate.discretise(&askew, 4, &HINGED).unwrap();
    assert_near(&frequencies(&discrete), &expected, 1e-3);
}

#[test]
fn clamped_thin_square_has_known_frequencies() {
    let plate = Plate { material: steel(), thickness: 0.001 };
    let discrete = plate.discretise(&rectangle(4, 4, 1.0, 1.0), 4, &CLAMPED).unwrap();
    let scale = (rigidity(0.001) / 8.0).sqrt();
    assert_near(&frequencies(&discrete), &[35.985, 73.39, 73.39, 108.2].map(|root| root * scale), 1e-3);
}

#[test]
fn free_square_plate_has_the_frequencies_of_nafems_fv12() {
    let plate = Plate { material: steel(), thickness: 0.05 };
    let discrete = plate.discretise(&rectangle(3, 3, 10.0, 10.0), 4, &FREE).unwrap();
    assert_eq!(discrete.rigid, 3);
    let expected = [1.622, 2.360, 2.922, 4.190, 4.190, 7.356].map(|hertz| 2.0 * PI * hertz);
    assert_near(&frequencies(&discrete), &expected, 3e-3);
}

#[test]
fn hinged_thin_disc_has_the_frequencies_of_kirchhoff() {
    let plate = Plate { material: steel(), thickness: 0.002 };
    let discrete = plate.discretise(&sector(1.0, 0.0, 2.0 * PI, 10), 4, &HINGED).unwrap();
    let scale = (rigidity(0.002) / 16.0).sqrt();
    assert_near(&frequencies(&discrete), &[4.9351, 13.8982, 13.8982].map(|root| root * scale), 2e-3);
}

#[test]
fn tapered_sheet_has_the_frequencies_of_nafems_fv32() {
    let sheet = Sheet { material: steel(), thickness: 0.05, state: PlaneState::Stress };
    let mesh = grid(4, 2, |_, _| true, |[x, y]| [10.0 * x, (y - 0.5) * (5.0 - 4.0 * x)]);
    let supports = [Support::Free, Support::Free, Support::Free, Support::Clamped];
    let discrete = sheet.discretise(&mesh, 4, &supports).unwrap();
    let expected = [44.623, 130.03, 162.70, 246.05, 379.90, 391.44].map(|hertz| 2.0 * PI * hertz);
    assert_near(&frequencies(&discrete), &expected, 1e-3);
}

#[test]
fn free_sphere_of_revolution_has_the_frequencies_of_lamb() {
    // λ = μ; shear waves travel at 1 m/s.
    let material = Material::isotropic(2.5, 0.25, 1.0);
    let mesh = sector(1.0, -PI / 2.0, PI / 2.0, 4);
    for (waves, rigid) in [(0, 2), (1, 2), (2, 0)] {
        let discrete = Revolve { material, waves }.discretise(&mesh, 4, &FREE).unwrap();
        assert_eq!(discrete.rigid, rigid);
        assert_near(&frequencies(&discrete), &[2.501133, 2.6399], 1e-3);
    }
}

#[test]
fn supports_leave_the_rigid_motions_that_they_do_not_hold() {
    let mesh = rectangle(1, 1, 2.0, 1.0);
    let plate = Plate { material: steel(), thickness: 0.01 };
    let sheet = Sheet { material: steel(), thickness: 0.01, state: PlaneState::Strain };
    let hinge = [Support::Hinged, Support::Free, Support::Free, Support::Free];
    assert_eq!(plate.discretise(&mesh, 2, &hinge).unwrap().rigid, 1);
    assert_eq!(sheet.discretise(&mesh, 2, &hinge).unwrap().rigid, 0);
    assert_eq!(sheet.discretise(&mesh, 2, &FREE).unwrap().rigid, 3);
}

#[test]
fn impossible_bodies_and_meshes_are_errors() {
    let membrane = Membrane { tension: 1.0, density: 1.0 };
    let mesh = rectangle(1, 1, 1.0, 1.0);
    let error = |mesh: &Mesh, order, supports: &[Support]| membrane.discretise(mesh, order, supports).err();
    assert_eq!(error(&mesh, 5, &FREE), Some(Error::Order(5)));
    assert_eq!(error(&mesh, 4, &FREE[..2]), Some(Error::Side(2)));
    assert_eq!(error(&mesh, 1, &CLAMPED), None);
    let mut folded = mesh.clone();
    folded.triangles[2].swap(0, 1);
    assert_eq!(error(&folded, 4, &FREE), Some(Error::Folded(2)));
    let mut loose = mesh.clone();
    loose.points.push([3.0, 3.0]);
    assert_eq!(error(&loose, 4, &FREE), Some(Error::Loose(5)));
    let mut unknown = mesh.clone();
    unknown.triangles[0][0] = 9;
    assert_eq!(error(&unknown, 4, &FREE), Some(Error::Vertex(9)));
    let mut strange = mesh.clone();
    strange.edges[0].vertices = [0, 2];
    assert_eq!(Nodes::new(&strange, 2).err(), Some(Error::Edge([0, 2])));
    let slack = Membrane { tension: 0.0, density: 1.0 };
    assert!(matches!(slack.discretise(&mesh, 2, &FREE), Err(Error::Quantity { .. })));
    let limp = Plate { material: Material::isotropic(1.0, 0.5, 1.0), thickness: 1.0 };
    assert!(matches!(limp.discretise(&mesh, 2, &FREE), Err(Error::Quantity { .. })));
}
