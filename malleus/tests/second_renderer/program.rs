//! The program under test, and the files of this folder.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Path of a file of this folder.
pub(crate) fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/second_renderer").join(name)
}

/// Runs `malleus play` with arguments that are split at spaces.
///
/// Returns the samples, and the text on stderr.
pub(crate) fn play(kit: &Path, words: &str) -> (Vec<[i32; 2]>, String) {
    let folder = tempfile::tempdir().unwrap();
    let wave = folder.path().join("out.wav");
    let mut command = Command::new(env!("CARGO_BIN_EXE_malleus"));
    command.arg("play").arg("--kit").arg(kit).arg("--output").arg(&wave);
    let output = command.args(words.split(' ')).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{message}");
    let mut reader = hound::WavReader::open(wave).unwrap();
    assert_eq!((reader.spec().channels, reader.spec().bits_per_sample), (2, 24));
    let samples = reader.samples::<i32>().map(Result::unwrap).collect::<Vec<_>>();
    (samples.chunks_exact(2).map(|sides| [sides[0], sides[1]]).collect(), message)
}
