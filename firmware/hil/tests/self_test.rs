//! Run of the self-test image on a real STM32F407G-DISC1: `cargo test --features hil`, with the
//! board on a probe.
#![cfg(feature = "hil")]

use std::error::Error;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use defmt_decoder::{DecodeError, Table};
use object::read::elf::{ElfFile32, ProgramHeader};
use probe_rs::flashing::DownloadOptions;
use probe_rs::rtt::Rtt;
use probe_rs::{Session, SessionConfig};

/// Name of the board's chip in probe-rs.
const CHIP: &str = "STM32F407VGTx";
/// Time after which a board without a verdict has failed. The test takes a few seconds.
const PATIENCE: Duration = Duration::from_secs(20);

#[test]
fn the_self_test_passes_on_a_real_disc1() -> Result<(), Box<dyn Error>> {
    let elf = build()?;
    let mut session = Session::auto_attach(CHIP, SessionConfig::default())?;
    flash(&mut session, &elf)?;
    let lines = listen(&mut session, &elf)?;
    assert!(lines.last().is_some_and(|line| line == "self-test: passed"), "{}", lines.join("\n"));
    Ok(())
}

/// Builds the self-test image and returns its ELF file.
fn build() -> Result<Vec<u8>, Box<dyn Error>> {
    let firmware = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let target = firmware.join("target");
    let status = Command::new(env!("CARGO"))
        .args(["build", "--release", "--locked", "--bin", "self-test", "--target-dir"])
        .arg(&target)
        .current_dir(&firmware)
        .status()?;
    assert!(status.success(), "the self-test image does not build");
    Ok(std::fs::read(target.join("thumbv7em-none-eabihf/release/self-test"))?)
}

/// Writes the segments of an ELF file to the flash of the board.
fn flash(session: &mut Session, elf: &[u8]) -> Result<(), Box<dyn Error>> {
    let mut loader = session.target().flash_loader();
    let file = ElfFile32::<object::Endianness>::parse(elf)?;
    let endian = file.endian();
    for segment in file.elf_program_headers() {
        let data = segment.data(endian, elf).map_err(|()| "a segment lies outside the file")?;
        if !data.is_empty() {
            loader.add_data(u64::from(segment.p_paddr(endian)), data)?;
        }
    }
    loader.commit(session, DownloadOptions::default())?;
    Ok(())
}

/// Resets the board and returns the lines of its log up to the verdict.
fn listen(session: &mut Session, elf: &[u8]) -> Result<Vec<String>, Box<dyn Error>> {
    let table = Table::parse(elf)?.ok_or("the image has no defmt section")?;
    let mut decoder = table.new_stream_decoder();
    let mut core = session.core(0)?;
    core.reset()?;
    let begun = Instant::now();
    let mut rtt = loop {
        match Rtt::attach(&mut core) {
            Ok(rtt) => break rtt,
            Err(error) if begun.elapsed() > PATIENCE => return Err(error.into()),
            // The program has not set RTT up yet.
            Err(_) => std::thread::sleep(Duration::from_millis(10)),
        }
    };
    let channel = rtt.up_channel(0).ok_or("the image has no log channel")?;
    let mut lines = Vec::new();
    let mut bytes = [0; 1024];
    while begun.elapsed() < PATIENCE {
        let count = channel.read(&mut core, &mut bytes)?;
        decoder.received(&bytes[..count]);
        loop {
            match decoder.decode() {
                Ok(frame) => lines.push(frame.display_message().to_string()),
                Err(DecodeError::UnexpectedEof) => break,
                // The decoder goes on at the next frame.
                Err(DecodeError::Malformed) => {}
            }
        }
        if lines.last().is_some_and(|line| line.starts_with("self-test: ")) {
            break;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    Ok(lines)
}
