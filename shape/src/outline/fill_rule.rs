//! Fill rule of an SVG path: the rings at which what is filled ends.

use super::{Outline, OutlineError, Side, ring_area, ring_contains};
use usvg::{FillRule, Path};

/// Gives the rule by which a path is filled; `None` for a path of which only the stroke is drawn.
pub(super) fn of(path: &Path) -> Option<FillRule> {
    path.fill().filter(|fill| fill.opacity().get() > 0.0).map(|fill| fill.rule())
}

/// Gives the rings of one path that are borders of what is filled. By `nonzero` a ring that has
/// filled parts on both sides is dropped: one inside another that runs in one direction with it.
/// By `evenodd`, and where only lines are drawn, each ring is a border.
///
/// # Errors
/// Names rings that cross or touch, if one would be dropped: a part of it may be a border.
pub(super) fn borders(rings: Vec<Vec<Side>>, rule: Option<FillRule>) -> Result<Vec<Vec<Side>>, OutlineError> {
    if rule != Some(FillRule::NonZero) {
        return Ok(rings);
    }
    let is_border: Vec<bool> = (0..rings.len()).map(|ring| is_border(&rings, ring)).collect();
    if !is_border.contains(&false) {
        return Ok(rings);
    }
    let all = Outline { rings };
    all.check_apart()?;
    Ok(all.rings.into_iter().zip(is_border).filter(|(_, is_border)| *is_border).map(|(ring, _)| ring).collect())
}

/// Tells whether exactly one side of a ring is filled by `nonzero`.
fn is_border(rings: &[Vec<Side>], ring: usize) -> bool {
    let Some(begin) = rings[ring].first() else { return true };
    let turns = |ring: &[Side]| if ring_area(ring) > 0.0 { 1 } else { -1 };
    let around = rings.iter().enumerate().filter(|(other, sides)| *other != ring && ring_contains(sides, begin.from));
    let outside: i32 = around.map(|(_, sides)| turns(sides)).sum();
    (outside != 0) != (outside + turns(&rings[ring]) != 0)
}
