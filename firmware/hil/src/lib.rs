//! Hardware in the loop: `cargo test --features hil` flashes the self-test image onto a real board
//! and reads its verdict.
