//! Sound of a bank over a run of frames.

use super::super::group::Group;
use super::super::kernel::{self, Backward, Stereo};
use super::super::mode::Mode;
use super::guard::MAX_ALLOWANCE;
use super::mix::MixShift;
use super::state::Bank;
use super::work::BankWork;
use crate::fixed;
use crate::output::Gains;
use crate::time::TICK_FRAMES;

impl Bank<'_> {
    /// Renders the bank's sound for a run without force, of at most a tick's frames: replaces
    /// `mix`. Gives the shift of the mix to bus samples.
    ///
    /// Costs 5.4 cycles a ringing mode and sample on a Cortex-M4F, and 250 a call, twice if it has
    /// modes above fs/4 (nominal, `cargo bench -p host-tests --bench run_time_vs_error`).
    pub fn ring(&mut self, run: kernel::Run, odd_start: bool, mix: &mut Backward) -> MixShift {
        let add = self.has_mirrored() && self.ring_mirrored(run, odd_start, mix);
        if let Some((groups, modes)) = self.plain() {
            kernel::free(groups, modes, kernel::Run { add, ..run }, mix);
        }
        self.mix_shift
    }

    /// Adds the bank's sound for a run without force straight to the stereo bus, by gains for the
    /// loudness of [`Bank::mix_shift`].
    #[inline(always)]
    pub fn ring_stereo(&mut self, run: kernel::Run, odd_start: bool, gains: Gains, out: &mut [[i32; 2]]) {
        let stereo = self.stereo(gains, out);
        if self.has_mirrored() {
            self.ring_stereo_mirrored(run, odd_start, stereo);
        } else if let Some((groups, modes)) = self.plain() {
            kernel::free_stereo(groups, modes, run, None, stereo);
        }
    }

    #[inline(never)] // its buffer must not weigh on banks without mirrored modes
    fn ring_stereo_mirrored(&mut self, run: kernel::Run, odd_start: bool, stereo: Stereo<'_>) {
        let mut mix = [0; TICK_FRAMES];
        self.ring_mirrored(run, odd_start, &mut mix);
        if let Some((groups, modes)) = self.plain() {
            kernel::free_stereo(groups, modes, run, Some(&mix), stereo);
        }
    }

    /// True if any groups are mirrored.
    #[inline(always)]
    fn has_mirrored(&self) -> bool {
        usize::from(self.plain_groups) < self.groups.len()
    }

    /// Renders the sound of the mirrored modes. True if there are any.
    #[inline(never)]
    fn ring_mirrored(&mut self, run: kernel::Run, odd_start: bool, mix: &mut Backward) -> bool {
        let Some((groups, modes)) = self.mirrored() else { return false };
        kernel::free(groups, modes, kernel::Run { add: false, ..run }, mix);
        alternate(mix, odd_start);
        true
    }

    /// True if a part of the force itself is added to the sound: gains into v have a half of `h[0]`
    /// that does not belong to the integral.
    pub fn has_onset(&self) -> bool {
        !self.onset.is_zero()
    }

    /// Shift of the bank's mix to bus samples until the next guard.
    #[inline(always)]
    pub fn mix_shift(&self) -> MixShift {
        self.mix_shift
    }

    /// Adds the bank's sound for a run of at most a tick's frames to `out`.
    ///
    /// `force` is the input in bus steps, `None` without input. `odd_start` is true if the absolute
    /// number of the first frame is odd. `skip` leaves out groups at rest and the input work of a
    /// zero force. No bit depends on the cut of time into runs.
    pub fn render(&mut self, force: Option<&[i32]>, odd_start: bool, skip: bool, out: &mut [i32]) -> BankWork {
        self.render_slots((force, None), odd_start, skip, out)
    }

    /// Renders as [`Bank::render`] does, under a force at the position of slot 0 and an optional
    /// one, as long, at that of slot 1.
    #[inline(never)] // one for both
    pub fn render_slots(
        &mut self,
        (force, second): (Option<&[i32]>, Option<&[i32]>),
        odd_start: bool,
        skip: bool,
        out: &mut [i32],
    ) -> BankWork {
        let mut work = BankWork::default();
        let mut second = second.filter(|_| self.has_second_gains()).unwrap_or(&[]);
        let mut sum = force.map_or(0, fixed::sum_of_magnitudes) + fixed::sum_of_magnitudes(second);
        let Some(force) = force.filter(|_| !skip || sum > 0) else {
            if self.is_ringing() || !skip {
                self.ring_on_bus(odd_start, skip, out);
                work.free_mode_frames += self.running_modes(skip) * out.len().min(TICK_FRAMES) as u32;
            }
            return work;
        };
        let (mut force, mut out, mut odd) = (force, out, odd_start);
        while !force.is_empty() && !out.is_empty() {
            let (count, spent) = affordable(force, second, sum, self.allowance);
            if count == 0 {
                let next = magnitude(force.first()) + magnitude(second.first());
                // For a tick of twice this force, or four times the force of this tick so far, at
                // most the largest possible force.
                let wanted = (next * 2 * TICK_FRAMES as u64).max(self.spent.saturating_mul(4));
                self.guard(wanted.min(MAX_ALLOWANCE), true);
                self.is_covered = false;
                work.extra_guards += 1;
                continue;
            }
            let (now, later) = force.split_at_checked(count).unwrap_or((force, &[]));
            let (out_now, out_later) =
                core::mem::take(&mut out).split_at_mut_checked(count).unwrap_or((&mut [], &mut []));
            let (second_now, second_later) = second.split_at_checked(count).unwrap_or((second, &[]));
            if second_now.is_empty() {
                self.drive(now, odd, skip, out_now);
            } else {
                self.drive_both((now, second_now), odd, skip, out_now);
            }
            second = second_later;
            work.driven_mode_frames += self.running_modes(skip) * count as u32;
            work.refused += u32::from(self.refusing);
            self.allowance -= spent;
            sum -= spent;
            self.spent = self.spent.saturating_add(spent);
            (force, out, odd) = (later, out_later, odd ^ (count % 2 == 1));
        }
        work
    }

    /// Adds a run without force to the bus.
    #[inline(never)] // its buffer must not weigh on runs with force
    fn ring_on_bus(&mut self, odd_start: bool, skip: bool, out: &mut [i32]) {
        let run = kernel::Run { frames: out.len().min(TICK_FRAMES), skip, add: false };
        let mut mix = [0; TICK_FRAMES];
        let shift = self.ring(run, odd_start, &mut mix);
        self.add_to_bus(&mix, shift, None, out);
    }

    /// Number of modes that a run takes: those that ring, or all.
    #[inline(always)]
    pub fn running_modes(&self, skip: bool) -> u32 {
        if skip { u32::from(self.ringing_modes) } else { self.modes.len() as u32 }
    }

    /// Destination of the mix.
    #[inline(always)]
    fn stereo<'o>(&self, gains: Gains, out: &'o mut [[i32; 2]]) -> Stereo<'o> {
        let Gains { left, right, shift } = gains;
        let bits = u32::from(self.mix_shift.bits);
        match self.mix_shift.is_loud {
            true => Stereo { out, left, right, doublings: bits, shift },
            false => Stereo { out, left, right, doublings: 0, shift: bits + shift },
        }
    }

    /// Adds the bank's sound for a run under a force straight to the stereo bus, by gains for the
    /// loudness of [`Bank::mix_shift`]. `None`, and nothing happens, if the bank is too loud to add
    /// its onset without a clip, or not guarded for so much force.
    pub fn render_stereo(
        &mut self,
        force: &[i32],
        odd_start: bool,
        gains: Gains,
        out: &mut [[i32; 2]],
    ) -> Option<BankWork> {
        if self.has_onset() {
            return self.drive_stereo_with_onset(force, odd_start, gains, out);
        }
        self.drive_stereo(force, None, odd_start, gains, out)
    }

    #[inline(never)] // its buffer must not weigh on banks without
    fn drive_stereo_with_onset(
        &mut self,
        force: &[i32],
        odd_start: bool,
        gains: Gains,
        out: &mut [[i32; 2]],
    ) -> Option<BankWork> {
        let mut onset = [0; TICK_FRAMES];
        self.onset_mix(force, gains.shift, &mut onset).then_some(())?;
        self.drive_stereo(force, Some(&onset), odd_start, gains, out)
    }

    #[inline(never)] // one for both
    fn drive_stereo(
        &mut self,
        force: &[i32],
        onset: Option<&Backward>,
        odd_start: bool,
        gains: Gains,
        out: &mut [[i32; 2]],
    ) -> Option<BankWork> {
        let sum = fixed::sum_of_magnitudes(force);
        self.allowance = self.allowance.checked_sub(sum).filter(|_| sum > 0)?;
        self.spent = self.spent.saturating_add(sum);
        let run = kernel::Run { frames: out.len().min(TICK_FRAMES), skip: true, add: false };
        let stereo = self.stereo(gains, out);
        let mut shifted = self.shifted(force);
        if self.has_mirrored() {
            self.drive_stereo_mirrored(run, (&mut shifted, onset), odd_start, stereo);
        } else if let Some((groups, modes)) = self.plain() {
            kernel::driven_stereo(groups, modes, run, &shifted, onset, stereo);
        }
        let driven_mode_frames = self.running_modes(true) * run.frames as u32;
        Some(BankWork { driven_mode_frames, refused: u32::from(self.refusing), ..BankWork::default() })
    }

    /// True if modes and onset together need no clip on the stereo bus, and have its unit.
    pub fn can_add_onset(&self, pan_shift: u32) -> bool {
        // Half of the range of a bus sample is for the modes, the other half for the onset.
        self.mix_shift.bits == 0 && u32::from(self.mix_bits) + pan_shift <= 30
    }

    /// Direct addition of the force to the sound. False if the bank is too loud for it
    /// ([`Bank::can_add_onset`]), or its half of the range does not suffice.
    fn onset_mix(&self, force: &[i32], pan_shift: u32, mix: &mut Backward) -> bool {
        if !self.can_add_onset(pan_shift) {
            return false;
        }
        let (onset, mut signs) = (self.onset, 0);
        let doublings = onset.doublings();
        for (sum, &x) in mix.iter_mut().rev().zip(force) {
            let undoubled = onset.undoubled(x);
            *sum = undoubled.wrapping_shl(doublings);
            signs |= undoubled ^ (undoubled >> 31);
        }
        // Only samples beyond the range lose bits by the shift.
        30u32.checked_sub(pan_shift + doublings).is_some_and(|range_bits| signs < 1 << range_bits)
    }

    #[inline(never)] // its buffer must not weigh on banks without mirrored modes
    fn drive_stereo_mirrored(
        &mut self,
        run: kernel::Run,
        (shifted, onset): (&mut Backward, Option<&Backward>),
        odd_start: bool,
        stereo: Stereo<'_>,
    ) {
        let mut mix = [0; TICK_FRAMES];
        self.drive_mirrored(run, shifted, odd_start, &mut mix);
        if let Some(onset) = onset {
            // Within the ranges of the bank and of the onset.
            mix.iter_mut().zip(onset).for_each(|(sum, x)| *sum = sum.wrapping_add(*x));
        }
        if let Some((groups, modes)) = self.plain() {
            kernel::driven_stereo(groups, modes, run, shifted, Some(&mix), stereo);
        }
    }

    /// Force as the gains expect it.
    #[inline(always)]
    fn shifted(&self, force: &[i32]) -> Backward {
        let force_shift = u32::from(self.force_shift);
        let mut shifted = [0; TICK_FRAMES];
        // Within the allowance |x| << force_shift stays below 2^31.
        for (shifted, &x) in shifted.iter_mut().rev().zip(force) {
            *shifted = x.wrapping_shl(force_shift);
        }
        shifted
    }

    /// Renders the sound of the mirrored modes under a force. True if there are any.
    #[inline(never)]
    fn drive_mirrored(
        &mut self,
        run: kernel::Run,
        shifted: &mut Backward,
        odd_start: bool,
        mix: &mut Backward,
    ) -> bool {
        let Some((groups, modes)) = self.mirrored() else { return false };
        alternate(shifted, odd_start);
        kernel::driven(groups, modes, run, shifted, mix);
        alternate(shifted, odd_start);
        alternate(mix, odd_start);
        true
    }

    /// Adds a run under a force for which the groups are guarded.
    fn drive(&mut self, force: &[i32], odd_start: bool, skip: bool, out: &mut [i32]) {
        let run = kernel::Run { frames: out.len().min(TICK_FRAMES), skip, add: false };
        let (mut mix, mut shifted) = ([0; TICK_FRAMES], self.shifted(force));
        let add = self.has_mirrored() && self.drive_mirrored(run, &mut shifted, odd_start, &mut mix);
        if let Some((groups, modes)) = self.plain() {
            kernel::driven(groups, modes, kernel::Run { add, ..run }, &shifted, &mut mix);
        }
        self.add_to_bus(&mix, self.mix_shift, Some(force), out);
    }

    /// Adds a run with a force in both slots.
    #[inline(never)] // it must not weigh on runs with one
    fn drive_both(&mut self, (force, second): (&[i32], &[i32]), odd_start: bool, skip: bool, out: &mut [i32]) {
        let run = kernel::Run { frames: out.len().min(TICK_FRAMES), skip, add: true };
        let (mut mix, mut forces) = ([0; TICK_FRAMES], [self.shifted(force), self.shifted(second)]);
        let (plain_groups, plain_modes) = (usize::from(self.plain_groups), usize::from(self.plain_modes));
        let (groups, modes, gains) = (&*self.groups, &mut *self.modes, &*self.second.gains);
        let (groups, mirrored) = groups.split_at_checked(plain_groups).unwrap_or((groups, &[]));
        let (modes, mirrored_modes) = modes.split_at_mut_checked(plain_modes).unwrap_or((&mut [], &mut []));
        let (gains, mirrored_gains) = gains.split_at_checked(plain_modes).unwrap_or((&[], &[]));
        if !mirrored.is_empty() {
            forces.iter_mut().for_each(|force| alternate(force, odd_start));
            kernel::driven_twice(mirrored, (mirrored_modes, mirrored_gains), run, &forces, &mut mix);
            forces.iter_mut().for_each(|force| alternate(force, odd_start));
            alternate(&mut mix, odd_start);
        }
        kernel::driven_twice(groups, (modes, gains), run, &forces, &mut mix);
        let frames = out.iter_mut().zip(mix.iter().rev());
        for ((out, &sum), (&x, &y)) in frames.zip(force.iter().zip(second)) {
            let at_once = self.onset.apply(x) + self.second.onset.apply(y);
            *out = fixed::qadd(*out, fixed::saturate((i64::from(sum) << self.mix_shift.bits) + at_once));
        }
    }

    /// Groups of the plain side, and the bank's modes.
    #[inline(always)]
    fn plain(&mut self) -> Option<(&[Group], &mut [Mode])> {
        Some((self.groups.get(..usize::from(self.plain_groups))?, self.modes))
    }

    /// Groups of the mirrored side, and their modes; `None` if there are none.
    fn mirrored(&mut self) -> Option<(&[Group], &mut [Mode])> {
        let groups = self.groups.get(usize::from(self.plain_groups)..).filter(|groups| !groups.is_empty())?;
        Some((groups, self.modes.get_mut(usize::from(self.plain_modes)..)?))
    }

    /// Adds the mix to the bus. Modes and onset cancel where the force rises, so that only their
    /// sum may saturate.
    fn add_to_bus(&self, mix: &Backward, shift: MixShift, force: Option<&[i32]>, out: &mut [i32]) {
        let Some(mix) = mix.get(TICK_FRAMES.saturating_sub(out.len())..) else { return };
        let frames = out.iter_mut().zip(mix.iter().rev());
        match force.filter(|_| !self.onset.is_zero()) {
            Some(force) if self.is_within_bus(mix, shift, force) => {
                let (bits, doublings) = (u32::from(shift.bits), self.onset.doublings());
                for ((out, &sum), &x) in frames.zip(force) {
                    let at_once = self.onset.undoubled(x).wrapping_shl(doublings);
                    *out = fixed::qadd(*out, sum.wrapping_shl(bits).wrapping_add(at_once)); // both < 2^30
                }
            }
            Some(force) => {
                for ((out, &sum), &x) in frames.zip(force) {
                    let sound = (i64::from(sum) << shift.bits) + self.onset.apply(x);
                    *out = fixed::qadd(*out, fixed::saturate(sound));
                }
            }
            None => frames.for_each(|(out, &sum)| *out = fixed::qadd(*out, shift.to_bus(sum))),
        }
    }

    /// True if neither the mix nor the onset of a force reaches half the range of the bus.
    fn is_within_bus(&self, mix: &[i32], shift: MixShift, force: &[i32]) -> bool {
        let bits = |samples: &[i32]| samples.iter().fold(0, |bits, x| bits | x ^ (x >> 31));
        // A power of two less one: at least each magnitude of the force.
        let bound = (i32::MAX as u32 >> bits(force).leading_zeros().saturating_sub(1)) as i32;
        let most = u64::from(self.onset.undoubled(bound).unsigned_abs()) + 1;
        shift.bits < 30 && bits(mix) < 1 << (30 - shift.bits) && most << self.onset.doublings() < 1 << 30
    }
}

/// Changes the sign of every other frame, so that the absolute number of the others is odd if the
/// first frame's is (`odd_start`). Frames beyond a run are 0 or unused.
#[inline(never)] // a call's registers weigh less on the stack than the loop's
fn alternate(samples: &mut Backward, odd_start: bool) {
    for [odd, even] in samples.as_chunks_mut::<2>().0 {
        // Backward: the first frame lies last.
        let x = if odd_start { even } else { odd };
        *x = x.saturating_neg();
    }
}

fn magnitude(x: Option<&i32>) -> u64 {
    x.map_or(0, |x| u64::from(x.unsigned_abs()))
}

/// Longest beginning of a force whose sum of magnitudes, with those of a second one, is within the
/// allowance, and that sum; `at_most` is a bound of the whole sum.
fn affordable(force: &[i32], second: &[i32], at_most: u64, allowance: u64) -> (usize, u64) {
    if at_most <= allowance {
        return (force.len(), at_most);
    }
    let mut spent = 0;
    let mut count = 0;
    for (index, x) in force.iter().enumerate() {
        let more = spent + u64::from(x.unsigned_abs()) + magnitude(second.get(index));
        if more > allowance {
            break;
        }
        spent = more;
        count += 1;
    }
    (count, spent)
}
