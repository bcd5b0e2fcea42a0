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
        let start = Instant::now();
        let cost = machine.call("mac_loop", &[PASSES, 3])?.cost;
        let per_second = cost.instructions as f64 / start.elapsed().as_secs_f64();
        println!("mac_loop: {:.1} million instructions per second", per_second / 1e6);
    }
    Ok(())
}
