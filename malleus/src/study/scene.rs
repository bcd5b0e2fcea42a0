//! Pad that is scraped in a trial, alone with its striker.

use dsp_core::SampleRate;
use dsp_core::engine::Setup;
use dsp_core::fixed::ONE_Q27;
use dsp_core::table::Kit;

use super::error::StudyError;
use crate::motion::Motion;
use crate::render::Performance;
use crate::render::instrument::{self, Output, Settings};
use crate::render::scraped::{self, Ablation};

/// Sample rate of all studies.
pub const RATE: SampleRate = SampleRate::HZ_48000;
/// Time in seconds that a sound goes on behind its motion.
const TAIL_S: f64 = 0.4;

/// Kit of one pad with one striker, and what they need.
#[derive(Clone, Debug)]
pub struct Scene {
    kit: kit::Kit,
}

impl Scene {
    /// Takes a pad and a striker out of a kit; the striker need not be one of the pad's.
    ///
    /// # Errors
    /// [`StudyError::Missing`] if the kit lacks one of the two.
    pub fn of(kit: &kit::Kit, pad: &'static str, striker: &'static str) -> Result<Self, StudyError> {
        let missing = |kind, name| StudyError::Missing { kit: kit.name.clone(), kind, name };
        let mut own = kit.clone();
        own.pads.retain(|other| other.name == pad);
        let Some(only) = own.pads.first_mut() else { return Err(missing("pad", pad)) };
        only.strikers = vec![striker.to_owned()];
        only.trigger = None;
        own.objects.retain(|object| object.name == only.object);
        let surface = own.objects.first().and_then(|object| object.surface.as_ref());
        own.surfaces.retain(|other| surface.is_some_and(|place| place.surface == other.name));
        own.strikers.retain(|other| other.name == striker);
        if own.strikers.is_empty() {
            return Err(missing("striker", striker));
        }
        Ok(Self { kit: own })
    }

    /// Sound of a motion on the pad, without parts of the model: both channels' mean, 1.0 = full
    /// scale.
    ///
    /// # Errors
    /// [`StudyError`] if the motion or the kit cannot be played.
    pub fn play(&self, motion: &Motion, ablations: &[Ablation]) -> Result<Vec<f64>, StudyError> {
        let kit = scraped::without(&self.kit, ablations, &[0]);
        let build = |kit: &kit::Kit| kit::binary::build(kit).map_err(|error| StudyError::Build(Box::new(error)));
        let binary = build(&kit)?;
        let is_constant = ablations.contains(&Ablation::NormalForce);
        let table = Kit::parse(&binary)?;
        let events = scraped::events(motion, &table, RATE, is_constant)?;
        let performance = Performance::new(events, None, &kit, RATE, Some(TAIL_S));
        let settings = Settings { setup: Setup::new(RATE), block: 128, budget_cycles: None };
        let bus = instrument::render(&table, &performance, settings, Output::Bus, |_| {})?;
        let mean = |[left, right]: [i32; 2]| 0.5 * (f64::from(left) + f64::from(right)) / f64::from(ONE_Q27);
        Ok(bus.into_iter().map(mean).collect())
    }
}
