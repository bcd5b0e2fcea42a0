//! Motions: their files, paths, normal forces and trials, and `malleus motion` as its user calls
//! it.

mod maps;
mod normal;
mod paths;
mod play;
mod program;
mod refusals;
mod study;
mod trials;

use std::sync::OnceLock;

use dsp_core::SampleRate;
use dsp_core::table::Kit;
use malleus::motion::{Motion, MotionFault, csv};

/// A kit of the pads `board` (strikers pen and ball) and `drum` (striker pen).
const KIT: &str = r#"
format = 1
name = "test"
[[object]]
name = "bar"
modes = [{ frequency_hz = 440.0, decay_per_s = 30.0, gain_sine = 300.0, gain_cosine = 20.0 }]
[[striker]]
name = "pen"
peak_force = 1.0
contact_time_s = 0.0005
[[striker]]
name = "ball"
peak_force = 1.0
contact_time_s = 0.0005
[[pad]]
name = "board"
object = "bar"
strikers = ["pen", "ball"]
[[pad]]
name = "drum"
object = "bar"
strikers = ["pen"]
"#;

/// Header of the files in which these tests write their lines.
const HEADER: &str = "time_s,pad,action,striker,x_m,y_m,normal_n\n";

/// Parses a whole file on the kit of these tests, at 48 kHz.
fn parse(bytes: &[u8]) -> Result<Motion, MotionFault> {
    static BINARY: OnceLock<Vec<u8>> = OnceLock::new();
    let binary = BINARY.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kit.toml");
        std::fs::write(&path, KIT).unwrap();
        kit::open(path.to_str().unwrap()).unwrap().binary
    });
    csv::parse(bytes, &Kit::parse(binary).unwrap(), SampleRate::HZ_48000)
}

/// Motion of lines that stand behind [`HEADER`].
fn motion(lines: &str) -> Motion {
    parse(format!("{HEADER}{lines}").as_bytes()).unwrap()
}
