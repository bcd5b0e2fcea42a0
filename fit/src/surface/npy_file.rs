//! Heights from an NPY file (NumPy enhancement proposal 1, versions 1 to 3).
//!
//! The crates that read NPY files need a C compiler to build. The format is a text of three keys,
//! and the numbers behind it.

use std::path::Path;

use super::error::SurfaceError;

/// First bytes of a file.
const MAGIC: &[u8] = b"\x93NUMPY";

/// Heights of a file, row by row, and the number of points of a row.
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<(Vec<f64>, usize), SurfaceError> {
    let not_npy = |reason| SurfaceError::NotNpy { path: path.to_owned(), reason };
    let (head, numbers) = split(bytes).ok_or_else(|| not_npy("its head is missing or cut"))?;
    let kind = quoted(head, "descr").ok_or_else(|| not_npy("its head names no type"))?;
    let shape = shape(head).ok_or_else(|| not_npy("its head names no shape"))?;
    let (rows, columns) = match shape[..] {
        [columns] | [columns, 1] => (1, columns),
        [rows, columns] => (rows, columns),
        _ => return Err(SurfaceError::Shape { path: path.to_owned(), shape }),
    };
    let wrong = || SurfaceError::NumberType { path: path.to_owned(), found: kind.to_owned() };
    let values = values(kind, numbers).ok_or_else(wrong)?;
    let count = rows.checked_mul(columns).ok_or_else(|| not_npy("its shape is too large"))?;
    if values.len() < count {
        return Err(not_npy("it ends before its last number"));
    }
    let is_transposed = value_of(head, "fortran_order").is_some_and(|text| text.starts_with("True"));
    if rows < 2 || !is_transposed {
        return Ok((values[..count].to_vec(), columns));
    }
    let by_row = (0..count).map(|index| values[index / columns + index % columns * rows]);
    Ok((by_row.collect(), columns))
}

/// Text of the head, and the numbers behind it.
fn split(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let rest = bytes.strip_prefix(MAGIC)?;
    let (&[version, _], rest) = rest.split_first_chunk::<2>()?;
    let (length, rest) = if version == 1 {
        let (length, rest) = rest.split_first_chunk::<2>()?;
        (usize::from(u16::from_le_bytes(*length)), rest)
    } else {
        let (length, rest) = rest.split_first_chunk::<4>()?;
        (u32::from_le_bytes(*length) as usize, rest)
    };
    let (head, numbers) = rest.split_at_checked(length)?;
    Some((std::str::from_utf8(head).ok()?, numbers))
}

/// Text behind a key and its colon.
fn value_of<'a>(head: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = head.split_once(&format!("'{key}'"))?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

/// Text in quotes behind a key; a type of several fields has none.
fn quoted<'a>(head: &'a str, key: &str) -> Option<&'a str> {
    let value = value_of(head, key)?;
    match value.strip_prefix('\'') {
        Some(rest) => rest.split('\'').next(),
        None => value.split(']').next(),
    }
}

/// Lengths of the array.
fn shape(head: &str) -> Option<Vec<usize>> {
    let inner = value_of(head, "shape")?.strip_prefix('(')?.split(')').next()?;
    inner.split(',').map(str::trim).filter(|text| !text.is_empty()).map(|text| text.parse().ok()).collect()
}

/// Numbers of a type in NumPy's notation; `None` if heights are not of that type.
fn values(kind: &str, bytes: &[u8]) -> Option<Vec<f64>> {
    let is_big = kind.starts_with('>');
    match kind.trim_start_matches(['<', '>', '|', '=']) {
        "f2" => Some(numbers(bytes, is_big, |bytes| f64::from(half::f16::from_le_bytes(bytes)))),
        "f4" => Some(numbers(bytes, is_big, |bytes| f64::from(f32::from_le_bytes(bytes)))),
        "f8" => Some(numbers(bytes, is_big, f64::from_le_bytes)),
        "i1" => Some(numbers(bytes, is_big, |bytes| f64::from(i8::from_le_bytes(bytes)))),
        "i2" => Some(numbers(bytes, is_big, |bytes| f64::from(i16::from_le_bytes(bytes)))),
        "i4" => Some(numbers(bytes, is_big, |bytes| f64::from(i32::from_le_bytes(bytes)))),
        "i8" => Some(numbers(bytes, is_big, |bytes| i64::from_le_bytes(bytes) as f64)),
        "u1" => Some(numbers(bytes, is_big, |bytes: [u8; 1]| f64::from(bytes[0]))),
        "u2" => Some(numbers(bytes, is_big, |bytes| f64::from(u16::from_le_bytes(bytes)))),
        "u4" => Some(numbers(bytes, is_big, |bytes| f64::from(u32::from_le_bytes(bytes)))),
        "u8" => Some(numbers(bytes, is_big, |bytes| u64::from_le_bytes(bytes) as f64)),
        _ => None,
    }
}

fn numbers<const N: usize>(bytes: &[u8], is_big: bool, number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    let (whole, _) = bytes.as_chunks::<N>();
    let of_bytes = |bytes: &[u8; N]| {
        let mut bytes = *bytes;
        if is_big {
            bytes.reverse();
        }
        number(bytes)
    };
    whole.iter().map(of_bytes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(head: &str, numbers: &[u8]) -> Vec<u8> {
        [MAGIC, &[1, 0], &(head.len() as u16).to_le_bytes(), head.as_bytes(), numbers].concat()
    }

    fn read(bytes: &[u8]) -> Result<(Vec<f64>, usize), SurfaceError> {
        parse(bytes, Path::new("heights.npy"))
    }

    #[test]
    fn numbers_of_each_order_and_type_are_read_row_by_row() {
        let head = "{'descr': '<i2', 'fortran_order': False, 'shape': (2, 3), }";
        let rows: Vec<u8> = [1i16, 2, 3, -4, 5, 6].iter().flat_map(|x| x.to_le_bytes()).collect();
        let expected = (vec![1.0, 2.0, 3.0, -4.0, 5.0, 6.0], 3);
        assert_eq!(read(&file(head, &rows)).expect("it is whole"), expected);
        let head = "{'descr': '>f4', 'fortran_order': True, 'shape': (2, 3), }";
        let columns: Vec<u8> = [1f32, -4.0, 2.0, 5.0, 3.0, 6.0].iter().flat_map(|x| x.to_be_bytes()).collect();
        assert_eq!(read(&file(head, &columns)).expect("it is whole"), expected);
    }

    #[test]
    fn halves_and_64_bit_integers_are_read() {
        let head = |kind: &str| format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': (2,), }}");
        let read = |kind: &str, numbers: &[u8]| read(&file(&head(kind), numbers)).expect("it is whole").0;
        // 1.5 and -2 of 16 bits.
        assert_eq!(read("<f2", &[0x00, 0x3e, 0x00, 0xc0]), [1.5, -2.0]);
        assert_eq!(read(">f2", &[0x3e, 0x00, 0xc0, 0x00]), [1.5, -2.0]);
        let of_64 = |numbers: [i64; 2]| numbers.map(i64::to_le_bytes).concat();
        assert_eq!(read("<i8", &of_64([-3, 1 << 40])), [-3.0, (1u64 << 40) as f64]);
        assert_eq!(read("<u8", &of_64([-1, 7])), [u64::MAX as f64, 7.0]);
    }

    #[test]
    fn files_that_hold_no_heights_are_refused_by_name() {
        let shape = |text: &str| format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {text}, }}");
        assert!(matches!(read(b"heights"), Err(SurfaceError::NotNpy { .. })));
        assert!(matches!(read(&file(&shape("(2,)"), &[0; 15])), Err(SurfaceError::NotNpy { .. })));
        assert!(matches!(read(&file(&shape("(1, 1, 1)"), &[0; 8])), Err(SurfaceError::Shape { .. })));
        let fields = "{'descr': [('x', '<f4'), ('y', '<f4')], 'fortran_order': False, 'shape': (1,), }";
        assert!(matches!(read(&file(fields, &[0; 8])), Err(SurfaceError::NumberType { .. })));
        let complex = "{'descr': '<c16', 'fortran_order': False, 'shape': (1,), }";
        assert!(matches!(read(&file(complex, &[0; 16])), Err(SurfaceError::NumberType { .. })));
    }
}
