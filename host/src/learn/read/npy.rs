//! Reads arrays of numbers in NumPy's `.npy` format, versions 1 to 3.

/// What is wrong with the bytes of an array.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NpyError {
    /// No NumPy magic, or a header that is cut off.
    #[error("has no NumPy header")]
    NoHeader,
    /// A header that is no dictionary of `descr`, `fortran_order` and `shape`.
    #[error("has a damaged NumPy header")]
    Header,
    /// Elements that are not real numbers.
    #[error("holds elements of type {0}")]
    Type(String),
    /// Python objects, which need Python to be read.
    #[error("holds Python objects")]
    Objects,
    /// Fewer or more bytes than the shape needs.
    #[error("has not as many bytes as its shape needs")]
    Length,
}

/// An array of numbers, in C order: the last index runs fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Size along each dimension.
    pub shape: Vec<usize>,
    /// The elements.
    pub data: Vec<f64>,
}

/// Reads an array.
pub fn read(bytes: &[u8]) -> Result<Array, NpyError> {
    let rest = bytes.strip_prefix(b"\x93NUMPY").ok_or(NpyError::NoHeader)?;
    let (length, rest) = match rest {
        [1, _, a, b, rest @ ..] => (usize::from(u16::from_le_bytes([*a, *b])), rest),
        [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
        _ => return Err(NpyError::NoHeader),
    };
    let (header, data) = rest.split_at_checked(length).ok_or(NpyError::NoHeader)?;
    let header = Header::parse(std::str::from_utf8(header).map_err(|_| NpyError::Header)?).ok_or(NpyError::Header)?;
    let data = numbers(&header.descr, data)?;
    let count = header.shape.iter().try_fold(1usize, |n, &s| n.checked_mul(s)).ok_or(NpyError::Length)?;
    if data.len() != count {
        return Err(NpyError::Length);
    }
    let data = if header.fortran_order { to_c_order(&header.shape, &data) } else { data };
    Ok(Array { shape: header.shape, data })
}

struct Header {
    descr: String,
    fortran_order: bool,
    shape: Vec<usize>,
}

impl Header {
    /// The header is a Python dictionary: `{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }`.
    fn parse(text: &str) -> Option<Self> {
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        let mut rest = text.trim().strip_prefix('{')?.strip_suffix('}')?.trim();
        while !rest.is_empty() {
            let (key, after) = quoted(rest)?;
            rest = after.trim_start().strip_prefix(':')?.trim_start();
            match key {
                "descr" if rest.starts_with('[') => {
                    // A record type: named, for the message, by what it is.
                    return Some(Self { descr: "record".into(), fortran_order: false, shape: vec![] });
                }
                "descr" => {
                    let (value, after) = quoted(rest)?;
                    (descr, rest) = (Some(value.to_owned()), after);
                }
                "fortran_order" => {
                    let (value, after) = if let Some(after) = rest.strip_prefix("True") {
                        (true, after)
                    } else {
                        (false, rest.strip_prefix("False")?)
                    };
                    (fortran_order, rest) = (Some(value), after);
                }
                "shape" => {
                    let (inside, after) = rest.strip_prefix('(')?.split_once(')')?;
                    let mut sizes = Vec::new();
                    for size in inside.split(',').map(str::trim).filter(|s| !s.is_empty()) {
                        sizes.push(size.trim_end_matches('L').parse().ok()?);
                    }
                    (shape, rest) = (Some(sizes), after);
                }
                _ => return None,
            }
            rest = rest.trim_start();
            rest = rest.strip_prefix(',').unwrap_or(rest).trim_start();
        }
        Some(Self { descr: descr?, fortran_order: fortran_order?, shape: shape? })
    }
}

fn quoted(text: &str) -> Option<(&str, &str)> {
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    text[1..].split_once(quote)
}

fn numbers(descr: &str, data: &[u8]) -> Result<Vec<f64>, NpyError> {
    fn decode<const N: usize>(data: &[u8], swap: bool, number: fn([u8; N]) -> f64) -> Result<Vec<f64>, NpyError> {
        let (chunks, rest) = data.as_chunks::<N>();
        if !rest.is_empty() {
            return Err(NpyError::Length);
        }
        Ok(chunks
            .iter()
            .map(|&chunk| {
                let mut chunk = chunk;
                if swap {
                    chunk.reverse();
                }
                number(chunk)
            })
            .collect())
    }
    let swap = descr.starts_with('>');
    match descr.trim_start_matches(['<', '>', '=', '|']) {
        "f8" => decode(data, swap, f64::from_le_bytes),
        "f4" => decode(data, swap, |b| f64::from(f32::from_le_bytes(b))),
        "i1" => decode(data, swap, |b| f64::from(i8::from_le_bytes(b))),
        "u1" | "b1" => decode(data, swap, |b| f64::from(u8::from_le_bytes(b))),
        "i2" => decode(data, swap, |b| f64::from(i16::from_le_bytes(b))),
        "u2" => decode(data, swap, |b| f64::from(u16::from_le_bytes(b))),
        "i4" => decode(data, swap, |b| f64::from(i32::from_le_bytes(b))),
        "u4" => decode(data, swap, |b| f64::from(u32::from_le_bytes(b))),
        "i8" => decode(data, swap, |b| i64::from_le_bytes(b) as f64),
        "u8" => decode(data, swap, |b| u64::from_le_bytes(b) as f64),
        "O" => Err(NpyError::Objects),
        other => Err(NpyError::Type(other.chars().take(20).collect())),
    }
}

/// From the first index running fastest to the last.
fn to_c_order(shape: &[usize], data: &[f64]) -> Vec<f64> {
    (0..data.len())
        .map(|c| {
            let (mut rest, mut at, mut stride) = (c, 0, data.len());
            for &size in shape.iter().rev() {
                stride /= size;
                at += (rest % size) * stride;
                rest /= size;
            }
            data[at]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::npz_writer as writer;
    use super::*;
    use proptest::prelude::*;

    fn with_header(header: &str, data: &[u8]) -> Vec<u8> {
        let mut out = b"\x93NUMPY\x01\x00".to_vec();
        out.extend((header.len() as u16).to_le_bytes());
        out.extend(header.as_bytes());
        out.extend(data);
        out
    }

    #[test]
    fn reads_what_was_written() {
        let data: Vec<f64> = (0..24).map(f64::from).collect();
        let array = read(&writer::array(&[2, 3, 4], &data)).expect("valid");
        assert_eq!((array.shape.as_slice(), array.data), ([2, 3, 4].as_slice(), data));
    }

    #[test]
    fn every_order_and_type_gives_the_same_numbers() {
        // NumPy's own bytes of arange(6).reshape(2, 3), by column and big-endian.
        let columns: Vec<u8> = [0.0, 3.0, 1.0, 4.0, 2.0, 5.0_f64].iter().flat_map(|v| v.to_le_bytes()).collect();
        let header = "{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }            \n";
        assert_eq!(read(&with_header(header, &columns)).expect("valid").data, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        let big: Vec<u8> = [-1_i16, 300].iter().flat_map(|v| v.to_be_bytes()).collect();
        let header = "{'descr': '>i2', 'fortran_order': False, 'shape': (2,), }\n";
        assert_eq!(read(&with_header(header, &big)).expect("valid").data, [-1.0, 300.0]);
        let scalar = with_header("{'shape': (), 'fortran_order': False, 'descr': \"|u1\"}", &[7]);
        assert_eq!(read(&scalar).expect("valid").data, [7.0]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let header = |descr: &str| format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (2,), }}\n");
        assert_eq!(read(b"abc"), Err(NpyError::NoHeader));
        assert_eq!(read(&with_header("{'descr': }", &[])), Err(NpyError::Header));
        assert_eq!(read(&with_header(&header("<f8"), &[0; 15])), Err(NpyError::Length));
        assert_eq!(read(&with_header(&header("<f8"), &[0; 24])), Err(NpyError::Length));
        assert_eq!(read(&with_header(&header("|O"), &[0; 16])), Err(NpyError::Objects));
        assert_eq!(read(&with_header(&header("<c16"), &[0; 32])), Err(NpyError::Type("c16".into())));
        let record = "{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (2,), }";
        assert_eq!(read(&with_header(record, &[0; 16])), Err(NpyError::Type("record".into())));
    }

    proptest! {
        #[test]
        fn damaged_headers_never_panic(at: prop::sample::Index, with in "\\PC{0,4}", data in 0usize..64) {
            let good = "{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }";
            let at = at.index(good.len());
            let _ = read(&with_header(&format!("{}{with}{}", &good[..at], &good[at + 1..]), &vec![1; data]));
        }
    }
}
