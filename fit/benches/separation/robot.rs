//! The separation of the robot's clips: one strike for each of four strikers on four things.

use std::path::{Path, PathBuf};

use fit::audio;
use fit::material::{self, RingingMode};
use fit::modes::Settings;
use fit::score::quantile;
use fit::separate::{Clip, Known, PartMode, Separation, separate};

/// Strikers and things of the clips, whose files are named STRIKER-THING.wav.
const STRIKERS: [&str; 4] = ["ceramic-chopstick", "polycarbonate-spoon", "steel-fork", "wood-spoon"];
const THINGS: [&str; 4] = ["ceramic-mug", "polycarbonate-cup", "steel-bowl", "wood-holder"];

/// Materials of strikers and of things, in the order of the names, with Young's moduli in pascals.
///
/// The moduli are those that the library has for these names: the clips come without measured ones.
const MATERIALS: [(&str, f64); 4] =
    [("ceramic", 7.2e10), ("polycarbonate", 2.4e9), ("steel", 2.0e11), ("wood", 1.1e10)];

/// Separates the clips and prints what is left, the materials and Young's moduli; says so if the
/// clips are absent.
pub(crate) fn print() {
    let folder = PathBuf::from(env!("SHARED_DATA")).join("robot");
    if !folder.is_dir() {
        println!("robot clips              absent: they are not part of this repository");
        return;
    }
    let separation = separated(&folder);
    let left: Vec<f64> = separation.stems.iter().map(|stems| stems.left_db).collect();
    println!(
        "robot clips, left        median {:6.2} dB, from {:.2} to {:.2} dB",
        quantile(&left, 0.5),
        quantile(&left, 0.0),
        quantile(&left, 1.0)
    );
    print_materials("things", &THINGS, &separation.objects);
    print_materials("strikers", &STRIKERS, &separation.strikers);
}

/// Prints the material of each part and the errors of Young's modulus. All parts have equally many
/// clips, so that a share of parts is one of clips.
fn print_materials(what: &str, names: &[&str], parts: &[Vec<PartMode>]) {
    let among = material::named(&MATERIALS.map(|(name, _)| name.to_owned())).expect("the materials are known");
    let (mut right, mut errors, mut logs) = (0, 0.0, 0.0);
    for ((name, modes), (truth, pascals)) in names.iter().zip(parts).zip(MATERIALS) {
        let ringing: Vec<RingingMode> = modes.iter().map(PartMode::ringing).collect();
        let found = material::identify(&ringing, &among).expect("the part has modes");
        let modulus = found.young_modulus_pa;
        println!(
            "  {name:22} {:14} {:3.0} %, E {:6.1} GPa, {:5.1} to {:5.1} GPa, truth {:5.1} GPa",
            found.material.name,
            100.0 * found.material.confidence,
            modulus.estimate / 1e9,
            modulus.low / 1e9,
            modulus.high / 1e9,
            pascals / 1e9
        );
        right += usize::from(found.material.name == truth);
        errors += (modulus.estimate / pascals - 1.0).abs();
        logs += (modulus.estimate / pascals).ln().abs();
    }
    let count = names.len() as f64;
    println!(
        "  {what}: material right in {:.1} % of the clips, mean error of E {:.1} %, geometric mean factor {:.2}",
        100.0 * right as f64 / count,
        100.0 * errors / count,
        (logs / count).exp()
    );
}

fn separated(folder: &Path) -> Separation {
    let pairs = THINGS.iter().flat_map(|thing| STRIKERS.iter().map(move |striker| format!("{striker}-{thing}.wav")));
    let recordings: Vec<audio::Recording> =
        pairs.map(|name| audio::read(&folder.join(name), None).expect("a clip can be read")).collect();
    let clips: Vec<Clip<'_>> = recordings
        .iter()
        .enumerate()
        .map(|(index, recording)| Clip {
            samples: &recording.samples,
            rate_hz: recording.rate_hz,
            object: index / STRIKERS.len(),
            striker: index % STRIKERS.len(),
        })
        .collect();
    separate(&clips, &Known::default(), Settings { most_modes: 40, ..Settings::default() }, &|_| {})
        .expect("the clips can be separated")
}
