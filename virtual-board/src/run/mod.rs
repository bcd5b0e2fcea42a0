//! Run of a board: the core until an event is due, then the devices, then the interrupt lines, and
//! so on.

mod account;
mod bus;
mod ending;
mod flash;
mod log;
mod memory;
mod report;
mod schedule;
mod usb;

use std::sync::Arc;

use virtual_core::{Clock, Core, CycleCase, Image, Machine, Pace, ReadTrap, RunError, Stop};

use crate::codec::Codec;
use crate::devices::Devices;
use crate::devices::i2s::Stream;
use crate::devices::map::{REGIONS, dma_line};
use crate::devices::pins::{PiezoPin, Pins};
use crate::devices::rcc::ResetCause;
use crate::error::BoardError;
use crate::flash::{FlashMemory, FlashTimes};
use crate::input::{Fault, PiezoSignal, Press};
use crate::usb_host::{Host, UsbHost};
use crate::wiring::Board;
use account::Account;
use bus::{FlashStores, Shared, Window};
use log::Log;
use schedule::{Action, Schedule};

pub use log::LogLine;
pub use report::{
    AdcReport, AudioReport, FlashReport, FunctionReport, InterruptReport, LedReport, MuteReport, Report, ResetReport,
    StreamReport, VolumeReport,
};

/// Most cycles between two checks for a reset that the program has requested.
const LONGEST_RUN_CYCLES: u64 = 100_000;

/// Surroundings of a board and settings of its time.
#[derive(Debug, Clone, Default)]
pub struct Setup {
    /// Column of the cycle model that the board's time follows.
    pub cycles: CycleCase,
    /// True if the waits of flash behind its accelerator are added.
    pub flash_waits: bool,
    /// Signals at the piezos.
    pub piezos: Vec<PiezoSignal>,
    /// Parts that are wired to the pins of the piezos, piezo 0 first; a circuit with a piezo where
    /// none is named.
    pub pins: Vec<PiezoPin>,
    /// Noise of each conversion of the ADC in counts, rms.
    pub adc_noise_counts: f64,
    /// Presses of the button.
    pub presses: Vec<Press>,
    /// Faults that happen.
    pub faults: Vec<Fault>,
    /// True if a debug probe is attached that halts the core at hard faults, as `probe-rs run`
    /// does.
    pub probe_catches_faults: bool,
    /// Bytes of the kit in its flash sector. If there are none the sector is as in `flash`.
    pub kit: Vec<u8>,
    /// Contents of flash besides the image and the kit, such as another run left them
    /// ([`VirtualBoard::flash`]); erased if there are none.
    pub flash: Option<FlashMemory>,
    /// Times of operations on flash.
    pub flash_times: FlashTimes,
    /// Host at the USB cable.
    pub usb: UsbHost,
}

/// Board with an image in its flash, from power-on.
///
/// ```no_run
/// use virtual_board::{Board, Setup, VirtualBoard};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let elf = std::fs::read("percussion.elf")?;
/// let mut board = VirtualBoard::new(Board::Stm32f407gDisc1, &elf, &Setup::default())?;
/// board.run_until(2.0)?;
/// for line in board.report()?.log {
///     println!("{:.3} s  {}", line.at_s, line.message);
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct VirtualBoard {
    board: Board,
    image: Image,
    machine: Machine,
    devices: Arc<Shared>,
    clock: Arc<Clock>,
    schedule: Schedule,
    log: Log,
    /// True while no debug probe fetches the log.
    probe_away: bool,
    account: Account,
    /// True while the core stands still for an operation on flash.
    waits_for_flash: bool,
    /// Sectors that the program must not read through its data cache, as bits.
    stale: u16,
    stale_traps: Vec<ReadTrap>,
    power_lost_s: Option<f64>,
    lines: u128,
    boots: usize,
    asleep: bool,
    /// True if a debug probe has halted the core at a fault.
    caught: bool,
    /// Function at which the core goes on as soon as it is awake, and its words in r0 to r3.
    jump: Option<(u32, [u32; 4])>,
    lowest_stack: u32,
}

impl VirtualBoard {
    /// Makes a board at power-on.
    ///
    /// # Errors
    /// [`BoardError`] if `elf` is not an image for the board's chip, if the setup names a piezo
    /// that the board does not have, or if the kit is longer than its sector.
    pub fn new(board: Board, elf: &[u8], setup: &Setup) -> Result<VirtualBoard, BoardError> {
        let wiring = board.wiring();
        let image = Image::from_elf(elf)?;
        memory::check(&image, wiring.chip)?;
        let mut machine = Machine::new(&image)?;
        let flash = flash::fill(&mut machine, &image, wiring.chip, setup)?;

        let last = wiring.piezos.len() - 1;
        let at_rail = setup.faults.iter().filter_map(|fault| match fault {
            Fault::PiezoAtRail { piezo, .. } => Some(*piezo),
            _ => None,
        });
        if let Some(piezo) = setup.piezos.iter().map(|signal| signal.piezo).chain(at_rail).find(|&piezo| piezo > last) {
            return Err(BoardError::NoSuchPiezo { piezo, last });
        }

        let clock = machine.clock();
        let mut devices = Devices::new(wiring, Arc::clone(&clock));
        devices.piezos.clone_from(&setup.piezos);
        let pin = |piezo: usize| setup.pins.get(piezo).copied().unwrap_or_default();
        let pins: Vec<PiezoPin> = (0..wiring.piezos.len()).map(pin).collect();
        devices.pins = Pins::new(&pins, setup.adc_noise_counts);
        devices.usb_host = Host::new(&setup.usb);
        if setup.faults.contains(&Fault::CodecSilent) {
            devices.codec = devices.codec.map(|_| Codec::new(false));
        }
        devices.insert_flash(flash, flash::ranges(&image, wiring.chip), setup.flash_times, &setup.faults);
        if setup.faults.contains(&Fault::CrystalDead) {
            devices.kill_crystal();
        }
        let devices = Arc::new(Shared::new(devices));
        for (base, bytes) in REGIONS {
            machine.map(base, bytes, Arc::new(Window { base, devices: Arc::clone(&devices) }))?;
        }
        machine.map_flash_stores(Arc::new(FlashStores(Arc::clone(&devices))))?;
        machine.set_pace(Pace { case: setup.cycles, flash_waits: setup.flash_waits });
        machine.reset()?;
        if setup.probe_catches_faults {
            machine.catch_faults();
        }
        machine.take_exception_changes();
        Ok(VirtualBoard {
            board,
            log: Log::new(elf, &machine),
            probe_away: false,
            image,
            machine,
            devices,
            clock,
            schedule: Schedule::new(&setup.presses, &setup.faults),
            account: Account::default(),
            waits_for_flash: false,
            stale: 0,
            stale_traps: Vec::new(),
            power_lost_s: None,
            lines: 0,
            boots: 0,
            asleep: false,
            caught: false,
            jump: None,
            lowest_stack: u32::MAX,
        })
    }

    /// Runs the board until `seconds` seconds after power-on, or until it loses its power.
    ///
    /// # Errors
    /// [`BoardError`] if the program does what the chip or its manual does not allow, or what the
    /// virtual board does not model.
    pub fn run_until(&mut self, seconds: f64) -> Result<(), BoardError> {
        loop {
            let Some(due) = self.look_after_devices(seconds)? else {
                self.account.settle(self.machine.now());
                return Ok(());
            };
            if self.waits_for_flash {
                self.machine.sleep_until(due);
                continue;
            }
            if self.caught || self.asleep {
                self.sleep_until(due);
                continue;
            }
            self.clock.set_due(due);
            match self.machine.resume_until_due() {
                Ok(Stop::Due | Stop::Limit) => self.asleep = false,
                Ok(Stop::Asleep) => {
                    self.asleep = true;
                    self.note_exceptions();
                    self.sleep_until(due);
                }
                Ok(Stop::Caught) => {
                    self.caught = true;
                    self.devices.lock().halted(u64::MAX / 2);
                }
                Ok(Stop::Breakpoint(number)) => return Err(BoardError::Breakpoint { number, time_s: self.now_s() }),
                Err(error) => return Err(self.explain(error)),
            }
            self.note_exceptions();
        }
    }

    /// Lets all events happen that are due.
    ///
    /// Returns the cycle of the next event, `None` at the end.
    fn look_after_devices(&mut self, end_s: f64) -> Result<Option<u64>, BoardError> {
        let shared = Arc::clone(&self.devices);
        let mut devices = shared.lock();
        let now = self.machine.now();
        if let Err((device, problem)) = devices.advance(now, &mut self.machine) {
            return Err(BoardError::Device { device, problem, time_s: devices.seconds(now) });
        }
        let mut stalled = None;
        while devices.cycle_at(self.schedule.next_s()) <= now {
            let Some(action) = self.schedule.take() else { break };
            if let Action::Stall { for_s, by_debugger } = action {
                let until = devices.cycle_at(devices.seconds(now) + for_s);
                if by_debugger {
                    devices.halted(until - now);
                }
                stalled = Some(until);
            } else {
                self.act(action, &mut devices, now)?;
            }
        }
        if !self.asleep && !self.probe_away {
            self.log.fetch(devices.seconds(now), self.boots, &mut self.machine);
        }
        if !self.asleep
            && let Some((address, arguments)) = self.jump.take()
        {
            let core = self.machine.core();
            for (register, word) in (0..).zip(arguments) {
                core.set_register(register, word);
            }
            core.set_register(14, core.pc() | 1);
            core.set_pc(address);
        }
        let watchdog = devices.watchdog_due() <= now;
        if watchdog || self.machine.core().is_reset_requested() {
            self.reset(if watchdog { ResetCause::Watchdog } else { ResetCause::Software }, &mut devices)?;
        }
        if devices.is_power_lost {
            self.power_lost_s.get_or_insert(devices.seconds(now));
            return Ok(None);
        }
        self.look_after_flash(&devices, now)?;
        if self.account.audio_number.is_none() {
            let stream = devices.audio_stream();
            self.account.audio_number = stream.map(|(controller, stream)| dma_line(controller, stream) + 16);
        }
        self.drive_lines(devices.lines(), now);
        if let Some(until) = stalled {
            // The core stands still. The next call lets the devices catch up.
            self.machine.sleep_until(until);
            return Ok(Some(until));
        }
        let end = devices.cycle_at(end_s);
        if now >= end {
            return Ok(None);
        }
        let next = [devices.next_event(), devices.watchdog_due(), devices.cycle_at(self.schedule.next_s())];
        let due = next.into_iter().fold(end.min(now + LONGEST_RUN_CYCLES), u64::min);
        Ok(Some(due.max(now + 1)))
    }

    /// Drives the core's interrupt lines. If one changes, a core that sleeps looks whether to wake.
    fn drive_lines(&mut self, lines: u128, now: u64) {
        let mut changed = lines ^ self.lines;
        self.asleep &= changed == 0;
        self.lines = lines;
        while changed != 0 {
            let line = changed.trailing_zeros() as u16;
            changed &= changed - 1;
            let asserted = lines >> line & 1 != 0;
            self.machine.set_interrupt(line, asserted);
            if asserted {
                self.account.asserted(line, now);
            }
        }
    }

    fn act(&mut self, action: Action, devices: &mut Devices, now: u64) -> Result<(), BoardError> {
        match action {
            Action::Button(pressed) => {
                devices.set_button(pressed);
                devices.pins_changed(now);
            }
            Action::AdcOverrun => devices.armed.adc_overrun = true,
            Action::AudioDmaError => devices.armed.audio_dma_error = true,
            Action::AdcDmaError => devices.armed.adc_dma_error = true,
            Action::AudioInterrupt { lost } => devices.armed.audio_interrupt_lost = lost,
            Action::PiezoAtRail(piezo) => devices.armed.piezos_at_rail |= 1 << piezo,
            Action::Stall { .. } => {}
            Action::PowerLost { seed } => {
                devices.break_flash_operation(seed, &mut self.machine);
                devices.is_power_lost = true;
            }
            Action::Probe { away } => self.probe_away = away,
            Action::StackUsedUp { left_bytes } => ending::use_up_stack(&mut self.machine, left_bytes)?,
            Action::Panic => self.jump = Some(ending::panic(&mut self.machine, &self.image)?),
            Action::HardFault => {
                self.jump = Some(ending::hard_fault(&self.machine, &self.image)?);
                self.machine.expect_fault();
            }
        }
        Ok(())
    }

    fn reset(&mut self, cause: ResetCause, devices: &mut Devices) -> Result<(), BoardError> {
        let now = self.machine.now();
        self.account.reset(now);
        self.lowest_stack = self.lowest_stack.min(self.machine.lowest_stack());
        devices.break_flash_operation(self.boots as u64, &mut self.machine);
        devices.reset(cause, now);
        self.machine.reset()?;
        self.log.restart();
        self.lines = 0;
        self.boots += 1;
        (self.asleep, self.caught) = (false, false);
        Ok(())
    }

    fn sleep_until(&mut self, due: u64) {
        let now = self.machine.now();
        self.machine.sleep_until(due);
        self.account.slept(now, due.max(now));
    }

    fn note_exceptions(&mut self) {
        for change in self.machine.take_exception_changes() {
            self.account.changed(change);
        }
    }

    fn explain(&self, error: RunError) -> BoardError {
        let mut devices = self.devices.lock();
        let time_s = devices.seconds(self.machine.now());
        match (error, devices.refused.take()) {
            (RunError::Address { pc, function, .. }, Some(refused)) => BoardError::Register {
                access: refused.access,
                register: refused.register,
                address: refused.address,
                problem: refused.problem,
                pc,
                function,
                time_s,
            },
            (error, _) => BoardError::Run(error),
        }
    }

    /// Returns the seconds since power-on.
    pub fn now_s(&self) -> f64 {
        self.devices.lock().seconds(self.machine.now())
    }

    /// Returns the core and memory of the board, for inspection.
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// Returns the sound that has left the I2S, one stream for each time without interruption.
    pub fn streams(&self) -> Vec<Stream> {
        self.devices.lock().audio().streams.clone()
    }
}
