//! The room: `y + y ⊗ IR_e` (diffimpact §3.4), where `IR_e` is noise that decays exponentially,
//! band by band.
//!
//! ```text
//!  left, right ─► feed ─► split ─► split ─► ... ─► lowest band    each at the lowest rate
//!                        │ high    │ high          │              that its band allows
//!                        ▼         ▼               ▼
//!                     network   network         network           four lines of pairs each
//!                        │ L R     │ L R           │ L R
//!  left, right ◄──(+)────┴─(+)◄─2x─┴──── ... ◄─2x──┘
//! ```
//!
//! **The law.** The answer to a unit impulse, on each side and in each band from its `from_hz` to
//! the next one's, is noise whose power decays as `g² e^{-2 d t}`. Its energy is `g²/(2 d)` of the
//! band's input at every sample rate. (Diffimpact's gain is per sample: theirs is ours over √fs,
//! over the rms of their noise.) T60 = ln(1000)/d. The sides are uncorrelated. A band's input is
//! `(L² + R²)/2` of its energy, which no constant-power pan changes: see `feed.rs`.
//!
//! **The delay.** The wet sound begins two blocks of 128 frames and a network's second longest line
//! after the dry one: 11 ms at 48 kHz where T60 is 0.3 s, 27 ms from 3 s on. The law's begins at
//! once.
//!
//! **The form.** Each band has one feedback delay network, so that its T60 is exact: all of its
//! resonances decay alike. Steep splits cut the bands apart, and each runs at the rate divided by 1
//! to 32, with its delays in one memory. A slow rotation inside the mix keeps the resonances
//! moving.
//!
//! **Time.** Input is gathered for a block of four ticks. The work on it is cut into four parts,
//! one at each tick of the next block, and the answer goes out in the block after that. So no bit
//! depends on the caller's block size.
//!
//! **Measured** at 48 kHz (`cargo test -p host-tests --test stages room:: -- --nocapture`,
//! `... --test on_chip room ...`); more in `docs/room.md`:
//!
//! | what | figure |
//! | --- | --- |
//! | against the twin in f64, T60 0.2 to 20 s, 32-bit lines | 95 dB and more |
//! | the same with 16-bit lines | 49.8 dB and more |
//! | T60 within 5 %, 4 bands and 8, neighbours within a factor of 2 (a) | 23 of 23, 17 of 17 |
//! | T60 within 5 %, the same bands, neighbours of 0.2 to 6 s, ±6 dB (a) | 15 of 17, 12 of 13 |
//! | energy of the bands: neighbours within a factor of 2, any neighbours | within 1.1 dB, 1.6 dB |
//! | peaks a second, 80 to 100 ms after an impulse | 7 400 and more |
//! | spectral crest of a late second, T60 6 s, lines of 48 KB, of 16 KB (b) | 12.1 dB, 14.8 dB |
//! | nominal cycles a frame, mean, noise, 4 bands (dearest tick), 8 bands | 281 (414), 356 (528) |
//! | RAM with 48 KB of lines | 57 664 bytes |
//!
//! (a) of bands with 300 and more independent samples (band width times T60). (b) Noise has 10.4
//! dB. The sounds against the twin are impulses, noise and tones that outlast the room.

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
