//! White parts of a drawing: its ground, and holes that are drawn over the body.

use super::svg::Ring;
use super::{Outline, Point, Side, ring_area};
use usvg::{Paint, Path};

/// Least value of each colour of white.
const WHITE: u8 = 250;

/// Tells whether a path is drawn at all.
pub(super) fn is_drawn(path: &Path) -> bool {
    let is_filled = path.fill().is_some_and(|fill| fill.opacity().get() > 0.0);
    path.is_visible() && (is_filled || has_stroke(path))
}

/// Tells whether a path is filled white, and has no stroke that shows it on white.
pub(super) fn is_white(path: &Path) -> bool {
    let is_white = |paint: &Paint| match paint {
        Paint::Color(colour) => [colour.red, colour.green, colour.blue].iter().all(|part| *part >= WHITE),
        _ => false,
    };
    let has_colour = has_stroke(path) && path.stroke().is_some_and(|stroke| !is_white(stroke.paint()));
    path.fill().is_none_or(|fill| is_white(fill.paint())) && !has_colour
}

fn has_stroke(path: &Path) -> bool {
    path.stroke().is_some_and(|stroke| stroke.opacity().get() > 0.0)
}

/// Leaves out the white rings that are no holes: those larger than the body, and those apart from
/// it. If all rings are white they are the shapes.
pub(super) fn without(rings: Vec<Ring>) -> Vec<Ring> {
    let size = |ring: &Ring| ring_area(&ring.sides).abs();
    let coloured = rings.iter().filter(|ring| !ring.is_white);
    let Some(body) = coloured.max_by(|a, b| size(a).total_cmp(&size(b))) else { return rings };
    let (most, around) = (size(body), bounds(&body.sides));
    let is_apart = |ring: &Ring| {
        let ([low, high], [least, last]) = (bounds(&ring.sides), around);
        (0..2).any(|axis| high[axis] < least[axis] || low[axis] > last[axis])
    };
    rings.into_iter().filter(|ring| !(ring.is_white && (size(ring) >= most || is_apart(ring)))).collect()
}

/// Lowest and highest coordinates of a ring.
fn bounds(ring: &[Side]) -> [Point; 2] {
    Outline { rings: vec![ring.to_vec()] }.bounds().unwrap_or_default()
}
