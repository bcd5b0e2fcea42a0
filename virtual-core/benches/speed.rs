//! Speed of the machine with cycles charged, in instructions per second: `cargo bench -p
//! virtual-core --bench speed`.

use std::path::Path;
use std::time::Instant;

use virtual_core::{Image, Machine};

const MANIFEST: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program/Cargo.toml");
const PASSES: u32 = 4_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let elf = virtual_core::build(Path::new(MANIFEST))?;
    let mut machine = Machine::new(&Image::from_elf(&elf)?)?;
    for _ in 0..3 {
        for (function, argument) in [("mac_loop", 3), ("float_loop", 0.5_f32.to_bits())] {
            let start = Instant::now();
            let cost = machine.call(function, &[PASSES, argument])?.cost;
            let per_second = cost.instructions as f64 / start.elapsed().as_secs_f64();
            println!("{function}: {:.1} million instructions per second", per_second / 1e6);
        }
    }
    Ok(())
}
