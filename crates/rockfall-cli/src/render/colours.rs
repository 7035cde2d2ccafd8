//! Colours on the command line.

use rockfall::{Colour, Error, ObjectId, Scene, Tag};
use rockfall_viewer::draw::{ColourBy, Style};
use rockfall_viewer::palette::{KINDS, Rgb};

use super::camera::body;
use crate::failure::Failure;
use crate::output;

/// Parses a colour: a name or six hexadecimal digits.
pub(super) fn colour(text: &str) -> Result<Colour, String> {
    text.parse().map_err(|error| match error {
        Error::Invalid { value, expected, .. } => format!("{value} is not a colour, expected {expected}"),
        other => other.to_string(),
    })
}

/// Colours of the background: at the horizon and straight up.
pub(super) fn background(text: &str) -> Result<[Rgb; 2], String> {
    match text.split_once(',') {
        Some((horizon, zenith)) => Ok([colour(horizon)?.0, colour(zenith)?.0]),
        None => colour(text).map(|colour| [colour.0; 2]),
    }
}

/// A `--colour` argument.
#[derive(Clone, Debug)]
pub(crate) struct Paint {
    what: Painted,
    colour: Colour,
}

#[derive(Clone, Debug)]
enum Painted {
    /// Spheres with these numbers.
    Spheres(u32, u32),
    /// A name in the scene, or a kind of object.
    Word(String),
}

/// The kind of object that a word means.
fn kind(word: &str) -> Option<usize> {
    KINDS.iter().position(|kind| kind.name.replace(' ', "-") == word)
}

fn kinds() -> String {
    KINDS.map(|kind| kind.name.replace(' ', "-")).join(" ")
}

/// Parses `WHAT=COLOUR`.
pub(crate) fn paint(text: &str) -> Result<Paint, String> {
    let expected = || {
        let kinds = kinds();
        format!(
            "expected WHAT=COLOUR, where WHAT is a name in the scene, the number of a sphere, a range of numbers as in 1-9, or one \
             of: {kinds}"
        )
    };
    let (what, value) = text.split_once('=').ok_or_else(expected)?;
    let what = if what.starts_with(|first: char| first.is_ascii_digit()) {
        let (from, to) = what.split_once('-').unwrap_or((what, what));
        let ends = from.parse().ok().zip(to.parse().ok()).filter(|(from, to)| from <= to);
        ends.map(|(from, to)| Painted::Spheres(from, to)).ok_or_else(expected)?
    } else if what.is_empty() {
        return Err(expected());
    } else {
        Painted::Word(what.to_owned())
    };
    Ok(Paint { what, colour: colour(value)? })
}

/// Gives the kinds of objects the colours of a style, and returns the tags of single objects.
pub(crate) fn apply(paints: &[Paint], scene: &Scene, style: &mut Style) -> Result<Vec<(ObjectId, Tag)>, Failure> {
    let mut tags = Vec::new();
    for Paint { what, colour } in paints {
        let objects = match what {
            Painted::Spheres(from, to) => spheres(scene, *from, *to)?,
            // A name comes before a kind.
            Painted::Word(word) => match (scene.named(word), kind(word)) {
                (Ok(objects), _) => objects,
                (Err(_), Some(kind)) => {
                    style.kinds[kind] = colour.0;
                    continue;
                }
                (Err(error), None) => {
                    let text = format!("--colour {word}: {error}; or the number of a sphere, or one of: {}", kinds());
                    return Err(Failure::usage(text));
                }
            },
        };
        for object in objects {
            tags.push((object, scene.tag(object)?.cloned().unwrap_or_default().colour(*colour)));
        }
    }
    Ok(tags)
}

/// The spheres with numbers in a range. A single number must exist; a range may have gaps.
fn spheres(scene: &Scene, from: u32, to: u32) -> Result<Vec<ObjectId>, Failure> {
    if from == to {
        return Ok(vec![body(scene, from)?.into()]);
    }
    let numbered = scene.sphere_ids().zip(0..).map(|(id, index)| (id, scene.reference(id).unwrap_or(index)));
    Ok(numbered.filter(|(_, number)| (from..=to).contains(number)).map(|(id, _)| id.into()).collect())
}

/// Returns an error where colours are to show tensions that a trajectory does not know, and tells if there are none.
pub(super) fn check_tension(by: ColourBy, is_recorded: bool, scene: &Scene) -> Result<(), Failure> {
    if by != ColourBy::Tension {
        return Ok(());
    }
    let counts = scene.counts();
    if counts.springs + counts.tethers == 0 {
        output::note(&format!("note: --colour-by tension: {}", output::NO_LINKS));
    }
    if is_recorded && scene.springs().iter().any(|spring| spring.muscle.is_some()) {
        let message = "a trajectory has no rest lengths of muscles, expected a scene or a checkpoint";
        return Err(Failure::usage(format!("--colour-by tension: {message}")));
    }
    Ok(())
}
