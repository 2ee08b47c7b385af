//! The bytes themselves. Where one of these fails, hosts and devices built before no longer understand those built
//! now: raise `VERSION`, and only then write the new bytes here.

use core::fmt::Debug;

use pliant_protocol::model::{MODEL_MAX, Model};
use pliant_protocol::{FRAME_MAX, Frame, SCHEMA, VERSION, decode, encode};
use serde::{Serialize, de::DeserializeOwned};

use crate::examples;

const TO_DEVICE: [&str; 20] = [
    "01010000ef9bafcdf8acd191017cfdff7e",
    "01020001e709effdb6f50d66ac4912",
    "01030002c001030100fff01521a1",
    "0104000391b6ac18",
    "010500040000c3f5483f8fc2f53c0000003f010000004000008040cdcc4c3ecdcc4c3d0000803f010000003f58921cbc",
    "0106000400010000803f8fc2f53c0000003f0000008040cdcc4c3ecdcc4c3d0000803f0090f2bdd2",
    "01070005ac02c0843dcdcc4c3e3d0a573eae47613e0000003f000000bf0000003f000000bf000ad7233dcdcc4c3d8fc2753d03000000c03f00\
     00a03f0000903fcdcc8c3f9a99993f6666a63f0ad7233c0ad7a3bc8fc2f53ccdccccbdcdcc4c3e9a9999be3333333fcdcc4c3f6666663f0ad7\
     23bde534f50e",
    "01080006ac027d21211a",
    "010900072f29f8dc",
    "010a0008a88c3da470bd3e85ebd13e000000bf2e90c6d0",
    "010b00090089a8b367",
    "010c0009014093d88c",
    "010d000ae6c10efd",
    "010e000b96824be5",
    "010f000c90943d108001cdcc4c3d02cdcccc3dcdcc4c3e9a99993ecdccccbdcdcc4cbe9a9999bec007742e",
    "0110000df89b3d0000003f0000803e0000003ecdccccbdcdcc4c3e9a9999be601bed15",
    "011100050102cdcc4c3e3d0a573eae47613e0000003f000000bf0000003f000000bf010ad7233dcdcc4c3d8fc2753d0ad7233c010000c03f00\
     00a03f0000903fcdcc8c3f9a99993f6666a63f0ad7233c0ad7a3bc8fc2f53ccdccccbdcdcc4c3e9a9999be3333333fcdcc4c3f6666663f0ad7\
     23bd70d36a61",
    "011200050102cdcc4c3e3d0a573eae47613e0000003f000000bf0000003f000000bf020ad7233dcdcc4c3d0ad7233c010000c03f0000a03f00\
     00903fcdcc8c3f9a99993f6666a63f0ad7233c0ad7a3bc8fc2f53ccdccccbdcdcc4c3e9a9999be3333333fcdcc4c3f6666663f0ad723bdba1d\
     b8eb",
    "011300050102cdcc4c3e3d0a573eae47613e0000003f000000bf0000003f000000bf030ad7233dcdcc4c3d010000c03f0000a03f0000903fcd\
     cc8c3f9a99993f6666a63f0ad7233c0ad7a3bc8fc2f53ccdccccbdcdcc4c3e9a9999be3333333fcdcc4c3f6666663f0ad723bdd45f875f",
    "011400050102cdcc4c3e3d0a573eae47613e0000003f000000bf0000003f000000bf0403cdcccc3d000000008fc275bd0ad7a33d0ad7a3bc8f\
     c2f5bc010000c03f0000a03f0000903fcdcc8c3f9a99993f6666a63f0ad7233c0ad7a3bc8fc2f53ccdccccbdcdcc4c3e9a9999be3333333fcd\
     cc4c3f6666663f0ad723bdd62aba0c",
];

const TO_HOST: [&str; 5] = [
    "01010000ef9bafcdf8acd191010001020a6d7073322d616e333836e807100feeb95005",
    "010200018202f0a2040336ca2ea5",
    "01030002830206c8ce0b38",
    "01040003f0a2048104030000803e000000be0000003f0000e03f01ac020112028bf6b98f",
    "010500040102030405060708090a0b99105288",
];

const MODELS: [&str; 2] = [
    "02000000003f0000803e0000000000000040",
    "03010000003f0000803e0000003e0000803fcdcccc3dcdcc4c3e000000409a99993e00004040\
     010000c0bfcdcccc3dcdcc4c3e9a99993e0000803f0000004000004040000080400000a0400000c040\
     000080bf000000c0000040c0000080c00000a0c00000c0c00000e0c0000000c1000010c1",
];

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len()).step_by(2).map(|i| u8::from_str_radix(&hex[i..i + 2], 16).unwrap()).collect()
}

fn is_golden<M: Serialize + DeserializeOwned + PartialEq + Debug + Clone>(messages: &[M], golden: &[&str]) {
    assert_eq!(messages.len(), golden.len());
    for (sequence, (message, golden)) in (1..).zip(messages.iter().zip(golden)) {
        let mut room = [0; FRAME_MAX];
        assert_eq!(hex(encode(sequence, message, &mut room).unwrap()), *golden, "{message:?}");
        assert_eq!(decode(&bytes(golden)), Ok(Frame { sequence, message: message.clone() }));
    }
}

#[test]
fn frames_are_the_bytes_they_always_were() {
    is_golden(&examples::to_device(), &TO_DEVICE);
    is_golden(&examples::to_host(), &TO_HOST);
}

#[test]
fn models_are_the_bytes_they_always_were() {
    for (model, golden) in examples::models().iter().zip(MODELS) {
        assert_eq!(hex(model.to_bytes(&mut [0; MODEL_MAX]).unwrap()), golden);
        assert_eq!(Model::from_bytes(&bytes(golden)).as_ref(), Ok(model));
    }
}

#[test]
fn variants_keep_their_numbers() {
    fn encoded<M: Serialize>(variants: &[M]) -> Vec<String> {
        variants.iter().map(|v| hex(postcard::to_slice(v, &mut [0; 32]).unwrap())).collect()
    }
    let counted = |n: usize| (0..n).map(|i| format!("{i:02x}")).collect::<Vec<_>>();
    assert_eq!(encoded(&examples::FIELDS), counted(31));
    assert_eq!(encoded(&examples::REGIONS), counted(4));
    assert_eq!(encoded(&examples::UPLOAD_ERRORS), counted(6));
    assert_eq!(encoded(&examples::MODES), ["00", "01", "02", "03", "0400", "0401", "0402"]);
    assert_eq!(
        encoded(&examples::DEVICE_ERRORS),
        [
            "00ef9bafcdf8acd19101",
            "010001",
            "0101",
            "0102",
            "020402",
            "0300",
            "0417",
            "05",
            "06",
            "07",
            "08",
            "0905",
            "0a00",
            "0a010f",
            "0b",
            "0c00ac02",
            "0c018001",
        ]
    );
}

#[test]
fn the_schema_is_the_one_of_this_version() {
    assert_eq!(VERSION, 1);
    assert_eq!(SCHEMA, 0x158d_8647_97c6_6aa2);
}
