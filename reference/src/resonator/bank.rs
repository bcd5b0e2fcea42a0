//! A bank: all modes of one object, driven by one force.

use std::fmt;

use super::mode::Mode;
use super::one_pole::OnePole;
use crate::rate::SampleRate;

/// Bank of the modes of an object or striker, vibrating at one sample rate.
///
/// A mode and sample costs 3.4 ns while ringing and 3.6 ns while driven: 60 modes over 10 s at 48
/// kHz took 0.10 s (one core of a server's Xeon, optimisation level 2). Modes at rest cost next to
/// nothing.
#[derive(Clone, Debug)]
pub struct Bank<'a> {
    modes: &'a [Mode],
    rate: SampleRate,
    /// One filter for each mode; `None` for a mode at or above Nyquist, which is never rendered.
    one_poles: Vec<Option<OnePole>>,
    /// Least decay in 1/s that the hand imposes; 0 without a hand.
    least_decay_per_s: f64,
    /// Number of modes below Nyquist that the latest choke or release has reached.
    reached: usize,
}

/// Number of modes below Nyquist that a choke or a release reaches at each tick.
pub const MODES_PER_TICK: usize = 16;

impl<'a> Bank<'a> {
    /// Bank at rest, to be struck at position 0.
    ///
    /// # Errors
    /// [`GainsError`] unless all `modes` have gains at the same number of positions, 1 or more.
    pub fn new(modes: &'a [Mode], rate: SampleRate) -> Result<Self, GainsError> {
        Self::of(modes, rate, OnePole::new)
    }

    /// Bank at rest in which a constant force falls silent.
    ///
    /// Beside each mode it adds a share of the force that cancels the mode's static response. A
    /// hand does not change that share.
    ///
    /// # Errors
    /// [`GainsError`] unless all `modes` have gains at the same number of positions, 1 or more.
    pub fn balanced(modes: &'a [Mode], rate: SampleRate) -> Result<Self, GainsError> {
        Self::of(modes, rate, OnePole::balanced)
    }

    fn of(
        modes: &'a [Mode],
        rate: SampleRate,
        one_pole: impl Fn(f64, f64, SampleRate) -> OnePole,
    ) -> Result<Self, GainsError> {
        let expected = modes.first().map_or(1, |mode| mode.gains.len().max(1));
        for (index, mode) in modes.iter().enumerate() {
            let found = mode.gains.len();
            if found != expected {
                return Err(GainsError { mode: index, found, expected });
            }
        }
        let one_poles = modes.iter().map(|mode| {
            let below_nyquist = mode.frequency_hz < rate.hz() / 2.0;
            below_nyquist.then(|| one_pole(mode.frequency_hz, mode.decay_per_s, rate))
        });
        let mut bank =
            Self { modes, rate, one_poles: one_poles.collect(), least_decay_per_s: 0.0, reached: usize::MAX };
        bank.set_position(0.0);
        Ok(bank)
    }

    /// Moves the contact to `position`, 0 to 1 along the object, for all force from now on
    /// ([`Mode::gain_at`]).
    ///
    /// The sound that rings already does not change.
    pub fn set_position(&mut self, position: f64) {
        for (mode, one_pole) in self.modes.iter().zip(&mut self.one_poles) {
            if let (Some(one_pole), Some(gain)) = (one_pole, mode.gain_at(position)) {
                one_pole.set_gain(gain, self.rate);
            }
        }
    }

    /// Lays a hand on the modes: each decays from then on at least as fast as a T60 of `t60_s`
    /// seconds.
    ///
    /// Its decay rate is `max(d, ln(1000)/T60)`. Each call of [`Self::reach`] changes
    /// [`MODES_PER_TICK`] modes, in their order; modes at or above Nyquist do not count. A choke or
    /// release before all modes are reached begins anew. The last two samples and the frequency of
    /// a mode stay as they were: `OnePole::set_decay`.
    pub fn choke(&mut self, t60_s: f64) {
        self.set_least_decay(1000_f64.ln() / t60_s);
    }

    /// Lifts the hand: [`Self::reach`] gives the modes their own decay rates back.
    pub fn release(&mut self) {
        self.set_least_decay(0.0);
    }

    fn set_least_decay(&mut self, least_per_s: f64) {
        if self.least_decay_per_s != least_per_s {
            (self.least_decay_per_s, self.reached) = (least_per_s, 0);
        }
    }

    /// Carries a choke or release on to the next modes.
    ///
    /// Must be called at each tick, which is each sample whose number is a multiple of 32.
    pub fn reach(&mut self) {
        let rendered = self.modes.iter().zip(&mut self.one_poles);
        let rendered = rendered.filter_map(|(mode, one_pole)| Some((mode, one_pole.as_mut()?)));
        for (mode, one_pole) in rendered.skip(self.reached).take(MODES_PER_TICK) {
            one_pole.set_decay(mode.decay_per_s.max(self.least_decay_per_s), self.rate);
        }
        self.reached = self.reached.saturating_add(MODES_PER_TICK);
    }

    /// Attenuates the vibration of all modes by a factor.
    pub fn attenuate(&mut self, factor: f64) {
        self.one_poles.iter_mut().flatten().for_each(|one_pole| one_pole.attenuate(factor));
    }

    /// True while a choke or release has modes left to reach.
    pub fn is_being_reached(&self) -> bool {
        self.reached < self.one_poles.iter().flatten().count()
    }

    /// Adds the bank's sound (full scale) under `force` (newtons) to `sound`, sample by sample.
    ///
    /// The shorter of the two slices sets the length. Any division into blocks gives the same bits.
    pub fn add_sound(&mut self, force: &[f64], sound: &mut [f64]) {
        let length = force.len().min(sound.len());
        let mut start = 0;
        // Runs with and without force are separate, because a mode without force needs fewer
        // operations.
        for run in force[..length].chunk_by(|a, b| (*a == 0.0) == (*b == 0.0)) {
            let sound = &mut sound[start..start + run.len()];
            for one_pole in self.one_poles.iter_mut().flatten() {
                if run[0] == 0.0 {
                    one_pole.ring(sound);
                } else {
                    one_pole.drive(run, sound);
                }
            }
            start += run.len();
        }
    }

    /// Adds the bank's sound under several forces at a time, each as long as `sound`.
    ///
    /// Every force drives the gains of its own position. The bank stays at the last position.
    pub fn add_sound_at(&mut self, forces: &[(f64, &[f64])], sound: &mut [f64]) {
        if let [(position, force)] = forces {
            self.set_position(*position);
            return self.add_sound(force, sound);
        }
        for index in 0..self.one_poles.len() {
            let mut inputs = Vec::new();
            for (position, force) in forces {
                if let (Some(one_pole), Some(gain)) = (&mut self.one_poles[index], self.modes[index].gain_at(*position))
                {
                    one_pole.set_gain(gain, self.rate);
                    inputs.push((one_pole.input(), *force));
                }
            }
            if let Some(one_pole) = &mut self.one_poles[index] {
                one_pole.drive_at(&inputs, sound);
            }
        }
    }

    /// Amplitude `|z|` (full scale) of every mode after the last sample computed, in their order.
    ///
    /// It is 0 for a mode that is never rendered.
    pub fn amplitudes(&self) -> impl Iterator<Item = f64> {
        self.one_poles.iter().map(|one_pole| one_pole.as_ref().map_or(0.0, OnePole::amplitude))
    }

    /// True if the bank has no modes.
    pub fn is_empty(&self) -> bool {
        self.modes.is_empty()
    }
}

/// Error: a mode has gains at another number of positions than the bank's first mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GainsError {
    /// Index of the mode in the bank, from 0.
    pub mode: usize,
    /// Number of positions at which the mode has gains.
    pub found: usize,
    /// Number of positions at which the bank's first mode has gains; 1 if it has none.
    pub expected: usize,
}

impl fmt::Display for GainsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mode, found, expected } = self;
        write!(
            f,
            "mode {mode} has gains at {found} positions where {expected} are expected: give all \
             modes of a bank the same number, 1 or more"
        )
    }
}

impl std::error::Error for GainsError {}
