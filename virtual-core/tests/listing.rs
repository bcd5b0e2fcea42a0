//! Decoder against a disassembler: every line of llvm-objdump's listing of the test program is read
//! as text and compared field by field.

mod assembly;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use virtual_core::decode::{Kind, decode};

use assembly::Line;

/// Returns the path of llvm-objdump in the toolchain's component llvm-tools.
fn objdump() -> PathBuf {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let print = |what: &[&str]| {
        let output = Command::new(&rustc).args(what).output().expect("rustc runs");
        String::from_utf8(output.stdout).expect("rustc prints text")
    };
    let version = print(&["-vV"]);
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).expect("rustc names its host");
    let sysroot = print(&["--print", "sysroot"]);
    let folder = PathBuf::from(sysroot.trim()).join("lib/rustlib").join(host).join("bin");
    folder.join(format!("llvm-objdump{}", std::env::consts::EXE_SUFFIX))
}

fn listing() -> String {
    let file = tempfile::NamedTempFile::new().unwrap();
    let program = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program/Cargo.toml");
    std::fs::write(file.path(), virtual_core::build(Path::new(program)).unwrap()).unwrap();
    let output = Command::new(objdump()).arg("-d").arg(file.path()).output();
    let output = output.expect("llvm-objdump runs (rustup component add llvm-tools)");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn every_instruction_is_decoded_as_the_disassembler_lists_it() {
    let listing = listing();
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let mut block = 0;
    for line in listing.lines().skip_while(|line| !line.contains("<op_")).filter_map(Line::parse) {
        let found = decode(line.address, line.halves[0], line.halves[1]);
        let expected = line.expected(block != 0);
        assert_eq!(found, expected, "{}", line.text);
        block = if found.kind == Kind::IfThen { line.mnemonic.len() - 1 } else { block.saturating_sub(1) };
        *seen.entry(format!("{:?}", found.kind)).or_default() += 1;
    }
    let total: usize = seen.values().sum();
    assert!(total > 10_000, "only {total} instructions");
    // The program has every kind; signed and unsigned division count as two.
    assert_eq!(seen.len(), 27, "{:?}", seen.keys());
}
