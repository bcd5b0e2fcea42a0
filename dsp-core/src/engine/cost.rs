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
    /// Prediction of a run's cost.
    Look,
    /// Register group whose cost a prediction looks up.
    PredictedGroup,
    /// Cycle of the modes' kernels, of which a [part](super::Setup::loop_percent) counts.
    KernelCycle,
    /// Strike that begins a residual.
    ResidualStrike,
    /// Residual or background in a run.
    ResidualRun,
    /// Frame of a residual or of the background.
    ResidualFrame,
    /// Cycle of the work on noise to come, of the room, of filters, or of contacts that go on.
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
    (CostItem::Tick, 2000),
    (CostItem::Pad, 490),
    (CostItem::WakingPad, 462),
    (CostItem::DueGroup, 118),
    (CostItem::RingingPad, 1089),
    (CostItem::BusPad, 1262),
    (CostItem::BusFrame, 49),
    (CostItem::StrikerBank, 826),
    (CostItem::DrivenStrikerBank, 3170),
    (CostItem::DrivenPad, 2820),
    (CostItem::BusDrivenPad, 3722),
    (CostItem::DrivenFrame, 20),
    (CostItem::ContactFrame, 88),
    (CostItem::DirectFrame, 17),
    (CostItem::GuardedGroup, 430),
    (CostItem::GuardedRingingGroup, 435),
    (CostItem::Strike, 2900),
    (CostItem::Choke, 640),
    (CostItem::ChokedMode, 60),
    (CostItem::MovedMode, 910),
    (CostItem::MovedGroup, 980),
    (CostItem::SecondFrame, 205),
    (CostItem::OnsetFrame, 32),
    (CostItem::Survey, 4900),
    (CostItem::SurveyedGroup, 125),
    (CostItem::Look, 800),
    (CostItem::PredictedGroup, 30),
    (CostItem::KernelCycle, 1),
    (CostItem::ResidualStrike, 700),
    (CostItem::ResidualRun, 420),
    (CostItem::ResidualFrame, 40),
    (CostItem::ResidualCycle, 1),
    (CostItem::IdleTick, 705),
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
    /// Nominal cycles of the item, from [`CYCLES`].
    #[inline]
    pub(super) fn cycles(self) -> u32 {
        CYCLES.get(self as usize).copied().unwrap_or(0)
    }
}

/// Number of pieces of each [`CostItem`] in a tick, and the cycles of all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    pieces: [u32; COST_ITEMS],
    /// Kept up with each change: a sum over all items would take some 300 cycles each time.
    cycles: u32,
}

impl Counts {
    /// Counts of a tick without any work.
    pub const NONE: Self = Self { pieces: [0; COST_ITEMS], cycles: 0 };

    /// Adds pieces of one item.
    #[inline(always)] // an item is known where it is added, and so are its cycles
    pub(super) fn add(&mut self, item: CostItem, count: u32) {
        if let (Some(counted), Some(cycles)) = (self.pieces.get_mut(item as usize), CYCLES.get(item as usize)) {
            *counted += count;
            self.cycles += count * cycles;
        }
    }

    /// Adds pieces of several items.
    #[inline(always)]
    pub(super) fn add_all<const N: usize>(&mut self, items: [(CostItem, u32); N]) {
        items.into_iter().for_each(|(item, count)| self.add(item, count));
    }

    /// Takes pieces of one item away, at most all of them.
    pub(super) fn remove(&mut self, item: CostItem, count: u32) {
        if let (Some(counted), Some(cycles)) = (self.pieces.get_mut(item as usize), CYCLES.get(item as usize)) {
            let count = count.min(*counted);
            *counted -= count;
            self.cycles -= count * cycles;
        }
    }

    /// True if a tick has been counted.
    pub fn is_any(&self) -> bool {
        self.cycles > 0
    }

    /// Number of pieces of one item.
    pub fn of(&self, item: CostItem) -> u32 {
        self.pieces.get(item as usize).copied().unwrap_or(0)
    }

    /// All counts, in the order of [`CostItem`].
    pub fn all(&self) -> &[u32; COST_ITEMS] {
        &self.pieces
    }

    /// Nominal cycles of all counted work.
    pub fn cycles(&self) -> u32 {
        self.cycles
    }
}

impl core::ops::AddAssign<&Self> for Counts {
    fn add_assign(&mut self, other: &Self) {
        self.pieces.iter_mut().zip(&other.pieces).for_each(|(sum, &more)| *sum += more);
        self.cycles += other.cycles;
    }
}
