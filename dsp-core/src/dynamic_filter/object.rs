//! All of an object's dynamic filter: noise, exciter, filter, and the loops round it.

use core::fmt;

use super::first_order::Filter;
use super::path::{Breakpoint, Path, PathError};
use crate::SampleRate;
use crate::biquad::butterworth::{BandError, Exciter};
use crate::resonator::TICK_FRAMES;
use crate::waveguide::{Loop, LoopError, Waveguides};

/// What a table says of an object's dynamic filter. `P` and `L` are iterators that may be run several times, such as `slice.iter().copied()`.
#[derive(Clone, Copy, Debug)]
pub struct Settings<P, L> {
    /// Seed of the noise; the stream is given to [`DynamicFilter::load`].
    pub seed: u32,
    /// The rate in Hz that the path's coefficients are for.
    pub rate_hz: f64,
    /// 1, or 2: then a2 and b2 count.
    pub order: u8,
    /// Whether the object's modes go into the filter, rather than beside it.
    pub modes_through: bool,
    /// The band of the noise, if it has any.
    pub exciter: Option<Exciter>,
    /// Breakpoints ([`Breakpoint`]), first at 0 s.
    pub path: P,
    /// Banded waveguides ([`Loop`]).
    pub loops: L,
}

/// Why a dynamic filter is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DynamicFilterError {
    /// Its path.
    Path(PathError),
    /// Its loops.
    Loop(LoopError),
    /// Its exciter's band.
    Exciter(BandError),
    /// The rate that its coefficients are for is none.
    Rate {
        /// That rate in Hz.
        rate_hz: f64,
    },
}

impl fmt::Display for DynamicFilterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Path(error) => error.fmt(f),
            Self::Loop(error) => error.fmt(f),
            Self::Exciter(error) => write!(f, "exciter: {error}"),
            Self::Rate { rate_hz } => write!(f, "coefficients for a rate of {rate_hz} Hz: give 1000 to 1000000 Hz"),
        }
    }
}

impl core::error::Error for DynamicFilterError {}

impl From<PathError> for DynamicFilterError {
    fn from(error: PathError) -> Self {
        Self::Path(error)
    }
}

impl From<LoopError> for DynamicFilterError {
    fn from(error: LoopError) -> Self {
        Self::Loop(error)
    }
}

impl From<BandError> for DynamicFilterError {
    fn from(error: BandError) -> Self {
        Self::Exciter(error)
    }
}

/// The dynamic filter of one object: at most `POINTS` breakpoints, `LOOPS` loops, and `FRAMES` frames of delay round the filter.
#[derive(Clone, Debug)]
pub struct DynamicFilter<const POINTS: usize, const LOOPS: usize, const FRAMES: usize> {
    sound: Sound<POINTS, LOOPS, FRAMES>,
    modes_through: bool,
}

#[derive(Clone, Debug)]
enum Sound<const POINTS: usize, const LOOPS: usize, const FRAMES: usize> {
    None,
    Filter(Filter<POINTS>),
    Loops(Waveguides<POINTS, LOOPS, FRAMES>),
}

impl<const POINTS: usize, const LOOPS: usize, const FRAMES: usize> DynamicFilter<POINTS, LOOPS, FRAMES> {
    /// None: gives nothing, costs nothing.
    pub const EMPTY: Self = Self { sound: Sound::None, modes_through: false };

    /// Derives all for a rate, at rest. `stream` is the number of the noise's stream, such as the pad's. After an error it is
    /// [`EMPTY`](Self::EMPTY).
    ///
    /// # Errors
    /// [`DynamicFilterError`].
    pub fn load<P, L>(
        &mut self,
        settings: Settings<P, L>,
        rate: SampleRate,
        stream: u32,
    ) -> Result<(), DynamicFilterError>
    where
        P: Iterator<Item = Breakpoint> + Clone,
        L: Iterator<Item = Loop> + Clone,
    {
        self.unload();
        let Settings { seed, rate_hz, modes_through, path, loops, .. } = settings;
        if !(1000.0..=1e6).contains(&rate_hz) {
            return Err(DynamicFilterError::Rate { rate_hz });
        }
        let filter = Filter::new(Path::new(path.clone(), rate)?, seed, stream);
        self.sound = match loops.clone().next() {
            None => Sound::Filter(filter),
            Some(_) => Sound::Loops(Waveguides::new(filter, path, loops, rate)?),
        };
        self.modes_through = modes_through;
        Ok(())
    }

    /// Makes it none.
    pub fn unload(&mut self) {
        *self = Self::EMPTY;
    }

    /// Whether the object's modes are to be given to [`render`](Self::render), rather than added to the output beside it.
    pub fn takes_modes(&self) -> bool {
        self.modes_through
    }

    /// Starts the path anew with noise of a level from 0 to 1.99 (peak force over reference force); what rings rings on. It holds from the next frame
    /// that is rendered.
    pub fn strike(&mut self, level: f32) {
        match &mut self.sound {
            Sound::None => (),
            Sound::Filter(filter) => filter.strike_with_noise(level),
            Sound::Loops(loops) => loops.strike(level),
        }
    }

    /// Whether anything sounds or may: false means that [`pass`](Self::pass) does for a block into which no modes come.
    pub fn is_ringing(&self) -> bool {
        match &self.sound {
            Sound::None => false,
            Sound::Filter(filter) => filter.is_ringing(),
            Sound::Loops(loops) => loops.is_ringing(),
        }
    }

    /// Adds a block of any length to `out`: Q4.27, saturating. `modes` (as many frames, where the table says that they go through the
    /// filter) are added to its input.
    pub fn render(&mut self, modes: Option<&[i32]>, out: &mut [i32]) {
        match &mut self.sound {
            Sound::None => (),
            Sound::Filter(filter) => filter.render(modes, out),
            Sound::Loops(loops) => loops.render(modes, out),
        }
    }

    /// Lets frames pass where nothing rings and no modes come: as a block, for nothing.
    pub fn pass(&mut self, frames: usize) {
        let mut nothing = [0; TICK_FRAMES];
        if let Some(nothing) = nothing.get_mut(..frames.min(TICK_FRAMES)) {
            self.render(None, nothing);
        }
    }

    /// Clears what rings and ends the path; the noise stays where it is.
    pub fn rest(&mut self) {
        match &mut self.sound {
            Sound::None => (),
            Sound::Filter(filter) => filter.rest(),
            Sound::Loops(loops) => loops.rest(),
        }
    }

    /// Nominal cycles of a tick while it sounds, at most, for the engine's budget; 0 where none is loaded.
    pub fn cycles_a_tick(&self) -> u32 {
        match &self.sound {
            Sound::None => 0,
            Sound::Filter(_) => 3328,
            Sound::Loops(loops) => 3328 + 5344 * loops.count() as u32,
        }
    }
}
