//! Places of strikes, and of what is heard.

use super::SolveError;
use crate::element::Discrete;
use crate::file::{Kind, Readout, ShapeFile};
use crate::gain::{self, Gain, Surface};
use crate::outline::{FlatSide, Outline, Point};

/// Number of positions of a strike if the file does not tell.
pub(super) const POSITIONS: usize = 9;
/// Share of the way to the rim at which the last position lies if the file has no path.
pub(super) const NEAR_RIM: f64 = 0.98;

/// Places of strikes, and what is heard.
#[derive(Clone, Debug)]
pub struct Places {
    kind: Kind,
    /// Places of strikes, with their direction in the plane of a sheet.
    strikes: Vec<(Point, [f64; 2])>,
    heard: Heard,
    /// Angle round the axis from the strike to what is heard.
    heard_rad: f64,
}

/// Mode's waves round the axis of a body of revolution.
#[derive(Clone, Copy, Debug)]
pub(super) struct Round {
    pub(super) waves: u32,
    pub(super) is_second: bool,
    /// True if an imperfection holds the waves in place: the strike lies between the two of a pair.
    pub(super) is_split: bool,
}

impl Round {
    /// Share of the mode's motion at an angle from the strike.
    fn share(self, angle_rad: f64) -> f64 {
        let between = if self.is_split && self.waves > 0 { std::f64::consts::FRAC_PI_4 } else { 0.0 };
        let phase = f64::from(self.waves) * angle_rad + between;
        if self.is_second { phase.sin() } else { phase.cos() }
    }
}

#[derive(Clone, Copy, Debug)]
enum Heard {
    Even,
    Velocity(Point, [f64; 2]),
    Pressure([f64; 3]),
}

impl Places {
    /// Places of a file.
    ///
    /// # Errors
    /// [`SolveError::NoPressure`] of a sheet.
    pub fn of(file: &ShapeFile, outline: &Outline) -> Result<Self, SolveError> {
        let kind = file.shape.kind;
        let count = file.strike.positions.unwrap_or(POSITIONS);
        let path = match &file.strike.path_m {
            Some(path) => path.iter().map(|point| flat(point)).collect(),
            None => default_path(kind, outline),
        };
        let is_flat = matches!(kind, Kind::Plate | Kind::Membrane);
        let direction = |given: &Option<Vec<f64>>, at: Point| match given.as_deref() {
            // Of a slanted strike a plate takes the part across it.
            Some(&[x, y, z]) if is_flat => [z / x.hypot(y).hypot(z).max(f64::MIN_POSITIVE), 0.0],
            None if is_flat => [1.0, 0.0],
            Some(given) => {
                let [x, y] = flat(given);
                let length = x.hypot(y).max(f64::MIN_POSITIVE);
                [x / length, y / length]
            }
            None => normal(outline, at),
        };
        let is_surface = file.strike.path_m.is_none() && kind == Kind::Revolve;
        let places = along(&path, count).into_iter();
        let places = places.map(|at| if is_surface { nearest(outline, at) } else { at });
        let strikes = places.map(|at| (at, direction(&file.strike.direction, at))).collect();
        let heard = match (file.sound.readout, file.sound.at_m.as_deref()) {
            (Readout::Velocity, Some(&([x, y] | [x, y, _]))) => {
                Heard::Velocity([x, y], direction(&file.sound.direction, [x, y]))
            }
            (Readout::Pressure, Some(&[x, y, z])) if matches!(kind, Kind::Plate | Kind::Membrane) => {
                Heard::Pressure([x, y, z])
            }
            (Readout::Pressure, _) => return Err(SolveError::NoPressure),
            _ => Heard::Even,
        };
        let heard_rad = match (kind, file.sound.at_m.as_deref()) {
            (Kind::Revolve, Some(&[_, _, degrees])) => degrees.to_radians(),
            _ => 0.0,
        };
        Ok(Self { kind, strikes, heard, heard_rad })
    }

    /// Places of strikes in the order of the positions, metres.
    pub(super) fn struck(&self) -> Vec<Point> {
        self.strikes.iter().map(|strike| strike.0).collect()
    }

    /// Point of the body that is heard, metres; `None` for other readouts.
    pub(super) fn heard_point(&self) -> Option<Point> {
        if let Heard::Velocity(at, _) = self.heard { Some(at) } else { None }
    }

    /// Gains of a mode at all positions; ω in rad/s, d in 1/s.
    pub(super) fn gains(
        &self,
        discrete: &Discrete,
        vector: &[f64],
        round: Round,
        omega: f64,
        decay_per_s: f64,
    ) -> Result<Vec<Gain>, SolveError> {
        let shape = |key: &'static str, at: Point, direction: [f64; 2]| {
            let value = discrete.value(vector, at).ok_or(SolveError::Outside { key, x: at[0], y: at[1] })?;
            Ok::<f64, SolveError>(match self.kind {
                Kind::Sheet => value[0] * direction[0] + value[1] * direction[1],
                Kind::Revolve => value[0] * direction[0] + value[2] * direction[1],
                Kind::Plate | Kind::Membrane | Kind::Solid => value[0] * direction[0],
            })
        };
        let [struck, heard_round] = [0.0, self.heard_rad].map(|angle| round.share(angle));
        let strike = |&(at, direction): &(Point, [f64; 2])| Ok(struck * shape("strike.path_m", at, direction)?);
        let strikes = self.strikes.iter().map(strike);
        let strikes = strikes.collect::<Result<Vec<f64>, SolveError>>()?;
        let gains = strikes.into_iter();
        Ok(match self.heard {
            Heard::Even => gains.map(gain::even).collect(),
            Heard::Velocity(at, direction) => {
                let heard = heard_round * shape("sound.at_m", at, direction)?;
                gains.map(|strike| gain::velocity(strike, heard, omega, decay_per_s)).collect()
            }
            Heard::Pressure(at_m) => {
                let pieces = pieces(discrete, vector);
                let surface = pieces.iter().map(|&(at_m, area_m2, value)| (Surface { at_m, area_m2 }, value));
                let unit = gain::pressure(1.0, surface, at_m, omega, decay_per_s);
                gains.map(|strike| Gain { sine: strike * unit.sine, cosine: strike * unit.cosine }).collect()
            }
        })
    }
}

/// Degree up to which integrals over an element are exact: a shape of order 4 and a wave of sound.
const DEGREE: usize = 8;

/// Place, area and value of a mode at the points of a quadrature over the body.
pub(super) fn pieces(discrete: &Discrete, vector: &[f64]) -> Vec<(Point, f64, f64)> {
    let nodes = &discrete.nodes;
    let samples = nodes.functions.samples(DEGREE);
    let of_triangle = |numbers: &Vec<usize>| {
        let values: Vec<f64> = numbers.iter().map(|&node| discrete.at_node(vector, node)[0]).collect();
        let positions: Vec<Point> = numbers.iter().filter_map(|&node| nodes.positions.get(node)).copied().collect();
        let piece = |sample: &crate::element::Sample| {
            let (mut at, mut value, mut by) = ([0.0; 2], 0.0, [[0.0; 2]; 2]);
            let functions = sample.values.iter().zip(&sample.derivatives);
            for ((factor, derivatives), (position, node)) in functions.zip(positions.iter().zip(&values)) {
                value += factor * node;
                for axis in 0..2 {
                    at[axis] += factor * position[axis];
                    by[axis][0] += derivatives[0] * position[axis];
                    by[axis][1] += derivatives[1] * position[axis];
                }
            }
            (at, sample.weight * (by[0][0] * by[1][1] - by[0][1] * by[1][0]), value)
        };
        samples.iter().map(piece).collect::<Vec<_>>()
    };
    nodes.triangles.iter().flat_map(of_triangle).collect()
}

/// Points evenly along a path.
pub(super) fn along<const N: usize>(path: &[[f64; N]], count: usize) -> Vec<[f64; N]> {
    let Some(&first) = path.first() else { return vec![] };
    let way = |pair: &[[f64; N]]| (0..N).map(|axis| (pair[1][axis] - pair[0][axis]).powi(2)).sum::<f64>().sqrt();
    let lengths: Vec<f64> = path.windows(2).map(way).collect();
    let whole: f64 = lengths.iter().sum();
    let point = |index: usize| {
        let mut rest = if count > 1 { whole * index as f64 / (count - 1) as f64 } else { 0.0 };
        for (pair, &length) in path.windows(2).zip(&lengths) {
            if rest <= length && length > 0.0 {
                let share = rest / length;
                return std::array::from_fn(|axis| pair[0][axis] + share * (pair[1][axis] - pair[0][axis]));
            }
            rest -= length;
        }
        path.last().copied().unwrap_or(first)
    };
    (0..count).map(point).collect()
}

/// Path of strikes without one in the file: from the middle to the rim, of a sheet along its
/// longest side.
fn default_path(kind: Kind, outline: &Outline) -> Vec<Point> {
    let sides = outline.sides();
    if kind == Kind::Revolve {
        return to_the_rim(&sides);
    }
    if kind == Kind::Sheet {
        let length = |side: &&FlatSide| distance(side.from, side.to);
        let longest = sides.iter().max_by(|a, b| length(a).total_cmp(&length(b)));
        let Some(side) = longest else { return vec![] };
        let middle = [0, 1].map(|axis| (side.from[axis] + side.to[axis]) / 2.0);
        return vec![middle, side.from];
    }
    let middle = innermost(outline);
    // Off the axes, where the modes of a symmetric body have their nodes.
    let to = [0.8_f64, 0.6];
    let [low, high] = outline.bounds().unwrap_or_default();
    let reach = distance(low, high);
    let (mut inside, mut outside) = (0.0, reach);
    let at = |far: f64| [middle[0] + far * to[0], middle[1] + far * to[1]];
    // The rim is where the way leaves the body first.
    let steps = 256;
    if let Some(step) = (1..=steps).find(|&step| !outline.contains(at(reach * f64::from(step) / f64::from(steps)))) {
        (inside, outside) =
            (reach * f64::from(step - 1) / f64::from(steps), reach * f64::from(step) / f64::from(steps));
    }
    for _ in 0..40 {
        let half = (inside + outside) / 2.0;
        if outline.contains(at(half)) { inside = half } else { outside = half }
    }
    vec![middle, at(NEAR_RIM * inside)]
}

/// Corners of the longest way along a profile from a point nearest the axis to the rim, without the
/// axis where there is such a way.
fn to_the_rim(sides: &[FlatSide]) -> Vec<Point> {
    let outer: Vec<Point> = sides.iter().filter(|side| side.ring == 0).map(|side| side.from).collect();
    let count = outer.len();
    let least = outer.iter().map(|at| at[0]).fold(f64::MAX, f64::min);
    let rim = (0..count).max_by(|&a, &b| outer[a][0].total_cmp(&outer[b][0])).unwrap_or(0);
    let way = |from: usize, step: usize| {
        let numbers = std::iter::successors(Some(from), |number| Some((number + step) % count));
        let before = numbers.take_while(|&number| number != rim);
        before.map(|number| outer[number]).chain(outer.get(rim).copied()).collect::<Vec<Point>>()
    };
    let starts = (0..count).filter(|&number| outer[number][0] - least <= 1e-9 * outer[rim][0]);
    let ways = starts.flat_map(|start| [way(start, 1), way(start, count - 1)]);
    let length = |way: &[Point]| {
        let has_axis = way.windows(2).any(|pair| pair[0][0] == 0.0 && pair[1][0] == 0.0);
        let length = way.windows(2).map(|pair| distance(pair[0], pair[1])).sum::<f64>();
        if has_axis { -length } else { length }
    };
    ways.max_by(|a, b| length(a).total_cmp(&length(b))).unwrap_or_default()
}

/// Point of an outline that lies nearest to a point.
fn nearest(outline: &Outline, at: Point) -> Point {
    let steps = 32;
    let sides = outline.sides();
    let places = sides.iter().flat_map(|side| (0..=steps).map(move |step| (side, f64::from(step) / f64::from(steps))));
    let far = |side: &FlatSide, share: f64| distance(side.point(share), at);
    let Some((side, share)) = places.min_by(|a, b| far(a.0, a.1).total_cmp(&far(b.0, b.1))) else { return at };
    let (mut low, mut high) = ((share - 1.0 / f64::from(steps)).max(0.0), (share + 1.0 / f64::from(steps)).min(1.0));
    for _ in 0..60 {
        let [a, b] = [(2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0];
        if far(side, a) <= far(side, b) { high = b } else { low = a }
    }
    side.point((low + high) / 2.0)
}

/// Point of a grid over the body that lies farthest from its rim.
fn innermost(outline: &Outline) -> Point {
    let [low, high] = outline.bounds().unwrap_or_default();
    let sides = outline.sides();
    let chords: Vec<[Point; 2]> = sides.iter().map(|side| [side.from, side.to]).collect();
    let clear = |at: Point| chords.iter().map(|&[from, to]| from_chord(at, from, to)).fold(f64::MAX, f64::min);
    let steps = 32;
    let grid = (1..steps).flat_map(|x| (1..steps).map(move |y| [x, y]));
    let points = grid.map(|[x, y]| {
        [
            low[0] + (high[0] - low[0]) * f64::from(x) / f64::from(steps),
            low[1] + (high[1] - low[1]) * f64::from(y) / f64::from(steps),
        ]
    });
    let inside = points.filter(|&at| outline.contains(at));
    inside.max_by(|&a, &b| clear(a).total_cmp(&clear(b))).unwrap_or(low)
}

/// First two of a point's coordinates.
fn flat(numbers: &[f64]) -> Point {
    [0, 1].map(|axis| numbers.get(axis).copied().unwrap_or(0.0))
}

/// Normal of the side that lies next to a point, out of the body.
fn normal(outline: &Outline, at: Point) -> [f64; 2] {
    let sides = outline.sides();
    let far = |side: &&FlatSide| from_chord(at, side.from, side.to);
    let Some(side) = sides.iter().min_by(|a, b| far(a).total_cmp(&far(b))) else { return [0.0, 1.0] };
    let along = [side.to[0] - side.from[0], side.to[1] - side.from[1]];
    let length = along[0].hypot(along[1]).max(f64::MIN_POSITIVE);
    [along[1] / length, -along[0] / length]
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Distance of a point from a chord.
fn from_chord(at: Point, from: Point, to: Point) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let square = (along[0] * along[0] + along[1] * along[1]).max(f64::MIN_POSITIVE);
    let share = ((at[0] - from[0]) * along[0] + (at[1] - from[1]) * along[1]) / square;
    let share = share.clamp(0.0, 1.0);
    distance(at, [from[0] + share * along[0], from[1] + share * along[1]])
}
