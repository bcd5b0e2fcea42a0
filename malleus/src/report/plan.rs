//! Plan of a body: from metres to the units of a drawing, whose y axis points down.

use std::fmt::Write;

/// Point in the plane of a body, metres.
pub(super) type Point = [f64; 2];

/// Plan of a body in the middle of a drawing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    middle: Point,
    scale: f64,
    /// Width and height of the drawing, in its own units.
    pub(super) size: [f64; 2],
}

/// Margin of a drawing, in its own units.
const MARGIN: f64 = 8.0;

impl Plan {
    /// Fits the rectangle between two corners, metres, into a drawing of a width and of at most a
    /// height.
    pub(super) fn new([low, high]: [Point; 2], width: f64, highest: f64) -> Self {
        let extent = [0, 1].map(|axis| (high[axis] - low[axis]).max(1e-9));
        let scale = ((width - 2.0 * MARGIN) / extent[0]).min((highest - 2.0 * MARGIN) / extent[1]);
        let middle = [0, 1].map(|axis| (low[axis] + high[axis]) / 2.0);
        Self { middle, scale, size: [width, scale * extent[1] + 2.0 * MARGIN] }
    }

    /// Place of a point in the drawing.
    pub(super) fn place(&self, point: Point) -> [f64; 2] {
        let [x, y] = [0, 1].map(|axis| (point[axis] - self.middle[axis]) * self.scale);
        [self.size[0] / 2.0 + x, self.size[1] / 2.0 - y]
    }

    /// Writes the data of a path along points.
    pub(super) fn along(&self, points: impl IntoIterator<Item = Point>) -> String {
        let mut data = String::new();
        for point in points {
            let [x, y] = self.place(point);
            // Writing into a string cannot fail.
            let _ = write!(data, "{}{x:.1} {y:.1}", if data.is_empty() { "M" } else { "L" });
        }
        data
    }
}

/// Smallest upright rectangle around points: its lower left and its upper right corner.
pub(super) fn bounds(points: impl IntoIterator<Item = Point>) -> [Point; 2] {
    let none = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    points.into_iter().fold(none, |[low, high], point| {
        [[0, 1].map(|axis| low[axis].min(point[axis])), [0, 1].map(|axis| high[axis].max(point[axis]))]
    })
}

/// Writes a drawing with its description for those who do not see it.
pub(super) fn drawing([width, height]: [f64; 2], label: &str, body: &str) -> String {
    format!("<svg viewBox=\"0 0 {width:.1} {height:.1}\" role=\"img\" aria-label=\"{label}\">{body}</svg>")
}
