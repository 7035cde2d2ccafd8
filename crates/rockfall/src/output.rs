//! Output files that appear complete or not at all.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that is written beside its place and put there by [`AtomicFile::commit`]; dropped before that, it leaves
/// nothing behind, and what stood in its place stays.
///
/// A place that is no regular file (a device, a pipe) is written to directly.
#[derive(Debug)]
pub struct AtomicFile {
    writer: BufWriter<File>,
    /// Where it is written and where it goes; `None` once done, and for what is written to directly.
    places: Option<(PathBuf, PathBuf)>,
}

impl AtomicFile {
    /// Opens the file for writing. A folder that is missing or must not be written to shows here, not at the end.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn create(path: &Path) -> io::Result<Self> {
        // Through links, which a rename would replace.
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        match fs::metadata(&target) {
            // A folder among them, which refuses to be opened.
            Ok(found) if !found.is_file() => {
                return Ok(Self { writer: BufWriter::new(OpenOptions::new().write(true).open(&target)?), places: None });
            }
            // A rename would go around a file's write protection.
            Ok(_) => drop(OpenOptions::new().append(true).open(&target)?),
            Err(_) => {}
        }
        let name = target.file_name().ok_or(io::ErrorKind::InvalidInput)?;
        let mut tries = 0_u32;
        loop {
            let mut beside = OsString::from(".");
            beside.push(name);
            beside.push(format!(".{}-{tries}.part", std::process::id()));
            let beside = target.with_file_name(beside);
            match OpenOptions::new().write(true).create_new(true).open(&beside) {
                Ok(file) => {
                    return Ok(Self { writer: BufWriter::with_capacity(1 << 16, file), places: Some((beside, target)) });
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists && tries < 1000 => tries += 1,
                Err(error) => return Err(error),
            }
        }
    }

    /// Finishes the file and puts it in its place.
    ///
    /// # Errors
    /// What the operating system says; nothing is left behind then.
    pub fn commit(mut self) -> io::Result<()> {
        self.writer.flush()?;
        if let Some((beside, target)) = &self.places {
            fs::rename(beside, target)?;
            self.places = None;
        }
        Ok(())
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if let Some((beside, _)) = &self.places {
            // Nothing is left to tell it to.
            let _ = fs::remove_file(beside);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An empty folder of this test's own, removed in the end.
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
    fn what_stood_there_stays_until_the_commit() {
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
    fn dropped_it_leaves_nothing() {
        let folder = Folder::new("drop");
        let mut file = AtomicFile::create(&folder.0.join("a.txt")).unwrap();
        file.write_all(b"half").unwrap();
        drop(file);
        assert!(folder.names().is_empty());
    }

    #[test]
    fn missing_folders_and_folders_in_its_place_show_at_once() {
        let folder = Folder::new("missing");
        assert!(AtomicFile::create(&folder.0.join("no/a.txt")).is_err());
        assert!(AtomicFile::create(&folder.0).is_err());
    }
}
