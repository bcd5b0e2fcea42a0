//! Sound of a voice over a run of frames.

use super::filters::FilterWork;
use super::state::{PadWork, Run, Voice};
use crate::contact::ActiveContacts;
use crate::fixed;
use crate::resonator::kernel;
use crate::resonator::{Bank, BankWork};
use crate::time::TICK_FRAMES;

impl Voice<'_, '_> {
    /// Adds a run without force to the stereo bus; gives the mode-frames of the object's bank and
    /// of the strikers' banks.
    #[inline(never)]
    pub fn ring(&mut self, frames: usize, odd_start: bool, out: &mut [[i32; 2]]) -> (u32, u32) {
        let Some((object, strikers)) = self.banks.split_first_mut() else { return (0, 0) };
        let object_modes = object.running_modes(true);
        let striker_modes = strikers.iter().map(|bank| bank.running_modes(true)).sum::<u32>();
        match self.panner.gains(object.mix_shift().is_loud).filter(|_| striker_modes == 0) {
            // The usual case, in one pass, with the bits of the other.
            Some(gains) => {
                let run = kernel::Run { frames, skip: true, add: false };
                object.ring_stereo(run, odd_start, gains, out);
            }
            None => self.ring_on_bus(frames, odd_start, out),
        }
        (object_modes * frames as u32, striker_modes * frames as u32)
    }

    /// Adds a run without force to the stereo bus, by way of the pad's own bus.
    #[inline(never)]
    pub(super) fn ring_on_bus(&mut self, frames: usize, odd_start: bool, out: &mut [[i32; 2]]) {
        let mut sound = [0; TICK_FRAMES];
        let Some(sound) = sound.get_mut(..frames) else { return };
        // The object's bank is last, as under a force: a sum that is clipped depends on the order.
        let Some((object, strikers)) = self.banks.split_first_mut() else { return };
        strikers.iter_mut().chain([object]).for_each(|bank| {
            bank.render(None, odd_start, true, sound);
        });
        if let Some(object) = self.frames.as_deref_mut() {
            object.render([None; 2], sound);
            self.add_noise_of_frames(sound);
        }
        self.panner.render(sound, out);
    }

    /// Adds a run under a force, or one that skips nothing, to the stereo bus.
    #[inline(never)] // its buffers must not weigh on runs without force
    pub fn drive(&mut self, run: Run<'_>, contacts: &mut ActiveContacts<'_>, out: &mut [[i32; 2]]) -> PadWork {
        self.wake();
        let mut work = PadWork::default();
        let frames = run.frames.min(TICK_FRAMES);
        let mut force = [0; TICK_FRAMES];
        let Some(force) = force.get_mut(..frames) else { return work };
        if run.direct.is_some() || contacts.is_any_on(self.number) {
            self.struck = true;
            work.force_frames = frames as u32;
            work.direct_frames = if run.direct.is_some() { frames as u32 } else { 0 };
        }
        let has_second = self.has_second(run.direct, contacts);
        if let [object] = &mut *self.banks
            && !has_second
        {
            take_force(self.number, run.direct, contacts, force);
            // The usual case, in one pass, with the bits of the others.
            let gains = self.panner.gains(object.mix_shift().is_loud);
            if let Some(gains) = gains.filter(|_| run.skip && !self.acceleration.is_built())
                && let Some(object) = object.render_stereo(force, run.odd_start, gains, out)
            {
                work.object = object;
                return work;
            }
        }
        if has_second {
            self.drive_both_on_bus(run, contacts, force, out, &mut work);
        } else {
            self.drive_on_bus(run, contacts, force, out, &mut work);
        }
        work
    }

    /// True if a force acts at the position of slot 1.
    #[inline(always)]
    fn has_second(&self, direct: Option<&[i32]>, contacts: &ActiveContacts<'_>) -> bool {
        self.banks.first().is_some_and(Bank::has_second_gains)
            && (contacts.is_any_in(self.number, 1) || direct.is_some() && self.direct_slot() == 1)
    }

    /// Completes [`Voice::drive`] by way of the pad's own bus. `force` holds the force already if
    /// no striker has a bank.
    #[inline(never)] // its buffer must not weigh on pads that do without
    pub(super) fn drive_on_bus(
        &mut self,
        run: Run<'_>,
        contacts: &mut ActiveContacts<'_>,
        force: &mut [i32],
        out: &mut [[i32; 2]],
        work: &mut PadWork,
    ) {
        let mut sound = [0; TICK_FRAMES];
        let Some(sound) = sound.get_mut(..force.len()) else { return };
        self.add_driven(run, contacts, (force, None), (sound, None), work);
        self.add_noise_of_frames(sound);
        self.panner.render(sound, out);
    }

    /// Completes [`Voice::drive`] by way of the pad's own bus, with forces in both slots.
    #[inline(never)]
    pub(super) fn drive_both_on_bus(
        &mut self,
        run: Run<'_>,
        contacts: &mut ActiveContacts<'_>,
        force: &mut [i32],
        out: &mut [[i32; 2]],
        work: &mut PadWork,
    ) {
        let (mut sound, mut second) = ([0; TICK_FRAMES], [0; TICK_FRAMES]);
        let frames = force.len();
        let (Some(sound), Some(second)) = (sound.get_mut(..frames), second.get_mut(..frames)) else { return };
        self.add_driven(run, contacts, (force, Some(second)), (sound, None), work);
        self.add_noise_of_frames(sound);
        self.panner.render(sound, out);
    }

    /// Adds a run of all banks under a force to a bus; the object's modes go to a bus of their own
    /// if there is one.
    ///
    /// The first force is that of slot 0, the second one that of slot 1. If there is no second one
    /// and no striker has a bank, the first holds the force already. On return it is the sum of
    /// both.
    #[inline(always)] // kits without filters need one of the two callers only
    fn add_driven(
        &mut self,
        run: Run<'_>,
        contacts: &mut ActiveContacts<'_>,
        (force, mut second): (&mut [i32], Option<&mut [i32]>),
        (sound, modes): (&mut [i32], Option<&mut [i32]>),
        work: &mut PadWork,
    ) {
        let (number, striker_count, direct_slot) = (self.number, self.striker_count, self.direct_slot());
        let Some((object, strikers)) = self.banks.split_first_mut() else { return };
        if !strikers.is_empty() || second.is_some() {
            let (mut direct, mut strikers) = (run.direct, strikers.iter_mut());
            for index in 0..striker_count {
                // Without a second force a direct one acts in slot 0.
                let (run, striker) = (Run { direct: direct.take(), ..run }, (number, index));
                let forces = (&mut *force, second.as_deref_mut(), direct_slot);
                let bank = strikers.next().filter(|bank| bank.mode_count() > 0);
                let is_idle = run.skip && run.direct.is_none() && !contacts.is_any_by(number, index);
                if is_idle && bank.as_ref().is_none_or(|bank| !bank.is_ringing()) {
                    continue;
                }
                match bank {
                    Some(bank) => work.strikers += drive_striker(bank, striker, run, contacts, forces, sound),
                    None => add_forces(striker, run.direct, contacts, forces),
                }
            }
        }
        let forces = (Some(&*force), second.as_deref());
        work.object = match self.frames.as_deref_mut() {
            Some(object) => {
                object.render([forces.0, forces.1], modes.unwrap_or(sound));
                BankWork { driven_mode_frames: (object.mode_count() * force.len()) as u32, ..BankWork::default() }
            }
            None => object.render_slots(forces, run.odd_start, run.skip, modes.unwrap_or(sound)),
        };
        if let Some(second) = second {
            // Stages that do not depend on the position hear both.
            add(force, second);
        }
        if self.acceleration.is_built() {
            work.acceleration_frames = force.len() as u32;
            self.acceleration.render(force, sound);
        }
    }

    /// Adds a run of all banks under a force to the pad's own bus, which filters join.
    ///
    /// The second bus takes the object's modes if there is one. `force` must be 0 and holds the
    /// force on return.
    #[inline(never)]
    fn drive_mono(
        &mut self,
        run: Run<'_>,
        contacts: &mut ActiveContacts<'_>,
        force: &mut [i32],
        buses: (&mut [i32], Option<&mut [i32]>),
    ) -> PadWork {
        self.wake();
        self.struck = true;
        let frames = force.len() as u32;
        let direct_frames = if run.direct.is_some() { frames } else { 0 };
        let mut work = PadWork { force_frames: frames, direct_frames, ..PadWork::default() };
        if self.has_second(run.direct, contacts) || self.has_second_in_frames(run.direct, contacts) {
            self.drive_both_mono(run, contacts, force, buses, &mut work);
            return work;
        }
        if self.banks.len() == 1 {
            take_force(self.number, run.direct, contacts, force);
        }
        self.add_driven(run, contacts, (force, None), buses, &mut work);
        work
    }

    /// Completes [`Voice::drive_mono`] with forces in both slots.
    #[inline(never)] // its buffer must not weigh on pads that do without
    fn drive_both_mono(
        &mut self,
        run: Run<'_>,
        contacts: &mut ActiveContacts<'_>,
        force: &mut [i32],
        buses: (&mut [i32], Option<&mut [i32]>),
        work: &mut PadWork,
    ) {
        let mut second = [0; TICK_FRAMES];
        let Some(second) = second.get_mut(..force.len()) else { return };
        self.add_driven(run, contacts, (force, Some(second)), buses, work);
    }

    /// Adds a run of all banks without a force to the pad's own bus, as [`Voice::drive_mono`] does.
    /// Gives the mode-frames of the object's bank and of the strikers' banks.
    #[inline(never)]
    fn ring_mono(&mut self, odd_start: bool, (sound, modes): (&mut [i32], Option<&mut [i32]>)) -> (u32, u32) {
        let Some((object, strikers)) = self.banks.split_first_mut() else { return (0, 0) };
        let frames = sound.len() as u32;
        let mut striker_modes = 0;
        for bank in strikers {
            striker_modes += bank.running_modes(true);
            bank.render(None, odd_start, true, sound);
        }
        let mut object_modes = object.running_modes(true);
        object.render(None, odd_start, true, modes.unwrap_or(sound));
        if let Some(object) = self.frames.as_deref_mut() {
            object_modes = object.running_modes();
            object.render([None; 2], sound);
        }
        (object_modes * frames, striker_modes * frames)
    }

    /// True if the filters take part in the next run: they sound, or take its force or its modes.
    #[inline(always)]
    pub fn filters_join_in(&self, has_force: bool) -> bool {
        self.filters.as_ref().is_some_and(|filters| {
            filters.is_active()
                || has_force && filters.takes_force()
                || filters.takes_modes() && (has_force || self.is_ringing())
        })
    }

    /// Adds a run in which the filters [join in](Self::filters_join_in) to the stereo bus. `frame`
    /// is the run's first frame within the tick.
    #[inline(never)] // its buffers must not weigh on pads that do without
    pub fn render_filtered(
        &mut self,
        frame: usize,
        run: Run<'_>,
        contacts: &mut ActiveContacts<'_>,
        out: &mut [[i32; 2]],
    ) -> (Ran, FilterWork) {
        let (mut force, mut sound, mut modes) = ([0; TICK_FRAMES], [0; TICK_FRAMES], [0; TICK_FRAMES]);
        let nothing = (Ran::Ringing(0, 0), FilterWork::default());
        let (Some(force), Some(sound), Some(modes)) =
            (force.get_mut(..run.frames), sound.get_mut(..run.frames), modes.get_mut(..run.frames))
        else {
            return nothing;
        };
        let Some((takes_modes, takes_force)) =
            self.filters.as_ref().map(|filters| (filters.takes_modes(), filters.takes_force()))
        else {
            return nothing;
        };
        let has_force = run.has_force;
        let in_frames = self.frames.is_some();
        let is_heard = has_force && (!run.skip || self.responds() || takes_force || in_frames);
        let mut brings_modes = takes_modes && (is_heard || self.is_ringing());
        if has_force && !is_heard {
            contacts.pass(self.number, run.frames);
        }
        let buses = (&mut *sound, takes_modes.then_some(&mut *modes));
        let ran = if is_heard || !run.skip {
            brings_modes |= takes_modes;
            Ran::Driven(self.drive_mono(run, contacts, force, buses))
        } else {
            let sounds = self.is_ringing() || self.sounds_in_frames();
            let (object, strikers) = if sounds { self.ring_mono(run.odd_start, buses) } else { (0, 0) };
            Ran::Ringing(object, strikers)
        };
        let force = is_heard.then_some(&*force);
        let Some(filters) = self.filters.as_deref_mut() else { return nothing };
        let work = filters.render(frame, force, brings_modes.then_some(modes), sound);
        self.panner.render(sound, out);
        (ran, work)
    }

    /// Adds a run of the residual to the stereo bus, unless it goes by way of the pad's own; gives
    /// its frames.
    #[inline(never)] // its buffer and registers must not weigh on kits without residuals
    pub fn render_residual(&mut self, out: &mut [[i32; 2]]) -> u32 {
        let is_panned_with_modes = self.pans_noise_with_modes();
        let Some(residual) = self.residual.as_deref_mut().filter(|residual| residual.is_active()) else {
            return 0;
        };
        if is_panned_with_modes {
            return out.len() as u32;
        }
        let mut sound = [0; TICK_FRAMES];
        let Some(sound) = sound.get_mut(..out.len()) else { return 0 };
        residual.render(sound);
        self.panner.render(sound, out);
        out.len() as u32
    }
}

/// Work of a voice's banks over a run of frames.
#[derive(Clone, Copy, Debug)]
pub enum Ran {
    /// Run under a force.
    Driven(PadWork),
    /// Free run: mode-frames of the object's bank and of the strikers' banks.
    Ringing(u32, u32),
}

/// Adds the forces of all contacts and a direct one, for a pad without strikers' banks and without
/// a force in slot 1.
pub(super) fn take_force(number: u8, direct: Option<&[i32]>, contacts: &mut ActiveContacts<'_>, force: &mut [i32]) {
    direct.into_iter().for_each(|direct| add(force, direct));
    contacts.add_force_of_pad(number, force);
}

/// Runs the bank of a striker and adds the striker's force to the object's.
#[inline(never)] // most strikers have no modes, and its buffer would weigh on them
fn drive_striker(
    bank: &mut Bank<'_>,
    (pad, index): (u8, u8),
    run: Run<'_>,
    contacts: &mut ActiveContacts<'_>,
    (first, second, direct_slot): Forces<'_>,
    sound: &mut [i32],
) -> BankWork {
    let mut force = [0; TICK_FRAMES];
    let Some(force) = force.get_mut(..first.len()) else { return BankWork::default() };
    let (direct, has_second) = (run.direct, second.is_some());
    if let Some(second) = second {
        contacts.add_force(pad, index, 1, force);
        direct.into_iter().filter(|_| direct_slot == 1).for_each(|direct| add(force, direct));
        add(second, force);
    }
    // The force of slot 0 is summed apart, for its bank hears both slots.
    let mut own = [0; TICK_FRAMES];
    let Some(own) = own.get_mut(..first.len()) else { return BankWork::default() };
    direct.into_iter().filter(|_| !has_second || direct_slot == 0).for_each(|direct| add(own, direct));
    contacts.add_force(pad, index, 0, own);
    add(first, own);
    add(force, own);
    bank.render(Some(force), run.odd_start, run.skip, sound)
}

/// Force of slot 0, that of slot 1 if there is one, and the slot in which a direct force acts if
/// there are both.
type Forces<'f> = (&'f mut [i32], Option<&'f mut [i32]>, u8);

/// Adds the force of a striker without a bank to the object's.
fn add_forces(
    (pad, index): (u8, u8),
    direct: Option<&[i32]>,
    contacts: &mut ActiveContacts<'_>,
    (first, second, direct_slot): Forces<'_>,
) {
    contacts.add_force(pad, index, 0, first);
    match second {
        Some(second) => {
            contacts.add_force(pad, index, 1, second);
            direct
                .into_iter()
                .for_each(|direct| add(if direct_slot == 1 { &mut *second } else { &mut *first }, direct));
        }
        None => direct.into_iter().for_each(|direct| add(first, direct)),
    }
}

fn add(sum: &mut [i32], more: &[i32]) {
    sum.iter_mut().zip(more).for_each(|(sum, &x)| *sum = fixed::qadd(*sum, x));
}
