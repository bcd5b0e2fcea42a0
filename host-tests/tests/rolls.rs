//! Rolls on every stage at once. The hour itself: `cargo bench -p host-tests --bench hour`.

use host_tests::rolls::roll;

#[test]
fn a_roll_stays_bounded_falls_silent_and_does_not_depend_on_the_block() {
    let rolled = roll(12.0, 128, |_| {});
    println!("{rolled:?}");
    assert!(rolled.strikes > 400, "{} strikes", rolled.strikes);
    assert!(rolled.peak > 0.05 && rolled.peak < 15.9, "peak {}", rolled.peak);
    let silent_after_s = rolled.silent_after_s.expect("silence within a minute");
    assert!(silent_after_s < 45.0, "{silent_after_s} s");
    let as_ticks = roll(4.0, 32, |_| {});
    for block in [1, 77, 4096] {
        assert_eq!(roll(4.0, block, |_| {}).hash, as_ticks.hash, "blocks of {block}");
    }
}
