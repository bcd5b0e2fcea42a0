//! A bank of modes in frames, and its head.

use super::head::Head;
use super::mode::{FrameMode, Line};
use crate::resonator::Retirement;
use crate::square_root::square_root;

/// A bank of modes in frames.
///
/// Accuracy of a mode against the `f64` reference: 100 dB and better (`cargo test -p host-tests
/// --test stages frames -- --nocapture`).
#[derive(Debug)]
pub struct FrameBank<'m> {
    pub(super) modes: &'m mut [FrameMode],
    pub(super) lines: &'m mut [Line],
    pub(super) head: Head<'m>,
    /// Gains from the bank's bus to both sides.
    pub(super) gains: [f32; 2],
    pub(super) ringing: u16,
    /// Bound of the amplitude that retired modes leave out, in bus steps, and its decay a block.
    pub(super) retired: f32,
    pub(super) retired_decay: f32,
}

impl FrameBank<'_> {
    /// A bank without modes.
    pub const fn empty() -> Self {
        Self {
            modes: &mut [],
            lines: &mut [],
            head: Head::empty(),
            gains: [0.0; 2],
            ringing: 0,
            retired: 0.0,
            retired_decay: 0.0,
        }
    }

    /// Number of modes that frames hold; those that only the head holds are not among them.
    pub fn mode_count(&self) -> usize {
        self.modes.len()
    }

    /// Number of modes that ring in frames.
    pub fn ringing_modes(&self) -> u32 {
        u32::from(self.ringing)
    }

    /// True if [`FrameBank::render`] makes a sound without a force.
    #[inline(always)]
    pub fn is_head_active(&self) -> bool {
        self.head.is_active()
    }

    /// True if the bank sounds or will.
    pub fn is_active(&self) -> bool {
        self.ringing > 0 || self.head.is_active()
    }

    /// Adds the head's sound for a run of at most a tick's frames to the pad's bus; `frame` is the
    /// run's first frame in its block ([`Head::render`]).
    pub fn render(&mut self, frame: usize, force: Option<&[i32]>, out: &mut [i32]) {
        self.head.render(frame, force, out);
    }

    /// Lets all modes ring, for a force that reaches them.
    pub(super) fn wake(&mut self) {
        self.lines.iter_mut().for_each(|line| line.ringing = line.count);
        self.ringing = self.modes.len() as u16; // banks count in 16 bits
    }

    /// Retires modes of some lines that no longer sound: those whose amplitude at the block's
    /// beginning is below the threshold, while the sum of retired amplitudes allows it.
    pub(super) fn retire(&mut self, lines: core::ops::Range<usize>, first_mode: usize) {
        let loudest = self.gains[0].max(self.gains[1]) / crate::fixed::ONE_Q27 as f32;
        let audible = Retirement::THRESHOLD / loudest.max(f32::MIN_POSITIVE);
        let audible = audible * audible;
        let Some(lines) = self.lines.get_mut(lines) else { return };
        let mut first = first_mode;
        for line in lines {
            while let Some(last) = line.ringing.checked_sub(1) {
                let Some(mode) = self.modes.get_mut(first + usize::from(last)) else { break };
                let squared = |[x, y]: [f32; 2]| x * x + y * y;
                // From the block's middle to its beginning the amplitude falls by less than |z^N|.
                let (size, decay) = (squared(mode.state), squared(mode.step));
                if size > audible * decay {
                    break;
                }
                let (size, decay) = (square_root(size), square_root(decay));
                if (size + self.retired * decay) * loudest > Retirement::SUM * decay {
                    break;
                }
                if size > 0.0 {
                    self.retired += size / decay;
                    self.retired_decay = self.retired_decay.max(decay);
                }
                mode.state = [0.0; 2];
                line.ringing = last;
                self.ringing -= 1;
            }
            first += usize::from(line.count);
        }
    }

    /// Begins a block for the head and for the sum of retired amplitudes.
    pub(super) fn begin_block(&mut self) {
        self.head.begin_block();
        self.retired *= self.retired_decay;
        let loudest = self.gains[0].max(self.gains[1]) / crate::fixed::ONE_Q27 as f32;
        if self.retired * loudest < 1e-10 {
            (self.retired, self.retired_decay) = (0.0, 0.0);
        }
    }
}
