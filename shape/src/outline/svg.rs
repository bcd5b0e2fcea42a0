//! Outlines from SVG drawings.

use super::arc::with_round_arcs;
use super::cut::{self, Cut};
use super::side::distance;
use super::{Outline, OutlineError, Point, Side, fill_rule, ground, ring_area};
use usvg::FillRule;
use usvg::roxmltree::{Document, Node, ParsingOptions};
use usvg::tiny_skia_path::{Path, PathSegment};

/// Share of the drawing's size below which two points are one: drawings are read in 32 bit.
const SAME: f64 = 1e-6;

/// Path that is visible, with its transforms applied.
struct Drawn {
    data: Path,
    is_white: bool,
    /// Rule by which the path is filled; `None` if only its stroke is drawn.
    rule: Option<FillRule>,
    /// Clip path or mask that cuts the path.
    cut: Option<Cut>,
}

/// Ring of a drawn path.
pub(super) struct Ring {
    pub(super) sides: Vec<Side>,
    pub(super) is_white: bool,
    cut: Option<Cut>,
}

/// Subpath: where each side begins and bends, and where the last one ends.
struct Subpath {
    sides: Vec<Side>,
    end: Point,
    closed: bool,
}

impl Outline {
    /// Makes the outline of a drawing in SVG: the shapes that are visible, with all transforms. The
    /// largest ring is the outer one, those inside it are holes. Within a path its `fill-rule`
    /// tells which rings are borders. White shapes without a stroke are the ground unless all are
    /// white: they can be holes, and are left out elsewhere. The drawing's y axis points down, the
    /// body's one up. A unit is `unit_m` metres long; it is that of the drawing's `viewBox`, or a
    /// pixel if it has none.
    ///
    /// # Errors
    /// Says what cannot be read, which path is open, which clip path or mask cuts a shape, or what
    /// [`Outline::check`] finds.
    pub fn from_svg(text: &str, unit_m: f64) -> Result<Outline, OutlineError> {
        if !(unit_m > 0.0 && unit_m.is_finite()) {
            return Err(OutlineError::BadUnit { unit_m });
        }
        let unreadable = |reason: String| OutlineError::Svg { reason };
        let tree = usvg::Tree::from_str(text, &usvg::Options::default()).map_err(|e| unreadable(e.to_string()))?;
        let options = ParsingOptions { allow_dtd: true, ..Default::default() };
        let document = Document::parse_with_options(text, options);
        let document = document.map_err(|error| unreadable(error.to_string()))?;
        let (pixels, has_arcs) = (pixels_per_unit(&document, tree.size()), document.descendants().any(has_arcs));
        let mut paths = Vec::new();
        collect(tree.root(), None, &mut paths);
        let scale = unit_m / pixels;
        let extent = f64::from(tree.size().width().max(tree.size().height())) * scale;
        let mut rings = Vec::new();
        let mut count = 0;
        for Drawn { data, is_white, rule, cut } in paths {
            let mut closed = Vec::new();
            for subpath in subpaths(&data, scale) {
                closed.push(with_round_arcs(&close(subpath, count, SAME * extent)?, has_arcs));
                count += 1;
            }
            let borders = fill_rule::borders(closed, rule)?;
            rings.extend(borders.into_iter().map(|sides| Ring { sides, is_white, cut: cut.clone() }));
        }
        let rings = ground::without(rings);
        if let Some((Cut { attribute, id }, ring)) = rings.iter().find_map(|ring| ring.cut.clone().zip(Some(ring))) {
            let at = ring.sides.first().map_or([0.0; 2], |side| side.from);
            return Err(OutlineError::Cut { attribute, id, at });
        }
        let mut rings: Vec<Vec<Side>> = rings.into_iter().map(|ring| ring.sides).collect();
        let largest = |a: &usize, b: &usize| ring_area(&rings[*a]).abs().total_cmp(&ring_area(&rings[*b]).abs());
        let Some(outer) = (0..rings.len()).rev().max_by(largest) else { return Err(OutlineError::NoPath) };
        rings.swap(0, outer);
        match Outline::oriented(rings) {
            Err(OutlineError::HoleOutside { at, .. }) => Err(OutlineError::TwoPieces { at }),
            other => other,
        }
    }
}

/// Gives the pixels per unit of the `viewBox`.
fn pixels_per_unit(document: &Document<'_>, size: usvg::Size) -> f64 {
    let root = document.root_element();
    let Some(view) = root.attribute("viewBox") else { return 1.0 };
    let numbers: Vec<f64> =
        view.split([' ', ',', '\t', '\n', '\r']).filter(|word| !word.is_empty()).flat_map(str::parse).collect();
    let [_, _, width, height] = numbers[..] else { return 1.0 };
    let (across, up) = (f64::from(size.width()) / width, f64::from(size.height()) / height);
    if !(across.is_finite() && up.is_finite() && across > 0.0 && up > 0.0) {
        return 1.0;
    }
    let slice = root.attribute("preserveAspectRatio").is_some_and(|value| value.contains("slice"));
    if slice { across.max(up) } else { across.min(up) }
}

/// Tells whether a shape of the drawing has arcs of circles or ellipses.
fn has_arcs(node: Node<'_, '_>) -> bool {
    match node.tag_name().name() {
        "circle" | "ellipse" => true,
        "rect" => ["rx", "ry"].iter().any(|name| node.has_attribute(*name)),
        "path" => node.attribute("d").is_some_and(|data| data.contains(['a', 'A'])),
        _ => false,
    }
}

/// Collects the paths that are visible. `cut` is what cuts the shapes of all groups around a group.
fn collect(group: &usvg::Group, cut: Option<Cut>, paths: &mut Vec<Drawn>) {
    if group.opacity().get() == 0.0 {
        return;
    }
    let cut = cut.or_else(|| cut::of(group));
    for node in group.children() {
        match node {
            usvg::Node::Group(group) => collect(group, cut.clone(), paths),
            usvg::Node::Path(path) if ground::is_drawn(path) => {
                let Some(data) = path.data().clone().transform(path.abs_transform()) else { continue };
                let (is_white, rule) = (ground::is_white(path), fill_rule::of(path));
                paths.push(Drawn { data, is_white, rule, cut: cut.clone() });
            }
            _ => {}
        }
    }
}

/// Parts a path into its subpaths, metres.
fn subpaths(path: &Path, scale: f64) -> Vec<Subpath> {
    let metres = |p: usvg::tiny_skia_path::Point| [f64::from(p.x) * scale, -f64::from(p.y) * scale];
    let mut parts: Vec<Subpath> = Vec::new();
    for segment in path.segments() {
        if let PathSegment::MoveTo(to) = segment {
            parts.push(Subpath { sides: Vec::new(), end: metres(to), closed: false });
            continue;
        }
        let Some(part) = parts.last_mut() else { continue };
        let from = part.end;
        let (curve, to) = match segment {
            PathSegment::MoveTo(to) | PathSegment::LineTo(to) => (None, metres(to)),
            PathSegment::QuadTo(middle, to) => {
                let (middle, to) = (metres(middle), metres(to));
                let third = |end: Point| [0, 1].map(|axis| end[axis] + 2.0 / 3.0 * (middle[axis] - end[axis]));
                (Some([third(from), third(to)]), to)
            }
            PathSegment::CubicTo(first, second, to) => (Some([metres(first), metres(second)]), metres(to)),
            PathSegment::Close => {
                part.closed = true;
                continue;
            }
        };
        part.sides.push(Side { from, curve });
        part.end = to;
    }
    parts.retain(|part| !part.sides.is_empty());
    parts
}

/// Makes a ring of a subpath: joins its end to its begin, and drops sides without length.
fn close(part: Subpath, path: usize, same: f64) -> Result<Vec<Side>, OutlineError> {
    let Subpath { mut sides, end, closed } = part;
    let begin = sides[0].from;
    let apart = distance(begin, end) > same;
    if apart && !closed {
        return Err(OutlineError::OpenPath { path, begin, end });
    }
    if apart {
        sides.push(Side { from: end, curve: None });
    }
    let count = sides.len();
    let starts: Vec<Point> = sides.iter().map(|side| side.from).collect();
    let long = |k: usize, side: &Side| {
        let to = starts[(k + 1) % count];
        distance(side.from, to) > same
            || side.curve.is_some_and(|controls| controls.iter().any(|c| distance(side.from, *c) > same))
    };
    Ok(sides.iter().enumerate().filter(|(k, side)| long(*k, side)).map(|(_, side)| *side).collect())
}
