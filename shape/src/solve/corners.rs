//! Corners of a body and lengths of its elements.

use std::f64::consts::PI;

use super::Body;
use crate::element::{Elasticity, Support};
use crate::file::Kind;

/// Angle in the body from which on elements become smaller towards a corner; stresses at it have no
/// bound. Corners of curves that are drawn as polygons are below it.
const FREE_CORNER: f64 = 195.0 / 180.0 * PI;
/// Angle of a corner of two hinged edges from which on elements become smaller.
const HINGED_CORNER: f64 = 95.0 / 180.0 * PI;
/// Elements at corners, as a share of the largest ones.
const CORNER_SHARE: f64 = 0.02;
/// Elements at corners of thin plates, as a share of the largest ones.
const HINGED_SHARE: f64 = 1e-3;
/// Angle in the body above which a corner counts as one into it, however blunt: errors fall slowly
/// with the length of the edges there.
const STRAIGHT: f64 = 181.0 / 180.0 * PI;
/// Power of the length of the edges as which errors fall at least, measured on plates with all
/// kinds of edges, membranes, sheets and bodies of revolution. Without thin layers at edges it
/// would be the eighth.
const FALLS: i32 = 4;
/// Lengths of the edges of the first two meshes, in wavelengths of the highest mode: of free plates
/// with rows along their edges, which are fine there, of other bodies, and of plates that are held
/// all around, whose frequencies err more.
const FIRST_SIZES: [[f64; 2]; 3] = [[0.8, 0.5], [0.7, 0.49], [0.63, 0.4]];

/// Corner of an outline.
#[derive(Clone, Copy, Debug)]
struct Corner {
    /// Angle in the body, radians.
    angle: f64,
    /// Supports of the sides before and after it.
    supports: [Support; 2],
}

impl Body {
    /// Length of the elements at each corner where stresses have no bound.
    pub(super) fn at_corners(&self, size: f64) -> Vec<Option<f64>> {
        let length = |corner: Corner| {
            let widest = if self.is_hinged(corner) { HINGED_CORNER } else { FREE_CORNER };
            // Within a thickness of it a corner of a plate is one in space.
            let least = (HINGED_SHARE * size).max(0.5 * self.thickness);
            let length = if self.kind == Kind::Plate { least } else { CORNER_SHARE * size };
            (corner.angle > widest).then_some(length)
        };
        self.corners().into_iter().map(length).collect()
    }

    /// Lists the corners at which the sides begin, in their order.
    fn corners(&self) -> Vec<Corner> {
        let sides = self.outline.sides();
        let starts = self.outline.rings.iter().scan(0, |first, ring| {
            *first += ring.len();
            Some((*first - ring.len())..*first)
        });
        let corner = |side: usize, before: usize| {
            let (into, out) = (sides[before].derivative(1.0), sides[side].derivative(0.0));
            let turn = (into[0] * out[1] - into[1] * out[0]).atan2(into[0] * out[0] + into[1] * out[1]);
            Corner { angle: PI - turn, supports: [before, side].map(|side| self.supports[side]) }
        };
        starts
            .flat_map(|ring| ring.clone().map(move |side| (side, if side == ring.start { ring.end } else { side } - 1)))
            .map(|(side, before)| corner(side, before))
            .collect()
    }

    /// True for a corner of a plate between hinged edges.
    fn is_hinged(&self, corner: Corner) -> bool {
        self.kind == Kind::Plate && corner.supports == [Support::Hinged; 2]
    }

    /// Power of the length of the edges as which the errors of the frequencies fall at least;
    /// `None` if they may fall as slowly as where stresses have no bound: at corners into the body
    /// or of two supports. Wood has waves too different for one length to fit them all.
    pub(super) fn falls(&self) -> Option<i32> {
        let is_bounded = |corner: &Corner| {
            let [before, after] = corner.supports;
            let widest = if self.is_hinged(*corner) { HINGED_CORNER } else { STRAIGHT };
            before == after && corner.angle <= widest
        };
        let is_even = matches!(self.material.elasticity, Elasticity::Isotropic { .. });
        let all = is_even && self.corners().iter().all(is_bounded);
        all.then_some(FALLS)
    }

    /// True if no edge is free.
    fn is_held(&self) -> bool {
        self.supports.iter().all(|&support| support != Support::Free)
    }

    /// Lengths of the edges of the first two meshes, in wavelengths of the highest mode.
    pub(super) fn first_sizes(&self) -> [f64; 2] {
        let [rows, others, held] = FIRST_SIZES;
        match self.kind {
            Kind::Plate if self.is_held() => held,
            Kind::Plate if self.has_rows => rows,
            _ => others,
        }
    }
}
