//! Reasons for which a picture cannot be made.

use std::path::PathBuf;

use kit::file::FileError;

/// Reason for which a picture was not made. No file is left behind.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The picture would be empty.
    #[error("{}: cannot be drawn: there is no {what} to draw", path.display())]
    Nothing {
        /// Path of the picture that was asked for.
        path: PathBuf,
        /// Name of the thing of which at least one is needed.
        what: &'static str,
    },
    /// The picture does not fit into memory.
    #[error("{}: cannot be drawn: {width} x {height} pixels do not fit into memory; draw fewer objects", path.display())]
    Surface {
        /// Path of the picture that was asked for.
        path: PathBuf,
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// The font inside the program is damaged.
    #[error("{}: cannot be drawn: the font inside this program is damaged; install the program again", path.display())]
    Font {
        /// Path of the picture that was asked for.
        path: PathBuf,
    },
    /// The picture cannot be encoded as PNG.
    #[error("{}: cannot be drawn: the picture cannot be encoded as PNG; draw a smaller one", path.display())]
    Encoding {
        /// Path of the picture that was asked for.
        path: PathBuf,
        /// Error of the PNG encoder, kept for programs; the message leaves it out.
        #[source]
        cause: png::EncodingError,
    },
    /// The file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
}
