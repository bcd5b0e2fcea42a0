//! Clip paths and masks of a drawing, which are named where they cut a shape: they are not applied.

use usvg::tiny_skia_path::{Path, PathSegment, Point, Rect, Transform};
use usvg::{ClipPath, Group, Node};

/// Share of a clip path's size by which a shape may reach over it: drawings are read in 32 bit.
const OVER: f32 = 1e-5;

/// Part of a drawing that cuts shapes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cut {
    /// Attribute of SVG.
    pub(super) attribute: &'static str,
    /// Name of the clip path or mask in the drawing.
    pub(super) id: String,
}

/// Gives the mask or clip path that may cut the shapes of a group. An upright rectangle around all
/// of them, as programs write it for a page, cuts nothing.
pub(super) fn of(group: &Group) -> Option<Cut> {
    if let Some(mask) = group.mask() {
        return Some(Cut { attribute: "mask", id: mask.id().to_owned() });
    }
    let clip = group.clip_path().filter(|clip| !is_around(clip, group))?;
    Some(Cut { attribute: "clip-path", id: clip.id().to_owned() })
}

/// Tells whether a clip path is an upright rectangle around all shapes of a group.
fn is_around(clip: &ClipPath, group: &Group) -> bool {
    let [Node::Path(path)] = clip.root().children() else { return false };
    let within = group.abs_transform().pre_concat(clip.transform()).pre_concat(path.abs_transform());
    let Some(page) = rectangle(path.data(), within).filter(|_| clip.clip_path().is_none()) else { return false };
    let (shapes, over) = (group.abs_bounding_box(), OVER * page.width().max(page.height()));
    page.left() <= shapes.left() + over
        && page.top() <= shapes.top() + over
        && page.right() >= shapes.right() - over
        && page.bottom() >= shapes.bottom() - over
}

/// Gives the upright rectangle that a path is, with its transform applied.
fn rectangle(path: &Path, transform: Transform) -> Option<Rect> {
    let path = path.clone().transform(transform)?;
    let (bounds, points) = (path.bounds(), path.points());
    let is_straight = path
        .segments()
        .all(|segment| matches!(segment, PathSegment::MoveTo(_) | PathSegment::LineTo(_) | PathSegment::Close));
    let corners = [bounds.left(), bounds.right()].map(|x| [bounds.top(), bounds.bottom()].map(|y| Point { x, y }));
    let corners = corners.as_flattened();
    let is_level = points.windows(2).all(|pair| pair[0].x == pair[1].x || pair[0].y == pair[1].y);
    let visits_all = corners.iter().all(|corner| points.contains(corner));
    (is_straight && is_level && visits_all && points.iter().all(|point| corners.contains(point))).then_some(bounds)
}
