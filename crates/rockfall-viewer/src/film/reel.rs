//! Films in memory.

use std::path::Path;

use rockfall::{Error, Result};

use crate::film::{Format, write_all};
use crate::picture::Picture;

/// The pictures of a film in memory, compressed without loss. All have the same size.
#[derive(Clone, Debug, Default)]
pub struct Reel {
    /// PNG files.
    pictures: Vec<Vec<u8>>,
}

impl Reel {
    /// Creates an empty reel.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a picture.
    ///
    /// # Errors
    /// [`Error::File`] when the picture has no pixels.
    pub fn push(&mut self, picture: &Picture) -> Result<()> {
        let mut bytes = Vec::new();
        picture.write_fast_png(&mut bytes).map_err(failed)?;
        self.pictures.push(bytes);
        Ok(())
    }

    /// Number of pictures.
    pub fn len(&self) -> usize {
        self.pictures.len()
    }

    /// Whether there are no pictures.
    pub fn is_empty(&self) -> bool {
        self.pictures.is_empty()
    }

    /// Returns a picture; `None` if there are not as many.
    pub fn picture(&self, index: usize) -> Option<Picture> {
        self.pictures.get(index).and_then(|bytes| Picture::read_png(bytes.as_slice()).ok())
    }

    /// Writes the film to a file, `fps` pictures per second.
    ///
    /// # Errors
    /// Those of [`write_all()`].
    pub fn write(&self, path: &Path, format: Format, fps: u32) -> Result<()> {
        let pictures = self.pictures.iter().map(|bytes| Picture::read_png(bytes.as_slice()).map_err(failed));
        write_all(path, format, fps, self.pictures.len() as u64, pictures)
    }
}

fn failed(source: std::io::Error) -> Error {
    Error::File { file: "picture of a film".into(), source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_come_back_as_they_were() {
        let mut reel = Reel::new();
        let pictures = [3_u8, 200].map(|red| Picture { width: 3, height: 2, pixels: vec![[red, 7, 9, 255]; 6] });
        pictures.iter().for_each(|picture| reel.push(picture).unwrap());
        assert_eq!((reel.len(), reel.is_empty()), (2, false));
        assert_eq!([0, 1, 2].map(|index| reel.picture(index)), [Some(pictures[0].clone()), Some(pictures[1].clone()), None]);
        let folder = tempfile::tempdir().unwrap();
        reel.write(folder.path(), Format::Folder, 25).unwrap();
        let second = std::fs::read(folder.path().join("0001.png")).unwrap();
        assert_eq!(Picture::read_png(second.as_slice()).unwrap(), pictures[1]);
    }
}
