//! Tests of clock tree, wait states, enable bits and watchdog.

use super::{Bench, FLASH, RCC, TIM3};
use crate::error::Problem;
use crate::frequency::Frequency;
use crate::wiring::Board;

const MS: u64 = 16_000;

/// Starts HSE and PLL for 168 MHz on the F407: M 8, N 336, P 2, APB1 /4, APB2 /2.
fn start_pll(bench: &mut Bench) {
    bench.write(RCC, 1 | 1 << 16);
    bench.pass(3 * MS);
    bench.write(RCC + 4, 8 | 336 << 6 | 1 << 22 | 7 << 24);
    bench.write(RCC, 1 | 1 << 16 | 1 << 24);
    bench.pass(MS);
    assert_eq!(bench.read(RCC) & (1 << 17 | 1 << 25), 1 << 17 | 1 << 25, "ready");
}

const CFGR_168: u32 = 2 | 5 << 10 | 4 << 13;

#[test]
fn a_peripheral_whose_clock_is_off_refuses_and_names_its_bit() {
    let mut bench = Bench::after_reset(Board::Stm32f407gDisc1);
    let refused = bench.try_write(TIM3 + 0x28, 1).unwrap_err();
    assert_eq!(refused, Problem::ClockOff { enable: "RCC_APB1ENR bit 1".to_owned() });
    bench.write(RCC + 0x40, 1 << 1);
    bench.write(TIM3 + 0x28, 1);
    bench.write(RCC + 0x20, 1 << 1);
    assert!(matches!(bench.try_write(TIM3 + 0x28, 1), Err(Problem::InReset { .. })));
    bench.write(RCC + 0x20, 0);
    assert_eq!(bench.read(TIM3 + 0x28), 0, "the reset cleared it");
}

#[test]
fn unmodelled_peripherals_and_unknown_registers_give_different_errors() {
    let mut bench = Bench::new(Board::Stm32f407gDisc1);
    assert!(matches!(bench.try_write(0x4000_4404, 1), Err(Problem::Unmodelled { .. })), "USART2");
    assert_eq!(bench.try_write(TIM3 + 0x3f0, 1), Err(Problem::Register));
    assert_eq!(bench.try_write(0x4003_0000, 1), Err(Problem::Register));
}

#[test]
fn the_core_may_not_outrun_the_wait_states_of_flash() {
    let mut bench = Bench::after_reset(Board::Stm32f407gDisc1);
    start_pll(&mut bench);
    bench.write(FLASH, 4);
    let refused = bench.try_write(RCC + 8, CFGR_168).unwrap_err();
    assert!(refused.to_string().contains("needs 5 wait states") && refused.to_string().contains("is 4"), "{refused}");
    bench.write(FLASH, 5);
    bench.write(RCC + 8, CFGR_168);
    let clocks = bench.devices.clocks;
    assert_eq!(clocks.core, Frequency::hz(168_000_000));
    assert_eq!((clocks.apb1, clocks.apb1_timers), (Frequency::hz(42_000_000), Frequency::hz(84_000_000)));
    assert!(bench.try_write(FLASH, 3).is_err(), "nor may the wait states be taken away");
}

#[test]
fn a_bus_may_not_be_too_fast_nor_a_clock_be_selected_before_it_runs() {
    let mut bench = Bench::after_reset(Board::Stm32f407gDisc1);
    assert!(bench.try_write(RCC + 8, 2).unwrap_err().to_string().contains("not running"));
    bench.write(RCC + 8, 0);
    start_pll(&mut bench);
    bench.write(FLASH, 5);
    let refused = bench.try_write(RCC + 8, 2 | 4 << 10 | 4 << 13).unwrap_err();
    assert!(refused.to_string().contains("PCLK1 is 84000000 Hz"), "{refused}");
    assert!(bench.try_write(RCC + 4, 8 | 300 << 6).is_err(), "PLLCFGR while the PLL is on");
}

#[test]
fn a_pll_outside_its_range_is_refused() {
    for pllcfgr in [2 | 100 << 6 | 1 << 22, 8 | 433 << 6 | 1 << 22, 8 | 60 << 6 | 1 << 22] {
        let mut bench = Bench::after_reset(Board::Stm32f407gDisc1);
        bench.write(RCC, 1 | 1 << 16);
        bench.pass(3 * MS);
        bench.write(RCC + 4, pllcfgr);
        bench.write(RCC, 1 | 1 << 16 | 1 << 24);
        bench.pass(MS);
        bench.write(FLASH, 5);
        assert!(matches!(bench.try_write(RCC + 8, CFGR_168), Err(Problem::ClockTree { .. })), "{pllcfgr:#x}");
    }
}

#[test]
fn caches_are_reset_only_while_they_are_off() {
    let mut bench = Bench::after_reset(Board::Stm32f407gDisc1);
    bench.write(FLASH, 3 << 9);
    assert!(bench.try_write(FLASH, 3 << 9 | 3 << 11).is_err());
    bench.write(FLASH, 0);
    bench.write(FLASH, 3 << 11);
}

#[test]
fn the_watchdog_is_due_at_the_end_of_its_count() {
    let mut bench = Bench::new(Board::Stm32f407gDisc1);
    const IWDG: u32 = 0x4000_3000;
    assert!(bench.try_write(IWDG + 8, 99).is_err(), "locked");
    bench.write(IWDG, 0x5555);
    bench.write(IWDG + 4, 1);
    bench.write(IWDG + 8, 399);
    assert_eq!(bench.devices.watchdog_due(), u64::MAX);
    bench.write(IWDG, 0xcccc);
    // 400 counts of 8 periods of 32 kHz last 100 ms.
    assert_eq!(bench.devices.watchdog_due(), 100 * MS);
    bench.pass(60 * MS);
    bench.write(IWDG, 0xaaaa);
    assert_eq!(bench.devices.watchdog_due(), 160 * MS);
}
