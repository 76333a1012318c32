//! The identifier in a file's header, made from the content.
//!
//! OpenVDB gives each file a random UUID, so that the same band would never be the same bytes
//! twice. Here a file gets a UUID of version 8 ("custom", RFC 9562) that is the hash of all its
//! other bytes. Since the format has no check sums, and OpenVDB trusts what it reads, the hash also
//! tells a damaged file before it is read.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// First byte of the UUID, which is text: after magic (8), format (4), library (8), has-offsets
/// (1).
const START: usize = 21;
const LENGTH: usize = 36;
/// The digit of the text that is the UUID's version, and what this module writes there.
const VERSION: usize = 14;
const OURS: u8 = b'8';

/// Bytes hashed at a time; a multiple of 16, and more than the header.
const CHUNK: usize = 1 << 16;

/// Replaces the UUID of a file by the hash of its content.
pub(super) fn stamp(path: &Path) -> io::Result<()> {
    let mut file = OpenOptions::new().read(true).write(true).open(path)?;
    let (found, hash) = scan(&mut file)?;
    if is_uuid(&found) {
        file.seek(SeekFrom::Start(START as u64))?;
        file.write_all(&uuid(hash))?;
    }
    Ok(())
}

/// Whether the content of a file is what was written. Files of other programs are taken on trust.
pub(super) fn is_intact(path: &Path) -> io::Result<bool> {
    let mut file = File::open(path)?;
    let mut head = Vec::new();
    (&mut file).take((START + LENGTH) as u64).read_to_end(&mut head)?;
    if head.get(START + VERSION) != Some(&OURS) {
        return Ok(true);
    }
    file.rewind()?;
    let (found, hash) = scan(&mut file)?;
    Ok(found == uuid(hash))
}

/// The text in the place of the UUID, and the hash of everything else.
fn scan(file: &mut File) -> io::Result<([u8; LENGTH], u128)> {
    let mut found = [0; LENGTH];
    let mut hash = Hash::default();
    let mut chunk = Vec::with_capacity(CHUNK);
    for number in 0.. {
        chunk.clear();
        file.take(CHUNK as u64).read_to_end(&mut chunk)?;
        if number == 0
            && let Some(place) = chunk.get_mut(START..START + LENGTH)
        {
            found.copy_from_slice(place);
            place.fill(0);
        }
        hash.add(&chunk);
        if chunk.len() < CHUNK {
            break;
        }
    }
    Ok((found, hash.finish()))
}

fn is_uuid(text: &[u8; LENGTH]) -> bool {
    text.iter().enumerate().all(|(n, c)| match n {
        8 | 13 | 18 | 23 => *c == b'-',
        _ => c.is_ascii_hexdigit(),
    })
}

/// The text of the UUID made of 122 bits of a hash, with version 8 and the variant of the RFC.
fn uuid(hash: u128) -> [u8; LENGTH] {
    let bits = hash & !(0xf << 76) & !(0x3 << 62) | 0x8 << 76 | 0x2 << 62;
    let digits = format!("{bits:032x}");
    let parts = [&digits[..8], &digits[8..12], &digits[12..16], &digits[16..20], &digits[20..]];
    parts.join("-").into_bytes().try_into().expect("32 digits and 4 hyphens")
}

/// A quick hash for telling contents apart; nobody is kept from making two files of the same hash.
#[derive(Default)]
struct Hash {
    lanes: [u64; 2],
    length: u64,
}

impl Hash {
    /// Odd numbers with bits all over (the fractions of the golden ratio and of the root of 3), so
    /// that each bit of a word reaches the bits above it, and the rotation those below.
    const FACTORS: [u64; 2] = [0x9e37_79b9_7f4a_7c15, 0xbb67_ae85_84ca_a73b];

    fn add(&mut self, bytes: &[u8]) {
        self.length += bytes.len() as u64;
        let (whole, rest) = bytes.as_chunks::<16>();
        let mut last = [0; 16];
        last[..rest.len()].copy_from_slice(rest);
        for block in whole.iter().chain(std::iter::once(&last)) {
            for (n, word) in block.as_chunks::<8>().0.iter().enumerate() {
                let mixed = (self.lanes[n] ^ u64::from_le_bytes(*word)).wrapping_mul(Self::FACTORS[n]);
                self.lanes[n] = mixed ^ mixed.rotate_left(29);
            }
        }
    }

    fn finish(mut self) -> u128 {
        let length = self.length;
        self.add(&length.to_le_bytes());
        // Both lanes in both halves.
        let [a, b] = self.lanes;
        let low = (a ^ b.rotate_left(32)).wrapping_mul(Self::FACTORS[0]);
        let high = (b ^ low.rotate_left(32)).wrapping_mul(Self::FACTORS[1]);
        u128::from(high) << 64 | u128::from(low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(rest: &[u8]) -> Vec<u8> {
        let mut bytes = vec![7; START];
        bytes.extend(b"26b71811-f7cc-4605-8ac2-eddc0a82b002");
        bytes.extend(rest);
        bytes
    }

    #[test]
    fn every_changed_byte_is_noticed() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("file");
        std::fs::write(&path, header(&[1; 300])).unwrap();
        assert!(is_intact(&path).unwrap(), "a file of another program");
        stamp(&path).unwrap();
        let stamped = std::fs::read(&path).unwrap();
        assert!(is_intact(&path).unwrap());
        assert!(is_uuid(stamped[START..START + LENGTH].try_into().unwrap()));
        for n in (0..stamped.len()).filter(|&n| n != START + VERSION) {
            let mut changed = stamped.clone();
            changed[n] ^= 0x40;
            std::fs::write(&path, changed).unwrap();
            assert!(!is_intact(&path).unwrap(), "byte {n}");
            if n >= START + LENGTH {
                std::fs::write(&path, &stamped[..n]).unwrap();
                assert!(!is_intact(&path).unwrap(), "end {n}");
            }
        }
    }

    #[test]
    fn the_same_content_gets_the_same_stamp() {
        let dir = tempfile::tempdir().unwrap();
        let stamped = |uuid_digit: u8, content: u8| {
            let path = dir.path().join("file");
            let mut bytes = header(&vec![content; 3 * CHUNK]);
            bytes[START] = uuid_digit;
            std::fs::write(&path, bytes).unwrap();
            stamp(&path).unwrap();
            std::fs::read(&path).unwrap()
        };
        assert_eq!(stamped(b'1', 0), stamped(b'f', 0));
        assert_ne!(stamped(b'1', 0)[START..START + LENGTH], stamped(b'1', 1)[START..START + LENGTH]);
    }

    #[test]
    fn what_has_no_identifier_is_left_alone() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("file");
        for content in [vec![], vec![1; 30], vec![b'x'; 100]] {
            std::fs::write(&path, &content).unwrap();
            stamp(&path).unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), content);
        }
    }
}
