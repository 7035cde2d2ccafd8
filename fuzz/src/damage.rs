//! Changes of files, and checksums.

use arbitrary::{Arbitrary, Unstructured};

/// Bytes before the content of a file: the magic number, the version and the length.
pub(crate) const PREFIX: usize = 20;
/// Most changes of a file.
const CHANGES: usize = 32;

/// Changes a file as the bytes say. `repair` makes its lengths and checksums right again.
pub(crate) fn changed(mut file: Vec<u8>, source: &mut Unstructured<'_>, repair: fn(&mut [u8])) -> arbitrary::Result<Vec<u8>> {
    for _ in 0..CHANGES {
        if source.is_empty() || file.is_empty() {
            break;
        }
        let (kind, at, value) = (u8::arbitrary(source)?, u32::arbitrary(source)? as usize, u32::arbitrary(source)?);
        let place = at % file.len();
        let end = (place + 4).min(file.len());
        match kind % 6 {
            0 => file[place] ^= value as u8,
            1 => file[place..end].copy_from_slice(&value.to_le_bytes()[..end - place]),
            2 => file[place / 4 * 4..end].fill(0),
            3 => drop(file.drain(place..(place + value as usize % 64).min(file.len()))),
            4 => drop(file.splice(place..place, value.to_le_bytes())),
            _ => file.truncate(place),
        }
    }
    // The last bit decides whether a reader sees the changes or wrong checksums.
    if source.is_empty() || bool::arbitrary(source)? {
        repair(&mut file);
    }
    Ok(file)
}

/// Writes the length and the checksum of a file into it.
pub(crate) fn close(file: &mut [u8]) {
    let length = file.len();
    if length < PREFIX + 4 {
        return;
    }
    file[PREFIX - 8..PREFIX].copy_from_slice(&(length as u64).to_le_bytes());
    let (content, sum) = file.split_at_mut(length - 4);
    sum.copy_from_slice(&crc32(content).to_le_bytes());
}

/// The CRC-32 of zip files, bit by bit: files are short.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & 0_u32.wrapping_sub(crc & 1)))
    };
    !bytes.iter().fold(!0, step)
}
