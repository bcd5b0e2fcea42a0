//! Force of one contact that goes on: eq. 1 to 7, and that of a ball with it (eq. 19).

use super::plane::{Heading, weights_of};
use super::roll::{Roll, Rolling};
use super::slope::{Reading, Slope};
use super::smoothing::{Smoothing, rounded};
use super::surface::Surface;
use super::{TICK_FRAMES, ramp};
use crate::rate::SampleRate;

/// Seconds in which the force of a ball comes when it begins to move, and goes when it rests.
const GATE_S: f64 = 0.02;

/// Distance in points of the grid in which slope and height of the path are lost: 10 shortest
/// waves.
pub const LEAK_POINTS: f64 = 28.0;

/// Contact that goes on: a surface, what moves over it, and how, in SI units.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Surface.
    pub surface: Surface,
    /// Mass m_p of the scraper in kg.
    pub mass_kg: f64,
    /// Gain β1 and exponent β2 of the slope.
    pub slope: [f64; 2],
    /// Limit α at the largest and at the least normal force, in metres.
    pub alpha_m: [f64; 2],
    /// Exponent ζ with which α follows the normal force.
    pub alpha_exponent: f64,
    /// Standard deviation of the smoothing at the mean of both limits, in seconds.
    pub smoothing_s: f64,
    /// Ball, if the contact rolls.
    pub rolling: Option<Rolling>,
    /// Least and largest normal force in newtons; equal ones give the mean of both limits.
    pub normal_n: [f64; 2],
    /// Seed of the places on the surface.
    pub seed: u32,
}

/// Motion at the end of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Velocity along the surface's rows and across them, in m/s.
    pub velocity_m_per_s: [f32; 2],
    /// Normal force N in newtons; 0 or below lifts the scraper off.
    pub normal_n: f32,
}

/// Force of one contact, a tick at a time.
#[derive(Clone, Debug)]
pub struct Scraper {
    contact: Contact,
    rate: SampleRate,
    slope: Slope,
    smoothing: Smoothing,
    /// Speed at the end of the tick before the last.
    earlier: f32,
    heading: [f32; 2],
    velocity: [f32; 2],
    is_backwards: bool,
    speed: f32,
    alpha_m: Option<f64>,
    path_slope: f64,
    roll: Option<Roll>,
    gate: f64,
}

impl Scraper {
    /// Begins a contact at rest.
    pub fn new(contact: Contact, rate: SampleRate) -> Self {
        let [least_m, most_m] = contact.alpha_m;
        let deviation = contact.smoothing_s * most_m / (0.5 * (least_m + most_m)) * rate.hz();
        let smoothing = Smoothing::new(rounded(deviation));
        let weight_n = 0.5 * (contact.normal_n[0] + contact.normal_n[1]);
        Self {
            slope: Slope::new(contact.surface.clone(), contact.seed.wrapping_mul(0x9e37_79b9)),
            earlier: 0.0,
            smoothing,
            heading: [0.0; 2],
            velocity: [0.0; 2],
            is_backwards: false,
            speed: 0.0,
            alpha_m: None,
            path_slope: 0.0,
            roll: contact.rolling.map(|ball| Roll::new(ball, weight_n)),
            gate: 0.0,
            contact,
            rate,
        }
    }

    /// Frames by which the force comes after the motion.
    pub fn delay(&self) -> usize {
        self.smoothing.delay()
    }

    /// Goes on to a motion over a tick, and gives the force in newtons in each frame.
    pub fn render(&mut self, motion: Motion) -> [f64; TICK_FRAMES] {
        let before = self.speed;
        let before_heading = self.heading;
        self.speed = self.signed_speed(motion);
        let is_lifted = motion.normal_n <= 0.0;
        let is_resting = self.speed == 0.0 && before == 0.0;
        let target = if is_lifted || is_resting { 0.0 } else { 1.0 };
        let limit_m = self.limit_m(f64::from(motion.normal_n.max(0.0)));
        let from_m = self.alpha_m.unwrap_or(limit_m);
        self.alpha_m = Some(limit_m);
        // The points a frame are rounded as in the instrument: see the path's places.
        let frame = 1.0 / (self.contact.surface.grid_step_m as f32 * self.rate.hz() as f32);
        let points = [before * frame, self.speed * frame];
        let map = self.contact.surface.map.as_ref();
        let mean_m = 0.5 * (self.contact.alpha_m[0] + self.contact.alpha_m[1]);
        let deviation = rounded(self.contact.smoothing_s * 0.5 * (from_m + limit_m) / mean_m * self.rate.hz());
        let reading = Reading::of(points[0].abs().max(points[1].abs()), map.is_some(), deviation);
        let across = map.map_or(1.0, |map| 1.0 / (map.row_step_m as f32 * self.rate.hz() as f32));
        let heading = self.heading_over_tick(before_heading, motion, [frame, across]);
        let rises = self.slope.render((points, &heading), [from_m, limit_m], reading);
        let rises = self.smoothing.render(deviation, reading.variance(), rises);
        // The smoothing's rises are those of the tick before.
        let ends = if self.smoothing.delay() == 0 { [before, self.speed] } else { [self.earlier, before] };
        self.earlier = before;
        let speeds: Vec<f64> = ramp(f64::from(ends[0]), f64::from(ends[1])).collect();
        let change = if self.roll.is_some() { TICK_FRAMES as f64 / (GATE_S * self.rate.hz()) } else { 1.0 };
        let to = self.gate + (target - self.gate).clamp(-change, change);
        let gates: Vec<f64> = ramp(self.gate, to).collect();
        self.gate = to;
        let frame_s = 1.0 / self.rate.hz();
        let leak_m = LEAK_POINTS * self.contact.surface.grid_step_m;
        let leak = f64::from(0.5 * (ends[0] + ends[1])).abs() * frame_s / leak_m;
        let leak = leak.min(0.5);
        let [gain, exponent] = self.contact.slope;
        std::array::from_fn(|frame| {
            let (rise, speed) = (rises[frame], speeds[frame]);
            self.path_slope += rise - self.path_slope * leak;
            // Eq. 1: S'' v is the rise of the slope in a second.
            let vertical = self.contact.mass_kg * rise * self.rate.hz() * speed;
            let horizontal = gain * (speed * self.path_slope).abs().powf(exponent);
            let rolled = self.roll.as_mut().map_or(0.0, |roll| roll.force_n(speed, self.path_slope, leak, frame_s));
            (vertical + horizontal + rolled) * gates[frame]
        })
    }

    /// Motion over the plane from the last motion to this one, with the points a frame of a speed
    /// of 1 m/s. Rest has the direction of the motion before.
    fn heading_over_tick(&mut self, before: [f32; 2], motion: Motion, [along, across]: [f32; 2]) -> Heading {
        let (from, to) = (self.velocity, motion.velocity_m_per_s);
        self.velocity = to;
        let before = if before == [0.0; 2] { self.heading } else { before };
        Heading {
            points: [[from[0] * along, to[0] * along], [from[1] * across, to[1] * across]],
            directions: [weights_of(before), weights_of(self.heading)],
        }
    }

    /// Speed along the path: positive until the motion turns back on itself.
    fn signed_speed(&mut self, motion: Motion) -> f32 {
        let [x, y] = motion.velocity_m_per_s;
        if x * x + y * y > 0.0 {
            self.is_backwards ^= x * self.heading[0] + y * self.heading[1] < 0.0;
            self.heading = [x, y];
        }
        let speed = f64::from(x * x + y * y).sqrt() as f32;
        if self.is_backwards { -speed } else { speed }
    }

    /// Limit α at a normal force (eq. 6 and 7).
    fn limit_m(&self, normal_n: f64) -> f64 {
        let ([least_m, most_m], [mut least_n, mut most_n]) = (self.contact.alpha_m, self.contact.normal_n);
        let mut normal_n = normal_n;
        if let Some(roll) = &self.roll {
            normal_n *= roll.normal_share(self.speed < 0.0);
            least_n *= 1.0 - roll.ball.modulation;
            most_n *= 1.0 + roll.ball.modulation;
        }
        if most_n <= least_n {
            return 0.5 * (least_m + most_m);
        }
        let share = ((normal_n - least_n) / (most_n - least_n)).clamp(0.0, 1.0);
        most_m + share.powf(self.contact.alpha_exponent) * (least_m - most_m)
    }
}
