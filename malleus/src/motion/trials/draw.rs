//! Lines of each trial's path.

use std::f64::consts::{PI, TAU};

use super::drawing::Drawing;
use super::profile::Profile;
use super::scribble::Path;
use super::shape::{Shape, Trial, TrialError};
use crate::motion::normal::GRAVITY_M_PER_S2;
use crate::motion::path::Action;

/// Longest step between lines in seconds.
const MOST_STEP_S: f64 = 1e-3;
/// Longest motion in seconds: a file of 600 000 lines.
const MOST_S: f64 = 600.0;
/// Number of lines in the time in which a sine goes from one extreme to the other. The error of
/// the acceleration at the extremes is 0.6 (π/200)² = 0.015 % of it.
const LINES_A_TURN: f64 = 200.0;
/// Share of the gravity that moves a solid ball down an incline without sliding: the rest turns it.
const ROLLING: f64 = 5.0 / 7.0;
/// Time in seconds between the lift of a stroke and the touch of the next one. No tick ends in it
/// but by chance, and the tool is at rest there.
const BETWEEN_STROKES_S: f64 = 1e-6;

impl Trial {
    /// Draws the trial: a line a millisecond, or more where the path turns quickly.
    ///
    /// The steps are so fine that the acceleration that [`Motion`](crate::motion::Motion) reads is
    /// within 0.02 % of the path's own at the ends of strokes.
    ///
    /// # Errors
    /// [`TrialError`] for parameters out of their ranges, and for a path that is too fast.
    pub fn draw(&self) -> Result<Drawing, TrialError> {
        let drawing = draw(self)?;
        drawing.motion()?;
        Ok(drawing)
    }
}

fn draw(trial: &Trial) -> Result<Drawing, TrialError> {
    check("start", trial.start_s, (0.0..=3600.0).contains(&trial.start_s), "must be from 0 to 3600 seconds")?;
    for place in trial.place_m {
        check("at", place, (-1000.0..=1000.0).contains(&place), "must be from -1000 to 1000 metres")?;
    }
    match trial.shape {
        Shape::BackAndForth { length_m, period_s, strokes } => {
            let stroke_s = stroke(length_m, period_s, strokes)?;
            let x = |time_s: f64| 0.5 * length_m * (1.0 - (PI * time_s / stroke_s).cos());
            let seconds = stroke_s * f64::from(strokes);
            let steps = f64::from(strokes) * lines_in(stroke_s, stroke_s);
            scrape(trial, Span { from_s: 0.0, seconds, steps }, |time_s| [x(time_s), 0.0])
        }
        Shape::FourStrokes { length_m, period_s, strokes } => {
            let stroke_s = stroke(length_m, period_s, strokes)?;
            let mut contacts = Vec::new();
            for number in 0..strokes {
                let x = |time_s: f64| 0.5 * length_m * (1.0 - (PI * time_s / stroke_s).cos());
                let from_s = stroke_s * f64::from(number);
                let place = |time_s: f64| [length_m * f64::from(number) + x(time_s - from_s), 0.0];
                let span = Span { from_s, seconds: stroke_s, steps: lines_in(stroke_s, stroke_s) };
                let mut lines = lines(trial, span, place);
                if number > 0 {
                    let time_s = on_grid(trial.start_s + from_s + BETWEEN_STROKES_S);
                    lines[0] = (time_s, at(trial, place(time_s - trial.start_s)));
                }
                contacts.push(lines);
            }
            Ok(Drawing { action: Action::Scrape, contacts })
        }
        Shape::Circle { length_m, speed_m_per_s } => {
            let profile = steady(length_m, speed_m_per_s)?;
            let radius_m = length_m / TAU;
            let turn_s = profile.ramp_s.min(PI * radius_m / speed_m_per_s);
            scrape(trial, Span::whole(profile.seconds, turn_s), |time_s| {
                let (sine, cosine) = (profile.distance(time_s) / radius_m).sin_cos();
                [radius_m * (1.0 - cosine), -radius_m * sine]
            })
        }
        Shape::Line { length_m, speed_m_per_s } => {
            let profile = steady(length_m, speed_m_per_s)?;
            // The steps of the circle of this length: both have lines at equal times.
            let turn_s = profile.ramp_s.min(0.5 * length_m / speed_m_per_s);
            scrape(trial, Span::whole(profile.seconds, turn_s), |time_s| [profile.distance(time_s), 0.0])
        }
        Shape::Scribble { length_m, speed_m_per_s, seed } => {
            steady(length_m, speed_m_per_s)?;
            // The hand's own time: at speed 1 between start and end.
            let hand = Profile::over(length_m / speed_m_per_s, 1.0);
            let path = Path::new(seed);
            let scale = length_m / path.length(length_m / speed_m_per_s);
            scrape(trial, Span::whole(hand.seconds, hand.ramp_s), |time_s| {
                path.place(hand.distance(time_s)).map(|place| scale * place)
            })
        }
        Shape::Roll { length_m, speed_m_per_s, incline_deg } => roll(trial, length_m, speed_m_per_s, incline_deg),
    }
}

fn roll(trial: &Trial, length_m: f64, speed_m_per_s: f64, incline_deg: f64) -> Result<Drawing, TrialError> {
    check_length(length_m)?;
    let is_speed = speed_m_per_s == 0.0 || (1e-3..=10.0).contains(&speed_m_per_s);
    check("speed", speed_m_per_s, is_speed, "must be from 0.001 to 10 m/s, or 0")?;
    let is_incline = (-80.0..=80.0).contains(&incline_deg);
    check("incline", incline_deg, is_incline, "must be from -80 to 80 degrees, positive uphill")?;
    let acceleration = -ROLLING * GRAVITY_M_PER_S2 * incline_deg.to_radians().sin();
    if speed_m_per_s == 0.0 && acceleration <= 0.0 {
        return Err(TrialError::AtRest);
    }
    // Speed at the end of the incline, squared; below 0 if the ball stops before.
    let end_squared = speed_m_per_s * speed_m_per_s + 2.0 * acceleration * length_m;
    let seconds = if end_squared >= 0.0 {
        2.0 * length_m / (speed_m_per_s + end_squared.sqrt())
    } else {
        -2.0 * speed_m_per_s / acceleration
    };
    check_time(seconds)?;
    let place = |time_s: f64| [speed_m_per_s * time_s + 0.5 * acceleration * time_s * time_s, 0.0];
    let contacts = vec![lines(trial, Span::whole(seconds, seconds), place)];
    Ok(Drawing { action: Action::Roll, contacts })
}

/// Time in seconds of one of the strokes, whose parameters are checked.
fn stroke(length_m: f64, period_s: f64, strokes: u32) -> Result<f64, TrialError> {
    check_length(length_m)?;
    check("period", period_s, (0.002..=60.0).contains(&period_s), "must be from 0.002 to 60 seconds")?;
    check("strokes", f64::from(strokes), (1..=1000).contains(&strokes), "must be from 1 to 1000 strokes")?;
    let stroke_s = 0.5 * period_s;
    check_time(stroke_s * f64::from(strokes))?;
    Ok(stroke_s)
}

/// Profile over a length at a speed, which are checked.
fn steady(length_m: f64, speed_m_per_s: f64) -> Result<Profile, TrialError> {
    check_length(length_m)?;
    check("speed", speed_m_per_s, (1e-3..=10.0).contains(&speed_m_per_s), "must be from 0.001 to 10 m/s")?;
    let profile = Profile::over(length_m, speed_m_per_s);
    check_time(profile.seconds)?;
    Ok(profile)
}

fn check_length(length_m: f64) -> Result<(), TrialError> {
    check("length", length_m, (1e-3..=100.0).contains(&length_m), "must be from 0.001 to 100 metres")
}

fn check_time(seconds: f64) -> Result<(), TrialError> {
    if seconds <= MOST_S { Ok(()) } else { Err(TrialError::TooLong { seconds, most_s: MOST_S }) }
}

fn check(name: &'static str, value: f64, is_fine: bool, allowed: &'static str) -> Result<(), TrialError> {
    if is_fine { Ok(()) } else { Err(TrialError::Parameter { name, value, allowed }) }
}

/// Number of steps in a time of a path that goes from one extreme to the other in `turn_s`.
fn lines_in(seconds: f64, turn_s: f64) -> f64 {
    (seconds / MOST_STEP_S.min(turn_s / LINES_A_TURN)).ceil()
}

/// Part of a trial's time in equal steps, in seconds from the trial's beginning.
struct Span {
    from_s: f64,
    seconds: f64,
    /// Number of steps, a whole number.
    steps: f64,
}

impl Span {
    fn whole(seconds: f64, turn_s: f64) -> Self {
        Self { from_s: 0.0, seconds, steps: lines_in(seconds, turn_s) }
    }
}

fn scrape(trial: &Trial, span: Span, place: impl Fn(f64) -> [f64; 2]) -> Result<Drawing, TrialError> {
    Ok(Drawing { action: Action::Scrape, contacts: vec![lines(trial, span, place)] })
}

/// Lines of a path whose places are given at times from the trial's beginning.
fn lines(trial: &Trial, span: Span, place: impl Fn(f64) -> [f64; 2]) -> Vec<(f64, [f64; 2])> {
    let Span { from_s, seconds, steps } = span;
    let line = |index: u32| {
        let time_s = on_grid(trial.start_s + from_s + seconds * f64::from(index) / steps);
        // The last time may lie behind the end by its rounding. The path goes on there, or a ball's
        // last acceleration would be wrong.
        (time_s, at(trial, place(time_s - trial.start_s)))
    };
    (0..=steps as u32).map(line).collect()
}

/// Time on a grid of nanoseconds, whose decimals are short. The places are those at the rounded
/// times, so that rounding adds no noise to the accelerations.
fn on_grid(time_s: f64) -> f64 {
    (time_s * 1e9).round() / 1e9
}

/// Place from the trial's own, on a grid of 1e-15 m.
fn at(trial: &Trial, place: [f64; 2]) -> [f64; 2] {
    // Adding 0 turns -0 into 0.
    [0, 1].map(|axis| ((trial.place_m[axis] + place[axis]) * 1e15).round() / 1e15 + 0.0)
}
