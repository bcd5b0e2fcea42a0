//! Rolls on every stage at once. `cargo bench -p host-tests --bench hour` plays the whole hour.

use host_tests::rolls::roll;
use host_tests::sweeps::{self, Extent};

#[test]
fn a_roll_stays_bounded_falls_silent_and_does_not_depend_on_the_block() {
    sweeps::rolls::hour(Extent::Tenth);
    let as_ticks = roll(4.0, 32, |_| {});
    for block in [1, 77, 4096] {
        assert_eq!(roll(4.0, block, |_| {}).hash, as_ticks.hash, "blocks of {block}");
    }
}
