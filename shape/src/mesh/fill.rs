//! Triangulation of what closed polygons enclose.

use super::MeshError;
use crate::outline::Point;
use crate::outline::side::distance;
use spade::handles::FixedFaceHandle;
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation};
use std::collections::HashMap;

/// Smallest angle that the refinement aims at, degrees.
const ANGLE_DEG: f64 = 25.0;

/// Rounds in which edges that are too long are halved.
const ROUNDS: usize = 16;

/// Triangles that fill the polygons.
pub(super) struct Fill {
    /// Triangles, counter-clockwise.
    pub(super) triangles: Vec<[usize; 3]>,
    /// Points that were put on each edge of each polygon, in order.
    pub(super) splits: Vec<Vec<Vec<usize>>>,
}

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Fills polygons, the outer one first, with triangles whose edges are at most `size` long; points
/// that it adds follow those that stand. With `may_split` some may lie on the polygons' edges.
pub(super) fn fill(
    points: &mut Vec<Point>,
    polygons: &[Vec<usize>],
    size: f64,
    may_split: bool,
) -> Result<Fill, MeshError> {
    let (mut cdt, mut names) = constrained(points, polygons)?;
    let area: f64 = polygons.iter().map(|polygon| polygon_area(points, polygon)).sum();
    let most = 60.0 * area / (size * size) + 100.0 * names.len() as f64 + 10_000.0;
    let limit = 3f64.sqrt() / 4.0 * size * size;
    let shortest = polygons.iter().map(|polygon| shortest_edge(points, polygon)).fold(f64::INFINITY, f64::min);
    let least = (1e-9 * limit).min(0.01 * shortest * shortest);
    let parameters = RefinementParameters::<f64>::new()
        .exclude_outer_faces(true)
        .with_min_required_area(least)
        .with_max_allowed_area(limit)
        .with_max_additional_vertices(most as usize)
        .with_angle_limit(AngleLimit::from_deg(ANGLE_DEG));
    let parameters = if may_split { parameters } else { parameters.keep_constraint_edges() };
    let mut outside = vec![];
    for _ in 0..ROUNDS {
        let result = cdt.refine(parameters.clone());
        outside = vec![false; cdt.num_all_faces()];
        result.excluded_faces.iter().for_each(|face| outside[face.index()] = true);
        let middles = long_edges(&cdt, &outside, size * (1.0 + 1e-9));
        if middles.is_empty() || !result.refinement_complete {
            break;
        }
        for middle in middles {
            cdt.insert(middle).map_err(|e| MeshError::Failed { reason: e.to_string() })?;
        }
        // Halves change the faces: what lies outside is found anew by the next refinement.
        outside.clear();
    }
    if outside.is_empty() {
        let result = cdt.refine(parameters);
        outside = vec![false; cdt.num_all_faces()];
        result.excluded_faces.iter().for_each(|face| outside[face.index()] = true);
    }
    for vertex in cdt.vertices().skip(names.len()) {
        names.push(points.len());
        points.push([vertex.position().x, vertex.position().y]);
    }
    let inside = cdt.inner_faces().filter(|face| !outside[face.fix().index()]);
    let triangles: Vec<[usize; 3]> = inside.map(|face| face.vertices().map(|v| names[v.fix().index()])).collect();
    let found: f64 = triangles.iter().map(|triangle| polygon_area(points, triangle)).sum();
    if (found - area).abs() > 1e-9 * area {
        return Err(MeshError::Failed { reason: format!("the triangles cover {found} of {area} square metres") });
    }
    let splits = splits(&triangles, polygons)?;
    Ok(Fill { triangles, splits })
}

/// Makes a triangulation that keeps the polygons' edges; gives the names of its vertices, too.
fn constrained(points: &[Point], polygons: &[Vec<usize>]) -> Result<(Cdt, Vec<usize>), MeshError> {
    let failed = |reason: &str| MeshError::Failed { reason: reason.to_owned() };
    let mut cdt = Cdt::new();
    let mut names = Vec::new();
    let mut rows = Vec::new();
    for polygon in polygons {
        let mut row = Vec::with_capacity(polygon.len());
        for &name in polygon {
            // Coordinates next to zero are not accepted, zero is.
            let [x, y] = points[name].map(|c| if c.abs() < 1e-40 { 0.0 } else { c });
            let handle = cdt.insert(Point2::new(x, y)).map_err(|e| MeshError::Failed { reason: e.to_string() })?;
            if handle.index() != names.len() {
                return Err(failed("two nodes lie on one point"));
            }
            names.push(name);
            row.push(handle);
        }
        rows.push(row);
    }
    for row in &rows {
        for (k, &from) in row.iter().enumerate() {
            let to = row[(k + 1) % row.len()];
            if !cdt.can_add_constraint(from, to) {
                return Err(failed("two edges cross"));
            }
            cdt.add_constraint(from, to);
        }
    }
    Ok((cdt, names))
}

/// Lists the middles of edges that are too long, the longest first, no two of one triangle.
fn long_edges(cdt: &Cdt, outside: &[bool], size: f64) -> Vec<Point2<f64>> {
    let inner = |face: FixedFaceHandle<spade::handles::PossiblyOuterTag>| !outside[face.index()];
    let mut long = Vec::new();
    for edge in cdt.undirected_edges() {
        let [a, b] = edge.positions();
        let length = distance([a.x, a.y], [b.x, b.y]);
        let faces = [edge.as_directed().face().fix(), edge.as_directed().rev().face().fix()];
        let fits = !edge.is_constraint_edge() && faces.iter().all(|face| face.index() != 0 && inner(*face));
        if fits && length > size {
            long.push((length, Point2::new(0.5 * (a.x + b.x), 0.5 * (a.y + b.y)), faces));
        }
    }
    long.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut used = vec![false; outside.len()];
    long.retain(|(_, _, faces)| {
        let free = faces.iter().all(|face| !used[face.index()]);
        faces.iter().for_each(|face| used[face.index()] = true);
        free
    });
    long.into_iter().map(|(_, middle, _)| middle).collect()
}

/// Finds the points that were put on the polygons' edges.
fn splits(triangles: &[[usize; 3]], polygons: &[Vec<usize>]) -> Result<Vec<Vec<Vec<usize>>>, MeshError> {
    let edges = || triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let all: std::collections::HashSet<(usize, usize)> = edges().collect();
    let next: HashMap<usize, usize> = edges().filter(|&(a, b)| !all.contains(&(b, a))).collect();
    let mut rows = Vec::with_capacity(polygons.len());
    for polygon in polygons {
        let mut row = Vec::with_capacity(polygon.len());
        for (k, &from) in polygon.iter().enumerate() {
            let to = polygon[(k + 1) % polygon.len()];
            let mut between = Vec::new();
            let mut at = from;
            loop {
                match next.get(&at) {
                    Some(&then) if then == to => break,
                    Some(&then) if between.len() < next.len() => between.push(then),
                    _ => return Err(MeshError::Failed { reason: "an edge of the outline is lost".to_owned() }),
                }
                at = between[between.len() - 1];
            }
            row.push(between);
        }
        rows.push(row);
    }
    Ok(rows)
}

/// Gives the length of the shortest edge of a polygon.
fn shortest_edge(points: &[Point], polygon: &[usize]) -> f64 {
    let ends = polygon.iter().zip(polygon.iter().cycle().skip(1));
    ends.map(|(a, b)| distance(points[*a], points[*b])).fold(f64::INFINITY, f64::min)
}

/// Gives the area of a polygon, positive if it runs counter-clockwise.
pub(super) fn polygon_area(points: &[Point], polygon: &[usize]) -> f64 {
    let origin = points[polygon[0]];
    let to = |k: usize| crate::outline::side::between(origin, points[polygon[k]]);
    (2..polygon.len()).map(|k| 0.5 * crate::outline::side::cross(to(k - 1), to(k))).sum()
}
