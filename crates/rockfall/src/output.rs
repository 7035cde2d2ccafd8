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
/// If a program is killed, its partial file remains, and the next program that writes to the same target continues or replaces it.
/// The partial file is locked, so that two programs cannot write to it at the same time. A link in its place is removed and never
/// followed. A target that is not a regular file (a device, a pipe) is written to directly.
#[derive(Debug)]
pub struct AtomicFile {
    /// The path that the caller gave.
    path: PathBuf,
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
            return Ok(Self::new(path, OpenOptions::new().write(true).open(path)?, None));
        };
        let beside = beside(&target)?;
        Ok(Self::new(path, open_new(&beside)?, Some((beside, target))))
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
        let mut left = open_left(&beside)?;
        let (mut file, crc32) = match left.as_mut().map(|file| hash(file, mark)).transpose()?.flatten().zip(left) {
            Some((crc32, file)) => (file, crc32),
            None => {
                // A partial file that was left may still be useful to the user, until the finished file has proved to be.
                let mut finished = finished(&target, mark)?;
                let mut file = open_new(&beside)?;
                let copied = copy_of(&mut finished, &mut file, mark);
                (file, copied.inspect_err(|_| drop(fs::remove_file(&beside)))?)
            }
        };
        file.set_len(mark.bytes)?;
        file.seek(SeekFrom::Start(mark.bytes))?;
        let mut resumed = Self::new(path, file, Some((beside, target)));
        (resumed.bytes, resumed.crc32, resumed.marked) = (mark.bytes, crc32, true);
        Ok(resumed)
    }

    fn new(path: &Path, file: File, places: Option<(PathBuf, PathBuf)>) -> Self {
        let writer = BufWriter::with_capacity(1 << 16, file);
        let path = path.to_owned();
        Self { path, writer, places, bytes: 0, crc32: Hasher::new(), marked: false, failed: false, read: false }
    }

    /// The path of the target, as it was given.
    pub fn path(&self) -> &Path {
        &self.path
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
            if !is_at(self.writer.get_ref(), beside) {
                let message = format!("{} was replaced or removed while it was written", beside.display());
                return Err(io::Error::other(message));
            }
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
            if is_at(self.writer.get_ref(), beside) {
                let _ = fs::remove_file(beside);
            }
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

/// Opens the partial file that an earlier program left, if there is one that no other program writes to.
fn open_left(path: &Path) -> io::Result<Option<File>> {
    loop {
        match fs::symlink_metadata(path) {
            Ok(found) if found.is_file() => {}
            // A link, or a pipe.
            Ok(_) => fs::remove_file(path)?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error),
        }
        match OpenOptions::new().read(true).write(true).open(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(error),
            Ok(file) if is_locked_at(&file, path)? => return Ok(Some(file)),
            Ok(_) => {}
        }
    }
}

/// Creates a partial file, in place of one that an earlier program left.
fn open_new(path: &Path) -> io::Result<File> {
    loop {
        // What was left is locked until it is removed. It may be another name of a file elsewhere, so it is not written to.
        if let Some(_left) = open_left(path)? {
            fs::remove_file(path)?;
        }
        match OpenOptions::new().read(true).write(true).create_new(true).open(path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
            Ok(file) if is_locked_at(&file, path)? => return Ok(file),
            Ok(_) => {}
        }
    }
}

/// Locks an open file. Returns whether it still has its name, which another program may have taken since it was opened.
fn is_locked_at(file: &File, path: &Path) -> io::Result<bool> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => {
            let message = format!("another program is writing it ({} is locked)", path.display());
            Err(io::Error::new(io::ErrorKind::ResourceBusy, message))
        }
        // Some file systems do not support locks.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(is_at(file, path)),
    }
}

/// Whether a path is that of an open file, and not of a link or of another file.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let number = |found: fs::Metadata| (found.dev(), found.ino());
    file.metadata().map(number).ok() == fs::symlink_metadata(path).map(number).ok()
}

#[cfg(not(unix))]
fn is_at(_file: &File, path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|found| found.is_file())
}

/// Removes a link that is in the place of an output whose name the program has chosen. [`AtomicFile`] follows the links of names
/// that users give.
///
/// # Errors
/// The error of the operating system.
pub fn remove_link(path: &Path) -> io::Result<()> {
    if fs::symlink_metadata(path).is_ok_and(|found| found.is_symlink()) { fs::remove_file(path) } else { Ok(()) }
}

/// The hash of a file from its beginning up to a mark; `None` if it differs from the mark.
fn hash(file: &mut File, mark: Mark) -> io::Result<Option<Hasher>> {
    let mut crc32 = Hasher::new();
    file.seek(SeekFrom::Start(0))?;
    let copied = copy(&mut file.take(mark.bytes), &mut crc32, &mut io::sink())?;
    Ok((copied == mark.bytes && crc32.clone().finalize() == mark.crc32).then_some(crc32))
}

/// Opens the finished file, if it is what was written up to a mark.
fn finished(target: &Path, mark: Mark) -> io::Result<File> {
    let mut finished = File::open(target)
        .map_err(|error| io::Error::new(error.kind(), "what was written of it before is not there any more"))?;
    match hash(&mut finished, mark)? {
        Some(_) => Ok(finished),
        None => Err(io::Error::new(io::ErrorKind::InvalidData, "it is not what was written before")),
    }
}

/// Copies the finished file up to a mark, and returns the hash.
fn copy_of(finished: &mut File, file: &mut File, mark: Mark) -> io::Result<Hasher> {
    finished.seek(SeekFrom::Start(0))?;
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
mod output_tests;
