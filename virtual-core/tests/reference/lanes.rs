//! Arithmetic on the bytes and halves of a word.

/// Sign with which lanes are read.
#[derive(Clone, Copy)]
pub(crate) enum Sign {
    Signed,
    Unsigned,
}

/// Part of a lane's result that is kept.
#[derive(Clone, Copy)]
pub(crate) enum Keep {
    Wrap,
    Saturate,
    Halve,
}

/// Returns `a + factor * b` in a lane of `width` bits.
fn lane(sign: Sign, keep: Keep, width: u32, a: u32, b: u32, factor: i32) -> u32 {
    let top = 1_i32 << width;
    let read = |value: u32| match sign {
        Sign::Signed if value.cast_signed() >= top / 2 => value.cast_signed() - top,
        _ => value.cast_signed(),
    };
    let (least, most) = match sign {
        Sign::Signed => (-top / 2, top / 2 - 1),
        Sign::Unsigned => (0, top - 1),
    };
    let result = read(a) + factor * read(b);
    let kept = match keep {
        Keep::Wrap => result,
        Keep::Saturate => result.clamp(least, most),
        Keep::Halve => result >> 1,
    };
    kept.rem_euclid(top).cast_unsigned()
}

pub(crate) fn bytes(sign: Sign, keep: Keep, a: u32, b: u32, factor: i32) -> u32 {
    each_byte(a, b, |a, b| lane(sign, keep, 8, a, b, factor))
}

/// Returns `a + factor * b` in both halves; the factors are those of the low and the high half.
pub(crate) fn halves(sign: Sign, keep: Keep, a: u32, b: u32, factors: [i32; 2]) -> u32 {
    let half = |shift: u32, factor| lane(sign, keep, 16, a >> shift & 0xffff, b >> shift & 0xffff, factor);
    pair(half(0, factors[0]), half(16, factors[1]))
}

pub(crate) fn each_byte(a: u32, b: u32, f: impl Fn(u32, u32) -> u32) -> u32 {
    let byte = |word: u32, n: usize| u32::from(word.to_le_bytes()[n]);
    u32::from_le_bytes(std::array::from_fn(|n| f(byte(a, n), byte(b, n)) as u8))
}

/// Returns the sum of the absolute differences of the bytes.
pub(crate) fn difference(a: u32, b: u32) -> u32 {
    a.to_le_bytes().iter().zip(b.to_le_bytes()).map(|(&x, y)| u32::from(x.abs_diff(y))).sum()
}

/// Returns two halves as a word, each cut to 16 bits.
pub(crate) fn pair(low: u32, high: u32) -> u32 {
    low & 0xffff | high << 16
}
