//! Counts of a bank's work.

/// Work of a bank over a run of frames, in modes (times the frames of the run for the first two).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BankWork {
    /// Modes that ran with input, times frames.
    pub driven_mode_frames: u32,
    /// Modes that rang freely, times frames.
    pub free_mode_frames: u32,
    /// Number of guards beyond the one a tick, because a force outgrew its allowance.
    pub extra_guards: u32,
    /// Number of runs of a group whose input was refused for want of headroom.
    pub refused: u32,
}

impl core::ops::AddAssign for BankWork {
    fn add_assign(&mut self, other: Self) {
        self.driven_mode_frames += other.driven_mode_frames;
        self.free_mode_frames += other.free_mode_frames;
        self.extra_guards += other.extra_guards;
        self.refused += other.refused;
    }
}
