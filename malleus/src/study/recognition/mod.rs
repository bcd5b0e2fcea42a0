//! Stand-in for the listeners of Experiment 2 (scraping-rolling §3.2): a program hears which of
//! five motions made a scrape.
//!
//! It hears loudness and brightness over 32 pieces of time, and nothing else. It learns from one
//! set of renderings and is tested on another. Two pairs of motions share a velocity profile: what
//! tells them apart is the normal force alone.

mod classifier;
mod confusion;
mod features;

use rayon::prelude::*;

use super::error::StudyError;
use super::scene::Scene;
use crate::motion::trials::{Shape, Trial};
use crate::render::scraped::Ablation;

pub use classifier::Classifier;
pub use confusion::Confusion;
pub use features::{FEATURES, PIECES, features};

/// Number of motions.
pub const MOTIONS: usize = 5;

/// Motions in the order of the paper's Fig. 5, and their names. The second and the third share a
/// velocity profile, and so do the fourth and the fifth.
pub const NAMES: [&str; MOTIONS] = ["scribble", "four-strokes", "back-and-forth", "line", "circle"];

/// Group of each motion: those of a group share a velocity profile.
pub const GROUPS: [usize; MOTIONS] = [0, 1, 1, 2, 2];

const SHAPES: [Shape; MOTIONS] = [
    Shape::Scribble { length_m: 0.8, speed_m_per_s: 0.4, seed: 0 },
    Shape::FourStrokes { length_m: 0.2, period_s: 1.0, strokes: 4 },
    Shape::BackAndForth { length_m: 0.2, period_s: 1.0, strokes: 4 },
    Shape::Line { length_m: 0.6, speed_m_per_s: 0.4 },
    Shape::Circle { length_m: 0.6, speed_m_per_s: 0.4 },
];

/// Learns each motion from `count` renderings, and is tested on as many others.
///
/// All renderings have another start, speed and length, drawn from their seeds. Training and test
/// share no seed, and no two motions do. `done` is called once for each rendering.
///
/// # Errors
/// [`StudyError`] if a motion cannot be played.
pub fn confusion(
    scene: &Scene,
    ablations: &[Ablation],
    (count, seed): (u32, u32),
    done: impl Fn() + Sync,
) -> Result<Confusion, StudyError> {
    let [training, test] = [0, 1].map(|set| {
        let each = (0..MOTIONS * count as usize).into_par_iter().map(|index| {
            let motion = index % MOTIONS;
            let own = seed.wrapping_add(((2 * index + set) as u32).wrapping_mul(0x9e37_79b9));
            let trial = Trial { shape: SHAPES[motion], start_s: 0.0, place_m: [0.0; 2] }.varied(own);
            let drawn = trial.draw()?.motion().map_err(crate::motion::trials::TrialError::from)?;
            let heard = features(&scene.play(&drawn, ablations)?);
            done();
            Ok((motion, heard))
        });
        each.collect::<Result<Vec<_>, StudyError>>()
    });
    let classifier = Classifier::learn(&training?);
    let mut confusion = Confusion::default();
    for (motion, heard) in test? {
        confusion.add(motion, classifier.hear(&heard));
    }
    Ok(confusion)
}
