//! Numbers as text: the shortest decimals from which they are read back bit for bit.

/// Shortest decimal that TOML accepts as a float and that gives `value` back bit for bit, when it
/// is read as f64 and rounded to f32.
///
/// The shortest decimal of an f32 lies nearer to it than to its neighbours. But the f64 nearest to
/// that decimal may lie exactly halfway between two f32s, and then be rounded to the wrong one. Of
/// all finite f32s only ±7.038531e-26 are such numbers (every f32 was tried); they get the digits
/// of their f64.
pub(super) fn shortest_decimal(value: f32) -> String {
    if value.is_nan() {
        return "nan".to_owned();
    }
    let shortest = format!("{value:?}");
    let comes_back = shortest.parse::<f64>().is_ok_and(|read| (read as f32).to_bits() == value.to_bits());
    if comes_back { shortest } else { format!("{:?}", f64::from(value)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_short_as_they_can_be() {
        assert_eq!(shortest_decimal(220.0), "220.0");
        assert_eq!(shortest_decimal(0.1), "0.1");
        assert_eq!(shortest_decimal(-0.0), "-0.0");
        assert_eq!(shortest_decimal(f32::from_bits(1)), "1e-45");
        assert_eq!(shortest_decimal(1e9), "1000000000.0");
        assert_eq!(shortest_decimal(f32::MAX), "3.4028235e38");
        assert_eq!(shortest_decimal(f32::INFINITY), "inf");
        assert_eq!(shortest_decimal(f32::NAN), "nan");
    }

    #[test]
    fn number_whose_shortest_decimal_rounds_wrongly_gets_more_digits() {
        let value = f32::from_bits(0x15AE_43FD);
        assert_eq!(format!("{value:?}"), "7.038531e-26");
        assert_ne!("7.038531e-26".parse::<f64>().map(|read| read as f32), Ok(value));
        let written = shortest_decimal(value);
        assert_eq!(written.parse::<f64>().map(|read| read as f32), Ok(value));
        assert_eq!(shortest_decimal(-value), format!("-{written}"));
    }
}
