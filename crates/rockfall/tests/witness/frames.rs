//! Frames of rods of fixed length, which are rigid bodies (docs/physics.md section 1.6).

use rockfall::glam::{DQuat, DVec3};
use rockfall::{Backend, MassProperties, Options, Simulation};

use crate::bodies::Clump;
use crate::geometry::Thing;
use crate::perturb::scale;
use crate::scenes::{self, together};
use crate::world::{Ball, Body, Mistake, World};

/// Most spheres of a frame.
const MOST: usize = 100;
/// A row of the matrix of rates of change of lengths depends on the rows before if this part of it is left.
const DEPENDENT: f64 = 1e-6;
/// Relative error of the lengths of a frame that is formed.
const LENGTHS: f64 = 1e-6;
/// Largest number of sweeps over the lengths of a frame.
const SWEEPS: usize = 10_000;

impl Clump {
    /// A body of these spheres. `form` gives it its state.
    fn frame(members: Vec<usize>) -> Self {
        let members = members.into_iter().map(|ball| (ball, DVec3::ZERO)).collect();
        let (x, v, l, q) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DQuat::IDENTITY);
        Self { x, v, l, q, mass: 0.0, moments: DVec3::ONE, axes: q, members, implied: true }
    }

    /// Takes the state of its spheres.
    fn form(&mut self, balls: &[Ball], points: bool) {
        let own: Vec<&Ball> = self.members.iter().map(|&(ball, _)| &balls[ball]).collect();
        self.mass = own.iter().map(|ball| ball.mass).sum();
        self.x = own.iter().map(|ball| ball.mass * ball.x).sum::<DVec3>() / self.mass;
        self.v = own.iter().map(|ball| ball.mass * ball.v).sum::<DVec3>() / self.mass;
        self.l = own.iter().map(|ball| ball.mass * (ball.x - self.x).cross(ball.v - self.v) + ball.l).sum();
        self.q = own[0].q;
        let inverse = self.q.inverse();
        self.members.iter_mut().for_each(|(ball, arm)| *arm = inverse * (balls[*ball].x - self.x));
        self.weigh(balls, points);
    }

    /// Computes the principal moments and axes from the places of the spheres. `points` leaves out their own moments.
    pub(crate) fn weigh(&mut self, balls: &[Ball], points: bool) {
        let mut inertia = [0.0; 6];
        for &(ball, arm) in &self.members {
            let ball = &balls[ball];
            let own = if points { 0.0 } else { ball.inertia() };
            let round = ball.mass * arm.length_squared() + own;
            for k in 0..3 {
                inertia[k] += round - ball.mass * arm[k] * arm[k];
            }
            for (at, [j, k]) in [(3, [0, 1]), (4, [0, 2]), (5, [1, 2])] {
                inertia[at] -= ball.mass * arm[j] * arm[k];
            }
        }
        (self.moments, self.axes) = MassProperties { mass: self.mass, centre: [0.0; 3], inertia }.principal();
    }
}

impl World {
    /// Makes bodies of the networks that can move only as rigid bodies.
    pub(crate) fn find_frames(&mut self) {
        for number in 0..self.networks.len() {
            let members: Vec<usize> =
                (0..self.balls.len()).filter(|&ball| self.body[ball] == Some(Body::Network(number))).collect();
            if (3..=MOST).contains(&members.len()) && self.is_rigid(&members, &self.networks[number]) {
                self.networks[number].clear();
                self.clumps.push(Clump::frame(members));
            }
        }
    }

    /// Whether rods allow no motion of spheres but that of a rigid body.
    fn is_rigid(&self, members: &[usize], rods: &[usize]) -> bool {
        let moving = |bar: &usize| self.bars[*bar].ends.into_iter().all(|end| !self.balls[end].fixed);
        rods.iter().all(moving) && self.rank(members, rods) == 3 * members.len() - 6
    }

    /// Rank of the matrix that maps velocities of spheres to rates of change of lengths.
    fn rank(&self, members: &[usize], rods: &[usize]) -> usize {
        let place = |ball: usize| members.iter().position(|&member| member == ball).expect("a sphere of the network");
        let mut basis: Vec<Vec<DVec3>> = Vec::new();
        for &rod in rods {
            let [one, two] = self.bars[rod].ends;
            let axis = (self.balls[two].x - self.balls[one].x).normalize_or_zero();
            let mut row = vec![DVec3::ZERO; members.len()];
            (row[place(one)], row[place(two)]) = (-axis, axis);
            // Twice, because the first time leaves rounding errors.
            for known in basis.iter().chain(&basis) {
                let along = product(&row, known);
                row.iter_mut().zip(known).for_each(|(own, other)| *own -= along * *other);
            }
            let left = product(&row, &row).sqrt();
            if left > DEPENDENT {
                row.iter_mut().for_each(|entry| *entry /= left);
                basis.push(row);
            }
        }
        basis.len()
    }

    /// Gives frames the state of their spheres.
    pub(crate) fn form_frames(&mut self) {
        let points = self.made(Mistake::FrameInertia);
        for clump in self.clumps.iter_mut().filter(|clump| clump.implied) {
            clump.form(&self.balls, points);
        }
    }

    /// Restores the lengths of the rods of frames.
    pub(crate) fn restore_frames(&mut self) {
        for _ in 0..SWEEPS {
            let mut worst = 0.0_f64;
            for number in 0..self.bars.len() {
                let [one, two] = self.bars[number].ends;
                let Some(length) = self.bars[number].length.filter(|_| self.clump_of(Thing::Bar(number)).is_some()) else {
                    continue;
                };
                let d = self.balls[two].x - self.balls[one].x;
                let w = [one, two].map(|end| self.balls[end].w());
                let way = (d.length() - length) / (w[0] + w[1]) * d.normalize();
                self.balls[one].x += w[0] * way;
                self.balls[two].x -= w[1] * way;
                worst = worst.max((d.length() - length).abs() / length);
            }
            if worst <= LENGTHS {
                return;
            }
        }
        self.lost = true;
    }
}

fn product(one: &[DVec3], two: &[DVec3]) -> f64 {
    one.iter().zip(two).map(|(a, b)| a.dot(*b)).sum()
}

/// Bodies are formed from spheres at any places and with any velocities, before the first step.
#[test]
fn frames_are_formed_as_specified() {
    let (mut formed, mut moved) = (0, 0.0_f64);
    for seed in (7..4_000).step_by(scenes::KINDS) {
        let plan = scenes::plan(seed, 1, 1);
        let world = World::of(&plan.clusters[0], plan.integrator, 0.0);
        if world.clumps.is_empty() {
            continue;
        }
        let scale = scale(&world);
        moved = moved.max(world.balls[0].x.distance(plan.clusters[0].spheres()[0].position.as_dvec3()) / scale.place);
        let options = Options::new().backend(Backend::Cpu).integrator(plan.integrator);
        let mut simulation = Simulation::with_options(together(&plan), options).expect("the simulation opens");
        let states = simulation.spheres().expect("spheres are read back");
        for (ball, state) in world.balls.iter().zip(&states) {
            let mut seen = ball.clone();
            seen.set(state);
            // Lengths hold within 1e-6.
            let [x, v, l] = [seen.x - ball.x, seen.v - ball.v, seen.l - ball.l].map(DVec3::length);
            let spin = scale.speed * ball.inertia() / ball.radius;
            assert!(x < 5e-6 * scale.place && v < 5e-5 * scale.speed && l < 5e-5 * spin, "seed {seed}: {x} {v} {l}");
        }
        formed += 1;
    }
    assert!(formed > 60 && moved > 1e-3, "{formed} {moved}");
}
