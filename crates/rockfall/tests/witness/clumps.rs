//! Random scenes with rigid bodies of spheres and rods, and copies of such bodies.

use rand::RngExt;
use rockfall::glam::{Quat, Vec3};
use rockfall::{Cuboid, Placement, RigidBody, RigidBodyId, Scene, Shape, ShapeMass, Sphere, SphereId, Spring, Tether};

use crate::draw::Draw;

/// How a scene is copied.
pub(crate) struct Scale {
    /// Factor of all lengths.
    pub(crate) size: f32,
    /// Number added to all groups.
    pub(crate) groups: u16,
}

/// Adds the spheres and the rigid bodies of a scene to another one, in the same order. `change` makes a copy of a sphere, `mass` is the
/// factor of the mass of a body, by its first sphere.
pub(crate) fn copy_spheres(
    from: &Scene,
    to: &mut Scene,
    scale: &Scale,
    change: impl Fn(usize, Sphere) -> Sphere,
    mass: impl Fn(usize) -> f32,
) {
    for (at, (id, sphere)) in from.sphere_ids().zip(from.spheres()).enumerate() {
        let Some(body) = from.body_of_sphere(id).map(|body| from.body(body).expect("a body of the scene")) else {
            to.add_sphere(change(at, *sphere)).expect("a valid sphere");
            continue;
        };
        // The first sphere of a body brings the others.
        if body.spheres()[0] == id {
            copy_body(from, to, body, scale, mass(at));
        }
    }
}

fn copy_body(from: &Scene, to: &mut Scene, body: &RigidBody, &Scale { size, groups }: &Scale, factor: f32) {
    let old = from.shape(body.shape).expect("the shape of a body");
    let mut shape = Shape::new();
    for sphere in &old.spheres {
        shape = shape.group(groups + sphere.group).sphere(size * sphere.centre, size * sphere.radius);
    }
    for rod in &old.rods {
        shape = shape.group(groups + rod.group).rod(rod.end1, rod.end2, size * rod.radius);
    }
    for part in &old.boxes {
        let Cuboid { corner, edges: [i, j, k], group, .. } = part.cuboid;
        shape = shape.group(groups + group).cuboid(Cuboid::new(size * corner, size * i, size * j, size * k));
    }
    shape = shape.rounding(size * old.rounding);
    let ShapeMass::Given { mass, centre, inertia } = old.mass else { panic!("the mass properties are given") };
    let inertia = inertia.map(|element| factor * size * size * element);
    let shape = shape.mass_properties(factor * mass, size * centre, inertia);
    let shape = to.add_shape(shape).expect("a valid shape");
    let centre = body.centre().map(|x| f64::from(size) * x);
    let placed = Placement::new(shape).centred_at(centre).turned(body.orientation).velocity(size * body.velocity);
    let momentum = factor * size * size * body.angular_momentum;
    to.add_body(placed.angular_momentum(momentum)).expect("a valid body");
}

impl Draw {
    /// Sets the mass properties of a shape: those of its parts, or any.
    pub(crate) fn weighed(&mut self, shape: Shape) -> Shape {
        let mass = self.between(0.5, 3.0);
        if self.chance(0.2) {
            // Written as numbers, because overlaps take long to integrate and scenes are copied several times.
            let own = shape.clone().mass(mass).mass_properties_of().expect("a valid shape");
            let centre = Vec3::from_array(own.centre.map(|x| x as f32));
            return shape.mass_properties(mass, centre, own.inertia.map(|element| element as f32));
        }
        let (centre, arms) = (self.vector(0.1), self.vector(0.25) + Vec3::splat(0.35));
        // Moments of masses at the distances `arms` along the axes.
        let [x, y, z] = (mass * arms * arms).to_array();
        let off = if self.chance(0.5) { 0.2 * x.min(y).min(z) } else { 0.0 };
        shape.mass_properties(mass, centre, [y + z, x + z, x + y, off, -off, 0.5 * off])
    }

    fn body(&mut self, shape: Shape, at: Vec3, velocity: Vec3) -> RigidBodyId {
        let shape = self.weighed(shape);
        let shape = self.scene.add_shape(shape).expect("a valid shape");
        let (spin, turn) = (self.vector(4.0), self.direction());
        let turn = Quat::from_axis_angle(turn, self.between(0.0, 3.0));
        let placed = Placement::new(shape).at(at.as_dvec3()).turned(turn).velocity(velocity).spin(spin);
        self.scene.add_body(placed).expect("a valid body")
    }

    /// A body of one to five spheres, most of which overlap, with rods between the first ones at times.
    fn clump(&mut self, at: Vec3, velocity: Vec3) -> RigidBodyId {
        let mut shape = Shape::new();
        let mut place = Vec3::ZERO;
        let count = self.rng.random_range(1..6);
        for _ in 0..count {
            shape = shape.sphere(place, self.between(0.12, 0.3));
            place += self.direction() * self.between(0.15, 0.45);
        }
        if count > 1 && self.chance(0.3) {
            let radius = self.between(0.05, 0.2);
            shape = shape.rod(0, 1, radius);
            if count > 2 && self.chance(0.5) {
                shape = shape.rod(1, 2, radius);
            }
        }
        self.body(shape, at, velocity)
    }

    /// A random sphere of a body.
    fn member(&mut self, body: RigidBodyId) -> SphereId {
        let spheres = self.scene.body(body).expect("a body").spheres();
        spheres[self.rng.random_range(0..spheres.len())]
    }

    /// Shoots a ball at a random sphere of a body.
    fn shoot_body(&mut self, body: RigidBodyId) {
        let member = self.member(body);
        let hit = *self.scene.sphere(member).expect("a sphere");
        self.shoot(hit.position, hit.velocity, hit.radius);
    }

    /// A clump that balls hit. It may hang on springs.
    pub(crate) fn clump_and_balls(&mut self) {
        let velocity = self.vector(1.0);
        let body = self.clump(self.middle, velocity);
        for _ in 0..self.rng.random_range(1..4) {
            self.shoot_body(body);
        }
        if self.chance(0.3) {
            let last = self.scene.sphere_ids().last().expect("a ball");
            let spring = Spring::new(self.member(body), last, self.between(10.0, 200.0), self.between(0.2, 1.0));
            let damping = self.between(0.0, 4.0);
            self.scene.add_spring(spring.damping(damping)).expect("a valid spring");
            let point = self.place(0.5);
            let tether = Tether::new(self.member(body), point, self.between(10.0, 100.0)).length(0.2);
            self.scene.add_tether(tether).expect("a valid tether");
        }
        if self.chance(0.2) {
            let (along, velocity) = (self.direction(), self.vector(1.0));
            let at = self.place(0.2);
            self.rod(at, along, 1.0, velocity, 0.15);
        }
    }

    /// A clump whose flat side falls on a box or a polygon, and a ball.
    pub(crate) fn landing(&mut self) {
        let (radius, side) = (self.between(0.12, 0.25), self.between(0.2, 0.4));
        let even = self.chance(0.5);
        let mut shape = Shape::new();
        for number in 0..self.rng.random_range(2..6) {
            let place = side * Vec3::new((number % 2) as f32, 0.0, (number / 2) as f32);
            shape = shape.sphere(place, if even { radius } else { radius * self.between(0.8, 1.2) });
        }
        if self.chance(0.5) {
            shape = shape.sphere(Vec3::new(0.5 * side, side, 0.0), radius);
        }
        let shape = self.weighed(shape);
        let shape = self.scene.add_shape(shape).expect("a valid shape");
        let normal = self.direction();
        let tilt = self.between(0.0, 0.1) * self.direction();
        let turn = Quat::from_rotation_arc(Vec3::Y, (normal + tilt).normalize());
        let velocity = self.vector(1.0) - self.between(-1.0, 3.0) * normal;
        let at = self.middle + (radius - self.between(0.0, 0.05)) * normal;
        let placed = Placement::new(shape).at(at.as_dvec3()).turned(turn).velocity(velocity).spin(self.vector(2.0));
        let body = self.scene.add_body(placed).expect("a valid body");
        if self.chance(0.5) {
            self.square(self.middle, normal);
        } else {
            self.plate(normal);
        }
        self.shoot_body(body);
    }

    /// A box whose upper face contains the middle.
    pub(crate) fn plate(&mut self, normal: Vec3) {
        let one = normal.any_orthonormal_vector();
        let [i, j, k] = [3.0 * one, 3.0 * normal.cross(one), self.between(0.5, 1.0) * normal];
        let corner = self.middle - 0.5 * (i + j) - k;
        self.scene.add_box(Cuboid::new(corner, i, j, k)).expect("a valid box");
    }

    /// Two or three clumps that meet, and a ball. A box may be between them.
    pub(crate) fn clumps(&mut self) {
        for _ in 0..self.rng.random_range(2..4) {
            let place = self.place(0.4);
            let velocity = self.vector(1.0) - 3.0 * (place - self.middle);
            self.clump(place, velocity);
        }
        let place = self.place(0.6);
        let ball = self.ball(place);
        self.add(ball);
        if self.chance(0.3) {
            self.cuboid();
        }
    }
}
