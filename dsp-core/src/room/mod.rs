//! The room: `y + y ⊗ IR_e` (diffimpact §3.4), where `IR_e` is noise that decays exponentially, band by band.
//!
//! ```text
//!  left, right ─► feed ─► split ─► split ─► ... ─► lowest band     each at the lowest rate that its band allows
//!                        │ high    │ high          │
//!                        ▼         ▼               ▼
//!                     network   network         network              four lines of pairs each
//!                        │ L R     │ L R           │ L R
//!  left, right ◄──(+)────┴─(+)◄─2x─┴──── ... ◄─2x──┘
//! ```
//!
//! **The law.** A unit impulse is answered, on each side and in each band from its `from_hz` to the next one's, by noise whose power decays as
//! `g² e^{-2 d t}`: the answer's energy is `g²/(2 d)` of what the band was given, at every sample rate. (Diffimpact's gain is per sample: theirs is ours over √fs,
//! over the rms of their noise.) T60 = ln(1000)/d. Sides are uncorrelated. What a band is given is
//! `(L² + R²)/2` of its energy, which no constant-power pan changes: see `feed.rs`.
//!
//! **The delay.** The wet sound begins two blocks of 128 frames and a network's second longest line after
//! the dry one: 11 ms at 48 kHz where T60 is 0.3 s, 27 ms from 3 s on. The law's begins at once.
//!
//! **The form.** One feedback delay network a band, so that a band's T60 is exact: all of its resonances decay alike. Bands are cut apart by steep splits, and
//! each runs at the rate divided by 1 to 32, with its delays in one memory. A slow rotation inside the mix keeps the resonances moving.
//!
//! **Time.** Input is gathered for a block of four ticks; its work is cut into four parts, one at each tick of the next block; the answer goes out in the block
//! after that. So the length of the caller's blocks changes nothing.
//!
//! **Measured** at 48 kHz (`cargo test -p host-tests --test stages room:: -- --nocapture`, `... --test on_chip room ...`); more in `docs/room.md`:
//!
//! | what | figure |
//! | --- | --- |
//! | against the twin in f64, T60 0.2 to 20 s; impulses, noise, tones that outlast the room | 32-bit lines 95 dB and more; 16-bit lines 49.8 dB and more |
//! | T60 within 5 %, of bands with 300 and more independent samples (band width times T60), neighbours within a factor of 2 | 23 of 23 (4 bands), 17 of 17 (8) |
//! | any neighbours from 0.2 to 6 s, gains ±6 dB | 15 of 17 (4 bands), 12 of 13 (8) |
//! | energy of the same | within 1.1 dB, any neighbours 1.6 dB |
//! | peaks a second, 80 to 100 ms after an impulse | 7 400 and more |
//! | spectral crest of a late second, T60 6 s; noise has 10.4 dB | 12.1 dB with 48 KB of lines, 14.8 dB with 16 KB |
//! | nominal cycles a frame, mean, noise | 281 with 4 bands (dearest tick 414), 356 with 8 (528) |
//! | RAM with 48 KB of lines | 57 664 bytes |

mod chain;
mod crossover;
mod dimensions;
mod elliptic;
mod error;
mod feed;
mod kernel;
mod lean;
mod level;
mod lines;
mod load;
mod network;
mod plan;
mod sample;
mod split;
mod state;
mod storage;
mod turn;
mod upsample;
mod work;

pub use dimensions::MAX_BANDS;
pub use error::RoomError;
pub use load::RoomSize;
pub use sample::Sample;
pub use state::Room;
