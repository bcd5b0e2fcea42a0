//! The kernels in plain Rust: the definition of the bits.

use super::super::network::Work;
use crate::fixed;

/// `work = gain · line / 2^16`, rounded down (SMULWB).
#[cfg(not(cortex_m4f))]
pub(in crate::room) fn take(line: &[i16], gain: i32, work: &mut [i32]) {
    for (value, &sample) in work.iter_mut().zip(line) {
        *value = ((i64::from(gain) * i64::from(sample)) >> 16) as i32;
    }
}

/// `line = work / 2^12`, rounded down, which the caller knows to fit; gives the bits of the largest size.
#[cfg(not(cortex_m4f))]
pub(in crate::room) fn put(work: &[i32], line: &mut [i16]) -> u32 {
    let mut sizes = 0;
    for (sample, &value) in line.iter_mut().zip(work) {
        *sample = (value >> 12) as i16;
        sizes |= (*sample ^ (*sample >> 15)) as u32;
    }
    32 - sizes.leading_zeros()
}

/// Mixes the lines' samples from `start` on, as many as `sound` has, and adds the input: `sound` holds the input of each frame in its first element,
/// and afterwards the two outputs. `half_step` is what storing will cut off.
pub(in crate::room) fn mix(
    work: &mut Work,
    start: usize,
    sound: &mut [[i32; 2]],
    [sine, cosine]: [i32; 2],
    half_step: i32,
) {
    let [w0, w1, w2, w3, w4, w5, w6, w7] = work;
    let (low, high) =
        (w0.iter_mut().zip(w1).zip(w2.iter_mut().zip(w3)), w4.iter_mut().zip(w5).zip(w6.iter_mut().zip(w7)));
    for ((((l0, l1), (l2, l3)), ((l4, l5), (l6, l7))), sound) in low.zip(high).skip(start).zip(sound) {
        let x = sound[0];
        // First stage: two rotations, two butterflies. What storing cuts off is added here and so reaches every line.
        let a0 = fixed::smmlar(fixed::smmulr(sine, *l1), cosine, *l0) + half_step;
        let a1 = fixed::smmlsr(fixed::smmulr(cosine, *l1), sine, *l0) + half_step;
        let a2 = fixed::smmlar(fixed::smmulr(sine, *l3), cosine, *l2);
        let a3 = fixed::smmlsr(fixed::smmulr(cosine, *l3), sine, *l2);
        let (a4, a5, a6, a7) = (*l4 + *l5, *l4 - *l5, *l6 + *l7, *l6 - *l7);
        let (b0, b2, b1, b3) = (a0 + a2, a0 - a2, a1 + a3, a1 - a3);
        let (b4, b6, b5, b7) = (a4 + a6, a4 - a6, a5 + a7, a5 - a7);
        let (c0, c4, c1, c5) = (b0 + b4, b0 - b4, b1 + b5, b1 - b5);
        let (c2, c6, c3, c7) = (b2 + b6, b2 - b6, b3 + b7, b3 - b7);
        // Outputs go round by three lines: a symmetric mix would come back to itself in step.
        (*l3, *l4, *l5, *l6) = (c0 + x, c1 - x, c2 + x, c3 + x);
        (*l7, *l0, *l1, *l2) = (c4 - x, c5 + x, c6 - x, c7 + x);
        *sound = [c0 - half_step, c3 - half_step];
    }
}
