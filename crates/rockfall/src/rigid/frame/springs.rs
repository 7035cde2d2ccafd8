//! Forces of springs, tethers and muscles (docs/physics section 11.9).

use glam::Vec3A;

use crate::rigid::frame::bodies::Bodies;
use crate::rigid::springs::Spring;
use crate::rigid::world::RigidWorld;
use crate::rotate::rotated;

/// Evaluates all springs in a substep of the frame, counted from 0. Each body adds the forces of its ends in order of addition.
pub(super) fn pull(world: &RigidWorld, bodies: &mut Bodies, substep: u32) {
    if world.springs.list.is_empty() {
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
    for (i, load) in loads.into_iter().enumerate() {
        if bodies.constants[i].sprung {
            bodies.pull(world, i, load);
        }
    }
}

/// The force on the end A, and the arms of both ends from the centres of their bodies.
fn force_of(spring: &Spring, length: f32, bodies: &Bodies) -> (Vec3A, [Vec3A; 2]) {
    let [a, b] = spring.bodies.map(|body| body as usize);
    let arm = |body: usize, side: usize| Vec3A::from(rotated(bodies.poses[body].turn, spring.places[side]));
    let arms = [arm(a, 0), arm(b, 1)];
    let way = Vec3A::from(bodies.poses[b].position - bodies.poses[a].position) + (arms[1] - arms[0]);
    let apart = way + Vec3A::from(bodies.periods.to_nearest(way.into()));
    let distance = apart.length();
    if distance == 0.0 {
        return (Vec3A::ZERO, arms);
    }
    let along = apart / distance;
    let speed = bodies.motions[b].at(arms[1]) - bodies.motions[a].at(arms[0]) + Vec3A::from(spring.belt);
    let force = spring.stiffness * (distance - length) + spring.damping * speed.dot(along);
    (force * along, arms)
}
