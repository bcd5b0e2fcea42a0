//! The independent watchdog: a board whose sound has stopped starts again.

use embassy_stm32::pac::IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};

/// LSI, 32 kHz (17 to 47 on silicon), over 32.
const COUNTS_PER_S: u32 = 1000;
/// The board starts again after so long without being fed, s (0.17 to 0.47 on silicon).
const TIMEOUT_S: f32 = 0.25;

/// Starts it. It cannot be stopped.
pub fn start() {
    IWDG.kr().write(|w| w.set_key(Key::START));
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY32));
    IWDG.rlr().write(|w| w.set_rl((COUNTS_PER_S as f32 * TIMEOUT_S) as u16));
    feed();
}

/// Another quarter of a second.
pub fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
