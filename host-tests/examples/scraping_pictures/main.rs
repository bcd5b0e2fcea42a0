//! Draws the picture of docs/scraping.md.
//!
//! Run it by `cargo run --release -p host-tests --example scraping_pictures`.

mod panels;
mod path;

use std::error::Error;
use std::path::Path;

use host_tests::scrape::Scrapes;
use malleus::plot::{CurvesPicture, curves};

fn main() -> Result<(), Box<dyn Error>> {
    let scrapes = Scrapes::new();
    let [cycles, errors] = panels::over_speed(&scrapes)?;
    let mut panels = vec![panels::paths(&scrapes), panels::normal_force()?];
    panels.extend([0.05, 0.2, 0.5, 2.0].map(|speed| panels::spectrum(&scrapes, speed)));
    panels.extend([errors, cycles]);
    let picture = CurvesPicture {
        title: "Scraping a mug".to_owned(),
        remark: "A stick over measured ceramic: its path, its normal force, third octaves of its force by four methods, error and cycles"
            .to_owned(),
        panels,
    };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/images/scraping.png");
    curves(&path, &picture)?;
    println!("{}", path.display());
    Ok(())
}
