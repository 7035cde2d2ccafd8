//! An unfinished archive of arrays. Frames are written to a scratch file, and rearranged into arrays when the file is finished.

use std::fs::File;
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

use rockfall::output::{AtomicFile, Mark, remove_link};
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// An unfinished archive.
#[derive(Debug)]
pub(crate) struct Archive {
    /// Final file. It is opened at the start, so that a bad path fails at once.
    file: AtomicFile,
    /// The records of the frames, one after the other.
    pub(crate) scratch: AtomicFile,
}

impl Archive {
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        let file = AtomicFile::create(path)?;
        Ok(Self { file, scratch: AtomicFile::create(&scratch_path(path)?)? })
    }

    /// Continues from a mark. Where the archive was finished, `unpack` writes its frames to a scratch file again.
    pub(crate) fn resume(
        path: &Path,
        mark: Mark,
        unpack: impl FnOnce(&Path, &mut AtomicFile, Mark) -> io::Result<()>,
    ) -> io::Result<Self> {
        let file = AtomicFile::create(path)?;
        let scratch_path = scratch_path(path)?;
        let scratch = match AtomicFile::resume(&scratch_path, mark) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let mut scratch = AtomicFile::create(&scratch_path)?;
                unpack(path, &mut scratch, mark)?;
                match scratch.mark()? {
                    Some(found) if found == mark => scratch,
                    _ => {
                        scratch.discard();
                        return Err(not_as_before());
                    }
                }
            }
            result => result?,
        };
        Ok(Self { file, scratch })
    }

    /// Writes the arrays from the records, and moves the archive to its final path.
    pub(crate) fn finish(
        mut self,
        write: impl FnOnce(&mut ZipWriter<StreamWriter<&mut AtomicFile>>, &mut AtomicFile) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut zip = ZipWriter::new_stream(&mut self.file);
        write(&mut zip, &mut self.scratch)?;
        zip.finish()?;
        self.file.commit()?;
        self.scratch.discard();
        Ok(())
    }
}

/// Opens a finished archive that a run continues.
pub(crate) fn open_finished(path: &Path) -> io::Result<ZipArchive<File>> {
    let finished = File::open(path)
        .map_err(|error| io::Error::new(error.kind(), "what was written of it before is not there any more"))?;
    ZipArchive::new(finished).map_err(|_| not_as_before())
}

/// Error for a finished file that a run cannot continue.
pub(crate) fn not_as_before() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "it is not what was written before")
}

/// The path of the scratch file, where no link is left.
fn scratch_path(path: &Path) -> io::Result<PathBuf> {
    let name = path.file_name().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "expected the name of a file"))?;
    let mut name = name.to_owned();
    name.push(".frames");
    let path = path.with_file_name(name);
    remove_link(&path)?;
    Ok(path)
}

/// Begins an array in the archive.
pub(crate) fn start_array(
    zip: &mut ZipWriter<impl Write + Seek>,
    name: &str,
    kind: &str,
    shape: &[u64],
    bytes: u64,
) -> io::Result<()> {
    let large = bytes > u64::from(u32::MAX) - 1024;
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored).large_file(large);
    zip.start_file(format!("{name}.npy"), options)?;
    zip.write_all(&header(kind, shape))
}

/// Header of format 1.0 of `.npy`: magic bytes, length, and a description in Python syntax. The header is padded to a multiple
/// of 64 bytes.
pub(super) fn header(kind: &str, shape: &[u64]) -> Vec<u8> {
    let shape: String = shape.iter().map(|length| format!("{length}, ")).collect();
    let text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}), }}", shape.trim_end());
    let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{text:<width$}\n", width = length - 1).as_bytes());
    bytes
}
