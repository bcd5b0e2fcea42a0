//! An object's dynamic filter as a whole: noise, exciter, filter, and the loops round it.

use super::exciter::BandPass;
use super::filter::Filter;
use crate::time::TICK_FRAMES;
use crate::waveguide::Loops;

/// Size of a [`DynamicFilter`], from which its memory follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FilterSize {
    /// Number of breakpoints of the path.
    pub breakpoints: usize,
    /// Number of loops round the filter.
    pub loops: usize,
    /// Frames of the loops' delay line.
    pub line_frames: usize,
}

/// The dynamic filter of one object, with the loops round it.
///
/// Input and output are blocks of Q4.27. Ticks of 32 frames are counted from the first frame, so
/// that the caller's block size changes no bit.
///
/// `cargo test -p host-tests --test stages -- --nocapture dynamic_filter waveguides` prints the
/// worst SNR against `f64` that is fed with this filter's noise. Cycles are printed by
/// `cargo test -p host-tests --test on_chip filters -- --nocapture`.
///
/// ```
/// use dsp_core::SampleRate;
/// use dsp_core::dynamic_filter::{Breakpoint, DynamicFilter, Settings};
/// use dsp_core::memory::{Memory, Word};
/// let point = |time_s, b0, a1| Breakpoint { time_s, a1, b0, b1: b0, ..Breakpoint::default() };
/// let path = [point(0.0, 0.2, -0.3), point(0.25, 0.0, -0.98)];
/// let settings = Settings {
///     seed: 1,
///     rate_hz: 48_000.0,
///     order: 1,
///     modes_through: false,
///     exciter: None,
///     path: path.iter().copied(),
///     loops: [].iter().copied(),
/// };
/// let size = DynamicFilter::size(&settings, SampleRate::HZ_48000).unwrap();
/// let mut words = [Word::uninit(); 100];
/// let mut filter = DynamicFilter::take(&mut Memory::new(&mut [], &mut words), size).unwrap();
/// filter.load(settings, SampleRate::HZ_48000, 0).unwrap();
/// filter.strike(1.0);
/// let mut out = [0; 100];
/// filter.render(None, &mut out);
/// assert!(out.iter().any(|&sample| sample != 0));
/// ```
// Fields that every tick reads stand near the start, where the core's short instructions reach
// them.
#[derive(Debug)]
#[repr(C)]
pub struct DynamicFilter<'m> {
    pub(super) modes_through: bool,
    pub(super) loaded: bool,
    /// True if noise goes straight into a filter of the first order, and nothing else does.
    pub(super) plain: bool,
    /// True if loops work in blocks of a tick, on noise without a band or levels of its own.
    pub(super) looped: bool,
    /// Noise level 1.0 as a word: 2^28 times the square root of the rate over the table's rate.
    pub(super) level_unit: f32,
    /// Frame within the tick.
    pub(super) frame: usize,
    /// Number of frames that are left of the segment.
    pub(super) left: usize,
    /// Number of whole ticks granted, in which nothing begins or ends and no modes come.
    pub(super) granted: u32,
    /// Number of granted ticks that are left.
    pub(super) whole_ticks: u32,
    /// True if the segment has noise.
    pub(super) noisy: bool,
    /// True if modes have come in since the last check for rest.
    pub(super) fed: bool,
    /// True if anything sounds or may sound.
    pub(super) ringing: bool,
    pub(super) exciter: BandPass,
    pub(super) filter: Filter<'m>,
    pub(super) loops: Loops<'m>,
}

impl<'m> DynamicFilter<'m> {
    /// Makes a filter that is not loaded: it adds nothing to the output and takes no time.
    pub const fn empty() -> Self {
        Self {
            filter: Filter::empty(),
            loops: Loops::empty(),
            exciter: BandPass::NONE,
            modes_through: false,
            loaded: false,
            plain: false,
            looped: false,
            level_unit: 0.0,
            frame: 0,
            left: 0,
            granted: 0,
            whole_ticks: 0,
            noisy: false,
            fed: false,
            ringing: false,
        }
    }

    /// Largest level of a strike. Louder strikes are played at this level.
    pub const MAX_LEVEL: f32 = 1.99;

    /// True if the caller gives the object's modes to [`render`](Self::render); false if it adds
    /// them to the output itself.
    pub fn takes_modes(&self) -> bool {
        self.modes_through
    }

    /// Returns q of the noise's format Q(27 - q), which is chosen on load. A test must know it to
    /// draw equal noise.
    pub fn input_shift(&self) -> i32 {
        self.filter.path.input_shift
    }

    /// Starts the path anew, from the next frame that is rendered. Earlier sound rings on.
    ///
    /// `level` is the strike's peak force over the reference force, from 0 to
    /// [`MAX_LEVEL`](Self::MAX_LEVEL). It scales the noise and moves the exciter's band, but never
    /// changes the filter, so that loops stay stable.
    pub fn strike(&mut self, level: f32) {
        if !self.loaded {
            return;
        }
        let level = level.clamp(0.0, Self::MAX_LEVEL);
        // The input's format holds at most 1.99 times 2^28.
        let words = (level * self.level_unit).min(Self::MAX_LEVEL * 268_435_456.0);
        self.settle_whole_ticks();
        self.filter.strike(words as i32);
        self.exciter.strike(level);
        (self.left, self.ringing) = (0, true);
    }

    /// True if anything sounds or may sound. If false, [`pass`](Self::pass) suffices for a block
    /// without modes.
    pub fn is_ringing(&self) -> bool {
        self.ringing
    }

    /// Adds a block of any length to `out`, Q4.27, saturating.
    ///
    /// `modes` has as many frames as `out`, and is added to the filter's input. It is ignored if
    /// the table does not send the modes through the filter.
    #[inline(never)] // its kernels are called through a pointer, from here alone
    pub fn render(&mut self, modes: Option<&[i32]>, out: &mut [i32]) {
        // The usual case: a granted whole tick.
        if let Some(tick) = out.as_mut_array()
            && (self.whole_ticks > 0 || self.renew())
        {
            self.whole_ticks -= 1;
            if self.plain {
                self.filter.run_tick(tick);
            } else {
                self.run_tick(tick);
            }
            return;
        }
        self.render_any(modes, out);
    }

    #[inline(never)]
    pub(super) fn render_any(&mut self, modes: Option<&[i32]>, out: &mut [i32]) {
        if !self.ringing && modes.is_none() {
            return self.pass(out.len());
        }
        // Whole ticks cost less, so a longer block is cut into them.
        if modes.is_none()
            && out.len() > TICK_FRAMES
            && let Some((rest_of_tick, ticks)) = out.split_at_mut_checked((TICK_FRAMES - self.frame) % TICK_FRAMES)
        {
            self.render_any(None, rest_of_tick);
            return ticks.chunks_mut(TICK_FRAMES).for_each(|tick| self.render(None, tick));
        }
        self.settle_whole_ticks();
        let (mut modes, mut out) = (modes.unwrap_or(&[]), out);
        while !out.is_empty() {
            if self.ringing && self.left == 0 {
                self.begin();
            }
            if !self.ringing {
                // The filter rests until the first frame of modes that is not 0.
                let given = if self.modes_through { modes } else { &[] };
                let waits = given.iter().position(|&mode| mode != 0).unwrap_or(out.len()).min(out.len());
                self.pass(waits);
                out = out.split_at_mut(waits).1;
                modes = modes.split_at(waits.min(modes.len())).1;
                if !out.is_empty() {
                    self.ringing = true;
                    self.segment();
                }
                continue;
            }
            let most = out.len().min(self.left);
            let frames = if self.loops.count() > 0 { self.loops.slot_length(most) } else { most };
            let (now, later) = out.split_at_mut(frames);
            let (given, more) = modes.split_at(frames.min(modes.len()));
            if self.loops.count() > 0 {
                self.run_looped(given, now);
            } else if !(self.plain && self.noisy && self.filter.run_noise(now)) {
                self.run(given, now);
            }
            (out, modes) = (later, more);
            self.left -= frames;
            self.frame = (self.frame + frames) % TICK_FRAMES;
        }
        if self.plain && self.ringing && self.frame == 0 && self.left == 0 {
            self.granted = self.filter.whole_ticks(false);
            self.whole_ticks = self.granted;
        }
    }

    /// Begins a segment at a tick, a strike or a breakpoint.
    #[inline(always)]
    fn begin(&mut self) {
        if self.frame == 0 {
            self.settle();
        }
        self.segment();
    }

    fn segment(&mut self) {
        (self.left, self.noisy) = self.filter.segment(TICK_FRAMES - self.frame);
    }

    /// Scales the loops' states on a tick, and looks for rest after the path's end. If there are
    /// loops, it looks for rest only at the end of their windows.
    #[inline(always)]
    pub(super) fn settle(&mut self) {
        let (due, silent) = if self.loops.count() > 0 { self.loops.settle() } else { (true, true) };
        if due && !self.filter.is_under_way() {
            self.end(silent);
        }
    }

    /// Ends the sound if all is at rest, on a tick after the path's end. `silent` is true if the
    /// loops' line holds no sound, not even in frames that they have still to read.
    #[inline(never)]
    fn end(&mut self, silent: bool) {
        let excited = !self.exciter.settle();
        let comes = excited || core::mem::take(&mut self.fed);
        if silent && !comes && self.loops.count() > 0 {
            self.loops.rest();
            self.filter.rest();
        }
        self.ringing = !self.filter.settle() || comes || !silent;
    }

    /// Adds the sums in the loops' line, filtered, to `out`.
    #[inline(always)]
    pub(super) fn filter_sums(&mut self, out: &mut [i32]) {
        let frames = out.len();
        let sizes = self.filter.run_sums(self.loops.slot(frames), out);
        self.loops.advance(frames, sizes);
    }

    /// Renders frames within a segment through the loops' line. Noise is drawn for all of them at
    /// once; modes, loops and filter work in blocks of the shortest delay.
    #[inline(never)]
    pub(super) fn run_looped(&mut self, modes: &[i32], out: &mut [i32]) {
        let sums = self.loops.slot(out.len());
        if self.exciter.is_loaded() {
            self.filter.excite(&mut self.exciter, self.noisy, sums);
        } else if self.noisy {
            self.filter.noise(sums);
        } else {
            sums.fill(0);
        }
        let (mut modes, mut out) = (modes, out);
        while !out.is_empty() {
            let frames = self.loops.run_length(out.len());
            let (now, later) = out.split_at_mut(frames);
            self.loops.add(frames);
            if self.modes_through {
                let (given, more) = modes.split_at(frames.min(modes.len()));
                self.filter.add(given, self.loops.slot(frames));
                self.fed |= given.iter().any(|&mode| mode != 0);
                modes = more;
            }
            self.filter_sums(now);
            out = later;
        }
    }

    /// Renders frames within a segment without loops, through a buffer.
    #[inline(never)]
    pub(super) fn run(&mut self, modes: &[i32], out: &mut [i32]) {
        let mut own = [0; TICK_FRAMES];
        let Some(input) = own.get_mut(..out.len()) else { return };
        if self.exciter.is_loaded() {
            self.filter.excite(&mut self.exciter, self.noisy, input);
        } else if self.noisy {
            self.filter.noise(input);
        }
        if self.modes_through {
            self.filter.add(modes, input);
        }
        self.filter.run(input, out);
    }

    /// Counts frames in which nothing rings and no modes come, instead of rendering them.
    pub fn pass(&mut self, frames: usize) {
        self.frame = (self.frame + frames) % TICK_FRAMES;
    }

    /// Clears all sound and ends the path. The noise's generator keeps its state.
    pub fn rest(&mut self) {
        self.settle_whole_ticks();
        self.filter.rest();
        self.loops.rest();
        self.exciter.rest();
        (self.left, self.noisy, self.ringing) = (0, false, false);
    }

    /// Clears all sound and ends the path when a choke has taken all.
    ///
    /// If the path was not over, the noise's generator goes on
    /// [`White::SKIP`](crate::noise::White::SKIP) draws behind its start, or behind the place to
    /// which the mute before this one put it. So the strikes that follow sound the same, whichever
    /// tick the choke ended in: that hangs on a rounding.
    pub fn mute(&mut self) {
        self.settle_whole_ticks();
        self.filter.start_noise_anew();
        self.rest();
    }

    /// Multiplies all sound, and the noise to come, by `left` (Q31). The next strike sets the
    /// noise's level anew.
    pub fn attenuate(&mut self, left: i32) {
        self.settle_whole_ticks();
        self.filter.attenuate(left);
        self.loops.attenuate(left);
        self.exciter.attenuate(left);
    }

    /// Largest number of nominal cycles of a tick in which the filter sounds, for the engine's
    /// budget; 0 if no filter is loaded.
    pub fn cycles_a_tick(&self) -> u32 {
        if !self.loaded {
            return 0;
        }
        let mut cycles = self.filter.cycles_a_tick(self.plain);
        cycles += if self.exciter.is_loaded() { 67 * 32 } else { 0 };
        cycles += if self.modes_through { 12 * 32 } else { 0 };
        cycles + self.loops.cycles_a_tick(self.filter.cycles_a_block())
    }
}
