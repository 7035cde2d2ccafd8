//! Random scenes of the contact law `rigid`.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::glam::{Quat, Vec3};
use rockfall::{ContactLaw, Cuboid, Placement, Polygon, RigidBodyId, Scene, Shape, Sphere, SphereId, Surface};

/// Draws a scene.
pub(crate) struct Draw {
    pub(crate) rng: Pcg64Mcg,
    pub(crate) scene: Scene,
    pub(crate) dt: f32,
}

impl Draw {
    pub(crate) fn new(seed: u64) -> Self {
        let mut draw = Self { rng: Pcg64Mcg::seed_from_u64(seed), scene: Scene::new(), dt: 1.0 / 60.0 };
        let settings = &mut draw.scene.settings;
        settings.contact_law = ContactLaw::Rigid;
        settings.collisions = false;
        settings.gravity = 9.81;
        let (mu, e) = (draw.pick(&[0.0, 0.2, 0.5, 1.0]), draw.pick(&[0.0, 0.0, 0.3, 0.8, 1.0]));
        (draw.scene.settings.coulomb_friction, draw.scene.settings.restitution) = (mu, e);
        if draw.chance(0.2) {
            let direction = (Vec3::NEG_Y + draw.vector(0.5)).normalize();
            draw.scene.settings.gravity_direction = direction;
        }
        if draw.chance(0.1) {
            draw.scene.settings.gravity = 0.0;
        }
        draw.scene.run.substeps = Some([1, 2, 4, 4, 4, 8, 13][draw.number(7)]);
        draw.dt = draw.pick(&[1.0 / 60.0, 1.0 / 60.0, 1.0 / 120.0, 0.01]);
        draw
    }

    pub(crate) fn number(&mut self, below: usize) -> usize {
        self.rng.random_range(0..below)
    }

    pub(crate) fn pick(&mut self, from: &[f32]) -> f32 {
        from[self.number(from.len())]
    }

    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        self.rng.random_range(low..high)
    }

    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.rng.random_bool(probability)
    }

    pub(crate) fn vector(&mut self, size: f32) -> Vec3 {
        size * Vec3::from_array([0; 3].map(|_| self.rng.random_range(-1.0..1.0)))
    }

    pub(crate) fn turn(&mut self) -> Quat {
        Quat::from_scaled_axis(self.vector(2.0)).normalize()
    }

    /// A floor at y = 0: a box, a plane, a parallelogram, triangles or tiles. Some are belts.
    pub(crate) fn floor(&mut self) {
        let belt = if self.chance(0.15) { self.vector(2.0) } else { Vec3::ZERO };
        let flat = |polygon: Polygon| polygon.surface_velocity(belt);
        // L x R points upwards.
        let (corner, left, right) = (Vec3::new(-6.0, 0.0, -6.0), 12.0 * Vec3::Z, 12.0 * Vec3::X);
        let parallelogram = Polygon::new(corner, left, right);
        let polygons = match self.number(5) {
            0 => {
                let mut cuboid = Cuboid::between([-6.0, -1.0, -6.0], [6.0, 0.0, 6.0]);
                cuboid.surface_velocity = belt;
                self.scene.add_box(cuboid).expect("a box");
                vec![]
            }
            1 => {
                let mut plane = parallelogram;
                plane.surface = Surface::Plane;
                vec![plane]
            }
            2 => vec![parallelogram],
            3 => vec![Polygon::triangle(corner, corner + 2.0 * left, corner + 2.0 * right)],
            _ => self.tiles(),
        };
        polygons.into_iter().for_each(|polygon| _ = self.scene.add_polygon(flat(polygon)).expect("a polygon"));
    }

    fn tiles(&mut self) -> Vec<Polygon> {
        let by_boxes = self.chance(0.5);
        let mut found = Vec::new();
        for k in 0..9 {
            let corner = Vec3::new((k % 3) as f32 * 1.5 - 2.3, 0.0, (k / 3) as f32 * 1.5 - 2.1);
            if by_boxes {
                let cuboid = Cuboid::between(corner - Vec3::Y, corner + Vec3::new(1.5, 0.0, 1.5));
                self.scene.add_box(cuboid).expect("a box");
            } else {
                found.push(Polygon::new(corner, 1.5 * Vec3::Z, 1.5 * Vec3::X));
            }
        }
        found
    }

    /// A wall across x or z that stands on the floor.
    pub(crate) fn wall(&mut self) {
        let at = self.between(0.5, 1.0);
        let cuboid = if self.chance(0.5) {
            Cuboid::between([at, 0.0, -3.0], [at + 1.0, 3.0, 3.0])
        } else {
            Cuboid::between([-3.0, 0.0, at], [3.0, 3.0, at + 1.0])
        };
        self.scene.add_box(cuboid).expect("a box");
    }

    fn sphere(&mut self, at: Vec3, speed: f32) -> Sphere {
        let (mass, radius) = (self.between(0.3, 3.0), self.between(0.15, 0.4));
        let sphere = Sphere::new(at, radius).mass(mass).velocity(self.vector(speed));
        let spin = self.vector(6.0);
        sphere.angular_momentum(spin * sphere.inertia())
    }

    fn add(&mut self, sphere: Sphere) -> SphereId {
        self.scene.add_sphere(sphere).expect("a sphere")
    }

    pub(crate) fn ball(&mut self, at: Vec3, speed: f32) -> SphereId {
        let sphere = self.sphere(at, speed);
        self.add(sphere)
    }

    pub(crate) fn half(&mut self) -> Vec3 {
        Vec3::from_array([0; 3].map(|_| self.rng.random_range(0.15..0.5)))
    }

    pub(crate) fn cuboid(&mut self, half: Vec3, at: Vec3, turn: Quat, speed: f32, spin: f32) -> RigidBodyId {
        let mass = self.between(0.3, 3.0);
        let shape = Shape::new().cuboid(Cuboid::between(-half, half)).mass(mass);
        self.place(shape, at, turn, speed, spin)
    }

    pub(crate) fn place(&mut self, shape: Shape, at: Vec3, turn: Quat, speed: f32, spin: f32) -> RigidBodyId {
        let shape = self.scene.add_shape(shape).expect("a shape");
        let (velocity, spin) = (self.vector(speed), self.vector(spin));
        let placement = Placement::new(shape).centred_at(at.as_dvec3()).turned(turn).velocity(velocity).spin(spin);
        self.scene.add_body(placement).expect("a body")
    }

    /// Balls, a clump of balls or a body of a box and a ball.
    pub(crate) fn clump(&mut self, at: Vec3, speed: f32) {
        let mut shape = Shape::new().mass(self.between(0.5, 3.0));
        for _ in 0..2 + self.number(3) {
            let (centre, radius) = (self.vector(0.3), self.between(0.1, 0.3));
            shape = shape.sphere(centre, radius);
        }
        if self.chance(0.4) {
            let (low, high) = (self.vector(0.1), self.half());
            shape = shape.cuboid(Cuboid::between(low - high, low + high));
        }
        let turn = self.turn();
        self.place(shape, at, turn, speed, 5.0);
    }
}

/// Balls that fall on a floor, near it, with walls.
pub(crate) fn balls_on_floor(seed: u64) -> Draw {
    let mut draw = Draw::new(seed);
    draw.floor();
    if draw.chance(0.4) {
        draw.wall();
    }
    for number in 0..1 + draw.number(4) {
        let at = Vec3::new(1.2 * number as f32 - 1.5, 0.3, 0.0) + draw.vector(0.3);
        let speed = draw.pick(&[0.0, 1.0, 4.0, 20.0]);
        draw.ball(at.with_y(at.y.max(0.12)), speed);
    }
    draw
}

/// Balls that meet, some of them fixed.
pub(crate) fn balls_with_balls(seed: u64) -> Draw {
    let mut draw = Draw::new(seed);
    if draw.chance(0.5) {
        draw.floor();
    }
    for number in 0..2 + draw.number(5) {
        let at = Vec3::new(0.0, 1.0, 0.0) + draw.vector(0.6);
        let speed = draw.pick(&[0.5, 3.0, 10.0]);
        let mut sphere = draw.sphere(at, speed);
        if number > 0 && draw.chance(0.15) {
            sphere.fixed = true;
            (sphere.velocity, sphere.angular_momentum) = (Vec3::ZERO, Vec3::ZERO);
        } else {
            sphere.velocity -= 3.0 * (at - Vec3::Y);
        }
        draw.add(sphere);
    }
    draw
}

/// Boxes near a floor, some of them flat on it.
pub(crate) fn boxes_on_floor(seed: u64) -> Draw {
    let mut draw = Draw::new(seed);
    draw.floor();
    if draw.chance(0.3) {
        draw.wall();
    }
    for number in 0..1 + draw.number(2) {
        let (half, speed) = (draw.half(), draw.pick(&[0.0, 1.0, 4.0]));
        let place = Vec3::new(1.6 * number as f32 - 1.4, 0.0, 0.0) + draw.vector(0.2);
        let (turn, height) = if draw.chance(0.4) {
            (Quat::from_rotation_y(draw.between(-1.0, 1.0)), half.y)
        } else {
            (draw.turn(), 0.9 * half.length())
        };
        let at = place.with_y(height + draw.between(-0.01, 0.08));
        let spin = draw.pick(&[0.0, 1.0, 5.0]);
        draw.cuboid(half, at, turn, speed, spin);
    }
    draw
}

/// Boxes that meet in the air or lie on each other.
pub(crate) fn boxes_with_boxes(seed: u64) -> Draw {
    let mut draw = Draw::new(seed);
    let (half, speed) = (draw.half(), draw.pick(&[0.0, 1.0, 4.0]));
    if draw.chance(0.5) {
        draw.floor();
        draw.cuboid(half, Vec3::Y * half.y, Quat::from_rotation_y(0.3), 0.1, 0.1);
        let other = draw.half();
        let (turn, aside) = (Quat::from_rotation_y(draw.between(-1.0, 1.0)), draw.vector(0.2));
        let height = 2.0 * half.y + other.y + draw.between(-0.005, 0.03);
        draw.cuboid(other, aside.with_y(height), turn, speed, 0.5);
        return draw;
    }
    let turn = draw.turn();
    draw.cuboid(half, Vec3::Y, turn, speed, 3.0);
    for _ in 0..1 + draw.number(2) {
        let (other, turn, way) = (draw.half(), draw.turn(), draw.vector(1.0).normalize());
        let far = draw.between(0.75, 1.1) * 0.8 * (half.length() + other.length());
        draw.cuboid(other, Vec3::Y + far * way, turn, speed, 3.0);
    }
    draw
}

/// Bodies of several parts, boxes and balls together.
pub(crate) fn mixtures(seed: u64) -> Draw {
    let mut draw = Draw::new(seed);
    draw.floor();
    for number in 0..2 + draw.number(3) {
        let at = Vec3::new(0.8 * number as f32 - 1.2, 0.55, 0.0) + draw.vector(0.2);
        let speed = draw.pick(&[0.0, 1.0, 5.0]);
        match draw.number(3) {
            0 => _ = draw.ball(at, speed),
            1 => draw.clump(at, speed),
            _ => {
                let (half, turn) = (draw.half(), draw.turn());
                draw.cuboid(half, at, turn, speed, 3.0);
            }
        }
    }
    draw
}

/// Bodies that turn freely.
pub(crate) fn free_bodies(seed: u64) -> Draw {
    let mut draw = Draw::new(seed);
    for number in 0..3 {
        let at = Vec3::X * (3.0 * number as f32) + draw.vector(0.5);
        if draw.chance(0.5) {
            draw.clump(at, 3.0);
        } else {
            let (half, turn) = (draw.half(), draw.turn());
            draw.cuboid(half, at, turn, 3.0, 12.0);
        }
    }
    draw
}
