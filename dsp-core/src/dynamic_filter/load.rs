//! Size, memory and derivation of a dynamic filter.

use super::error::DynamicFilterError;
use super::object::{DynamicFilter, FilterSize};
use super::path::{Input, Path};
use super::settings::{Breakpoint, Exciter, Loop, Settings};
use super::stability;
use crate::SampleRate;
use crate::memory::{Memory, OutOfMemory};
use crate::noise::White;
use crate::time::TICK_FRAMES;
use crate::waveguide::Loops;

impl<'m> DynamicFilter<'m> {
    /// Size of the filter that these settings describe, at a rate.
    ///
    /// # Errors
    /// [`DynamicFilterError`] for invalid loops.
    pub fn size<P, L>(settings: &Settings<P, L>, rate: SampleRate) -> Result<FilterSize, DynamicFilterError>
    where
        P: Iterator<Item = Breakpoint> + Clone,
        L: Iterator<Item = Loop> + Clone,
    {
        Ok(FilterSize {
            breakpoints: settings.path.clone().count(),
            loops: settings.loops.clone().count(),
            line_frames: Loops::line_frames(settings.loops.clone(), rate)?,
        })
    }

    /// Takes the memory of a filter, which is silent until it is loaded.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(memory: &mut Memory<'m>, size: FilterSize) -> Result<Self, OutOfMemory> {
        let path = Path::take(memory, size.breakpoints)?;
        let loops = Loops::take(memory, size.loops, size.line_frames)?;
        let mut taken = Self { loops, ..Self::empty() };
        taken.filter.path = path;
        Ok(taken)
    }

    /// Derives the filter for a rate, at rest, in memory that was taken for the settings'
    /// [`size`](Self::size).
    ///
    /// `stream` is the number of the noise's stream, such as the pad's. After an error the filter
    /// is not loaded, and strikes do nothing.
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
        self.derive(settings, rate, stream, false)
    }

    /// Derives the filter as [`load`](Self::load) does.
    ///
    /// `is_known` is true if the settings have been loaded without memory before. The stability of
    /// their loops is then not checked again, because that takes most of a load.
    ///
    /// # Errors
    /// [`DynamicFilterError`].
    pub(crate) fn derive<P, L>(
        &mut self,
        settings: Settings<P, L>,
        rate: SampleRate,
        stream: u32,
        is_known: bool,
    ) -> Result<(), DynamicFilterError>
    where
        P: Iterator<Item = Breakpoint> + Clone,
        L: Iterator<Item = Loop> + Clone,
    {
        self.loaded = false;
        let Settings { seed, rate_hz, order, modes_through, exciter, path, loops } = settings;
        if !(SampleRate::MIN_HZ..=SampleRate::MAX_HZ).contains(&rate_hz) {
            return Err(DynamicFilterError::Rate { rate_hz });
        }
        let ratio = rate.hz() / rate_hz;
        let looped = loops.clone().next().is_some();
        let alone = !looped && exciter.is_none() && !modes_through;
        self.plain = order == 1 && alone && path.clone().all(|point| point.noise == 1.0);
        let input = match (self.plain, looped) {
            (true, _) => Input::Noise,
            (false, true) => Input::Sums,
            (false, false) => Input::Words,
        };
        self.filter.path.load(order, path.clone(), rate, ratio, input)?;
        let path = path.map(move |point| point.carried(order, ratio));
        self.filter.start(White::new(seed, stream));
        let largest_gain = self.filter.path.gain;
        let stable = |all: &[_]| match is_known {
            true => Ok(()),
            false => stability::check(order, largest_gain, path, all, rate),
        };
        self.loops.load(loops, self.filter.line_scale(), rate, stable)?;
        self.filter.expect_sums(self.loops.is_coarse());
        let by_tick = self.loops.run_length(TICK_FRAMES) == TICK_FRAMES;
        self.looped = looped && by_tick && exciter.is_none() && !self.filter.path.has_levels;
        if let Some(exciter) = exciter {
            let largest = Exciter::LARGEST_EXPONENT;
            if !(-largest..=largest).contains(&exciter.exponent) {
                return Err(DynamicFilterError::Exponent { exponent: exciter.exponent });
            }
            self.exciter.load(&exciter, rate)?;
        }
        self.level_unit = (268_435_456.0 * libm::sqrt(ratio)) as f32;
        (self.modes_through, self.loaded) = (modes_through, true);
        Ok(())
    }
}
