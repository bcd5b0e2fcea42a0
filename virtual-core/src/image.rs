//! ELF file as the board sees it: bytes in flash, bytes in RAM, and the names of functions.

use object::read::elf::{ElfFile32, FileHeader, ProgramHeader};
use object::{Endianness, Object, ObjectSymbol, SymbolKind, SymbolSection};

use crate::error::ImageError;
use crate::memory::{self, FLASH_ADDRESS, FLASH_BYTES};

/// Segment of memory that the ELF file loads.
#[derive(Debug, Clone)]
pub(crate) struct Segment {
    /// Address at which the bytes are stored, in flash for initialised data.
    pub(crate) load_address: u32,
    /// Address at which the program finds the bytes when it runs.
    pub(crate) run_address: u32,
    /// Stored bytes.
    pub(crate) bytes: Vec<u8>,
    /// Length in memory, in bytes. Memory beyond the stored bytes is zeroed (.bss).
    pub(crate) memory_bytes: u32,
}

/// Named address of an image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symbol {
    /// Demangled name without the hash, such as `dsp_core::resonator::free`.
    pub name: String,
    /// Name that the linker uses.
    pub linker_name: String,
    /// Address, without the Thumb bit.
    pub address: u32,
    /// Length in bytes. Code whose source gives no length (assembly) reaches to the next function.
    pub bytes: u32,
    /// True if the symbol is code.
    pub is_function: bool,
}

/// Linked program for the target thumbv7em-none-eabihf, which a [`crate::Machine`] can run.
#[derive(Debug, Clone)]
pub struct Image {
    pub(crate) segments: Vec<Segment>,
    symbols: Vec<Symbol>,
    entry: u32,
}

impl Image {
    /// Reads an ELF file as a linker wrote it.
    ///
    /// # Errors
    /// [`ImageError`] if the file is no ELF file, incomplete or for another processor, if it lies
    /// outside the board's memory, or has nothing to load.
    pub fn from_elf(bytes: &[u8]) -> Result<Image, ImageError> {
        if bytes.get(4) == Some(&object::elf::ELFCLASS64) {
            return Err(ImageError::WrongProcessor { found: "a 64-bit processor".to_owned() });
        }
        let file = ElfFile32::<Endianness>::parse(bytes)?;
        let header = file.elf_header();
        let endian = header.endian()?;
        if header.e_machine(endian) != object::elf::EM_ARM || endian != Endianness::Little {
            let found = format!("ELF machine {} ({endian:?}-endian)", header.e_machine(endian));
            return Err(ImageError::WrongProcessor { found });
        }

        let mut segments = Vec::new();
        for segment in header.program_headers(endian, bytes)? {
            if segment.p_type(endian) != object::elf::PT_LOAD || segment.p_memsz(endian) == 0 {
                continue;
            }
            let (load_address, run_address) = (segment.p_paddr(endian), segment.p_vaddr(endian));
            let (stored_bytes, memory_bytes) = (segment.p_filesz(endian), segment.p_memsz(endian));
            let truncated = |()| ImageError::Truncated { address: load_address, bytes: stored_bytes };
            let bytes = segment.data(endian, bytes).map_err(truncated)?.to_vec();
            for (address, bytes) in [(load_address, stored_bytes), (run_address, memory_bytes)] {
                if bytes != 0 && !memory::contains(address, bytes) {
                    return Err(ImageError::OutsideMemory { address, bytes });
                }
            }
            segments.push(Segment { load_address, run_address, bytes, memory_bytes });
        }
        if segments.iter().all(|segment| segment.bytes.is_empty()) {
            return Err(ImageError::Empty);
        }

        Ok(Image { segments, symbols: symbols(&file), entry: header.e_entry(endian) & !1 })
    }

    /// Returns the symbols of code and data in the order of their addresses.
    pub fn symbols(&self) -> &[Symbol] {
        &self.symbols
    }

    /// Returns the symbol with that linker name, or else with that demangled name.
    pub fn symbol(&self, name: &str) -> Option<&Symbol> {
        let by = |matches: &dyn Fn(&&Symbol) -> bool| self.symbols.iter().find(matches);
        by(&|symbol| symbol.linker_name == name).or_else(|| by(&|symbol| symbol.name == name))
    }

    /// Returns the entry point that the ELF header names, without the Thumb bit.
    pub fn entry(&self) -> u32 {
        self.entry
    }

    /// Returns the ranges of memory that the image uses, as address and length in bytes.
    ///
    /// Each segment has two: that of its stored bytes, and that of its memory when it runs.
    pub fn ranges(&self) -> impl Iterator<Item = (u32, u32)> {
        let segments = self.segments.iter();
        segments.flat_map(|segment| {
            [(segment.load_address, segment.bytes.len() as u32), (segment.run_address, segment.memory_bytes)]
        })
    }

    /// Returns the number of bytes that are written to flash: vector table, code, constants and the
    /// initial values of `.data`.
    pub fn flash_bytes(&self) -> u32 {
        self.segments.iter().map(|segment| segment.bytes.len() as u32).sum()
    }

    /// Returns the number of bytes of RAM in use before the first call: `.data`, `.bss` and
    /// functions in RAM, without the stack.
    pub fn static_ram_bytes(&self) -> u32 {
        let in_ram = |segment: &&Segment| segment.run_address.wrapping_sub(FLASH_ADDRESS) >= FLASH_BYTES;
        self.segments.iter().filter(in_ram).map(|segment| segment.memory_bytes).sum()
    }
}

fn symbols(file: &ElfFile32<'_, Endianness>) -> Vec<Symbol> {
    let mut found: Vec<Symbol> = file
        .symbols()
        .filter(|symbol| matches!(symbol.kind(), SymbolKind::Text | SymbolKind::Data | SymbolKind::Unknown))
        .filter_map(|symbol| {
            let linker_name = symbol.name().ok().filter(|name| !name.is_empty() && !name.starts_with('$'))?;
            // Absolute symbols are those of the memory map, such as the end of the stack.
            if symbol.section_index().is_none() && symbol.section() != SymbolSection::Absolute {
                return None;
            }
            let is_function = symbol.kind() == SymbolKind::Text;
            let address = symbol.address() as u32;
            Some(Symbol {
                name: format!("{:#}", rustc_demangle::demangle(linker_name)),
                linker_name: linker_name.to_owned(),
                address: if is_function { address & !1 } else { address },
                bytes: symbol.size() as u32,
                is_function,
            })
        })
        .collect();
    found.sort_by(|a, b| (a.address, !a.is_function, &a.linker_name).cmp(&(b.address, !b.is_function, &b.linker_name)));
    // Assembly without `.size` gives no length: a function lasts until the next one starts.
    let starts: Vec<u32> = found.iter().filter(|symbol| symbol.is_function).map(|symbol| symbol.address).collect();
    for symbol in found.iter_mut().filter(|symbol| symbol.is_function && symbol.bytes == 0) {
        let next = starts.partition_point(|&start| start <= symbol.address);
        symbol.bytes = starts.get(next).map_or(0, |&start| start - symbol.address);
    }
    found
}
