//! Resonators of other crates and a plain loop, with a pair of functions for each kind.
//!
//! `load_...` makes resonators from words, `render_...` adds a block.

pub mod forms;

use forms::Resonator;

use crate::wire::slice;

macro_rules! rival {
    ($form:ident, $load:ident, $render:ident) => {
        /// Makes `count` resonators from five words each. Gives the bytes of one resonator.
        #[unsafe(no_mangle)]
        #[unsafe(link_section = ".text.exported")]
        pub unsafe extern "C" fn $load(resonators: *mut forms::$form, words: *const [u32; 5], count: usize) -> usize {
            // SAFETY: the host has written `count` groups of words there.
            let words = unsafe { slice(words, count) };
            for (index, &words) in words.iter().enumerate() {
                // SAFETY: the host leaves room for `count` resonators.
                unsafe { resonators.add(index).write(forms::$form::new(words)) }
            }
            size_of::<forms::$form>()
        }

        /// Adds the sound of a block to `out`. `force` may be null.
        #[unsafe(no_mangle)]
        #[unsafe(link_section = ".text.exported")]
        pub unsafe extern "C" fn $render(
            resonators: *mut forms::$form,
            count: usize,
            force: *const <forms::$form as Resonator>::Sample,
            out: *mut <forms::$form as Resonator>::Sample,
            frames: usize,
        ) {
            // SAFETY: the host has written the arguments, and the three slices do not overlap.
            let (resonators, force, out) = unsafe {
                (
                    core::slice::from_raw_parts_mut(resonators, count),
                    (!force.is_null()).then(|| slice(force, frames)),
                    core::slice::from_raw_parts_mut(out, frames),
                )
            };
            forms::render(resonators, force, out);
        }
    };
}

rival!(PlainDirect, load_plain_direct, render_plain_direct);
rival!(BiquadDirect1, load_biquad_direct_1, render_biquad_direct_1);
rival!(BiquadDirect2, load_biquad_direct_2, render_biquad_direct_2);
rival!(IdspFloatDirect1, load_idsp_float_direct_1, render_idsp_float_direct_1);
rival!(IdspFloatDirect2, load_idsp_float_direct_2, render_idsp_float_direct_2);
rival!(IdspFloatNormal, load_idsp_float_normal, render_idsp_float_normal);
rival!(IdspVariable, load_idsp_variable, render_idsp_variable);
rival!(IdspFixedDirect1, load_idsp_fixed_direct_1, render_idsp_fixed_direct_1);
rival!(IdspFixedDither, load_idsp_fixed_dither, render_idsp_fixed_dither);
rival!(IdspFixedWide, load_idsp_fixed_wide, render_idsp_fixed_wide);
rival!(IdspFixedNormal, load_idsp_fixed_normal, render_idsp_fixed_normal);
