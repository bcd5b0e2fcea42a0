//! What can keep a picture from being made.

use std::path::PathBuf;

use kit::file::FileError;

/// Why a picture was not made. No file is left behind in any of these cases.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// There is nothing to draw.
    #[error("{}: cannot be drawn: there is no {what}", path.display())]
    Nothing {
        /// The picture that was asked for.
        path: PathBuf,
        /// What is missing.
        what: &'static str,
    },
    /// The picture does not fit into memory.
    #[error("{}: cannot be drawn: {width} x {height} pixels do not fit into memory; draw fewer objects", path.display())]
    Surface {
        /// The picture that was asked for.
        path: PathBuf,
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// The font inside the program cannot be read.
    #[error("{}: cannot be drawn: the font inside this program is damaged; install the program again", path.display())]
    Font {
        /// The picture that was asked for.
        path: PathBuf,
    },
    /// The picture cannot be encoded.
    #[error("{}: cannot be encoded as PNG: {cause}", path.display())]
    Encoding {
        /// The picture that was asked for.
        path: PathBuf,
        /// What the encoder says.
        cause: png::EncodingError,
    },
    /// The file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
}
