//! Force of one contact that goes on: `f = m S'' v² + β1 |v S'|^β2` (scraping-rolling eq. 1 to 7),
//! and that of a ball with it (eq. 19).

use super::kernel::roll::Frames;
use super::limit::Limits;
use super::motion::{MAX_SPEED_M_PER_S, Motion, MotionError};
use super::plane::{HeadingEnd, weights_of};
use super::power::Powers;
use super::ramp::{Ramp, fixed_from, power_of_two};
use super::roll::{Roll, Rolling, Units};
use super::scale::Gain;
use super::slope::{Ends, Reading, Slope};
use super::smoothing::{Smoothing, deviation_of};
use super::sum::Sum;
use super::work::Work;
use crate::SampleRate;
use crate::exponential;
use crate::fixed;
use crate::table::layout::{ObjectSurfaceRecord, RollRecord, ScrapeRecord};
use crate::table::{Kit, Pad, Surface};
use crate::time::TICK_FRAMES;

/// Seconds in which the force of a ball comes when it begins to move, and goes when it rests.
const GATE_S: f32 = 0.02;
/// Decay length of the path's slope and height in steps of the grid: 10 shortest waves.
///
/// Slopes do not fit together where the path hops to another place of the surface. Without a decay
/// each hop would throw the path far off.
const LEAK_STEPS: f32 = 28.0;
/// Largest rises of a frame in the unit of slopes.
const LARGEST_RISES: f32 = 4.0;
/// Most times that the unit of rises is halved: at 0.6 µm/s.
const MOST_HALVINGS: i32 = 24;

/// Contact that goes on: a surface, what moves over it, and how, in SI units.
#[derive(Clone, Copy, Debug)]
pub struct Contact<'k> {
    /// Surface.
    pub surface: Surface<'k>,
    /// Mass m_p of the scraper in kg.
    pub mass_kg: f32,
    /// Gain β1 and exponent β2 of the slope.
    pub slope: [f32; 2],
    /// Limit α at the largest and at the least normal force, in metres.
    pub alpha_m: [f32; 2],
    /// Exponent ζ with which α follows the normal force.
    pub alpha_exponent: f32,
    /// Standard deviation of the smoothing at the mean of both limits, in seconds.
    pub smoothing_s: f32,
    /// Ball, if the contact rolls.
    pub rolling: Option<Rolling>,
    /// Least and largest normal force in newtons; equal ones give the mean of both limits.
    pub normal_n: [f32; 2],
    /// Force in newtons that 1.0 on the force bus stands for: the object's `reference_force`,
    /// less the level of scrapes and rolls on it.
    pub reference_force_n: f32,
    /// Seed of the places on the surface.
    pub seed: u32,
}

impl<'k> Contact<'k> {
    /// Contact of a pad's striker with the surface of the pad's object, by a kit that
    /// [`Kit::check_surfaces`] has accepted.
    ///
    /// `None` if the object has no surface, the striker does not scrape, or, if `rolls`, does not
    /// roll.
    pub fn of(kit: &Kit<'k>, pad: usize, striker: usize, rolls: bool, normal_n: [f32; 2]) -> Option<Self> {
        let Records { pad_view, place, scrape, roll } = Records::of(kit, pad, striker, rolls)?;
        let surface = kit.surfaces().nth(place.surface.get().into())?;
        // A ball that rolls scrapes as far as it slips.
        let share = roll.map_or(1.0, |roll| roll.slip.get());
        Some(Self {
            surface,
            mass_kg: scrape.mass_kg.get() * share,
            slope: [scrape.slope_gain.get() * share, scrape.slope_exponent.get()],
            alpha_m: limits_m(scrape, surface.curvature_rms_per_m()),
            alpha_exponent: scrape.alpha_exponent.get(),
            smoothing_s: scrape.smoothing_s.get(),
            rolling: roll.map(Rolling::of),
            normal_n,
            reference_force_n: kit.object_of(pad_view)?.reference_force()
                / exponential::ratio_of_db(place.level_db.get().into()) as f32,
            seed: pad as u32,
        })
    }

    /// True if [`Contact::of`] gives a contact.
    pub fn is_possible(kit: &Kit<'_>, pad: usize, striker: usize, rolls: bool) -> bool {
        Records::of(kit, pad, striker, rolls).is_some()
    }
}

/// Number, or 0 in place of one below.
fn positive(number: f32) -> f32 {
    if number > 0.0 { number } else { 0.0 }
}

/// Records of a kit that a contact is made of.
struct Records<'k> {
    pad_view: Pad<'k>,
    place: &'k ObjectSurfaceRecord,
    scrape: &'k ScrapeRecord,
    roll: Option<&'k RollRecord>,
}

impl<'k> Records<'k> {
    fn of(kit: &Kit<'k>, pad: usize, striker: usize, rolls: bool) -> Option<Self> {
        let pad_view = kit.pads().nth(pad)?;
        let object = pad_view.object_index();
        let place = kit.object_surfaces().iter().find(|place| usize::from(place.object.get()) == object)?;
        let striker = pad_view.striker_indices().nth(striker)?;
        let scrape = kit.scrapes().iter().find(|scrape| usize::from(scrape.striker.get()) == striker)?;
        let roll = kit.rolls().iter().find(|roll| usize::from(roll.striker.get()) == striker);
        Some(Self { pad_view, place, scrape, roll: if rolls { Some(roll?) } else { None } })
    }
}

/// Limits α of a scraper in metres, on a surface of an rms curvature: 1/c and 5/c unless given.
fn limits_m(scrape: &ScrapeRecord, curvature_rms_per_m: f32) -> [f32; 2] {
    let own = |given: f32, times: f32| if given > 0.0 { given } else { times / curvature_rms_per_m };
    [own(scrape.alpha_min_m.get(), 1.0), own(scrape.alpha_max_m.get(), 5.0)]
}

/// Force of one contact, a tick at a time.
///
/// The output comes [`delay`](Self::delay) frames after the motion: the smoothing looks as far
/// ahead as it looks back. Equations: scraping-rolling eq. 1 to 7, and 15 to 19 for a ball.
///
/// Accuracy against the `f64` reference (`cargo test -p host-tests --test scrape -- --nocapture`):
///
/// - scrapes at 0.05 to 2 m/s: at least 113 dB; rolls: 109 dB;
/// - on maps: 113 dB, at speeds of up to an eighth of the shortest wave a frame.
///
/// Cost on a Cortex-M4F in cycles a frame (`cargo test -p host-tests --test on_chip scrape::
/// -- --nocapture`): 165 at 0.2 m/s, 221 at 0.9 m/s, 237 at 2 m/s; a ball 270; on a map of a
/// shortest wave of 62 µm 347 at 0.2 m/s, 528 at 0.35 m/s; at rest 7.
#[derive(Clone, Debug)]
pub struct Scraper<'k> {
    contact: Contact<'k>,
    rate: SampleRate,
    slope: Slope<'k>,
    smoothing: Smoothing,
    sum: Sum,
    roll: Option<Roll>,
    /// Slope of one unit, four times the largest rise of a frame.
    unit: f32,
    /// Velocity in m/s of the last tick that was not at rest.
    heading: [f32; 2],
    is_backwards: bool,
    /// Signed speeds in m/s at the ends of the last four ticks.
    speeds: [f32; 4],
    /// Motion over the plane at the end of the last tick, which maps need.
    heading_end: HeadingEnd,
    limits: Limits,
    /// Standard deviation of the smoothing in frames for the sum of two limits.
    smoothing_per_m: f32,
    alpha_m: f32,
    normal_n: f32,
    /// From m/s to points of the grid a frame: along a profile or the rows of a map, and across.
    steps: [f32; 2],
    /// Share of the force, 0 while lifted, Q30.
    gate: i32,
    is_first: bool,
}

impl<'k> Scraper<'k> {
    /// Begins a contact at rest.
    pub fn new(contact: Contact<'k>, rate: SampleRate) -> Self {
        let mut scraper = Self {
            contact,
            rate,
            slope: Slope::new(contact.surface),
            smoothing: Smoothing::off(),
            sum: Sum::none(),
            roll: None,
            unit: 0.0,
            heading: [0.0; 2],
            heading_end: HeadingEnd::default(),
            is_backwards: false,
            speeds: [0.0; 4],
            limits: Limits::new([0.0; 2], [0.0; 2], 1.0),
            smoothing_per_m: 0.0,
            alpha_m: 0.0,
            normal_n: 0.0,
            steps: [0.0; 2],
            gate: 0,
            is_first: true,
        };
        scraper.begin(contact);
        scraper
    }

    /// Begins another contact at rest, in the place of the one before: it needs little stack.
    pub fn begin(&mut self, contact: Contact<'k>) {
        let (surface, rate) = (contact.surface, self.rate);
        let [least_m, most_m] = contact.alpha_m;
        // Four times the largest rise of a frame: the limit of the curvature over the longest way.
        let unit = LARGEST_RISES * MAX_SPEED_M_PER_S / (rate.hz_f32() * least_m);
        self.smoothing_per_m = contact.smoothing_s * rate.hz_f32() / (least_m + most_m);
        let widest = deviation_of(self.smoothing_per_m * 2.0 * most_m);
        let [slope_gain, slope_exponent] = contact.slope;
        let force_n = contact.reference_force_n;
        let other = (slope_exponent != 1.0).then(|| {
            // The power is that of speed and slope over 8 units at the highest speed.
            let largest = f64::from(8.0 * MAX_SPEED_M_PER_S * unit);
            let scale = exponential::power(largest, slope_exponent.into()) as f32;
            (Powers::new(slope_exponent), Gain::new(slope_gain * scale / force_n, 27))
        });
        self.sum.begin(
            contact.mass_kg * rate.hz_f32() * unit / force_n,
            slope_gain * unit / force_n,
            other,
            1.0 / (rate.hz_f32() * LEAK_STEPS * surface.grid_step_m()),
        );
        let [least_n, most_n] = contact.normal_n;
        let units = Units { slope: unit, force_n, height_m: 32_768.0 * surface.unit_m(), rate };
        self.slope.begin(surface, contact.seed.wrapping_mul(0x9e37_79b9));
        self.smoothing.begin(widest);
        self.roll = contact.rolling.map(|ball| Roll::new(ball, 0.5 * (least_n + most_n), units));
        let shares = self.roll.as_ref().map_or([1.0; 2], Roll::normal_shares);
        let range_n = [least_n * shares[0], most_n * shares[1]];
        self.limits = Limits::new(contact.alpha_m, range_n, contact.alpha_exponent);
        (self.contact, self.unit) = (contact, unit);
        (self.heading, self.heading_end, self.is_backwards) = ([0.0; 2], HeadingEnd::default(), false);
        (self.speeds, self.alpha_m, self.normal_n) = ([0.0; 4], self.limits.mean_m(), 0.0);
        self.steps = [surface.grid_step_m(), surface.map().map_or(1.0, |map| map.row_step_m())]
            .map(|step_m| 1.0 / (step_m * rate.hz_f32()));
        (self.gate, self.is_first) = (0, true);
    }

    /// Ends the force at once.
    pub(crate) fn stop(&mut self) {
        (self.speeds, self.gate) = ([0.0; 4], 0);
        self.smoothing.stop();
    }

    /// Work of the last tick: of the slope, and taps that were derived and filtered with.
    pub(super) const fn work(&self) -> (Work, [u32; 2]) {
        (self.slope.work(), self.smoothing.work())
    }

    /// Contact whose force it makes.
    pub(crate) const fn contact(&self) -> &Contact<'k> {
        &self.contact
    }

    /// Frames by which the force comes after the motion.
    pub fn delay(&self) -> usize {
        self.smoothing.delay()
    }

    /// Normal force in newtons at the end of the last tick: that of the motion, times a ball's
    /// share where it rolls; 0 while lifted.
    pub fn normal_n(&self) -> f32 {
        self.normal_n
    }

    /// True if the force is 0 until the next motion.
    pub fn is_silent(&self) -> bool {
        self.speeds == [0.0; 4] && self.gate == 0 && self.smoothing.is_silent()
    }

    /// Goes on to a motion over a tick, and gives the force in each frame, Q4.27 of the reference
    /// force, saturated.
    ///
    /// # Errors
    /// [`MotionError`]; then nothing has moved.
    pub fn render(&mut self, motion: Motion, force: &mut [i32; TICK_FRAMES]) -> Result<(), MotionError> {
        motion.check()?;
        if motion.velocity_m_per_s == [0.0; 2] && self.is_silent() {
            // Nothing moves, and nothing rings.
            self.normal_n = positive(motion.normal_n);
            force.fill(0);
            return Ok(());
        }
        let [_, earliest, earlier, before] = self.speeds;
        let is_first_motion = self.heading == [0.0; 2];
        let speed = self.signed_speed(motion);
        let is_map = self.contact.surface.rows() > 1;
        let heading = if is_map { Some(self.heading_over_tick(is_first_motion, motion)) } else { None };
        self.speeds = [earliest, earlier, before, speed];
        let share = self.roll.as_ref().map_or(1.0, |roll| roll.normal_share(speed < 0.0));
        self.normal_n = positive(motion.normal_n) * share;
        let is_resting = speed == 0.0 && before == 0.0;
        let target = if motion.normal_n > 0.0 && !is_resting { 1 << 30 } else { 0 };
        let limit = self.limits.at(self.normal_n);
        let from = if self.is_first { limit } else { self.alpha_m };
        (self.alpha_m, self.is_first) = (limit, false);
        let [along, _] = self.steps;
        let ends = Ends { steps: [before * along, speed * along], alpha_m: [from, limit], heading };
        let deviation = deviation_of(self.smoothing_per_m * (from + limit));
        let largest = if ends.steps[0].abs() > ends.steps[1].abs() { ends.steps[0].abs() } else { ends.steps[1].abs() };
        let reading = Reading::of(largest, is_map, deviation);
        let halvings = self.halvings();
        let unit = self.unit * power_of_two(-(halvings as i32));
        self.slope.render(&ends, reading, unit, self.smoothing.room(halvings));
        self.smoothing.set(deviation, reading.variance());
        self.smoothing.render(speed == 0.0 && before == 0.0, force);
        self.add_up(halvings, force);
        self.open(target, force);
        Ok(())
    }

    /// Number of times that the rises' unit can be halved: the rises of all ticks that the
    /// smoothing sees must have room.
    fn halvings(&self) -> u32 {
        // Numbers from 0 on have the order of their bits.
        let largest = self.speeds.iter().fold(0, |largest: u32, speed| largest.max(speed.abs().to_bits()));
        // The exponent of the ratio to the highest speed is that of both, one less where the
        // mantissa of the highest speed is the smaller one: the difference borrows it.
        let ratio = MAX_SPEED_M_PER_S.to_bits() as i32 - largest as i32;
        (ratio >> 23).clamp(0, MOST_HALVINGS) as u32
    }

    /// Turns smoothed rises of the slope into force.
    fn add_up(&mut self, halvings: u32, force: &mut [i32; TICK_FRAMES]) {
        let [_, earlier, before, speed] = self.speeds;
        // The smoothing's rises are those of the tick before.
        let speeds = if self.smoothing.delay() == 0 { [before, speed] } else { [earlier, before] };
        let weights = self.sum.weights(speeds, halvings);
        match &mut self.roll {
            Some(roll) => {
                let mut frames = Frames::NONE;
                self.sum.render(weights, speeds, force, Some(&mut frames.slopes));
                roll.render(speeds, weights.less, &mut frames, force);
            }
            None => self.sum.render(weights, speeds, force, None),
        }
    }

    /// Opens or shuts the gate.
    fn open(&mut self, target: i32, force: &mut [i32; TICK_FRAMES]) {
        if (self.gate, target) == (1 << 30, 1 << 30) {
            return;
        }
        let change = match &self.roll {
            Some(_) => fixed_from(TICK_FRAMES as f32 / (GATE_S * self.rate.hz_f32()), 30),
            None => 1 << 30,
        };
        let to = (target - self.gate).min(change).max(-change) + self.gate;
        let mut gate = Ramp::new([self.gate, to]);
        force.iter_mut().for_each(|force| *force = fixed::times_q31(*force, gate.next()) << 1);
        self.gate = to;
    }

    /// Motion over the plane at both ends of a tick. Rest has the direction of the motion before;
    /// the first motion has its own from its begin on.
    fn heading_over_tick(&mut self, is_first_motion: bool, motion: Motion) -> [HeadingEnd; 2] {
        let (mut from, velocity) = (self.heading_end, motion.velocity_m_per_s);
        let is_resting = velocity == [0.0; 2];
        let directions = if is_resting { from.directions } else { weights_of(velocity) };
        if is_first_motion {
            from.directions = directions;
        }
        let [along, across] = self.steps;
        self.heading_end = HeadingEnd { points: [velocity[0] * along, velocity[1] * across], directions };
        [from, self.heading_end]
    }

    /// Speed along the path: positive until the motion turns back on itself.
    fn signed_speed(&mut self, motion: Motion) -> f32 {
        let [x, y] = motion.velocity_m_per_s;
        let square = x * x + y * y;
        if square > 0.0 {
            let [before_x, before_y] = self.heading;
            self.is_backwards ^= x * before_x + y * before_y < 0.0;
            self.heading = [x, y];
        }
        let speed = match [x, y] {
            [x, 0.0] => x.abs(),
            [0.0, y] => y.abs(),
            _ => {
                // Rounded to the nearest number, so that places stay where they should be over long
                // paths.
                crate::square_root::rounded_root(square)
            }
        };
        let speed = if speed < MAX_SPEED_M_PER_S { speed } else { MAX_SPEED_M_PER_S };
        if self.is_backwards { -speed } else { speed }
    }
}
