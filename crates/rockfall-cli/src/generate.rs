//! `rockfall generate`: writes a scene of any size.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use rockfall::generate::{Kind, MeshClump};
use rockfall::glam::DVec3;
use rockfall::output::AtomicFile;
use rockfall::{ContactLaw, Mesh, Scene};

use crate::failure::Failure;
use crate::files;
use crate::options::whole;
use crate::output;

/// Length of a frame of hard contacts, in s.
const FRAME: f32 = 1.0 / 60.0;

/// Details that do not fit into the one-line descriptions of the options.
const AFTER_HELP: &str = "\
`rockfall generate clump ROCK.stl --spheres 50` fills a closed triangle mesh (.stl, .obj, .ply) with up to 50 spheres, by the \
Euclidean method of CLUMP (Angelidakis et al., SoftwareX 15, 100735, 2021): each sphere is the largest one that fits at the \
place farthest from the surface and from the spheres before it. The scene has the clump as an @body, with the mass, centre \
and inertia of the mesh, above a floor. The command prints by how much the volume and the inertia of the spheres differ from \
those of the mesh.";

/// What is generated.
#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    Kind(Kind),
    /// A clump of spheres in the shape of a mesh.
    Clump,
}

impl What {
    fn parse(text: &str) -> Result<Self, String> {
        if text == "clump" {
            return Ok(Self::Clump);
        }
        text.parse().map(Self::Kind).map_err(|error: rockfall::Error| format!("{error}; or clump and a mesh"))
    }
}

#[derive(Debug, clap::Args)]
#[command(after_long_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// Kind of scene: pile, mixed, clumps, boxes, dominoes, bricks, arch, hulls, soft, chain, hopper, drum, column, vibrated,
    /// shear-cell, mixer or screw; or clump, for a rigid body in the shape of a mesh
    #[arg(value_parser = What::parse)]
    kind: What,
    /// Mesh of a clump: a file with the extension .stl, .obj or .ply
    #[arg(value_name = "MESH")]
    mesh: Option<PathBuf>,
    /// Number of spheres, including those of rods, capsules and rigid bodies; dominoes round it down to whole ones and a ball; a
    /// clump has at most this number
    #[arg(long, value_name = "N", value_parser = whole(0, u32::MAX), allow_negative_numbers = true)]
    spheres: u32,
    /// Seed of the random numbers; the same seed gives the same scene
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    /// Give the scene hard contacts, in frames of 1/60 s; kinds with objects that the law does not take are refused
    #[arg(long, value_name = "LAW", value_parser = ["rigid"])]
    law: Option<String>,
    #[command(flatten)]
    clump: ClumpArguments,
    /// Scene file to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
struct ClumpArguments {
    /// Clump: radius of the smallest sphere, in units [default: the edge of a cell of the grid]
    #[arg(long, value_name = "R", requires = "mesh", allow_negative_numbers = true)]
    min_radius: Option<f32>,
    /// Clump: how far spheres may reach into each other, as a share of a radius, from 0 to less than 1 [default: 0.6]
    #[arg(long, value_name = "O", requires = "mesh", allow_negative_numbers = true)]
    overlap: Option<f32>,
    /// Clump: density, in mass/units³ [default: 1]
    #[arg(long, value_name = "D", requires = "mesh", allow_negative_numbers = true)]
    density: Option<f32>,
    /// Clump: number of units that a unit of the mesh has [default: 1]
    #[arg(long, value_name = "S", requires = "mesh", allow_negative_numbers = true)]
    scale: Option<f64>,
    /// Clump: approximate number of cells of the grid in which the mesh is measured [default: 2000000]
    #[arg(long, value_name = "N", requires = "mesh", allow_negative_numbers = true)]
    cells: Option<u32>,
}

/// A generated scene, with lines of text for its head.
struct Generated {
    scene: Scene,
    title: String,
}

pub(crate) fn generate(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    if let Some(path) = out {
        files::check("--out", path, files::SCENE)?;
    }
    let file = out.as_ref().map(|path| AtomicFile::create(path).map_err(|error| Failure::file(path, &error)));
    let file = file.transpose()?;
    let Generated { scene, title } = match (arguments.kind, &arguments.mesh) {
        (What::Kind(kind), None) => of_kind(kind, arguments)?,
        (What::Clump, Some(mesh)) => clump(mesh, arguments)?,
        (What::Clump, None) => return Err(Failure::usage("clump: the name of a mesh is missing, as in clump rock.stl")),
        (What::Kind(kind), Some(mesh)) => {
            return Err(Failure::usage(format!("{kind} has no mesh, got {}; only clump has one", mesh.display())));
        }
    };
    let text = title + "\n" + &scene.to_text();
    let (Some(mut file), Some(path)) = (file, out) else {
        return output::print(&text);
    };
    file.write_all(text.as_bytes()).and_then(|()| file.commit()).map_err(|error| Failure::file(path, &error))
}

/// A scene in which a clump in the shape of a mesh falls onto a floor. Prints how near it is to the mesh.
fn clump(path: &Path, arguments: &Arguments) -> Result<Generated, Failure> {
    let Arguments { spheres, seed, clump, .. } = arguments;
    let mut options = MeshClump::new(*spheres);
    options.min_radius = clump.min_radius.unwrap_or(options.min_radius);
    options.overlap = clump.overlap.unwrap_or(options.overlap);
    options.density = clump.density.unwrap_or(options.density);
    options.cells = clump.cells.unwrap_or(options.cells);
    let mut mesh = Mesh::read(path).map_err(Failure::usage)?;
    if let Some(scale) = clump.scale {
        mesh = mesh.transformed(scale, DVec3::X, 0.0, DVec3::ZERO).map_err(Failure::usage)?;
    }
    let name = output::on_one_line(&path.display().to_string());
    let of_mesh = |error: rockfall::Error| Failure::usage(format!("{name}: {error}"));
    let fit = options.fit(&mesh).map_err(of_mesh)?;
    let mut title = format!("# rockfall generate clump {name} --spheres {spheres} --seed {seed}\n");
    for line in fit.to_string().lines() {
        output::note(line);
        title += &format!("# {line}\n");
    }
    Ok(Generated { scene: fit.scene(*seed).map_err(of_mesh)?, title })
}

/// A scene of a kind.
fn of_kind(kind: Kind, arguments: &Arguments) -> Result<Generated, Failure> {
    let Arguments { spheres, seed, law, .. } = arguments;
    let mut scene = kind.generate(*spheres, *seed)?;
    let mut title = format!("# rockfall generate {kind} --spheres {spheres} --seed {seed}");
    if law.is_some() {
        harden(&mut scene)?;
        title += " --law rigid";
    }
    title.push('\n');
    if reduce_overlaps(kind, &mut scene) {
        title += "# Gravity is so small that bodies at rest overlap by less than 5 % of their radius at a time step of 0.02 s.\n\
                  # For more gravity, use resting_overlap and a shorter time step (rockfall check suggests both).\n";
    }
    for line in kind.note(*spheres).lines() {
        title += &format!("# {line}\n");
    }
    Ok(Generated { scene, title })
}

/// Makes the contacts of a scene hard. Scenes of the thesis's law get the gravity and friction of other scenes with hard contacts.
fn harden(scene: &mut Scene) -> Result<(), Failure> {
    if scene.contact_law() == ContactLaw::Rigid {
        return Ok(());
    }
    let settings = &mut scene.settings;
    if !settings.contact_law.has_history() {
        (settings.gravity, settings.restitution, settings.coulomb_friction) = (10.0, 0.0, 0.4);
    }
    settings.contact_law = ContactLaw::Rigid;
    let seconds = scene.run.dt.unwrap_or(FRAME) * scene.run.steps.unwrap_or_default() as f32;
    (scene.run.dt, scene.run.steps) = (Some(FRAME), Some((seconds / FRAME).round() as u64));
    scene.run.integrator = None;
    scene.hard_contacts(FRAME)?;
    Ok(())
}

/// Gravity of soft blobs as a share of [`Scene::gentle_gravity`], which is that of a pile: a blob stands on few of its spheres,
/// blobs lie on each other, and springs press the feet of a blob that lands.
const SOFT: f32 = 0.07;
/// Activation threshold of kinds in which bodies press others while they fall, in 1/s. A contact that is slower than the threshold
/// is not a collision, so it is cushioned by the contact force alone: at the default of 1 by up to 6 % of the radius.
const THRESHOLD: f32 = 0.5;

/// Chooses constants with which 100 to 5,000 spheres overlap by less than 5 % of their radius, without those that collide.
/// Grains, hard contacts and scenes with `resting_overlap` have constants of their own. Returns whether gravity was changed.
fn reduce_overlaps(kind: Kind, scene: &mut Scene) -> bool {
    if kind.has_grains() || scene.contact_law() == ContactLaw::Rigid || scene.settings.resting_overlap > 0.0 {
        return false;
    }
    if matches!(kind, Kind::Mixed | Kind::Soft | Kind::Hopper) {
        scene.settings.activation_threshold = THRESHOLD;
    }
    let share = if kind == Kind::Soft { SOFT } else { 1.0 };
    let gravity = rounded(share * scene.gentle_gravity());
    std::mem::replace(&mut scene.settings.gravity, gravity) != gravity
}

/// Rounds to three significant digits.
fn rounded(number: f32) -> f32 {
    format!("{number:.2e}").parse().unwrap_or(number)
}
