//! Scripts of accesses, and boards that carry them out (`program`).

use std::path::Path;

use virtual_board::{Board, BoardError, FlashMemory, Setup, VirtualBoard};

/// Address of the script.
const SCRIPT: u32 = 0x0802_0000;
/// Address of the number of words that were read, which follow it.
const READ: u32 = 0x2000_8000;

pub(crate) const RCC: u32 = 0x4002_3800;
pub(crate) const ACR: u32 = 0x4002_3c00;
pub(crate) const KEYR: u32 = ACR + 0x04;
pub(crate) const SR: u32 = ACR + 0x0c;
pub(crate) const CR: u32 = ACR + 0x10;

/// Line of a script.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Line {
    /// Writes a word.
    Write(u32, u32),
    /// Writes a half-word.
    Write16(u32, u16),
    /// Writes a byte.
    Write8(u32, u8),
    /// Reads a word for [`read`].
    Read(u32),
    /// Waits until a bit of a word is set.
    Until(u32, u32),
    /// Writes a word by an instruction in RAM.
    WriteFromRam(u32, u32),
}

use Line::{Read, Write};

/// Lines that open FLASH_CR.
pub(crate) const UNLOCK: [Line; 2] = [Write(KEYR, 0x4567_0123), Write(KEYR, 0xcdef_89ab)];

/// Lines that erase a sector by words.
pub(crate) fn erase(sector: u32) -> [Line; 2] {
    [Write(CR, 2 << 8 | 2 | sector << 3), Write(CR, 1 << 16 | 2 << 8 | 2 | sector << 3)]
}

/// Lines that program a word.
pub(crate) fn program(address: u32, value: u32) -> [Line; 2] {
    [Write(CR, 2 << 8 | 1), Write(address, value)]
}

/// Returns a flash with a script.
pub(crate) fn flash(board: Board, lines: &[Line]) -> FlashMemory {
    let mut flash = FlashMemory::erased(board.wiring().chip);
    insert(&mut flash, lines);
    flash
}

/// Writes a script into a flash.
pub(crate) fn insert(flash: &mut FlashMemory, lines: &[Line]) {
    let words = |line: &Line| match *line {
        Line::Write(address, value) => [1, address, value],
        Line::Write16(address, value) => [2, address, value.into()],
        Line::Write8(address, value) => [3, address, value.into()],
        Line::Read(address) => [4, address, 0],
        Line::Until(address, bit) => [5, address, bit],
        Line::WriteFromRam(address, value) => [6, address, value],
    };
    let script: Vec<u32> = lines.iter().flat_map(words).chain([0; 3]).collect();
    let bytes: Vec<u8> = script.into_iter().flat_map(u32::to_le_bytes).collect();
    flash.write(SCRIPT, &bytes).unwrap();
}

/// Makes a board with the program in its flash.
pub(crate) fn board(board: Board, setup: &Setup) -> Result<VirtualBoard, BoardError> {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/flash/program/Cargo.toml");
    VirtualBoard::new(board, &virtual_core::build(Path::new(manifest)).unwrap(), setup)
}

/// Runs a script for `seconds` seconds, on a board that is otherwise set up by `setup`.
pub(crate) fn run(lines: &[Line], setup: &Setup, seconds: f64) -> Result<VirtualBoard, BoardError> {
    let flash = Some(flash(Board::Stm32f407gDisc1, lines));
    let mut running = board(Board::Stm32f407gDisc1, &Setup { flash, ..setup.clone() })?;
    running.run_until(seconds)?;
    Ok(running)
}

/// Returns the words that the script has read.
pub(crate) fn read(running: &VirtualBoard) -> Vec<u32> {
    let word = |address: u32| {
        let mut bytes = [0; 4];
        running.machine().read(address, &mut bytes).unwrap();
        u32::from_le_bytes(bytes)
    };
    (1..=word(READ)).map(|index| word(READ + 4 * index)).collect()
}

/// Lines that start the cycle counter.
pub(crate) const START_CYCLES: [Line; 2] = [Write(0xe000_edfc, 1 << 24), Write(0xe000_1000, 1)];
/// Line that reads the cycle counter.
pub(crate) const CYCLES: Line = Read(0xe000_1004);
