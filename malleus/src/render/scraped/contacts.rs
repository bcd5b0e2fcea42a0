//! Force of each contact of a motion, by the instrument's scraper or by the reference's.

use dsp_core::SampleRate;
use dsp_core::scrape::{Contact, Scraper};
use dsp_core::table::Kit;
use dsp_core::time::TICK_FRAMES;

use super::error::ScrapedError;
use crate::motion::normal::{Grip, NormalForce, NormalRange};
use crate::motion::{self, Action, Motion, State};

/// Program that makes the force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Renderer {
    /// `dsp-core`, in fixed point.
    Instrument,
    /// `reference`, in `f64`.
    Reference,
}

/// Force of one contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Number of the pad.
    pub pad: u8,
    /// Number of the striker on the pad.
    pub striker: u8,
    /// First frame of the force.
    pub first_frame: usize,
    /// Force in newtons, frame by frame.
    pub force_n: Vec<f64>,
    /// Place along the object at the end of each tick, 0 to 1.
    pub along: Vec<f64>,
    /// Force in newtons that 1.0 on the force bus stands for.
    pub reference_force_n: f64,
}

/// Motion and force in each frame, in step: the motion is shown when its force comes out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Force on the pad in newtons.
    pub force_n: Vec<f64>,
    /// Normal force in newtons; 0 while nothing touches.
    pub normal_n: Vec<f64>,
    /// Speed in m/s.
    pub speed_m_per_s: Vec<f64>,
    /// Distance in metres since the motion began.
    pub distance_m: Vec<f64>,
}

/// Forces of a motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scraped {
    /// Force of each contact.
    pub sources: Vec<Source>,
    /// All contacts together over time.
    pub trace: Trace,
}

/// Settings of a contact beside the motion's own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    range: NormalRange,
    normal: NormalForce,
    /// True if the normal force counts as constant.
    is_constant: bool,
}

impl Held {
    /// Least and largest normal force in newtons.
    pub(super) fn normal_n(&self) -> [f32; 2] {
        if self.is_constant { [1.0; 2] } else { [self.range.least_n as f32, self.range.most_n as f32] }
    }

    /// Motion at a state; without one the striker is lifted.
    pub(super) fn moved(&self, state: Option<&State>) -> dsp_core::scrape::Motion {
        let Some(state) = state else { return dsp_core::scrape::Motion::default() };
        let normal_n = if self.is_constant { 1.0 } else { self.normal.at(state) as f32 };
        dsp_core::scrape::Motion { velocity_m_per_s: state.velocity_m_per_s.map(|v| v as f32), normal_n }
    }
}

/// Renders the force of a motion.
///
/// The limits α of a striker stand for its least and its largest normal force on that pad in the
/// whole motion (scraping-rolling eq. 7). `is_constant` leaves the normal force out: α stays at its
/// mean while the striker touches. `progress` gets the number of frames that are done.
///
/// # Errors
/// [`ScrapedError`].
pub fn render(
    motion: &Motion,
    kit: &Kit<'_>,
    rate: SampleRate,
    (renderer, is_constant): (Renderer, bool),
    mut progress: impl FnMut(usize),
) -> Result<Scraped, ScrapedError> {
    kit.check_surfaces()?;
    let mut scraped = Scraped::default();
    let end = (motion.end_s() * rate.hz()) as usize + 4 * TICK_FRAMES;
    let trace = &mut scraped.trace;
    for numbers in [&mut trace.force_n, &mut trace.normal_n, &mut trace.speed_m_per_s, &mut trace.distance_m] {
        numbers.resize(end.next_multiple_of(TICK_FRAMES), 0.0);
    }
    let mut way_m = 0.0;
    for index in 0..motion.contacts().len() {
        let held = held(motion, kit, index, is_constant)?;
        let source = contact(motion, kit, rate, (index, renderer, held), (&mut scraped.trace, &mut way_m))?;
        progress(source.first_frame + source.force_n.len());
        scraped.sources.push(source);
    }
    Ok(scraped)
}

/// Grip of a contact's striker, and the range of its normal force over the whole motion.
pub(super) fn held(motion: &Motion, kit: &Kit<'_>, index: usize, is_constant: bool) -> Result<Held, ScrapedError> {
    let contact = &motion.contacts()[index];
    let number = kit.pads().nth(contact.pad.into()).and_then(|pad| pad.striker_indices().nth(contact.striker.into()));
    let scrape =
        number.and_then(|number| kit.scrapes().iter().find(|scrape| usize::from(scrape.striker.get()) == number));
    let Some(scrape) = scrape else {
        return Err(ScrapedError::DoesNotScrape { pad: pad_name(kit, contact), striker: striker_name(kit, contact) });
    };
    let grip = Grip {
        mass_kg: scrape.mass_kg.get().into(),
        tilt_rad: scrape.tilt_rad.get().into(),
        friction: scrape.friction.get().into(),
    };
    let normal =
        NormalForce::new(&grip).map_err(|error| ScrapedError::Grip { striker: striker_name(kit, contact), error })?;
    let same = motion.contacts().iter().enumerate().filter(|(_, other)| {
        (other.pad, other.striker, other.action) == (contact.pad, contact.striker, contact.action)
    });
    let range = same.filter_map(|(other, _)| normal.range(motion, other)).reduce(NormalRange::with);
    let range = range.unwrap_or(NormalRange { least_n: 0.0, most_n: 0.0 });
    Ok(Held { range, normal, is_constant })
}

pub(super) fn pad_name(kit: &Kit<'_>, contact: &motion::Contact) -> String {
    kit.pads().nth(contact.pad.into()).map_or(String::new(), |pad| pad.name().to_owned())
}

fn striker_name(kit: &Kit<'_>, contact: &motion::Contact) -> String {
    let number = kit.pads().nth(contact.pad.into()).and_then(|pad| pad.striker_indices().nth(contact.striker.into()));
    number.and_then(|number| kit.strikers().nth(number)).map_or(String::new(), |striker| striker.name().to_owned())
}

/// Renders one contact, and adds it to the trace.
fn contact(
    motion: &Motion,
    kit: &Kit<'_>,
    rate: SampleRate,
    (index, renderer, held): (usize, Renderer, Held),
    (trace, way_m): (&mut Trace, &mut f64),
) -> Result<Source, ScrapedError> {
    let touch = &motion.contacts()[index];
    let mut contact = described(kit, touch, held.normal_n())?;
    // Each touch begins at a place of its own, as in an engine.
    contact.seed = u32::from(touch.pad).wrapping_add(256 * index as u32);
    let reference_force_n = f64::from(contact.reference_force_n);
    let [length_m, _] = object_size_m(kit, touch);
    let mut scraper = Scraper::new(contact, rate);
    let mut twin = (renderer == Renderer::Reference).then(|| {
        let (numerator, denominator) = rate.ratio();
        reference::scrape::Scraper::new(
            super::super::reference::contact(&contact),
            reference::SampleRate { numerator, denominator },
        )
    });
    let first_tick = (touch.touch_s * rate.hz() / TICK_FRAMES as f64) as usize;
    let mut reader = motion.reader();
    let mut source = Source {
        pad: touch.pad,
        striker: touch.striker,
        first_frame: first_tick * TICK_FRAMES,
        force_n: Vec::new(),
        along: Vec::new(),
        reference_force_n,
    };
    let delay = scraper.delay();
    let (mut before, mut along) = ([0.0_f64; 2], 0.5);
    for tick in first_tick.. {
        let time_s = ((tick + 1) * TICK_FRAMES) as f64 / rate.hz();
        let state = reader.at(time_s).filter(|state| state.contact == index);
        let motion = held.moved(state.as_ref());
        if let Some(state) = &state {
            along = along_object(state, length_m);
        }
        let mut frames = [0; TICK_FRAMES];
        scraper.render(motion, &mut frames).map_err(|error| ScrapedError::Motion { time_s, error })?;
        let newtons = frames.map(|force| f64::from(force) / f64::from(dsp_core::fixed::ONE_Q27) * reference_force_n);
        let newtons = match &mut twin {
            None => newtons,
            Some(twin) => twin.render(reference::scrape::Motion {
                velocity_m_per_s: motion.velocity_m_per_s,
                normal_n: motion.normal_n,
            }),
        };
        source.force_n.extend(newtons);
        source.along.push(along);
        let [x, y] = motion.velocity_m_per_s.map(f64::from);
        let speed = (x * x + y * y).sqrt();
        let shown_n = if held.is_constant { f64::from(motion.normal_n) } else { f64::from(scraper.normal_n()) };
        let now = [speed, shown_n];
        let step = |from: [f64; 2], to: [f64; 2], frame: usize, which: usize| {
            from[which] + (to[which] - from[which]) * (frame + 1) as f64 / TICK_FRAMES as f64
        };
        for (frame, force_n) in newtons.into_iter().enumerate() {
            let (out, shown) = (tick * TICK_FRAMES + frame, tick * TICK_FRAMES + frame + delay);
            extend(trace, shown + 1);
            trace.force_n[out] += force_n;
            trace.speed_m_per_s[shown] = step(before, now, frame, 0);
            trace.normal_n[shown] = step(before, now, frame, 1);
            *way_m += trace.speed_m_per_s[shown] / rate.hz();
            trace.distance_m[shown] = *way_m;
        }
        before = now;
        // Some ticks of silence show that the force has ended.
        if state.is_none() && time_s > touch.lift_s && scraper.is_silent() {
            break;
        }
    }
    let shown = (first_tick * TICK_FRAMES + source.force_n.len() + delay).min(trace.distance_m.len());
    trace.distance_m[shown..].fill(*way_m);
    Ok(source)
}

fn extend(trace: &mut Trace, frames: usize) {
    for numbers in [&mut trace.force_n, &mut trace.normal_n, &mut trace.speed_m_per_s, &mut trace.distance_m] {
        if numbers.len() < frames {
            numbers.resize(frames, numbers.last().copied().unwrap_or(0.0));
        }
    }
}

/// Contact of a pad's striker with the pad's surface.
pub(super) fn described<'k>(
    kit: &Kit<'k>,
    touch: &motion::Contact,
    normal_n: [f32; 2],
) -> Result<Contact<'k>, ScrapedError> {
    let (pad, striker) = (usize::from(touch.pad), usize::from(touch.striker));
    let rolls = touch.action == Action::Roll;
    if let Some(contact) = Contact::of(kit, pad, striker, rolls, normal_n) {
        return Ok(contact);
    }
    let object = kit.pads().nth(pad).and_then(|pad| kit.object_of(pad));
    let number = kit.pads().nth(pad).map(|pad| pad.object_index());
    let has_surface = kit.object_surfaces().iter().any(|place| Some(usize::from(place.object.get())) == number);
    let name = pad_name(kit, touch);
    if !has_surface {
        let object = object.map_or(String::new(), |object| object.name().to_owned());
        return Err(ScrapedError::NoSurface { pad: name, object });
    }
    Err(ScrapedError::DoesNotRoll { pad: name, striker: striker_name(kit, touch) })
}

/// Place of a state along an object of a length, 0 to 1; the object's middle is place 0 m.
pub(super) fn along_object(state: &State, length_m: f32) -> f64 {
    (0.5 + state.position_m[0] / f64::from(length_m)).clamp(0.0, 1.0)
}

/// Size of a pad's object along its positions and across them, in metres.
pub(super) fn object_size_m(kit: &Kit<'_>, touch: &motion::Contact) -> [f32; 2] {
    let number = kit.pads().nth(touch.pad.into()).map(|pad| pad.object_index());
    let place = kit.object_surfaces().iter().find(|place| Some(usize::from(place.object.get())) == number);
    place.map_or([1.0; 2], |place| place.size_m.map(|size_m| size_m.get()))
}
