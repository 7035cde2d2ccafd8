//! The substep that springs bound (docs/physics section 11.10).

use glam::{DMat3, DVec3, Vec3};

use crate::rigid::springs::Spring;
use crate::rigid::world::{Body, RigidWorld};
use crate::rotate::rotated;

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
