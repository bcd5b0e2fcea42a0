//! Arbitrary numbers of a range.

use dsp_core::table::range::Range;
use proptest::prelude::*;

/// Any number of a range, with all bit patterns equally likely.
///
/// Subnormal numbers and -0.0 occur, and the ends of the range occur often.
pub(crate) fn number(range: Range) -> BoxedStrategy<f32> {
    let ends = prop_oneof![Just(range.min), Just(range.max)];
    let positive = |max: f32| (0..=max.to_bits()).prop_map(f32::from_bits);
    if range.min > 0.0 {
        let inside = (range.min.to_bits()..=range.max.to_bits()).prop_map(f32::from_bits);
        prop_oneof![8 => inside, 1 => ends].boxed()
    } else if range.min == 0.0 {
        prop_oneof![8 => positive(range.max), 1 => ends, 1 => Just(-0.0)].boxed()
    } else if range.max == 0.0 {
        prop_oneof![8 => positive(-range.min).prop_map(|value| -value), 1 => ends, 1 => Just(-0.0)].boxed()
    } else {
        let negative = positive(-range.min).prop_map(|value| -value);
        // The shortest decimal of this number, read as f64, is rounded to another f32.
        let trap = Just(f32::from_bits(0x15AE_43FD)).prop_filter("in range", move |&value| range.holds(value));
        prop_oneof![4 => positive(range.max), 4 => negative, 1 => ends, 1 => Just(-0.0), 1 => trap].boxed()
    }
}
