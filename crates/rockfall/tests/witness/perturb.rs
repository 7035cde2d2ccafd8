//! States that differ from others by rounding errors of f32.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::glam::DVec3;

use crate::world::{Ball, Sweeps, World};

/// Half a unit in the last place of an f32, relative.
pub(crate) const EPS: f64 = 6e-8;

/// Magnitudes that determine rounding errors.
pub(crate) struct Scale {
    pub(crate) place: f64,
    pub(crate) speed: f64,
}

pub(crate) fn scale(world: &World) -> Scale {
    let moving = |ball: &Ball| ball.v.length().max(ball.spin().length() * ball.radius);
    let g = world.set.gravity.length() * world.dt;
    let balls = || world.balls.iter();
    let places = balls().map(|ball| ball.x.abs().max_element() + ball.radius);
    Scale { place: places.fold(0.0, f64::max), speed: balls().map(moving).fold(g, f64::max) }
}

/// The world with a random perturbation of the size of rounding errors.
pub(crate) fn perturbed(world: &World, seed: u64) -> World {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let scale = scale(world);
    let mut near = |size: f64| 3.0 * EPS * size * rng.random_range(-1.0..1.0);
    let mut world = World { sweeps: Sweeps::WithinTolerance(seed), slack: near(10.0), ..world.clone() };
    for ball in &mut world.balls {
        for axis in 0..3 {
            ball.x[axis] += near(scale.place);
            ball.v[axis] += near(scale.speed);
            ball.l[axis] += near(scale.speed * ball.inertia() / ball.radius);
        }
        ball.radius += near(ball.radius);
        ball.mass += near(ball.mass);
    }
    for bar in &mut world.bars {
        bar.radius += near(bar.radius);
        bar.length = bar.length.map(|length| length + near(length));
    }
    let mut off = |vector: &mut DVec3, least: f64| {
        let size = vector.length().max(least);
        *vector += DVec3::from_array([0; 3].map(|_| near(size)));
    };
    for block in &mut world.blocks_at_rest {
        block.edges.iter_mut().for_each(|edge| off(edge, 0.0));
        off(&mut block.corner, scale.place);
    }
    for face in &mut world.faces_at_rest {
        [&mut face.left, &mut face.right].into_iter().for_each(|edge| off(edge, 0.0));
        off(&mut face.corner, scale.place);
    }
    world.set.restitution += near(1.0);
    world.place_walls(world.time);
    world
}
