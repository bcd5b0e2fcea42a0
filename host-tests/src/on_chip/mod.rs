//! The same code on the virtual Cortex-M4F: the bank alone and the whole engine, called from here.

mod bank;
mod biquads;
pub mod budget_scenes;
mod engine;
mod filters;
mod loaded;
mod residual;
mod room;
pub mod scenes;

pub use bank::BankOnChip;
pub use biquads::BiquadsOnChip;
pub use engine::{BLOCK_FRAMES, EngineOnChip, Footprint, Told};
pub use filters::FiltersOnChip;
pub use residual::ResidualOnChip;
pub use room::RoomOnChip;

use std::path::Path;

use virtual_core::{BuildError, Image, ImageError, RunError};

/// The first byte of the core-coupled memory, which the images leave to the host for what it hands
/// over.
const HOST_MEMORY: u32 = 0x1000_0000;

/// The kit's place in flash: behind every image.
const KIT_FLASH: u32 = 0x080e_0000;

/// Why something could not run on the virtual core.
#[derive(Debug, thiserror::Error)]
pub enum OnChipError {
    /// The image could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The image is no image.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The program stopped.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A function of the image said no.
    #[error("{function} returned {code}: see its documentation in host-tests/images")]
    Refused {
        /// The function.
        function: &'static str,
        /// Code that the function returned.
        code: i32,
    },
}

/// Images of the profile `release`, which are optimised for speed.
const FAST: &[&str] = &["biquads-image", "filters-image", "kernels-image", "residual-image"];
/// Images of the profile `small`, which are optimised for size.
const SMALL: &[&str] = &["engine-image", "trigger-image"];

/// Gives one of the images of `host-tests/images`; the first call builds all of its profile.
pub(crate) fn image(name: &str) -> Result<Image, OnChipError> {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("images/Cargo.toml");
    let (profile, images) = if SMALL.contains(&name) { ("small", SMALL) } else { ("release", FAST) };
    Ok(Image::from_elf(&virtual_core::build_one_of(&manifest, images, name, profile, &[])?)?)
}

fn accept(function: &'static str, code: u32) -> Result<(), OnChipError> {
    match code as i32 {
        0 => Ok(()),
        code => Err(OnChipError::Refused { function, code }),
    }
}

fn bytes_of(words: &[i32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

fn words_of(bytes: &[u8]) -> Vec<i32> {
    bytes.as_chunks().0.iter().map(|&word| i32::from_le_bytes(word)).collect()
}
