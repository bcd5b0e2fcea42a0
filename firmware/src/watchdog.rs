//! Independent watchdog, which restarts a board whose sound has stopped.

use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_stm32::pac::{DBGMCU, IWDG};

/// Counts of the watchdog per second with the division by 32: its clock LSI has 32 kHz, on silicon
/// 17 to 47 kHz.
const COUNTS_PER_S: u32 = 1000;
/// Time without feeding after which the board restarts, in seconds (0.17 to 0.47 s on silicon).
const TIMEOUT_S: f32 = 0.25;
/// Time without feeding after which the board restarts while a kit is loaded, in seconds (5.6 to
/// 15 s on silicon).
///
/// Deriving a kit's tables may take seconds. This is the longest time with the division by 64.
const LOADING_S: f32 = 8.19;

/// Starts the watchdog with the time limit for loading a kit. It cannot be stopped, but it waits
/// while a debugger halts the core.
pub fn start() {
    DBGMCU.apb1fzr().modify(|w| w.set_iwdg(true));
    IWDG.kr().write(|w| w.set_key(Key::START));
    expect_loading();
}

/// Raises the time limit to that of loading a kit, for a board that is silent meanwhile.
pub fn expect_loading() {
    set(Pr::DIVIDE_BY64, LOADING_S / 2.0);
}

/// Lowers the time limit to [`TIMEOUT_S`], for a board that plays.
pub fn expect_sound() {
    set(Pr::DIVIDE_BY32, TIMEOUT_S);
}

/// Sets the division, and the number of counts that last `timeout_s` with the division by 32.
fn set(division: Pr, timeout_s: f32) {
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(division));
    IWDG.rlr().write(|w| w.set_rl((COUNTS_PER_S as f32 * timeout_s) as u16));
    feed();
}

/// Starts the time limit anew.
pub fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
