//! Noise and filter of either order, with coefficients that move along the path.

use super::exciter::BandPass;
use super::kernel::two_poles::TwoPoles;
use super::kernel::{self, OnePole, SumsKind};
use super::path::{Form, MAX_INPUT_BITS, PARAMETERS, Path};
use super::walk::{Line, Walk};
use crate::fixed::{qadd, saturating_shift_left, smmulr, times_q31};
use crate::noise::White;
use crate::time::TICK_FRAMES;
use crate::waveguide::COARSE_BITS;

/// Noise and filter of one object. Words of the input are Q(27 - q).
#[derive(Debug)]
pub(super) struct Filter<'m> {
    pub(super) path: Path<'m>,
    walk: Walk,
    one_pole: OnePole,
    two_poles: TwoPoles,
    /// Format of the sums of noise and loops.
    sums: SumsKind,
    /// Level of the noise along the path, Q30.
    level: Line,
    /// Generator as it began, or as the last mute on the path set it.
    noise_start: White,
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
            noise_start: White::new(0, 0),
        }
    }

    /// Puts the filter at rest behind the end of the loaded path, with a generator of noise.
    pub(super) fn start(&mut self, noise: White) {
        self.one_pole = OnePole {
            noise,
            shift: self.path.scale,
            growth: self.path.growth,
            whole: self.path.whole,
            ..OnePole::REST
        };
        self.noise_start = noise;
        self.one_pole.state = self.one_pole.rest();
        self.two_poles = TwoPoles::new(&self.path);
        self.walk.end(&self.path);
    }

    /// Sets the format of sums: `coarse` if they are smaller than the input by [`COARSE_BITS`].
    pub(super) fn expect_sums(&mut self, coarse: bool) {
        self.sums = SumsKind::new(&self.one_pole, self.path.form == Form::EqualZeros, coarse);
    }

    /// Goes to the path's start and sets the noise's level, of which 2^28 is 1.0.
    pub(super) fn strike(&mut self, level: i32) {
        let level = shifted(level, self.path.input_shift);
        self.one_pole.level = level;
        self.walk.start(&self.path);
    }

    /// Begins a segment of at most `most` frames. Gives its number of frames, and true if it has
    /// noise.
    #[inline(always)]
    pub(super) fn segment(&mut self, most: usize) -> (usize, bool) {
        // Behind the path's end the lines stay as they are.
        if self.walk.is_over() {
            return (most, false);
        }
        self.begin_segment(most)
    }

    #[inline(never)]
    fn begin_segment(&mut self, most: usize) -> (usize, bool) {
        let frames = self.walk.segment(&self.path, most, &mut self.one_pole.lines, &mut self.level);
        // Noise of level 0 throughout the segment is not drawn.
        let silent = self.path.has_levels && self.level.is_zero();
        (frames, self.walk.is_under_way() && !silent)
    }

    /// True before the path's last breakpoint, at which noise ends.
    pub(super) fn is_under_way(&self) -> bool {
        self.walk.is_under_way()
    }

    /// Clears the state on a tick without input, if it is too small to decay further. Gives true if
    /// the filter is at rest.
    pub(super) fn settle(&mut self) -> bool {
        if self.path.form.parameters() == PARAMETERS {
            return self.two_poles.settle();
        }
        // Damping multiplies the rounded high word. With a positive pole the decay ends where that
        // word is 0. With a negative pole it ends within 1/(1 - |p|), because twice the rounding's
        // half step alternates. If damping multiplies all bits, it ends a step below 0.
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

    /// Clears all sound, and ends the path.
    pub(super) fn rest(&mut self) {
        (self.one_pole.state, self.one_pole.last) = (self.one_pole.rest(), 0);
        self.two_poles.rest();
        self.walk.end(&self.path);
    }

    /// Sets the generator of the noise that follows a mute, unless the path is over.
    pub(super) fn start_noise_anew(&mut self) {
        if self.walk.is_before(self.path.last_frame()) {
            self.noise_start = self.noise_start.skipped();
            self.one_pole.noise = self.noise_start;
        }
    }

    /// Multiplies all sound, and the noise to come, by `left` (Q31).
    pub(super) fn attenuate(&mut self, left: i32) {
        let nothing = self.one_pole.rest();
        let one_pole = &mut self.one_pole;
        // The half step in the state stays as it is. 32 bits of the rest are enough.
        one_pole.state = ((one_pole.state - nothing) >> 31) * i64::from(left) + nothing;
        (one_pole.last, one_pole.level) = (times_q31(one_pole.last, left), times_q31(one_pole.level, left));
        self.two_poles.attenuate(left);
    }

    /// Number of whole ticks that may be run by [`run_tick`](Self::run_tick), or begun by
    /// [`tick`](Self::tick), within the piece of the path. Behind the path's end it is
    /// unlimited if `after_end`, and 0 if not.
    pub(super) fn whole_ticks(&self, after_end: bool) -> u32 {
        match (self.walk.is_over(), after_end) {
            (true, true) => u32::MAX,
            (true, false) => 0,
            (false, _) => self.walk.whole_ticks(),
        }
    }

    /// Moves on by whole ticks along the path.
    pub(super) fn pass(&mut self, whole_ticks: u32) {
        self.walk.pass(whole_ticks);
    }

    /// Sets the lines for one whole tick before the path's end. Gives true if it has noise.
    pub(super) fn tick(&mut self) -> bool {
        self.tick_lines();
        !self.path.has_levels || {
            self.walk.tick_level(&mut self.level);
            !self.level.is_zero()
        }
    }

    /// Sets the coefficients' lines for one whole tick, but not the noise's level.
    #[inline(always)]
    pub(super) fn tick_lines(&mut self) {
        match self.path.form {
            Form::EqualZeros => self.walk.tick(&mut self.one_pole.lines, 2),
            Form::OnePole => self.walk.tick(&mut self.one_pole.lines, 3),
            Form::Conjugate | Form::Real => self.walk.tick(&mut self.one_pole.lines, PARAMETERS),
        }
    }

    /// Generator of the noise for sums, and the noise's level in their format.
    #[inline(always)]
    pub(super) fn noise_of_sums(&mut self) -> (&mut White, i32) {
        let level = self.one_pole.level >> self.grain();
        (&mut self.one_pole.noise, level)
    }

    /// Adds a whole tick of noise, filtered, to `out`. Does what [`segment`](Self::segment) and
    /// [`run_noise`](Self::run_noise) do, in less time.
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

    /// Adds noise, filtered, to `out`. Returns false if it has done nothing, because a filter of
    /// the second order needs [`run`](Self::run).
    #[inline(always)]
    pub(super) fn run_noise(&mut self, out: &mut [i32]) -> bool {
        match self.path.form {
            Form::EqualZeros => kernel::from_noise::<true>(&mut self.one_pole, out),
            Form::OnePole => kernel::from_noise::<false>(&mut self.one_pole, out),
            Form::Conjugate | Form::Real => return false,
        }
        true
    }

    /// Draws the next frames of noise, Q(27 - q), smaller by [`grain`](Self::grain) bits.
    pub(super) fn noise(&mut self, input: &mut [i32]) {
        self.draw(self.one_pole.level >> self.grain(), input);
    }

    /// Number of bits by which words are smaller than the filter's input, because they go into
    /// coarse sums ([`run_sums`](Self::run_sums)).
    fn grain(&self) -> u32 {
        if self.sums.is_coarse() { COARSE_BITS } else { 0 }
    }

    /// Draws the next frames of noise at a strike's level times the path's level.
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
            // The path's level 1 is 2^30, which leaves a product's high word two bits too small.
            *word = noise.draw(smmulr(level, part.value) << 2);
            part.advance();
        }
        (self.one_pole.noise, self.level) = (noise, part);
    }

    /// Fills `input` with the next frames of noise through the exciter's band, or, without noise,
    /// with the sound that still rings in the band.
    ///
    /// The band works on words below 2^27 or 2^25 ([`BandPass::bits`]).
    pub(super) fn excite(&mut self, band: &mut BandPass, noisy: bool, input: &mut [i32]) {
        let down = (MAX_INPUT_BITS - self.path.input_shift - band.bits()).max(0) as u32;
        if noisy {
            self.draw(self.one_pole.level >> down, input);
        } else {
            input.fill(0);
        }
        band.run(input);
        // 2.0 in the band's format is one of two powers in nearly all tables, and a single
        // instruction clips to a known power.
        let (bits, grain) = (MAX_INPUT_BITS - self.path.input_shift - down as i32, self.grain());
        match bits {
            27 => input.iter_mut().for_each(|word| *word = clipped(*word, 27) << down >> grain),
            25 => input.iter_mut().for_each(|word| *word = clipped(*word, 25) << down >> grain),
            _ => input.iter_mut().for_each(|word| *word = clipped(*word, bits) << down >> grain),
        }
    }

    /// Nominal cycles of a tick of noise and filter alone. If not `plain`, the noise goes through a
    /// buffer.
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

    /// Nominal cycles that a block of sums costs more in the second order; 0 in the first order.
    pub(super) fn cycles_a_block(&self) -> u32 {
        if self.path.form.parameters() == PARAMETERS { 150 } else { 0 }
    }

    /// Adds a signal of the bus to an input and clips the input to 2.0. Coarse sums are clipped at
    /// 32 times as much.
    pub(super) fn add(&self, signal: &[i32], input: &mut [i32]) {
        let shift = self.grain() as i32 + self.path.input_shift;
        let largest = self.largest_input();
        // The loop stands here twice, so that the direction of the shift is decided once.
        if shift >= 0 {
            let shift = shift.min(31);
            for (word, &sample) in input.iter_mut().zip(signal) {
                *word = qadd(*word, sample >> shift).max(-largest).min(largest);
            }
        } else {
            // Samples that the shift would overflow are beyond the clip anyway.
            let shift = shift.unsigned_abs().min(31);
            let most = i32::MAX >> shift;
            for (word, &sample) in input.iter_mut().zip(signal) {
                *word = qadd(*word, sample.max(-most).min(most) << shift).max(-largest).min(largest);
            }
        }
    }

    /// Largest word of the input: 2.0 less a step.
    pub(super) fn largest_input(&self) -> i32 {
        ((1i64 << (28 - self.path.input_shift)) - 1) as i32
    }

    /// Adds the input in `buffer`, filtered, to `out`, and leaves s in the buffer.
    ///
    /// In the second order s is larger than the bus by 2^[`line_scale`](Self::line_scale). In the
    /// first order it is as [`kernel::portable::from_buffer`] leaves it.
    pub(super) fn run(&mut self, buffer: &mut [i32], out: &mut [i32]) {
        match self.path.form {
            Form::EqualZeros => kernel::from_buffer::<true>(&mut self.one_pole, buffer, out),
            Form::OnePole => kernel::from_buffer::<false>(&mut self.one_pole, buffer, out),
            form @ (Form::Conjugate | Form::Real) => {
                kernel::two_poles(&mut self.two_poles, form == Form::Real, &mut self.one_pole.lines, buffer, out);
            }
        }
    }

    /// Clips sums of noise and loops to 2.0 and adds them, filtered, to `out`.
    ///
    /// Leaves s in the place of the sums, and gives the sizes of s, or'ed. There s is larger than
    /// the bus by 2^[`line_scale`](Self::line_scale).
    #[inline(always)]
    pub(super) fn run_sums(&mut self, sums: &mut [i32], out: &mut [i32]) -> u32 {
        match self.path.form {
            Form::EqualZeros | Form::OnePole => kernel::from_sums(&mut self.one_pole, self.sums, sums, out),
            Form::Conjugate | Form::Real => self.run_sums_of_two_poles(sums, out),
        }
    }

    #[inline(never)]
    fn run_sums_of_two_poles(&mut self, sums: &mut [i32], out: &mut [i32]) -> u32 {
        // The loop stands here twice, so that the kind of clip is decided once.
        if self.sums.is_coarse() {
            sums.iter_mut().for_each(|sum| *sum = kernel::portable::clipped::<true>(*sum));
        } else {
            sums.iter_mut().for_each(|sum| *sum = kernel::portable::clipped::<false>(*sum));
        }
        self.run(sums, out);
        sums.iter().fold(0, |sizes, &s| sizes | (s ^ (s >> 31)) as u32)
    }

    /// Exponent of two by which the s of [`run_sums`](Self::run_sums) is larger than the bus.
    pub(super) fn line_scale(&self) -> i32 {
        match (self.path.form.parameters() < PARAMETERS, self.one_pole.is_far()) {
            (true, true) => 0,
            (true, false) => self.path.scale + 2,
            (false, _) => self.path.scale,
        }
    }
}

/// Clips a word to ±2^bits.
#[inline(always)]
fn clipped(word: i32, bits: i32) -> i32 {
    word.clamp(-1 << bits, (1 << bits) - 1)
}

/// Shifts a word to the right by `right` bits, rounding down. A negative `right` shifts it to the
/// left, saturating.
#[inline(always)]
fn shifted(word: i32, right: i32) -> i32 {
    if right >= 0 { word >> right.min(31) } else { saturating_shift_left(word, right.unsigned_abs()) }
}
