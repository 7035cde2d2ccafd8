//! One frame of a trajectory.

use rockfall::{Result, Scene, Simulation, SphereId, SphereState};

/// The state of all spheres at one time.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Frame {
    /// Number of steps done.
    pub step: u64,
    /// Simulated time, in s.
    pub time: f64,
    /// States of the spheres, in insertion order.
    pub spheres: Vec<SphereState>,
    /// Numbers of the spheres in the scene file ([`Scene::reference`]).
    pub references: Vec<Option<u32>>,
    /// Number of contacts of every sphere, without those of its rods; empty if they were not requested.
    pub contacts: Vec<u32>,
}

impl Frame {
    /// Reads the current state. If `contacts` is set, contacts are counted on the host, which takes about as long as a step of
    /// the CPU backend.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] if the GPU failed.
    pub fn of(simulation: &mut Simulation, contacts: bool) -> Result<Self> {
        let contacts = match contacts {
            true => simulation.diagnostics()?.iter().map(|sphere| sphere.contacts).collect(),
            false => Vec::new(),
        };
        let report = simulation.report();
        let spheres = simulation.spheres()?;
        let scene = simulation.scene();
        let references = scene.sphere_ids().map(|id| scene.reference(id)).collect();
        Ok(Self { step: report.steps, time: report.time, spheres, references, contacts })
    }

    /// Brings all spheres into the box of a periodic scene. In other scenes they stay.
    pub fn bring_into_box(&mut self, scene: &Scene) {
        if scene.is_periodic() {
            self.spheres.iter_mut().for_each(|sphere| sphere.bring_into_box(scene));
        }
    }
}

/// Numbers of the spheres of a scene, by default their insertion indices.
pub(crate) struct Indices(std::collections::HashMap<SphereId, u32>);

impl Indices {
    pub(crate) fn of(scene: &Scene) -> Self {
        Self::numbered(scene, None)
    }

    /// Gives the spheres, in insertion order, other numbers.
    pub(crate) fn numbered(scene: &Scene, numbers: Option<&[u32]>) -> Self {
        match numbers {
            Some(numbers) => Self(scene.sphere_ids().zip(numbers.iter().copied()).collect()),
            None => Self(scene.sphere_ids().zip(0..).collect()),
        }
    }

    /// Numbers of two spheres of the scene.
    pub(crate) fn pair(&self, a: SphereId, b: SphereId) -> [u32; 2] {
        [a, b].map(|id| self.0.get(&id).copied().unwrap_or(u32::MAX))
    }
}

/// Conversion of numbers to little-endian bytes.
pub(crate) trait Bytes {
    /// Appends the bytes of the number.
    fn put(self, bytes: &mut Vec<u8>);
}

macro_rules! bytes {
    ($($type:ty),*) => {
        $(
            impl Bytes for $type {
                fn put(self, bytes: &mut Vec<u8>) {
                    bytes.extend_from_slice(&self.to_le_bytes());
                }
            }
        )*
    };
}

bytes!(u8, i8, u32, u64, i64, f32, f64);

impl<T: Bytes, const N: usize> Bytes for [T; N] {
    fn put(self, bytes: &mut Vec<u8>) {
        self.into_iter().for_each(|number| number.put(bytes));
    }
}

pub(crate) fn bytes_of<T: Bytes>(numbers: impl IntoIterator<Item = T>) -> Vec<u8> {
    let mut bytes = Vec::new();
    numbers.into_iter().for_each(|number| number.put(&mut bytes));
    bytes
}
