//! Runs the corpus of the fuzz target `robot` (docs/fuzzing.md), and shakes it.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

#[allow(unreachable_pub, reason = "public for the fuzzer")]
#[path = "../../../../fuzz/src/robot.rs"]
mod target;

/// Limit for one case.
const LONGEST: Duration = Duration::from_secs(30);

fn corpus() -> BTreeMap<String, Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/robot");
    let files = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let read = |entry: std::fs::DirEntry| (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap());
    files.map(|entry| read(entry.unwrap())).collect()
}

#[test]
fn the_corpus_of_robots_passes() {
    let corpus = corpus();
    assert!(corpus.len() >= 10, "only {} files", corpus.len());
    for (name, bytes) in corpus {
        println!("fuzz/corpus/robot/{name}");
        let start = Instant::now();
        target::robot(&bytes);
        assert!(start.elapsed() < LONGEST, "{:?}", start.elapsed());
    }
}

/// What replaces a word: numbers at the ends of their ranges, names, and what is no XML.
const WORDS: [&str; 24] = [
    "-1", "0", "1", "1e15", "-1e15", "1e-30", "1e300", "NaN", "", "a", "b", "world", "1 1 1", "0 0 1", "-0.0", "<body>",
    "</body>", "\"", "free", "ball", "slide", "true", "\u{1}", "ä",
];

/// Changes of the corpus for `ROCKFALL_FUZZ=SECONDS,SEED` without a measure of coverage. The input that fails is printed.
#[test]
#[ignore = "as long as it is told"]
fn shaken() {
    let told = std::env::var("ROCKFALL_FUZZ").unwrap_or_default();
    let mut numbers = told.split(',').map(|word| word.parse::<u64>().unwrap_or(1));
    let (seconds, mut seed) = (numbers.next().unwrap_or(1), numbers.next().unwrap_or(1));
    let mut random = move |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below.max(1)
    };
    let corpus: Vec<Vec<u8>> = corpus().into_values().collect();
    let (start, mut runs, mut accepted, mut slowest) = (Instant::now(), 0_u64, 0_u64, Duration::ZERO);
    while start.elapsed() < Duration::from_secs(seconds) {
        let mut text = String::from_utf8_lossy(&corpus[random(corpus.len())]).into_owned();
        let other = String::from_utf8_lossy(&corpus[random(corpus.len())]).into_owned();
        for _ in 0..1 + random(6) {
            let ends: Vec<usize> = text.match_indices(['"', ' ', '<', '>', '=']).map(|(at, _)| at).collect();
            let Some(pair) = ends.windows(2).nth(random(ends.len().saturating_sub(1))).map(|pair| pair[0] + 1..pair[1]) else {
                break;
            };
            match random(30) {
                26 => text = format!("{}{}{}", &text[..pair.start], &text[pair.clone()], &text[pair.start..]),
                27 => text.replace_range(pair, ""),
                28 | 29 => {
                    // An element of another robot.
                    let starts: Vec<usize> = other.match_indices('<').map(|(at, _)| at).collect();
                    let from = starts.get(random(starts.len())).copied().unwrap_or(0);
                    let to = other[from..].find('>').map_or(other.len(), |end| from + end + 1);
                    let at = text[..pair.start].rfind('<').unwrap_or(0);
                    text.insert_str(at, &other[from..to]);
                }
                word => text.replace_range(pair, WORDS[word % WORDS.len()]),
            }
        }
        let began = Instant::now();
        let ended = std::panic::catch_unwind(|| target::robot(text.as_bytes()));
        assert!(ended.is_ok(), "{text}");
        slowest = slowest.max(began.elapsed());
        assert!(began.elapsed() < LONGEST, "{:?}: {text}", began.elapsed());
        accepted += u64::from(rockfall_import::parse(&text, "nowhere/robot.xml").is_ok());
        runs += 1;
    }
    eprintln!("{runs} runs, {accepted} accepted, the slowest {slowest:?}");
}
