//! Trials of the paper's experiments (scraping-rolling §3.1, §5.1), with the things of the shipped
//! kit `scrapes`.

use crate::motion::trials::{Shape, Trial};
use crate::render::scraped::Ablation;

/// Experiment whose sounds are rated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Experiment {
    /// Experiment 1: realism of scrapes.
    Scraping,
    /// Experiment 3: realism of balls that roll.
    Rolling,
}

impl Experiment {
    /// Name in titles and in files of ratings.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Scraping => "scraping",
            Self::Rolling => "rolling",
        }
    }
}

/// Rendering of a trial: the whole model, or the model without a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Method {
    /// Name in files of ratings.
    pub name: &'static str,
    /// Parts that are left out.
    pub ablations: &'static [Ablation],
}

/// One description that listeners read, and what is heard.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyTrial {
    /// Sentence that describes the event.
    pub text: String,
    /// Pad of the kit.
    pub pad: &'static str,
    /// Striker of the pad.
    pub striker: &'static str,
    /// Motion.
    pub trial: Trial,
}

/// Model whole, and without each of its parts.
const METHODS: [Method; 4] = [
    Method { name: "full", ablations: &[] },
    Method { name: "without-scraper", ablations: &[Ablation::Scraper] },
    Method { name: "without-normal-force", ablations: &[Ablation::NormalForce] },
    Method { name: "without-nonlinearity", ablations: &[Ablation::Nonlinearity] },
];

/// Surfaces of both experiments: pads and their descriptions (§3.1).
const SURFACES: [(&str, &str); 3] =
    [("marimba", "a bar of basswood"), ("woodblock", "a block of poplar wood"), ("mug", "a ceramic mug")];
/// Scrapers of Experiment 1.
const SCRAPERS: [(&str, &str); 2] = [("pen", "A pen of plastic"), ("stick", "A wooden stick")];
/// Balls of Experiment 3. Their own modes lie above what is heard.
const BALLS: [(&str, &str); 3] =
    [("ceramic-ball", "A ceramic ball"), ("glass-ball", "A glass ball"), ("ball", "A wooden ball")];

/// Motions of Experiment 1 (§3.1).
const SCRAPES: [(&str, Shape); 5] = [
    ("slowly back and forth", Shape::BackAndForth { length_m: 0.15, period_s: 1.4, strokes: 4 }),
    ("quickly back and forth", Shape::BackAndForth { length_m: 0.1, period_s: 0.5, strokes: 6 }),
    ("in a circle", Shape::Circle { length_m: 0.6, speed_m_per_s: 0.4 }),
    ("along a short line", Shape::Line { length_m: 0.12, speed_m_per_s: 0.4 }),
    ("along a long line", Shape::Line { length_m: 0.6, speed_m_per_s: 0.4 }),
];
/// Motions of Experiment 3 (§5.1).
const ROLLS: [(&str, Shape); 2] = [
    ("down", Shape::Roll { length_m: 0.5, speed_m_per_s: 0.1, incline_deg: -2.0 }),
    ("up", Shape::Roll { length_m: 0.5, speed_m_per_s: 0.65, incline_deg: 2.0 }),
];

/// Methods of an experiment: the model whole, and without each of its parts that is heard there.
pub fn methods(experiment: Experiment) -> impl Iterator<Item = Method> {
    let is_heard = move |method: &Method| experiment == Experiment::Scraping || method.name != "without-scraper";
    METHODS.into_iter().filter(is_heard)
}

/// Trials of an experiment: all its things on all surfaces in all motions. 30 of scraping, 18 of
/// rolling.
pub fn trials(experiment: Experiment) -> Vec<StudyTrial> {
    let (tools, motions) = match experiment {
        Experiment::Scraping => (SCRAPERS.as_slice(), SCRAPES.as_slice()),
        Experiment::Rolling => (BALLS.as_slice(), ROLLS.as_slice()),
    };
    let text = |tool: &str, motion: &str, surface: &str| match experiment {
        Experiment::Scraping => format!("{tool} is drawn {motion} over {surface}."),
        Experiment::Rolling => format!("{tool} rolls {motion} a slope of {surface}."),
    };
    let mut trials = Vec::new();
    for &(striker, tool) in tools {
        for &(pad, surface) in &SURFACES {
            let surface = if experiment == Experiment::Rolling { material(pad) } else { surface };
            for &(motion, shape) in motions {
                let trial = Trial { shape, start_s: 0.05, place_m: [0.0, 0.0] };
                trials.push(StudyTrial { text: text(tool, motion, surface), pad, striker, trial });
            }
        }
    }
    trials
}

/// Material of a pad's surface.
fn material(pad: &str) -> &'static str {
    match pad {
        "marimba" => "basswood",
        "woodblock" => "poplar wood",
        _ => "ceramic",
    }
}
