//! Check that triangles close one body.

use std::collections::HashMap;

use super::{Point, Surface, SurfaceError};

/// Distance below which two vertices are one, as a share of the body's size.
const WELD: f64 = 1e-6;

/// Makes one vertex of all that lie within [`WELD`], and leaves out triangles that lose their area.
pub(super) fn welded(points: &[Point], triangles: &[[usize; 3]]) -> Result<Surface, SurfaceError> {
    if let Some(vertex) = points.iter().position(|point| !point.iter().all(|part| part.is_finite())) {
        return Err(SurfaceError::NotFinite(vertex));
    }
    if let Some(vertex) = triangles.iter().flatten().find(|vertex| **vertex >= points.len()) {
        return Err(SurfaceError::Vertex(*vertex));
    }
    let extent = |axis: usize| {
        let parts = || triangles.iter().flatten().map(|vertex| points[*vertex][axis]);
        parts().fold(f64::NEG_INFINITY, f64::max) - parts().fold(f64::INFINITY, f64::min)
    };
    let reach = WELD * [0, 1, 2].map(extent).into_iter().fold(0.0, f64::max);
    if !(reach > 0.0 && reach.is_finite()) {
        return Err(SurfaceError::Empty);
    }
    let mut kept: Vec<Point> = Vec::new();
    let mut boxes: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut numbers = vec![usize::MAX; points.len()];
    let mut of = |vertex: usize| {
        if numbers[vertex] == usize::MAX {
            let point = points[vertex];
            // A box is four times as wide as vertices may be apart: near ones are in it or beside.
            let place = point.map(|part| (part / (4.0 * reach)).floor() as i64);
            let near = (0..27).flat_map(|step| {
                let beside = [step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1];
                boxes.get(&[0, 1, 2].map(|axis| place[axis].wrapping_add(beside[axis]))).into_iter().flatten().copied()
            });
            let is_near = |other: &usize| (0..3).all(|axis| (kept[*other][axis] - point[axis]).abs() <= reach);
            let found = near.into_iter().find(is_near);
            numbers[vertex] = found.unwrap_or_else(|| {
                kept.push(point);
                boxes.entry(place).or_default().push(kept.len() - 1);
                kept.len() - 1
            });
        }
        numbers[vertex]
    };
    let welded: Vec<[usize; 3]> = triangles.iter().map(|triangle| triangle.map(&mut of)).collect();
    let triangles = welded.into_iter().filter(|[a, b, c]| a != b && b != c && c != a).collect();
    Ok(Surface { points: kept, triangles })
}

impl Surface {
    /// Checks that each edge has two triangles, and that they enclose one body.
    pub(super) fn check(&self) -> Result<(), SurfaceError> {
        if self.triangles.is_empty() {
            return Err(SurfaceError::Empty);
        }
        let mut edges: HashMap<[usize; 2], Vec<usize>> = HashMap::new();
        for (number, triangle) in self.triangles.iter().enumerate() {
            for corner in 0..3 {
                edges.entry([triangle[corner], triangle[(corner + 1) % 3]]).or_default().push(number);
            }
        }
        let mut bodies = Bodies::new(self.triangles.len());
        // In order of the triangles, so that a fault is named alike each time.
        for (number, triangle) in self.triangles.iter().enumerate() {
            for corner in 0..3 {
                let [from, to] = [triangle[corner], triangle[(corner + 1) % 3]];
                let ends = [from, to].map(|vertex| self.points[vertex]);
                let same = edges.get(&[from, to]).map_or(0, Vec::len);
                let other = edges.get(&[to, from]).map_or(&[][..], Vec::as_slice);
                match (same, other.len()) {
                    (1, 1) => bodies.join(number, other[0]),
                    (1, 0) => return Err(SurfaceError::Gap(ends)),
                    (_, 0) => return Err(SurfaceError::Turned(ends)),
                    _ => return Err(SurfaceError::Branched(ends)),
                }
            }
        }
        let mut volumes: HashMap<usize, f64> = HashMap::new();
        let origin = self.points[self.triangles[0][0]];
        for (number, corners) in self.corners().enumerate() {
            let [a, b, c] = corners.map(|corner| super::minus(corner, origin));
            *volumes.entry(bodies.of(number)).or_default() += super::dot(a, super::cross(b, c)) / 6.0;
        }
        // A shell of negative volume is a cavity: all shells together must enclose a volume.
        let solid = volumes.values().filter(|volume| **volume > 0.0).count();
        if solid == 0 || volumes.values().sum::<f64>() <= 0.0 {
            return Err(SurfaceError::InsideOut);
        }
        if solid > 1 { Err(SurfaceError::Pieces(solid)) } else { Ok(()) }
    }
}

/// Triangles by the shell that they belong to.
struct Bodies(Vec<usize>);

impl Bodies {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn of(&mut self, mut triangle: usize) -> usize {
        while self.0[triangle] != triangle {
            self.0[triangle] = self.0[self.0[triangle]];
            triangle = self.0[triangle];
        }
        triangle
    }

    fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.of(one), self.of(other));
        self.0[one] = other;
    }
}
