//! Tests of the USB core: its registers are strict, and its host gets the answers of the manual.

use super::{Bench, RCC};
use crate::devices::rcc::ClockTree;
use crate::devices::usb::{Answer, Usb};
use crate::devices::{Context, RESET_CLOCKS};
use crate::error::Problem;
use crate::frequency::Frequency;
use crate::wiring::Board;

const OTG: u32 = 0x5000_0000;
const PWRDWN: u32 = 1 << 16;
const NOVBUSSENS: u32 = 1 << 21;

/// USB core with a clock of 48 MHz, apart from a board.
struct Core {
    usb: Usb,
    now_s: f64,
}

impl Core {
    /// Makes a core with FIFOs, whose endpoint 1 is active in both directions.
    fn ready() -> Core {
        let mut core = Core { usb: Usb::default(), now_s: 0.0 };
        let bulk = 64 | 1 << 15 | 2 << 18 | 1 << 28;
        for (offset, value) in [
            (0x38, PWRDWN | NOVBUSSENS),
            (0x0c, 0x4000_1840),
            (0x24, 64),
            (0x28, 16 << 16 | 64),
            (0x104, 16 << 16 | 80),
            (0x920, bulk | 1 << 22 | 1 << 27),
            (0xb30, 1 << 19 | 64),
            (0xb20, bulk | 1 << 26 | 1 << 31),
        ] {
            core.write(offset, value).unwrap();
        }
        core
    }

    fn with<T>(&mut self, act: impl FnOnce(&mut Usb, &Context<'_>) -> T) -> T {
        let clocks = ClockTree { usb: Some(Frequency::hz(48_000_000)), ..RESET_CLOCKS };
        act(&mut self.usb, &Context { now: 0, seconds: self.now_s, clocks: &clocks })
    }

    fn write(&mut self, offset: u32, value: u32) -> Result<(), Problem> {
        self.with(|usb, context| usb.write(offset, value, context))
    }

    fn read(&mut self, offset: u32) -> u32 {
        self.with(|usb, context| usb.read(offset, context)).unwrap()
    }

    fn output(&mut self, odd: bool, data: &[u8]) -> Answer {
        self.with(|usb, context| usb.output(0, 1, odd, data, context)).unwrap()
    }

    fn input(&mut self) -> Answer {
        self.with(|usb, context| usb.input(0, 1, context)).unwrap()
    }
}

#[test]
fn usb_core_needs_its_bus_clock_and_48_mhz() {
    let mut bench = Bench::new(Board::Stm32f407gDisc1);
    let refused = bench.try_write(OTG + 0x38, PWRDWN).unwrap_err();
    assert_eq!(refused, Problem::ClockOff { enable: "RCC_AHB2ENR bit 7".to_owned() });
    bench.write(RCC + 0x34, 1 << 7);
    let refused = bench.try_write(OTG + 0x38, PWRDWN).unwrap_err().to_string();
    assert!(refused.contains("the USB clock is off") && refused.contains("48 MHz"), "{refused}");
    assert_eq!(bench.read(OTG + 0x3c), 0x1200);
    assert_eq!(bench.try_write(OTG + 0x400, 0), Err(Problem::Register), "a register of host mode");
}

#[test]
fn usb_out_packet_waits_in_the_fifo_and_the_next_is_refused_until_nak_is_cleared() {
    let mut core = Core::ready();
    assert_eq!(core.output(false, &[1, 2, 3, 4, 5]), Answer::Ack);
    assert_eq!(core.output(true, &[6]), Answer::Nak);
    assert_ne!(core.read(0x14) & 1 << 4, 0, "RXFLVL");
    assert_eq!(core.read(0x20), 1 | 5 << 4 | 2 << 17);
    assert!(core.with(|usb, context| usb.read(0x20, context)).is_err(), "the data is unread");
    assert_eq!((core.read(0x1000), core.read(0x1000)), (0x0403_0201, 5));
    assert!(core.with(|usb, context| usb.read(0x1000, context)).is_err(), "there is no more data");
    assert_eq!(core.read(0x20), 1 | 3 << 17, "the transfer is complete");
    assert_eq!((core.read(0x14) & 1 << 4, core.read(0xb28) & 1), (0, 1));
    assert!(core.with(|usb, context| usb.read(0x20, context)).is_err(), "the FIFO is empty");
    core.write(0xb30, 1 << 19 | 64).unwrap();
    let control = core.read(0xb20);
    core.write(0xb20, control | 1 << 26).unwrap();
    assert_eq!(core.output(false, &[1, 2, 3, 4, 5]), Answer::Ack, "a repeated packet is dropped");
    assert_eq!(core.read(0x14) & 1 << 4, 0);
    assert_eq!(core.output(true, &[]), Answer::Ack);
    assert_eq!(core.read(0x20), 1 | 2 << 15 | 2 << 17, "a packet without data is told, too");
}

#[test]
fn usb_in_packet_is_sent_once_it_is_whole_and_ends_with_its_acknowledgement() {
    let mut core = Core::ready();
    assert_eq!(core.input(), Answer::Nak);
    assert!(core.write(0x2000, 1).is_err(), "the endpoint is not enabled");
    let control = core.read(0x920) | 1 << 26 | 1 << 31;
    assert!(core.write(0x920, control).is_err(), "no size");
    core.write(0x930, 1 << 19 | 6).unwrap();
    core.write(0x920, control).unwrap();
    assert!(core.write(0x930, 1 << 19 | 6).is_err(), "the endpoint is enabled");
    core.write(0x2000, 0x0403_0201).unwrap();
    assert_eq!((core.input(), core.read(0x938)), (Answer::Nak, 15));
    core.write(0x2000, 0x0605).unwrap();
    assert_eq!(core.input(), Answer::Data(vec![1, 2, 3, 4, 5, 6], false));
    assert_eq!(core.read(0x928) & 1, 0, "not acknowledged");
    core.usb.acknowledge(1, 6);
    assert_eq!((core.read(0x928) & 1, core.read(0x920) >> 31, core.read(0x938)), (1, 0, 16));
    assert_eq!(core.input(), Answer::Nak);
}

#[test]
fn usb_core_is_suspended_after_3_ms_and_woken_by_the_next_frame() {
    let mut core = Core::ready();
    core.usb.start_frame(1, 0.010);
    core.usb.look_for_suspend(0.0129);
    assert_eq!(core.read(0x14) & 1 << 11, 0);
    core.usb.look_for_suspend(0.01301);
    assert_eq!((core.read(0x14) & 1 << 11, core.read(0x808) & 1), (1 << 11, 1));
    core.write(0x14, 1 << 11).unwrap();
    core.usb.start_frame(2, 0.020);
    assert_eq!((core.read(0x14) & 1 << 31, core.read(0x808)), (1 << 31, 2 << 8 | 3 << 1));
}

#[test]
fn usb_fifos_that_overlap_or_are_too_large_are_refused() {
    let mut core = Core::ready();
    assert!(core.write(0x24, 8).is_err(), "a receive FIFO of 8 words");
    assert!(core.write(0x28, 16 << 16 | 40).is_err(), "within the receive FIFO");
    assert!(core.write(0x104, 300 << 16 | 80).is_err(), "beyond the memory");
    core.write(0x104, 16 << 16 | 72).unwrap();
    core.write(0x930, 1 << 19).unwrap();
    let control = core.read(0x920) | 1 << 31;
    let refused = core.write(0x920, control).unwrap_err().to_string();
    assert!(refused.contains("endpoints 1 and 0 overlap"), "{refused}");
}
