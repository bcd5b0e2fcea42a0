//! Compiled functions: loops, recursion, division, formatting, floats.

use core::fmt::Write;

/// Returns the sum of products of two arrays of `count` words at `a` and `b`.
#[unsafe(no_mangle)]
extern "C" fn dot(a: *const i32, b: *const i32, count: u32) -> i64 {
    // SAFETY: the tests pass addresses of `count` words in RAM.
    let (a, b) =
        unsafe { (core::slice::from_raw_parts(a, count as usize), core::slice::from_raw_parts(b, count as usize)) };
    a.iter().zip(b).map(|(&x, &y)| i64::from(x) * i64::from(y)).sum()
}

/// Sorts `count` words and returns the one in the middle.
#[unsafe(no_mangle)]
extern "C" fn median(values: *mut u32, count: u32) -> u32 {
    // SAFETY: the tests pass an address of this many items in RAM.
    let values = unsafe { core::slice::from_raw_parts_mut(values, count as usize) };
    values.sort_unstable();
    values[values.len() / 2]
}

/// Writes a float as text into `text` and returns the length of the text.
#[unsafe(no_mangle)]
extern "C" fn format(bits: u32, text: *mut u8, length: u32) -> u32 {
    struct Text<'a>(&'a mut [u8], usize);
    impl Write for Text<'_> {
        fn write_str(&mut self, s: &str) -> core::fmt::Result {
            let end = self.1 + s.len();
            self.0.get_mut(self.1..end).ok_or(core::fmt::Error)?.copy_from_slice(s.as_bytes());
            self.1 = end;
            Ok(())
        }
    }
    // SAFETY: the tests pass an address of this many items in RAM.
    let mut text = Text(unsafe { core::slice::from_raw_parts_mut(text, length as usize) }, 0);
    let _ = write!(text, "{:e}", f32::from_bits(bits));
    text.1 as u32
}

/// Computes the Ackermann function, a recursion that needs stack.
#[unsafe(no_mangle)]
extern "C" fn ackermann(m: u32, n: u32) -> u32 {
    match (m, n) {
        (0, n) => n + 1,
        (m, 0) => ackermann(m - 1, 1),
        (m, n) => ackermann(m - 1, ackermann(m, n - 1)),
    }
}

/// Computes a float polynomial by FPU code.
#[unsafe(no_mangle)]
extern "C" fn polynomial(x: f32, y: f32) -> f32 {
    let mut sum = 1.0;
    for k in 1..8 {
        sum = sum * x + y / k as f32;
    }
    if sum > 0.0 { sum } else { -sum * 0.5 }
}

/// Mixes six arguments, of which two come on the stack.
#[unsafe(no_mangle)]
extern "C" fn six(a: u32, b: u32, c: u32, d: u32, e: u32, f: u32) -> u32 {
    a ^ b.rotate_left(1) ^ c.rotate_left(2) ^ d.rotate_left(3) ^ e.rotate_left(4) ^ f.rotate_left(5)
}

/// Computes one of eight functions, by a jump table.
#[unsafe(no_mangle)]
extern "C" fn choose(which: u32, a: u32, b: u32) -> u32 {
    match which {
        0 => a.wrapping_add(b),
        1 => a.wrapping_sub(b),
        2 => a.wrapping_mul(b),
        3 => a.checked_div(b).unwrap_or(0),
        4 => a & b,
        5 => a | b,
        6 => a.count_ones(),
        _ => a ^ b,
    }
}

/// Pointer to a function of any signature.
#[repr(transparent)]
struct Kept(*const ());

// SAFETY: the pointer is an address of code, which is never written.
unsafe impl Sync for Kept {}

/// Functions that the tests call by name, so that the linker keeps them.
#[used]
#[unsafe(link_section = ".vectors")]
static KEPT: [Kept; 7] = [
    Kept(dot as *const ()),
    Kept(median as *const ()),
    Kept(format as *const ()),
    Kept(ackermann as *const ()),
    Kept(polynomial as *const ()),
    Kept(six as *const ()),
    Kept(choose as *const ()),
];
