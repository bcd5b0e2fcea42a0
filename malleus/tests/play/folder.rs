//! A folder with a kit, in which the program runs, and files to put there.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// A kit of one pad, `bar`, that MIDI note 60 plays.
pub(crate) const KIT: &str = r#"
format = 1
name = "test"
[[object]]
name = "bar"
modes = [
  { frequency_hz = 440.0, decay_per_s = 30.0, gain_sine = 300.0, gain_cosine = 20.0 },
  { frequency_hz = 5200.0, decay_per_s = 50.0, gain_sine = 300.0, gain_cosine = 0.0 },
]
[[striker]]
name = "stick"
peak_force = 1.0
contact_time_s = 0.0005
[[pad]]
name = "bar"
object = "bar"
strikers = ["stick"]
midi_notes = [60]
"#;

/// A folder that holds the kit [`KIT`] as kit.toml, and the files that a test puts there.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("kit.toml", KIT.as_bytes());
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> &Self {
        fs::write(self.path(name), bytes).unwrap();
        self
    }

    /// Runs `malleus` in this folder with arguments that are split at spaces.
    pub(crate) fn malleus(&self, words: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_malleus")).args(words.split(' ')).current_dir(self.0.path()).output().unwrap()
    }

    /// Asserts that a run fails with exit code 1, says all of `expected` on stderr, and leaves no
    /// new file behind.
    pub(crate) fn refuses(&self, words: &str, expected: &[&str]) {
        let files = |folder: &Path| fs::read_dir(folder).unwrap().count();
        let before = files(self.0.path());
        let output = self.malleus(words);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{words}: {message}");
        for part in expected {
            assert!(message.contains(part), "{words}: no {part:?} in: {message}");
        }
        assert!(!message.contains("panicked"), "{message}");
        assert_eq!(files(self.0.path()), before, "{words}: a file was left behind");
    }

    /// Asserts that these events are refused with all of `expected` on stderr.
    pub(crate) fn refuses_strikes(&self, csv: &str, expected: &[&str]) {
        self.write("strikes.csv", csv.as_bytes());
        self.refuses("play --kit kit.toml --strikes strikes.csv -o out.wav", expected);
    }
}

/// Bytes of a Standard MIDI File of one track with the given events.
pub(crate) fn midi(events: &[u8]) -> Vec<u8> {
    let mut file = b"MThd\0\0\0\x06\0\0\0\x01\0\x60MTrk".to_vec();
    file.extend((events.len() as u32 + 4).to_be_bytes());
    file.extend(events);
    file.extend([0, 0xFF, 0x2F, 0]);
    file
}

/// Samples of a WAV file, channels interleaved.
pub(crate) fn samples(path: &Path) -> Vec<i32> {
    hound::WavReader::open(path).unwrap().into_samples::<i32>().map(Result::unwrap).collect()
}
