//! Plans of one length beside those of others.

use fourier::forward;

/// Bits of the spectrum of a fixed signal.
fn bits(length: usize) -> Vec<[u64; 2]> {
    let mut input: Vec<f64> = (0..length).map(|n| ((n * n) as f64 * 0.37).sin()).collect();
    let transform = forward(length);
    let mut output = transform.make_output_vec();
    transform.process(&mut input, &mut output).expect("the lengths are right");
    output.iter().map(|bin| [bin.re.to_bits(), bin.im.to_bits()]).collect()
}

/// Pairs of lengths, the second of which a kept planner builds out of the first where the
/// processor has AVX. The last bits of the second spectrum then differ.
const PAIRS: [[usize; 2]; 6] =
    [[432, 1_728], [576, 2_304], [1_512, 9_072], [2_304, 4_608], [18_432, 3_111], [18_432, 8_957]];

#[test]
fn spectra_do_not_depend_on_the_lengths_planned_before() {
    for [before, length] in PAIRS {
        let alone = std::thread::spawn(move || bits(length)).join().expect("it ends");
        let after = std::thread::spawn(move || {
            drop(forward(before));
            bits(length)
        });
        assert!(alone == after.join().expect("it ends"), "{before} before {length}");
    }
}
