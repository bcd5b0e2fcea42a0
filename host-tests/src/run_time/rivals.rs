//! Resonators of `idsp` and `biquad`, and a plain loop. PC and image compile one source.

#[path = "../../images/kernels/src/rivals/forms.rs"]
pub mod forms;

use std::time::Instant;

use dsp_core::resonator::TICK_FRAMES;

use super::words::{FIXED_PEAK, Words};
use crate::single_mode::Case;
use forms::{MIX_SHIFT, Resonator};

/// Facts of a rival that hold for both compiled copies.
#[derive(Clone, Copy, Debug)]
pub struct Rival {
    /// Name of the crate, or `plain loop`.
    pub kernel: &'static str,
    /// Type of the crate, or the recurrence.
    pub form: &'static str,
    /// Name of the kind in the image: its functions are `load_` and `render_` with this name.
    pub function: &'static str,
    /// Source of the rival's coefficients.
    pub words: Words,
    /// Converts a force to the word that the image takes. An impulse of 1.0 rings at full scale.
    pub force_word: fn(f64) -> u32,
    /// Frames by which an impulse is delayed, so that the output is `r^n sin nθ` from frame 0.
    ///
    /// It is 1 if the output contains an input at once.
    pub delay: usize,
    render: fn(&[[u32; 5]], usize, usize) -> Vec<u32>,
    to_full_scale: fn(u32) -> f64,
    time: fn(&[[u32; 5]], bool, usize) -> f64,
}

/// All rivals.
pub fn all() -> [Rival; 11] {
    use Words::{Direct30, DirectFloat, Normal31, NormalFloat, StateVariable};
    use forms::*;
    [
        Rival { delay: 1, ..rival::<PlainDirect>("plain loop", "direct form, f32", "plain_direct", DirectFloat) },
        rival::<BiquadDirect1>("biquad", "DirectForm1<f32>", "biquad_direct_1", DirectFloat),
        rival::<BiquadDirect2>("biquad", "DirectForm2Transposed<f32>", "biquad_direct_2", DirectFloat),
        rival::<IdspFloatDirect1>("idsp", "Biquad<f32>, DirectForm1", "idsp_float_direct_1", DirectFloat),
        rival::<IdspFloatDirect2>("idsp", "Biquad<f32>, DirectForm2Transposed", "idsp_float_direct_2", DirectFloat),
        rival::<IdspFloatNormal>("idsp", "Normal<f32>", "idsp_float_normal", NormalFloat),
        rival::<IdspVariable>("idsp", "Svf<f32>", "idsp_variable", StateVariable),
        rival::<IdspFixedDirect1>("idsp", "Biquad<Q32<30>>, DirectForm1", "idsp_fixed_direct_1", Direct30),
        rival::<IdspFixedDither>("idsp", "Biquad<Q32<30>>, DirectForm1Dither", "idsp_fixed_dither", Direct30),
        rival::<IdspFixedWide>("idsp", "Biquad<Q32<30>>, DirectForm1Wide", "idsp_fixed_wide", Direct30),
        rival::<IdspFixedNormal>("idsp", "Normal<Q32<31>>", "idsp_fixed_normal", Normal31),
    ]
}

fn rival<R: Resonator<Sample: Word>>(
    kernel: &'static str,
    form: &'static str,
    function: &'static str,
    words: Words,
) -> Rival {
    Rival {
        kernel,
        form,
        function,
        words,
        force_word: |force| R::Sample::from_force(force).to_word(),
        delay: 0,
        render: render::<R>,
        to_full_scale: |word| R::Sample::from_word(word).to_full_scale(),
        time: time::<R>,
    }
}

impl Rival {
    /// Sound of a case over its frames, 1.0 = full scale.
    pub fn render(&self, case: &Case) -> Vec<f64> {
        let sound = (self.render)(&[self.words.of(case)], case.frames(), self.delay);
        sound.into_iter().map(self.to_full_scale).collect()
    }

    /// Sound of `frames` frames, as the words that the image gives.
    pub fn render_words(&self, case: &Case, frames: usize) -> Vec<u32> {
        (self.render)(&[self.words.of(case)], frames, self.delay)
    }

    /// Time of a mode and sample on this PC in ns: all cases together, over a number of ticks.
    pub fn time_ns(&self, cases: &[Case], driven: bool, ticks: usize) -> f64 {
        let words: Vec<[u32; 5]> = cases.iter().map(|case| self.words.of(case)).collect();
        (self.time)(&words, driven, ticks) / (cases.len() * ticks * TICK_FRAMES) as f64
    }
}

/// Sample that can be carried as a word between host and image.
trait Word: Copy + Default {
    /// Converts a force; an impulse of 1.0 makes a mode ring at full scale.
    fn from_force(force: f64) -> Self;
    fn to_word(self) -> u32;
    fn from_word(word: u32) -> Self;
    fn to_full_scale(self) -> f64;
}

impl Word for f32 {
    fn from_force(force: f64) -> f32 {
        force as f32
    }
    fn to_word(self) -> u32 {
        self.to_bits()
    }
    fn from_word(word: u32) -> f32 {
        f32::from_bits(word)
    }
    fn to_full_scale(self) -> f64 {
        f64::from(self)
    }
}

impl Word for i32 {
    fn from_force(force: f64) -> i32 {
        (force * FIXED_PEAK).round() as i32
    }
    fn to_word(self) -> u32 {
        self.cast_unsigned()
    }
    fn from_word(word: u32) -> i32 {
        word.cast_signed()
    }
    fn to_full_scale(self) -> f64 {
        f64::from(self) / (FIXED_PEAK / f64::from(1u32 << MIX_SHIFT))
    }
}

/// Sound of modes struck in the first tick and ringing freely after it, as words.
fn render<R: Resonator<Sample: Word>>(words: &[[u32; 5]], frames: usize, delay: usize) -> Vec<u32> {
    let mut modes: Vec<R> = words.iter().map(|&words| R::new(words)).collect();
    let mut force = [R::Sample::default(); TICK_FRAMES];
    force[delay] = R::Sample::from_force(1.0);
    let mut sound = Vec::with_capacity(frames + TICK_FRAMES);
    while sound.len() < frames {
        let mut out = [R::Sample::default(); TICK_FRAMES];
        forms::render(&mut modes, sound.is_empty().then_some(&force[..]), &mut out);
        sound.extend(out.map(Word::to_word));
    }
    sound.truncate(frames);
    sound
}

fn time<R: Resonator<Sample: Word>>(words: &[[u32; 5]], driven: bool, ticks: usize) -> f64 {
    let mut modes: Vec<R> = words.iter().map(|&words| R::new(words)).collect();
    let mut force = [R::Sample::default(); TICK_FRAMES];
    force[0] = R::Sample::from_force(1.0);
    let mut out = [R::Sample::default(); TICK_FRAMES];
    forms::render(&mut modes, Some(&force), &mut out);
    let force = driven.then_some([R::Sample::default(); TICK_FRAMES]);
    let begin = Instant::now();
    for _ in 0..ticks {
        out.fill(R::Sample::default());
        forms::render(&mut modes, std::hint::black_box(force.as_ref().map(|force| &force[..])), &mut out);
        std::hint::black_box(&mut out);
    }
    begin.elapsed().as_secs_f64() * 1e9
}

#[cfg(test)]
mod tests {
    use dsp_core::SampleRate;

    use super::*;
    use crate::single_mode::snr_db;

    #[test]
    fn every_rival_rings_at_the_case_it_was_made_for() {
        for (frequency_hz, t60_s) in [(997.0, 0.2), (5_000.0, 0.05), (15_000.0, 0.2)] {
            let case = Case { frequency_hz, t60_s, rate: SampleRate::HZ_48000, level: 1.0 }.exact();
            for rival in all() {
                let snr_db = snr_db(case.reference(), rival.render(&case));
                assert!(snr_db > 55.0, "{}: {}, {frequency_hz} Hz: {snr_db} dB", rival.kernel, rival.form);
            }
        }
    }
}
