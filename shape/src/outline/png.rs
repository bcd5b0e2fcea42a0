//! Outlines from pictures: the border of what is dark or opaque, as a polygon.

use std::collections::HashMap;
use std::io::Cursor;

use png::{ColorType, Decoder, Transformations};

use super::simple::simplified;
use super::{Outline, OutlineError, Point};

/// Maximum number of pixels of a picture.
const MOST_PIXELS: usize = 1 << 24;
/// Value at the border of the shape: half covered.
const BORDER: f64 = 0.5;
/// Least distance of a traced point from the middle of a pixel, so that no two points fall
/// together.
const APART: f64 = 0.02;
/// Area in square pixels below which a speck is no part of the shape.
const SPECK: f64 = 1.0;
/// Values of pixels that are covered in part.
const GREY: std::ops::Range<f32> = 0.05..0.95;
/// Least difference of a pixel from the ground that is seen, of full scale.
const SEEN: f32 = 0.1;
/// Maximum number of corners of an outline.
const MOST_CORNERS: usize = 10_000;
/// Distances in pixels by which a polygon may leave the traced border, the first that fits counts.
const TOLERANCES: [f64; 3] = [0.75, 0.3, 0.1];

/// Picture: how much of each pixel the shape covers, 0 to 1, row by row from the top.
struct Picture {
    width: usize,
    height: usize,
    covered: Vec<f32>,
}

impl Outline {
    /// Makes the outline of a picture in PNG: the border lies at half between the colour of the
    /// ground, which is that of most pixels at the picture's border, and that of the shape, which
    /// is the commonest one far from it. If any pixel is transparent, what is more than half opaque
    /// is the shape. The ground must be light. Pixels that are covered in part
    /// place the border between the middles of two pixels; a picture without such pixels is blurred
    /// first, which loses what is a pixel thin. The border becomes a polygon of few
    /// corners, about half a pixel off at most. Holes stay holes, and specks below a pixel are left
    /// out. The picture's upper left corner is the origin, and the y axis points up. A pixel is
    /// `unit_m` metres wide.
    ///
    /// # Errors
    /// Says what cannot be read, where the shape is open or has a second piece, or what
    /// [`Outline::check`] finds.
    pub fn from_png(bytes: &[u8], unit_m: f64) -> Result<Outline, OutlineError> {
        if !(unit_m > 0.0 && unit_m.is_finite()) {
            return Err(OutlineError::BadUnit { unit_m });
        }
        let picture = Picture::read(bytes)?;
        let metres = |point: Point| [point[0] * unit_m, -point[1] * unit_m];
        if let Some(at) = picture.open_at() {
            return Err(OutlineError::OpenPicture { at });
        }
        let picture = picture.without_stairs();
        let mut rings = picture.rings();
        rings.retain(|ring| area(ring).abs() >= SPECK);
        let largest = |a: &usize, b: &usize| area(&rings[*a]).abs().total_cmp(&area(&rings[*b]).abs());
        let Some(outer) = (0..rings.len()).max_by(largest) else { return Err(OutlineError::NoShape) };
        rings.swap(0, outer);
        let is_outer = |ring: &&Vec<Point>| (area(ring) > 0.0) == (area(&rings[0]) > 0.0);
        if let Some(second) = rings.iter().skip(1).find(is_outer) {
            return Err(OutlineError::TwoPieces { at: metres(second[0]) });
        }
        let mut last = OutlineError::NoShape;
        for tolerance in TOLERANCES {
            let simple: Vec<Vec<Point>> = rings.iter().map(|ring| simplified(ring, tolerance)).collect();
            let corners = simple.iter().map(Vec::len).sum();
            if corners > MOST_CORNERS {
                return Err(OutlineError::ManyCorners { corners, most: MOST_CORNERS });
            }
            let mut simple = simple.iter().map(|ring| ring.iter().copied().map(metres).collect::<Vec<Point>>());
            let first = simple.next().unwrap_or_default();
            match Outline::polygon(&first, &simple.collect::<Vec<_>>()) {
                Ok(outline) => return Ok(outline),
                Err(error) => last = error,
            }
        }
        Err(last)
    }
}

impl Picture {
    fn read(bytes: &[u8]) -> Result<Self, OutlineError> {
        let unreadable = |_| OutlineError::Png;
        let mut decoder = Decoder::new(Cursor::new(bytes));
        decoder.set_transformations(Transformations::normalize_to_color8());
        let mut reader = decoder.read_info().map_err(unreadable)?;
        let (width, height) = (reader.info().width as usize, reader.info().height as usize);
        if width.saturating_mul(height) > MOST_PIXELS {
            return Err(OutlineError::LargePicture { width, height, most: MOST_PIXELS });
        }
        let mut pixels = vec![0; reader.output_buffer_size().ok_or(OutlineError::Png)?];
        let frame = reader.next_frame(&mut pixels).map_err(unreadable)?;
        let (colours, has_alpha) = match frame.color_type {
            ColorType::Grayscale => (1, false),
            ColorType::GrayscaleAlpha => (1, true),
            ColorType::Rgb => (3, false),
            ColorType::Rgba => (3, true),
            ColorType::Indexed => return Err(OutlineError::Png),
        };
        let pixels = || pixels.chunks_exact(colours + usize::from(has_alpha)).take(width * height);
        let is_transparent = has_alpha && pixels().any(|pixel| pixel[colours] < u8::MAX);
        let share = |byte: u8| f32::from(byte) / f32::from(u8::MAX);
        let covered = if is_transparent {
            pixels().map(|pixel| share(pixel[colours])).collect()
        } else {
            let pixels: Vec<&[u8]> = pixels().map(|pixel| &pixel[..colours]).collect();
            unlike_the_ground(&pixels, width)
        };
        Ok(Self { width, height, covered })
    }

    /// Blurs a picture whose pixels are all covered or not: its border is a stair else, with steps
    /// as long as the line is slanted.
    fn without_stairs(self) -> Self {
        if self.covered.iter().any(|value| GREY.contains(value)) {
            return self;
        }
        let [across, down] = [1, self.width].map(|step| {
            move |values: &[f32]| -> Vec<f32> {
                let at = |index: Option<usize>| index.and_then(|index| values.get(index)).copied().unwrap_or(0.0);
                let blurred = |index: usize| {
                    let beside = at(index.checked_sub(step)) + at(index.checked_add(step));
                    0.5 * values[index] + 0.25 * beside
                };
                (0..values.len()).map(blurred).collect()
            }
        });
        let covered = down(&across(&self.covered));
        Self { covered, ..self }
    }

    fn at(&self, column: usize, row: usize) -> f64 {
        f64::from(self.covered.get(row * self.width + column).copied().unwrap_or(0.0))
    }

    /// Pixel of the shape on the picture's border, column and row from the upper left corner.
    fn open_at(&self) -> Option<[usize; 2]> {
        let (last_column, last_row) = (self.width - 1, self.height - 1);
        let upright = (0..self.height).flat_map(|row| [[0, row], [last_column, row]]);
        let level = (0..self.width).flat_map(|column| [[column, 0], [column, last_row]]);
        upright.chain(level).find(|&[column, row]| self.at(column, row) > BORDER)
    }

    /// Closed borders of the shape in pixels from the upper left corner, by marching squares whose
    /// corners are the middles of pixels.
    fn rings(&self) -> Vec<Vec<Point>> {
        // An edge between two pixels is named by the first one, and whether it leads down.
        let mut next: HashMap<(usize, bool), (usize, bool)> = HashMap::new();
        let mut order = Vec::new();
        for row in 0..self.height.saturating_sub(1) {
            for column in 0..self.width.saturating_sub(1) {
                let pixel = row * self.width + column;
                let corners = [[column, row], [column + 1, row], [column + 1, row + 1], [column, row + 1]];
                let values = corners.map(|[column, row]| self.at(column, row));
                let inside = values.map(|value| value > BORDER);
                if inside == [true; 4] || inside == [false; 4] {
                    continue;
                }
                let edges = [(pixel, false), (pixel + 1, true), (pixel + self.width, false), (pixel, true)];
                // Two opposite corners are joined if the middle of the cell is inside.
                let is_joined = values.iter().sum::<f64>() / 4.0 > BORDER;
                let enters = |edge: usize| !inside[edge] && inside[(edge + 1) % 4];
                for leaves in (0..4).filter(|&edge| inside[edge] && !inside[(edge + 1) % 4]) {
                    let mut ways = (1..4).map(|step| (leaves + if is_joined { step } else { 4 - step }) % 4);
                    let Some(edge) = ways.find(|&edge| enters(edge)) else { continue };
                    next.insert(edges[leaves], edges[edge]);
                    order.push(edges[leaves]);
                }
            }
        }
        let mut rings = Vec::new();
        for start in order {
            let mut ring = Vec::new();
            let mut edge = start;
            while let Some(following) = next.remove(&edge) {
                ring.push(self.crossing(edge));
                edge = following;
            }
            if ring.len() > 2 {
                rings.push(ring);
            }
        }
        rings
    }

    /// Point on an edge between two pixels at which the border crosses it.
    fn crossing(&self, (pixel, leads_down): (usize, bool)) -> Point {
        let [column, row] = [pixel % self.width, pixel / self.width];
        let step = [usize::from(!leads_down), usize::from(leads_down)];
        let [from, to] = [self.at(column, row), self.at(column + step[0], row + step[1])];
        let share = ((BORDER - from) / (to - from)).clamp(APART, 1.0 - APART);
        [column as f64 + 0.5 + share * step[0] as f64, row as f64 + 0.5 + share * step[1] as f64]
    }
}

/// Area within a ring, positive or negative by its direction.
fn area(ring: &[Point]) -> f64 {
    let following = ring.iter().cycle().skip(1);
    ring.iter().zip(following).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

/// Gives the difference of each pixel from the ground, as a share of the shape's, at most 1.
fn unlike_the_ground(pixels: &[&[u8]], width: usize) -> Vec<f32> {
    let height = pixels.len() / width.max(1);
    let is_border = |index: usize| {
        let (column, row) = (index % width.max(1), index / width.max(1));
        column == 0 || row == 0 || column + 1 == width || row + 1 == height
    };
    let border: Vec<&[u8]> =
        pixels.iter().enumerate().filter(|(index, _)| is_border(*index)).map(|(_, p)| *p).collect();
    let ground: Vec<u8> = (0..border.first().map_or(0, |pixel| pixel.len()))
        .map(|colour| {
            let mut values: Vec<u8> = border.iter().map(|pixel| pixel[colour]).collect();
            values.sort_unstable();
            // On a tie the lighter one.
            values[values.len() / 2]
        })
        .collect();
    let is_dark =
        ground.iter().map(|&colour| usize::from(colour)).sum::<usize>() * 2 < ground.len() * usize::from(u8::MAX);
    let far = |pixel: &[u8]| pixel.iter().zip(&ground).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0);
    let mut counts = [0_usize; 1 + u8::MAX as usize];
    pixels.iter().for_each(|pixel| counts[usize::from(far(pixel))] += 1);
    let farthest = counts.iter().rposition(|&count| count > 0).unwrap_or(0);
    // Pixels that are covered in part are nearer to the ground, as a rule nearer than half.
    let commonest = (farthest.div_ceil(2)..=farthest).max_by_key(|&value| counts[value]).unwrap_or(0);
    if (farthest as f32) < SEEN * f32::from(u8::MAX) {
        return vec![if is_dark { 1.0 } else { 0.0 }; pixels.len()];
    }
    let covered = |pixel: &&[u8]| {
        let covered = (f32::from(far(pixel)) / commonest as f32).min(1.0);
        if is_dark { 1.0 - covered } else { covered }
    };
    pixels.iter().map(covered).collect()
}
