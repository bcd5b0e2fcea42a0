//! Section `[object.dynamic_filter]` of docs/kit-format.md, and the hand on the filter.

use std::f64::consts::PI;

use toml::Table;

use crate::noise::Generator;
use crate::text::{number, tables, word};

/// Product of the hand's factors below which the filter falls silent.
const SILENT: f64 = 1.0 / 1_048_576.0;

/// Dynamic filter of a pad.
pub(crate) struct Filter {
    fs: f64,
    pub(crate) through: bool,
    generator: Generator,
    exciter: Option<Exciter>,
    path: Vec<Breakpoint>,
    loops: Vec<Loop>,
    /// Sample at which the path began; `None` before the first strike.
    start: Option<usize>,
    /// Noise level of the strike.
    noise: f64,
    /// Share of the noise level that the hand has left.
    noise_left: f64,
    states: States,
    /// All samples s so far, as the hand has left them.
    line: Vec<f64>,
    /// Product of the hand's factors; `None` if the filter is silent under the hand.
    hand: Option<f64>,
}

struct Breakpoint {
    time: f64,
    noise: f64,
    law: Law,
    values: [f64; 5],
    /// Noise level times the root of the filter's impulse energy.
    level: f64,
    /// Radius of the slowest pole.
    radius: f64,
}

/// Set of values that are linear between breakpoints.
#[derive(Clone, Copy)]
enum Law {
    /// First order: a1, b0, b1.
    First,
    /// Second order with conjugate poles: p, γ, d.
    Conjugate,
    /// Second order with real poles: p1, p2, α, β, d.
    Real,
}

/// States of the filter after the last sample: its input e, and s, z, or z1 and z2.
#[derive(Clone, Copy, Default)]
struct States {
    e: f64,
    z: [f64; 2],
}

impl Filter {
    pub(crate) fn new(object: &Table, stream: u32, fs: f64) -> Option<Self> {
        let table = object.get("dynamic_filter")?.as_table()?;
        let rho = fs / number(table, "rate_hz", 48000.0);
        Some(Self {
            fs,
            through: word(table, "modes", "beside") == "through",
            generator: Generator::new(table.get("seed").map_or(0, |seed| seed.as_integer().unwrap() as u32), stream),
            exciter: table.get("exciter").map(|exciter| Exciter::new(exciter.as_table().unwrap(), fs)),
            path: tables(table, "path").iter().map(|point| Breakpoint::new(point, rho)).collect(),
            loops: tables(table, "loops").iter().map(|table| Loop::new(table, fs)).collect(),
            start: None,
            noise: 0.0,
            noise_left: 1.0,
            states: States::default(),
            line: Vec::new(),
            hand: Some(1.0),
        })
    }

    /// Starts the path at sample n; `level` is the strike's peak force over the reference force.
    pub(crate) fn strike(&mut self, n: usize, level: f64, table: &Table) {
        self.start = Some(n);
        self.noise = level * (self.fs / number(table, "rate_hz", 48000.0)).sqrt();
        self.noise_left = 1.0;
        self.hand = Some(1.0);
        if let Some(exciter) = &mut self.exciter {
            exciter.strike(level);
        }
    }

    /// Notes that a hand comes or goes; a choke of a choked pad is neither.
    pub(crate) fn hand(&mut self) {
        self.hand = Some(1.0);
    }

    /// Computes sample n; `hand_per_s` is the hand's decay rate, 0 without a hand.
    pub(crate) fn play(&mut self, n: usize, modes: f64, hand_per_s: f64) -> f64 {
        if hand_per_s > 0.0 && n.is_multiple_of(32) && self.hand.is_some_and(|product| product < SILENT) {
            if self.time(n).is_some() {
                self.generator.start_anew();
            }
            self.scale(0.0);
            (self.hand, self.start) = (None, None);
        }
        let noise = self.excitation(n);
        let (law, values) = self.coefficients(n);
        let e = noise + modes + self.loops.iter_mut().map(|one| one.play(&self.line)).sum::<f64>();
        let s = self.states.play(law, values, e);
        self.line.push(s);
        if hand_per_s > 0.0
            && let Some(product) = self.hand
        {
            let kappa = self.kappa(n, hand_per_s);
            self.hand = Some(product * kappa);
            self.scale(kappa);
        }
        s
    }

    /// Time from the strike to sample n in seconds; `None` if the path is over.
    fn time(&self, n: usize) -> Option<f64> {
        let last = self.path.last().unwrap().time;
        let samples = n - self.start?;
        ((samples as f64) < (last * self.fs).ceil()).then_some(samples as f64 / self.fs)
    }

    /// Piece of the path that holds a time, and the time's place in it from 0 to 1.
    fn piece(&self, time: f64) -> Option<(&[Breakpoint], f64)> {
        let piece = self.path.windows(2).find(|piece| (piece[0].time..piece[1].time).contains(&time))?;
        Some((piece, (time - piece[0].time) / (piece[1].time - piece[0].time)))
    }

    /// Noise behind the exciter.
    fn excitation(&mut self, n: usize) -> f64 {
        let piece = self.time(n).and_then(|time| self.piece(time));
        let level = piece.and_then(|(piece, x)| {
            let silent = piece[0].noise == 0.0 && piece[1].noise == 0.0;
            (!silent).then_some(between(piece[0].noise, piece[1].noise, x))
        });
        let noise = level.map_or(0.0, |level| self.noise * self.noise_left * level * self.generator.draw());
        self.exciter.as_mut().map_or(noise, |exciter| exciter.play(noise))
    }

    fn coefficients(&self, n: usize) -> (Law, [f64; 5]) {
        let last = self.path.last().unwrap();
        let piece = self.time(n).and_then(|time| self.piece(time));
        let values = piece.map_or(last.values, |(piece, x)| {
            std::array::from_fn(|k| between(piece[0].values[k], piece[1].values[k], x))
        });
        (last.law, values)
    }

    /// Level and radius at sample n, linear between breakpoints.
    fn level(&self, n: usize) -> (f64, f64) {
        let piece = self.time(n).and_then(|time| self.piece(time));
        piece.map_or((0.0, self.path.last().unwrap().radius), |(piece, x)| {
            (between(piece[0].level, piece[1].level, x), between(piece[0].radius, piece[1].radius, x))
        })
    }

    /// Factor by which the hand damps the states from sample n to n + 1.
    fn kappa(&self, n: usize, hand_per_s: f64) -> f64 {
        let hand = (-hand_per_s / self.fs).exp();
        let ((now, radius), (next, _)) = (self.level(n), self.level(n + 1));
        let quotient = if now > 0.0 { next / now } else { f64::from(next > 0.0) };
        let own = if self.loops.is_empty() { quotient.max(radius).min(1.0) } else { 1.0 };
        (hand / own).min(1.0)
    }

    /// Multiplies all states and all later noise by a factor.
    fn scale(&mut self, kappa: f64) {
        self.noise_left *= kappa;
        self.states.e *= kappa;
        self.states.z = self.states.z.map(|z| z * kappa);
        let longest = self.loops.iter().map(|one| one.delay + 2).max().unwrap_or(0);
        self.line.iter_mut().rev().take(longest).for_each(|s| *s *= kappa);
        self.loops.iter_mut().for_each(|one| one.y = one.y.map(|y| y * kappa));
        if let Some(exciter) = &mut self.exciter {
            exciter.low.0 = exciter.low.0.map(|c| c * kappa);
            exciter.high.0 = exciter.high.0.map(|c| c * kappa);
        }
    }
}

fn between(a: f64, b: f64, x: f64) -> f64 {
    a * (1.0 - x) + b * x
}

impl Breakpoint {
    fn new(table: &Table, rho: f64) -> Self {
        let b0 = number(table, "b0", 0.0);
        let first = !table.contains_key("a2");
        let mut a = vec![1.0, number(table, "a1", 0.0)];
        let mut b = vec![b0, number(table, "b1", b0)];
        if !first {
            a.push(number(table, "a2", 0.0));
            b.push(number(table, "b2", 0.0));
        }
        let (a, b) = (carried_over(&a, rho), carried_over(&b, rho));
        let b = b.iter().map(|b| b / a[0]).collect::<Vec<_>>();
        let a = a.iter().map(|x| x / a[0]).collect::<Vec<_>>();
        let n1 = b[1] - a[1] * b[0];
        let (law, values, radius) = if first {
            (Law::First, [a[1], b[0], b[1], 0.0, 0.0], a[1].abs())
        } else {
            let n2 = b[2] - a[2] * b[0];
            let root = (a[1] * a[1] - 4.0 * a[2]).abs().sqrt() / 2.0;
            if a[1] * a[1] < 4.0 * a[2] {
                let p = [-a[1] / 2.0, root];
                (Law::Conjugate, [p[0], p[1], n1, -(n2 + n1 * p[0]) / p[1], b[0]], p[0].hypot(p[1]))
            } else {
                let p = [-a[1] / 2.0 + root, -a[1] / 2.0 - root];
                (Law::Real, [p[0], p[1], n1, n2 + p[1] * n1, b[0]], p[0].abs().max(p[1].abs()))
            }
        };
        let noise = number(table, "noise", 1.0);
        let level = noise * impulse_energy(law, values, radius).sqrt();
        Self { time: number(table, "time_s", 0.0), noise, law, values, level, radius }
    }
}

/// Carries a polynomial c0 + c1/z + ... over to another rate.
///
/// 1/z is replaced by ((1 - ρ) + (1 + ρ)/z) / ((1 + ρ) + (1 - ρ)/z), and the denominator is left
/// out.
fn carried_over(polynomial: &[f64], rho: f64) -> Vec<f64> {
    let order = polynomial.len() - 1;
    let (upper, lower) = ([1.0 - rho, 1.0 + rho], [1.0 + rho, 1.0 - rho]);
    let mut sum = vec![0.0; order + 1];
    for (k, coefficient) in polynomial.iter().enumerate() {
        let mut product = vec![*coefficient];
        for factor in 0..order {
            let by = if factor < k { upper } else { lower };
            let mut next = vec![0.0; product.len() + 1];
            for (place, value) in product.iter().enumerate() {
                next[place] += value * by[0];
                next[place + 1] += value * by[1];
            }
            product = next;
        }
        sum.iter_mut().zip(product).for_each(|(sum, product)| *sum += product);
    }
    sum
}

/// Energy Σ h² of the impulse response of a breakpoint's filter.
fn impulse_energy(law: Law, values: [f64; 5], radius: f64) -> f64 {
    let mut states = States::default();
    let length = 16 + (30.0 / (1.0 - radius)) as usize;
    (0..length).map(|n| states.play(law, values, f64::from(n == 0)).powi(2)).sum()
}

impl States {
    fn play(&mut self, law: Law, v: [f64; 5], e: f64) -> f64 {
        let States { e: e1, z } = *self;
        self.e = e;
        match law {
            Law::First => {
                let s = v[1] * e + v[2] * e1 - v[0] * z[0];
                self.z = [s, 0.0];
                s
            }
            Law::Conjugate => {
                self.z = [v[0] * z[0] - v[1] * z[1] + v[2] * e1, v[0] * z[1] + v[1] * z[0] + v[3] * e1];
                self.z[0] + v[4] * e
            }
            Law::Real => {
                self.z = [v[0] * z[0] + e1, v[1] * z[1] + v[3] * z[0]];
                v[4] * e + v[2] * self.z[0] + self.z[1]
            }
        }
    }
}

struct Loop {
    delay: usize,
    c: [f64; 4],
    y: [f64; 2],
}

impl Loop {
    fn new(table: &Table, fs: f64) -> Self {
        let (middle, width) = (number(table, "frequency_hz", 0.0), number(table, "bandwidth_hz", 0.0));
        let time = number(table, "delay_s", 0.0) * fs;
        let omega = 2.0 * PI * middle / fs;
        let (sin, cos) = omega.sin_cos();
        let tau = sin * width / (2.0 * middle);
        let (c3, c4) = (-2.0 * cos / (1.0 + tau), (1.0 - tau) / (1.0 + tau));
        let (re, im) = (1.0 + c3 * cos + c4 * (2.0 * omega).cos(), -c3 * sin - c4 * (2.0 * omega).sin());
        let gain = number(table, "gain", 0.0);
        let (turn_sin, turn_cos) = (-omega * time.fract()).sin_cos();
        let w = [gain * (turn_cos * re - turn_sin * im), gain * (turn_cos * im + turn_sin * re)];
        let c1 = -w[1] / sin;
        Self { delay: time as usize, c: [w[0] - c1 * cos, c1, c3, c4], y: [0.0; 2] }
    }

    /// Computes the next sample from all earlier samples s.
    fn play(&mut self, line: &[f64]) -> f64 {
        let s = |delay: usize| line.len().checked_sub(delay).map_or(0.0, |place| line[place]);
        let y =
            self.c[0] * s(self.delay) + self.c[1] * s(self.delay + 1) - self.c[2] * self.y[0] - self.c[3] * self.y[1];
        self.y = [y, self.y[0]];
        y
    }
}

struct Exciter {
    edges_hz: [f64; 2],
    exponent: f64,
    fs: f64,
    low: Section,
    high: Section,
    /// Coefficients of the band; `None` before the first strike.
    band: Option<Band>,
}

struct Band {
    narrow: bool,
    inputs: [f64; 2],
    low: [f64; 2],
    high: [f64; 2],
}

struct Section([f64; 2]);

impl Exciter {
    fn new(table: &Table, fs: f64) -> Self {
        let edges_hz = [number(table, "low_hz", 0.0), number(table, "high_hz", 0.0)];
        let exponent = number(table, "exponent", 0.0);
        Self { edges_hz, exponent, fs, low: Section([0.0; 2]), high: Section([0.0; 2]), band: None }
    }

    fn strike(&mut self, level: f64) {
        let (fs, m) = (self.fs, level.max(2f64.powi(-31)).powf(self.exponent));
        let high = (self.edges_hz[1] * m).max(0.0002 * fs).min(0.49 * fs);
        let low = (self.edges_hz[0] * m).max(0.0001 * fs).min(high / 1.05);
        let (a, b) = ((PI * low / fs).tan(), (PI * high / fs).tan());
        let (width, square) = (b - a, a * b);
        // Its square is h² = B² (-1 + i)²/8 = -i B²/4.
        let h = [-width / 8f64.sqrt(), width / 8f64.sqrt()];
        let root = square_root([-square, -width * width / 4.0]);
        // The coefficients g and k of a pole.
        let section = |pole: [f64; 2]| {
            let g = pole[0].hypot(pole[1]);
            [g, -2.0 * pole[0] / g]
        };
        let high = section([h[0] - root[0], h[1] - root[1]]);
        let low = section([h[0] + root[0], h[1] + root[1]]);
        let narrow = width * width <= square;
        let inputs = if narrow { [width / square.sqrt(); 2] } else { [1.0, (width / high[0]).powi(2)] };
        self.band = Some(Band { narrow, inputs, low, high });
    }

    fn play(&mut self, x: f64) -> f64 {
        let Some(band) = &self.band else { return 0.0 };
        let x = x * band.inputs[0];
        let (v1, v2) = self.low.play(x, band.low);
        let low = if band.narrow { v1 } else { x - band.low[1] * v1 - v2 };
        let (v1, v2) = self.high.play(low * band.inputs[1], band.high);
        if band.narrow { v1 } else { v2 }
    }
}

impl Section {
    fn play(&mut self, x: f64, [g, k]: [f64; 2]) -> (f64, f64) {
        let [c1, c2] = self.0;
        let v1 = (c1 + g * (x - c2)) / (1.0 + g * (g + k));
        let v2 = c2 + g * v1;
        self.0 = [2.0 * v1 - c1, 2.0 * v2 - c2];
        (v1, v2)
    }
}

/// Square root whose real part is 0 or more.
fn square_root([re, im]: [f64; 2]) -> [f64; 2] {
    let size = re.hypot(im);
    let root = ((size + re) / 2.0).sqrt();
    [root, ((size - re) / 2.0).sqrt().copysign(im)]
}
