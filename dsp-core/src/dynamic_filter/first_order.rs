//! The filter's state, and its blocks.

use super::path::Path;
use crate::fixed::{qadd, saturate, smmulr};
use crate::noise::Sfc32;
use crate::resonator::TICK_FRAMES;

/// The largest |e|: 2.0, of which noise takes 1.0. What comes in is clipped to it.
const MAX_INPUT: i32 = (1 << 28) - 1;

/// 1 + a1 = 1, with 32 bits more.
const NO_POLE: i64 = 1 << 62;

/// The dynamic filter of one object.
///
/// Worst SNR against `f64` fed the same noise: `cargo test -p host-tests --test dynamic_filter -- --nocapture`.
#[derive(Clone, Debug)]
pub struct Filter<const N: usize> {
    path: Path<N>,
    noise: Sfc32,
    /// The half of a draw that is yet to be used.
    spare: Option<i32>,
    /// S, 2^(32 + h) times the bus.
    state: i64,
    last_input: i32,
    /// Frames since the strike, and the tick's frame.
    time: u32,
    frame: usize,
    /// Strike's gain of b0 and b1, and of the noise, Q31.
    gain: i32,
    noise_level: i32,
    /// b0, b1 with 32 bits more than the filter takes, and their step.
    b: [i64; 2],
    b_step: [i64; 2],
    /// 1 + a1 with 32 bits more.
    damp: i64,
    damp_step: i64,
    sounding: bool,
    ringing: bool,
}

impl<const N: usize> Filter<N> {
    /// At rest, with noise of its own.
    pub fn new(path: Path<N>, seed: u32, stream: u32) -> Self {
        Self {
            path,
            noise: Sfc32::new(seed, stream),
            spare: None,
            state: 0,
            last_input: 0,
            time: 0,
            frame: 0,
            gain: 0,
            noise_level: 0,
            b: [0; 2],
            b_step: [0; 2],
            damp: 0,
            damp_step: 0,
            sounding: false,
            ringing: false,
        }
    }

    /// Starts the path anew; what rings rings on. `gain` from 0 to 1 multiplies b0 and b1.
    pub fn strike(&mut self, gain: f32) {
        self.start(q31(gain), i32::MAX);
    }

    /// Starts the path anew with noise of a level from 0 to 1, the filter being as the table says: inside a loop, whose gain no strike may change.
    pub fn strike_with_noise(&mut self, level: f32) {
        self.start(i32::MAX, q31(level));
    }

    fn start(&mut self, gain: i32, noise_level: i32) {
        (self.gain, self.noise_level, self.time) = (gain, noise_level, 0);
        (self.sounding, self.ringing) = (true, true);
        self.anchor();
    }

    /// Whether the path has not come to its end.
    pub fn is_sounding(&self) -> bool {
        self.sounding
    }

    /// Clears what rings; the noise stays where it is.
    pub fn rest(&mut self) {
        (self.state, self.last_input, self.sounding, self.ringing) = (0, 0, false, false);
    }

    /// Whether anything sounds or may: false means that a block costs nothing and leaves the noise where it is.
    pub fn is_ringing(&self) -> bool {
        self.ringing
    }

    /// Adds the filter's sound to `out`. `modes` are added to the noise; after the path's last breakpoint there is no noise, and
    /// a last b0 other than 0 serves the modes only.
    pub fn render(&mut self, modes: Option<&[i32]>, out: &mut [i32]) {
        let mut modes = modes.unwrap_or(&[]);
        if !self.ringing && modes.is_empty() {
            self.frame = (self.frame + out.len()) % TICK_FRAMES;
            return;
        }
        let mut out = out;
        while !out.is_empty() {
            if self.frame == 0 {
                self.anchor();
                // Less than a step of the state is left, and nothing comes: -1 is what rounding down makes of it.
                if !self.sounding && self.last_input == 0 && (-1..=1).contains(&(self.state >> 28)) {
                    (self.state, self.ringing) = (0, false);
                }
            }
            let to_breakpoint = self.next_start().map_or(usize::MAX, |start| (start - self.time) as usize);
            let frames = out.len().min(TICK_FRAMES - self.frame).min(to_breakpoint);
            let (now, later) = out.split_at_mut(frames);
            let (given, more) = modes.split_at(frames.min(modes.len()));
            (modes, out) = (more, later);
            self.frame = (self.frame + frames) % TICK_FRAMES;
            if !self.ringing && given.iter().all(|&word| word == 0) {
                continue;
            }
            self.ringing = true;
            let mut input = [0; TICK_FRAMES];
            self.fill(input.get_mut(..frames).unwrap_or(&mut []), given);
            self.run(&input, now);
            self.time = self.time.saturating_add(frames as u32);
            if frames == to_breakpoint {
                self.anchor();
            }
        }
    }

    /// Noise and modes.
    fn fill(&mut self, input: &mut [i32], modes: &[i32]) {
        if self.sounding {
            let (first, rest) = input.split_at_mut(usize::from(self.spare.is_some()).min(input.len()));
            first.iter_mut().for_each(|word| *word = self.draw());
            let (pairs, odd) = rest.as_chunks_mut::<2>();
            for pair in pairs {
                let word = self.noise.draw() as i32;
                *pair = [(word >> 16) << 12, (word << 16) >> 4];
            }
            odd.iter_mut().for_each(|word| *word = self.draw());
            if self.noise_level < i32::MAX {
                for word in input.iter_mut() {
                    *word = smmulr(*word << 1, self.noise_level);
                }
            }
        }
        for (word, &mode) in input.iter_mut().zip(modes) {
            *word = qadd(*word, mode).clamp(-MAX_INPUT, MAX_INPUT);
        }
    }

    /// Uniform in -1.0 to 1.0, 16 bits: two of a draw.
    #[inline(always)]
    fn draw(&mut self) -> i32 {
        match self.spare.take() {
            Some(spare) => spare,
            None => {
                let word = self.noise.draw();
                self.spare = Some(((word << 16) as i32) >> 4);
                (word as i32 >> 16) << 12
            }
        }
    }

    fn run(&mut self, input: &[i32], out: &mut [i32]) {
        // Of eq. 17 there is one product less; a pole below 0 costs a change of sign.
        let damp_end = self.damp.saturating_add(self.damp_step.saturating_mul(TICK_FRAMES as i64));
        let positive = self.damp <= NO_POLE && damp_end <= NO_POLE;
        match (positive, self.b[0] == self.b[1] && self.b_step[0] == self.b_step[1]) {
            (true, true) => self.sound::<true, true>(input, out),
            (true, false) => self.sound::<true, false>(input, out),
            (false, true) => self.sound::<false, true>(input, out),
            (false, false) => self.sound::<false, false>(input, out),
        }
    }

    #[inline(always)]
    fn sound<const POSITIVE: bool, const EQUAL: bool>(&mut self, input: &[i32], out: &mut [i32]) {
        let shift = 32 + self.path.scale();
        let (mut state, mut last) = (self.state, self.last_input);
        let ([mut b0, mut b1], [b0_step, b1_step]) = (self.b, self.b_step);
        let (mut damp, damp_step) = (self.damp, self.damp_step);
        for (out, &e) in out.iter_mut().zip(input) {
            // |state| < 2^60: so much of it as a word holds, by 1 + a1 as Q29.
            let high = ((state + (1 << 28)) >> 29) as i32;
            let now = (damp >> 33) as i32;
            if POSITIVE || now <= 1 << 29 {
                state -= i64::from(now) * i64::from(high);
            } else {
                // -(1 - |a1|), so that what rounding leaves of the high word weighs little here too.
                state = -(state + (i64::from(now) - (1 << 30)) * i64::from(high));
            }
            if EQUAL {
                // |e| < 2^28; b0 and b1 have a bit less than the state.
                state += i64::from((b0 >> 32) as i32) * i64::from((e + last) << 1);
            } else {
                state += i64::from((b0 >> 32) as i32) * i64::from(e << 1);
                state += i64::from((b1 >> 32) as i32) * i64::from(last << 1);
                b1 = b1.wrapping_add(b1_step);
            }
            last = e;
            *out = qadd(*out, saturate(state >> shift));
            damp = damp.wrapping_add(damp_step);
            b0 = b0.wrapping_add(b0_step);
        }
        if EQUAL {
            b1 = b0;
        }
        (self.state, self.last_input, self.b, self.damp) = (state, last, [b0, b1], damp);
    }

    /// Where the next piece starts.
    fn next_start(&self) -> Option<u32> {
        self.path.pieces().iter().map(|piece| piece.start).find(|&start| start > self.time)
    }

    /// Sets the coefficients to what the path says now, so that steps of 32 bits do not drift.
    fn anchor(&mut self) {
        self.sounding &= self.time < self.path.last_frame();
        let Some(piece) = self.path.pieces().iter().rev().find(|piece| piece.start <= self.time) else { return };
        let frames = i64::from(self.time - piece.start);
        let [b0, b1, damp] = piece.value;
        let [b0_slope, b1_slope, damp_slope] = piece.slope;
        let gain = i64::from(self.gain);
        let of_strike = |wide: i64| (((wide >> 32) * gain) << 1) + ((i64::from(wide as u32) * gain) >> 31);
        let now = |value: i64, slope: i64| value.saturating_add(slope.saturating_mul(frames));
        self.b = [of_strike(now(b0, b0_slope)), of_strike(now(b1, b1_slope))];
        self.b_step = [of_strike(b0_slope), of_strike(b1_slope)];
        self.damp = now(damp, damp_slope);
        self.damp_step = damp_slope;
    }
}

fn q31(gain: f32) -> i32 {
    (f64::from(gain.clamp(0.0, 1.0)) * f64::from(i32::MAX)) as i32
}
