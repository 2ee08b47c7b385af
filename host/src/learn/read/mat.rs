//! Reads MATLAB v5 files: real numeric arrays, cells and structs, compressed or not.
//!
//! Written for files from anywhere: it never panics, and the file bounds time and memory.

use std::collections::BTreeMap;

/// Cells in cells in structs: deeper than this is no data file.
const MAX_DEPTH: usize = 16;
/// Bytes that all compressed variables of one file may unpack to.
const MAX_UNPACKED: usize = 128 << 20;
/// Elements in one array.
const MAX_ELEMENTS: usize = 8 << 20;

const TYPE_MATRIX: u32 = 14;
const TYPE_COMPRESSED: u32 = 15;

/// What is wrong with the bytes of a MATLAB file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MatError {
    /// No MATLAB v5 header.
    #[error("it has no MATLAB v5 header")]
    NoHeader,
    /// The HDF5-based format of newer MATLAB versions.
    #[error("it is of version 7.3; save it with -v7 or -v6")]
    Version73,
    /// Written on a big-endian machine.
    #[error("it is big-endian; only little-endian files are read")]
    BigEndian,
    /// The file ends inside an element.
    #[error("it ends early")]
    Truncated,
    /// Compressed data that does not unpack.
    #[error("its compressed data is damaged or unpacks to more than 128 MiB")]
    Compression,
    /// Sizes that contradict each other or exceed the limits.
    #[error("an array in it is larger than its data or nested too deeply")]
    Limit,
    /// A kind of data that demonstrations do not have.
    #[error("it holds data of a kind that is not read (type {0}); real arrays, cells and structs are")]
    Unsupported(u32),
}

/// One value of a MATLAB file. Arrays are column-major.
#[derive(Debug, Clone, PartialEq)]
pub enum Mat {
    /// A real numeric array.
    Numeric {
        /// Size along each dimension.
        size: Vec<usize>,
        /// Elements, column by column.
        data: Vec<f64>,
    },
    /// A cell array.
    Cell(Vec<Mat>),
    /// A struct array.
    Struct(Vec<BTreeMap<String, Mat>>),
    /// Text, or anything else that is named but not read.
    Other,
}

/// Reads all variables of a file.
pub fn read(bytes: &[u8]) -> Result<BTreeMap<String, Mat>, MatError> {
    if bytes.starts_with(b"MATLAB 7.3") || bytes.starts_with(b"\x89HDF") {
        return Err(MatError::Version73);
    }
    let header = bytes.get(..128).ok_or(MatError::NoHeader)?;
    match &header[124..] {
        [0, 1, b'I', b'M'] => {}
        [_, _, b'M', b'I'] => return Err(MatError::BigEndian),
        _ => return Err(MatError::NoHeader),
    }
    let mut input = Cursor { bytes: &bytes[128..] };
    let mut budget = MAX_UNPACKED;
    let mut variables = BTreeMap::new();
    while !input.bytes.is_empty() {
        let (kind, data) = input.element()?;
        let (name, value) = match kind {
            TYPE_MATRIX => matrix(data, 0)?,
            TYPE_COMPRESSED => {
                let unpacked = miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(data, budget)
                    .map_err(|_| MatError::Compression)?;
                budget -= unpacked.len();
                let (kind, data) = Cursor { bytes: &unpacked }.element()?;
                if kind != TYPE_MATRIX {
                    return Err(MatError::Unsupported(kind));
                }
                matrix(data, 0)?
            }
            other => return Err(MatError::Unsupported(other)),
        };
        variables.insert(name, value);
    }
    Ok(variables)
}

struct Cursor<'a> {
    bytes: &'a [u8],
}

impl<'a> Cursor<'a> {
    fn take(&mut self, n: usize) -> Result<&'a [u8], MatError> {
        let (head, tail) = self.bytes.split_at_checked(n).ok_or(MatError::Truncated)?;
        self.bytes = tail;
        Ok(head)
    }

    fn u32(&mut self) -> Result<u32, MatError> {
        let word = self.take(4)?.first_chunk().ok_or(MatError::Truncated)?;
        Ok(u32::from_le_bytes(*word))
    }

    /// Type and payload of the next element. Up to four bytes of payload sit in the tag itself.
    fn element(&mut self) -> Result<(u32, &'a [u8]), MatError> {
        let word = self.u32()?;
        let small = (word >> 16) as usize;
        if small > 0 {
            let data = self.take(4)?;
            return Ok((word & 0xffff, data.get(..small).ok_or(MatError::Limit)?));
        }
        let n = self.u32()? as usize;
        let data = self.take(n)?;
        if word != TYPE_COMPRESSED {
            // The padding of the last element may be missing.
            let padding = n.next_multiple_of(8) - n;
            self.take(padding.min(self.bytes.len()))?;
        }
        Ok((word, data))
    }
}

fn matrix(data: &[u8], depth: usize) -> Result<(String, Mat), MatError> {
    if depth > MAX_DEPTH {
        return Err(MatError::Limit);
    }
    let empty = Mat::Numeric { size: vec![0, 0], data: vec![] };
    if data.is_empty() {
        return Ok((String::new(), empty));
    }
    let mut input = Cursor { bytes: data };
    let (_, flags) = input.element()?;
    let &[class, flags, ..] = flags else { return Err(MatError::Truncated) };
    let complex = flags & 0x08 != 0;
    let (kind, sizes) = input.element()?;
    let mut size = Vec::new();
    for v in numbers(kind, sizes)? {
        if !(0.0..=MAX_ELEMENTS as f64).contains(&v) {
            return Err(MatError::Limit);
        }
        size.push(v as usize);
    }
    let count =
        size.iter().try_fold(1usize, |n, &s| n.checked_mul(s)).filter(|&n| n <= MAX_ELEMENTS).ok_or(MatError::Limit)?;
    let (_, name) = input.element()?;
    let name = String::from_utf8_lossy(name).into_owned();

    let value = match class {
        1 => {
            // Every cell takes at least its tag.
            if count > input.bytes.len() / 8 {
                return Err(MatError::Limit);
            }
            Mat::Cell((0..count).map(|_| nested(&mut input, depth)).collect::<Result<_, _>>()?)
        }
        2 => {
            let (kind, length) = input.element()?;
            let length = numbers(kind, length)?.first().copied().unwrap_or(0.0) as usize;
            let (_, names) = input.element()?;
            if length == 0 || names.len() % length != 0 {
                return Err(MatError::Limit);
            }
            let names: Vec<String> = names.chunks_exact(length).map(until_zero).collect();
            if names.is_empty() || count.saturating_mul(names.len()) > input.bytes.len() / 8 {
                return Err(MatError::Limit);
            }
            let mut all = Vec::with_capacity(count);
            for _ in 0..count {
                let mut fields = BTreeMap::new();
                for name in &names {
                    fields.insert(name.clone(), nested(&mut input, depth)?);
                }
                all.push(fields);
            }
            Mat::Struct(all)
        }
        6..=15 if !complex => {
            let (kind, data) = input.element()?;
            let data = numbers(kind, data)?;
            if data.len() != count {
                return Err(MatError::Truncated);
            }
            Mat::Numeric { size, data }
        }
        _ => Mat::Other,
    };
    Ok((name, value))
}

fn nested(input: &mut Cursor, depth: usize) -> Result<Mat, MatError> {
    match input.element()? {
        (TYPE_MATRIX, data) => Ok(matrix(data, depth + 1)?.1),
        (kind, _) => Err(MatError::Unsupported(kind)),
    }
}

fn until_zero(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&b| b == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).into_owned()
}

/// Numbers of any stored type. MATLAB stores arrays of small whole numbers in the smallest type that holds them.
fn numbers(kind: u32, data: &[u8]) -> Result<Vec<f64>, MatError> {
    fn decode<const N: usize>(data: &[u8], number: fn([u8; N]) -> f64) -> Vec<f64> {
        data.as_chunks::<N>().0.iter().map(|c| number(*c)).collect()
    }
    Ok(match kind {
        1 => decode(data, |b| f64::from(i8::from_le_bytes(b))),
        2 => decode(data, |b| f64::from(u8::from_le_bytes(b))),
        3 => decode(data, |b| f64::from(i16::from_le_bytes(b))),
        4 => decode(data, |b| f64::from(u16::from_le_bytes(b))),
        5 => decode(data, |b| f64::from(i32::from_le_bytes(b))),
        6 => decode(data, |b| f64::from(u32::from_le_bytes(b))),
        7 => decode(data, |b| f64::from(f32::from_le_bytes(b))),
        9 => decode(data, f64::from_le_bytes),
        12 => decode(data, |b| i64::from_le_bytes(b) as f64),
        13 => decode(data, |b| u64::from_le_bytes(b) as f64),
        other => return Err(MatError::Unsupported(other)),
    })
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::mat_writer as writer;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn reads_what_was_written() {
        for compressed in [false, true] {
            let bytes = writer::file(&writer::demos(&[2, 3], 5, true), compressed);
            let variables = read(&bytes).expect("valid");
            assert_eq!(variables["dt"], Mat::Numeric { size: vec![1, 1], data: vec![0.5] });
            let Mat::Cell(cells) = &variables["demos"] else { panic!("a cell") };
            assert_eq!(cells.len(), 2);
            let Mat::Struct(fields) = &cells[1] else { panic!("a struct") };
            let Mat::Numeric { size, data } = &fields[0]["pos"] else { panic!("numbers") };
            assert_eq!((size.as_slice(), data.len()), ([3, 5].as_slice(), 15));
        }
    }

    #[test]
    fn other_files_are_named() {
        assert_eq!(read(b""), Err(MatError::NoHeader));
        assert_eq!(read(&[b'x'; 500]), Err(MatError::NoHeader));
        assert_eq!(read(b"MATLAB 7.3 MAT-file, Platform"), Err(MatError::Version73));
        let mut big = writer::file(&[], false);
        big[124..128].copy_from_slice(&[1, 0, b'M', b'I']);
        assert_eq!(read(&big), Err(MatError::BigEndian));
    }

    #[test]
    fn a_huge_empty_struct_costs_nothing() {
        let bytes = writer::file(&[writer::matrix("s", 2, &[1 << 22, 1], &writer::field_names(&[]))], false);
        assert_eq!(read(&bytes), Err(MatError::Limit));
    }

    #[test]
    fn deep_nesting_is_refused() {
        let mut inner = writer::numeric("", &[1, 1], &[1.0]);
        for _ in 0..40 {
            inner = writer::matrix("", 1, &[1, 1], &inner);
        }
        assert_eq!(read(&writer::file(&[inner], false)), Err(MatError::Limit));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn corrupted_files_never_panic(
            compressed: bool,
            hits in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
            cut in proptest::option::of(any::<prop::sample::Index>()),
        ) {
            let mut bytes = writer::file(&writer::demos(&[2, 2], 6, true), compressed);
            for (at, value) in hits {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            if let Some(cut) = cut {
                bytes.truncate(cut.index(bytes.len()));
            }
            let _ = super::super::lasa::read("a.mat", &bytes);
        }
    }
}
