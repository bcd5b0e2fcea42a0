//! A pad's sound over a run of frames.

use super::{Pad, PadWork, Run};
use crate::contact::flight::Flight;
use crate::fixed;
use crate::resonator::kernel;
use crate::resonator::{Bank, BankWork, Memory, TICK_FRAMES};

impl Pad<'_> {
    /// Renders a run without force and adds it to the stereo sum; gives the mode-frames of the object's bank and of the strikers' banks. A
    /// striker's bank that rings sounds on the same bus as the object's.
    #[inline(never)]
    pub fn ring(
        &mut self,
        frames: usize,
        odd_start: bool,
        memory: &mut Memory<'_>,
        banks: &mut [Bank],
        out: &mut [[i32; 2]],
    ) -> (u32, u32) {
        let Some((object, strikers)) = banks.split_first_mut() else { return (0, 0) };
        let object_modes = object.running_modes(true);
        let striker_modes = strikers.iter().map(|bank| bank.running_modes(true)).sum::<u32>();
        match self.panner.gains(object.mix_shift().is_loud).filter(|_| striker_modes == 0) {
            // The usual case, in one pass: the same bits.
            Some(gains) => {
                let run = kernel::Run { frames, skip: true, add: false };
                object.ring_stereo(memory, run, odd_start, gains, out);
            }
            None => self.ring_on_bus(frames, odd_start, memory, banks, out),
        }
        (object_modes * frames as u32, striker_modes * frames as u32)
    }

    #[inline(never)]
    fn ring_on_bus(
        &mut self,
        frames: usize,
        odd_start: bool,
        memory: &mut Memory<'_>,
        banks: &mut [Bank],
        out: &mut [[i32; 2]],
    ) {
        let mut sound = [0; TICK_FRAMES];
        let Some(sound) = sound.get_mut(..frames) else { return };
        // The object's last, as under a force: a sum that is clipped depends on the order.
        let Some((object, strikers)) = banks.split_first_mut() else { return };
        strikers.iter_mut().chain([object]).for_each(|bank| {
            bank.render(memory, None, odd_start, true, sound);
        });
        self.panner.render(sound, out);
    }

    /// Renders a run with force, or one that leaves nothing out, and adds it to the stereo sum.
    #[inline(never)] // its buffers must not weigh on runs without force
    #[allow(clippy::too_many_arguments)] // what a run has, and where the pad's state lies
    pub fn drive<const CONTACTS: usize>(
        &mut self,
        number: u8,
        run: Run<'_>,
        flight: &mut Flight<CONTACTS>,
        memory: &mut Memory<'_>,
        banks: &mut [Bank],
        out: &mut [[i32; 2]],
    ) -> PadWork {
        self.wake(banks);
        let mut work = PadWork::default();
        let frames = run.frames.min(TICK_FRAMES);
        let mut force = [0; TICK_FRAMES];
        let Some(force) = force.get_mut(..frames) else { return work };
        if run.direct.is_some() || flight.count_on(number) > 0 {
            self.struck = true;
            work.force_frames = frames as u32;
            work.direct_frames = if run.direct.is_some() { frames as u32 } else { 0 };
        }
        let has_second = self.has_second(number, run.direct, flight, banks);
        if let [object] = &mut *banks
            && !has_second
        {
            Self::take_force(number, run.direct, flight, force);
            // The usual case, in one pass: the same bits.
            let gains = self.panner.gains(object.mix_shift().is_loud);
            if let Some(gains) = gains.filter(|_| run.skip && !self.acceleration.is_built())
                && let Some(object) = object.render_stereo(memory, force, run.odd_start, gains, out)
            {
                work.object = object;
                return work;
            }
        }
        if has_second {
            self.drive_both_on_bus(number, run, flight, memory, banks, force, out, &mut work);
        } else {
            self.drive_on_bus(number, run, flight, memory, banks, force, out, &mut work);
        }
        work
    }

    /// True if a force acts at the position of slot 1.
    #[inline(always)]
    fn has_second<const CONTACTS: usize>(
        &self,
        number: u8,
        direct: Option<&[i32]>,
        flight: &Flight<CONTACTS>,
        banks: &[Bank],
    ) -> bool {
        banks.first().is_some_and(Bank::has_second_gains)
            && (flight.is_any_in(number, 1) || direct.is_some() && self.direct_slot() == 1)
    }

    /// Adds the force of all contacts, and a direct one: where no striker has a bank and slot 1 no force.
    fn take_force<const CONTACTS: usize>(
        number: u8,
        direct: Option<&[i32]>,
        flight: &mut Flight<CONTACTS>,
        force: &mut [i32],
    ) {
        direct.into_iter().for_each(|direct| add(force, direct));
        flight.add_force_of_pad(number, force);
    }

    /// The same with all that a pad can have; `force` holds the force already where no striker has a bank.
    #[inline(never)] // its buffer must not weigh on pads that do without
    #[allow(clippy::too_many_arguments)] // one call, taken apart for the stack's sake
    fn drive_on_bus<const CONTACTS: usize>(
        &mut self,
        number: u8,
        run: Run<'_>,
        flight: &mut Flight<CONTACTS>,
        memory: &mut Memory<'_>,
        banks: &mut [Bank],
        force: &mut [i32],
        out: &mut [[i32; 2]],
        work: &mut PadWork,
    ) {
        let mut sound = [0; TICK_FRAMES];
        let Some(sound) = sound.get_mut(..force.len()) else { return };
        self.add_driven(number, run, flight, memory, banks, (force, None), (sound, None), work);
        self.panner.render(sound, out);
    }

    /// [`Pad::drive_on_bus`] with a force in slot 1 as well, for which there is another buffer.
    #[inline(never)]
    #[allow(clippy::too_many_arguments)] // one call, taken apart for the stack's sake
    fn drive_both_on_bus<const CONTACTS: usize>(
        &mut self,
        number: u8,
        run: Run<'_>,
        flight: &mut Flight<CONTACTS>,
        memory: &mut Memory<'_>,
        banks: &mut [Bank],
        force: &mut [i32],
        out: &mut [[i32; 2]],
        work: &mut PadWork,
    ) {
        let (mut sound, mut second) = ([0; TICK_FRAMES], [0; TICK_FRAMES]);
        let frames = force.len();
        let (Some(sound), Some(second)) = (sound.get_mut(..frames), second.get_mut(..frames)) else { return };
        self.add_driven(number, run, flight, memory, banks, (force, Some(second)), (sound, None), work);
        self.panner.render(sound, out);
    }

    /// Adds, under a force, all of the pad to a bus, the object's modes to another one where there is one. The first force is that of slot 0, and
    /// holds it already where no striker has a bank and there is no second; behind, it is that of both.
    #[inline(always)] // one of two callers is not built where there are no filters
    #[allow(clippy::too_many_arguments)] // one call, taken apart for the stack's sake
    fn add_driven<const CONTACTS: usize>(
        &mut self,
        number: u8,
        run: Run<'_>,
        flight: &mut Flight<CONTACTS>,
        memory: &mut Memory<'_>,
        banks: &mut [Bank],
        (force, mut second): (&mut [i32], Option<&mut [i32]>),
        (sound, modes): (&mut [i32], Option<&mut [i32]>),
        work: &mut PadWork,
    ) {
        let Some((object, strikers)) = banks.split_first_mut() else { return };
        if !strikers.is_empty() || second.is_some() {
            let (mut direct, mut strikers) = (run.direct, strikers.iter_mut());
            for index in 0..self.striker_count {
                // Where there is no second force, a direct one acts in slot 0.
                let (direct, striker) = (direct.take(), (number, index));
                let forces = (&mut *force, second.as_deref_mut(), self.direct_slot());
                match strikers.next().filter(|bank| bank.mode_count() > 0) {
                    Some(bank) => {
                        work.strikers += drive_striker(bank, striker, run, direct, flight, memory, forces, sound);
                    }
                    None => add_forces(striker, direct, flight, forces),
                }
            }
        }
        let forces = (Some(&*force), second.as_deref());
        work.object = object.render_slots(memory, forces, run.odd_start, run.skip, modes.unwrap_or(sound));
        if let Some(second) = second {
            // What does not depend on the position hears both.
            add(force, second);
        }
        if self.acceleration.is_built() {
            work.acceleration_frames = force.len() as u32;
            self.acceleration.render(force, sound);
        }
    }

    /// Under a force, adds the pad to a mono bus of at most a tick, before level and pan: what its filters are put beside. Leaves the force in `force`,
    /// which is to be silent before. The object's modes go to `modes` where there is such a bus.
    #[inline(never)]
    #[allow(clippy::too_many_arguments)] // what a run has, and where the pad's state lies
    pub fn drive_mono<const CONTACTS: usize>(
        &mut self,
        number: u8,
        run: Run<'_>,
        flight: &mut Flight<CONTACTS>,
        memory: &mut Memory<'_>,
        banks: &mut [Bank],
        force: &mut [i32],
        buses: (&mut [i32], Option<&mut [i32]>),
    ) -> PadWork {
        self.wake(banks);
        self.struck = true;
        let frames = force.len() as u32;
        let direct_frames = if run.direct.is_some() { frames } else { 0 };
        let mut work = PadWork { force_frames: frames, direct_frames, ..PadWork::default() };
        if self.has_second(number, run.direct, flight, banks) {
            self.drive_both_mono(number, run, flight, memory, banks, force, buses, &mut work);
            return work;
        }
        if banks.len() == 1 {
            Self::take_force(number, run.direct, flight, force);
        }
        self.add_driven(number, run, flight, memory, banks, (force, None), buses, &mut work);
        work
    }

    /// [`Pad::drive_mono`] with a force in slot 1 as well.
    #[inline(never)] // its buffer must not weigh on pads that do without
    #[allow(clippy::too_many_arguments)] // one call, taken apart for the stack's sake
    fn drive_both_mono<const CONTACTS: usize>(
        &mut self,
        number: u8,
        run: Run<'_>,
        flight: &mut Flight<CONTACTS>,
        memory: &mut Memory<'_>,
        banks: &mut [Bank],
        force: &mut [i32],
        buses: (&mut [i32], Option<&mut [i32]>),
        work: &mut PadWork,
    ) {
        let mut second = [0; TICK_FRAMES];
        let Some(second) = second.get_mut(..force.len()) else { return };
        self.add_driven(number, run, flight, memory, banks, (force, Some(second)), buses, work);
    }

    /// The same without a force; gives the mode-frames of the object's bank and of the strikers' banks.
    #[inline(never)]
    pub fn ring_mono(
        &mut self,
        odd_start: bool,
        memory: &mut Memory<'_>,
        banks: &mut [Bank],
        (sound, modes): (&mut [i32], Option<&mut [i32]>),
    ) -> (u32, u32) {
        let Some((object, strikers)) = banks.split_first_mut() else { return (0, 0) };
        let frames = sound.len() as u32;
        let mut striker_modes = 0;
        for bank in strikers {
            striker_modes += bank.running_modes(true);
            bank.render(memory, None, odd_start, true, sound);
        }
        let object_modes = object.running_modes(true);
        object.render(memory, None, odd_start, true, modes.unwrap_or(sound));
        (object_modes * frames, striker_modes * frames)
    }

    /// Adds a mono bus to the stereo sum with the pad's level and pan.
    pub fn pan(&self, sound: &[i32], out: &mut [[i32; 2]]) {
        self.panner.render(sound, out);
    }
}

/// Runs the bank of a striker, and adds its force to the object's.
#[inline(never)] // most strikers have no modes, and its buffer would weigh on them
#[allow(clippy::too_many_arguments)] // one call, taken apart for the stack's sake
fn drive_striker<const CONTACTS: usize>(
    bank: &mut Bank,
    (pad, index): (u8, u8),
    run: Run<'_>,
    direct: Option<&[i32]>,
    flight: &mut Flight<CONTACTS>,
    memory: &mut Memory<'_>,
    (first, second, direct_slot): Forces<'_>,
    sound: &mut [i32],
) -> BankWork {
    let mut force = [0; TICK_FRAMES];
    let Some(force) = force.get_mut(..first.len()) else { return BankWork::default() };
    let has_second = second.is_some();
    if let Some(second) = second {
        flight.add_force(pad, index, 1, force);
        direct.into_iter().filter(|_| direct_slot == 1).for_each(|direct| add(force, direct));
        add(second, force);
    }
    // What is added to the first slot is added up apart.
    let mut own = [0; TICK_FRAMES];
    let Some(own) = own.get_mut(..first.len()) else { return BankWork::default() };
    direct.into_iter().filter(|_| !has_second || direct_slot == 0).for_each(|direct| add(own, direct));
    flight.add_force(pad, index, 0, own);
    add(first, own);
    add(force, own);
    bank.render(memory, Some(force), run.odd_start, run.skip, sound)
}

/// The forces of slot 0 and, where there is one, of slot 1; and the slot in which a direct force acts where there are both.
type Forces<'f> = (&'f mut [i32], Option<&'f mut [i32]>, u8);

/// Adds the force of a striker without a bank.
fn add_forces<const CONTACTS: usize>(
    (pad, index): (u8, u8),
    direct: Option<&[i32]>,
    flight: &mut Flight<CONTACTS>,
    (first, second, direct_slot): Forces<'_>,
) {
    flight.add_force(pad, index, 0, first);
    match second {
        Some(second) => {
            flight.add_force(pad, index, 1, second);
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
