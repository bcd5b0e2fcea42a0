//! Place of a contact on its surface.
//!
//! A path is cut into segments, each of which plays the surface from a place of its own, given by
//! the segment's number; towards its end a segment is faded into the next one. Otherwise the
//! surface's length would be heard as a pitch.
//!
//! Places are whole numbers of `2^-32` points, as in the instrument: two paths that differ by a
//! thousandth of a point would differ by -60 dB.

/// Longest segment in points.
const LONGEST: u32 = 1024;
/// Part of a segment over which it is faded.
const FADED: i64 = 16;
/// Places in a point of the grid.
pub const POINT: i64 = 1 << 32;

/// Segments of paths over a surface.
#[derive(Clone, Copy, Debug)]
pub struct Segments {
    /// Length of a segment.
    length: i64,
    /// Length of the surface in points.
    points: u32,
    seed: u32,
}

/// Place in two segments.
#[derive(Clone, Copy, Debug)]
pub struct InTable {
    /// Offsets to places in the surface, in this segment and in the next.
    pub offsets: [i64; 2],
    /// Number of this segment.
    pub segment: i64,
    /// Weight of the next segment, 0 to 1, if it has begun.
    pub fade: Option<f64>,
}

impl Segments {
    /// Cuts paths over a surface of `points` points into segments.
    pub fn new(points: u32, seed: u32) -> Self {
        Self { points, ..Self::in_map(points / 3, seed) }
    }

    /// Cuts paths over a map into segments, at most as long as its shorter side of `points` points.
    pub fn in_map(points: u32, seed: u32) -> Self {
        let longest = points.clamp(32, LONGEST);
        Self { length: i64::from(1u32 << longest.ilog2()) * POINT, points: 1, seed }
    }

    /// Segment of a place.
    pub fn at(&self, place: i64) -> InTable {
        let segment = place.div_euclid(self.length);
        let within = place.rem_euclid(self.length);
        let begin = self.length - self.length / FADED;
        let fade = (within >= begin).then(|| (within - begin) as f64 / (self.length / FADED) as f64);
        InTable { offsets: [self.offset(segment), self.offset(segment + 1)], segment, fade }
    }

    fn offset(&self, segment: i64) -> i64 {
        point_of(self.random(segment), self.points) - segment * self.length
    }

    fn random(&self, segment: i64) -> u32 {
        spread((segment as u32).wrapping_add(self.seed))
    }

    /// Offset from a place in the plane to a segment's place in a map with a number of columns and
    /// rows.
    pub fn offset_in_map(&self, segment: i64, points: [usize; 2]) -> [i64; 2] {
        let random = self.random(segment);
        [point_of(random, points[0] as u32), point_of(spread(random), points[1] as u32)]
    }

    /// Place on the surface in points.
    pub fn in_table(&self, place: i64) -> f64 {
        place.rem_euclid(i64::from(self.points) * POINT) as f64 / POINT as f64
    }
}

/// Point of a table for a random number.
fn point_of(random: u32, points: u32) -> i64 {
    ((u64::from(random) * u64::from(points)) >> 32) as i64 * POINT
}

/// Number whose bits are spread by the finalizer of MurmurHash3 (Appleby, public domain).
fn spread(number: u32) -> u32 {
    let mut x = number;
    x = (x ^ (x >> 16)).wrapping_mul(0x85eb_ca6b);
    x = (x ^ (x >> 13)).wrapping_mul(0xc2b2_ae35);
    x ^ (x >> 16)
}
