//! Functions as the compiler makes them: loops, recursion, division, formatting, floats.

use core::fmt::Write;

/// Sum of products of two arrays of `count` words at `a` and `b`.
#[unsafe(no_mangle)]
extern "C" fn dot(a: *const i32, b: *const i32, count: u32) -> i64 {
    // SAFETY: the tests pass addresses of RAM that hold so many words.
    let (a, b) =
        unsafe { (core::slice::from_raw_parts(a, count as usize), core::slice::from_raw_parts(b, count as usize)) };
    a.iter().zip(b).map(|(&x, &y)| i64::from(x) * i64::from(y)).sum()
}

/// Sorts `count` words, then gives the one in the middle.
#[unsafe(no_mangle)]
extern "C" fn median(values: *mut u32, count: u32) -> u32 {
    // SAFETY: as for `dot`.
    let values = unsafe { core::slice::from_raw_parts_mut(values, count as usize) };
    values.sort_unstable();
    values[values.len() / 2]
}

/// Writes a float as text into `text` and gives its length.
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
    // SAFETY: as for `dot`.
    let mut text = Text(unsafe { core::slice::from_raw_parts_mut(text, length as usize) }, 0);
    let _ = write!(text, "{:e}", f32::from_bits(bits));
    text.1 as u32
}

/// A recursion that needs stack: the Ackermann function.
#[unsafe(no_mangle)]
extern "C" fn ackermann(m: u32, n: u32) -> u32 {
    match (m, n) {
        (0, n) => n + 1,
        (m, 0) => ackermann(m - 1, 1),
        (m, n) => ackermann(m - 1, ackermann(m, n - 1)),
    }
}

/// A float polynomial and its root: compiled FPU code.
#[unsafe(no_mangle)]
extern "C" fn polynomial(x: f32, y: f32) -> f32 {
    let mut sum = 1.0;
    for k in 1..8 {
        sum = sum * x + y / k as f32;
    }
    if sum > 0.0 { sum } else { -sum * 0.5 }
}

/// Six arguments, of which two come on the stack.
#[unsafe(no_mangle)]
extern "C" fn six(a: u32, b: u32, c: u32, d: u32, e: u32, f: u32) -> u32 {
    a ^ b.rotate_left(1) ^ c.rotate_left(2) ^ d.rotate_left(3) ^ e.rotate_left(4) ^ f.rotate_left(5)
}

/// A jump table.
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

/// What a table of function pointers holds, whatever the signature.
#[repr(transparent)]
struct Kept(*const ());

// SAFETY: an address of code, never written.
unsafe impl Sync for Kept {}

/// Keeps what the tests call by name.
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
