//! Springs, tethers and muscles between bodies, and the substep that they bound (docs/physics.md sections 11.9 and 11.10).

use glam::{DMat3, DVec3, Vec3};

use crate::model::muscles::muscle_length;
use crate::rigid::world::{Body, RigidWorld};
use crate::rotate::rotated;

/// Words of a muscle: its amplitude, its phase at the start of the frame, and the change of the phase in a substep, 64 bits each with the
/// low word first, in units of 2^-64 turns.
pub(crate) type MuscleWords = [u32; 5];

/// A spring, a tether or a muscle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spring {
    /// Bodies of its ends A and B. They differ, and at least one has mass.
    pub(crate) bodies: [u32; 2],
    /// Places of its ends in coordinates of the bodies.
    pub(crate) places: [Vec3; 2],
    /// In mass/s².
    pub(crate) stiffness: f32,
    /// In mass/s.
    pub(crate) damping: f32,
    /// Rest length, in units.
    pub(crate) length: f32,
    /// Velocity of the surface of a fixed sphere at B less that of one at A, in units/s.
    pub(crate) belt: Vec3,
    /// Number of its muscle.
    pub(crate) muscle: Option<u32>,
}

/// All springs of a world, in order of addition.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Springs {
    pub(crate) list: Vec<Spring>,
    /// The muscles in the present frame.
    pub(crate) muscles: Vec<MuscleWords>,
}

impl Springs {
    /// The rest length of a spring in a substep of the frame, counted from 0.
    pub(crate) fn length(&self, spring: &Spring, substep: u32) -> f32 {
        let muscle = spring.muscle.map(|number| self.muscles[number as usize]);
        muscle.map_or(spring.length, |muscle| muscle_length(muscle, spring.length, substep))
    }

    /// The greatest difference of the length of a spring from its rest lengths.
    fn strain(&self, spring: &Spring, length: f64) -> f64 {
        let muscle = spring.muscle.map(|number| self.muscles[number as usize]);
        let amplitude = muscle.map_or(0.0, |[amplitude, ..]| f64::from(f32::from_bits(amplitude)).abs());
        (length - f64::from(spring.length)).abs() + amplitude * f64::from(spring.length)
    }
}

/// What the springs of a world ask of the substep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SpringBound {
    /// The greatest stiffness over mass, in 1/s².
    pub(crate) stiffness: f64,
    /// The greatest damping over mass, in 1/s.
    pub(crate) damping: f64,
}

impl SpringBound {
    pub(crate) fn of(world: &RigidWorld) -> Self {
        let ends: Vec<[End; 2]> = world.springs.list.iter().map(|spring| ends(world, spring)).collect();
        // Of each body the sums of k sqrt(w), c sqrt(w) and f sqrt(lambda / J).
        let mut loads = vec![[0.0; 3]; world.bodies.len()];
        for (spring, ends) in world.springs.list.iter().zip(&ends) {
            for (body, end) in spring.bodies.iter().zip(ends) {
                let load = &mut loads[*body as usize];
                load[0] += f64::from(spring.stiffness) * end.root;
                load[1] += f64::from(spring.damping) * end.root;
                load[2] += end.turning;
            }
        }
        let row = |(spring, ends): (&Spring, &[End; 2]), what: usize| -> f64 {
            spring.bodies.iter().zip(ends).map(|(body, end)| end.root * loads[*body as usize][what]).sum()
        };
        let greatest = |what: usize| world.springs.list.iter().zip(&ends).map(|pair| row(pair, what)).fold(0.0, f64::max);
        let turning = loads.iter().map(|load| load[2]).fold(0.0, f64::max);
        Self { stiffness: greatest(0) + turning, damping: greatest(1) }
    }

    /// The longest substep, in s; infinite without springs.
    pub(crate) fn substep(&self) -> f64 {
        let Self { stiffness, damping } = *self;
        (1.0 / stiffness.sqrt()).min(4.0 / (damping + (damping * damping + 4.0 * stiffness).sqrt()))
    }

    /// The least number of substeps of a frame of `dt` seconds.
    pub(crate) fn substeps(&self, dt: f32) -> u32 {
        (f64::from(dt) / self.substep()).ceil().clamp(1.0, f64::from(u32::MAX)) as u32
    }
}

/// What the end of a spring means for its body. All 0 without mass.
#[derive(Clone, Copy, Debug, Default)]
struct End {
    /// The root of the greatest inverse mass of the body there.
    root: f64,
    /// f sqrt(lambda / J): the stiffness of the force of the spring against a rotation of the body, over its moments.
    turning: f64,
}

fn ends(world: &RigidWorld, spring: &Spring) -> [End; 2] {
    let bodies = spring.bodies.map(|body| &world.bodies[body as usize]);
    let point = |side: usize| {
        let pose = &bodies[side].pose;
        pose.position.as_dvec3() + rotated(pose.turn, spring.places[side]).as_dvec3()
    };
    let strain = world.springs.strain(spring, point(0).distance(point(1)));
    let force = f64::from(spring.stiffness) * strain;
    [0, 1].map(|side| end(bodies[side], spring.places[side], force))
}

fn end(body: &Body, place: Vec3, force: f64) -> End {
    if body.inverse_mass == 0.0 {
        return End::default();
    }
    let moments = body.moments.as_dvec3();
    let turning = greatest_response(body.axes.as_dquat().inverse() * place.as_dvec3(), moments);
    let root = (f64::from(body.inverse_mass) + turning).sqrt();
    End { root, turning: force * (turning / moments.min_element()).sqrt() }
}

/// The greatest (r x n) . I^-1 (r x n) of all directions n, with the arm r along the principal axes.
fn greatest_response(arm: DVec3, moments: DVec3) -> f64 {
    let cross =
        DMat3::from_cols(DVec3::new(0.0, arm.z, -arm.y), DVec3::new(-arm.z, 0.0, arm.x), DVec3::new(arm.y, -arm.x, 0.0));
    let response = cross.transpose() * DMat3::from_diagonal(moments.recip()) * cross;
    // One eigenvalue is 0, that of the arm. The others are the roots of a quadratic.
    let [x, y, z] = [response.x_axis, response.y_axis, response.z_axis];
    let trace = x.x + y.y + z.z;
    let minors = x.x * y.y - x.y * y.x + x.x * z.z - x.z * z.x + y.y * z.z - y.z * z.y;
    0.5 * (trace + (trace * trace - 4.0 * minors).max(0.0).sqrt())
}
