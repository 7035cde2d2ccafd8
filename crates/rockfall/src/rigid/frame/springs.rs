//! Forces of springs, tethers and muscles, and of the program (docs/physics section 11.9).

use glam::Vec3A;

use crate::rigid::frame::bodies::Bodies;
use crate::rigid::springs::Spring;
use crate::rigid::world::RigidWorld;
use crate::rotate::rotated;
use crate::user_laws::ForceInput;

/// Evaluates all springs and forces of the program in a substep of `h` seconds, counted from 0. Each body adds the forces of its ends in
/// order of addition, and then those of the program.
pub(super) fn pull(world: &RigidWorld, bodies: &mut Bodies, substep: u32, h: f32) {
    if world.springs.list.is_empty() && world.laws.is_empty() {
        return;
    }
    let mut loads = vec![[Vec3A::ZERO; 2]; bodies.count()];
    for spring in &world.springs.list {
        let (force, arms) = force_of(spring, world.springs.length(spring, substep), bodies);
        let [a, b] = spring.bodies.map(|body| body as usize);
        loads[a][0] += force;
        loads[a][1] += arms[0].cross(force);
        loads[b][0] -= force;
        loads[b][1] -= arms[1].cross(force);
    }
    if !world.laws.is_empty() {
        for (i, load) in loads.iter_mut().enumerate().filter(|(i, _)| bodies.constants[*i].dynamic) {
            let [force, torque] = world.laws.load(&input_of(bodies, i), substep, h);
            *load = [load[0] + force, load[1] + torque];
        }
    }
    for (i, load) in loads.into_iter().enumerate() {
        if bodies.constants[i].sprung {
            bodies.pull(world, i, load);
        }
    }
}

/// What the forces of the program know of a body.
fn input_of(bodies: &Bodies, i: usize) -> ForceInput<'static> {
    ForceInput {
        position: bodies.poses[i].position,
        velocity: bodies.motions[i].velocity.into(),
        angular_velocity: bodies.motions[i].spin.into(),
        mass: 1.0 / bodies.masses[i].inverse_mass,
        radius: bodies.constants[i].radius,
        time: 0.0,
        parameters: &[],
    }
}

/// The force on the end A, and the arms of both ends from the centres of their bodies.
fn force_of(spring: &Spring, length: f32, bodies: &Bodies) -> (Vec3A, [Vec3A; 2]) {
    let [a, b] = spring.bodies.map(|body| body as usize);
    let arm = |body: usize, side: usize| Vec3A::from(rotated(bodies.poses[body].turn, spring.places[side]));
    let arms = [arm(a, 0), arm(b, 1)];
    let way = Vec3A::from(bodies.poses[b].position - bodies.poses[a].position) + (arms[1] - arms[0]);
    let apart = way + Vec3A::from(bodies.periods.nearest(way.into()));
    let distance = apart.length();
    if distance == 0.0 {
        return (Vec3A::ZERO, arms);
    }
    let along = apart / distance;
    let speed = bodies.motions[b].at(arms[1]) - bodies.motions[a].at(arms[0]) + Vec3A::from(spring.belt);
    let force = spring.stiffness * (distance - length) + spring.damping * speed.dot(along);
    (force * along, arms)
}
