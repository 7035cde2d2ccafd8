//! Opening and saving of scenes, pictures, films and tables. Only a scene that was saved in this session, and a file that the
//! user chose to overwrite, are written again. All other files get new names.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::Viewer;
use crate::film::Format;
use crate::pixels::Picture;
use crate::window::dialog::Choice;
use crate::window::message::Level;
use crate::window::new_name::{new_name, stem_of};

/// A file that the present scene was saved to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct SavedFile {
    path: PathBuf,
    /// Number of the scene in the session.
    scene: u64,
    /// Time of the last change and size, to notice when another program has changed the file.
    stamp: Option<(SystemTime, u64)>,
}

fn stamp(path: &Path) -> Option<(SystemTime, u64)> {
    let data = std::fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}

impl Viewer {
    /// Opens a scene file, and returns whether it could be opened.
    pub fn load(&mut self, path: &Path) -> bool {
        let loaded = self.session.load(path);
        self.frame_if_new_scene();
        loaded
    }

    /// Returns the file that Ctrl+S writes without asking: the one that this scene was saved to, if nobody has changed it since.
    pub fn saved_file(&self) -> Option<&Path> {
        let saved = self.saved.as_ref()?;
        let same = saved.scene == self.session.scene_version() && saved.stamp.is_some() && saved.stamp == stamp(&saved.path);
        same.then_some(&saved.path)
    }

    /// Saves the present state to the file that this scene was saved to before. Without one, opens the dialog.
    pub(super) fn save(&mut self) {
        match self.saved_file().map(Path::to_owned) {
            Some(path) => drop(self.save_to(&path)),
            None => self.ask_for_file(true),
        }
    }

    /// Saves the present state and ends the program. Without a file that the scene was saved to before, only opens the dialog.
    pub(in crate::window) fn save_and_leave(&mut self) {
        self.leaving = false;
        self.save();
        self.quit = !self.dialog.is_shown() && !self.session.is_changed();
    }

    fn save_to(&mut self, path: &Path) -> bool {
        let saved = self.session.save(path);
        if saved {
            self.saved = Some(SavedFile { path: path.to_owned(), scene: self.session.scene_version(), stamp: stamp(path) });
        }
        saved
    }

    /// Opens the file dialog in the folder of the scene. To save, it proposes a name that no file has.
    pub(super) fn ask_for_file(&mut self, saving: bool) {
        let source = self.session.source();
        let folder = source.path.as_deref().and_then(Path::parent).unwrap_or(Path::new("")).to_owned();
        let path = match &self.saved {
            Some(saved) if saving && saved.scene == self.session.scene_version() => saved.path.clone(),
            _ if saving => new_name(&folder, &stem_of(&source.name), "txt"),
            _ if folder.as_os_str().is_empty() => folder,
            _ => folder.join(""),
        };
        self.dialog.open(saving, path.display().to_string());
    }

    /// Opens or saves the file that was chosen in the dialog. The dialog stays open if that fails.
    pub fn choose(&mut self, choice: &Choice) {
        self.dialog.close();
        let done = match choice {
            Choice::Open(path) => self.load(path),
            Choice::Save(path) => self.save_to(path),
        };
        if !done {
            let why = self.session.messages.all().last().map_or("", |message| message.text.as_str()).to_owned();
            self.dialog.refuse(why);
        }
    }

    /// Returns a name for a file made of this scene, with a number that makes it new.
    fn new_file(&self, what: &str, extension: &str) -> PathBuf {
        let stem = stem_of(&self.session.source().name);
        let stem = if what.is_empty() { stem } else { format!("{stem}-{}", stem_of(what)) };
        new_name(&self.folder, &stem, extension)
    }

    /// Writes the motion of the picked body as CSV.
    pub fn save_track(&mut self) {
        let name = self.session.watch.facts().map_or_else(String::new, |facts| facts.title.clone());
        let path = self.new_file(&name, "csv");
        self.session.save_track(&path);
    }

    /// Starts to record a film.
    pub fn start_recording(&mut self, format: Format) {
        let extension = if format == Format::Mp4 { "mp4" } else { "gif" };
        let path = self.new_file("", extension);
        self.capture.start(&path, format, self.session.now());
        self.session.tell(Level::Note, format!("recording to {}; Esc or the button ends it", path.display()));
    }

    /// Ends a recording; the film is completed in the background.
    pub fn stop_recording(&mut self) {
        self.capture.stop(self.session.now());
    }

    /// Takes a picture of the scene that [`Capture::wants_picture`](super::Capture::wants_picture) asked for.
    pub fn captured(&mut self, mut picture: Picture) {
        if let Some(legend) = self.legend.as_ref().filter(|_| self.style.colour_by.title().is_some()) {
            // The font is built in, so this cannot fail.
            let _ = legend.draw(&mut picture);
        }
        if self.capture.take_screenshot() {
            let path = self.new_file("", "png");
            let saved = rockfall::output::AtomicFile::create(&path).and_then(|mut file| {
                picture.write_png(&mut file)?;
                file.commit()
            });
            match saved {
                Ok(()) => self.session.tell(Level::Note, format!("saved as {}", path.display())),
                Err(error) => self.session.tell(Level::Error, format!("{}: {error}", path.display())),
            }
        }
        self.capture.add(picture, self.session.now());
    }

    /// Reports the films that were completed; with `wait`, waits for those that are not.
    pub fn report_films(&mut self, wait: bool) {
        for (path, result) in self.capture.finished(wait) {
            match result {
                Ok(()) => self.session.tell(Level::Note, format!("saved as {}", path.display())),
                Err(error) => self.session.tell(Level::Error, error.to_string()),
            }
        }
    }
}
