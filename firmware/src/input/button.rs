//! The button: its interrupt notes when the first contact was made, its level is read once a half.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_stm32::exti::ExtiInput;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::mode::Blocking;
use embassy_stm32::{interrupt, pac};

use crate::cycles;

/// Above the sound: it only reads a clock.
const PRIORITY: Priority = Priority::P1;
/// The line of pin 0, on every board.
const LINE: usize = 0;

/// A button on EXTI line 0.
pub struct Button {
    /// Its pin; the edge of a press interrupts.
    pub pin: ExtiInput<'static, Blocking>,
    /// Whether the pin is high while the button is pressed.
    pub pressed_is_high: bool,
}

static TOUCHED: AtomicBool = AtomicBool::new(false);
static TOUCHED_AT: AtomicU32 = AtomicU32::new(0);

#[interrupt]
fn EXTI0() {
    pac::EXTI.pr(0).write(|w| w.set_line(LINE, true));
    // While one is kept the time stands still: it is the first contact that counts.
    if !TOUCHED.load(Ordering::Acquire) {
        TOUCHED_AT.store(cycles::now(), Ordering::Relaxed);
        TOUCHED.store(true, Ordering::Release);
    }
}

impl Button {
    /// Lets its interrupt come.
    pub fn listen(&self) {
        interrupt::EXTI0.set_priority(PRIORITY);
        // SAFETY: the handler uses nothing but the two atomics.
        unsafe { interrupt::EXTI0.enable() };
    }

    /// When the button was first touched since the last call, in core cycles.
    pub fn touched(&self) -> Option<u32> {
        if !TOUCHED.load(Ordering::Acquire) {
            return None;
        }
        let at = TOUCHED_AT.load(Ordering::Relaxed);
        TOUCHED.store(false, Ordering::Release);
        Some(at)
    }

    /// Whether it is pressed now; contacts may bounce.
    pub fn is_pressed(&self) -> bool {
        self.pin.is_high() == self.pressed_is_high
    }
}
