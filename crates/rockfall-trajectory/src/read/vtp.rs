//! Reads `.pvd` files and the folder of their frames.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use roxmltree::Document;

use super::{Moment, States, states, unusable};
use crate::vtp::SCENE;

/// The files of the frames.
#[derive(Debug)]
pub(super) struct Frames {
    files: Vec<PathBuf>,
}

/// Names of the arrays of a state.
const NAMES: [(&str, &str); 4] = [("Points", "3"), ("velocity", "3"), ("orientation", "4"), ("angular_momentum", "3")];

pub(super) fn open(path: &Path) -> io::Result<(Frames, Vec<Moment>, Vec<u8>)> {
    let text = fs::read(path)?;
    let text = String::from_utf8(text).map_err(|_| unusable("it is neither a .npz archive nor a .pvd list"))?;
    let document = Document::parse(&text).map_err(|error| unusable(&format!("it is not a complete .pvd list ({error})")))?;
    if document.root_element().attribute("type") != Some("Collection") {
        return Err(unusable("it is not a .pvd list"));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let (mut files, mut moments) = (Vec::new(), Vec::new());
    for entry in document.descendants().filter(|node| node.has_tag_name("DataSet")) {
        // Part 1 has the static objects, which are in the scene.
        if entry.attribute("part").unwrap_or("0") != "0" {
            continue;
        }
        let place = document.text_pos_at(entry.range().start).row;
        let wrong = |what: &str| unusable(&format!("line {place}: {what}"));
        let file = entry.attribute("file").ok_or_else(|| wrong("expected file=\"NAME/STEP.vtp\""))?;
        let time = entry.attribute("timestep").and_then(|time| time.parse::<f64>().ok()).filter(|time| time.is_finite());
        let time = time.ok_or_else(|| wrong("expected timestep=\"SECONDS\""))?;
        let file = folder.join(file);
        let step = file.file_stem().and_then(|stem| stem.to_str()).and_then(|stem| stem.parse().ok());
        let step = step.ok_or_else(|| wrong("expected a file name that is the number of the step"))?;
        if !file.is_file() {
            return Err(wrong(&format!("{} does not exist", file.display())));
        }
        files.push(file);
        moments.push(Moment { step, time });
    }
    let scene = files.first().and_then(|file| file.parent()).map(|folder| folder.join(SCENE));
    let text = scene.map(|scene| {
        fs::read(&scene).map_err(|error| unusable(&format!("{}, the scene of the trajectory: {error}", scene.display())))
    });
    Ok((Frames { files }, moments, text.transpose()?.unwrap_or_default()))
}

impl Frames {
    pub(super) fn read(&self, index: usize) -> io::Result<States> {
        let file = &self.files[index];
        let bytes = fs::read(file).map_err(|error| unusable(&format!("{}: {error}", file.display())))?;
        read(&bytes).map_err(|reason| unusable(&format!("{}: {reason}", file.display())))
    }
}

/// Reads a frame. The arrays follow the XML in binary form, each after its length.
fn read(bytes: &[u8]) -> Result<States, String> {
    if !bytes.trim_ascii_end().ends_with(b"</VTKFile>") {
        return Err("it is cut off or not a .vtp file".to_owned());
    }
    const DATA: &[u8] = b"<AppendedData encoding=\"raw\">\n_";
    let at = bytes.windows(DATA.len()).position(|window| window == DATA).ok_or("it has no appended arrays")?;
    let head = std::str::from_utf8(&bytes[..at]).map_err(|_| "it is not a .vtp file")?;
    let text = format!("{head}</VTKFile>");
    let document = Document::parse(&text).map_err(|error| error.to_string())?;
    let data = &bytes[at + DATA.len()..];
    let mut arrays: [Vec<u8>; 4] = Default::default();
    for ((name, components), array) in NAMES.into_iter().zip(&mut arrays) {
        let node = document.descendants().find(|node| node.attribute("Name") == Some(name));
        let node = node.ok_or_else(|| format!("it has no array {name}"))?;
        let fits = node.attribute("type") == Some("Float32") && node.attribute("NumberOfComponents") == Some(components);
        let offset = node.attribute("offset").and_then(|offset| offset.parse::<usize>().ok()).filter(|_| fits);
        let offset =
            offset.ok_or_else(|| format!("array {name}: expected {components} appended components of type Float32"))?;
        let cut = || format!("array {name} is cut off");
        let rest = data.get(offset..).ok_or_else(cut)?;
        let (length, rest) = rest.split_first_chunk::<8>().ok_or_else(cut)?;
        let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| cut())?;
        *array = rest.get(..length).ok_or_else(cut)?.to_vec();
    }
    states(&arrays).map_err(|error| error.to_string())
}
