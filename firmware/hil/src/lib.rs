#![doc = "Hardware in the loop: `cargo test --features hil` flashes the self-test image and reads its verdict from a real board."]
