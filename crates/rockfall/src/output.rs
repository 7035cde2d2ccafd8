//! Output files that appear complete or not at all, and that a later run can go on with.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crc32fast::Hasher;

/// How far a file has been written: what [`AtomicFile::resume`] goes on from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mark {
    /// Bytes.
    pub bytes: u64,
    /// CRC-32 of those bytes.
    pub crc32: u32,
}

/// A file that is written beside its place, as `.NAME.part`, and put there by [`AtomicFile::commit`]; what stood in its place
/// stays until then. Dropped before that it leaves nothing behind, unless there is a [`Mark`] to go on from.
///
/// What is left of a program that was killed is used by the next one that writes to the same place. The unfinished file is
/// locked, so that no two programs do so at once. A place that is no regular file (a device, a pipe) is written to directly.
#[derive(Debug)]
pub struct AtomicFile {
    writer: BufWriter<File>,
    /// Where it is written and where it goes; `None` once done, and for what is written to directly.
    places: Option<(PathBuf, PathBuf)>,
    bytes: u64,
    crc32: Hasher,
    /// Something refers to what was written so far.
    marked: bool,
    /// Something could not be written: the file has a gap.
    failed: bool,
    /// Its end is to be found again before anything is written.
    read: bool,
}

impl AtomicFile {
    /// Opens the file for writing. A folder that is missing or must not be written to shows here, not at the end.
    ///
    /// # Errors
    /// What the operating system says; [`io::ErrorKind::ResourceBusy`] while another program writes to the same place.
    pub fn create(path: &Path) -> io::Result<Self> {
        let Some(target) = regular(path)? else {
            return Ok(Self::new(OpenOptions::new().write(true).open(path)?, None));
        };
        let beside = beside(&target)?;
        let file = open_locked(&beside)?;
        file.set_len(0)?;
        Ok(Self::new(file, Some((beside, target))))
    }

    /// Opens the file for going on behind a mark, in what a program left that was ended early, or in the finished file.
    ///
    /// # Errors
    /// As for [`AtomicFile::create`]; [`io::ErrorKind::NotFound`] and [`io::ErrorKind::InvalidData`] when what was written up
    /// to the mark is not there any more, or is something else.
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
                    // What was left may still be of use to somebody; an empty file is not.
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

    /// Puts on the disk what was written so far, and keeps it from now on, even unfinished. `None` for what is no regular
    /// file, where there is nothing to go on from.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn mark(&mut self) -> io::Result<Option<Mark>> {
        self.writer.flush()?;
        if self.places.is_none() {
            return Ok(None);
        }
        sync(self.writer.get_ref())?;
        self.marked = true;
        Ok(Some(Mark { bytes: self.bytes, crc32: self.crc32.clone().finalize() }))
    }

    /// What was written so far, to be read from its beginning. What is written later comes after it all the same.
    ///
    /// # Errors
    /// What the operating system says; [`io::ErrorKind::Unsupported`] for what is no regular file.
    pub fn reader(&mut self) -> io::Result<&mut File> {
        self.writer.flush()?;
        if self.places.is_none() {
            return Err(io::ErrorKind::Unsupported.into());
        }
        // No second handle: some systems keep those out of what is locked.
        self.read = true;
        let file = self.writer.get_mut();
        file.seek(SeekFrom::Start(0))?;
        Ok(file)
    }

    /// Finishes the file, puts it on the disk and in its place.
    ///
    /// # Errors
    /// What the operating system says, also where an earlier write failed; nothing is put in its place then.
    pub fn commit(mut self) -> io::Result<()> {
        if self.failed {
            return Err(io::Error::other("a part of it could not be written"));
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

    /// Removes the file unfinished, marked or not.
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
            // Nothing is left to tell it to.
            let _ = fs::remove_file(beside);
        }
    }
}

/// Where a file goes, through links, which a rename would replace; `None` for what is no regular file.
fn regular(path: &Path) -> io::Result<Option<PathBuf>> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    match fs::metadata(&target) {
        // A folder among them, which refuses to be opened.
        Ok(found) if !found.is_file() => return Ok(None),
        // A rename would go around a file's write protection.
        Ok(_) => drop(OpenOptions::new().append(true).open(&target)?),
        Err(_) => {}
    }
    Ok(Some(target))
}

/// Where a file is written before it is complete.
fn beside(target: &Path) -> io::Result<PathBuf> {
    let mut name = OsString::from(".");
    name.push(target.file_name().ok_or(io::ErrorKind::InvalidInput)?);
    name.push(".part");
    Ok(target.with_file_name(name))
}

/// Opens or makes a file that no other program writes to.
fn open_locked(path: &Path) -> io::Result<File> {
    loop {
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                let message = format!("another program is writing it ({} is locked)", path.display());
                return Err(io::Error::new(io::ErrorKind::ResourceBusy, message));
            }
            // Some file systems have no locks.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        // Another program may have put it in its place since it was opened.
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

/// The hash of a file up to a mark, from its beginning; `None` when it is not that of the mark.
fn hash(file: &mut File, mark: Mark) -> io::Result<Option<Hasher>> {
    let mut crc32 = Hasher::new();
    file.seek(SeekFrom::Start(0))?;
    let copied = copy(&mut file.take(mark.bytes), &mut crc32, &mut io::sink())?;
    Ok((copied == mark.bytes && crc32.clone().finalize() == mark.crc32).then_some(crc32))
}

/// Copies the finished file up to a mark.
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

/// A full disk may show only here.
fn sync(file: &File) -> io::Result<()> {
    match file.sync_all() {
        // Some file systems have no such thing.
        Err(error) if matches!(error.kind(), io::ErrorKind::Unsupported | io::ErrorKind::InvalidInput) => Ok(()),
        result => result,
    }
}

/// Puts the new name on the disk, where folders can be told to.
fn sync_folder(target: &Path) {
    if let Some(folder) = target.parent().filter(|_| cfg!(unix)) {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        // The file itself is complete and in its place.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
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

    #[test]
    fn what_a_killed_program_left_is_gone_on_with() {
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

        // A finished one is gone on with too, and stays until the commit.
        let mut file = AtomicFile::resume(&path, mark).unwrap();
        file.write_all(b"three").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "one,two");
        file.commit().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "one,three");
    }

    #[test]
    fn what_is_not_there_or_something_else_is_refused() {
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
    fn what_was_written_can_be_read_and_gone_on_with() {
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
    fn leftovers_are_used_again_and_two_writers_are_refused() {
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
