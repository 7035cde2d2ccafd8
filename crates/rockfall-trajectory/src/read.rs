//! Reads the trajectories that this crate writes, for example to draw a film of them.

use std::io;
use std::path::{Path, PathBuf};

use rockfall::glam::{Quat, Vec3};
use rockfall::{Error, Result, RigidBodyId, Scene, Simulation, SphereId};

mod npz;
mod stage;
mod vtp;

use stage::Stage;

/// A trajectory that is read from a file: `.npz`, or `.pvd` with its folder. Frames are read one by one.
///
/// ```no_run
/// use rockfall::Simulation;
/// use rockfall_trajectory::Reader;
///
/// # fn main() -> rockfall::Result<()> {
/// let mut reader = Reader::open("bridge.npz")?;
/// let mut simulation = Simulation::new(reader.scene().clone())?;
/// for frame in 0..reader.moments().len() {
///     reader.show(frame, &mut simulation)?;
///     println!("{} s: {:?}", reader.moments()[frame].time, simulation.energy()?);
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Reader {
    path: PathBuf,
    scene: Scene,
    moments: Vec<Moment>,
    file: File,
    /// Where spheres come and go.
    stage: Option<Stage>,
}

#[derive(Debug)]
enum File {
    Npz(npz::Frames),
    Vtp(vtp::Frames),
}

/// The time of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Number of steps done.
    pub step: u64,
    /// Simulated time, in s.
    pub time: f64,
}

/// The states of all spheres in one frame, each array in insertion order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct States {
    /// Numbers of the spheres, the same in all frames: places in [`Reader::spheres`].
    pub ids: Vec<u32>,
    /// Centres, in units.
    pub positions: Vec<Vec3>,
    /// Velocities, in units/s.
    pub velocities: Vec<Vec3>,
    /// Orientations, unit quaternions.
    pub orientations: Vec<Quat>,
    /// Angular momenta, in mass units²/s.
    pub angular_momenta: Vec<Vec3>,
}

impl States {
    /// Gives these states to the spheres of a simulation that has as many spheres.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the numbers of spheres differ, or for a value that is not finite or not a unit quaternion.
    pub fn apply(&self, simulation: &mut Simulation) -> Result<()> {
        let ids: Vec<_> = simulation.scene().sphere_ids().collect();
        if ids.len() != self.positions.len() {
            let value = format!("{} spheres", self.positions.len());
            return Err(Error::Invalid { field: "frame", value, expected: "as many spheres as the scene has" });
        }
        self.put(ids, simulation)
    }

    /// Gives these states to spheres.
    fn put(&self, spheres: impl IntoIterator<Item = SphereId>, simulation: &mut Simulation) -> Result<()> {
        for (index, id) in spheres.into_iter().enumerate() {
            match simulation.scene().body_of_sphere(id) {
                Some(body) => self.put_body(index, id, body, simulation)?,
                None => {
                    simulation.set_position(id, self.positions[index])?;
                    simulation.set_velocity(id, self.velocities[index])?;
                    simulation.set_orientation(id, self.orientations[index])?;
                    simulation.set_angular_momentum(id, self.angular_momenta[index])?;
                }
            }
        }
        Ok(())
    }

    /// Gives the state with an index to a rigid body, if its sphere is the first one of the body.
    fn put_body(&self, index: usize, id: SphereId, body: RigidBodyId, simulation: &mut Simulation) -> Result<()> {
        let scene = simulation.scene();
        if scene.body(body)?.spheres().first() != Some(&id) {
            return Ok(());
        }
        let mut sphere = *scene.sphere(id)?;
        (sphere.position, sphere.position_low) = (self.positions[index], Vec3::ZERO);
        (sphere.velocity, sphere.orientation) = (self.velocities[index], self.orientations[index]);
        sphere.angular_momentum = self.angular_momenta[index];
        let moved = scene.body_with_sphere(body, &sphere)?;
        simulation.update_body(body, |body| *body = moved)
    }
}

impl Reader {
    /// Opens a trajectory and checks that it is complete. The checksums of a `.npz` file are verified, for which the file is
    /// read once.
    ///
    /// # Errors
    /// [`Error::File`] when the file cannot be read, is damaged, is not a trajectory or has no frames, and for the scene in it
    /// the errors of [`Scene::parse_bytes`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let failed = |source| Error::File { file: path.to_owned(), source };
        let mut start = [0; 4];
        let mut file = std::fs::File::open(path).map_err(failed)?;
        let is_archive = io::Read::read_exact(&mut file, &mut start).is_ok() && start == *b"PK\x03\x04";
        let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
        let (file, moments, text) = if is_archive || extension.as_deref() == Some("npz") {
            npz::open(path).map(|(frames, moments, text)| (File::Npz(frames), moments, text)).map_err(failed)?
        } else {
            vtp::open(path).map(|(frames, moments, text)| (File::Vtp(frames), moments, text)).map_err(failed)?
        };
        if moments.is_empty() {
            return Err(failed(unusable("it has no frames")));
        }
        if let Some(at) = moments.windows(2).position(|pair| !(pair[0].time <= pair[1].time && pair[1].time.is_finite())) {
            return Err(failed(unusable(&format!("the time of frame {} is before that of frame {at}", at + 1))));
        }
        let scene = Scene::parse_bytes(&text, path)?.scene;
        let flows = !(scene.inlets().is_empty() && scene.outlets().is_empty());
        if moments.len() > 1 && flows && matches!(file, File::Vtp(_)) {
            let reason = "its spheres come and go, so its frames cannot be read back; expected an .npz file, or the scene file, which \
                has inlets or outlets";
            return Err(failed(unusable(reason)));
        }
        let spheres = scene.counts().spheres;
        let stage = match &file {
            File::Npz(frames) => match (frames.cast(), frames.spheres()) {
                (Some(cast), _) => Some(Stage::new(scene.clone(), cast).map_err(failed)?),
                (None, Some(found)) if found != spheres => return Err(failed(differs(0, found, spheres))),
                _ => None,
            },
            File::Vtp(_) => None,
        };
        let scene = stage.as_ref().map_or(scene, |stage| stage.everyone().clone());
        Ok(Self { path: path.to_owned(), scene, moments, file, stage })
    }

    /// The objects of the trajectory. The states of the spheres are those of some frame. Where spheres come and go, the spheres are those
    /// of all frames, and the other objects those of the last state. Spheres that are not in the last state have the group, the material,
    /// the name and the colour of the first inlet with such radii.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Whether the spheres are the same in all frames.
    pub fn is_constant(&self) -> bool {
        self.stage.is_none()
    }

    /// The spheres of [`Reader::scene`], by their numbers in [`States::ids`].
    pub fn spheres(&self) -> Vec<SphereId> {
        self.stage.as_ref().map_or_else(|| self.scene.sphere_ids().collect(), |stage| stage.spheres().to_vec())
    }

    /// The times of all frames, of which there is at least one.
    pub fn moments(&self) -> &[Moment] {
        &self.moments
    }

    /// Reads a frame and gives it to a simulation, as [`Reader::apply`] does.
    ///
    /// # Errors
    /// As for [`Reader::frame`] and [`Reader::apply`].
    pub fn show(&mut self, index: usize, simulation: &mut Simulation) -> Result<()> {
        let states = self.frame(index)?;
        self.apply(&states, simulation)
    }

    /// Gives the states of a frame to a simulation of [`Reader::scene`]. Where spheres come and go, the simulation has the spheres of the
    /// frame afterwards, with the same handles in all frames, and those rods, springs and tethers of the scene whose spheres are there.
    ///
    /// # Errors
    /// As for [`States::apply`]; also when spheres were added to the simulation or removed by something else.
    pub fn apply(&mut self, states: &States, simulation: &mut Simulation) -> Result<()> {
        match &mut self.stage {
            Some(stage) => stage.show(states, simulation),
            None => states.apply(simulation),
        }
    }

    /// Reads a frame; `index` counts from 0.
    ///
    /// # Errors
    /// [`Error::File`] when the frame does not exist, is damaged, or has another number of spheres than the scene.
    pub fn frame(&mut self, index: usize) -> Result<States> {
        self.read(index).map_err(|source| Error::File { file: self.path.clone(), source })
    }

    fn read(&mut self, index: usize) -> io::Result<States> {
        if index >= self.moments.len() {
            return Err(unusable(&format!("it has {} frames, so there is no frame {index}", self.moments.len())));
        }
        let mut states = match &mut self.file {
            File::Npz(frames) => frames.read(index)?,
            File::Vtp(frames) => frames.read(index)?,
        };
        let (found, spheres) = (states.positions.len(), self.scene.counts().spheres);
        if self.is_constant() {
            if found != spheres {
                return Err(differs(index, found, spheres));
            }
            states.ids = (0..found as u32).collect();
        }
        let is_sound = |k: usize| {
            let vectors = [states.positions[k], states.velocities[k], states.angular_momenta[k]];
            vectors.iter().all(|vector| vector.is_finite()) && states.orientations[k].is_normalized()
        };
        match (0..found).find(|k| !is_sound(*k)) {
            Some(k) => Err(unusable(&format!(
                "frame {index}, sphere {k}: expected finite numbers and an orientation that is a unit quaternion"
            ))),
            None => Ok(states),
        }
    }
}

fn differs(frame: usize, found: usize, expected: usize) -> io::Error {
    unusable(&format!("frame {frame} has {found} spheres, but its scene has {expected}"))
}

fn unusable(reason: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, format!("not a usable trajectory: {reason}"))
}

/// Groups of `N` little-endian f32.
pub(crate) fn vectors<const N: usize>(bytes: &[u8]) -> impl Iterator<Item = [f32; N]> {
    let number = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    bytes.chunks_exact(4 * N).map(move |group| std::array::from_fn(|k| number(&group[4 * k..4 * k + 4])))
}

/// The states from the bytes of positions, velocities, orientations (w, x, y, z) and angular momenta.
fn states(arrays: &[Vec<u8>; 4]) -> io::Result<States> {
    let [positions, velocities, orientations, angular_momenta] = arrays;
    let count = positions.len() / 12;
    if [velocities.len(), angular_momenta.len(), orientations.len() / 4 * 3].iter().any(|length| *length != 12 * count) {
        return Err(unusable("its arrays differ in length"));
    }
    let triples = |bytes| vectors::<3>(bytes).map(Vec3::from_array).collect();
    Ok(States {
        ids: Vec::new(),
        positions: triples(positions),
        velocities: triples(velocities),
        orientations: vectors::<4>(orientations).map(|[w, x, y, z]| Quat::from_xyzw(x, y, z, w)).collect(),
        angular_momenta: triples(angular_momenta),
    })
}
