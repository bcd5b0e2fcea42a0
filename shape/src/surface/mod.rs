//! Surface of a solid: triangles that close a body, in metres.

mod check;
mod error;
mod extrude;
mod fault;
mod nearest;
mod read;

pub use error::SurfaceError;
pub use extrude::ExtrudeError;
pub use nearest::Foot;

/// Point in space, metres.
pub type Point = [f64; 3];

/// Closed surface of one body, whose triangles run counter-clockwise seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Vertices, metres.
    points: Vec<Point>,
    /// Vertices of each triangle.
    triangles: Vec<[usize; 3]>,
}

impl Surface {
    /// Makes the surface of triangles, metres: vertices within a millionth of the body's size
    /// become one.
    ///
    /// # Errors
    /// Says where the surface is open, turned, in two pieces or inside out.
    pub fn new(points: &[Point], triangles: &[[usize; 3]]) -> Result<Self, SurfaceError> {
        let surface = check::welded(points, triangles)?;
        surface.check()?;
        Ok(surface)
    }

    /// Gives the surface with another coordinate for each one of its vertices.
    pub(crate) fn with_coordinates(&self, change: impl Fn(f64) -> f64) -> Self {
        let points = self.points.iter().map(|point| point.map(&change)).collect();
        Self { points, triangles: self.triangles.clone() }
    }

    /// Gives the vertices, metres.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Gives the vertices of each triangle, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[usize; 3]] {
        &self.triangles
    }

    /// Gives the corners of each triangle, metres.
    pub fn corners(&self) -> impl Iterator<Item = [Point; 3]> + '_ {
        self.triangles.iter().map(|triangle| triangle.map(|vertex| self.points[vertex]))
    }

    /// Gives the lowest and the highest coordinate along each axis, metres.
    pub fn bounds(&self) -> [Point; 2] {
        let [low, high] = [f64::INFINITY, f64::NEG_INFINITY].map(|value| [value; 3]);
        self.points.iter().fold([low, high], |[low, high], point| {
            [[0, 1, 2].map(|axis| low[axis].min(point[axis])), [0, 1, 2].map(|axis| high[axis].max(point[axis]))]
        })
    }

    /// Gives the volume, m³.
    pub fn volume_m3(&self) -> f64 {
        let origin = self.points.first().copied().unwrap_or_default();
        let tetrahedron = |corners: [Point; 3]| {
            let [a, b, c] = corners.map(|corner| minus(corner, origin));
            dot(a, cross(b, c)) / 6.0
        };
        self.corners().map(tetrahedron).sum()
    }

    /// Gives the centre of mass, metres, and the second moments ∫ (x - x̄)(y - ȳ) dV, m⁵.
    pub fn second_moments(&self) -> (Point, [[f64; 3]; 3]) {
        let origin = self.points.first().copied().unwrap_or_default();
        let (mut volume, mut first, mut second) = (0.0, [0.0; 3], [[0.0; 3]; 3]);
        for corners in self.corners() {
            let corners = corners.map(|corner| minus(corner, origin));
            let [a, b, c] = corners;
            let tetrahedron = dot(a, cross(b, c)) / 6.0;
            volume += tetrahedron;
            let sum = [0, 1, 2].map(|axis| a[axis] + b[axis] + c[axis]);
            for row in 0..3 {
                first[row] += tetrahedron * sum[row] / 4.0;
                for (column, entry) in second[row].iter_mut().enumerate() {
                    let squares: f64 = corners.iter().map(|corner| corner[row] * corner[column]).sum();
                    *entry += tetrahedron * (sum[row] * sum[column] + squares) / 20.0;
                }
            }
        }
        let centre = first.map(|moment| moment / volume);
        for (row, line) in second.iter_mut().enumerate() {
            line.iter_mut().zip(centre).for_each(|(entry, other)| *entry -= volume * centre[row] * other);
        }
        ([0, 1, 2].map(|axis| origin[axis] + centre[axis]), second)
    }
}

pub(crate) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Unit vector of a direction; the zero vector stays.
pub(crate) fn unit(vector: Point) -> Point {
    let length = dot(vector, vector).sqrt();
    if length > 0.0 { vector.map(|part| part / length) } else { vector }
}
