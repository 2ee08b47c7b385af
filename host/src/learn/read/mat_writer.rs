//! Writes small MATLAB v5 files, so that tests need no data of others.

/// One element: tag, payload, padding to eight bytes.
pub fn element(kind: u32, payload: &[u8]) -> Vec<u8> {
    let mut out = kind.to_le_bytes().to_vec();
    out.extend((payload.len() as u32).to_le_bytes());
    out.extend(payload);
    out.resize(out.len().next_multiple_of(8), 0);
    out
}

/// A matrix element of the given class with its header and body.
pub fn matrix(name: &str, class: u8, size: &[u32], body: &[u8]) -> Vec<u8> {
    let mut all = element(6, &[class, 0, 0, 0, 0, 0, 0, 0]);
    all.extend(element(5, &size.iter().flat_map(|s| s.to_le_bytes()).collect::<Vec<_>>()));
    all.extend(element(1, name.as_bytes()));
    all.extend(body);
    element(14, &all)
}

/// A double array.
pub fn numeric(name: &str, size: &[u32], data: &[f64]) -> Vec<u8> {
    let bytes: Vec<u8> = data.iter().flat_map(|v| v.to_le_bytes()).collect();
    matrix(name, 6, size, &element(9, &bytes))
}

/// The names of a struct's fields, 8 bytes each; the length is a small element.
pub fn field_names(names: &[&str]) -> Vec<u8> {
    let mut out = (4u32 << 16 | 5).to_le_bytes().to_vec();
    out.extend(8u32.to_le_bytes());
    let padded: Vec<u8> = names
        .iter()
        .flat_map(|n| {
            let mut b = n.as_bytes().to_vec();
            b.resize(8, 0);
            b
        })
        .collect();
    out.extend(element(1, &padded));
    out
}

/// A scalar struct.
pub fn structure(name: &str, fields: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut body = field_names(&fields.iter().map(|f| f.0).collect::<Vec<_>>());
    fields.iter().for_each(|f| body.extend(&f.1));
    matrix(name, 2, &[1, 1], &body)
}

/// `dt` and `demos` with one demonstration a dimension given: straight lines to zero, `n` samples in `n - 1` s.
pub fn demos(dimensions: &[u32], n: u32, with_velocity: bool) -> Vec<Vec<u8>> {
    let mut cells = Vec::new();
    for (i, &d) in dimensions.iter().enumerate() {
        let start = 10.0 + i as f64;
        let t: Vec<f64> = (0..n).map(f64::from).collect();
        let step = start / f64::from(n - 1);
        let pos: Vec<f64> = t.iter().flat_map(|t| vec![start - step * t; d as usize]).collect();
        let mut fields = vec![("pos", numeric("", &[d, n], &pos)), ("t", numeric("", &[1, n], &t))];
        if with_velocity {
            fields.push(("vel", numeric("", &[d, n], &vec![-step; pos.len()])));
        }
        cells.extend(structure("", &fields));
    }
    let demos = matrix("demos", 1, &[1, dimensions.len() as u32], &cells);
    vec![numeric("dt", &[1, 1], &[0.5]), demos]
}

/// A whole file.
pub fn file(variables: &[Vec<u8>], compressed: bool) -> Vec<u8> {
    let mut out = vec![b' '; 128];
    out[..10].copy_from_slice(b"MATLAB 5.0");
    out[124..].copy_from_slice(&[0, 1, b'I', b'M']);
    for variable in variables {
        if compressed {
            let packed = miniz_oxide::deflate::compress_to_vec_zlib(variable, 6);
            out.extend(15u32.to_le_bytes());
            out.extend((packed.len() as u32).to_le_bytes());
            out.extend(packed);
        } else {
            out.extend(variable);
        }
    }
    out
}
