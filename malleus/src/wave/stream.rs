//! WAV files that a program wrote into a pipe: their headers do not tell how long they are.

/// Least length in bytes that stands for an unknown one: SoX writes 0x7fff_f000 into the data's
/// header, FFmpeg 0xffff_ffff.
const UNKNOWN: u32 = 0x7fff_f000;
/// Bytes of the header before the first chunk, and of the header of a chunk.
const RIFF_BYTES: usize = 12;
const CHUNK_BYTES: usize = 8;

/// Gives a WAV file whose header has the length of its data where that was left open: all whole
/// frames to the end of the file. Other files are given as they are, damaged ones too.
pub(super) fn with_length(mut bytes: Vec<u8>) -> Vec<u8> {
    if let Some((place, length)) = open_length(&bytes) {
        bytes[place..place + 4].copy_from_slice(&length.to_le_bytes());
    }
    bytes
}

/// Place of the data's length, and the length that is there, if the header leaves it open.
fn open_length(bytes: &[u8]) -> Option<(usize, u32)> {
    let word = |place: usize| Some(u32::from_le_bytes(bytes.get(place..place + 4)?.try_into().ok()?));
    let whole = word(4)?;
    let (mut chunk, mut frame_bytes) = (RIFF_BYTES, None);
    loop {
        let (content, length) = (chunk + CHUNK_BYTES, word(chunk + 4)?);
        match &bytes[chunk..chunk + 4] {
            b"fmt " => frame_bytes = word(content + 12).map(|word| word & 0xffff),
            b"data" => {
                let left = u32::try_from(bytes.len().checked_sub(content)?).unwrap_or(u32::MAX);
                let is_whole_unknown = whole == 0 || whole >= UNKNOWN;
                let is_open = (length >= UNKNOWN && length > left) || (length == 0 && is_whole_unknown);
                let frame_bytes = frame_bytes.filter(|bytes| *bytes > 0 && is_open)?;
                return Some((chunk + 4, left - left % frame_bytes));
            }
            _ => {}
        }
        // A chunk of an odd length has a byte behind it.
        chunk = content.checked_add(length.checked_next_multiple_of(2)? as usize)?;
    }
}
