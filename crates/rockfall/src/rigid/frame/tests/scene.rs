//! A small builder of scenes.

use glam::{DMat3, DVec3, Quat, Vec3};

use crate::rigid::common::FREQUENCY;
use crate::rigid::frame::{Frame, FrameReport, advance};
use crate::rigid::groups::GroupWords;
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Shape};
use crate::rigid::world::{Body, Collider, Kind, RigidWorld, Surface};

pub(super) const DT: f32 = 1.0 / 60.0;
pub(super) const G: f32 = 9.81;

/// A world with one surface for all contacts; y is up.
pub(super) struct Scene {
    pub(super) world: RigidWorld,
    pub(super) substeps: u32,
    pub(super) last: FrameReport,
    pub(super) repeats: u32,
}

impl Scene {
    pub(super) fn new(friction: f32, restitution: f32) -> Self {
        let world = RigidWorld {
            bodies: vec![Body::fixed(Kind::World, Pose::IDENTITY)],
            surfaces: vec![Surface { friction, restitution }],
            materials: 1,
            gravity: Vec3::new(0.0, -G, 0.0),
            ..RigidWorld::default()
        };
        Self { world, substeps: 4, last: FrameReport::default(), repeats: 0 }
    }

    /// A stack of unit cubes, which have the numbers from 1 on.
    pub(super) fn stack(count: usize) -> Self {
        let mut scene = Self::new(0.5, 0.0);
        scene.floor();
        for k in 0..count {
            scene.cuboid(Vec3::splat(0.5), Vec3::new(0.0, k as f32 + 0.5, 0.0));
        }
        scene
    }

    pub(super) fn weightless(mut self) -> Self {
        self.world.gravity = Vec3::ZERO;
        self
    }

    pub(super) fn substeps(mut self, substeps: u32) -> Self {
        self.substeps = substeps;
        self
    }

    /// A collider of a body. Equal shapes are stored once.
    pub(super) fn attach(&mut self, body: usize, shape: Shape, place: Pose) {
        let known = self.world.shapes.iter().position(|old| *old == shape);
        let shape = known.unwrap_or_else(|| {
            self.world.shapes.push(shape);
            self.world.shapes.len() - 1
        });
        self.world.colliders.push(Collider {
            body: body as u32,
            shape: shape as u32,
            place,
            group: GroupWords::default(),
            material: 0,
            surface_velocity: Vec3::ZERO,
        });
    }

    /// A half-space of the world: the point and the outward normal of its plane.
    pub(super) fn plane(&mut self, point: Vec3, normal: Vec3) {
        let turn = Quat::from_rotation_arc(Vec3::Y, normal.normalize());
        self.attach(0, Shape { core: Core::HalfSpace, radius: 0.0 }, Pose::new(point, turn));
    }

    pub(super) fn floor(&mut self) {
        self.plane(Vec3::ZERO, Vec3::Y);
    }

    /// A box of the world.
    /// A triangle of the world, touched on both sides.
    pub(super) fn triangle(&mut self, corners: [Vec3; 3]) {
        let [a, b, c] = corners;
        let centre = (a + b + c) / 3.0;
        let turn = Quat::from_rotation_arc(Vec3::Z, (b - a).cross(c - a).normalize());
        let [u, v] = [a, b].map(|corner| (turn.inverse() * (corner - centre)) * Vec3::new(1.0, 1.0, 0.0));
        let core = Core::Face { u, v, is_triangle: true, one_sided: false, is_facet: false };
        self.attach(0, Shape { core, radius: 0.0 }, Pose::new(centre, turn));
    }

    /// A floor of triangles from (-1, -1) to (x, z) at the height 0: squares of this size in two halves.
    pub(super) fn mesh(&mut self, size: f32, x: f32, z: f32) {
        let counts = [x, z].map(|end| ((end + 1.0) / size) as u32);
        for i in 0..counts[0] {
            for k in 0..counts[1] {
                let corner = |di: u32, dk: u32| Vec3::new((i + di) as f32 * size - 1.0, 0.0, (k + dk) as f32 * size - 1.0);
                self.triangle([corner(0, 0), corner(0, 1), corner(1, 0)]);
                self.triangle([corner(1, 1), corner(1, 0), corner(0, 1)]);
            }
        }
    }

    pub(super) fn block(&mut self, half: Vec3, pose: Pose) {
        self.attach(0, Shape::cuboid(half), pose);
    }

    /// A body of one shape and its number.
    pub(super) fn body(&mut self, shape: Shape, pose: Pose, mass: f32) -> usize {
        let (volume, tensor) = shape.mass();
        let values = tensor * DMat3::from_diagonal(DVec3::splat(f64::from(mass) / volume));
        let moments = DVec3::new(values.x_axis.x, values.y_axis.y, values.z_axis.z).as_vec3();
        let mut body = Body::loose(pose, mass, moments, Quat::IDENTITY);
        (body.radius, body.width) = (shape.extent(), shape.width());
        self.world.bodies.push(body);
        let number = self.world.bodies.len() - 1;
        self.attach(number, shape, Pose::IDENTITY);
        number
    }

    pub(super) fn ball(&mut self, radius: f32, at: Vec3) -> usize {
        self.body(Shape::ball(radius), Pose::new(at, Quat::IDENTITY), 1.0)
    }

    pub(super) fn cuboid(&mut self, half: Vec3, at: Vec3) -> usize {
        self.body(Shape::cuboid(half), Pose::new(at, Quat::IDENTITY), 1.0)
    }

    pub(super) fn kinematic(&mut self, shape: Shape, at: Vec3, velocity: Vec3) -> usize {
        let mut body = Body::fixed(Kind::Kinematic, Pose::new(at, Quat::IDENTITY));
        (body.velocity, body.radius) = (velocity, shape.extent());
        self.world.bodies.push(body);
        let number = self.world.bodies.len() - 1;
        self.attach(number, shape, Pose::IDENTITY);
        number
    }

    pub(super) fn throw(&mut self, body: usize, velocity: Vec3, spin: Vec3) {
        self.world.bodies[body].velocity = velocity;
        self.world.bodies[body].set_spin(spin);
    }

    pub(super) fn at(&self, body: usize) -> Vec3 {
        self.world.bodies[body].pose.position
    }

    pub(super) fn velocity(&self, body: usize) -> Vec3 {
        self.world.bodies[body].velocity
    }

    pub(super) fn spin(&self, body: usize) -> Vec3 {
        self.world.bodies[body].spin
    }

    pub(super) fn step(&mut self) {
        self.last = advance(&mut self.world, DT, self.substeps);
        self.repeats += self.last.repeats;
    }

    pub(super) fn run(&mut self, seconds: f32) {
        for _ in 0..(seconds / DT).round() as u32 {
            self.step();
        }
    }
}

pub(super) fn close(value: f32, wanted: f32, within: f32) {
    assert!((value - wanted).abs() <= within, "{value}, not {wanted} +- {within}");
}

/// Energy of the contacts as springs of the stiffness w² / K, which `energy` leaves out.
pub(super) fn spring_energy(scene: &Scene) -> f64 {
    let world = &scene.world;
    let frame = Frame::open(world, DT, scene.substeps);
    let mut sum = 0.0;
    for block in &frame.contacts.blocks {
        let both = block.bodies.map(|body| &world.bodies[body as usize]);
        for pair in &frame.contacts.pairs[block.pair_range()] {
            for row in &frame.contacts.rows[pair.first as usize..pair.first as usize + usize::from(pair.count)] {
                let resists = |body: &Body, arm: Vec3| {
                    let moment = arm.cross(pair.normal.into());
                    body.inverse_mass + moment.dot(body.inverse_inertia * moment)
                };
                let k = resists(both[0], row.arm_a.into()) + resists(both[1], row.arm_b.into());
                let frequency = if block.fixed { 2.0 * FREQUENCY } else { FREQUENCY };
                let w = std::f32::consts::TAU * frequency * scene.substeps as f32 / DT;
                sum += f64::from(0.5 * w * w / k * row.gap.min(0.0).powi(2));
            }
        }
    }
    sum
}

/// Numbers that look random.
pub(super) struct Random(pub(super) u32);

impl Random {
    /// From -1 to 1.
    pub(super) fn number(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let x = (self.0 >> ((self.0 >> 28) + 4)) ^ self.0;
        let x = x.wrapping_mul(277_803_737);
        ((x >> 22) ^ x) as f32 / 2.0_f32.powi(31) - 1.0
    }

    pub(super) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }
}
