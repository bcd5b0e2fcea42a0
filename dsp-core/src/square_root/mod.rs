//! Square roots with the same bits on every machine.

#[cfg(cortex_m4f)]
mod cortex_m4;

#[cfg(cortex_m4f)]
pub(crate) use cortex_m4::rounded_root;

/// Square root, rounded to the nearest `f32`: the bits of the Cortex-M4F's instruction.
#[cfg(not(cortex_m4f))]
pub(crate) fn rounded_root(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// Square root of a number from 1e-37 to 1e37, with a relative error below 5e-6; 0 for 0 and below.
/// About 15 cycles on a Cortex-M4.
///
/// Two steps of Newton's method for `1/sqrt(x)` follow the well-known first guess from the bits.
#[inline(always)]
pub(crate) fn square_root(x: f32) -> f32 {
    let half = 0.5 * x;
    let guess = f32::from_bits(0x5f37_59df_u32.wrapping_sub(x.to_bits() >> 1));
    let better = guess * (1.5 - half * guess * guess);
    let best = better * (1.5 - half * better * better);
    if x > 0.0 { x * best } else { 0.0 }
}

/// Square root of a number from 1e-30 to 1, within two roundings: a factor that is applied sample
/// after sample must not add up errors.
#[inline(always)] // noise takes 18 of them in a tick
pub(crate) fn exact_root(x: f32) -> f32 {
    let root = square_root(x);
    0.5 * (root + x / root)
}

/// Length `sqrt(x² + y²)` of a vector whose squares are in the range of `f64`, within three
/// roundings.
pub(crate) fn length(x: f64, y: f64) -> f64 {
    libm::sqrt(x * x + y * y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_within_5e_6_of_themselves() {
        let worst = (0..400_000)
            .map(|step| 10f32.powf(-37.0 + 74.0 * step as f32 / 400_000.0))
            .map(|x| (f64::from(square_root(x)) / f64::from(x).sqrt() - 1.0).abs())
            .fold(0.0, f64::max);
        assert!(worst < 5e-6, "{worst:e}");
        assert_eq!(square_root(0.0), 0.0);
        let worst = (1..100_000u32)
            .map(|step| f64::from(step) as f32 / 1e5)
            .map(|x| (f64::from(exact_root(x)) / f64::from(x).sqrt() - 1.0).abs())
            .fold(0.0, f64::max);
        assert!(worst < 1.3e-7, "{worst:e}");
    }
}
