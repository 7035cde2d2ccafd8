//! Runs the corpus of the fuzz targets (docs/fuzzing.md) through the code that the fuzzer calls, so that errors it
//! found do not return.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

#[allow(unreachable_pub, reason = "public for the fuzzer")]
#[path = "../../../../fuzz/src/lib.rs"]
pub(crate) mod targets;

/// Limit for one case. A case takes some milliseconds; one that hangs would take far longer.
const LONGEST: Duration = Duration::from_secs(60);

/// The files of a corpus, by name.
pub(crate) fn corpus(target: &str) -> BTreeMap<String, Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(target);
    let files = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let read = |entry: fs::DirEntry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap());
    files.map(|entry| read(entry.unwrap())).collect()
}

fn replay(target: &str, least: usize, entry: fn(&[u8])) {
    let corpus = corpus(target);
    assert!(corpus.len() >= least, "only {} files", corpus.len());
    for (name, bytes) in corpus {
        // Printed with the panic of a case that fails.
        println!("fuzz/corpus/{target}/{name}");
        let start = Instant::now();
        entry(&bytes);
        assert!(start.elapsed() < LONGEST, "{:?}", start.elapsed());
    }
}

#[test]
fn the_corpus_of_checkpoints_passes() {
    replay("checkpoint_file", 10, targets::checkpoint_file);
}

#[test]
fn the_corpus_of_laws_passes() {
    replay("law_text", 10, targets::law_text);
}

#[test]
fn the_corpus_of_meshes_passes() {
    replay("mesh", 20, targets::mesh);
}

#[test]
fn the_corpus_of_scene_texts_passes() {
    replay("scene_text", 50, targets::scene_text);
}

#[test]
fn the_corpus_of_files_of_worlds_passes() {
    replay("worlds_file", 20, targets::worlds_file);
}

#[test]
fn the_corpus_of_motions_passes() {
    replay("motion", 50, targets::motion);
}
