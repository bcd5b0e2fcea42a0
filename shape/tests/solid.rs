//! Solids by finite cells.

use std::f64::consts::TAU;

use shape::eigen::{self, Wanted};
use shape::solid::{Grid, Solid};
use shape::surface::{Point, Surface};

fn cuboid(extents: [f64; 3]) -> (Vec<Point>, Vec<[usize; 3]>) {
    let points = (0..8).map(|corner| [0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { extents[axis] } else { 0.0 }));
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    (points.collect(), triangles)
}

fn turned(points: &[Point], angles: Point) -> Vec<Point> {
    points
        .iter()
        .map(|point| {
            let mut at = *point;
            for axis in 0..3 {
                let (sine, cosine) = angles[axis].sin_cos();
                let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
                (at[a], at[b]) = (cosine * at[a] - sine * at[b], sine * at[a] + cosine * at[b]);
            }
            at
        })
        .collect()
}

fn ball(radius: f64, steps: usize) -> (Vec<Point>, Vec<[usize; 3]>) {
    let (mut points, mut triangles) = (vec![], vec![]);
    // A cube's faces, blown up.
    let (cube, _) = cuboid([2.0; 3]);
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    for [a, b, _, d] in faces.map(|face| face.map(|corner: usize| cube[corner].map(|part| part - 1.0))) {
        let first = points.len();
        for row in 0..=steps {
            for column in 0..=steps {
                let [u, v] = [row, column].map(|step| {
                    (std::f64::consts::FRAC_PI_4 * (2.0 * step as f64 / steps as f64 - 1.0)).tan() / 2.0 + 0.5
                });
                let at = [0, 1, 2].map(|axis| a[axis] + u * (b[axis] - a[axis]) + v * (d[axis] - a[axis]));
                let length = at.iter().map(|part| part * part).sum::<f64>().sqrt();
                points.push(at.map(|part| radius * part / length));
            }
        }
        for row in 0..steps {
            for column in 0..steps {
                let corner = first + row * (steps + 1) + column;
                let across = corner + steps + 1;
                triangles.push([corner, across, across + 1]);
                triangles.push([corner, across + 1, corner + 1]);
            }
        }
    }
    (points, triangles)
}

fn run(name: &str, surface: &Surface, size: f64) {
    let solid = Solid { young: 200e9, poisson: 0.3, density: 8000.0 };
    let clock = std::time::Instant::now();
    let grid = Grid::over(surface, size);
    let cells = solid.discretise(surface, &grid).unwrap();
    let built = clock.elapsed().as_secs_f64();
    let modes = eigen::modes(&cells.problem, Wanted::Lowest(26), &mut |_, _| ()).unwrap();
    let hz: Vec<f64> = modes.values[6..].iter().map(|value| value.sqrt() / TAU).collect();
    println!(
        "{name}: {:?} cells {} unknowns {} nnz {} mass {} rigid {:.1e} counted {} build {built:.2} s, all {:.2} s",
        grid.counts,
        cells.len(),
        cells.problem.size,
        cells.problem.rows.len(),
        cells.mass_kg,
        modes.values[5],
        modes.counted,
        clock.elapsed().as_secs_f64()
    );
    println!("{hz:.2?}");
}

#[test]
fn try_out() {
    let (points, triangles) = cuboid([0.2, 0.03, 0.008]);
    let surface = Surface::new(&points, &triangles).unwrap();
    run("bar", &surface, 0.015);
    let surface = Surface::new(&turned(&points, [0.3, 0.5, 0.7]), &triangles).unwrap();
    run("turned bar", &surface, 0.015);
    let (points, triangles) = cuboid([0.1, 0.09, 0.08]);
    for (name, angles) in [("box", [0.0; 3]), ("turned box", [0.3, 0.5, 0.7])] {
        let surface = Surface::new(&turned(&points, angles), &triangles).unwrap();
        run(name, &surface, 0.025);
    }
    let (points, triangles) = ball(0.1, 40);
    let surface = Surface::new(&points, &triangles).unwrap();
    for cells in [3.0, 4.0, 5.0] {
        run("ball", &surface, 0.2 / cells);
    }
    println!(
        "expected {:.2} and mass {}",
        2.501_133 * (200e9_f64 / 2.6 / 8000.0).sqrt() / 0.1 / TAU,
        8000.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-3
    );
}
