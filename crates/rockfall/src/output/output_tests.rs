//! Tests of output files.

use super::*;

/// An empty folder for one test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("rockfall-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn names(&self) -> Vec<OsString> {
        fs::read_dir(&self.0).unwrap().map(|entry| entry.unwrap().file_name()).collect()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn an_existing_file_stays_until_the_commit() {
    let folder = Folder::new("commit");
    let path = folder.0.join("a.txt");
    fs::write(&path, "old").unwrap();
    let mut file = AtomicFile::create(&path).unwrap();
    file.write_all(b"new").unwrap();
    file.flush().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    file.commit().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(folder.names(), ["a.txt"]);
}

#[test]
fn a_dropped_file_leaves_nothing() {
    let folder = Folder::new("drop");
    let mut file = AtomicFile::create(&folder.0.join("a.txt")).unwrap();
    file.write_all(b"half").unwrap();
    drop(file);
    assert!(folder.names().is_empty());
}

#[test]
fn missing_folders_and_folders_as_targets_are_errors_at_once() {
    let folder = Folder::new("missing");
    assert!(AtomicFile::create(&folder.0.join("no/a.txt")).is_err());
    assert!(AtomicFile::create(&folder.0).is_err());
}

#[test]
fn the_partial_file_of_a_killed_program_is_continued() {
    let folder = Folder::new("resume");
    let path = folder.0.join("a.txt");
    let mut file = AtomicFile::create(&path).unwrap();
    file.write_all(b"one,").unwrap();
    let mark = file.mark().unwrap().unwrap();
    assert_eq!(mark, Mark { bytes: 4, crc32: crc32fast::hash(b"one,") });
    file.write_all(b"lost").unwrap();
    file.flush().unwrap();
    drop(file);
    assert_eq!(folder.names(), [".a.txt.part"]);

    let mut file = AtomicFile::resume(&path, mark).unwrap();
    file.write_all(b"two").unwrap();
    let later = file.mark().unwrap().unwrap();
    assert_eq!(later, Mark { bytes: 7, crc32: crc32fast::hash(b"one,two") });
    file.commit().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "one,two");
    assert_eq!(folder.names(), ["a.txt"]);

    // A finished file can be continued too. It stays unchanged until the commit.
    let mut file = AtomicFile::resume(&path, mark).unwrap();
    file.write_all(b"three").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "one,two");
    file.commit().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "one,three");
}

#[test]
fn missing_and_changed_files_are_not_continued() {
    let folder = Folder::new("foreign");
    let path = folder.0.join("a.txt");
    let mark = Mark { bytes: 4, crc32: crc32fast::hash(b"one,") };
    assert_eq!(AtomicFile::resume(&path, mark).unwrap_err().kind(), io::ErrorKind::NotFound);
    fs::write(&path, "two,three").unwrap();
    assert_eq!(AtomicFile::resume(&path, mark).unwrap_err().kind(), io::ErrorKind::InvalidData);
    fs::write(&path, "one").unwrap();
    assert_eq!(AtomicFile::resume(&path, mark).unwrap_err().kind(), io::ErrorKind::InvalidData);
    assert_eq!(folder.names(), ["a.txt"], "nothing is left behind");
    assert_eq!(fs::read_to_string(&path).unwrap(), "one");
}

#[test]
fn a_file_can_be_read_and_then_continued() {
    let folder = Folder::new("read");
    let path = folder.0.join("a.txt");
    let mut file = AtomicFile::create(&path).unwrap();
    file.write_all(b"one,two,").unwrap();
    let mut start = [0; 3];
    file.reader().unwrap().read_exact(&mut start).unwrap();
    assert_eq!(&start, b"one");
    file.write_all(b"three").unwrap();
    file.commit().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "one,two,three");
}

/// Another program may put its own file in the place of the partial file.
#[cfg(unix)]
#[test]
fn a_replaced_partial_file_is_not_taken_for_the_output() {
    let folder = Folder::new("replaced");
    let path = folder.0.join("a.txt");
    fs::write(&path, "old").unwrap();
    let mut file = AtomicFile::create(&path).unwrap();
    file.write_all(b"new").unwrap();
    fs::remove_file(folder.0.join(".a.txt.part")).unwrap();
    fs::write(folder.0.join(".a.txt.part"), "foreign").unwrap();
    let error = file.commit().unwrap_err();
    assert!(error.to_string().contains(".a.txt.part was replaced"), "{error}");
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(fs::read_to_string(folder.0.join(".a.txt.part")).unwrap(), "foreign");
}

#[cfg(unix)]
#[test]
fn links_in_place_of_partial_files_are_not_followed() {
    let folder = Folder::new("links");
    let [path, beside, other] = ["a.txt", ".a.txt.part", "other"].map(|name| folder.0.join(name));
    let mark = Mark { bytes: 4, crc32: crc32fast::hash(b"one,") };
    let no_mark = Mark { bytes: 0, crc32: 0 };
    type Link = fn(&Path, &Path) -> io::Result<()>;
    let links: [Link; 2] = [|from, to| std::os::unix::fs::symlink(from, to), |from, to| fs::hard_link(from, to)];
    for link in links {
        fs::write(&other, "one,other").unwrap();
        link(&other, &beside).unwrap();
        let mut file = AtomicFile::create(&path).unwrap();
        file.write_all(b"one,").unwrap();
        file.commit().unwrap();
        assert_eq!(fs::read_to_string(&other).unwrap(), "one,other");
    }
    std::os::unix::fs::symlink(&other, &beside).unwrap();
    drop(AtomicFile::resume(&path, mark).unwrap());
    assert_eq!(fs::read_to_string(&other).unwrap(), "one,other");
    // A link to nothing would create a file elsewhere.
    fs::remove_file(&beside).unwrap();
    std::os::unix::fs::symlink(folder.0.join("none"), &beside).unwrap();
    AtomicFile::resume(&path, no_mark).unwrap().discard();
    assert!(!folder.0.join("none").exists());
}

#[test]
fn leftovers_are_reused_and_second_writers_are_refused() {
    let folder = Folder::new("leftover");
    let path = folder.0.join("a.txt");
    fs::write(folder.0.join(".a.txt.part"), "left by a program that was killed").unwrap();
    let mut file = AtomicFile::create(&path).unwrap();
    assert_eq!(AtomicFile::create(&path).unwrap_err().kind(), io::ErrorKind::ResourceBusy);
    file.write_all(b"new").unwrap();
    file.commit().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(folder.names(), ["a.txt"]);
    AtomicFile::create(&path).unwrap().discard();
    assert_eq!(folder.names(), ["a.txt"]);
}
