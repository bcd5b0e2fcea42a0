//! Outline of a flat body: closed rings of straight and curved sides, in metres.

mod arc;
mod check;
mod cut;
mod error;
mod fill_rule;
mod ground;
mod png;
pub(crate) mod side;
mod simple;
mod svg;
pub(crate) mod touch;

pub use error::OutlineError;
pub use side::FlatSide;

/// Point in the plane, metres.
pub type Point = [f64; 2];

/// Side of a ring, from its point to that of the next side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// Begin of the side.
    pub from: Point,
    /// Control points of a cubic Bézier curve; `None` for a straight side.
    pub curve: Option<[Point; 2]>,
}

/// Outline: the outer ring and those of the holes. The body lies to the left of each side: the
/// outer ring runs counter-clockwise, holes run clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Rings, the outer one first.
    pub rings: Vec<Vec<Side>>,
}

impl Outline {
    /// Lists the sides of all rings with both their ends, ring after ring.
    pub fn sides(&self) -> Vec<FlatSide> {
        self.rings.iter().enumerate().flat_map(|(index, ring)| ring_sides(index, ring)).collect()
    }

    /// Gives the lower left and the upper right corner of the smallest upright rectangle around the
    /// body, metres; `None` without sides.
    pub fn bounds(&self) -> Option<[Point; 2]> {
        self.sides().iter().flat_map(FlatSide::extremes).fold(None, |bounds, p| {
            let [low, high] = bounds.unwrap_or([p, p]);
            Some([[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]])
        })
    }

    /// Gives the area of the body without its holes, square metres.
    pub fn area(&self) -> f64 {
        self.rings.iter().map(|ring| ring_area(ring)).sum()
    }

    /// Tells whether a point lies inside the body and outside its holes.
    pub fn contains(&self, point: Point) -> bool {
        self.sides().iter().filter(|side| side.crossings(point) % 2 == 1).count() % 2 == 1
    }

    /// Tells whether any side is a curve.
    pub fn is_curved(&self) -> bool {
        self.rings.iter().flatten().any(|side| side.curve.is_some())
    }
}

/// Lists the sides of one ring with both their ends.
fn ring_sides(index: usize, ring: &[Side]) -> impl Iterator<Item = FlatSide> + '_ {
    ring.iter().enumerate().map(move |(k, side)| FlatSide {
        ring: index,
        from: side.from,
        to: ring[(k + 1) % ring.len()].from,
        curve: side.curve,
    })
}

/// Gives the area that a ring encloses, square metres: positive if it runs counter-clockwise.
fn ring_area(ring: &[Side]) -> f64 {
    let origin = ring.first().map_or([0.0; 2], |side| side.from);
    ring_sides(0, ring).map(|side| side.swept_area(origin)).sum()
}

/// Tells whether a ring encloses a point.
fn ring_contains(ring: &[Side], point: Point) -> bool {
    ring_sides(0, ring).filter(|side| side.crossings(point) % 2 == 1).count() % 2 == 1
}

/// Turns a ring round: the same curve, run the other way.
fn reversed(ring: &[Side]) -> Vec<Side> {
    let turn = |side: FlatSide| Side { from: side.to, curve: side.curve.map(|[a, b]| [b, a]) };
    let mut sides: Vec<Side> = ring_sides(0, ring).map(turn).collect();
    sides.reverse();
    sides
}
