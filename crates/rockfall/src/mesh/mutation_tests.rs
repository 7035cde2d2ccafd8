//! Random changes of small files. No bytes may make a reader panic or return an invalid mesh.

use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64Mcg;

use super::file_tests::samples;
use super::{Mesh, MeshFormat};

/// Number of changed files of each format.
const CASES: u64 = 20_000;

/// Words and bytes that matter to a reader.
const WORDS: [&[u8]; 20] = [
    b"-1",
    b"0",
    b"nan",
    b"1e39",
    b"4294967296",
    b"-9223372036854775808",
    b"99999999999999999999",
    b"/",
    b"\\\n",
    b"\r",
    b"\n",
    b"f ",
    b"solid",
    b"endsolid",
    b"list uchar int",
    b"element face ",
    b"double",
    b"\xff\xff\xff\xff",
    b"\0\0\0\0",
    b"\0\0\x80\x7f",
];

fn change(bytes: &mut Vec<u8>, other: &[u8], random: &mut Pcg64Mcg) {
    let at = random.random_range(0..=bytes.len());
    let end = random.random_range(at..=bytes.len().min(at + 40));
    match random.random_range(0..8) {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(at..end)),
        2 => bytes.extend_from_within(at..end),
        3 => {
            let copy = bytes[at..end].to_vec();
            bytes.splice(at..at, copy);
        }
        4 => {
            let word = WORDS[random.random_range(0..WORDS.len())];
            let end = if random.random() { at } else { bytes.len().min(at + word.len()) };
            bytes.splice(at..end, word.iter().copied());
        }
        5 => {
            let from = random.random_range(0..=other.len());
            let to = random.random_range(from..=other.len().min(from + 40));
            bytes.splice(at..end, other[from..to].iter().copied());
        }
        6 => bytes[at..end].fill_with(|| random.random()),
        _ => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << random.random_range(0..8)),
    }
}

/// Reads the bytes. Returns whether they were accepted.
fn check(bytes: &[u8], format: MeshFormat) -> bool {
    match Mesh::parse(bytes, format) {
        Ok(mesh) => {
            assert_eq!(Mesh::parse(&mesh.to_stl(), MeshFormat::Stl).unwrap(), Mesh { left_out: 0, ..mesh.clone() });
            assert!(mesh.area() > 0.0 && mesh.volume().is_finite());
            true
        }
        Err(error) => {
            let message = error.to_string();
            assert!(message.len() < 400 && !message.contains(char::is_control), "{message:?}");
            false
        }
    }
}

#[test]
fn changed_files_are_read_or_refused() {
    for format in MeshFormat::ALL {
        let samples: Vec<_> = samples().into_iter().filter(|sample| sample.1 == format).map(|sample| sample.2).collect();
        let mut accepted = 0;
        for seed in 0..CASES {
            let mut random = Pcg64Mcg::seed_from_u64(seed);
            let mut bytes = samples[random.random_range(0..samples.len())].clone();
            let other = &samples[random.random_range(0..samples.len())];
            for _ in 0..random.random_range(1..=4) {
                change(&mut bytes, other, &mut random);
            }
            accepted += u64::from(check(&bytes, format));
        }
        assert!(accepted > CASES / 50 && accepted < CASES * 9 / 10, "{accepted} of {format:?}");
    }
}

/// Small files of random bytes after the first ones of a file.
#[test]
fn random_bytes_are_refused() {
    for format in MeshFormat::ALL {
        for (seed, (_, _, sample)) in samples().into_iter().cycle().take(2_000).enumerate() {
            let mut random = Pcg64Mcg::seed_from_u64(seed as u64);
            let mut bytes = sample[..random.random_range(0..=sample.len())].to_vec();
            bytes.extend((0..random.random_range(0..200)).map(|_| random.random::<u8>()));
            check(&bytes, format);
        }
    }
}
