//! Charts as inline SVG: axes, lines, dots and bars. The page's style sheet colours them by class.

use std::fmt::Write;

use super::markup::escaped;

/// Width of a chart in its own units, which the page scales.
const WIDTH: f64 = 480.0;
/// Height of a chart in its own units.
const HEIGHT: f64 = 280.0;
/// Left edge of the area with the data.
const LEFT: f64 = 48.0;
/// Right edge of the area with the data.
const RIGHT: f64 = 468.0;
/// Upper edge of the area with the data.
const TOP: f64 = 10.0;
/// Lower edge of the area with the data.
const BOTTOM: f64 = 238.0;

/// Axis of a chart: a linear or logarithmic range, its ticks and its label.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    low: f64,
    high: f64,
    logarithmic: bool,
    ticks: Vec<(f64, String)>,
    label: &'static str,
}

impl Axis {
    /// Creates a logarithmic axis of frequency in Hz.
    pub(super) fn frequency(low_hz: f64, high_hz: f64) -> Self {
        let ticks = [50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 1e4, 2e4];
        let ticks = ticks
            .iter()
            .filter(|f| (low_hz..=high_hz).contains(*f))
            .map(|&f| (f, if f < 1e3 { format!("{f}") } else { format!("{}k", f / 1e3) }));
        Self { low: low_hz, high: high_hz, logarithmic: true, ticks: ticks.collect(), label: "frequency, Hz" }
    }

    /// Creates a logarithmic axis whose range is rounded outwards to 1, 2 or 5 times a power of
    /// ten.
    pub(super) fn decades(low: f64, high: f64, label: &'static str) -> Self {
        let steps: Vec<f64> =
            (-6..7).flat_map(|decade| [1.0, 2.0, 5.0].map(|step| step * 10f64.powi(decade))).collect();
        let first = steps.iter().rposition(|step| *step <= low).unwrap_or(0);
        let last = steps.iter().position(|step| *step >= high).unwrap_or(steps.len() - 1).max(first + 1);
        let kept = steps.get(first..=last.min(steps.len() - 1)).unwrap_or(&[]);
        let many = kept.len() > 8;
        let ticks = kept.iter().filter(|step| !many || is_power_of_ten(**step)).map(|step| (*step, plain(*step)));
        let (low, high) = (kept.first().copied().unwrap_or(low), kept.last().copied().unwrap_or(high));
        Self { low, high, logarithmic: true, ticks: ticks.collect(), label }
    }

    /// Creates a linear axis with about six round ticks at most.
    pub(super) fn linear(low: f64, high: f64, label: &'static str) -> Self {
        let high = if high > low { high } else { low + 1.0 };
        let raw = (high - low) / 6.0;
        let unit = 10f64.powf(raw.log10().floor());
        let step = unit * [1.0, 2.0, 5.0, 10.0].into_iter().find(|step| step * unit >= raw).unwrap_or(10.0);
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        let ticks = (first..=last).map(|index| (index as f64 * step, plain(index as f64 * step)));
        Self { low, high, logarithmic: false, ticks: ticks.collect(), label }
    }

    /// Place of a value along the axis, 0 to 1; values beyond an end lie at that end.
    fn share(&self, value: f64) -> f64 {
        let share = if self.logarithmic {
            (value.max(self.low * 1e-9) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
    }
}

fn is_power_of_ten(value: f64) -> bool {
    (value.log10() - value.log10().round()).abs() < 1e-9
}

/// Writes a tick's number without the digits that rounding adds.
fn plain(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    if rounded == 0.0 { "0".to_owned() } else { format!("{rounded}").replace('-', "\u{2212}") }
}

/// Chart to which marks are added one by one.
#[derive(Clone, Debug)]
pub(super) struct Chart {
    x: Axis,
    y: Axis,
    title: &'static str,
    body: String,
    legend: String,
    uprights: u32,
}

impl Chart {
    /// Creates a chart without marks.
    pub(super) fn new(title: &'static str, x: Axis, y: Axis) -> Self {
        Self { x, y, title, body: String::new(), legend: String::new(), uprights: 0 }
    }

    fn place(&self, x: f64, y: f64) -> (f64, f64) {
        (LEFT + (RIGHT - LEFT) * self.x.share(x), BOTTOM - (BOTTOM - TOP) * self.y.share(y))
    }

    fn draw(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing into a string cannot fail.
        let _ = self.body.write_fmt(element);
    }

    /// Adds an entry to the legend that names the marks of a class.
    pub(super) fn explain(&mut self, class: &str, text: &str) {
        let _ = write!(self.legend, "<span class=\"key {class}\">{}</span> ", escaped(text));
    }

    /// Draws a line through points.
    pub(super) fn line(&mut self, class: &str, points: impl IntoIterator<Item = (f64, f64)>) {
        let mut path = String::new();
        for (x, y) in points {
            let (x, y) = self.place(x, y);
            let _ = write!(path, "{}{x:.1} {y:.1}", if path.is_empty() { "M" } else { "L" });
        }
        self.draw(format_args!("<path class=\"line {class}\" d=\"{path}\"/>"));
    }

    /// Draws a dot.
    pub(super) fn dot(&mut self, class: &str, x: f64, y: f64, radius: f64) {
        let (x, y) = self.place(x, y);
        self.draw(format_args!("<circle class=\"dot {class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\"/>"));
    }

    /// Draws an upright line over a range of y, such as an error bar.
    pub(super) fn interval(&mut self, class: &str, x: f64, from: f64, to: f64) {
        let ((x, from), (_, to)) = (self.place(x, from), self.place(x, to));
        self.draw(format_args!(
            "<path class=\"line {class}\" d=\"M{x:.1} {from:.1}V{to:.1}M{left:.1} {from:.1}h4M{left:.1} {to:.1}h4\"/>",
            left = x - 2.0
        ));
    }

    /// Draws a dot and a line from the lower edge up to it.
    pub(super) fn stem(&mut self, class: &str, x: f64, y: f64) {
        let (px, py) = self.place(x, y);
        self.draw(format_args!("<path class=\"stem {class}\" d=\"M{px:.1} {BOTTOM}V{py:.1}\"/>"));
        self.dot(class, x, y, 2.6);
    }

    /// Draws a bar over a range of x, from the lower edge up.
    pub(super) fn bar(&mut self, class: &str, from: f64, to: f64, y: f64) {
        let (left, top) = self.place(from, y);
        let (right, _) = self.place(to, y);
        let (width, height) = ((right - left).max(0.5), BOTTOM - top);
        self.draw(format_args!(
            "<rect class=\"bar {class}\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\"/>"
        ));
    }

    /// Draws a horizontal line over a range of x.
    pub(super) fn level(&mut self, class: &str, from: f64, to: f64, y: f64) {
        self.line(class, [(from, y), (to, y)]);
    }

    /// Draws an upright line with a word at its top. The words of several lines stand below each
    /// other.
    pub(super) fn upright(&mut self, class: &str, x: f64, word: &str) {
        let (x, _) = self.place(x, self.y.low);
        let word = escaped(word);
        let (anchor, beside) = if x > 0.5 * (LEFT + RIGHT) { ("end", x - 3.0) } else { ("start", x + 3.0) };
        let y = TOP + 12.0 + 13.0 * f64::from(self.uprights);
        self.uprights += 1;
        self.draw(format_args!("<path class=\"upright {class}\" d=\"M{x:.1} {TOP}V{BOTTOM}\"/><text class=\"word\" text-anchor=\"{anchor}\" x=\"{beside:.1}\" y=\"{y:.1}\">{word}</text>"));
    }

    /// Draws a picture that fills the area with the data.
    pub(super) fn picture(&mut self, data: &str) {
        let (width, height) = (RIGHT - LEFT, BOTTOM - TOP);
        self.draw(format_args!("<image href=\"{data}\" x=\"{LEFT}\" y=\"{TOP}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\"/>"));
    }

    /// Writes the chart as an HTML figure with its caption and legend above it.
    pub(super) fn figure(self) -> String {
        let mut axes = String::new();
        for (value, text) in &self.x.ticks {
            let (x, _) = self.place(*value, self.y.low);
            let _ = write!(
                axes,
                "<path class=\"grid\" d=\"M{x:.1} {TOP}V{BOTTOM}\"/><text class=\"tick\" text-anchor=\"middle\" x=\"{x:.1}\" y=\"{}\">{text}</text>",
                BOTTOM + 16.0
            );
        }
        for (value, text) in &self.y.ticks {
            let (_, y) = self.place(self.x.low, *value);
            let _ = write!(
                axes,
                "<path class=\"grid\" d=\"M{LEFT} {y:.1}H{RIGHT}\"/><text class=\"tick\" text-anchor=\"end\" x=\"{}\" y=\"{:.1}\">{text}</text>",
                LEFT - 5.0,
                y + 4.0
            );
        }
        let middle = 0.5 * (LEFT + RIGHT);
        let upright = 0.5 * (TOP + BOTTOM);
        format!(
            "<figure><figcaption><strong>{title}</strong> {legend}</figcaption><svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{title}\">{axes}{body}<path class=\"frame\" d=\"M{LEFT} {TOP}H{RIGHT}V{BOTTOM}H{LEFT}Z\"/><text class=\"axis\" text-anchor=\"middle\" x=\"{middle}\" y=\"{below}\">{x}</text><text class=\"axis\" text-anchor=\"middle\" transform=\"translate(11 {upright}) rotate(-90)\">{y}</text></svg></figure>\n",
            title = escaped(self.title),
            legend = self.legend,
            body = self.body,
            below = HEIGHT - 8.0,
            x = escaped(self.x.label),
            y = escaped(self.y.label),
        )
    }
}
