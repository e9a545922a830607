//! ZIP archives, as numpy.savez writes them.
#![allow(dead_code, unreachable_pub, reason = "each test binary includes this file and uses its own part")]

/// How entries are packed.
#[derive(Clone, Copy)]
pub enum Packed {
    Stored,
    Deflated,
}

/// CRC-32, bit by bit.
pub fn crc(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for &byte in bytes {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = crc >> 1 ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 };
        }
    }
    !crc
}

/// An archive of files with these names.
pub fn zip(files: &[(&str, &[u8])], packed: Packed) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, file) in files {
        let (method, data) = match packed {
            Packed::Stored => (0_u16, file.to_vec()),
            Packed::Deflated => (8, miniz_oxide::deflate::compress_to_vec(file, 6)),
        };
        let sizes = [crc(file), data.len() as u32, file.len() as u32];
        let common = [
            &20_u16.to_le_bytes()[..],
            &[0; 2],
            &method.to_le_bytes(),
            &[0, 0, 0x21, 0],
            &sizes.iter().flat_map(|size| size.to_le_bytes()).collect::<Vec<_>>(),
            &(name.len() as u16).to_le_bytes(),
            &[0; 2],
        ]
        .concat();
        let at = bytes.len() as u32;
        bytes.extend([&b"PK\x03\x04"[..], &common, name.as_bytes(), &data].concat());
        let rest = [&[0; 10][..], &at.to_le_bytes(), name.as_bytes()].concat();
        directory.extend([&b"PK\x01\x02\x14\x00"[..], &common, &rest].concat());
    }
    let count = (files.len() as u16).to_le_bytes();
    let place = [(directory.len() as u32).to_le_bytes(), (bytes.len() as u32).to_le_bytes()].concat();
    bytes.extend([&directory[..], b"PK\x05\x06\0\0\0\0", &count, &count, &place, &[0; 2]].concat());
    bytes
}
