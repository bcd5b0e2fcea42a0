//! Code to which a core is sent that is to panic or to fault, and the end of its stack.

use virtual_core::{Core, FLASH_ADDRESS, FLASH_BYTES, Image, Machine, RunError};

/// Address of a function, and its words in r0 to r3.
pub(super) type Jump = (u32, [u32; 4]);

const PANIC: &str = "core::panicking::panic";
const STACK_END: &str = "_stack_end";
const MESSAGE: &[u8; 8] = b"injected";
const FILE: &[u8; 16] = b"virtual-board.rs";

/// Returns the start of a panic. Its message and place are written to the flash behind the image's
/// last byte, as if the image held them.
pub(super) fn panic(machine: &mut Machine, image: &Image) -> Result<Jump, RunError> {
    let symbol = machine.symbol(PANIC).filter(|symbol| symbol.is_function);
    let function = symbol.ok_or_else(|| RunError::NoFunction { name: PANIC.to_owned() })?.address;
    let is_in_flash = |end: &u32| end.wrapping_sub(FLASH_ADDRESS) < FLASH_BYTES;
    let ends = image.ranges().map(|(address, bytes)| address + bytes).filter(is_in_flash);
    let message = ends.max().unwrap_or(FLASH_ADDRESS).next_multiple_of(16);
    let file = message + MESSAGE.len() as u32;
    let location = file + FILE.len() as u32;
    machine.write(message, MESSAGE)?;
    machine.write(file, FILE)?;
    let words = [file, FILE.len() as u32, 1, 1];
    machine.write(location, &words.map(u32::to_le_bytes).concat())?;
    Ok((function, [message, MESSAGE.len() as u32, location, 0]))
}

/// Moves the stack pointer to `left_bytes` bytes above the end of the stack, to which cortex-m-rt
/// and the memory map give a name.
pub(super) fn use_up_stack(machine: &mut Machine, left_bytes: u32) -> Result<(), RunError> {
    let symbol = machine.symbol(STACK_END).ok_or_else(|| RunError::NoFunction { name: STACK_END.to_owned() })?;
    machine.core().set_register(13, symbol.address + left_bytes);
    machine.expect_fault();
    Ok(())
}

/// Returns the address of an undefined instruction of the image. Compilers put `udf` after calls
/// that never return.
pub(super) fn hard_fault(machine: &Machine, image: &Image) -> Result<Jump, RunError> {
    let mut bytes = vec![0; image.flash_bytes() as usize];
    machine.read(FLASH_ADDRESS, &mut bytes)?;
    let undefined = bytes.chunks_exact(2).position(|pair| pair[1] == 0xde && pair[0] == 0xfe);
    let undefined = undefined.or_else(|| bytes.chunks_exact(2).position(|pair| pair[1] == 0xde));
    let index = undefined.ok_or_else(|| RunError::NoFunction { name: "with a udf".to_owned() })?;
    Ok((FLASH_ADDRESS + 2 * index as u32, [0; 4]))
}
