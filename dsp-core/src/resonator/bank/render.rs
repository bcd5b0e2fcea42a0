//! A bank's sound over a run of frames.

use super::super::TICK_FRAMES;
use super::super::group::Group;
use super::super::kernel::{self, Backward};
use super::super::mode::Mode;
use super::guard::MAX_ALLOWANCE;
use super::{Bank, BankWork, Memory};
use crate::fixed;

impl Bank {
    /// Adds the bank's sound for a run of at most a tick's frames to `out`.
    ///
    /// `force` is the input in bus steps, `None` where there is none; `odd_start` says whether the first frame's absolute number is odd;
    /// `skip` leaves out groups at rest and the input work of a zero force. The bits do not depend on how a caller cuts time into runs.
    pub fn render(
        &mut self,
        memory: &mut Memory<'_>,
        force: Option<&[i32]>,
        odd_start: bool,
        skip: bool,
        out: &mut [i32],
    ) -> BankWork {
        let mut work = BankWork::default();
        let mut sum = force.map_or(0, sum_of_magnitudes);
        let Some(force) = force.filter(|_| !skip || sum > 0) else {
            if self.is_ringing() || !skip {
                self.run(memory, None, odd_start, skip, out, &mut work);
            }
            return work;
        };
        let (mut force, mut out, mut odd) = (force, out, odd_start);
        while !force.is_empty() && !out.is_empty() {
            let (count, spent) = affordable(force, sum, self.allowance);
            if count == 0 {
                let next = force.first().map_or(0, |x| u64::from(x.unsigned_abs()));
                // Room for a tick of twice this force, or four times what this tick has brought already, at most for what can come at all.
                let wanted = (next * 2 * TICK_FRAMES as u64).max(self.spent.saturating_mul(4));
                self.guard(memory, wanted.min(MAX_ALLOWANCE), true, None);
                work.extra_guards += 1;
                continue;
            }
            let (now, later) = force.split_at_checked(count).unwrap_or((force, &[]));
            let (out_now, out_later) =
                core::mem::take(&mut out).split_at_mut_checked(count).unwrap_or((&mut [], &mut []));
            self.run(memory, Some(now), odd, skip, out_now, &mut work);
            work.refused += u32::from(self.refusing);
            self.allowance -= spent;
            sum -= spent;
            self.spent = self.spent.saturating_add(spent);
            (force, out, odd) = (later, out_later, odd ^ (count % 2 == 1));
        }
        work
    }

    /// A run for which the groups are guarded.
    fn run(
        &mut self,
        memory: &mut Memory<'_>,
        force: Option<&[i32]>,
        odd_start: bool,
        skip: bool,
        out: &mut [i32],
        work: &mut BankWork,
    ) {
        let run = kernel::Run { frames: out.len().min(TICK_FRAMES), skip };
        let modes = memory.modes.get_mut(self.modes.range()).unwrap_or(&mut []);
        let groups = memory.groups.get(self.groups.range()).unwrap_or(&[]);
        let (Some((plain, mirrored)), Some((plain_groups, mirrored_groups))) = (
            modes.split_at_mut_checked(usize::from(self.plain_modes)),
            groups.split_at_checked(usize::from(self.plain_groups)),
        ) else {
            return; // they were loaded within
        };
        let mut mix: Backward = [0; TICK_FRAMES];
        self.side(plain_groups, plain, force, None, run, &mut mix);
        if !mirrored_groups.is_empty() {
            let mut mirrored_mix = [0; TICK_FRAMES];
            self.side(mirrored_groups, mirrored, force, Some(odd_start), run, &mut mirrored_mix);
            for (frame, (sum, &x)) in mix.iter_mut().rev().zip(mirrored_mix.iter().rev()).enumerate() {
                // The bounds of both sides' modes together stay below 2^31: nothing wraps.
                *sum = if odd_start == (frame % 2 == 1) { sum.wrapping_add(x) } else { sum.wrapping_sub(x) };
            }
        }
        self.add_to_bus(&mix, force, out);
        let ran = if skip { u32::from(self.ringing_modes) } else { self.modes.range().len() as u32 } * run.frames as u32;
        match force {
            Some(_) => work.driven_mode_frames += ran,
            None => work.free_mode_frames += ran,
        }
    }

    /// The groups of one side, plain or (with the parity of the first frame) mirrored.
    fn side(
        &self,
        groups: &[Group],
        modes: &mut [Mode],
        force: Option<&[i32]>,
        mirrored: Option<bool>,
        run: kernel::Run,
        mix: &mut Backward,
    ) {
        let Some(force) = force else { return kernel::free(groups, modes, run, mix) };
        let mut shifted: Backward = [0; TICK_FRAMES];
        let force_shift = u32::from(self.force_shift);
        // Within the allowance |x| << force_shift stays below 2^31.
        for (shifted, &x) in shifted.iter_mut().rev().zip(force) {
            *shifted = x.wrapping_shl(force_shift);
        }
        if let Some(odd_start) = mirrored {
            shifted.iter_mut().rev().skip(usize::from(!odd_start)).step_by(2).for_each(|x| *x = x.saturating_neg());
        }
        kernel::driven(groups, modes, run, &shifted, mix);
    }

    /// Brings the mix to the bus. Modes and onset cancel where the force rises, so that only their sum may saturate.
    fn add_to_bus(&self, mix: &Backward, force: Option<&[i32]>, out: &mut [i32]) {
        let mix_exponent = u32::from(self.mix_exponent);
        let sums = mix.iter().rev();
        match force.filter(|_| !self.onset.is_zero()) {
            Some(force) => {
                for (out, (&sum, &x)) in out.iter_mut().zip(sums.zip(force)) {
                    let sound = (i64::from(sum) << mix_exponent) + self.onset.apply_wide(x);
                    *out = fixed::qadd(*out, fixed::saturate(sound));
                }
            }
            None if mix_exponent == 0 => {
                out.iter_mut().zip(sums).for_each(|(out, &sum)| *out = fixed::qadd(*out, sum));
            }
            None => {
                for (out, &sum) in out.iter_mut().zip(sums) {
                    *out = fixed::qadd(*out, fixed::saturating_shift_left(sum, mix_exponent));
                }
            }
        }
    }
}

fn sum_of_magnitudes(force: &[i32]) -> u64 {
    force.iter().fold(0, |sum, x| sum + u64::from(x.unsigned_abs()))
}

/// The longest beginning of a force whose sum of magnitudes is within the allowance, and that sum; `at_most` is a bound of the whole sum.
fn affordable(force: &[i32], at_most: u64, allowance: u64) -> (usize, u64) {
    if at_most <= allowance {
        return (force.len(), at_most);
    }
    let mut spent = 0;
    let mut count = 0;
    for x in force {
        let more = spent + u64::from(x.unsigned_abs());
        if more > allowance {
            break;
        }
        spent = more;
        count += 1;
    }
    (count, spent)
}
