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
/// Elements at other corners of thin plates, as a share of the largest ones.
const THIN_SHARE: f64 = 1e-3;
/// Largest part of the energy near a corner of two hinged edges that the mesh may leave out.
///
/// Near the corner, slopes are proportional to a power p of the distance. Elements of a length l,
/// in thicknesses, leave out the part `l^{2p}` of the energy. Elements half a thickness long made
/// the frequencies of an L of h/a 0.01 wrong by 0.9 %.
const HINGED_PART: f64 = 1e-3;
/// Smallest elements at corners of two hinged edges, as a share of the thickness. At blunt corners
/// the power is small, and elements that miss as little would be smaller than numbers resolve.
const HINGED_LEAST: f64 = 1e-5;
/// Largest sine of a corner's angle at which its two hinged edges act as one straight edge.
const SMOOTH: f64 = 0.1;
/// Relative errors of frequencies from a corner of two hinged edges whose energy is missed whole,
/// in units of the thickness over the root of the area.
///
/// The first is that of a corner out of the body, where 0.05 was measured on octagons and 0.26 on
/// polygons of 16 corners. The second is that of a corner into the body, measured on an L of h/a
/// 0.01.
const HINGED_ERRORS: [f64; 2] = [0.3, 2.0];
/// Angle in the body above which a corner counts as one into it, however blunt: errors fall slowly
/// with the length of the edges there.
const STRAIGHT: f64 = 181.0 / 180.0 * PI;
/// Power of the length of the edges as which errors fall at least, measured on plates with all
/// kinds of edges, membranes, sheets and bodies of revolution. Without thin layers at edges it
/// would be the eighth.
const FALLS: i32 = 4;
/// Lengths of the edges of the first two meshes, in wavelengths of the highest mode: of free plates
/// with rows along their edges, of those without, of plates that are held all around, whose
/// frequencies err more, and of other bodies. A coarser first mesh of the first ones, 0.8, or a
/// coarser second mesh of the next ones, 0.49, would make a third one needed for a plate of 3:2.
const FIRST_SIZES: [[f64; 2]; 4] = [[0.66, 0.46], [0.7, 0.455], [0.63, 0.4], [0.7, 0.49]];
/// Lengths of those edges for free plates at whose corners stresses have no bound: the estimate of
/// an L has all of the change between two meshes, and meshes of nearly one size change too little.
const CORNERED_SIZES: [f64; 2] = [0.8, 0.5];

/// Corner of an outline.
#[derive(Clone, Copy, Debug)]
struct Corner {
    /// Angle in the body, radians.
    angle: f64,
    /// Supports of the sides before and after it.
    supports: [Support; 2],
}

impl Corner {
    /// True if the edges meet in nearly one direction.
    fn is_smooth(&self) -> bool {
        self.angle.sin().abs() <= SMOOTH
    }

    /// Power of the distance as which slopes vary at a corner of two hinged edges.
    fn power(&self) -> f64 {
        [1.0, 2.0].map(|half_waves| (half_waves * PI / self.angle - 1.0).abs()).into_iter().fold(1.0, f64::min)
    }

    /// Length of the elements at a corner of two hinged edges, as a share of the thickness.
    fn hinged_share(&self) -> f64 {
        HINGED_PART.powf(0.5 / self.power()).max(HINGED_LEAST)
    }
}

impl Body {
    /// Length of the elements at each corner where stresses have no bound.
    pub(super) fn at_corners(&self, size: f64) -> Vec<Option<f64>> {
        let length = |corner: Corner| {
            let widest = if self.is_hinged(corner) { HINGED_CORNER } else { FREE_CORNER };
            let length = match self.kind {
                Kind::Plate if self.is_hinged(corner) => corner.hinged_share() * self.thickness,
                // Within a thickness of it a corner of a plate is one in space.
                Kind::Plate => (THIN_SHARE * size).max(0.5 * self.thickness),
                _ => CORNER_SHARE * size,
            };
            (corner.angle > widest && !(self.is_hinged(corner) && corner.is_smooth())).then_some(length)
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

    /// Error of the frequencies from what the elements at corners of hinged edges miss.
    pub(super) fn hinged_error(&self) -> f64 {
        let is_sharp = |corner: &Corner| self.is_hinged(*corner) && corner.angle > HINGED_CORNER && !corner.is_smooth();
        let missed = |corner: Corner| {
            HINGED_ERRORS[usize::from(corner.angle > PI)] * corner.hinged_share().powf(2.0 * corner.power())
        };
        let all: f64 = self.corners().into_iter().filter(is_sharp).map(missed).sum();
        all * self.thickness / self.outline.area().sqrt()
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
    pub(super) fn is_held(&self) -> bool {
        self.supports.iter().all(|&support| support != Support::Free)
    }

    /// Lengths of the edges of the first two meshes, in wavelengths of the highest mode.
    pub(super) fn first_sizes(&self) -> [f64; 2] {
        let [rows, thin, held, others] = FIRST_SIZES;
        match self.kind {
            Kind::Plate if self.is_held() => held,
            Kind::Plate if self.has_rows && self.falls().is_none() => CORNERED_SIZES,
            Kind::Plate if self.has_rows => rows,
            Kind::Plate => thin,
            _ => others,
        }
    }
}
