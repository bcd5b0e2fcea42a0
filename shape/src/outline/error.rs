//! What can be wrong with an outline.

use kit::counting::counted;

use super::Point;

/// Reason why an outline cannot be a body. Rings and sides are counted from 0, the outer ring is 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OutlineError {
    /// An outline without rings.
    #[error("the outline has no ring: give at least 3 points of the outer ring")]
    Empty,
    /// A ring of too few points to enclose anything.
    #[error("ring {ring} has {}: give at least 3", counted(*points, "different points"))]
    TooFewPoints {
        /// Ring.
        ring: usize,
        /// Count of different points.
        points: usize,
    },
    /// A ring without area.
    #[error("ring {ring} encloses no area near ({:.6}, {:.6}) m: move its points off one line", at[0], at[1])]
    NoArea {
        /// Ring.
        ring: usize,
        /// First point of the ring, metres.
        at: Point,
    },
    /// A coordinate that is not a finite number.
    #[error("side {side} of ring {ring} begins or bends at ({}, {}) m: give finite numbers", at[0], at[1])]
    NotFinite {
        /// Ring.
        ring: usize,
        /// Side of the ring.
        side: usize,
        /// Point, metres.
        at: Point,
    },
    /// A side without length.
    #[error("side {side} of ring {ring} at ({:.6}, {:.6}) m has no length: remove the repeated point", at[0], at[1])]
    NoLength {
        /// Ring.
        ring: usize,
        /// Side of the ring.
        side: usize,
        /// Point, metres.
        at: Point,
    },
    /// A ring that runs the wrong way round.
    #[error("ring {ring} runs the wrong way: the outer ring runs counter-clockwise, holes clockwise; turn it round")]
    WrongWay {
        /// Ring.
        ring: usize,
    },
    /// Two sides of a ring that cross or touch.
    #[error("{} near ({:.6}, {:.6}) m: draw the outline so that it meets itself nowhere", meeting(*ring, *side, *other), at[0], at[1])]
    Crosses {
        /// Ring.
        ring: usize,
        /// First side of the ring.
        side: usize,
        /// Second side of the ring.
        other: usize,
        /// Place, metres.
        at: Point,
    },
    /// A hole outside the outer ring.
    #[error("ring {ring} at ({:.6}, {:.6}) m is no hole of the body: move it inside the outer ring", at[0], at[1])]
    HoleOutside {
        /// Ring.
        ring: usize,
        /// First point of the ring, metres.
        at: Point,
    },
    /// A hole that touches or crosses another ring.
    #[error(
        "side {side} of ring {ring} touches side {other_side} of ring {other} near ({:.6}, {:.6}) m: \
         leave material between them, or join them to one ring", at[0], at[1]
    )]
    HoleTouches {
        /// Ring of the hole.
        ring: usize,
        /// Side of that ring.
        side: usize,
        /// Other ring.
        other: usize,
        /// Side of the other ring.
        other_side: usize,
        /// Place, metres.
        at: Point,
    },
    /// A hole inside another hole.
    #[error("hole {ring} at ({:.6}, {:.6}) m lies inside hole {other}: remove one of them", at[0], at[1])]
    HoleInHole {
        /// Inner ring.
        ring: usize,
        /// Ring around it.
        other: usize,
        /// First point of the inner ring, metres.
        at: Point,
    },
    /// A drawing of more than one body.
    #[error("the drawing has a second piece at ({:.6}, {:.6}) m outside the first: draw one body only", at[0], at[1])]
    TwoPieces {
        /// First point of the second piece, metres.
        at: Point,
    },
    /// A path that does not close.
    #[error(
        "path {path} ends at ({:.6}, {:.6}) m, away from its begin at ({:.6}, {:.6}) m: close it (command Z)",
        end[0], end[1], begin[0], begin[1]
    )]
    OpenPath {
        /// Path of the drawing, counted from 0 through all shapes and their parts.
        path: usize,
        /// Begin, metres.
        begin: Point,
        /// End, metres.
        end: Point,
    },
    /// A shape that a clip path or a mask may cut.
    #[error(
        "the shape at ({:.6}, {:.6}) m is cut by the {attribute} \"{id}\", which is not applied: draw the shape as it \
         is after the cut, or remove the {attribute}", at[0], at[1]
    )]
    Cut {
        /// Attribute of SVG that cuts.
        attribute: &'static str,
        /// Name of the clip path or mask.
        id: String,
        /// First point of the shape, metres.
        at: Point,
    },
    /// A drawing without visible shapes.
    #[error("the drawing has no visible shape: draw one closed path, rectangle, circle or ellipse with a fill")]
    NoPath,
    /// A text that is no SVG drawing.
    #[error("the drawing is not readable as SVG: {reason}; save it as plain SVG")]
    Svg {
        /// Message of the reader.
        reason: String,
    },
    /// A file that is no PNG picture.
    #[error("the picture is not readable as PNG: save it again as PNG with 8 or 16 bits a channel")]
    Png,
    /// A picture with more pixels than are traced.
    #[error("the picture has {width} x {height} pixels, and at most {most} are traced: scale it down")]
    LargePicture {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
        /// Maximum number of pixels.
        most: usize,
    },
    /// A picture without anything dark or opaque.
    #[error("the picture has no shape: draw it dark on white, or opaque on a transparent ground")]
    NoShape,
    /// A shape that the border of its picture cuts off.
    #[error(
        "the shape touches the picture's border at column {}, row {}: leave a margin of the light ground around it", at[0], at[1]
    )]
    OpenPicture {
        /// Column and row of a pixel, from the upper left corner, 0 being the first.
        at: [usize; 2],
    },
    /// A picture whose border has too many corners.
    #[error("the picture's shape has {corners} corners, and at most {most} are meshed: smooth or clean the picture")]
    ManyCorners {
        /// Number of corners.
        corners: usize,
        /// Maximum number of corners.
        most: usize,
    },
    /// A unit that is not a positive length.
    #[error("a unit of {unit_m} m is no length: give metres per unit of the drawing, 0.001 for millimetres")]
    BadUnit {
        /// Unit, metres.
        unit_m: f64,
    },
}

impl OutlineError {
    /// Counts sides as before rings were turned round: `turned` has the number of sides of each
    /// ring that was.
    pub(super) fn of_turned(mut self, turned: &[Option<usize>]) -> Self {
        let before = |ring: usize, side: &mut usize| {
            if let Some(Some(count)) = turned.get(ring) {
                *side = (count - 1).saturating_sub(*side);
            }
        };
        match &mut self {
            Self::NoLength { ring, side, .. } => before(*ring, side),
            Self::Crosses { ring, side, other, .. } => {
                before(*ring, side);
                before(*ring, other);
                if *side > *other {
                    std::mem::swap(side, other);
                }
            }
            Self::HoleTouches { ring, side, other, other_side, .. } => {
                before(*ring, side);
                before(*other, other_side);
            }
            _ => {}
        }
        self
    }
}

fn meeting(ring: usize, side: usize, other: usize) -> String {
    if side == other {
        return format!("side {side} of ring {ring} crosses itself");
    }
    format!("sides {side} and {other} of ring {ring} cross or touch")
}
