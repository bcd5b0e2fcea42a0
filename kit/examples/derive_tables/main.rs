//! Makes the shipped tables anew.
//!
//! Run it by `cargo run -p kit --example derive_tables -- --data ../shared/data --out tables`.
//!
//! Bars and membranes come from the classical equations and need no data. The tables of measured
//! objects stay as they are if their data are absent. Equal inputs give equal files.

mod bar;
mod classical;
mod failure;
mod level;
mod measured;
mod membrane;
mod mug;
mod strikers;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use failure::Failure;
use kit::{Kit, Object, Striker};

fn main() -> ExitCode {
    let (data, out) = match arguments() {
        Some(paths) => paths,
        None => {
            eprintln!("usage: derive_tables --data DIR --out DIR");
            return ExitCode::from(2);
        }
    };
    match derive(&data, &out) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("derive_tables: {error}");
            ExitCode::FAILURE
        }
    }
}

fn arguments() -> Option<(PathBuf, PathBuf)> {
    let (mut data, mut out) = (None, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--data" => data = words.next().map(PathBuf::from),
            "--out" => out = words.next().map(PathBuf::from),
            _ => return None,
        }
    }
    Some((data?, out?))
}

fn derive(data: &Path, out: &Path) -> Result<(), Failure> {
    write(out, "strikers", Vec::new(), strikers::all())?;
    for object in classical::all() {
        write_object(out, object)?;
    }
    match measured::read(&data.join("modes_tdw.csv"))? {
        Some(modes) => {
            for object in measured::all(&modes) {
                write_object(out, object)?;
            }
        }
        None => {
            println!(
                "{}: absent; woodblock, pan, glass and plate stay as they are",
                data.join("modes_tdw.csv").display()
            )
        }
    }
    match mug::derive(&data.join("hammer"))? {
        Some(object) => write_object(out, object)?,
        None => println!("{}: absent; the mug stays as it is", data.join("hammer").display()),
    }
    Ok(())
}

fn write_object(out: &Path, object: Object) -> Result<(), Failure> {
    write(out, &object.name.clone(), vec![object], Vec::new())
}

fn write(out: &Path, name: &str, objects: Vec<Object>, strikers: Vec<Striker>) -> Result<(), Failure> {
    let table = Kit {
        name: name.to_owned(),
        objects,
        strikers,
        pads: Vec::new(),
        background: None,
        room: vec![],
        headphone_db: None,
        surfaces: Vec::new(),
    };
    let path = out.join(format!("{name}.toml"));
    kit::binary::build(&table)?; // refuses what a board would refuse
    kit::file::write_whole(&path, kit::text::write(&table).as_bytes())?;
    println!("{}", path.display());
    Ok(())
}
