//! A pad: one struck object with its strikers (diffimpact eq. 1 without residual, background and room).
//!
//! ```text
//! contacts of striker s --> F_s --+--> η · striker bank s --+
//! direct force (counts as s = 0) -+                         |
//!                                 +-- F = Σ F_s --> object bank --+--> level, pan --> stereo
//!                                              \--> α · F --------+
//! ```
//!
//! A second strike adds energy to the same ringing banks.

mod tables;

pub use tables::PadTables;

use crate::SampleRate;
use crate::contact::flight::Flight;
use crate::contact::law::{Impact, StrikerLaw, typical_contact};
use crate::fixed;
use crate::output::Panner;
use crate::radiation::Acceleration;
use crate::resonator::kernel::{self, Backward};
use crate::resonator::{Bank, BankError, BankWork, Group, Memory, Retirement, TICK_FRAMES, Used};
use crate::table::layout::STRIKERS_PER_PAD;
use crate::table::{Kit, Object, Pad as PadTable};
use tables::{object_table, striker_table};

/// A pad's stages and their state.
#[derive(Clone, Debug)]
pub struct Pad {
    object: Bank,
    /// The first `striker_count` are the pad's.
    strikers: [PadStriker; STRIKERS_PER_PAD],
    striker_count: u8,
    /// Those of the strikers that come up to the last one with modes.
    sounding_strikers: u8,
    mode_count: u16,
    acceleration: Acceleration,
    panner: Panner,
    /// |force| that contacts which have just begun will bring, until the banks are guarded for it.
    expected: u64,
    choked: bool,
    struck: bool,
}

#[derive(Clone, Debug)]
struct PadStriker {
    law: StrikerLaw,
    bank: Bank,
}

impl PadStriker {
    const NONE: Self = Self { law: StrikerLaw::NONE, bank: Bank::EMPTY };
}

/// What a pad did over a run of frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PadWork {
    /// The object's bank.
    pub object: BankWork,
    /// All strikers' banks.
    pub strikers: BankWork,
    /// Frames for which the acceleration sound was computed.
    pub acceleration_frames: u32,
    /// Frames for which a direct force was taken in.
    pub direct_frames: u32,
    /// Frames in which a force was made or taken in.
    pub force_frames: u32,
}

/// A run of frames of at most a tick, as a pad renders it.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// Number of frames.
    pub frames: usize,
    /// Whether the first frame's absolute number is odd.
    pub odd_start: bool,
    /// Whether what is not needed may be left out.
    pub skip: bool,
    /// Direct force for this pad, Q4.27.
    pub direct: Option<&'a [i32]>,
}

impl Pad {
    /// A pad without object or strikers.
    pub const EMPTY: Self = Self {
        object: Bank::EMPTY,
        strikers: [PadStriker::NONE; STRIKERS_PER_PAD],
        striker_count: 0,
        sounding_strikers: 0,
        mode_count: 0,
        acceleration: Acceleration::NONE,
        panner: Panner::SILENT,
        expected: 0,
        choked: false,
        struck: false,
    };

    /// Derives a pad from its tables for a sample rate. `which` names, in case of an error, the bank: `None` the object's, or a striker's.
    ///
    /// # Errors
    /// A [`BankError`] and the bank that it concerns.
    pub fn load(
        kit: &Kit<'_>,
        pad: PadTable<'_>,
        object: &Object<'_>,
        rate: SampleRate,
        memory: &mut Memory<'_>,
        used: &mut Used,
    ) -> Result<Self, (BankError, Option<usize>)> {
        let reference_force = object.reference_force();
        let first = kit.strikers_of(pad).next();
        let contact = first.map_or((0.0, 0.0), |striker| typical_contact(&striker, reference_force));
        let table = object_table(object, pad, contact);
        let mut strikers = [PadStriker::NONE; STRIKERS_PER_PAD];
        let (mut striker_count, mut sounding_strikers) = (0, 0);
        let mut mode_count = 0;
        let object_bank = Bank::load(&table, rate, memory, used).map_err(|error| (error, None))?;
        for (index, (slot, striker)) in strikers.iter_mut().zip(kit.strikers_of(pad)).enumerate() {
            let law = StrikerLaw::new(&striker, reference_force, rate);
            let table = striker_table(&striker, pad, reference_force, typical_contact(&striker, reference_force));
            let bank = Bank::load(&table, rate, memory, used).map_err(|error| (error, Some(index)))?;
            mode_count += bank.mode_count();
            *slot = PadStriker { law, bank };
            striker_count += 1;
            if slot.bank.mode_count() > 0 {
                sounding_strikers = striker_count;
            }
        }
        mode_count += object_bank.mode_count();
        Ok(Self {
            object: object_bank,
            mode_count: mode_count as u16, // all banks count in 16 bits
            strikers,
            striker_count,
            sounding_strikers,
            acceleration: Acceleration::new(object.acceleration(), reference_force),
            panner: Panner::new(pad.level_db(), pad.pan()),
            expected: 0,
            choked: false,
            struck: false,
        })
    }

    /// Number of strikers.
    pub fn striker_count(&self) -> usize {
        usize::from(self.striker_count)
    }

    /// All strikers that make a sound, and possibly others.
    #[inline(always)]
    fn sounding(&self) -> &[PadStriker] {
        self.strikers.get(..usize::from(self.sounding_strikers)).unwrap_or(&[])
    }

    #[inline(always)]
    fn sounding_mut(&mut self) -> &mut [PadStriker] {
        self.strikers.get_mut(..usize::from(self.sounding_strikers)).unwrap_or(&mut [])
    }

    /// The object's bank and the strikers' banks.
    pub fn banks(&self) -> impl Iterator<Item = &Bank> {
        core::iter::once(&self.object).chain(self.sounding().iter().map(|striker| &striker.bank))
    }

    /// The same to be changed.
    pub fn banks_mut(&mut self) -> impl Iterator<Item = &mut Bank> {
        let strikers = self.strikers.iter_mut().take(usize::from(self.sounding_strikers));
        core::iter::once(&mut self.object).chain(strikers.map(|striker| &mut striker.bank))
    }

    /// Register groups of all banks.
    pub fn group_count(&self) -> u32 {
        self.banks().map(Bank::group_count).sum()
    }

    /// Output (1.0 = full scale) that a bus step of a bank makes on the louder side.
    pub fn unit(&self) -> f32 {
        self.panner.loudest() / fixed::ONE_Q27 as f32
    }

    /// Modes of the object's bank and of all strikers' banks.
    #[inline(always)]
    pub fn mode_count(&self) -> usize {
        usize::from(self.mode_count)
    }

    /// Whether the pad has been struck, or driven, since it was loaded.
    #[inline(always)]
    pub fn was_struck(&self) -> bool {
        self.struck
    }

    /// Whether any mode rings.
    #[inline(always)]
    pub fn is_ringing(&self) -> bool {
        self.object.is_ringing() || self.sounding().iter().any(|striker| striker.bank.is_ringing())
    }

    /// Bound of the amplitude that retirement leaves out at present, output units (1.0 = full scale).
    #[inline(always)]
    pub fn retired_amplitude(&self) -> f32 {
        let mut sum = self.object.retired_amplitude();
        for striker in self.sounding() {
            sum += striker.bank.retired_amplitude();
        }
        sum
    }

    /// The impact of a strike, and the object moved to its position. `None` where the strike does nothing.
    pub fn strike(
        &mut self,
        tables: &PadTables<'_>,
        velocity: f32,
        position: f32,
        striker: u8,
        rate: SampleRate,
        memory: &mut Memory<'_>,
    ) -> Option<Impact> {
        let impact = self.strikers.get(usize::from(striker))?.law.impact(velocity)?;
        self.expected += impact.sum();
        self.struck = true;
        self.object.set_position(position, &tables.object_table(), rate, memory);
        Some(impact)
    }

    /// Lays a hand on, or lets go.
    pub fn set_choked(&mut self, choked: bool, tables: &PadTables<'_>, rate: SampleRate, memory: &mut Memory<'_>) {
        if choked == self.choked {
            return;
        }
        self.choked = choked;
        self.object.set_choked(choked, &tables.object_table(), rate, memory);
        for (index, striker) in self.sounding_mut().iter_mut().enumerate() {
            if let Some(table) = tables.striker_table(index) {
                striker.bank.set_choked(choked, &table, rate, memory);
            }
        }
    }

    /// Whether [`Pad::ring`] goes straight to the stereo bus.
    pub fn rings_quickly(&self) -> bool {
        self.panner.half_gains().is_some()
            && !self.object.mix_shift().is_loud
            && !self.banks().skip(1).any(Bank::is_ringing)
    }

    /// Whether a contact has begun that the banks are not guarded for yet.
    pub fn expects(&self) -> bool {
        self.expected > 0
    }

    /// Whether a force would be heard: some group is not left out, or there is an acceleration sound.
    pub fn responds(&self, groups: &[Group]) -> bool {
        self.acceleration.is_built() || self.banks().any(|bank| bank.has_admitted(groups))
    }

    /// Guards the banks for the contacts that have just begun. Before the run in which they do.
    pub fn meet_expected(&mut self, memory: &mut Memory<'_>) {
        let expected = core::mem::take(&mut self.expected);
        if expected > 0 {
            // What is left out altogether needs no guard.
            for bank in self.banks_mut() {
                if bank.has_admitted(memory.groups) {
                    bank.expect(memory, expected);
                }
            }
        }
    }

    /// Whether the next tick guards any group, if no more force comes before it.
    pub fn is_guard_due(&self) -> bool {
        self.object.is_guard_due() || self.sounding().iter().any(|striker| striker.bank.is_guard_due())
    }

    /// The bookkeeping of a tick; gives how many modes retired. `retired_elsewhere` is what other pads leave out, output units.
    pub fn tick(&mut self, memory: &mut Memory<'_>, skip: bool, retired_elsewhere: f32) -> u32 {
        if skip && !self.is_guard_due() {
            self.object.tick(memory, None);
            self.sounding_mut().iter_mut().for_each(|striker| striker.bank.tick(memory, None));
            return 0;
        }
        self.tick_with_guards(memory, skip, retired_elsewhere)
    }

    #[inline(never)]
    fn tick_with_guards(&mut self, memory: &mut Memory<'_>, skip: bool, retired_elsewhere: f32) -> u32 {
        let already = retired_elsewhere + self.retired_amplitude();
        // 1.0 on the bus is full scale, so that a bus step is 2^-27 of it.
        let mut retirement = Retirement::new(already, self.panner.loudest() / fixed::ONE_Q27 as f32);
        self.object.tick(memory, skip.then_some(&mut retirement));
        for striker in self.sounding_mut().iter_mut() {
            striker.bank.tick(memory, skip.then_some(&mut retirement));
        }
        retirement.retired_modes()
    }

    /// Renders a run without force and adds it to the stereo sum; gives the mode-frames of the object's bank and of the strikers' banks. A
    /// striker's bank that rings sounds on the same bus as the object's. `scratch` holds nothing before and after.
    #[inline(never)]
    pub fn ring(
        &mut self,
        frames: usize,
        odd_start: bool,
        memory: &mut Memory<'_>,
        scratch: &mut Backward,
        out: &mut [[i32; 2]],
    ) -> (u32, u32) {
        let object = self.object.running_modes(true) * frames as u32;
        let strikers = self.sounding().iter().map(|striker| striker.bank.running_modes(true)).sum::<u32>();
        match self.panner.half_gains().filter(|_| strikers == 0 && !self.object.mix_shift().is_loud) {
            // The usual case, in one pass: the same bits.
            Some(gains) => {
                let run = kernel::Run { frames, skip: true, add: false };
                self.object.ring_stereo(memory, run, odd_start, scratch, gains, out);
            }
            None => self.ring_on_bus(frames, odd_start, memory, out),
        }
        (object, strikers * frames as u32)
    }

    #[inline(never)]
    fn ring_on_bus(&mut self, frames: usize, odd_start: bool, memory: &mut Memory<'_>, out: &mut [[i32; 2]]) {
        let mut sound = [0; TICK_FRAMES];
        let Some(sound) = sound.get_mut(..frames) else { return };
        for striker in self.sounding_mut() {
            striker.bank.render(memory, None, odd_start, true, sound);
        }
        self.object.render(memory, None, odd_start, true, sound);
        self.panner.render(sound, out);
    }

    /// Renders a run with force, or one that leaves nothing out, and adds it to the stereo sum.
    #[inline(never)] // its buffers must not weigh on runs without force
    pub fn drive<const CONTACTS: usize>(
        &mut self,
        number: u8,
        run: Run<'_>,
        flight: &mut Flight<CONTACTS>,
        memory: &mut Memory<'_>,
        out: &mut [[i32; 2]],
    ) -> PadWork {
        let mut work = PadWork::default();
        let frames = run.frames.min(TICK_FRAMES);
        let (mut sound, mut total) = ([0; TICK_FRAMES], [0; TICK_FRAMES]);
        let (Some(sound), Some(total)) = (sound.get_mut(..frames), total.get_mut(..frames)) else { return work };
        let mut direct = run.direct;
        if direct.is_some() || flight.count_on(number) > 0 {
            self.struck = true;
            work.force_frames = frames as u32;
            work.direct_frames = if direct.is_some() { frames as u32 } else { 0 };
        }
        for (striker, index) in self.strikers.iter_mut().take(usize::from(self.striker_count)).zip(0u8..) {
            let direct = direct.take();
            if striker.bank.mode_count() == 0 {
                direct.into_iter().for_each(|direct| add(total, direct));
                flight.add_force(number, index, total);
            } else {
                work.strikers += drive_striker(striker, (number, index), run, direct, flight, memory, total, sound);
            }
        }
        let force = &*total;
        work.object = self.object.render(memory, Some(force), run.odd_start, run.skip, sound);
        if self.acceleration.is_built() {
            work.acceleration_frames = frames as u32;
            self.acceleration.render(force, sound);
        }
        self.panner.render(sound, out);
        work
    }
}

/// Runs the bank of a striker, and adds its force to the object's.
#[inline(never)] // most strikers have no modes, and its buffer would weigh on them
#[allow(clippy::too_many_arguments)] // one call, taken apart for the stack's sake
fn drive_striker<const CONTACTS: usize>(
    striker: &mut PadStriker,
    (pad, index): (u8, u8),
    run: Run<'_>,
    direct: Option<&[i32]>,
    flight: &mut Flight<CONTACTS>,
    memory: &mut Memory<'_>,
    total: &mut [i32],
    sound: &mut [i32],
) -> BankWork {
    let mut force = [0; TICK_FRAMES];
    let Some(force) = force.get_mut(..total.len()) else { return BankWork::default() };
    direct.into_iter().for_each(|direct| add(force, direct));
    flight.add_force(pad, index, force);
    add(total, force);
    striker.bank.render(memory, Some(force), run.odd_start, run.skip, sound)
}

fn add(sum: &mut [i32], more: &[i32]) {
    sum.iter_mut().zip(more).for_each(|(sum, &x)| *sum = fixed::qadd(*sum, x));
}
