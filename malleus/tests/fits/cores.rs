//! `malleus fit` writes the same tables, bit for bit, on any number of cores.
//!
//! What a thread has fitted before, and what another fits beside it, must not change a table.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::prior::{strike, write};

/// Fits recordings on a number of threads; returns the bytes of the tables in order of their names.
fn tables(recordings: &[PathBuf], modes: &str, threads: &str) -> Vec<(String, Vec<u8>)> {
    let folder = TempDir::new().expect("a folder");
    let output = folder.path().join("tables");
    let done = Command::new(env!("CARGO_BIN_EXE_malleus"))
        .env("RAYON_NUM_THREADS", threads)
        .arg("fit")
        .args(recordings)
        .args(["--modes", modes, "-o"])
        .arg(&output)
        .output()
        .expect("the program runs");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let mut tables: Vec<(String, Vec<u8>)> = fs::read_dir(&output)
        .expect("a folder of tables")
        .map(|entry| {
            let path = entry.expect("a table").path();
            (path.file_name().expect("a name").to_string_lossy().into_owned(), fs::read(&path).expect("readable"))
        })
        .collect();
    tables.sort();
    tables
}

/// Asserts that one thread and two write the same tables, in this order of recordings and in the
/// reverse.
fn assert_same_tables(recordings: &[PathBuf], modes: &str) {
    let alone = tables(recordings, modes, "1");
    assert_eq!(alone.len(), recordings.len());
    let reversed: Vec<PathBuf> = recordings.iter().rev().cloned().collect();
    for ((name, one), (_, two)) in alone.iter().zip(tables(&reversed, modes, "2")) {
        assert!(*one == two, "{name} at {modes} modes depends on the number of threads");
    }
}

#[test]
fn tables_are_the_same_bits_on_one_thread_and_on_two() {
    let folder = TempDir::new().expect("a folder");
    let recordings = [1u64, 2, 3].map(|seed| {
        let path = folder.path().join(format!("cymbal-{seed}.wav"));
        let sound = strike(seed);
        // Other lengths make other transforms.
        write(&path, &sound[..sound.len() - 7_001 * (seed as usize - 1)]);
        path
    });
    assert_same_tables(&recordings, "16");
}

#[test]
#[ignore = "fits 28 recordings six times: cargo test --release -p malleus --test fits -- --ignored all_recordings"]
fn tables_of_all_recordings_are_the_same_bits_on_one_thread_and_on_two() {
    let folder = Path::new(env!("SHARED_DATA")).join("recordings");
    let mut recordings: Vec<PathBuf> = fs::read_dir(&folder)
        .expect("the recordings in ../shared/data")
        .map(|entry| entry.expect("a file").path())
        .collect();
    recordings.retain(|path| path.extension().is_some_and(|ending| ending == "wav"));
    recordings.sort();
    for modes in ["64", "32", "16"] {
        assert_same_tables(&recordings, modes);
    }
}
