//! The checksum of a kit.

use crc::{CRC_32_ISO_HDLC, Crc};

// A board checks one kit, at its start, and has no kilobyte to spare for a lookup table; a PC
// checks many kits.
#[cfg(target_os = "none")]
type Lookup = crc::NoTable;
#[cfg(not(target_os = "none"))]
type Lookup = crc::Table<16>;

/// CRC-32/ISO-HDLC (the one of zip and Ethernet) over a kit's bytes after its header.
pub fn checksum(bytes: &[u8]) -> u32 {
    const CRC: Crc<u32, Lookup> = Crc::<u32, Lookup>::new(&CRC_32_ISO_HDLC);
    CRC.checksum(bytes)
}

#[cfg(test)]
mod tests {
    #[test]
    fn checksum_of_the_digits_1_to_9_is_the_published_one() {
        assert_eq!(super::checksum(b"123456789"), 0xCBF4_3926);
    }
}
