//! Verdicts on kernels with a mistake, kept in files of the repository (`tests/verdicts`).
//!
//! Software Vulkan needs seconds to compile a kernel, and there are hundreds of broken ones. That a comparison rejects one of them
//! depends on its text, on the input, on what is expected, and on the code that compares. A [`Key`] is a hash of all of these. A
//! broken kernel whose key is in the file was rejected before, so it is not run again. A kernel with an unknown key is run.
//!
//! `ROCKFALL_VERDICTS=all` runs every kernel and does not read the files. `ROCKFALL_VERDICTS=record` runs those with unknown keys
//! and writes the files anew, and `ROCKFALL_VERDICTS=list` prints their names and runs none. Without any of them, a test runs kernels
//! with unknown keys for [`MOST_TIME`] and leaves the rest to such a run: after a change of shared WGSL nearly all keys are unknown.
//! A line that begins with "note:" says how many are left.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time after which a test runs no further broken kernels.
const MOST_TIME: Duration = Duration::from_secs(300);

/// A hash that is the same on every machine and with every compiler.
#[derive(Clone, Copy)]
pub(crate) struct Key(u64);

impl Key {
    /// The key of the code that comes to a verdict. A list of mistakes in a file (from `static MISTAKES` to the end of the array)
    /// is left out, so that another mistake in it changes no verdict on the others.
    pub(crate) fn of_code(files: &[&str]) -> Self {
        let mut key = Self(0);
        for file in files {
            let (code, rest) = file.split_once("static MISTAKES").unwrap_or((file, ""));
            key.add(code);
            key.add(rest.split_once("\n];\n").map_or(rest, |(_, code)| code));
        }
        key
    }

    fn add_word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 ^= self.0 >> 29;
    }

    pub(crate) fn add(&mut self, bytes: impl AsRef<[u8]>) {
        let bytes = bytes.as_ref();
        self.add_word(bytes.len() as u64);
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.add_word(u64::from_le_bytes(word));
        }
    }

    pub(crate) fn value(self) -> u64 {
        self.0
    }
}

#[derive(PartialEq, Eq)]
enum Mode {
    Unknown,
    All,
    Record,
    List,
}

/// The verdicts of one test.
pub(crate) struct Verdicts {
    test: &'static str,
    mode: Mode,
    /// The keys in the file, by what they are of.
    known: BTreeMap<String, u64>,
    /// Those of this run.
    rejected: Mutex<BTreeMap<String, u64>>,
    run: AtomicUsize,
    left: AtomicUsize,
    begun: Instant,
}

impl Verdicts {
    /// Reads the file of a test.
    pub(crate) fn of(test: &'static str) -> Self {
        let mode = match std::env::var("ROCKFALL_VERDICTS").as_deref() {
            Err(_) => Mode::Unknown,
            Ok("all") => Mode::All,
            Ok("record") => Mode::Record,
            Ok("list") => Mode::List,
            Ok(other) => panic!("ROCKFALL_VERDICTS is {other}, expected all, record or list"),
        };
        let text = if mode == Mode::All { String::new() } else { std::fs::read_to_string(path(test)).unwrap_or_default() };
        let verdict = |line: &str| {
            let (key, what) = line.split_once(' ')?;
            Some((what.to_owned(), u64::from_str_radix(key, 16).ok()?))
        };
        let known = text.lines().map(|line| verdict(line).unwrap_or_else(|| panic!("{}: {line}", path(test).display())));
        let known = known.collect();
        Self {
            test,
            mode,
            known,
            rejected: Mutex::default(),
            run: AtomicUsize::new(0),
            left: AtomicUsize::new(0),
            begun: Instant::now(),
        }
    }

    /// Number of threads that may run broken kernels, each with a device of its own.
    #[allow(dead_code, reason = "the worlds are run one after the other")]
    pub(crate) fn threads(&self) -> usize {
        if self.mode != Mode::Record {
            return 2;
        }
        std::thread::available_parallelism().map_or(2, |cores| cores.get().clamp(2, 12))
    }

    /// Whether one of the trials rejects the kernel, in this run or in the one that wrote the file. `what` names the mistake. Also true
    /// for a kernel that is left to another run.
    pub(crate) fn rejects<T>(
        &self,
        what: &str,
        trials: impl Iterator<Item = T> + Clone,
        key: impl Fn(&T) -> u64,
        mut rejects: impl FnMut(&T) -> bool,
    ) -> bool {
        let what = what.replace('\n', " ");
        let known = self.known.get(&what).and_then(|known| trials.clone().map(|trial| key(&trial)).find(|key| key == known));
        let is_late = self.mode == Mode::Unknown && self.begun.elapsed() > MOST_TIME;
        if known.is_none() && (is_late || self.mode == Mode::List) {
            self.left.fetch_add(1, Ordering::Relaxed);
            if self.mode == Mode::List {
                println!("unknown: {what}");
            }
            return true;
        }
        let found = known.or_else(|| {
            self.run.fetch_add(1, Ordering::Relaxed);
            trials.clone().find(|trial| rejects(trial)).map(|trial| key(&trial))
        });
        if let Some(key) = found {
            let mut rejected = self.rejected.lock().unwrap_or_else(PoisonError::into_inner);
            rejected.insert(what, key);
            if self.mode == Mode::Record && known.is_none() {
                // At once, so that nothing is lost when a long run is ended.
                let mut all = self.known.clone();
                all.extend(rejected.clone());
                write(self.test, &all);
            }
        }
        found.is_some()
    }

    /// Says how many kernels were run, and writes the file if it is to be recorded.
    pub(crate) fn finish(self) {
        let (rejected, run) = (self.rejected.into_inner().unwrap_or_else(PoisonError::into_inner), self.run.into_inner());
        let known = rejected.len().saturating_sub(run);
        // Past the capture of the output of tests. `scripts/run-tests` prints lines that begin with "note:".
        let mut note = format!("note: {}: {run} broken kernels run, {known} known to be rejected\n", self.test);
        let left = self.left.into_inner();
        if left > 0 {
            note += &format!(
                "note: {}: {left} broken kernels NOT run; ROCKFALL_VERDICTS=record runs and records them\n",
                self.test
            );
        }
        std::io::stderr().write_all(note.as_bytes()).expect("standard error");
        if self.mode == Mode::Record {
            write(self.test, &rejected);
        }
    }
}

fn write(test: &str, verdicts: &BTreeMap<String, u64>) {
    let lines: String = verdicts.iter().map(|(what, key)| format!("{key:016x} {what}\n")).collect();
    let path = path(test);
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("the folder of the verdicts");
    std::fs::write(&path, lines).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

fn path(test: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/verdicts").join(test).with_extension("txt")
}

#[test]
fn keys_depend_on_every_byte_but_not_on_the_list_of_mistakes() {
    let key = |file: &str| Key::of_code(&[file]).value();
    let file = "fn a() {}\nstatic MISTAKES: [u8; 1] = [\n    1,\n];\nfn b() {}\n";
    assert_eq!(key(file), key(&file.replace("    1,", "    2,\n    3,")));
    assert_ne!(key(file), key(&file.replace("fn b", "fn c")));
    assert_ne!(key(file), key(&file.replace("fn a", "fn d")));
    assert_ne!(Key::of_code(&["ab", "c"]).value(), Key::of_code(&["a", "bc"]).value());
}
