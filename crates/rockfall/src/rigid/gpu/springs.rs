//! Springs on a device: their rows, and the list of ends of each body (`rigid/frame/springs.wgsl`).

use bytemuck::cast_slice;

use crate::rigid::gpu::arrays::Arrays;
use crate::rigid::gpu::kernels::{ENDS_OF_SPRINGS, MUSCLES, SPRINGS};
use crate::rigid::gpu::rows::ConstantRow;
use crate::rigid::springs::{MuscleWords, Spring, Springs};

/// The muscle of a spring that has none.
const NO_MUSCLE: u32 = u32::MAX;
/// Rows of a spring.
const SPRING_ROWS: u64 = 4;

/// What the host keeps of the springs on a device.
#[derive(Clone, Debug, Default)]
pub(super) struct OnDevice {
    /// Bodies with mass at which springs end.
    bodies: Vec<u32>,
    /// Number of springs.
    springs: u32,
    /// The muscles in the present frame.
    muscles: Vec<MuscleWords>,
}

impl OnDevice {
    /// Uploads the springs of a world. `constants` are the rows of its bodies.
    pub(super) fn new(arrays: &mut Arrays, springs: &Springs, constants: &[ConstantRow]) -> Self {
        let has_mass = |body: &u32| constants[*body as usize].acceleration[3] != 0.0;
        // Forces of the program act on all bodies.
        let all = arrays.laws.iter().flat_map(|_| 0..constants.len() as u32);
        let mut bodies: Vec<u32> = springs.list.iter().flat_map(|spring| spring.bodies).chain(all).filter(has_mass).collect();
        bodies.sort_unstable();
        bodies.dedup();
        if bodies.is_empty() {
            return Self::default();
        }
        let rows: Vec<[u32; 4]> = springs.list.iter().flat_map(rows_of).chain(bases(&bodies, constants)).collect();
        arrays.upload(SPRINGS, cast_slice(&rows));
        arrays.upload(ENDS_OF_SPRINGS, cast_slice(&ends(springs, &bodies, constants.len())));
        arrays.make(MUSCLES, 4 * (bodies.len() + 5 * springs.muscles.len()) as u64);
        Self { springs: springs.list.len() as u32, muscles: springs.muscles.clone(), bodies }
    }

    /// Bodies with mass at which springs end.
    pub(super) fn bodies(&self) -> u32 {
        self.bodies.len() as u32
    }

    /// Takes over the field and the external forces of the bodies.
    pub(super) fn set_bases(&self, arrays: &Arrays, constants: &[ConstantRow]) {
        if !self.bodies.is_empty() {
            let rows: Vec<[u32; 4]> = bases(&self.bodies, constants).collect();
            let place = 16 * SPRING_ROWS * u64::from(self.springs);
            arrays.gpu.queue.write_buffer(arrays.get(SPRINGS), place, cast_slice(&rows));
        }
    }

    /// Takes over the muscles of a frame.
    pub(super) fn set_muscles(&mut self, muscles: &[MuscleWords]) {
        self.muscles.copy_from_slice(muscles);
    }

    /// Begins a frame: no substep is done.
    pub(super) fn begin(&self, arrays: &Arrays) {
        if !self.bodies.is_empty() {
            let words: Vec<u32> =
                std::iter::repeat_n(0, self.bodies.len()).chain(self.muscles.iter().flatten().copied()).collect();
            arrays.gpu.queue.write_buffer(arrays.get(MUSCLES), 0, cast_slice(&words));
        }
    }
}

/// What the forces of springs come on top of: g + F/m and the torque of each body.
fn bases(bodies: &[u32], constants: &[ConstantRow]) -> impl Iterator<Item = [u32; 4]> {
    bodies.iter().flat_map(|body| {
        let ConstantRow { acceleration, torque, .. } = constants[*body as usize];
        [acceleration, torque].map(|row| row.map(f32::to_bits))
    })
}

fn rows_of(spring: &Spring) -> [[u32; 4]; 4] {
    let row = |vector: glam::Vec3, last: f32| vector.extend(last).to_array().map(f32::to_bits);
    let [a, b] = spring.bodies;
    [
        row(spring.places[0], spring.stiffness),
        row(spring.places[1], spring.damping),
        row(spring.belt, spring.length),
        [a, b, spring.muscle.unwrap_or(NO_MUSCLE), 0],
    ]
}

/// The words of `ends`.
fn ends(springs: &Springs, bodies: &[u32], count: usize) -> Vec<u32> {
    let mut lists = vec![Vec::new(); count];
    for (number, spring) in (0_u32..).zip(&springs.list) {
        for (side, body) in (0..).zip(spring.bodies) {
            lists[body as usize].push(2 * number + side);
        }
    }
    let mut words = vec![springs.list.len() as u32, bodies.len() as u32, springs.muscles.len() as u32];
    let mut at = (words.len() + 2 * bodies.len() + 2) as u32;
    for body in bodies {
        words.extend([*body, at]);
        at += lists[*body as usize].len() as u32;
    }
    words.extend([0, at]);
    words.extend(bodies.iter().flat_map(|body| &lists[*body as usize]));
    words
}
