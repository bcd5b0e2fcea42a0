//! Contacts of the shipped kit `scrapes`, rendered by the instrument, by the reference, and by the
//! law itself.

pub mod bands;
pub mod law;
pub mod map;
pub mod on_chip;

use dsp_core::SampleRate;
use dsp_core::fixed::ONE_Q27;
use dsp_core::scrape::{Contact, Motion, Scraper};
use dsp_core::table::Kit;
use dsp_core::time::TICK_FRAMES;

/// Rate of all renderings.
pub const RATE: SampleRate = SampleRate::HZ_48000;

/// Shipped kit `scrapes`.
#[derive(Debug)]
pub struct Scrapes(kit::Loaded);

impl Default for Scrapes {
    fn default() -> Self {
        Self::new()
    }
}

impl Scrapes {
    /// Reads the kit.
    pub fn new() -> Self {
        Self(kit::shipped("scrapes").expect("a shipped kit").expect("a right kit"))
    }

    /// The kit with a map on the object of a pad in place of its surface.
    pub fn with_map(pad: &str, map: kit::Surface) -> Self {
        let mut loaded = kit::shipped("scrapes").expect("a shipped kit").expect("a right kit");
        let object = loaded.kit.pads.iter().find(|candidate| candidate.name == pad).expect("a pad").object.clone();
        let object = loaded.kit.objects.iter_mut().find(|candidate| candidate.name == object).expect("an object");
        object.surface.as_mut().expect("a surface").surface = map.name.clone();
        loaded.kit.surfaces.push(map);
        loaded.binary = kit::binary::build(&loaded.kit).expect("a right kit");
        Self(loaded)
    }

    /// Kit of one pad alone, as the board reads it, with the number of a striker.
    pub fn alone(&self, pad: &str, striker: &str) -> (Vec<u8>, usize) {
        let mut kit = self.0.kit.clone();
        kit.pads.retain(|candidate| candidate.name == pad);
        let pad = kit.pads.first().expect("a pad of the kit").clone();
        kit.objects.retain(|object| object.name == pad.object);
        let object = kit.objects.first().expect("an object of the kit");
        let surface = object.surface.as_ref().map(|place| place.surface.clone());
        kit.surfaces.retain(|candidate| Some(&candidate.name) == surface.as_ref());
        kit.strikers.retain(|candidate| pad.strikers.contains(&candidate.name));
        let striker = pad.strikers.iter().position(|candidate| candidate == striker).expect("a striker");
        (kit::binary::build(&kit).expect("a right kit"), striker)
    }

    /// Contact of a striker with a pad, between two normal forces.
    pub fn contact(&self, pad: &str, striker: &str, rolls: bool, normal_n: [f32; 2]) -> Contact<'_> {
        let table = Kit::parse(&self.0.binary).expect("a right kit");
        let pads = &self.0.kit.pads;
        let number = pads.iter().position(|candidate| candidate.name == pad).expect("a pad of the kit");
        let striker = pads[number].strikers.iter().position(|candidate| candidate == striker).expect("a striker");
        Contact::of(&table, number, striker, rolls, normal_n).expect("a surface and a scraper")
    }
}

/// Velocity of a motion along a line at the end of each tick.
pub fn along(speeds: impl IntoIterator<Item = f64>, normal_n: f32) -> Vec<Motion> {
    let motion = |speed: f64| Motion { velocity_m_per_s: [speed as f32, 0.0], normal_n };
    speeds.into_iter().map(motion).collect()
}

/// Force by the instrument, one motion a tick; Q4.27 of the reference force.
pub fn render(contact: Contact<'_>, motions: &[Motion]) -> Vec<i32> {
    let mut scraper = Scraper::new(contact, RATE);
    let mut force = Vec::with_capacity(motions.len() * TICK_FRAMES);
    for motion in motions {
        let mut frames = [0; TICK_FRAMES];
        scraper.render(*motion, &mut frames).expect("a possible motion");
        force.extend(frames);
    }
    force
}

/// Force by the reference in the same unit.
pub fn twin(contact: Contact<'_>, motions: &[Motion]) -> Vec<f64> {
    let unit = f64::from(ONE_Q27) / f64::from(contact.reference_force_n);
    let (numerator, denominator) = RATE.ratio();
    let rate = reference::SampleRate { numerator, denominator };
    let mut scraper = reference::scrape::Scraper::new(malleus::render::reference::contact(&contact), rate);
    let motion = |motion: &Motion| reference::scrape::Motion {
        velocity_m_per_s: motion.velocity_m_per_s,
        normal_n: motion.normal_n,
    };
    motions.iter().flat_map(|tick| scraper.render(motion(tick))).map(|force_n| force_n * unit).collect()
}
