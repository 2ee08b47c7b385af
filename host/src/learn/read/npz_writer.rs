//! Writes small NumPy archives for tests.

/// A float64 array in C order.
pub fn array(shape: &[usize], data: &[f64]) -> Vec<u8> {
    let sizes: String = shape.iter().map(|s| format!("{s}, ")).collect();
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({sizes}), }}");
    while (header.len() + 11) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut out = b"\x93NUMPY\x01\x00".to_vec();
    out.extend((header.len() as u16).to_le_bytes());
    out.extend(header.as_bytes());
    out.extend(data.iter().flat_map(|v| v.to_le_bytes()));
    out
}

/// A ZIP archive.
pub fn archive(members: &[(&str, &[u8])], deflated: bool) -> Vec<u8> {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let (mut out, mut directory) = (Vec::new(), Vec::new());
    for (name, data) in members {
        let packed = if deflated { miniz_oxide::deflate::compress_to_vec(data, 6) } else { data.to_vec() };
        // Version, flags, method, time and date, checksum, sizes, length of the name.
        let mut common = vec![20, 0, 0, 0, if deflated { 8 } else { 0 }, 0, 0, 0, 0, 0];
        for word in [crc.checksum(data), packed.len() as u32, data.len() as u32] {
            common.extend(word.to_le_bytes());
        }
        common.extend((name.len() as u16).to_le_bytes());
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&common);
        // No extra field, no comment, disk 0, no attributes; then the offset.
        directory.extend([0; 12]);
        directory.extend((out.len() as u32).to_le_bytes());
        directory.extend(name.as_bytes());
        out.extend(b"PK\x03\x04");
        out.extend(&common);
        out.extend([0; 2]);
        out.extend(name.as_bytes());
        out.extend(packed);
    }
    let offset = out.len() as u32;
    out.extend(&directory);
    out.extend(b"PK\x05\x06\0\0\0\0");
    let count = members.len() as u16;
    out.extend([count.to_le_bytes(), count.to_le_bytes()].concat());
    out.extend((directory.len() as u32).to_le_bytes());
    out.extend(offset.to_le_bytes());
    out.extend([0; 2]);
    out
}

/// An archive of float64 arrays, as `numpy.savez` names them.
pub fn file(arrays: &[(&str, &[usize], &[f64])], deflated: bool) -> Vec<u8> {
    let members: Vec<_> =
        arrays.iter().map(|(name, shape, data)| (format!("{name}.npy"), array(shape, data))).collect();
    let members: Vec<_> = members.iter().map(|(name, data)| (name.as_str(), data.as_slice())).collect();
    archive(&members, deflated)
}
