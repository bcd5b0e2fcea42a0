//! Mesh over an outline of any form.

use super::band::{Band, apart, strip};
use super::boundary::{Chord, place_nodes, unit};
use super::fill::fill;
use super::{BoundaryEdge, Mesh, MeshError, Sizing};
use crate::outline::side::{between, cross, distance};
use crate::outline::touch::meeting;
use crate::outline::{FlatSide, Outline, Point};
use std::collections::HashMap;

/// Rounds in which nodes are put on curves.
const ROUNDS: usize = 40;

/// Rounds in which the triangles may ask for more nodes on curves; where two curves leave a corner
/// in nearly one direction they would ask for ever more.
const ASKED: usize = 5;

/// Rounds in which chords that cross are halved.
const HALVED: usize = 16;

/// Rounds in which all curves may be halved because their chords cannot be triangulated.
const HALVINGS: usize = 3;

/// Edge on the outline before its curve is known.
struct Piece {
    vertices: [usize; 2],
    chord: [usize; 2],
    span: [f64; 2],
}

/// Makes a mesh over an outline that has been checked.
pub(super) fn mesh(outline: &Outline, sides: &[FlatSide], sizing: &Sizing) -> Result<Mesh, MeshError> {
    let mut rings = place_nodes(sides, outline, sizing);
    for round in 0..=ROUNDS {
        uncross(&mut rings, sides)?;
        // A band that cannot be enclosed is left out.
        let may_split = round < ASKED || !outline.is_curved();
        let made = attempt(&rings, sizing, may_split);
        let made = made.or_else(|_| attempt(&rings, &Sizing::even(sizing.size_m), may_split));
        let (mut points, triangles, pieces) = match made {
            Err(_) if round < HALVINGS && outline.is_curved() => {
                let all = rings.iter().enumerate().flat_map(|(r, ring)| (0..ring.len()).map(move |k| [r, k]));
                let middle = |[r, k]: [usize; 2]| 0.5 * (rings[r][k].span[0] + rings[r][k].span[1]);
                let curved = all.filter(|[r, k]| sides[rings[*r][*k].side].curve.is_some());
                let nodes = curved.map(|place| (place, vec![middle(place)])).collect();
                split(&mut rings, sides, &nodes);
                continue;
            }
            other => other?,
        };
        let mut nodes: HashMap<[usize; 2], Vec<f64>> = HashMap::new();
        for piece in &pieces {
            let [r, k] = piece.chord;
            let chord = rings[r][k];
            let is_curved = sides[chord.side].curve.is_some();
            // The nodes that straight sides have got by then stay.
            let is_kept = is_curved || (outline.is_curved() && round + 1 == ASKED);
            if is_kept && piece.span[0] > chord.span[0] {
                nodes.entry(piece.chord).or_default().push(piece.span[0]);
                points[piece.vertices[0]] = sides[chord.side].point(piece.span[0]);
            }
        }
        if nodes.is_empty() || round == ROUNDS {
            let edge = |piece: &Piece| {
                let side = rings[piece.chord[0]][piece.chord[1]].side;
                let curve = sides[side].curve.and_then(|_| sides[side].part(piece.span[0], piece.span[1]).curve);
                BoundaryEdge { vertices: piece.vertices, side, curve }
            };
            let mesh = Mesh { points, triangles, edges: pieces.iter().map(edge).collect() };
            let misfits = misfits(&mesh);
            if misfits.is_empty() {
                return Ok(compact(mesh));
            }
            if let Some(&Piece { vertices: [first, _], .. }) = misfits.first().map(|k| &pieces[*k])
                && round == ROUNDS
            {
                return Err(MeshError::Curve { at: mesh.points[first] });
            }
            for piece in misfits.iter().map(|k| &pieces[*k]) {
                nodes.entry(piece.chord).or_default().push(0.5 * (piece.span[0] + piece.span[1]));
            }
        }
        split(&mut rings, sides, &nodes);
    }
    Err(MeshError::Failed { reason: "the curves found no nodes".to_owned() })
}

/// Parts the chords of curves at the parameters that are given for them.
fn split(rings: &mut [Vec<Chord>], sides: &[FlatSide], nodes: &HashMap<[usize; 2], Vec<f64>>) {
    for (r, ring) in rings.iter_mut().enumerate() {
        *ring = (0..ring.len())
            .flat_map(|k| halves(&ring[k], sides, nodes.get(&[r, k]).map_or(&[], Vec::as_slice)))
            .collect();
    }
}

/// Halves the curves' chords that cross another chord although the sides do not. Sides that cross
/// by less than the check of outlines sees, in the tip of a corner, keep an error.
fn uncross(rings: &mut [Vec<Chord>], sides: &[FlatSide]) -> Result<(), MeshError> {
    for _ in 0..HALVED {
        let nodes = crossed(rings, sides);
        if nodes.is_empty() {
            return Ok(());
        }
        split(rings, sides, &nodes);
    }
    match crossed(rings, sides).keys().min() {
        Some(&[r, k]) => Err(MeshError::Curve { at: rings[r][k].from }),
        None => Ok(()),
    }
}

/// Finds the middles of the curves' chords that cross another chord.
fn crossed(rings: &[Vec<Chord>], sides: &[FlatSide]) -> HashMap<[usize; 2], Vec<f64>> {
    let mut edges = Vec::new();
    for (r, ring) in rings.iter().enumerate() {
        for (k, chord) in ring.iter().enumerate() {
            edges.push(([r, k], [chord.from, ring[(k + 1) % ring.len()].from], chord));
        }
    }
    let left = |ends: &[Point; 2]| ends[0][0].min(ends[1][0]);
    edges.sort_by(|a, b| left(&a.1).total_cmp(&left(&b.1)));
    let curved = |chord: &Chord| sides[chord.side].curve.is_some();
    let mut nodes = HashMap::new();
    for (first, &(place, ends, chord)) in edges.iter().enumerate() {
        let right = ends[0][0].max(ends[1][0]);
        for &(other, far, near) in edges[first + 1..].iter().take_while(|edge| left(&edge.1) <= right) {
            let joined = ends[1] == far[0] || far[1] == ends[0];
            if joined || !(curved(chord) || curved(near)) || apart(ends, far) || meeting(ends, far, 0.0).is_none() {
                continue;
            }
            for (place, chord) in [(place, chord), (other, near)] {
                if curved(chord) {
                    nodes.insert(place, vec![0.5 * (chord.span[0] + chord.span[1])]);
                }
            }
        }
    }
    nodes
}

/// Parts a chord at parameters in rising order.
fn halves(chord: &Chord, sides: &[FlatSide], at: &[f64]) -> Vec<Chord> {
    let mut bounds = vec![chord.span[0]];
    bounds.extend(at);
    bounds.push(chord.span[1]);
    let part = |(k, span): (usize, &[f64])| Chord {
        from: if k == 0 { chord.from } else { sides[chord.side].point(span[0]) },
        span: [span[0], span[1]],
        ..*chord
    };
    bounds.windows(2).enumerate().map(part).collect()
}

type Attempt = (Vec<Point>, Vec<[usize; 3]>, Vec<Piece>);

/// Makes the band and what it encloses, over straight chords, which stay whole unless `may_split`
/// is true.
fn attempt(rings: &[Vec<Chord>], sizing: &Sizing, may_split: bool) -> Result<Attempt, MeshError> {
    let mut points = Vec::new();
    let mut names = Vec::with_capacity(rings.len());
    for ring in rings {
        names.push((points.len()..points.len() + ring.len()).collect::<Vec<usize>>());
        points.extend(ring.iter().map(|chord| chord.from));
    }
    let band = Band::plan(rings, sizing.layer_m);
    let inner = band.inner_rings(&mut points, &names);
    let polygons: Vec<Vec<usize>> = inner.iter().map(|ring| ring.polygon.clone()).collect();
    let filled = fill(&mut points, &polygons, sizing.size_m, may_split)?;
    let mut triangles = filled.triangles;
    let mut pieces = Vec::new();
    for (r, ring) in rings.iter().enumerate() {
        let edge_of: HashMap<usize, usize> = inner[r].chords.iter().enumerate().map(|(edge, k)| (*k, edge)).collect();
        for (k, chord) in ring.iter().enumerate() {
            let [a, b] = [names[r][k], names[r][(k + 1) % ring.len()]];
            let mut line = Vec::new();
            if let Some(&edge) = edge_of.get(&k) {
                let polygon = &inner[r].polygon;
                line.push(polygon[edge]);
                line.extend(&filled.splits[r][edge]);
                line.push(polygon[(edge + 1) % polygon.len()]);
            }
            if band.has(r, k) || line.is_empty() {
                if band.has(r, k) {
                    strip(a, b, &line, &mut triangles);
                }
                line = vec![a, b];
            }
            let length = distance(points[a], points[b]);
            let share = |name: usize| match name {
                name if name == a => chord.span[0],
                name if name == b => chord.span[1],
                name => chord.span[0] + (chord.span[1] - chord.span[0]) * distance(points[a], points[name]) / length,
            };
            let piece = |ends: &[usize]| Piece {
                vertices: [ends[0], ends[1]],
                chord: [r, k],
                span: [share(ends[0]), share(ends[1])],
            };
            pieces.extend(line.windows(2).map(piece));
        }
    }
    Ok((points, triangles, pieces))
}

/// Lists the edges on the outline whose curve bends too far into their triangle.
pub(super) fn misfits(mesh: &Mesh) -> Vec<usize> {
    let directed = |t: &[usize; 3]| [([t[0], t[1]], t[2]), ([t[1], t[2]], t[0]), ([t[2], t[0]], t[1])];
    let apexes: HashMap<[usize; 2], usize> = mesh.triangles.iter().flat_map(directed).collect();
    let misfit = |edge: &BoundaryEdge| {
        let Some(apex) = apexes.get(&edge.vertices).map(|apex| mesh.points[*apex]) else { return true };
        let [from, to] = edge.vertices.map(|vertex| mesh.points[vertex]);
        let side = FlatSide { ring: 0, from, to, curve: edge.curve };
        let height = cross(unit(between(from, to)), between(from, apex));
        edge.curve.is_some()
            && [0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99].into_iter().any(|t| {
                let distance = cross(unit(side.derivative(t)), between(side.point(t), apex));
                distance.is_nan() || distance <= 0.1 * height
            })
    };
    (0..mesh.edges.len()).filter(|k| misfit(&mesh.edges[*k])).collect()
}

/// Leaves out the points that no triangle uses.
fn compact(mesh: Mesh) -> Mesh {
    let mut used = vec![false; mesh.points.len()];
    mesh.triangles.iter().flatten().for_each(|vertex| used[*vertex] = true);
    let mut count = 0;
    let names: Vec<usize> = used
        .iter()
        .map(|used| {
            count += usize::from(*used);
            count.saturating_sub(1)
        })
        .collect();
    let points = mesh.points.iter().zip(&used).filter(|(_, used)| **used).map(|(point, _)| *point).collect();
    let triangles = mesh.triangles.iter().map(|triangle| triangle.map(|vertex| names[vertex])).collect();
    let rename = |edge: &BoundaryEdge| BoundaryEdge { vertices: edge.vertices.map(|vertex| names[vertex]), ..*edge };
    Mesh { points, triangles, edges: mesh.edges.iter().map(rename).collect() }
}
