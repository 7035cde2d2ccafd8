//! More kinds of clusters: boxes, and objects of several kinds.

use rand::RngExt;
use rockfall::glam::Vec3;
use rockfall::{Cuboid, SphereId, Spring, Tether};

use crate::draw::Draw;

impl Draw {
    pub(crate) fn cuboid(&mut self) -> Cuboid {
        let (i, helper) = (self.direction(), self.direction());
        let j = i.cross(helper).normalize();
        let edges = [i, j, i.cross(j)].map(|edge| edge * self.between(0.6, 1.4));
        let cuboid = Cuboid::new(self.middle - 0.5 * (edges[0] + edges[1] + edges[2]), edges[0], edges[1], edges[2]);
        self.scene.add_box(cuboid).expect("a valid box");
        cuboid
    }

    /// Rods on edges and vertices of a box, with their axes outside or inside it.
    pub(crate) fn box_and_rods(&mut self) {
        let Cuboid { corner, edges: [i, j, k], .. } = self.cuboid();
        let count = self.rng.random_range(1..4);
        for number in 0..count {
            let vertex = self.chance(0.3);
            let out = -(j.normalize() + k.normalize() + if vertex { i.normalize() } else { Vec3::ZERO }).normalize();
            let depth = if self.chance(0.7) { self.between(0.02, 0.12) } else { self.between(-0.1, -0.02) };
            let helper = self.direction();
            let along = (j.normalize() - k.normalize() + 0.5 * helper.cross(out)).normalize();
            let start = if vertex { 0.0 } else { 0.25 * (number + 1) as f32 };
            let velocity = self.vector(0.5) - self.between(0.0, 3.0) * out;
            self.rod(corner + start * i + depth * out, along, 1.6, velocity, 0.1);
        }
    }

    /// Balls at faces, edges and vertices of a box, and inside it.
    pub(crate) fn box_and_balls(&mut self) {
        let Cuboid { corner, edges, .. } = self.cuboid();
        let count = self.rng.random_range(1..5);
        for _ in 0..count {
            let t = [0; 3].map(|_| self.between(-0.25, 1.25));
            let place = corner + t[0] * edges[0] + t[1] * edges[1] + t[2] * edges[2];
            let ball = self.ball(place);
            let pull = 2.0 * (self.middle - place);
            self.add(ball.velocity(ball.velocity + pull));
        }
        if self.chance(0.4) {
            let place = self.place(0.8);
            self.capsule(place, 2.0 * (self.middle - place));
        }
    }

    /// Fixed spheres with surface velocities, on their own and as ends of rods.
    pub(crate) fn rollers(&mut self) {
        for _ in 0..self.rng.random_range(1..3) {
            let place = self.place(0.4);
            let ball = self.ball(place);
            self.add(ball.fixed());
        }
        let (along, velocity) = (self.direction(), self.vector(1.0));
        let place = self.place(0.4);
        self.rod(place, along, 1.2, velocity, 0.5);
        let at = self.scene.spheres()[0];
        self.shoot(at.position, Vec3::ZERO, at.radius);
        let place = self.place(0.4);
        let ball = self.ball(place);
        self.add(ball);
    }

    pub(crate) fn groups(&mut self) {
        for number in 0..5 {
            let place = self.place(0.4);
            let ball = self.ball(place);
            self.add(ball.group(number % 2));
        }
        let cuboid = self.cuboid();
        self.scene.add_box(cuboid.group(1)).expect("a valid box");
    }

    pub(crate) fn everything(&mut self) {
        let place = self.place(0.4);
        let velocity = self.vector(1.0);
        self.capsule(place, velocity);
        let (place, along) = (self.place(0.4), self.direction());
        self.rod(place, along, 1.0, velocity, 0.1);
        for _ in 0..2 {
            let place = self.place(0.5);
            let ball = self.ball(place);
            self.add(ball);
        }
        let normal = self.direction();
        self.square(self.middle - 0.5 * normal, normal);
    }

    /// Springs, tethers, external forces and rods of free length on capsules, chains and fixed spheres.
    pub(crate) fn tied(&mut self) {
        let (place, velocity) = (self.place(0.3), self.vector(1.0));
        self.capsule(place, velocity);
        self.pendulum();
        let force = self.vector(6.0);
        self.rebuild(|sphere| if sphere.fixed { sphere } else { sphere.force(force) });
        let ids: Vec<SphereId> = self.scene.sphere_ids().collect();
        for pair in [[0, 2], [1, ids.len() - 1], [0, ids.len() - 2]] {
            let (stiffness, length) = (self.between(10.0, 200.0), self.between(0.2, 1.5));
            let damping = self.between(0.0, 4.0);
            let spring = Spring::new(ids[pair[0]], ids[pair[1]], stiffness, length).damping(damping);
            self.scene.add_spring(spring).expect("a valid spring");
        }
        let point = self.place(0.5);
        self.scene.add_tether(Tether::new(ids[1], point, 50.0)).expect("a valid tether");
        if self.chance(0.5) {
            self.join(ids[3], ids[ids.len() - 1], 0.1, None);
        }
        let at = self.place_of(ids[0]);
        self.shoot(at, velocity, 0.2);
    }

    /// Rods that are exactly parallel, along a coordinate axis.
    pub(crate) fn parallel(&mut self) {
        let along = Vec3::AXES[self.rng.random_range(0..3)];
        let (one, other) = along.any_orthonormal_pair();
        let (velocity, shift) = (self.vector(1.0), self.between(-0.8, 0.8));
        self.rod(self.middle, along, 1.25, velocity, 0.1);
        let place = self.middle + shift * along + self.between(0.1, 0.2) * one + self.between(0.02, 0.1) * other;
        self.rod(place, along, 1.25, velocity - 2.0 * one, 0.1);
        let place = self.place(0.4);
        let ball = self.ball(place);
        self.add(ball);
    }

    /// A zigzag chain whose links touch each other.
    pub(crate) fn folded(&mut self) {
        let mut last: Option<SphereId> = None;
        for link in 0..5 {
            let side = if link % 2 == 0 { -0.4 } else { 0.4 };
            let jitter = self.vector(0.1);
            let mut ball = self.ball(self.middle + Vec3::new(side, 0.16 * link as f32, 0.0) + jitter);
            ball.radius *= 0.4;
            ball.velocity -= 4.0 * (ball.position - self.middle);
            let next = self.add(ball);
            if let Some(last) = last {
                self.join(last, next, 0.12, Some(1.0));
            }
            last = Some(next);
        }
        if self.chance(0.5) {
            let at = self.middle;
            self.shoot(at, Vec3::ZERO, 0.2);
        }
    }
}
