//! The filter along its path, of either order.

use super::exciter::BandPass;
use super::kernel::two_poles::TwoPoles;
use super::kernel::{self, OnePole, SumsKind};
use super::path::{Form, MAX_INPUT_BITS, PARAMETERS, Path};
use super::walk::{Line, Walk};
use crate::fixed::{qadd, saturating_shift_left, smmulr, times_q31};
use crate::noise::White;
use crate::time::TICK_FRAMES;
use crate::waveguide::COARSE_BITS;

/// Noise and filter of one object; its input is Q(27 - q).
#[derive(Debug)]
pub(super) struct Filter<'m> {
    pub(super) path: Path<'m>,
    walk: Walk,
    one_pole: OnePole,
    two_poles: TwoPoles,
    /// Format of the sums that come in.
    sums: SumsKind,
    /// The path's level of the noise, Q30.
    level: Line,
}

impl Filter<'_> {
    pub(super) const fn empty() -> Self {
        Self {
            path: Path::empty(),
            walk: Walk::NOWHERE,
            one_pole: OnePole::REST,
            two_poles: TwoPoles::REST,
            sums: SumsKind::new(&OnePole::REST, true, false),
            level: Line { value: 0, step: 0 },
        }
    }

    /// At rest behind the end of the loaded path.
    pub(super) fn start(&mut self, noise: White) {
        self.one_pole = OnePole {
            noise,
            shift: self.path.scale,
            growth: self.path.growth,
            whole: self.path.whole,
            ..OnePole::REST
        };
        self.one_pole.state = self.one_pole.rest();
        self.two_poles = TwoPoles::new(&self.path);
        self.walk.end(&self.path);
    }

    /// Input of sums, `coarse` if they are smaller than noise by [`COARSE_BITS`].
    pub(super) fn expect_sums(&mut self, coarse: bool) {
        self.sums = SumsKind::new(&self.one_pole, self.path.form == Form::EqualZeros, coarse);
    }

    /// To the path's start, with noise of a level of which 2^28 is 1.0.
    pub(super) fn strike(&mut self, level: i32) {
        let level = shifted(level, self.path.input_shift);
        self.one_pole.level = level;
        self.walk.start(&self.path);
    }

    /// Begins a segment of at most so many frames: gives its frames, and whether there is noise in
    /// it.
    #[inline(always)]
    pub(super) fn segment(&mut self, most: usize) -> (usize, bool) {
        // Nothing new behind the path's end.
        if self.walk.is_over() {
            return (most, false);
        }
        self.begin_segment(most)
    }

    #[inline(never)]
    fn begin_segment(&mut self, most: usize) -> (usize, bool) {
        let frames = self.walk.segment(&self.path, most, &mut self.one_pole.lines, &mut self.level);
        // What is 0 all along is not drawn.
        let silent = self.path.has_levels && self.level.is_zero();
        (frames, self.walk.is_under_way() && !silent)
    }

    /// True if noise is still to come.
    pub(super) fn is_under_way(&self) -> bool {
        self.walk.is_under_way()
    }

    /// At a tick into which nothing came: clears what is below a step; gives whether all is.
    pub(super) fn settle(&mut self) -> bool {
        if self.path.form.parameters() == PARAMETERS {
            return self.two_poles.settle();
        }
        // Damping takes the high word, rounded: a positive pole ends where that is 0, a negative
        // one, where twice the rounding's half step alternates, within 1/(1 - |p|); where it takes
        // all bits, a step below it.
        let nothing = self.one_pole.rest();
        let bits = if self.one_pole.is_far() { 30 } else { 32 };
        let OnePole { state, last, lines: [damp, ..], .. } = &mut self.one_pole;
        let distance = i64::from(damp.value) + (1 << 31);
        let rest = if self.path.whole {
            1
        } else if distance < 1 << 30 {
            (1 << 30) / distance.max(1) + 2
        } else {
            0
        };
        if *last == 0 && (-rest..=rest).contains(&(*state >> bits)) {
            *state = nothing;
        }
        *last == 0 && *state == nothing
    }

    /// Clears what rings, and ends the path.
    pub(super) fn rest(&mut self) {
        (self.one_pole.state, self.one_pole.last) = (self.one_pole.rest(), 0);
        self.two_poles.rest();
        self.walk.end(&self.path);
    }

    /// Leaves so much (Q31) of what rings and of the noise to come.
    pub(super) fn attenuate(&mut self, left: i32) {
        let nothing = self.one_pole.rest();
        let one_pole = &mut self.one_pole;
        // Beside the half step that it holds; 32 bits of it are enough.
        one_pole.state = ((one_pole.state - nothing) >> 31) * i64::from(left) + nothing;
        (one_pole.last, one_pole.level) = (times_q31(one_pole.last, left), times_q31(one_pole.level, left));
        self.two_poles.attenuate(left);
    }

    /// Number of whole ticks that may be run by [`run_tick`](Self::run_tick), or begun by
    /// [`tick`](Self::tick): within the path's piece, or, where this is asked for, behind the
    /// path's end.
    pub(super) fn whole_ticks(&self, after_end: bool) -> u32 {
        match (self.walk.is_over(), after_end) {
            (true, true) => u32::MAX,
            (true, false) => 0,
            (false, _) => self.walk.whole_ticks(),
        }
    }

    /// Goes on by so many of them on the path.
    pub(super) fn pass(&mut self, whole_ticks: u32) {
        self.walk.pass(whole_ticks);
    }

    /// Sets the lines for one of them before the path's end; gives whether there is noise in it.
    pub(super) fn tick(&mut self) -> bool {
        self.tick_lines();
        !self.path.has_levels || {
            self.walk.tick_level(&mut self.level);
            !self.level.is_zero()
        }
    }

    /// Walks as [`walk`](Self::walk) does, for noise without levels.
    #[inline(always)]
    pub(super) fn tick_lines(&mut self) {
        match self.path.form {
            Form::EqualZeros => self.walk.tick(&mut self.one_pole.lines, 2),
            Form::OnePole => self.walk.tick(&mut self.one_pole.lines, 3),
            Form::Conjugate | Form::Real => self.walk.tick(&mut self.one_pole.lines, PARAMETERS),
        }
    }

    /// Generator of the noise for sums, and its level.
    #[inline(always)]
    pub(super) fn noise_of_sums(&mut self) -> (&mut White, i32) {
        let level = self.one_pole.level >> self.grain();
        (&mut self.one_pole.noise, level)
    }

    /// A whole tick of noise through the filter, added to `out`: as [`segment`](Self::segment) and
    /// [`run_noise`](Self::run_noise), for less.
    #[inline(always)]
    pub(super) fn run_tick(&mut self, out: &mut [i32; TICK_FRAMES]) {
        if self.path.form == Form::EqualZeros {
            self.walk.tick(&mut self.one_pole.lines, 2);
            kernel::from_noise::<true>(&mut self.one_pole, out);
        } else {
            self.walk.tick(&mut self.one_pole.lines, 3);
            kernel::from_noise::<false>(&mut self.one_pole, out);
        }
    }

    /// Noise through the filter, added to `out`; `false` where only [`run`](Self::run) can.
    #[inline(always)]
    pub(super) fn run_noise(&mut self, out: &mut [i32]) -> bool {
        match self.path.form {
            Form::EqualZeros => kernel::from_noise::<true>(&mut self.one_pole, out),
            Form::OnePole => kernel::from_noise::<false>(&mut self.one_pole, out),
            Form::Conjugate | Form::Real => return false,
        }
        true
    }

    /// The next frames of noise, Q(27 - q).
    pub(super) fn noise(&mut self, input: &mut [i32]) {
        self.draw(self.one_pole.level >> self.grain(), input);
    }

    /// Bits by which the input's words are smaller than the filter takes them: those of sums
    /// ([`run_sums`](Self::run_sums)).
    fn grain(&self) -> u32 {
        if self.sums.is_coarse() { COARSE_BITS } else { 0 }
    }

    /// The next frames of noise at a strike's level, and at the path's.
    #[inline(always)]
    fn draw(&mut self, level: i32, input: &mut [i32]) {
        if self.path.has_levels {
            self.draw_levels(level, input);
        } else {
            kernel::noise(&mut self.one_pole.noise, level, input);
        }
    }

    #[inline(never)]
    fn draw_levels(&mut self, level: i32, input: &mut [i32]) {
        let (mut noise, mut part) = (self.one_pole.noise, self.level);
        for word in input {
            // 1 is 2^30: two bits less than a product's high word has.
            *word = noise.draw(smmulr(level, part.value) << 2);
            part.advance();
        }
        (self.one_pole.noise, self.level) = (noise, part);
    }

    /// The next frames of noise through the exciter's band, which works on words below 2^27; or
    /// what it gives without noise.
    pub(super) fn excite(&mut self, band: &mut BandPass, noisy: bool, input: &mut [i32]) {
        let down = (MAX_INPUT_BITS - self.path.input_shift - band.bits()).max(0) as u32;
        if noisy {
            self.draw(self.one_pole.level >> down, input);
        } else {
            input.fill(0);
        }
        band.run(input);
        // 2.0 in the band's format, in nearly all tables one of two powers, to which a single
        // instruction clips.
        let (bits, grain) = (MAX_INPUT_BITS - self.path.input_shift - down as i32, self.grain());
        match bits {
            27 => input.iter_mut().for_each(|word| *word = clipped(*word, 27) << down >> grain),
            25 => input.iter_mut().for_each(|word| *word = clipped(*word, 25) << down >> grain),
            _ => input.iter_mut().for_each(|word| *word = clipped(*word, bits) << down >> grain),
        }
    }

    /// Nominal cycles of a tick of noise alone, in blocks where it is not `plain`.
    pub(super) fn cycles_a_tick(&self, plain: bool) -> u32 {
        let first = match (self.path.form, plain) {
            (Form::EqualZeros, true) => 560,
            (Form::OnePole, true) => 650,
            (Form::EqualZeros, false) => 780,
            (Form::OnePole, false) => 980,
            (Form::Conjugate, _) => 2600,
            (Form::Real, _) => 2860,
        };
        let second = self.path.form.parameters() == PARAMETERS;
        let levels = if self.path.has_levels { [630, 340][usize::from(second)] } else { 0 };
        let loud = if second && self.path.scale < 0 { 360 } else { 0 };
        first + levels + loud + if self.path.whole { 32 * 90 } else { 0 }
    }

    /// Filters a block of sums that the first order does not take.
    pub(super) fn cycles_a_block(&self) -> u32 {
        if self.path.form.parameters() == PARAMETERS { 150 } else { 0 }
    }

    /// Adds a signal of the bus to an input, and clips it to 2.0; coarse sums to more.
    pub(super) fn add(&self, signal: &[i32], input: &mut [i32]) {
        let shift = self.grain() as i32 + self.path.input_shift;
        let largest = self.largest_input();
        // Twice the loop, so that what is shifted how is asked once.
        if shift >= 0 {
            let shift = shift.min(31);
            for (word, &sample) in input.iter_mut().zip(signal) {
                *word = qadd(*word, sample >> shift).max(-largest).min(largest);
            }
        } else {
            // What would be lost at the top is beyond the clip.
            let shift = shift.unsigned_abs().min(31);
            let most = i32::MAX >> shift;
            for (word, &sample) in input.iter_mut().zip(signal) {
                *word = qadd(*word, sample.max(-most).min(most) << shift).max(-largest).min(largest);
            }
        }
    }

    /// 2.0, less a step.
    pub(super) fn largest_input(&self) -> i32 {
        ((1i64 << (28 - self.path.input_shift)) - 1) as i32
    }

    /// An input through the filter, added to `out`. In the buffer s is left, larger than the bus by
    /// 2^[`line_scale`](Self::line_scale).
    pub(super) fn run(&mut self, buffer: &mut [i32], out: &mut [i32]) {
        match self.path.form {
            Form::EqualZeros => kernel::from_buffer::<true>(&mut self.one_pole, buffer, out),
            Form::OnePole => kernel::from_buffer::<false>(&mut self.one_pole, buffer, out),
            form @ (Form::Conjugate | Form::Real) => {
                kernel::two_poles(&mut self.two_poles, form == Form::Real, &mut self.one_pole.lines, buffer, out);
            }
        }
    }

    /// Sums of noise and loops, clipped to 2.0, through the filter, added to `out`, and s left in
    /// their place; gives its sizes, or'ed.
    #[inline(always)]
    pub(super) fn run_sums(&mut self, sums: &mut [i32], out: &mut [i32]) -> u32 {
        match self.path.form {
            Form::EqualZeros | Form::OnePole => kernel::from_sums(&mut self.one_pole, self.sums, sums, out),
            Form::Conjugate | Form::Real => self.run_sums_of_two_poles(sums, out),
        }
    }

    #[inline(never)]
    fn run_sums_of_two_poles(&mut self, sums: &mut [i32], out: &mut [i32]) -> u32 {
        // Twice the loop, so that how it is clipped is asked once.
        if self.sums.is_coarse() {
            sums.iter_mut().for_each(|sum| *sum = kernel::portable::clipped::<true>(*sum));
        } else {
            sums.iter_mut().for_each(|sum| *sum = kernel::portable::clipped::<false>(*sum));
        }
        self.run(sums, out);
        sums.iter().fold(0, |sizes, &s| sizes | (s ^ (s >> 31)) as u32)
    }

    /// See [`run`](Self::run).
    pub(super) fn line_scale(&self) -> i32 {
        match (self.path.form.parameters() < PARAMETERS, self.one_pole.is_far()) {
            (true, true) => 0,
            (true, false) => self.path.scale + 2,
            (false, _) => self.path.scale,
        }
    }
}

/// Clipped to 2^bits.
#[inline(always)]
fn clipped(word: i32, bits: i32) -> i32 {
    word.clamp(-1 << bits, (1 << bits) - 1)
}

/// By so many bits to the right, rounding down, or to the left, saturating.
#[inline(always)]
fn shifted(word: i32, right: i32) -> i32 {
    if right >= 0 { word >> right.min(31) } else { saturating_shift_left(word, right.unsigned_abs()) }
}
