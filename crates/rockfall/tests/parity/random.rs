//! Random objects of clusters, with one method for each kind of cluster.

use glam::{Vec3, Vec3Swizzles};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rockfall::{Capsule, Cuboid, Muscle, Polygon, Rod, Scene, Sphere, SphereId, Spring, Surface, Tether};

/// Largest distance of a random position from the centre of its cluster, along each axis.
const EXTENT: f32 = 0.8;

/// Draws the objects of one cluster.
pub(crate) struct Draw<'a> {
    pub(crate) scene: &'a mut Scene,
    pub(crate) rng: Pcg64Mcg,
    pub(crate) middle: Vec3,
    /// Large spheres. They are added after everything else, because they must be the last in memory.
    pub(crate) giants: &'a mut Vec<Sphere>,
    /// Whether springs have muscles.
    pub(crate) muscles: bool,
}

impl Draw<'_> {
    fn unit(&mut self) -> f32 {
        self.rng.random_range(-1.0..1.0)
    }

    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        self.rng.random_range(low..high)
    }

    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.rng.random_bool(probability)
    }

    pub(crate) fn vector(&mut self, size: f32) -> Vec3 {
        let [x, y, z] = [0; 3].map(|_| self.unit());
        size * Vec3::new(x, y, z)
    }

    fn place(&mut self) -> Vec3 {
        let offset = self.vector(EXTENT);
        self.middle + offset
    }

    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.vector(1.0);
            if (0.1..1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }

    /// A sphere with random state and parameters.
    pub(crate) fn ball(&mut self, position: Vec3) -> Sphere {
        let (mass, radius) = (self.between(0.5, 3.0), self.between(0.25, 0.5));
        let sphere = Sphere::new(position, radius).mass(mass).velocity(self.vector(2.0));
        let spin = self.vector(4.0);
        sphere.angular_momentum(spin * sphere.inertia())
    }

    fn sphere(&mut self) -> SphereId {
        let position = self.place();
        let ball = self.ball(position);
        let fixed = self.chance(0.15);
        self.add(if fixed { ball.fixed() } else { ball })
    }

    pub(crate) fn add(&mut self, sphere: Sphere) -> SphereId {
        self.scene.add_sphere(sphere).unwrap()
    }

    /// A thin rod between two small spheres, of fixed or free length.
    fn rod(&mut self, end1: Vec3, end2: Vec3) {
        let mut ends = [end1, end2].map(|end| {
            let mut ball = self.ball(end);
            ball.radius *= 0.5;
            if self.chance(0.1) { ball.fixed() } else { ball }
        });
        // After a step, the ends of a rod of fixed length have the same velocity along its axis. docs/physics section 3.6
        // relies on this, because it moves the ends on a circle.
        let along = (end2 - end1).normalize();
        let parting = (ends[1].velocity - ends[0].velocity).dot(along);
        ends[1].velocity -= parting * along;
        let added = ends.map(|end| self.add(end));
        let radius = self.between(0.1, 0.25);
        let rod = Rod::new(added[0], added[1], radius);
        let strain = self.between(0.95, 1.05);
        let rod = if self.chance(0.6) { rod.length(end1.distance(end2) * strain) } else { rod };
        self.scene.add_rod(rod).unwrap();
    }

    /// A rod through a point, somewhere between its ends.
    fn rod_through(&mut self, point: Vec3, length: f32) {
        let (direction, part) = (self.direction(), self.between(0.2, 0.8));
        self.rod(point - part * length * direction, point + (1.0 - part) * length * direction);
    }

    pub(crate) fn spheres(&mut self, count: usize) {
        for _ in 0..count {
            self.sphere();
        }
    }

    /// Two spheres that overlap each other and nothing else.
    pub(crate) fn sphere_pair(&mut self) {
        let (place, direction) = (self.place(), self.direction());
        let one = self.ball(place);
        self.add(one);
        let mut other = self.ball(place);
        other.position += self.between(0.85, 0.98) * (one.radius + other.radius) * direction;
        self.add(other.velocity(one.velocity - 2.0 * direction));
    }

    /// A sphere much larger than all others, which hits a floor, and small spheres about its surface.
    pub(crate) fn giant(&mut self) {
        let mut giant = self.ball(self.middle);
        giant.radius = self.between(3.0, 3.2);
        giant.velocity.y = -self.between(4.0, 5.0);
        self.giants.push(giant);
        // The large sphere is side A of this contact, and side B of those with spheres.
        let floor = self.middle - 0.98 * giant.radius * Vec3::Y;
        self.floor(floor);
        for _ in 0..13 {
            let direction = self.direction();
            self.ball_about(&giant, direction);
        }
        // The first two large spheres have more neighbours than a workgroup has threads. The neighbours are spread evenly, so
        // that few of them touch each other.
        let ring = if self.giants.len() < 3 { 70 } else { 0 };
        for k in 0..ring {
            let (height, turn) = (1.0 - (k as f32 + 0.5) / 35.0, 2.399_963_2 * k as f32);
            let across = (1.0 - height * height).sqrt();
            self.ball_about(&giant, Vec3::new(across * turn.cos(), height, across * turn.sin()));
        }
    }

    fn ball_about(&mut self, giant: &Sphere, direction: Vec3) {
        let mut ball = self.ball(self.middle);
        ball.position += (giant.radius + self.between(0.6, 1.5) * ball.radius) * direction;
        self.add(ball);
    }

    /// A capsule and a sphere that hits one of its ends.
    pub(crate) fn capsule_and_sphere(&mut self) {
        let (middle, direction) = (self.middle, self.direction());
        self.scene.add_capsule(Capsule::new(middle, middle + direction, 0.25).mass(1.5)).unwrap();
        let across = self.vector(0.6);
        let mut ball = self.ball(middle + direction);
        ball.position += (0.2 + ball.radius) * (2.0 * direction + across).normalize();
        self.add(ball.velocity(across - 2.0 * direction));
    }

    /// A sphere that hits a floor and nothing else.
    pub(crate) fn sphere_on_floor(&mut self) {
        let floor = self.middle;
        self.floor(floor);
        let mut ball = self.ball(floor);
        ball.position.y += 0.9 * ball.radius;
        let velocity = Vec3::new(ball.velocity.x, -2.0, ball.velocity.z);
        self.add(ball.velocity(velocity));
    }

    /// A sphere that hits two walls at a right angle.
    pub(crate) fn corner(&mut self) {
        let corner = self.middle;
        for (from, to) in [((-0.5, -1.0, -1.0), (0.0, 1.0, 1.0)), ((0.001, -1.0, -0.5), (1.5, 1.0, 0.0))] {
            self.scene.add_box(Cuboid::between(corner + Vec3::from(from), corner + Vec3::from(to))).unwrap();
        }
        let mut ball = self.ball(corner);
        let depths = [self.between(0.8, 0.95), self.between(0.8, 0.95)];
        ball.position += Vec3::new(depths[0] * ball.radius, self.between(-0.3, 0.3), depths[1] * ball.radius);
        let velocity = Vec3::new(self.between(-3.0, -1.5), ball.velocity.y, self.between(-3.0, -1.5));
        self.add(ball.velocity(velocity));
    }

    /// A rod of free length that a sphere hits between its ends.
    pub(crate) fn struck_rod(&mut self) {
        let (middle, along) = (self.middle, self.direction());
        let ends = [-0.7, 0.7].map(|way| {
            let mut ball = self.ball(middle + way * along);
            ball.radius *= 0.4;
            self.add(ball)
        });
        self.scene.add_rod(Rod::new(ends[0], ends[1], 0.15)).unwrap();
        let (across, place) = (along.cross(self.direction()).normalize(), self.between(-0.3, 0.3));
        let mut ball = self.ball(middle + place * along);
        ball.position += (0.1 + ball.radius) * across;
        let aside = self.vector(0.5);
        self.add(ball.velocity(aside - 6.0 * across));
    }

    /// A row of two rods of fixed length and one of free length, half of the time from a fixed sphere. Spheres hit an end and
    /// rods of both kinds.
    pub(crate) fn struck_network(&mut self) {
        let places = [(-0.8, 0.3, 0.0), (0.0, -0.3, 0.1), (0.8, 0.3, -0.1), (1.5, 0.2, 0.1)];
        let (fixed, slow) = (self.chance(0.5), 0.3);
        let mut ends = Vec::new();
        for (number, place) in places.into_iter().enumerate() {
            let jitter = self.vector(0.1);
            let mut ball = self.ball(self.middle + Vec3::from(place) + jitter);
            ball.radius *= 0.5;
            let velocity = slow * ball.velocity;
            let ball = ball.velocity(velocity);
            ends.push((self.add(if fixed && number == 0 { ball.fixed() } else { ball }), ball.position));
        }
        for (number, pair) in ends.windows(2).enumerate() {
            let [(one, here), (two, there)] = [pair[0], pair[1]];
            let rod = Rod::new(one, two, 0.1);
            let length = here.distance(there);
            self.scene.add_rod(if number < 2 { rod.length(length) } else { rod }).unwrap();
        }
        // A brace of free length between two spheres of the network.
        self.scene.add_rod(Rod::new(ends[0].0, ends[2].0, 0.08)).unwrap();
        for (from, to, way) in [(0, 1, 0.5), (1, 1, 0.0), (2, 3, 0.5), (0, 2, 0.55)] {
            let (from, to): (Vec3, Vec3) = (ends[from].1, ends[to].1);
            let aside = self.vector(0.15);
            let mut ball = self.ball(from.lerp(to, way));
            ball.radius = 0.25;
            let across = (Vec3::Y + aside).normalize();
            ball.position += if way == 0.0 { -0.33 * across } else { 0.31 * across };
            let velocity = if way == 0.0 { 5.0 } else { -5.0 } * across;
            self.add(ball.velocity(velocity));
        }
    }

    /// Overlaps so small that they began within the step.
    pub(crate) fn shallow_overlaps(&mut self) {
        let (a, direction) = (self.place(), self.direction());
        let one = self.ball(a);
        let other = self.ball(a);
        let gap = one.radius + other.radius - self.between(0.0005, 0.01);
        let speed = self.between(0.5, 3.0);
        let mut other = other;
        other.position = a + gap * direction;
        other.velocity = one.velocity - speed * direction;
        self.add(one);
        self.add(other);
        // Two spheres that separate slowly, so that the damping of the contact would pull.
        let (place, direction) = (self.middle + Vec3::new(0.0, 2.5, 0.0), self.direction());
        let one = self.ball(place);
        let other = self.ball(place);
        let gap = one.radius + other.radius - self.between(0.0005, 0.001);
        let slow = self.between(0.12, 0.2);
        let mut other = other;
        other.position = place + gap * direction;
        other.velocity = one.velocity + slow * direction;
        self.add(one);
        self.add(other);
        let floor = self.middle - Vec3::Y * EXTENT;
        let ball = self.ball(floor);
        let height = ball.radius - self.between(0.0005, 0.01);
        let mut sunk = ball;
        sunk.position = floor + height * Vec3::Y;
        sunk.velocity = Vec3::new(0.5, -speed, 0.1);
        self.add(sunk);
        self.floor(floor);
    }

    /// A skew polygon that faces up and whose centre is a given point.
    fn floor(&mut self, point: Vec3) {
        let [skew, tilt, other] = [self.between(-0.4, 0.4), self.between(-0.2, 0.2), self.between(-0.2, 0.2)];
        let (left, right) = (Vec3::new(0.1, tilt, 2.4), Vec3::new(2.4, other, skew));
        self.scene.add_polygon(Polygon::new(point - 0.5 * (left + right), left, right)).unwrap();
    }

    pub(crate) fn sphere_on_rod(&mut self, pushed: bool) {
        let point = self.place();
        self.rod_through(point, 1.4);
        let offset = 0.3 * self.direction();
        let ball = self.ball(point + offset);
        self.add(if pushed { ball.velocity(-8.0 * offset) } else { ball });
    }

    pub(crate) fn rods(&mut self, count: usize) {
        let point = self.place();
        for _ in 0..count {
            let offset = self.vector(0.15);
            self.rod_through(point + offset, 1.6);
        }
    }

    pub(crate) fn parallel_rods(&mut self) {
        // Along a coordinate axis, so that they are exactly parallel.
        let along = [Vec3::X, Vec3::Y, Vec3::Z][self.rng.random_range(0..3)];
        let across = [along.yzx(), along.zxy()].map(|axis| axis * self.between(0.08, 0.15));
        let start = self.place();
        let shift = self.between(-0.6, 0.6);
        self.rod(start, start + 1.25 * along);
        let start = start + shift * along + across[0] + across[1];
        self.rod(start, start + 1.25 * along);
    }

    pub(crate) fn capsules(&mut self, count: usize) {
        for _ in 0..count {
            let (point, axis, radius) = (self.place(), self.direction(), self.between(0.15, 0.3));
            let half = self.between(0.3, 0.7) * axis;
            let mass = self.between(0.5, 3.0);
            let velocity = self.vector(2.0);
            let capsule = Capsule::new(point - half, point + half, radius).mass(mass).velocity(velocity);
            self.scene.add_capsule(capsule).unwrap();
        }
        self.sphere();
    }

    /// A box with random orientation and edges of different lengths.
    fn cuboid(&mut self) -> Cuboid {
        let (i, helper) = (self.direction(), self.direction());
        let j = i.cross(helper).normalize();
        let edges = [i, j, i.cross(j)].map(|edge| edge * self.between(0.6, 1.4));
        let cuboid = Cuboid::new(self.middle - 0.5 * (edges[0] + edges[1] + edges[2]), edges[0], edges[1], edges[2]);
        self.scene.add_box(cuboid).unwrap();
        cuboid
    }

    pub(crate) fn box_and_spheres(&mut self) {
        let Cuboid { corner, edges: [i, j, k], .. } = self.cuboid();
        self.spheres(3);
        let outward = -(i + j + k).normalize();
        for place in [corner + 0.15 * outward, corner + 0.5 * i - 0.12 * (j + k).normalize(), self.middle + 0.3 * i] {
            let jitter = self.vector(0.05);
            let ball = self.ball(place + jitter);
            self.add(ball);
        }
    }

    pub(crate) fn box_and_rods(&mut self, count: usize) {
        let Cuboid { corner, edges: [i, j, k], .. } = self.cuboid();
        for number in 0..count {
            // The rod crosses the edge along I. Its axis passes outside or inside the box.
            let out = -(j.normalize() + k.normalize()).normalize();
            let depth = if number % 2 == 0 { 0.06 } else { -0.08 };
            let (turn, jitter) = (self.between(-0.4, 0.4), self.vector(0.03));
            let along = (j.normalize() - k.normalize() + turn * i.normalize()).normalize();
            let point = corner + (0.3 + 0.1 * number as f32) * i + depth * out + jitter;
            self.rod(point - 0.7 * along, point + 0.8 * along);
        }
        let point = self.place();
        self.rod_through(point, 1.8);
    }

    /// Rods that touch a box at a vertex only: two pass the vertex outside, and one ends near another vertex inside the box.
    pub(crate) fn box_and_vertex_rods(&mut self) {
        let Cuboid { corner, edges, .. } = self.cuboid();
        let [i, j, k] = edges.map(Vec3::normalize);
        let out = -(i + j + k).normalize();
        for depth in [0.08, 0.12] {
            let jitter = self.vector(0.02);
            let along = out.cross(self.direction()).normalize();
            let point = corner + depth * out + jitter;
            self.rod(point - 0.6 * along, point + 0.7 * along);
        }
        let last = corner + edges[0] + edges[1] + edges[2];
        // Ends inside, short of every edge, so that only the vertex is within its radius.
        let jitter = self.vector(0.08);
        self.rod(last + 0.3 * out + jitter, last + 0.02 * out);
    }

    pub(crate) fn polygon(&mut self) {
        let (left, helper) = (self.direction(), self.direction());
        let right = (helper - 0.7 * helper.dot(left) * left).normalize();
        let (left, right) = (left * self.between(1.2, 2.0), right * self.between(1.2, 2.0));
        let corner = self.middle - 0.5 * (left + right);
        let mut polygon = Polygon::new(corner, left, right);
        polygon.surface = if self.chance(0.5) { Surface::Triangle } else { Surface::Parallelogram };
        self.scene.add_polygon(polygon).unwrap();
        let up = left.cross(right).normalize();
        for (height, speed) in [(0.15, -1.5), (0.1, 1.5), (0.15, 0.1), (-0.1, 1.0)] {
            let (l, k, jitter) = (self.between(0.1, 0.9), self.between(0.1, 0.9), self.vector(0.1));
            let ball = self.ball(corner + l * left + k * right + height * up + jitter);
            let velocity = ball.velocity * 0.2 + speed * up;
            self.add(ball.velocity(velocity));
        }
        self.capsules(1);
    }

    /// A cone or a ball, touched from outside or from inside, with balls near its surface and near a rim.
    pub(crate) fn smooth_wall(&mut self) {
        let (axis, helper) = (self.direction(), self.direction());
        let out = (helper - helper.dot(axis) * axis).normalize();
        let inside = self.chance(0.5);
        let side = if inside { -1.0 } else { 1.0 };
        let radii = [self.between(0.8, 1.2), self.between(0.8, 1.2)];
        let is_ball = self.chance(0.3);
        let foot = self.middle - radii[0] * out;
        let (wall, length) = if is_ball {
            (Polygon::ball(foot, radii[0]), 0.0)
        } else {
            let length = self.between(0.8, 1.5);
            (Polygon::cone(foot - 0.5 * length * axis, axis, radii, length), length)
        };
        self.scene.add_polygon(wall.inside(inside)).unwrap();
        for (height, speed) in [(0.15, -1.5), (0.1, 1.5), (0.15, 0.1), (-0.1, 1.0)] {
            let (along, jitter) = (length * self.between(-0.6, 0.6), self.vector(0.1));
            let up = side * out;
            let ball = self.ball(self.middle + along * axis + jitter + height * up);
            let velocity = ball.velocity * 0.2 + speed * up;
            self.add(ball.velocity(velocity));
        }
        self.capsules(1);
    }

    /// A row of rods of fixed length. The first end is fixed half of the time.
    pub(crate) fn chain(&mut self) {
        let mut place = self.middle - Vec3::X * 1.2;
        let hung = self.chance(0.5);
        let first = self.ball(place);
        let mut last = self.add(if hung { first.fixed() } else { first });
        for _ in 0..6 {
            let step = Vec3::X * 0.4 + self.vector(0.15);
            place += step;
            let mut ball = self.ball(place);
            ball.radius *= 0.4;
            let next = self.add(ball);
            let length = step.length() * self.between(0.97, 1.03);
            self.scene.add_rod(Rod::new(last, next, 0.1).length(length)).unwrap();
            last = next;
        }
        self.sphere();
    }

    /// A tetrahedron of rods of fixed length, with one more rod of free length.
    pub(crate) fn frame(&mut self) {
        let corners = [Vec3::ONE, Vec3::new(1.0, -1.0, -1.0), Vec3::new(-1.0, 1.0, -1.0), Vec3::new(-1.0, -1.0, 1.0)];
        let mut ends = Vec::new();
        for corner in corners {
            let jitter = self.vector(0.1);
            let ball = self.ball(self.middle + 0.5 * corner + jitter);
            let velocity = 0.2 * ball.velocity;
            ends.push(self.add(ball.velocity(velocity)));
        }
        for (place, one) in ends.iter().enumerate() {
            for two in &ends[..place] {
                let [a, b] = [one, two].map(|end| self.scene.sphere(*end).unwrap().position);
                let length = a.distance(b) * self.between(0.998, 1.002);
                self.scene.add_rod(Rod::new(*one, *two, 0.15).length(length)).unwrap();
            }
        }
        let tail = self.sphere();
        self.scene.add_rod(Rod::new(ends[0], tail, 0.1)).unwrap();
    }

    /// Spheres with springs, a tether and external forces.
    pub(crate) fn attached(&mut self) {
        let spheres: Vec<SphereId> = (0..4)
            .map(|_| {
                let position = self.place();
                let ball = self.ball(position);
                let force = self.vector(5.0);
                self.add(ball.force(force))
            })
            .collect();
        for (one, two) in [(0, 1), (1, 2), (0, 2), (3, 0)] {
            let (stiffness, length) = (self.between(10.0, 100.0), self.between(0.2, 1.5));
            let spring = Spring::new(spheres[one], spheres[two], stiffness, length);
            let damping = self.between(0.0, 4.0);
            let mut spring = spring.damping(damping);
            // All quarters of a turn, so fast that a step changes the phase much. One spring has none.
            spring.muscle = (self.muscles && one > 0).then(|| Muscle::new(0.3, 40.0 * stiffness, stiffness));
            self.scene.add_spring(spring).unwrap();
        }
        let point = self.place();
        let (stiffness, length) = (self.between(10.0, 100.0), self.between(0.0, 0.5));
        let mut tether = Tether::new(spheres[2], point, stiffness).length(length);
        tether.damping = self.between(0.0, 4.0);
        self.scene.add_tether(tether).unwrap();
    }

    /// Overlapping spheres and a box, in several groups.
    pub(crate) fn groups(&mut self) {
        for number in 0..6 {
            let position = self.place();
            let ball = self.ball(position);
            self.add(ball.group(number % 3));
        }
        let cuboid = self.cuboid();
        self.scene.add_box(cuboid.group(2)).unwrap();
    }

    /// Objects of several kinds in one place.
    pub(crate) fn crowd(&mut self) {
        self.capsules(2);
        self.rods(1);
        self.spheres(2);
        let floor = self.middle - 0.6 * Vec3::Y;
        self.floor(floor);
    }
}
