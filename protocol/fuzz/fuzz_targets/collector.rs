//! A serial line of any bytes, against a second, plainer reading of it: cut at zeros, unstuff each part whole.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pliant_protocol::serial::stuff;
use pliant_protocol::{Collector, FRAME_MAX, SERIAL_MAX, ToDevice, decode, encode};

/// One part of the line without its zero; none where it promises more bytes than it has.
fn unstuffed(mut part: &[u8]) -> Option<Vec<u8>> {
    let mut frame = Vec::new();
    while let Some((&code, rest)) = part.split_first() {
        let run = usize::from(code) - 1;
        frame.extend_from_slice(rest.get(..run)?);
        part = &rest[run..];
        if code < 255 && !part.is_empty() {
            frame.push(0);
        }
    }
    Some(frame)
}

fuzz_target!(|data: &[u8]| {
    let mut collector = Collector::new();
    let seen: Vec<_> = data.iter().filter_map(|byte| collector.push(*byte).map(<[u8]>::to_vec)).collect();

    let mut parts: Vec<_> = data.split(|byte| *byte == 0).collect();
    parts.pop(); // not ended yet
    parts.retain(|part| !part.is_empty());
    let expected: Vec<_> = parts.iter().filter_map(|part| unstuffed(part)).filter(|f| f.len() <= FRAME_MAX).collect();
    assert_eq!(seen, expected);
    let passed_over = collector.overruns() + collector.malformed();
    assert_eq!(passed_over as usize, parts.len() - expected.len());

    let (mut frame, mut line) = ([0; FRAME_MAX], [0; SERIAL_MAX]);
    let frame = encode(1, &ToDevice::Stop, &mut frame).expect("a stop fits");
    let line = stuff(frame, &mut line).expect("a frame fits");
    collector.push(0);
    let last = line.iter().find_map(|byte| collector.push(*byte).map(decode::<ToDevice>));
    assert_eq!(last.map(|frame| frame.map(|f| f.message)), Some(Ok(ToDevice::Stop)));
});
