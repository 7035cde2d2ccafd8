//! Robots of URDF and MJCF files as scenes of the rockfall physics engine.
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let imported = rockfall_import::load_urdf("robot.urdf")?;
//! for note in &imported.notes {
//!     eprintln!("{note}");
//! }
//! let simulation = rockfall::Simulation::new(imported.scene)?;
//! # Ok(())
//! # }
//! ```
//!
//! A link of a URDF file or a body of an MJCF file becomes a rigid body with a shape of its own, and a joint becomes a joint. Links
//! without a joint between them become one body. The scene has the contact law `rigid`, and z is up. `docs/robots.md`
//! in the repository lists what is
//! taken over.
//!
//! Files may come from strangers. The size, the nesting and the number of elements of a file are limited, a document type is refused, and
//! every number is checked.

mod assets;
mod build;
mod error;
mod mass;
mod mjcf;
mod model;
mod notes;
mod solid;
mod urdf;
mod xml;

use std::path::Path;

use rockfall::Scene;

pub use error::{Error, Result};

/// What a file became.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Imported {
    /// The scene. Lengths are in m, masses in kg.
    pub scene: Scene,
    /// What the file has that the scene does not have, or has in another form. Each begins with the file, the
    /// line and the element.
    pub notes: Vec<String>,
}

/// Reads a URDF file.
///
/// # Errors
/// [`Error::File`] when the file, or a mesh that it names, cannot be read. [`Error::Element`] for a text that is no URDF, numbers that are
/// not finite or out of their range, names that no link has, links that form no tree, and elements that a scene cannot have: joints of the
/// type `planar`, `mimic`, and moving links without mass. [`Error::Scene`] when the engine refuses the scene.
pub fn load_urdf(path: impl AsRef<Path>) -> Result<Imported> {
    urdf::load(path.as_ref())
}

/// Reads an MJCF file, the format of MuJoCo, with the files that it includes.
///
/// # Errors
/// As for [`load_urdf`], for text that is no MJCF, and for `coordinate="global"`.
pub fn load_mjcf(path: impl AsRef<Path>) -> Result<Imported> {
    mjcf::load(path.as_ref())
}

/// Reads a URDF or an MJCF file: the root element, `robot` or `mujoco`, decides.
///
/// # Errors
/// As for [`load_urdf`] and [`load_mjcf`].
pub fn load(path: impl AsRef<Path>) -> Result<Imported> {
    let path = path.as_ref();
    converted(path, xml::Reader::default().read(path)?)
}

/// Reads a URDF or an MJCF text as that of a file, to which the files that it names are relative. The root element decides.
///
/// # Errors
/// As for [`load`].
pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Imported> {
    let path = path.as_ref();
    converted(path, xml::Reader::default().parse(path, text, 0)?)
}

fn converted(path: &Path, root: xml::Element) -> Result<Imported> {
    match root.name.as_str() {
        "robot" => urdf::convert(path, &root),
        "mujoco" => mjcf::convert(path, root),
        _ => Err(root.wrong("the root element is unknown, expected <robot> or <mujoco>")),
    }
}
