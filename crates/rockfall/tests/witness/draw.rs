//! Random bodies of all kinds: one method for each kind of cluster.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rockfall::glam::Vec3;
use rockfall::{Capsule, Motion, MotionId, MotionTerm, ObjectId, Polygon, Rod, Scene, Sphere, SphereId, Spring, Tether};

use crate::scenes::rebuilt;

/// Generates one cluster.
pub(crate) struct Draw {
    pub(crate) rng: Pcg64Mcg,
    pub(crate) scene: Scene,
    pub(crate) middle: Vec3,
}

fn vector(rng: &mut Pcg64Mcg, size: f32) -> Vec3 {
    size * Vec3::from_array([0; 3].map(|_| rng.random_range(-1.0..1.0)))
}

pub(crate) fn direction(rng: &mut Pcg64Mcg) -> Vec3 {
    loop {
        let v = vector(rng, 1.0);
        if (0.1..1.0).contains(&v.length()) {
            return v.normalize();
        }
    }
}

impl Draw {
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        self.rng.random_range(low..high)
    }

    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.rng.random_bool(probability)
    }

    pub(crate) fn direction(&mut self) -> Vec3 {
        direction(&mut self.rng)
    }

    pub(crate) fn vector(&mut self, size: f32) -> Vec3 {
        vector(&mut self.rng, size)
    }

    pub(crate) fn place(&mut self, size: f32) -> Vec3 {
        self.middle + self.vector(size)
    }

    pub(crate) fn ball(&mut self, position: Vec3) -> Sphere {
        let (mass, radius) = (self.between(0.5, 3.0), self.between(0.2, 0.4));
        let sphere = Sphere::new(position, radius).mass(mass).velocity(self.vector(2.0));
        let spin = self.vector(4.0);
        sphere.angular_momentum(spin * sphere.inertia())
    }

    pub(crate) fn add(&mut self, sphere: Sphere) -> SphereId {
        self.scene.add_sphere(sphere).expect("a valid sphere")
    }

    pub(crate) fn place_of(&self, id: SphereId) -> Vec3 {
        self.scene.sphere(id).expect("a sphere").position
    }

    pub(crate) fn join(&mut self, one: SphereId, two: SphereId, radius: f32, strain: Option<f32>) {
        let distance = self.place_of(one).distance(self.place_of(two));
        let rod = Rod::new(one, two, radius);
        let rod = match strain {
            Some(strain) => rod.length(distance * strain),
            None => rod,
        };
        self.scene.add_rod(rod).expect("a valid rod");
    }

    /// Adds a ball from a random direction that has just hit a target at `at` with the velocity `velocity` and the
    /// radius `reach`.
    pub(crate) fn shoot(&mut self, at: Vec3, velocity: Vec3, reach: f32) {
        let from = self.direction();
        let mut ball = self.ball(at);
        let speed = self.between(0.5, 5.0);
        ball.position += (reach + ball.radius - self.between(0.001, 0.05)) * from;
        let aside = self.vector(1.0);
        self.add(ball.velocity(velocity - speed * from + aside));
    }

    /// Two balls and nothing else.
    pub(crate) fn duel(&mut self) {
        let place = self.place(0.5);
        let ball = self.ball(place);
        self.add(ball);
        self.shoot(ball.position, ball.velocity, ball.radius);
    }

    pub(crate) fn crowd(&mut self) {
        let count = self.rng.random_range(3..8);
        for number in 0..count {
            let position = self.place(0.6);
            let mut ball = self.ball(position);
            ball.velocity -= 3.0 * (position - self.middle);
            ball.fixed = number > 1 && self.chance(0.15);
            self.add(ball);
        }
    }

    pub(crate) fn square(&mut self, point: Vec3, normal: Vec3) {
        let left = normal.any_orthonormal_vector();
        let (left, right) = (3.0 * left, 3.0 * normal.cross(left) + self.between(-1.0, 1.0) * left);
        // Left x right is along the normal.
        let mut polygon = Polygon::new(point - 0.5 * (left + right), left, right);
        if self.chance(0.4) {
            // Its centre is at the point.
            polygon = Polygon::new(point - (left + right) / 3.0, left, right);
            polygon.surface = rockfall::Surface::Triangle;
        }
        self.scene.add_polygon(polygon).expect("a valid polygon");
    }

    /// Lets some of the walls follow motions, and makes belts of some.
    pub(crate) fn move_walls(&mut self) {
        let walls = self.scene.box_ids().map(ObjectId::Box).chain(self.scene.polygon_ids().map(ObjectId::Polygon));
        let walls: Vec<ObjectId> = walls.collect();
        let motions: Vec<MotionId> = (0..2)
            .map(|number| {
                let mut motion = Motion::new(format!("motion{number}"), self.term());
                if self.chance(0.4) {
                    motion.terms.push(self.term());
                }
                self.scene.add_motion(motion).expect("a valid motion")
            })
            .collect();
        for wall in walls {
            if self.chance(0.7) {
                let motion = motions[self.rng.random_range(0..2)];
                self.scene.set_motion(wall, Some(motion)).expect("a wall");
            }
            if self.chance(0.2) {
                let belt = self.vector(2.0);
                self.scene.set_surface_velocity(wall, belt).expect("a wall");
            }
        }
    }

    /// A translation, an oscillation or a turn. It may begin or end within the first steps.
    fn term(&mut self) -> MotionTerm {
        let vector = self.vector(2.0).as_dvec3();
        let size = f64::from(self.between(0.2, 2.0));
        let term = match self.rng.random_range(0..3) {
            0 => MotionTerm::translation(vector),
            1 => MotionTerm::oscillation(0.1 * vector, size).phase(size),
            _ => MotionTerm::turn(size, self.direction().as_dvec3(), self.middle.as_dvec3() + vector),
        };
        if self.chance(0.3) { term.during(0.0013, 0.021) } else { term }
    }

    /// One to three polygons, at right angles or not, and a few bodies that fall on them.
    pub(crate) fn corner(&mut self) {
        let (normal, other) = (self.direction(), self.direction());
        self.square(self.middle, normal);
        if self.chance(0.5) {
            let second = if self.chance(0.5) { normal.any_orthonormal_vector() } else { (normal + 1.5 * other).normalize() };
            self.square(self.middle, second);
        }
        let count = self.rng.random_range(1..5);
        for _ in 0..count {
            let jitter = self.vector(0.8);
            let mut ball = self.ball(self.middle);
            let side = jitter - normal * jitter.dot(normal);
            ball.position += side + (ball.radius - self.between(-0.1, 0.1)) * normal;
            ball.velocity -= self.between(-1.0, 3.0) * normal;
            self.add(ball);
        }
        if self.chance(0.5) {
            let at = self.middle + 0.35 * normal;
            self.capsule(at, -2.0 * normal);
        }
    }

    /// Adds a rod through a point.
    pub(crate) fn rod(&mut self, point: Vec3, along: Vec3, length: f32, velocity: Vec3, fixed: f64) {
        let part = self.between(0.2, 0.8);
        let radius = self.between(0.08, 0.2);
        let ends = [point - part * length * along, point + (1.0 - part) * length * along].map(|end| {
            let mut ball = self.ball(end);
            ball.radius = radius * self.between(0.5, 1.2);
            ball.velocity = velocity + 0.3 * ball.velocity;
            ball.fixed = self.chance(fixed);
            self.add(ball)
        });
        let strain = if self.chance(0.5) { 1.0 } else { self.between(0.98, 1.02) };
        let strain = self.chance(0.4).then_some(strain);
        self.join(ends[0], ends[1], radius, strain);
    }

    /// Rods of free and fixed length that cross, and a ball.
    pub(crate) fn rods(&mut self) {
        let count = self.rng.random_range(1..4);
        for _ in 0..count {
            let (point, along, length) = (self.place(0.15), self.direction(), self.between(1.0, 2.0));
            let velocity = self.vector(2.0);
            self.rod(point, along, length, velocity, 0.15);
        }
        if count < 3 {
            let at = self.place(0.2);
            self.shoot(at, Vec3::ZERO, 0.1);
        }
    }

    pub(crate) fn capsule(&mut self, point: Vec3, velocity: Vec3) {
        let axis = self.direction() * self.between(0.2, 0.6);
        let radius = self.between(0.15, 0.3);
        if self.chance(0.3) {
            let shift = self.vector(0.5);
            let capsule = Capsule::new(point - axis, point + axis, radius).mass(1.5).velocity(velocity + shift);
            self.scene.add_capsule(capsule).expect("a valid capsule");
            return;
        }
        // Ends of different masses and radii, with rotation. Some motions are not rigid.
        let (turn, roll) = (self.vector(4.0), self.between(-5.0, 5.0));
        let loose = self.chance(0.2);
        let ends = [-1.0, 1.0].map(|side| {
            let mut ball = self.ball(point + side * axis);
            ball.radius = radius * self.between(0.7, 1.3);
            let spin = turn + roll * axis.normalize();
            ball.velocity = velocity + side * spin.cross(axis) + if loose { self.vector(0.3) } else { Vec3::ZERO };
            ball.angular_momentum = (spin + if loose { self.vector(1.0) } else { Vec3::ZERO }) * ball.inertia();
            self.add(ball)
        });
        self.join(ends[0], ends[1], radius, Some(1.0));
    }

    pub(crate) fn capsule_duel(&mut self) {
        let velocity = self.vector(1.0);
        self.capsule(self.middle, velocity);
        let ends: Vec<Vec3> = self.scene.spheres().iter().map(|sphere| sphere.position).collect();
        let at = ends[0].lerp(ends[1], self.between(-0.1, 1.1));
        match self.rng.random_range(0..3) {
            0 => self.shoot(at, velocity, 0.2),
            1 => {
                let away = self.direction();
                let shift = self.vector(0.4);
                self.capsule(at + 0.45 * away + shift, velocity - 3.0 * away);
            }
            _ => {
                let normal = self.direction();
                let low = ends.iter().map(|end| end.dot(normal)).fold(f32::INFINITY, f32::min);
                let foot = self.middle + (low - self.middle.dot(normal) - 0.17) * normal;
                self.square(foot, normal);
                self.push_all(-2.5 * normal);
            }
        }
    }

    pub(crate) fn push_all(&mut self, velocity: Vec3) {
        self.rebuild(|sphere| if sphere.fixed { sphere } else { sphere.velocity(sphere.velocity + velocity) });
    }

    /// Changes all spheres by rebuilding the scene, because spheres of a scene cannot be changed in place.
    pub(crate) fn rebuild(&mut self, change: impl Fn(Sphere) -> Sphere) {
        self.scene = rebuilt(&self.scene, |_, sphere| change(sphere));
    }

    pub(crate) fn capsules(&mut self) {
        let count = self.rng.random_range(2..4);
        for _ in 0..count {
            let place = self.place(0.5);
            let velocity = self.vector(1.5) - 2.0 * (place - self.middle);
            self.capsule(place, velocity);
        }
        let place = self.place(0.5);
        let ball = self.ball(place);
        self.add(ball);
    }

    /// A chain, attached to a fixed sphere or free, and a ball that hits it.
    pub(crate) fn pendulum(&mut self) {
        let links = self.rng.random_range(1..5);
        let hung = self.chance(0.6);
        let first = self.ball(self.middle);
        let mut anchor = first;
        anchor.radius = if hung { 0.1 } else { 0.12 };
        let mut last = self.add(if hung { anchor.fixed() } else { anchor });
        let strained = self.chance(0.2);
        let mut place = self.middle;
        for _ in 0..links {
            place += self.direction() * self.between(0.4, 0.7);
            let mut ball = self.ball(place);
            ball.radius *= 0.4;
            let next = self.add(ball);
            let strain = if strained { self.between(0.99, 1.01) } else { 1.0 };
            self.join(last, next, 0.08, Some(strain));
            last = next;
        }
        self.shoot(place, Vec3::ZERO, 0.1);
        if self.chance(0.3) {
            let normal = self.direction();
            self.square(place - 0.15 * normal, normal);
        }
    }

    /// A triangle or a tetrahedron of rods of fixed length that hits something. Some hang on a fixed ball, or have a further ball that
    /// is hinged to them. These are networks, the others are rigid bodies.
    pub(crate) fn frame(&mut self) {
        let corners = [Vec3::ONE, Vec3::new(1.0, -1.0, -1.0), Vec3::new(-1.0, 1.0, -1.0), Vec3::new(-1.0, -1.0, 1.0)];
        let count = if self.chance(0.5) { 3 } else { 4 };
        let (velocity, turn) = (self.vector(2.0), self.vector(2.0));
        let body = self.chance(0.5);
        // The engine forms a body of any lengths and velocities.
        let loose = if body && self.chance(0.3) { 1.0 } else { 0.0 };
        let mut ends: Vec<SphereId> = Vec::new();
        for corner in &corners[..count] {
            let arm = 0.35 * *corner + self.vector(0.1);
            let mut ball = self.ball(self.middle + arm);
            ball.radius *= 0.6;
            ball.velocity = velocity + turn.cross(arm) + loose * self.vector(0.5);
            let added = self.add(ball);
            for &end in &ends {
                let strain = 1.0 + loose * self.between(-0.02, 0.02);
                self.join(end, added, 0.1, Some(strain));
            }
            ends.push(added);
        }
        if !body {
            self.loosen(&ends);
        }
        let at = self.place_of(ends[0]);
        let radius = self.scene.sphere(ends[0]).expect("a corner").radius;
        if self.chance(0.5) {
            let normal = -(at - self.middle).normalize();
            self.square(at - (radius - 0.02) * normal, normal);
            self.push_all(-2.0 * normal);
        } else {
            self.shoot(at, velocity, radius);
        }
        if self.chance(0.3) {
            self.shoot(self.middle, velocity, 0.2);
        }
    }

    /// Joins a frame to a fixed ball, or adds a ball that hinges on its last side.
    fn loosen(&mut self, frame: &[SphereId]) {
        let ends = &frame[frame.len() - if self.chance(0.5) { 1 } else { 2 }..];
        let near = ends.iter().map(|&end| self.place_of(end)).sum::<Vec3>() / ends.len() as f32;
        let place = near + self.between(0.6, 0.8) * (near - self.middle).normalize() + self.vector(0.1);
        let mut ball = self.ball(place);
        ball.radius *= 0.5;
        ball.fixed = ends.len() == 1;
        let added = self.add(ball);
        for &end in ends {
            self.join(end, added, 0.1, Some(1.0));
        }
    }

    pub(crate) fn springs(&mut self) {
        // The balls are either close together, or apart with only one of them hit.
        let apart = self.chance(0.5);
        let balls: Vec<SphereId> = (0..4)
            .map(|_| {
                let place = self.place(if apart { 1.2 } else { 0.45 });
                let ball = self.ball(place);
                let force = self.vector(8.0);
                self.add(ball.force(force))
            })
            .collect();
        for (one, two) in [(0, 1), (1, 2), (2, 3)] {
            let spring = Spring::new(balls[one], balls[two], self.between(10.0, 200.0), self.between(0.2, 1.5));
            let damping = self.between(0.0, 4.0);
            self.scene.add_spring(spring.damping(damping)).expect("a valid spring");
        }
        let point = self.place(0.5);
        let tether = Tether::new(balls[0], point, self.between(10.0, 100.0)).length(0.2);
        let damping = self.between(0.0, 4.0);
        self.scene.add_tether(tether.damping(damping)).expect("a valid tether");
        if apart {
            let hit = *self.scene.sphere(balls[1]).expect("a ball");
            self.shoot(hit.position, hit.velocity, hit.radius);
        } else if self.chance(0.4) {
            self.join(balls[2], balls[3], 0.1, None);
        }
    }
}
