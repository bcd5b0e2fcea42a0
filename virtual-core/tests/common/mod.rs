//! The thumb program of these tests, built once, and a machine with it.

use std::path::Path;

use virtual_core::{Image, Machine};

/// The bytes of its ELF file.
pub(crate) fn elf() -> Vec<u8> {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program/Cargo.toml");
    virtual_core::build(Path::new(manifest)).unwrap_or_else(|error| panic!("{error}"))
}

/// A fresh machine with the program loaded.
pub(crate) fn machine() -> Machine {
    Machine::new(&Image::from_elf(&elf()).unwrap()).unwrap()
}
