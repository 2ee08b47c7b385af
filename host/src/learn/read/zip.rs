//! Reads ZIP archives as NumPy writes them: stored or deflated, not encrypted, below 4 GiB.
//!
//! Sizes are those of the central directory, and what is unpacked has to match them and its checksum. Layout: PKWARE's
//! APPNOTE, sections 4.3.7, 4.3.12 and 4.3.16.

use std::collections::BTreeMap;

/// Bytes that all members of one archive may unpack to.
pub const MAX_UNPACKED: usize = 256 << 20;
/// Members of one archive.
const MAX_MEMBERS: usize = 1 << 14;

const END: &[u8] = b"PK\x05\x06";
const DIRECTORY: &[u8] = b"PK\x01\x02";
const LOCAL: &[u8] = b"PK\x03\x04";
const CRC32: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// What is wrong with the bytes of an archive.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ZipError {
    /// No end-of-directory record: another kind of file, or one that was cut off.
    #[error("it is no ZIP archive, or it is cut off")]
    NoArchive,
    /// Offsets or sizes that lead out of the file.
    #[error("its directory is damaged")]
    Directory,
    /// A 64-bit archive, or one on several disks.
    #[error("it is of a kind for archives beyond 4 GiB or on several disks")]
    Huge,
    /// More members, or more bytes in them, than demonstrations have.
    #[error("it unpacks to more than 256 MiB or 16384 arrays")]
    Limit,
    /// A member that is encrypted or compressed in an unusual way.
    #[error("`{0}` is encrypted or compressed by an unknown method")]
    Method(String),
    /// A member whose bytes are not what the directory says.
    #[error("`{0}` is damaged")]
    Damaged(String),
    /// Two members of one name.
    #[error("`{0}` is in it twice")]
    Twice(String),
}

/// The members of an archive, by name.
pub fn read(bytes: &[u8]) -> Result<BTreeMap<String, Vec<u8>>, ZipError> {
    // The record is the last thing in the file but for a comment of at most 65535 bytes.
    let tail = bytes.len().saturating_sub(65535 + 22);
    let at = bytes[tail..].windows(4).rposition(|w| w == END).ok_or(ZipError::NoArchive)? + tail;
    let end = bytes.get(at..at + 22).ok_or(ZipError::NoArchive)?;
    let (disks, members) = (u16_at(end, 4)? | u16_at(end, 6)?, u16_at(end, 10)?);
    let (size, offset) = (u32_at(end, 12)?, u32_at(end, 16)?);
    if disks != 0 || members == u16::MAX || size == u32::MAX || offset == u32::MAX {
        return Err(ZipError::Huge);
    }
    if usize::from(members) > MAX_MEMBERS {
        return Err(ZipError::Limit);
    }
    let mut directory = bytes.get(offset as usize..at).ok_or(ZipError::Directory)?;
    let mut budget = MAX_UNPACKED;
    let mut out = BTreeMap::new();
    for _ in 0..members {
        let (entry, rest) = directory.split_at_checked(46).ok_or(ZipError::Directory)?;
        if !entry.starts_with(DIRECTORY) {
            return Err(ZipError::Directory);
        }
        let lengths = [u16_at(entry, 28)?, u16_at(entry, 30)?, u16_at(entry, 32)?].map(usize::from);
        let name = rest.get(..lengths[0]).ok_or(ZipError::Directory)?;
        let name = String::from_utf8_lossy(name).into_owned();
        directory = rest.get(lengths.iter().sum()..).ok_or(ZipError::Directory)?;

        let member = member(bytes, entry, &name, budget)?;
        budget -= member.len();
        if out.contains_key(&name) {
            return Err(ZipError::Twice(name));
        }
        out.insert(name, member);
    }
    Ok(out)
}

/// Unpacks the member that an entry of the directory describes.
fn member(bytes: &[u8], entry: &[u8], name: &str, budget: usize) -> Result<Vec<u8>, ZipError> {
    let (flags, method, checksum) = (u16_at(entry, 8)?, u16_at(entry, 10)?, u32_at(entry, 16)?);
    let (packed, size, offset) = (u32_at(entry, 20)?, u32_at(entry, 24)?, u32_at(entry, 42)?);
    if packed == u32::MAX || size == u32::MAX || offset == u32::MAX {
        return Err(ZipError::Huge);
    }
    let (packed, size, offset) = (packed as usize, size as usize, offset as usize);
    if size > budget {
        return Err(ZipError::Limit);
    }
    let local = bytes.get(offset..).and_then(|b| b.get(..30)).ok_or(ZipError::Directory)?;
    if !local.starts_with(LOCAL) {
        return Err(ZipError::Directory);
    }
    let begin = offset + 30 + usize::from(u16_at(local, 26)?) + usize::from(u16_at(local, 28)?);
    let data = bytes.get(begin..).and_then(|b| b.get(..packed)).ok_or(ZipError::Directory)?;
    let encrypted = flags & 1 != 0;
    let damaged = || ZipError::Damaged(name.to_owned());
    let unpacked = match method {
        0 if !encrypted => data.to_vec(),
        8 if !encrypted => miniz_oxide::inflate::decompress_to_vec_with_limit(data, size).map_err(|_| damaged())?,
        _ => return Err(ZipError::Method(name.to_owned())),
    };
    if unpacked.len() != size || CRC32.checksum(&unpacked) != checksum {
        return Err(damaged());
    }
    Ok(unpacked)
}

fn u16_at(bytes: &[u8], at: usize) -> Result<u16, ZipError> {
    let word = bytes.get(at..).and_then(|b| b.first_chunk()).ok_or(ZipError::Directory)?;
    Ok(u16::from_le_bytes(*word))
}

fn u32_at(bytes: &[u8], at: usize) -> Result<u32, ZipError> {
    let word = bytes.get(at..).and_then(|b| b.first_chunk()).ok_or(ZipError::Directory)?;
    Ok(u32::from_le_bytes(*word))
}

#[cfg(test)]
mod tests {
    use super::super::npz_writer as writer;
    use super::*;

    #[test]
    fn reads_what_was_written() {
        let long = vec![7; 5000];
        for deflated in [false, true] {
            let all = read(&writer::archive(&[("a", b"abc"), ("b", &long)], deflated)).expect("valid");
            assert_eq!((all["a"].as_slice(), all["b"].as_slice()), (b"abc".as_slice(), long.as_slice()));
        }
        assert_eq!(read(&writer::archive(&[], false)), Ok(BTreeMap::new()));
    }

    #[test]
    fn what_is_wrong_is_named() {
        assert_eq!(read(b""), Err(ZipError::NoArchive));
        assert_eq!(read(&[0xff; 300]), Err(ZipError::NoArchive));
        let good = writer::archive(&[("a", &[7; 5000])], true);
        assert_eq!(read(&good[..good.len() - 1]), Err(ZipError::NoArchive));
        // A byte of the first member's data, behind 30 bytes and its name.
        let mut bad = good.clone();
        bad[33] ^= 0x55;
        assert_eq!(read(&bad), Err(ZipError::Damaged("a".into())));
        assert_eq!(read(&writer::archive(&[("a", b"x"), ("a", b"y")], false)), Err(ZipError::Twice("a".into())));
    }

    /// A few kilobytes that unpack to a gigabyte, honest or not about it, cost nothing.
    #[test]
    fn bombs_do_not_go_off() {
        let zeros = vec![0; 1 << 20];
        let mut bomb = writer::archive(&[("a", &zeros)], true);
        let directory = bomb.windows(4).position(|w| w == DIRECTORY).expect("there");
        bomb[directory + 24..directory + 28].copy_from_slice(&(1_u32 << 30).to_le_bytes());
        assert_eq!(read(&bomb), Err(ZipError::Limit));
        bomb[directory + 24..directory + 28].copy_from_slice(&100_u32.to_le_bytes());
        assert_eq!(read(&bomb), Err(ZipError::Damaged("a".into())));
    }
}
