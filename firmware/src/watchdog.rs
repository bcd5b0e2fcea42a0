//! The independent watchdog: a board whose sound has stopped starts again.

use embassy_stm32::pac::IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};

/// LSI, 32 kHz (17 to 47 on silicon), over 32.
const COUNTS_PER_S: u32 = 1000;
/// The board starts again after so long without being fed, s (0.17 to 0.47 on silicon).
const TIMEOUT_S: f32 = 0.25;
/// The same while a kit is loaded, whose tables may take seconds (5.6 to 15 s on silicon): as long as the counter goes with twice the division.
const LOADING_S: f32 = 8.19;

/// Starts it, for the time of loading a kit. It cannot be stopped.
pub fn start() {
    IWDG.kr().write(|w| w.set_key(Key::START));
    set(Pr::DIVIDE_BY64, LOADING_S / 2.0);
}

/// From now on the sound is due: it may not stop for longer than [`TIMEOUT_S`].
pub fn expect_sound() {
    set(Pr::DIVIDE_BY32, TIMEOUT_S);
}

/// `timeout_s` is what it would be with the division by 32.
fn set(division: Pr, timeout_s: f32) {
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(division));
    IWDG.rlr().write(|w| w.set_rl((COUNTS_PER_S as f32 * timeout_s) as u16));
    feed();
}

/// As long again.
pub fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
