//! Button: its interrupt notes the time of the first contact, and its level is read once a half.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_stm32::exti::ExtiInput;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::mode::Blocking;
use embassy_stm32::{interrupt, pac};

use crate::cycles;

/// Priority of the button's interrupt, above that of the sound: its handler takes less than a
/// microsecond, and would note the end of a half's rendering instead of the contact.
const PRIORITY: Priority = Priority::P0;
/// EXTI line of the button's pin, which is pin 0 on every board.
const LINE: usize = 0;

/// Button on EXTI line 0.
pub struct Button {
    /// Pin of the button, of which the edge of a press interrupts.
    pub pin: ExtiInput<'static, Blocking>,
    /// True if the pin is high while the button is pressed.
    pub pressed_is_high: bool,
}

/// True if a first contact has been noted and not been taken.
static TOUCHED: AtomicBool = AtomicBool::new(false);
/// Time of the noted contact, in core cycles.
static TOUCHED_AT: AtomicU32 = AtomicU32::new(0);

/// True while the button is pressed, as the sound's interrupt has seen it last.
static DOWN: AtomicBool = AtomicBool::new(false);

#[interrupt]
fn EXTI0() {
    pac::EXTI.pr(0).write(|w| w.set_line(LINE, true));
    // The contacts bounce, and the first one counts: a noted time is not overwritten.
    if !TOUCHED.load(Ordering::Acquire) {
        TOUCHED_AT.store(cycles::now(), Ordering::Relaxed);
        TOUCHED.store(true, Ordering::Release);
    }
}

impl Button {
    /// Enables the button's interrupt.
    pub fn listen(&self) {
        interrupt::EXTI0.set_priority(PRIORITY);
        // SAFETY: the handler shares nothing but two atomics.
        unsafe { interrupt::EXTI0.enable() };
    }

    /// Takes the noted contact if it closed before the time `now`, and returns its time. Times are
    /// in core cycles.
    pub fn touched_before(&self, now: u32) -> Option<u32> {
        let at = TOUCHED_AT.load(Ordering::Relaxed);
        if !self.is_touched() || now.wrapping_sub(at).cast_signed() < 0 {
            return None;
        }
        TOUCHED.store(false, Ordering::Release);
        Some(at)
    }

    /// Returns true if a contact has been noted and not been taken.
    pub fn is_touched(&self) -> bool {
        TOUCHED.load(Ordering::Acquire)
    }

    /// Returns true if the contacts are closed now. They may bounce.
    pub fn is_pressed(&self) -> bool {
        let is_pressed = self.pin.is_high() == self.pressed_is_high;
        DOWN.store(is_pressed, Ordering::Relaxed);
        is_pressed
    }
}

/// Returns true if the button was pressed when the sound's interrupt looked last.
pub fn is_down() -> bool {
    DOWN.load(Ordering::Relaxed)
}
