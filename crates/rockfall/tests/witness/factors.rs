//! Damping of several contacts of rigid bodies, which damp as one (docs/physics.md section 4.16).

use rockfall::glam::DVec3;

use crate::geometry::{Feature, Line, Pair, Thing};
use crate::world::{Ball, Mistake, World};

impl World {
    /// The factor of the damping of a contact with a wall that other spheres of the body touch too.
    pub(crate) fn wall_factor(&self, pair: &Pair, line: &Line) -> f64 {
        let (Thing::Ball(ball), Thing::Block(_) | Thing::Face(_)) = (pair.a, pair.b) else { return 1.0 };
        let counts = !self.made(Mistake::WallFactor) && !self.is_solid(ball);
        let Some(clump) = self.clump_at(ball).filter(|_| counts) else { return 1.0 };
        let (clump, this) = (&self.clumps[clump], &self.balls[ball]);
        let w = |ball: &Ball| clump.inverse_mass(ball.x - clump.x, line.n);
        let (mut p, mut sum, mut moment) = (0.0, 0.0, DVec3::ZERO);
        for &(other, _) in clump.members.iter().filter(|member| !self.is_solid(member.0)) {
            let other = &self.balls[other];
            let o = line.o + (other.x - this.x).dot(line.n) + other.radius - this.radius;
            if o > 0.0 {
                let weight = if self.made(Mistake::WallWeights) { 1.0 } else { w(this) / w(other) };
                p += weight * o * o;
                sum += weight * o;
                moment += weight * o * (other.x - clump.x);
            }
        }
        let torque = moment.cross(line.n);
        let q = sum * sum / clump.mass + torque.dot(clump.inverse(torque));
        (w(this) * p / q).sqrt()
    }

    /// What contacts of a sphere act on: its rigid body or itself. The inverse mass of its centre, and of a lever under a torque.
    fn responses(&self, ball: usize) -> (f64, DVec3, impl Fn(DVec3) -> f64 + '_) {
        let clump = self.clump_at(ball).map(|clump| &self.clumps[clump]);
        let inverse_mass = clump.map_or_else(|| self.balls[ball].w(), |clump| 1.0 / clump.mass);
        let centre = clump.map_or(self.balls[ball].x, |clump| clump.x);
        (inverse_mass, centre, move |torque: DVec3| clump.map_or(0.0, |clump| torque.dot(clump.inverse(torque))))
    }

    fn boxes_damp_as_one(&self) -> bool {
        !self.made(Mistake::SolidFactor)
    }

    /// Whether two spheres count among the contacts of their bodies that damp as one.
    fn damp_as_one(&self, a: usize, b: usize) -> bool {
        let pair = Pair { a: Thing::Ball(a), b: Thing::Ball(b), feature: Feature::None };
        self.parts_may_touch(pair.a, pair.b) && (self.boxes_damp_as_one() || !self.has_box(&pair))
    }

    /// The factor of the damping of a contact of two spheres whose bodies have other contacts with each other.
    pub(crate) fn pair_factor(&self, pair: &Pair, line: &Line) -> f64 {
        let (Thing::Ball(one), Thing::Ball(two)) = (pair.a, pair.b) else { return 1.0 };
        if self.made(Mistake::PairFactor) || self.has_box(pair) && !self.boxes_damp_as_one() {
            return 1.0;
        }
        let balls = |ball: usize| match self.clump_at(ball) {
            Some(clump) => self.clumps[clump].members.iter().map(|member| member.0).collect(),
            None => vec![ball],
        };
        let ((mass_a, centre_a, turn_a), (mass_b, centre_b, turn_b)) = (self.responses(one), self.responses(two));
        let inverse_mass =
            |x: DVec3, y: DVec3, n: DVec3| mass_a + turn_a((x - centre_a).cross(n)) + mass_b + turn_b((y - centre_b).cross(n));
        let levers = |a: usize, b: usize| {
            let [x, y] = [a, b].map(|ball| self.balls[ball].x);
            [if self.is_solid(a) { y } else { x }, if self.is_solid(b) { x } else { y }]
        };
        let [x, y] = levers(one, two);
        let own = inverse_mass(x, y, line.n);
        let (mut p, mut sum, mut force, mut on_a, mut on_b) = (0.0, 0.0, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        let all = balls(one).into_iter().flat_map(|a| balls(two).into_iter().map(move |b| (a, b)));
        for (a, b) in all.filter(|&(a, b)| self.damp_as_one(a, b)) {
            let [x, y] = levers(a, b);
            let (o, n) = if (a, b) == (one, two) {
                (line.o, line.n)
            } else if let Some(line) = self.line_of_solid(a, b) {
                (line.o, line.n)
            } else {
                (self.balls[a].radius + self.balls[b].radius - x.distance(y), (y - x).normalize_or_zero())
            };
            if o > 0.0 {
                let push = own / inverse_mass(x, y, n) * o;
                (p, sum, force) = (p + push * o, sum + push, force + push * n);
                (on_a, on_b) = (on_a + push * (x - centre_a).cross(n), on_b + push * (y - centre_b).cross(n));
            }
        }
        let response = (mass_a + mass_b) * force.length_squared() + turn_a(on_a) + turn_b(on_b);
        (own * p / response.max(0.25 * (mass_a + mass_b) * sum * sum)).sqrt()
    }
}
