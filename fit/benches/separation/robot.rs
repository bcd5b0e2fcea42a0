//! The separation of the robot's clips: one strike for each of four strikers on four things.

use std::path::{Path, PathBuf};

use fit::audio;
use fit::modes::Settings;
use fit::score::quantile;
use fit::separate::{Clip, Known, Separation, separate};

/// Strikers and things of the clips, whose files are named STRIKER-THING.wav.
const STRIKERS: [&str; 4] = ["ceramic-chopstick", "polycarbonate-spoon", "steel-fork", "wood-spoon"];
const THINGS: [&str; 4] = ["ceramic-mug", "polycarbonate-cup", "steel-bowl", "wood-holder"];

/// Separates the clips of a folder and prints what is left; says so if they are absent.
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
    if std::env::var_os("SEPLOG").is_some() {
        for (i, stems) in separation.stems.iter().enumerate() {
            println!("{} {} left {:.1} {:?}", THINGS[i/4], STRIKERS[i%4], stems.left_db, stems.blows.iter().map(|b| format!("{:.4} {:.2}ms {:.0}", b.at_s, 1e3*b.contact_time_s, b.level_db)).collect::<Vec<_>>());
        }
        for (name, modes) in THINGS.iter().zip(&separation.objects).chain(STRIKERS.iter().zip(&separation.strikers)) {
            for mode in modes {
                println!("MODE {name} {:.1} {:.2} {:.1}", mode.frequency_hz, mode.decay_per_s, mode.level_db);
            }
        }
    }
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
    separate(&clips, &Known::default(), Settings { most_modes: 40, ..Settings::default() }, &|_| {}).expect("the clips can be separated")
}
