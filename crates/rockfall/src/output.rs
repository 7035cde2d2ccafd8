//! Output files that appear complete or not at all, and that a later run can continue.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crc32fast::Hasher;

/// How much of a file has been written. [`AtomicFile::resume`] continues from a mark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mark {
    /// Number of bytes written.
    pub bytes: u64,
    /// CRC-32 of those bytes.
    pub crc32: u32,
}

/// A file that is written as `.NAME.part` next to its target and renamed to the target by [`AtomicFile::commit`]. Until then an
/// existing target stays unchanged. If dropped before the commit, the file is removed, unless a [`Mark`] was taken.
///
/// If a program is killed, its partial file remains, and the next program that writes to the same target uses it. The partial
/// file is locked, so that two programs cannot write to it at the same time. A target that is not a regular file (a device, a
/// pipe) is written to directly.
#[derive(Debug)]
pub struct AtomicFile {
    writer: BufWriter<File>,
    /// Paths of the partial file and the target. `None` once committed, and for a target that is written to directly.
    places: Option<(PathBuf, PathBuf)>,
    bytes: u64,
    crc32: Hasher,
    /// A mark was taken, so the partial file must be kept.
    marked: bool,
    /// A write failed, so the file has a gap.
    failed: bool,
    /// The file was read, so the next write must first seek to its end.
    read: bool,
}

impl AtomicFile {
    /// Opens the file for writing. A folder that is missing or write-protected is reported here, not at the commit.
    ///
    /// # Errors
    /// The error of the operating system; [`io::ErrorKind::ResourceBusy`] while another program writes to the same target.
    pub fn create(path: &Path) -> io::Result<Self> {
        let Some(target) = regular(path)? else {
            return Ok(Self::new(OpenOptions::new().write(true).open(path)?, None));
        };
        let beside = beside(&target)?;
        let file = open_locked(&beside)?;
        file.set_len(0)?;
        Ok(Self::new(file, Some((beside, target))))
    }

    /// Opens the file to continue after a mark, from the partial file of a program that ended early, or from the finished file.
    ///
    /// # Errors
    /// As for [`AtomicFile::create`]. [`io::ErrorKind::NotFound`] when the part up to the mark does not exist any more,
    /// [`io::ErrorKind::InvalidData`] when it has changed.
    pub fn resume(path: &Path, mark: Mark) -> io::Result<Self> {
        let Some(target) = regular(path)? else {
            return Self::create(path);
        };
        let beside = beside(&target)?;
        let left = beside.exists();
        let mut file = open_locked(&beside)?;
        let crc32 = match left.then(|| hash(&mut file, mark)).transpose()?.flatten() {
            Some(crc32) => crc32,
            None => match copy_of(&target, &mut file, mark) {
                Ok(crc32) => crc32,
                Err(error) => {
                    // A partial file that was left may still be useful to the user. An empty file is not.
                    if !left {
                        let _ = fs::remove_file(&beside);
                    }
                    return Err(error);
                }
            },
        };
        file.set_len(mark.bytes)?;
        file.seek(SeekFrom::Start(mark.bytes))?;
        let mut resumed = Self::new(file, Some((beside, target)));
        (resumed.bytes, resumed.crc32, resumed.marked) = (mark.bytes, crc32, true);
        Ok(resumed)
    }

    fn new(file: File, places: Option<(PathBuf, PathBuf)>) -> Self {
        let writer = BufWriter::with_capacity(1 << 16, file);
        Self { writer, places, bytes: 0, crc32: Hasher::new(), marked: false, failed: false, read: false }
    }

    /// Writes everything so far to the disk, and keeps it from now on even if the file is not committed. Returns `None` for a
    /// target that is not a regular file, which cannot be continued.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn mark(&mut self) -> io::Result<Option<Mark>> {
        self.writer.flush()?;
        if self.places.is_none() {
            return Ok(None);
        }
        sync(self.writer.get_ref())?;
        self.marked = true;
        Ok(Some(Mark { bytes: self.bytes, crc32: self.crc32.clone().finalize() }))
    }

    /// Returns the file for reading, positioned at its beginning. Later writes are still appended at the end.
    ///
    /// # Errors
    /// The error of the operating system; [`io::ErrorKind::Unsupported`] for a target that is not a regular file.
    pub fn reader(&mut self) -> io::Result<&mut File> {
        self.writer.flush()?;
        if self.places.is_none() {
            return Err(io::ErrorKind::Unsupported.into());
        }
        // The same handle is used, because some systems do not allow a second one to access a locked file.
        self.read = true;
        let file = self.writer.get_mut();
        file.seek(SeekFrom::Start(0))?;
        Ok(file)
    }

    /// Completes the file, writes it to the disk and renames it to its target.
    ///
    /// # Errors
    /// The error of the operating system, also if an earlier write failed. The target is unchanged then.
    pub fn commit(mut self) -> io::Result<()> {
        if self.failed {
            return Err(io::Error::other("an earlier write failed"));
        }
        self.writer.flush()?;
        if let Some((beside, target)) = &self.places {
            sync(self.writer.get_ref())?;
            fs::rename(beside, target)?;
            sync_folder(target);
            self.places = None;
        }
        Ok(())
    }

    /// Removes the partial file, even if a mark was taken.
    pub fn discard(mut self) {
        self.marked = false;
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if std::mem::take(&mut self.read) {
            self.writer.get_mut().seek(SeekFrom::End(0))?;
        }
        let written = self.writer.write(bytes).inspect_err(|error| {
            self.failed |= error.kind() != io::ErrorKind::Interrupted;
        })?;
        self.crc32.update(&bytes[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if let Some((beside, _)) = self.places.as_ref().filter(|_| !self.marked) {
            // An error cannot be reported here.
            let _ = fs::remove_file(beside);
        }
    }
}

/// Resolves the path of a target through links, because a rename would replace a link. Returns `None` for a target that is not
/// a regular file.
fn regular(path: &Path) -> io::Result<Option<PathBuf>> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    match fs::metadata(&target) {
        // This includes folders, which cannot be opened for writing.
        Ok(found) if !found.is_file() => return Ok(None),
        // A rename would bypass the write protection of a file.
        Ok(_) => drop(OpenOptions::new().append(true).open(&target)?),
        Err(_) => {}
    }
    Ok(Some(target))
}

/// Path of the partial file.
fn beside(target: &Path) -> io::Result<PathBuf> {
    let mut name = OsString::from(".");
    name.push(target.file_name().ok_or(io::ErrorKind::InvalidInput)?);
    name.push(".part");
    Ok(target.with_file_name(name))
}

/// Opens or creates a file that no other program writes to.
fn open_locked(path: &Path) -> io::Result<File> {
    loop {
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                let message = format!("another program is writing it ({} is locked)", path.display());
                return Err(io::Error::new(io::ErrorKind::ResourceBusy, message));
            }
            // Some file systems do not support locks.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        // Another program may have renamed it since it was opened.
        if is_at(&file, path) {
            return Ok(file);
        }
    }
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let number = |found: fs::Metadata| (found.dev(), found.ino());
    file.metadata().map(number).ok() == fs::metadata(path).map(number).ok()
}

#[cfg(not(unix))]
fn is_at(_file: &File, path: &Path) -> bool {
    path.exists()
}

/// The hash of a file from its beginning up to a mark; `None` if it differs from the mark.
fn hash(file: &mut File, mark: Mark) -> io::Result<Option<Hasher>> {
    let mut crc32 = Hasher::new();
    file.seek(SeekFrom::Start(0))?;
    let copied = copy(&mut file.take(mark.bytes), &mut crc32, &mut io::sink())?;
    Ok((copied == mark.bytes && crc32.clone().finalize() == mark.crc32).then_some(crc32))
}

/// Copies the finished file up to a mark, and returns the hash.
fn copy_of(target: &Path, file: &mut File, mark: Mark) -> io::Result<Hasher> {
    let mut finished = File::open(target)
        .map_err(|error| io::Error::new(error.kind(), "what was written of it before is not there any more"))?;
    if hash(&mut finished, mark)?.is_none() {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "it is not what was written before"));
    }
    finished.seek(SeekFrom::Start(0))?;
    file.seek(SeekFrom::Start(0))?;
    let mut crc32 = Hasher::new();
    copy(&mut finished.take(mark.bytes), &mut crc32, file)?;
    Ok(crc32)
}

fn copy(from: &mut impl Read, crc32: &mut Hasher, to: &mut impl Write) -> io::Result<u64> {
    let mut buffer = vec![0; 1 << 16];
    let mut copied = 0;
    loop {
        let read = from.read(&mut buffer)?;
        if read == 0 {
            return Ok(copied);
        }
        crc32.update(&buffer[..read]);
        to.write_all(&buffer[..read])?;
        copied += read as u64;
    }
}

/// Writes a file to the disk. A full disk may be reported only here.
fn sync(file: &File) -> io::Result<()> {
    match file.sync_all() {
        // Some file systems do not support this.
        Err(error) if matches!(error.kind(), io::ErrorKind::Unsupported | io::ErrorKind::InvalidInput) => Ok(()),
        result => result,
    }
}

/// Writes the new name to the disk, on systems that can synchronize folders.
fn sync_folder(target: &Path) {
    if let Some(folder) = target.parent().filter(|_| cfg!(unix)) {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        // Errors are ignored: the file itself is complete and has its name.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

#[cfg(test)]
mod tests {
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
}
