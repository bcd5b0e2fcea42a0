//! Scraping and rolling on a bare Cortex-M4F, without a board.
//!
//! Nothing starts by itself: the virtual core writes a kit into the flash and calls the exported
//! functions. The code on the host is `host-tests/src/scrape/on_chip.rs`.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;
use core::panic::PanicInfo;

use dsp_core::SampleRate;
use dsp_core::scrape::{Contact, Motion, Scraper};
use dsp_core::table::Kit;
use dsp_core::time::TICK_FRAMES;

/// Contact that `scrape_new` begins, as the host writes it.
#[repr(C)]
pub struct Request {
    kit: *const u8,
    kit_bytes: usize,
    pad: usize,
    striker: usize,
    rolls: u32,
    least_n: f32,
    most_n: f32,
}

struct State(UnsafeCell<Option<Scraper<'static>>>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl Sync for State {}

static STATE: State = State(UnsafeCell::new(None));

fn state() -> &'static mut Option<Scraper<'static>> {
    // SAFETY: see `Sync` for `State`: this is the running call's only reference.
    unsafe { &mut *STATE.0.get() }
}

/// Begins a contact. -1: the kit is refused, -2: it has no such contact.
///
/// # Safety
/// The request lies at the address, and the kit of the request stays where it is.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn scrape_new(request: *const Request) -> i32 {
    // SAFETY: the caller's promise.
    let request = unsafe { &*request };
    // SAFETY: the caller's promise.
    let bytes = unsafe { core::slice::from_raw_parts(request.kit, request.kit_bytes) };
    let Ok(kit) = Kit::parse(bytes) else { return -1 };
    let normal_n = [request.least_n, request.most_n];
    let Some(contact) = Contact::of(&kit, request.pad, request.striker, request.rolls != 0, normal_n) else {
        return -2;
    };
    *state() = Some(Scraper::new(contact, SampleRate::HZ_48000));
    0
}

/// Goes on over a tick of 32 frames. -1: nothing was begun, -2: the motion is refused.
///
/// # Safety
/// There is room for 32 words at the address.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn scrape_render(
    x_bits: u32,
    y_bits: u32,
    normal_bits: u32,
    force: *mut [i32; TICK_FRAMES],
) -> i32 {
    let velocity_m_per_s = [f32::from_bits(x_bits), f32::from_bits(y_bits)];
    let motion = Motion { velocity_m_per_s, normal_n: f32::from_bits(normal_bits) };
    // SAFETY: the caller's promise.
    let force = unsafe { &mut *force };
    match state() {
        None => -1,
        Some(scraper) => scraper.render(motion, force).map_or(-2, |()| 0),
    }
}

/// Bytes of a contact's state.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn scrape_bytes() -> u32 {
    size_of::<Scraper<'static>>() as u32
}

/// The virtual core never starts here; a linker needs an entry.
#[unsafe(no_mangle)]
pub extern "C" fn _start() -> ! {
    loop {}
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // An undefined instruction: the virtual core stops and names the function.
    // SAFETY: never returns.
    unsafe { core::arch::asm!("udf #0", options(noreturn)) }
}
