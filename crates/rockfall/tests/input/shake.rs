//! A plain loop in place of a fuzzer: changed files of the corpus and random bytes, without a measure of what they cover.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64Mcg;

use crate::fuzz::{corpus, targets};

/// Words that replace others in a text.
const WORDS: &[&str] = &[
    "0",
    "-0",
    "1",
    "-1",
    "0.5",
    "2",
    "10",
    "1e-3",
    "1e-10",
    "1e-30",
    "1e-45",
    "1e10",
    "1e18",
    "1e30",
    "3.4e38",
    "-3.4e38",
    "nan",
    "inf",
    "-",
    "x",
    "4294967296",
    "mass=1",
    "density=2",
    "fixed=1",
    "at=0,0.5,0",
    "at=1e30,0,0",
    "spin=0,1,0",
    "spin=1e30,0,1e30",
    "velocity=0,-9,0",
    "velocity=1e38,0,0",
    "turn=40",
    "axis=1,2,3",
    "centre=0,0,0",
    "inertia=1,1,1,0,0,0",
    "rounding=0.1",
    "0,0,0",
    "1,0,0",
    "0,1,0",
    "0,0,1",
    "1,1,1",
    "0.5,0.5,0.5",
    "1e15,0,0",
    "0,1e-20,0",
    "world",
    "at=0,1,0",
    "to=0,2,0",
    "limits=-1e30..1e30",
    "speed=1e30",
    "force=0",
];

/// Lines that are put in.
const LINES: &[&str] = &[
    "set contact_law rigid",
    "set gravity 9.81",
    "set restitution 1",
    "set coulomb_friction 1e30",
    "@run dt=0.01",
    "@run dt=1e30",
    "@run substeps=1",
    "@group 3",
    "@body b mass=1",
    "@body h density=1",
    "@end",
    "@hull 0,0,0 1,0,0 0,1,0 0,0,1",
    "B -0.5 -0.5 -0.5 1 0 0 0 1 0 0 0 1",
    "S 1 0 0.4 0 0 -1 0 0 0 0 1 0.5",
    "S 2 0.3 0.9 0 0 0 0 0 0 0 - 0.5 0",
    "C -0.5 0 0 0.5 0 0 0 0 0 1 0.3",
    "P -5 0 -5 0 0 10 10 0 0",
    "@plane at=0,0,0 normal=0,1,0",
    "@place b at=0,0.4,0",
    "@place h at=0,0.2,0",
    "@place b at=0.2,0.9,0 fixed=1",
    "@place h at=0,1,0 spin=1,2,3",
    "@force 1 0 1e30 0",
    "@joint hinge 1 world at=0,0.4,0 axis=0,0,1 limits=-30..40",
    "@joint ball 1 2 at=0,0.6,0 cone=20 twist=-5..5",
    "@joint distance 2 world at=0,1,0 to=0,3,0 stiffness=1e30",
    "@joint slider world 1 frame_a=0,0,0,1,0,0,0 frame_b=0,0,0,1,0,0,0 speed=1 force=2",
    "@material m",
    "@pair m m restitution=1 friction=0",
    "@use m",
];

fn any<'a, T: ?Sized>(random: &mut Pcg64Mcg, of: &[&'a T]) -> &'a T {
    of[random.random_range(0..of.len())]
}

fn shaken_text(seed: &[u8], random: &mut Pcg64Mcg) -> Vec<u8> {
    let text = String::from_utf8_lossy(seed).into_owned();
    let mut lines: Vec<Vec<String>> = text.lines().map(|line| line.split(' ').map(str::to_owned).collect()).take(60).collect();
    for _ in 0..random.random_range(1..8) {
        let at = random.random_range(0..=lines.len());
        match random.random_range(0..5) {
            0 => lines.insert(at, vec![any(random, LINES).to_owned()]),
            1 if at < lines.len() => drop(lines.remove(at)),
            2 if at < lines.len() => {
                let line = lines[at].clone();
                lines.insert(random.random_range(0..=lines.len()), line);
            }
            _ if at < lines.len() => {
                let word = random.random_range(0..lines[at].len());
                lines[at][word] = any(random, WORDS).to_owned();
            }
            _ => {}
        }
    }
    lines.iter().map(|line| line.join(" ") + "\n").collect::<String>().into_bytes()
}

/// Bytes of a case of a target.
fn shaken(target: &str, seeds: &[Vec<u8>], random: &mut Pcg64Mcg) -> Vec<u8> {
    let seed = &seeds[random.random_range(0..seeds.len())];
    if target == "scene_text" {
        return shaken_text(seed, random);
    }
    let fresh = random.random_range(0..2) == 0;
    let mut bytes = if fresh { (0..random.random_range(8..900)).map(|_| random.random()).collect() } else { seed.clone() };
    for _ in 0..if fresh { 0 } else { random.random_range(1..6) } {
        let at = random.random_range(0..=bytes.len());
        match random.random_range(0..4) {
            0 => bytes.insert(at, random.random()),
            1 if at < bytes.len() => drop(bytes.remove(at)),
            2 => bytes.extend((0..random.random_range(1..40)).map(|_| random.random::<u8>())),
            _ if at < bytes.len() => bytes[at] = random.random(),
            _ => {}
        }
    }
    if let Some(first) = bytes.first_mut().filter(|_| fresh) {
        // Cases and files of the law `rigid`.
        *first |= if target == "motion" { 8 } else { 192 };
    }
    bytes
}

/// `ROCKFALL_FUZZ=motion,60,7 cargo test -p rockfall --test input shaken -- --ignored --nocapture` shakes `motion` for 60 seconds,
/// with 7 as the seed. `fuzz/artifacts` has the case that runs, and the one that took longest.
#[test]
#[ignore = "takes as long as asked for"]
fn a_shaken_corpus_passes() {
    let asked = std::env::var("ROCKFALL_FUZZ").expect("ROCKFALL_FUZZ=target,seconds,seed");
    let [target, seconds, seed]: [&str; 3] = asked.split(',').collect::<Vec<_>>().try_into().expect("target,seconds,seed");
    let (seconds, seed) = (seconds.parse().expect("seconds"), seed.parse().expect("a seed"));
    let entry: fn(&[u8]) = match target {
        "motion" => targets::motion,
        "scene_text" => targets::scene_text,
        "checkpoint_file" => targets::checkpoint_file,
        _ => panic!("{target}"),
    };
    let seeds: Vec<Vec<u8>> = corpus(target).into_values().collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/artifacts");
    fs::create_dir_all(&folder).unwrap();
    let running = folder.join(format!("{target}-{seed}"));
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let (start, mut runs, mut longest) = (Instant::now(), 0, Duration::ZERO);
    while start.elapsed() < Duration::from_secs(seconds) {
        let bytes = shaken(target, &seeds, &mut random);
        fs::write(&running, &bytes).unwrap();
        let before = Instant::now();
        entry(&bytes);
        if before.elapsed() > longest {
            longest = before.elapsed();
            fs::copy(&running, folder.join(format!("{target}-{seed}-longest"))).unwrap();
        }
        runs += 1;
    }
    println!("{runs} runs, the longest {longest:?}");
}
