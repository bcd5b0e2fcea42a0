//! Outlines from points, and the check that an outline is a body.

use super::side::distance;
use super::touch::{apart, itself, joined};
use super::{FlatSide, Outline, OutlineError, Point, Side, reversed, ring_area, ring_contains, ring_sides};

/// Pieces in which a curved side is checked.
const PIECES: usize = 16;

/// Share of the body's extent below which a distance counts as a touch.
const TOUCH: f64 = 1e-9;

/// Piece of a side.
struct Piece {
    side: usize,
    /// Place in the ring's row of pieces, and the count of them.
    place: [usize; 2],
    flat: FlatSide,
}

impl Outline {
    /// Makes the outline of a polygon with holes, metres, and turns its rings the right way round.
    ///
    /// # Errors
    /// Names the first ring that is no ring, or the first sides that cross or touch.
    pub fn polygon(outer: &[Point], holes: &[Vec<Point>]) -> Result<Outline, OutlineError> {
        let mut rings = Vec::with_capacity(1 + holes.len());
        for points in std::iter::once(outer).chain(holes.iter().map(Vec::as_slice)) {
            let mut points = points.to_vec();
            points.dedup();
            while points.len() > 1 && points.first() == points.last() {
                points.pop();
            }
            if points.is_empty() && rings.is_empty() {
                return Err(OutlineError::Empty);
            }
            rings.push(points.into_iter().map(|from| Side { from, curve: None }).collect());
        }
        Outline::oriented(rings)
    }

    /// Makes an outline of rings of any direction, the outer one first, and checks it.
    pub(super) fn oriented(mut rings: Vec<Vec<Side>>) -> Result<Outline, OutlineError> {
        let mut turned = vec![None; rings.len()];
        for (index, (ring, turned)) in rings.iter_mut().zip(&mut turned).enumerate() {
            check_finite(index, ring)?;
            if (ring_area(ring) > 0.0) != (index == 0) {
                *ring = reversed(ring);
                *turned = Some(ring.len());
            }
        }
        let outline = Outline { rings };
        outline.check().map_err(|error| error.of_turned(&turned))?;
        Ok(outline)
    }

    /// Checks that the outline is that of one body: rings of finite numbers that enclose an area,
    /// run the right way and cross or touch neither themselves nor each other, and holes inside the
    /// outer ring and outside each other.
    ///
    /// # Errors
    /// Names the first of these that does not hold, and where.
    pub fn check(&self) -> Result<(), OutlineError> {
        if self.rings.is_empty() {
            return Err(OutlineError::Empty);
        }
        for (index, ring) in self.rings.iter().enumerate() {
            check_finite(index, ring)?;
        }
        let extent = self.extent();
        for (index, ring) in self.rings.iter().enumerate() {
            check_ring(index, ring, extent)?;
        }
        self.check_apart()?;
        for (index, ring) in self.rings.iter().enumerate().skip(1) {
            let at = ring[0].from;
            if !ring_contains(&self.rings[0], at) {
                return Err(OutlineError::HoleOutside { ring: index, at });
            }
            let mut others = (1..self.rings.len()).filter(|other| *other != index);
            if let Some(other) = others.find(|other| ring_contains(&self.rings[*other], at)) {
                return Err(OutlineError::HoleInHole { ring: index, other, at });
            }
        }
        // A ring that crosses itself may enclose as much to its left as to its right.
        self.rings.iter().enumerate().try_for_each(|(index, ring)| check_area(index, ring))
    }

    /// Checks that the rings cross or touch neither themselves nor each other.
    pub(super) fn check_apart(&self) -> Result<(), OutlineError> {
        check_crossings(&self.pieces(), TOUCH * self.extent())
    }

    /// Diagonal of the smallest upright rectangle around the body, metres.
    fn extent(&self) -> f64 {
        self.bounds().map_or(0.0, |[low, high]| distance(low, high))
    }

    /// Lists the pieces of all sides.
    fn pieces(&self) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for (ring, sides) in self.rings.iter().enumerate() {
            let begin = pieces.len();
            for (side, flat) in ring_sides(ring, sides).enumerate() {
                let count = if flat.curve.is_some() { PIECES } else { 1 };
                for k in 0..count {
                    let at = |k: usize| k as f64 / count as f64;
                    // Points at one parameter are the same for both pieces that end there.
                    let (from, to) = (flat.point(at(k)), flat.point(at(k + 1)));
                    let flat = FlatSide { from, to, ..flat.part(at(k), at(k + 1)) };
                    pieces.push(Piece { side, place: [pieces.len() - begin, 0], flat });
                }
            }
            let count = pieces.len() - begin;
            pieces[begin..].iter_mut().for_each(|piece| piece.place[1] = count);
        }
        pieces
    }
}

/// Checks that all numbers of a ring are finite.
fn check_finite(ring: usize, sides: &[Side]) -> Result<(), OutlineError> {
    for (side, flat) in sides.iter().enumerate() {
        let [a, b] = flat.curve.unwrap_or([flat.from; 2]);
        // Squares of what is larger than this are no numbers any more.
        let beyond = |p: &Point| !p.iter().all(|x| x.abs() < 1e100);
        if let Some(at) = [flat.from, a, b].into_iter().find(beyond) {
            return Err(OutlineError::NotFinite { ring, side, at });
        }
    }
    Ok(())
}

/// Checks that a ring has points that do not lie on one line, and that its sides have lengths.
fn check_ring(ring: usize, sides: &[Side], extent: f64) -> Result<(), OutlineError> {
    let curved = sides.iter().any(|side| side.curve.is_some());
    if sides.len() < if curved { 2 } else { 3 } {
        return Err(OutlineError::TooFewPoints { ring, points: sides.len() });
    }
    for (side, flat) in ring_sides(ring, sides).enumerate() {
        if distance(flat.from, flat.to) <= TOUCH * extent {
            let is_loop = |c: &Point| distance(flat.from, *c) > TOUCH * extent;
            if flat.curve.iter().flatten().any(is_loop) {
                return Err(OutlineError::Crosses { ring, side, other: side, at: flat.from });
            }
            return Err(OutlineError::NoLength { ring, side, at: flat.from });
        }
    }
    if lies_on_a_line(sides, TOUCH * extent) {
        return Err(OutlineError::NoArea { ring, at: sides[0].from });
    }
    Ok(())
}

/// Tells whether all points of a ring lie within a tolerance of one line.
fn lies_on_a_line(sides: &[Side], tolerance: f64) -> bool {
    let first = sides[0].from;
    let points = || sides.iter().flat_map(|side| std::iter::once(side.from).chain(side.curve.into_iter().flatten()));
    let far = |p: &Point| distance(first, *p);
    let Some(last) = points().max_by(|a, b| far(a).total_cmp(&far(b))) else { return true };
    let [x, y] = [last[0] - first[0], last[1] - first[1]];
    points().all(|p| (x * (p[1] - first[1]) - y * (p[0] - first[0])).abs() <= tolerance * x.hypot(y))
}

/// Checks that a ring encloses an area and runs the right way.
fn check_area(ring: usize, sides: &[Side]) -> Result<(), OutlineError> {
    let area = ring_area(sides);
    let round: f64 = ring_sides(ring, sides).map(|side| distance(side.from, side.to)).sum();
    if area.abs() <= 1e-12 * round * round {
        return Err(OutlineError::NoArea { ring, at: sides[0].from });
    }
    if (area > 0.0) == (ring == 0) { Ok(()) } else { Err(OutlineError::WrongWay { ring }) }
}

/// Checks that no piece crosses or touches itself, or another one than its neighbours at their
/// common ends.
fn check_crossings(pieces: &[Piece], tolerance: f64) -> Result<(), OutlineError> {
    let reach = |piece: &Piece, axis: usize| {
        let along = piece.flat.controls().map(|p| p[axis]);
        let [low, high] =
            [along.iter().copied().fold(f64::MAX, f64::min), along.iter().copied().fold(f64::MIN, f64::max)];
        [low - tolerance, high + tolerance]
    };
    let mut order: Vec<usize> = (0..pieces.len()).collect();
    order.sort_by(|&a, &b| reach(&pieces[a], 0)[0].total_cmp(&reach(&pieces[b], 0)[0]).then(a.cmp(&b)));
    for (place, &first) in order.iter().enumerate() {
        let [_, right] = reach(&pieces[first], 0);
        let [low, high] = reach(&pieces[first], 1);
        if let Some(at) = itself(&pieces[first].flat, tolerance) {
            let Piece { side, flat, .. } = pieces[first];
            return Err(OutlineError::Crosses { ring: flat.ring, side, other: side, at });
        }
        for &second in &order[place + 1..] {
            let [left, _] = reach(&pieces[second], 0);
            if left > right {
                break;
            }
            let [below, above] = reach(&pieces[second], 1);
            if below <= high && above >= low {
                let pair = [&pieces[first.min(second)], &pieces[first.max(second)]];
                check_pair(pair, tolerance)?;
            }
        }
    }
    Ok(())
}

/// Checks that two pieces meet at most at their common end.
fn check_pair([first, second]: [&Piece; 2], tolerance: f64) -> Result<(), OutlineError> {
    let (a, b) = (&first.flat, &second.flat);
    let count = first.place[1];
    let same = a.ring == b.ring;
    let follows = same && (first.place[0] + 1) % count == second.place[0];
    let precedes = same && (second.place[0] + 1) % count == first.place[0];
    let meeting = match (follows, precedes) {
        (true, _) => joined(a, b, tolerance).or_else(|| if precedes { joined(b, a, tolerance) } else { None }),
        (false, true) => joined(b, a, tolerance),
        (false, false) => apart(a, b, tolerance),
    };
    let Some(at) = meeting else { return Ok(()) };
    if same {
        return Err(OutlineError::Crosses { ring: a.ring, side: first.side, other: second.side, at });
    }
    Err(OutlineError::HoleTouches { ring: b.ring, side: second.side, other: a.ring, other_side: first.side, at })
}
