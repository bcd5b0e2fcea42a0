//! Supports by side, in the order of the outline's sides.

use crate::file::{Edge, ShapeFile};
use crate::outline::{Outline, Side};

/// Lists the supports of a file by the sides of the outline. Rings that the file's corners run the
/// wrong way round were turned, so that their sides come in the opposite order.
pub(super) fn by_side(file: &ShapeFile, outline: &Outline, edges: &[Edge]) -> Vec<Edge> {
    let outer = file.corners_m().filter(|_| file.shape.outline.is_none());
    let holes = file.shape.holes_m.iter().map(Vec::as_slice);
    let corners: Vec<&[[f64; 2]]> = outer.map_or_else(Vec::new, |outer| std::iter::once(outer).chain(holes).collect());
    let mut rest = edges;
    let mut ordered = Vec::with_capacity(edges.len());
    for (number, ring) in outline.rings.iter().enumerate() {
        let (of_ring, others) = rest.split_at(ring.len().min(rest.len()));
        rest = others;
        let is_turned = corners.get(number).is_some_and(|corners| (area(corners) > 0.0) != (number == 0));
        if is_turned { ordered.extend(of_ring.iter().rev()) } else { ordered.extend(of_ring) }
    }
    ordered
}

/// Area within corners, positive if they run counter-clockwise.
fn area(corners: &[[f64; 2]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

/// Lists how many straight and curved sides follow each other, ring by ring: drawn arcs have
/// several.
pub(super) fn listed(outline: &Outline) -> String {
    let of_ring = |ring: &Vec<Side>| {
        let runs = ring.chunk_by(|a, b| a.curve.is_some() == b.curve.is_some());
        let run = |run: &[Side]| {
            let kind = if run.iter().any(|side| side.curve.is_some()) { "curved" } else { "straight" };
            format!("{} {kind}", run.len())
        };
        runs.map(run).collect::<Vec<_>>().join(", ")
    };
    outline.rings.iter().map(of_ring).collect::<Vec<_>>().join("; then a hole of ")
}
