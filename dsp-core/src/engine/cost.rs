//! Cost of a tick: the work that it is made of, and the cycles of each piece of work.

/// Kind of work that a tick may contain. [`CYCLES`] says how long one piece of each kind takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum CostItem {
    /// Tick in which anything is to be done.
    Tick,
    /// Pad that is awake in a run of frames, sounding or not.
    Pad,
    /// Pad with bookkeeping at a tick's beginning.
    WakingPad,
    /// Register group whose bank is guarded at a tick's beginning.
    DueGroup,
    /// Pad that rings freely in a run, straight to the stereo bus.
    RingingPad,
    /// Pad that rings freely in a run, by way of its own bus: it is loud, or a striker's bank
    /// rings.
    BusPad,
    /// Frame of a bank that goes by way of its pad's bus.
    BusFrame,
    /// Striker's bank that rings in a run.
    StrikerBank,
    /// Striker's bank under a force in a run.
    DrivenStrikerBank,
    /// Pad under a force in a run, straight to the stereo bus.
    DrivenPad,
    /// Pad under a force in a run, by way of its own bus: it has an onset, an acceleration sound or
    /// a striker's bank, or is too loud.
    BusDrivenPad,
    /// Frame of a pad under a force, whichever way it takes.
    DrivenFrame,
    /// Frame of a contact.
    ContactFrame,
    /// Frame of a direct force, or of a contact that goes on, beside the force's own cycles.
    DirectFrame,
    /// Register group at rest that is guarded for a contact.
    GuardedGroup,
    /// Register group that rings and is guarded for a contact.
    GuardedRingingGroup,
    /// Strike.
    Strike,
    /// Choke or release of a pad.
    Choke,
    /// Mode that a choke or a release reaches.
    ChokedMode,
    /// Mode whose gains are derived for a strike at another position.
    MovedMode,
    /// Register group of such modes.
    MovedGroup,
    /// Frame of a register group under a force in the second slot of its pad, beside its kernel's
    /// cycles.
    SecondFrame,
    /// Frame of a driven pad that goes straight to the stereo bus and adds a share of the force.
    OnsetFrame,
    /// Survey of all groups, to shed some.
    Survey,
    /// Register group that a survey looks at.
    SurveyedGroup,
    /// Register group that is left out.
    ShedGroup,
    /// Prediction of a run's cost.
    Look,
    /// Cycle of the modes' kernels, of which a [part](super::Setup::loop_percent) counts.
    KernelCycle,
    /// Strike that begins a residual.
    ResidualStrike,
    /// Residual or background in a run.
    ResidualRun,
    /// Frame of a residual or of the background.
    ResidualFrame,
    /// Cycle of the work on noise to come, of the room, of filters, of contacts that go on, or of a
    /// prediction before the tick.
    ResidualCycle,
    /// Tick in which nothing is to be done.
    IdleTick,
}

/// Number of [`CostItem`]s.
pub const COST_ITEMS: usize = CostItem::IdleTick as usize + 1;

/// Nominal cycles of each [`CostItem`], without flash waits; the item is the index.
///
/// They come from fits to the virtual core (`cargo bench -p host-tests --bench budget_costs` prints
/// one), and from profiles for items that a fit cannot tell apart.
/// `cargo test -p host-tests --test on_chip budget` holds them to 3 %.
pub const CYCLES: [u32; COST_ITEMS] = by_item([
    (CostItem::Tick, 1600),
    (CostItem::Pad, 533),
    (CostItem::WakingPad, 700),
    (CostItem::DueGroup, 135),
    (CostItem::RingingPad, 787),
    (CostItem::BusPad, 880),
    (CostItem::BusFrame, 39),
    (CostItem::StrikerBank, 940),
    (CostItem::DrivenStrikerBank, 3645),
    (CostItem::DrivenPad, 2700),
    (CostItem::BusDrivenPad, 3140),
    (CostItem::DrivenFrame, 20),
    (CostItem::ContactFrame, 31),
    (CostItem::DirectFrame, 10),
    (CostItem::GuardedGroup, 310),
    (CostItem::GuardedRingingGroup, 615),
    (CostItem::Strike, 3500),
    (CostItem::Choke, 630),
    (CostItem::ChokedMode, 53),
    (CostItem::MovedMode, 910),
    (CostItem::MovedGroup, 980),
    (CostItem::SecondFrame, 210),
    (CostItem::OnsetFrame, 23),
    (CostItem::Survey, 4000),
    (CostItem::SurveyedGroup, 80),
    (CostItem::ShedGroup, 150),
    (CostItem::Look, 425),
    (CostItem::KernelCycle, 1),
    (CostItem::ResidualStrike, 700),
    (CostItem::ResidualRun, 420),
    (CostItem::ResidualFrame, 40),
    (CostItem::ResidualCycle, 1),
    (CostItem::IdleTick, 670),
]);

/// Takes the cycles out of a list that must follow the order of [`CostItem`].
const fn by_item(list: [(CostItem, u32); COST_ITEMS]) -> [u32; COST_ITEMS] {
    let mut cycles = [0; COST_ITEMS];
    let mut index = 0;
    while index < COST_ITEMS {
        assert!(list[index].0 as usize == index, "the list must follow the order of the items");
        cycles[index] = list[index].1;
        index += 1;
    }
    cycles
}

impl CostItem {
    /// Nominal cycles of the item, from [`CYCLES`], for constants.
    pub(super) const fn const_cycles(self) -> u32 {
        CYCLES[self as usize]
    }

    /// Nominal cycles of the item, from [`CYCLES`].
    #[inline]
    pub(super) fn cycles(self) -> u32 {
        CYCLES.get(self as usize).copied().unwrap_or(0)
    }
}

/// Cycles of the work of a tick, and of its parts that a decision asks for.
///
/// The number of pieces of each [`CostItem`] is kept on a PC alone (feature `counts`), where it is
/// reported and the cycles of an item are fitted. A board has no time for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    cycles: u32,
    pub(super) looks: u32,
    pub(super) pads: u32,
    pub(super) kernel_cycles: u32,
    pub(super) guarded_groups: u32,
    pub(super) chokes: u32,
    pub(super) choked_modes: u32,
    /// Cycles of forces beside the groups that answer them.
    pub(super) force_cycles: u32,
    pub(super) is_idle: bool,
    #[cfg(feature = "counts")]
    pieces: [u32; COST_ITEMS],
}

impl Counts {
    /// Counts of a tick without any work.
    pub const NONE: Self = Self {
        cycles: 0,
        looks: 0,
        pads: 0,
        kernel_cycles: 0,
        guarded_groups: 0,
        chokes: 0,
        choked_modes: 0,
        force_cycles: 0,
        is_idle: false,
        #[cfg(feature = "counts")]
        pieces: [0; COST_ITEMS],
    };

    /// Adds pieces of one item.
    #[inline(always)] // an item is known where it is added, and so is what it adds to
    pub(super) fn add(&mut self, item: CostItem, count: u32) {
        let cycles = count * item.cycles();
        self.cycles += cycles;
        match item {
            CostItem::Look => self.looks += count,
            CostItem::Pad => self.pads += count,
            CostItem::KernelCycle => self.kernel_cycles += count,
            CostItem::GuardedGroup => self.guarded_groups += count,
            CostItem::Choke => self.chokes += count,
            CostItem::ChokedMode => self.choked_modes += count,
            CostItem::BusDrivenPad | CostItem::DrivenPad | CostItem::DrivenStrikerBank | CostItem::ContactFrame => {
                self.force_cycles += cycles
            }
            CostItem::IdleTick => self.is_idle |= count > 0,
            _ => {}
        }
        #[cfg(feature = "counts")]
        if let Some(pieces) = self.pieces.get_mut(item as usize) {
            *pieces += count;
        }
    }

    /// Adds pieces of several items.
    #[inline(always)]
    pub(super) fn add_all<const N: usize>(&mut self, items: [(CostItem, u32); N]) {
        items.into_iter().for_each(|(item, count)| self.add(item, count));
    }

    /// Cycles that would be free if all groups were shed.
    pub(super) fn sheddable_cycles(&self) -> u32 {
        self.kernel_cycles + self.guarded_groups * CostItem::GuardedGroup.cycles()
    }

    /// Takes cycles of the kernels away, at most all of them, and groups that need no guard.
    pub(super) fn free(&mut self, kernel_cycles: u32, guarded_groups: u32) {
        let [cycles, groups] = [kernel_cycles.min(self.kernel_cycles), guarded_groups.min(self.guarded_groups)];
        self.kernel_cycles -= cycles;
        self.guarded_groups -= groups;
        self.cycles -= cycles + groups * CostItem::GuardedGroup.cycles();
        #[cfg(feature = "counts")]
        for (item, freed) in [(CostItem::KernelCycle, cycles), (CostItem::GuardedGroup, groups)] {
            if let Some(pieces) = self.pieces.get_mut(item as usize) {
                *pieces -= freed;
            }
        }
    }

    /// True if a tick has been counted.
    pub fn is_any(&self) -> bool {
        self.cycles > 0
    }

    /// Number of pieces of one item.
    #[cfg(feature = "counts")]
    pub fn of(&self, item: CostItem) -> u32 {
        self.pieces.get(item as usize).copied().unwrap_or(0)
    }

    /// All counts, in the order of [`CostItem`].
    #[cfg(feature = "counts")]
    pub fn all(&self) -> &[u32; COST_ITEMS] {
        &self.pieces
    }

    /// Nominal cycles of all counted work.
    pub fn cycles(&self) -> u32 {
        self.cycles
    }
}

impl core::ops::AddAssign<&Self> for Counts {
    #[inline(never)] // one for all
    fn add_assign(&mut self, other: &Self) {
        self.cycles += other.cycles;
        self.looks += other.looks;
        self.pads += other.pads;
        self.kernel_cycles += other.kernel_cycles;
        self.guarded_groups += other.guarded_groups;
        self.chokes += other.chokes;
        self.choked_modes += other.choked_modes;
        self.force_cycles += other.force_cycles;
        self.is_idle |= other.is_idle;
        #[cfg(feature = "counts")]
        self.pieces.iter_mut().zip(&other.pieces).for_each(|(sum, &more)| *sum += more);
    }
}
