//! Machine: a core, its memory, the decoded program, and the account of its cost.

mod call;
mod catch;
mod clock;
mod code;
mod execute;
mod loops;
mod profile;
mod run;

use std::sync::Arc;

use rsemu::core::space::AddressSpace;

use crate::cpu::{Core, Direct};
use crate::cycle::Cost;
use crate::cycle::flash::Accelerator;
use crate::cycle::hazard::Previous;
use crate::error::RunError;
use crate::image::{Image, Symbol};
use crate::memory::{self, FLASH_ADDRESS, FLASH_BYTES, Memory, Peripheral, RAM_ADDRESS, RAM_BYTES, ReadTrap};

pub use call::Call;
pub use clock::{Clock, CycleCase, ExceptionChange, Pace};
pub use loops::Loop;
pub use profile::FunctionCost;
pub use run::{Run, Stop};

use code::Code;
use profile::Functions;

/// Number of instructions after which [`Machine::call`] takes a call for an endless loop, unless
/// [`Machine::limit_calls`] sets another.
const DEFAULT_LIMIT_INSTRUCTIONS: u64 = 2_000_000_000;

/// Emulated Cortex-M4F with a program in its memory: flash at 0x0800_0000, RAM at 0x2000_0000, CCM
/// at 0x1000_0000.
///
/// Memory keeps what calls write to it. [`Machine::cost`] accumulates over all calls, and
/// [`Machine::profile`] and [`Machine::loops`] since [`Machine::clear_counts`].
#[derive(Debug)]
pub struct Machine {
    core: Direct,
    memory: Memory,
    space: Arc<AddressSpace>,
    image: Image,
    code: Code,
    functions: Functions,
    total: Cost,
    previous: Previous,
    accelerator: Accelerator,
    limit_instructions: u64,
    lowest_stack: u32,
    /// True if the next instruction may be in an IT block.
    in_block: bool,
    clock: Arc<Clock>,
    pace: Pace,
    /// Difference between the clock and the cost at the present pace, in cycles: sleep, and time
    /// that was spent at other paces.
    cycles_beyond_cost: i64,
    /// Time of the clock at which the counter of the DWT was 0.
    cycle_counter_origin: u64,
    /// True if a debug probe is attached that may halt the core at faults.
    has_probe: bool,
    /// True if the program itself handles its next fault.
    fault_expected: bool,
    /// Changes of exceptions since they were last taken, or `None` before that.
    exception_changes: Option<Vec<ExceptionChange>>,
}

impl Machine {
    /// Makes a machine with a program in its flash.
    ///
    /// The initialised data is already in RAM too, so that functions can be called without the
    /// start-up code. The rest of RAM is zero, and the rest of flash is erased (0xff).
    ///
    /// # Errors
    /// [`RunError::NoMemory`] if the image lies outside the board's memory.
    pub fn new(image: &Image) -> Result<Machine, RunError> {
        let (memory, space) = Memory::new()?;
        for segment in &image.segments {
            memory.write(segment.load_address, &segment.bytes)?;
            memory.write(segment.run_address, &segment.bytes)?;
        }
        let space = Arc::new(space);
        Ok(Machine {
            core: Direct::new(Arc::clone(&space), memory.clone(), FLASH_ADDRESS),
            memory,
            space,
            code: Code::new(flash_end(image)),
            functions: Functions::of(image),
            image: image.clone(),
            total: Cost::default(),
            previous: Previous::NOTHING,
            accelerator: Accelerator::default(),
            limit_instructions: DEFAULT_LIMIT_INSTRUCTIONS,
            lowest_stack: u32::MAX,
            in_block: false,
            clock: Arc::default(),
            pace: Pace::default(),
            cycles_beyond_cost: 0,
            cycle_counter_origin: 0,
            has_probe: false,
            fault_expected: false,
            exception_changes: None,
        })
    }

    /// Sets the number of instructions after which [`Machine::call`] gives up, 2 000 000 000 at
    /// first.
    pub fn limit_calls(&mut self, instructions: u64) {
        self.limit_instructions = instructions;
    }

    /// Reads memory of the program: flash, RAM or CCM.
    ///
    /// # Errors
    /// [`RunError::NoMemory`] if a byte lies outside the memory.
    pub fn read(&self, address: u32, destination: &mut [u8]) -> Result<(), RunError> {
        self.memory.read(address, destination)
    }

    /// Writes memory of the program: flash, as a programmer does, RAM or CCM.
    ///
    /// Flash beyond the image's bytes cannot be executed.
    ///
    /// # Errors
    /// [`RunError::NoMemory`] if a byte lies outside the memory.
    pub fn write(&mut self, address: u32, source: &[u8]) -> Result<(), RunError> {
        self.memory.write(address, source)?;
        if address.wrapping_sub(FLASH_ADDRESS) < FLASH_BYTES {
            self.code.flash_changed(address, source.len());
        }
        Ok(())
    }

    /// Returns the symbol with that linker name, or else with that demangled name.
    pub fn symbol(&self, name: &str) -> Option<Symbol> {
        self.image.symbol(name).cloned()
    }

    /// Adds a device to the bus, which accesses of the program to its addresses call.
    ///
    /// The device may share state with the caller.
    ///
    /// # Errors
    /// [`RunError::Mapping`] if the addresses are not free.
    pub fn map(&mut self, address: u32, bytes: u32, device: Arc<dyn Peripheral>) -> Result<(), RunError> {
        memory::map(&self.space, address, bytes, device)
    }

    /// Adds a device that takes the program's stores to flash, which are errors otherwise. Offsets
    /// count from the start of flash, and reads go to the memory.
    ///
    /// # Errors
    /// [`RunError::Mapping`] if there is such a device already.
    pub fn map_flash_stores(&mut self, device: Arc<dyn Peripheral>) -> Result<(), RunError> {
        memory::map_flash_stores(&self.space, device)
    }

    /// Lets a device take the program's reads of a part of memory, from which no instructions can
    /// run meanwhile. [`Machine::untrap_reads`] ends it.
    ///
    /// # Errors
    /// [`RunError::Mapping`] if the addresses cannot be mapped.
    pub fn trap_reads(&mut self, address: u32, bytes: u32, device: Arc<dyn Peripheral>) -> Result<ReadTrap, RunError> {
        let trap = memory::trap_reads(&self.space, address, bytes, device)?;
        self.core.set_trap(true);
        Ok(trap)
    }

    /// Gives reads that a device took back to the memory.
    pub fn untrap_reads(&mut self, trap: ReadTrap) {
        memory::untrap_reads(&self.space, &trap);
        self.core.set_trap(false);
    }

    /// Drives an external interrupt line, which is level-sensitive. Line 0 is the first after the
    /// system exceptions.
    pub fn set_interrupt(&mut self, line: u16, asserted: bool) {
        self.core.set_interrupt(line, asserted);
    }

    /// Returns the core, for its registers.
    pub fn core(&mut self) -> &mut impl Core {
        &mut self.core
    }

    /// Returns the clock of the machine, which devices may share.
    pub fn clock(&self) -> Arc<Clock> {
        Arc::clone(&self.clock)
    }

    /// Returns the cycles since the machine was made, at its pace, sleep included.
    #[inline]
    pub fn now(&self) -> u64 {
        self.pace.cycles(&self.total).wrapping_add_signed(self.cycles_beyond_cost)
    }

    /// Returns the pace of the machine's time.
    pub fn pace(&self) -> Pace {
        self.pace
    }

    /// Sets the pace of the machine's time from now on. At first it is nominal cycles without waits
    /// of flash.
    pub fn set_pace(&mut self, pace: Pace) {
        let now = self.now();
        self.pace = pace;
        self.move_to(now);
    }

    /// Lets time pass to `cycle` while the core executes nothing. A time in the past changes
    /// nothing.
    pub fn sleep_until(&mut self, cycle: u64) {
        if cycle > self.now() {
            self.move_to(cycle);
        }
    }

    fn move_to(&mut self, cycle: u64) {
        self.cycles_beyond_cost = cycle.wrapping_sub(self.pace.cycles(&self.total)).cast_signed();
        self.clock.set_now(cycle);
    }

    /// Returns the changes of exceptions since the last call. The first call starts the record.
    pub fn take_exception_changes(&mut self) -> Vec<ExceptionChange> {
        self.exception_changes.replace(Vec::new()).unwrap_or_default()
    }

    /// Lets the program handle its next fault instead of ending the run, for tests of fault
    /// handlers. An undefined instruction is such a fault too.
    pub fn expect_fault(&mut self) {
        self.fault_expected = true;
    }

    /// Returns the flash accelerator, for its switches.
    pub fn accelerator(&mut self) -> &mut Accelerator {
        &mut self.accelerator
    }

    /// Returns the cost of all that has run since the machine was made.
    pub fn cost(&self) -> Cost {
        self.total
    }

    /// Returns the cost of each function that has run since [`Machine::clear_counts`], the dearest
    /// first.
    ///
    /// The cost of a function does not include that of the functions it called.
    pub fn profile(&self) -> Vec<FunctionCost> {
        self.functions.profile(self.total)
    }

    /// Returns the loops that have run since [`Machine::clear_counts`], the one with most
    /// instructions first.
    pub fn loops(&self) -> Vec<Loop> {
        loops::found(&self.code)
    }

    /// Sets the counts of [`Machine::profile`] and [`Machine::loops`] to 0.
    pub fn clear_counts(&mut self) {
        self.functions.clear(self.total);
        self.code.clear_counts();
    }

    /// Empties the caches and the prefetch buffer of the flash accelerator.
    pub fn clear_flash_cache(&mut self) {
        self.accelerator.clear();
    }
}

/// Returns the address at which the bytes of the image in flash end.
fn flash_end(image: &Image) -> u32 {
    let in_flash = |address: &u32| address.wrapping_sub(FLASH_ADDRESS) <= FLASH_BYTES;
    let ends = image.segments.iter().map(|segment| segment.load_address.saturating_add(segment.bytes.len() as u32));
    ends.filter(in_flash).max().unwrap_or(FLASH_ADDRESS)
}

/// End of RAM, at which a stack starts unless the image says otherwise.
const RAM_END: u32 = RAM_ADDRESS + RAM_BYTES;
