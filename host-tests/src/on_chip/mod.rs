//! The code under test on the virtual Cortex-M4F: single stages and the whole engine, called from
//! the PC.

mod bank;
mod biquads;
pub mod budget_scenes;
mod engine;
mod filters;
mod frames;
mod loaded;
pub mod lone_pad;
mod residual;
mod room;
pub mod scenes;

pub use bank::BankOnChip;
pub use biquads::BiquadsOnChip;
pub use engine::{BLOCK_FRAMES, EngineOnChip, Footprint, Told};
pub use filters::FiltersOnChip;
pub use frames::FramesOnChip;
pub use residual::ResidualOnChip;
pub use room::RoomOnChip;

use std::path::Path;

use virtual_core::{BuildError, Image, ImageError, RunError};

/// First byte of the core-coupled memory. The images leave it to the host, which writes arguments
/// there and reads results.
const HOST_MEMORY: u32 = 0x1000_0000;

/// Address of the kit in flash, behind every image.
pub(crate) const KIT_FLASH: u32 = 0x080e_0000;

/// Reason for which something could not run on the virtual core.
#[derive(Debug, thiserror::Error)]
pub enum OnChipError {
    /// The image could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The file that was built is no valid image.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The virtual core stopped before the function returned.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A function of the image returned an error code.
    #[error("{function} returned {code}: see its documentation in host-tests/images")]
    Refused {
        /// Name of the function.
        function: &'static str,
        /// Code that the function returned.
        code: i32,
    },
}

/// Images of the profile `release`, which are optimised for speed.
const FAST: &[&str] =
    &["biquads-image", "filters-image", "frames-image", "kernels-image", "residual-image", "scrape-image"];
/// Images of the profile `small`, which are optimised for size.
const SMALL: &[&str] = &["engine-image", "trigger-image"];

/// Gives one of the images of `host-tests/images`. The first call builds all images of its profile.
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
