//! What the parts of a tick cost.

/// What a tick is made of, as far as it costs time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Part {
    /// A tick in which something is to be done.
    Tick,
    /// A pad, sounding or not, in a run.
    Pad,
    /// A pad with bookkeeping at a tick's beginning.
    WakingPad,
    /// A register group whose bank is guarded at a tick's beginning.
    DueGroup,
    /// A pad that rings freely, in a run: straight to the stereo bus.
    RingingPad,
    /// The same, over the bus: loud, or with a striker's bank that rings.
    BusPad,
    /// A frame of it.
    BusFrame,
    /// A bank, beside the object's, that rings or is driven.
    StrikerBank,
    /// A pad under a force, in a run: straight to the stereo bus.
    DrivenPad,
    /// The same, over the bus: with an onset, an acceleration sound or a striker's bank, or too loud.
    BusDrivenPad,
    /// A frame of a pad under a force, either way.
    DrivenFrame,
    /// A frame of a contact.
    ContactFrame,
    /// A frame of a direct force.
    DirectFrame,
    /// A register group at rest that is guarded for a contact.
    GuardedGroup,
    /// The same of a group that rings.
    GuardedRingingGroup,
    /// A strike.
    Strike,
    /// A hand that comes or goes.
    Hand,
    /// A mode that it reaches.
    ChokedMode,
    /// A mode whose gains are derived for a strike at another position.
    MovedMode,
    /// A frame of a register group under a force in the second slot of its pad, beside its kernel's cycles.
    SecondFrame,
    /// A frame of a driven pad that goes straight to the stereo bus and adds a share of the force.
    OnsetFrame,
    /// A survey of all groups, to leave some out.
    Survey,
    /// A group of it.
    SurveyedGroup,
    /// A look ahead.
    Look,
    /// A group whose cost is looked up in it.
    PredictedGroup,
    /// A cycle of the kernels.
    KernelCycle,
    /// A strike that begins a residual.
    ResidualStrike,
    /// A residual or the background, in a run.
    ResidualRun,
    /// A frame of it.
    ResidualFrame,
    /// A cycle of the work on noise to come, of the room, and of filters.
    ResidualCycle,
    /// A tick in which nothing is.
    IdleTick,
}

/// Number of [`Part`]s.
pub const PARTS: usize = Part::IdleTick as usize + 1;

/// Cycles of each [`Part`], nominal, without flash waits, from fits to the virtual core (`cargo bench -p host-tests --bench budget_costs` prints one) and from
/// profiles where a fit cannot tell parts apart; `cargo test -p host-tests --test on_chip budget` holds them to 3 %.
pub const CYCLES: [u32; PARTS] = [
    900, 457, 462, 118, 1089, 1305, 49, 2394, 2900, 5380, 20, 131, 24, 430, 435, 2900, 640, 60, 1600, 205, 32, 5500,
    125, 800, 30, 1, 700, 500, 40, 1, 963,
];

/// Number of each part in a tick, and the cycles of all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    parts: [u32; PARTS],
    /// Kept up with each change: a sum over all parts would take some 300 cycles each time.
    cycles: u32,
}

impl Counts {
    /// Nothing.
    pub const NONE: Self = Self { parts: [0; PARTS], cycles: 0 };

    /// Adds a number of a part.
    #[inline(always)] // a part is known where it is added, and so are its cycles
    pub(super) fn add(&mut self, part: Part, count: u32) {
        if let (Some(counted), Some(cycles)) = (self.parts.get_mut(part as usize), CYCLES.get(part as usize)) {
            *counted += count;
            self.cycles += count * cycles;
        }
    }

    /// Adds several parts.
    #[inline(always)]
    pub(super) fn add_all<const N: usize>(&mut self, parts: [(Part, u32); N]) {
        parts.into_iter().for_each(|(part, count)| self.add(part, count));
    }

    /// Takes a number of a part away, at most all.
    pub(super) fn remove(&mut self, part: Part, count: u32) {
        if let (Some(counted), Some(cycles)) = (self.parts.get_mut(part as usize), CYCLES.get(part as usize)) {
            let count = count.min(*counted);
            *counted -= count;
            self.cycles -= count * cycles;
        }
    }

    /// True if a tick has been counted.
    pub fn is_any(&self) -> bool {
        self.cycles > 0
    }

    /// Number of a part.
    pub fn of(&self, part: Part) -> u32 {
        self.parts.get(part as usize).copied().unwrap_or(0)
    }

    /// Numbers of all parts, in the order of [`Part`].
    pub fn all(&self) -> &[u32; PARTS] {
        &self.parts
    }

    /// Cycles of all parts together.
    pub fn cycles(&self) -> u32 {
        self.cycles
    }
}

impl core::ops::AddAssign<&Self> for Counts {
    fn add_assign(&mut self, other: &Self) {
        self.parts.iter_mut().zip(&other.parts).for_each(|(sum, &more)| *sum += more);
        self.cycles += other.cycles;
    }
}
