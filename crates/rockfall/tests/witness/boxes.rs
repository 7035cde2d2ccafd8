//! Boxes of rigid bodies: their parts, which of them touch, and their contact lines (docs/physics.md section 2.16).

use rockfall::glam::{DMat3, DQuat, DVec3};
use rockfall::{BoxPart, RigidBody, Scene, Shape, SphereId};

use crate::geometry::{Feature, Line, Pair, Thing, face_corners, segment_segment, sphere_box, sphere_face, vertex_of};
use crate::world::{Ball, Mistake, World};

/// Rounding radius of a box as a share of its shortest edge.
const ROUNDING: f64 = 0.02;
/// Overlaps of at most this share of the rounding radius count as touching at a corner of a wall.
const AT_CORNER: f64 = 1e-3;
/// Sine of the angle of two edges below which their overlap becomes less.
const NEARLY_PARALLEL: f64 = 0.1;
/// Distance from an end of an edge below which its overlap becomes less, in radii.
const NEAR_END: f64 = 4.0;

/// The core of a box of a rigid body.
#[derive(Clone, Debug)]
pub(crate) struct Core {
    /// The sphere that stands for the solid. Its centre is that of the box.
    pub(crate) solid: usize,
    /// Turns coordinates along the edges of the box into those of the body.
    pub(crate) turn: DQuat,
    /// Half the edges of the core.
    pub(crate) half: DVec3,
    /// Rounding radius.
    pub(crate) radius: f64,
}

/// What a sphere is, with the number of its core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Sphere,
    Solid(usize),
    Vertex(usize),
}

/// The kinds of objects that the table of section 2.16 has.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Sphere,
    Solid,
    Vertex,
    Rod,
    Edge,
    Wall,
}

/// A box in coordinates of its shape: its centre, and its core.
fn core_of(shape: &Shape, number: usize) -> (DVec3, Core) {
    let cuboid = &shape.boxes[number].cuboid;
    let edges = cuboid.edges.map(|edge| edge.as_dvec3());
    let lengths = DVec3::from_array(edges.map(DVec3::length));
    let radius = if shape.rounding > 0.0 { f64::from(shape.rounding) } else { ROUNDING * lengths.min_element() };
    let (one, two) = (edges[0].normalize(), edges[1].normalize());
    let turn = DQuat::from_mat3(&DMat3::from_cols(one, two, one.cross(two)));
    let centre = cuboid.corner.as_dvec3() + 0.5 * (edges[0] + edges[1] + edges[2]);
    (centre, Core { solid: usize::MAX, turn: turn.normalize(), half: 0.5 * lengths - radius, radius })
}

/// Centres of the spheres of a body in coordinates of its shape.
pub(crate) fn places(scene: &Scene, body: &RigidBody, shape: &Shape, centre: DVec3) -> Vec<DVec3> {
    let boxes: Vec<(DVec3, Core)> = (0..shape.boxes.len()).map(|number| core_of(shape, number)).collect();
    let mut own = shape.spheres.iter().map(|sphere| sphere.centre.as_dvec3());
    let of = |&id: &SphereId| match scene.box_of_sphere(id) {
        Some(BoxPart::Solid(number)) => boxes[number].0,
        Some(BoxPart::Rim(number)) => {
            // The order of the vertices is that of the engine: this one is the nearest.
            let (middle, core) = &boxes[number];
            let x = scene.sphere(id).expect("a sphere of the body").position.as_dvec3();
            let seen = body.orientation.as_dquat().inverse() * (x - DVec3::from_array(body.centre())) + centre;
            let way = core.turn.inverse() * (seen - *middle);
            *middle + core.turn * (core.half * way.signum())
        }
        None => own.next().expect("a sphere of the shape"),
    };
    body.spheres().iter().map(of).collect()
}

/// The cores of all boxes of bodies, and what every sphere is. `number` is that of a sphere in the scene.
pub(crate) fn cores(scene: &Scene, number: impl Fn(SphereId) -> usize) -> (Vec<Core>, Vec<Part>) {
    let (mut cores, mut parts) = (Vec::new(), vec![Part::Sphere; scene.spheres().len()]);
    for body in scene.bodies() {
        let shape = scene.shape(body.shape).expect("the shape of a body");
        let first = cores.len();
        cores.extend((0..shape.boxes.len()).map(|number| core_of(shape, number).1));
        for &id in body.spheres() {
            match scene.box_of_sphere(id) {
                Some(BoxPart::Solid(of)) => {
                    cores[first + of].solid = number(id);
                    parts[number(id)] = Part::Solid(first + of);
                }
                Some(BoxPart::Rim(of)) => parts[number(id)] = Part::Vertex(first + of),
                None => {}
            }
        }
    }
    (cores, parts)
}

impl World {
    pub(crate) fn is_solid(&self, ball: usize) -> bool {
        matches!(self.parts[ball], Part::Solid(_))
    }

    /// The core of which a rod is an edge.
    fn core_of_edge(&self, bar: usize) -> Option<usize> {
        match self.bars[bar].ends.map(|end| self.parts[end]) {
            [Part::Vertex(one), Part::Vertex(two)] if one == two => Some(one),
            _ => None,
        }
    }

    pub(crate) fn is_edge(&self, bar: usize) -> bool {
        self.core_of_edge(bar).is_some()
    }

    fn kind(&self, thing: Thing) -> Kind {
        match thing {
            Thing::Ball(ball) => match self.parts[ball] {
                Part::Sphere => Kind::Sphere,
                Part::Solid(_) => Kind::Solid,
                Part::Vertex(_) => Kind::Vertex,
            },
            Thing::Bar(bar) if self.is_edge(bar) => Kind::Edge,
            Thing::Bar(_) => Kind::Rod,
            Thing::Block(_) | Thing::Face(_) => Kind::Wall,
        }
    }

    /// Whether the table of parts has contacts of these two.
    pub(crate) fn parts_may_touch(&self, a: Thing, b: Thing) -> bool {
        let allows = |one: Kind, two: Kind| match one {
            Kind::Solid => matches!(two, Kind::Sphere | Kind::Vertex | Kind::Wall),
            Kind::Vertex => matches!(two, Kind::Solid | Kind::Rod | Kind::Wall),
            Kind::Edge => matches!(two, Kind::Rod | Kind::Edge | Kind::Wall),
            Kind::Sphere | Kind::Rod | Kind::Wall => true,
        };
        let (one, two) = (self.kind(a), self.kind(b));
        allows(one, two) && allows(two, one)
    }

    /// Whether an object is a part of a box of a body.
    pub(crate) fn is_box_part(&self, thing: Thing) -> bool {
        matches!(self.kind(thing), Kind::Solid | Kind::Vertex | Kind::Edge)
    }

    pub(crate) fn has_box(&self, pair: &Pair) -> bool {
        self.is_box_part(pair.a) || self.is_box_part(pair.b)
    }

    /// Radius of a sphere, or of the rounding of the box for which it stands.
    pub(crate) fn round_radius(&self, ball: usize) -> f64 {
        match self.parts[ball] {
            Part::Solid(core) => self.cores[core].radius,
            _ => self.balls[ball].radius,
        }
    }

    /// The radius of the sphere around the whole box of a part. A vertex may be small, but it moves as its box does.
    pub(crate) fn size(&self, ball: usize) -> Option<f64> {
        match self.parts.get(ball) {
            Some(&Part::Solid(core) | &Part::Vertex(core)) => Some(self.balls[self.cores[core].solid].radius),
            _ => None,
        }
    }

    /// Radius of a sphere or rod.
    pub(crate) fn radius(&self, thing: Thing) -> Option<f64> {
        match thing {
            Thing::Ball(ball) => Some(self.round_radius(ball)),
            Thing::Bar(bar) => Some(self.bars[bar].radius),
            Thing::Block(_) | Thing::Face(_) => None,
        }
    }

    /// The normal from a box to a point, the distance of the point from its core, and the way from the centre of the box to the point of the
    /// core. Inside the core that is the nearest point of its surface: only there both arms of friction end in one point (section 4.5).
    fn core_line(&self, core: &Core, point: DVec3) -> (DVec3, f64, DVec3) {
        let solid = &self.balls[core.solid];
        let turn = solid.q * core.turn;
        let d = turn.inverse() * (point - solid.x);
        let c = d.clamp(-core.half, core.half);
        if d != c {
            return (turn * (d - c).normalize(), d.distance(c), turn * c);
        }
        let depths = core.half - d.abs();
        let face = (1..3).fold(0, |least, k| if depths[k] < depths[least] { k } else { least });
        let side = if d[face] < 0.0 { -1.0 } else { 1.0 };
        let n = side * DVec3::AXES[face];
        (turn * n, -depths[face], turn * (c + depths[face] * n))
    }

    /// Contact line of a solid, which is A, with a point or a sphere.
    fn solid_line(&self, core: usize, point: DVec3, radius: f64) -> Line {
        let core = &self.cores[core];
        let (n, distance, c) = self.core_line(core, point);
        let c = if self.made(Mistake::CoreLever) { DVec3::ZERO } else { c };
        Line { core: [c, DVec3::ZERO], ..Line::new(n, radius + core.radius - distance, [0.0; 2]) }
    }

    /// Contact line of two spheres of which one may stand for a solid; `None` for two other spheres.
    pub(crate) fn line_of_solid(&self, one: usize, two: usize) -> Option<Line> {
        let with = |core: usize, other: usize| self.solid_line(core, self.balls[other].x, self.balls[other].radius);
        match [one, two].map(|ball| self.parts[ball]) {
            [Part::Solid(core), _] => Some(with(core, two)),
            [_, Part::Solid(core)] => {
                let line = with(core, one);
                Some(Line { n: -line.n, core: [DVec3::ZERO, line.core[0]], ..line })
            }
            _ => None,
        }
    }

    /// From the centre of the box of an edge to the middle of the edge.
    fn outward(&self, bar: usize) -> Option<DVec3> {
        let core = self.core_of_edge(bar)?;
        let [one, two] = self.ends(bar);
        Some(0.5 * (one + two) - self.balls[self.cores[core].solid].x)
    }

    /// Contact line of an edge with another edge or a rod.
    pub(crate) fn line_of_edges(&self, one: usize, two: usize) -> Option<Line> {
        let [a, b] = [one, two].map(|bar| self.ends(bar));
        let radii = [one, two].map(|bar| self.bars[bar].radius);
        let reach = radii[0] + radii[1];
        let closest = segment_segment(a, b, reach)?;
        let common = closest.common?;
        let lengths = [a, b].map(|ends| ends[1].distance(ends[0]));
        let sine = (a[1] - a[0]).cross(b[1] - b[0]).length() / (lengths[0] * lengths[1]);
        let near_end = |k: usize, at: f64| at.min(1.0 - at) * lengths[k] / (NEAR_END * radii[k]);
        let ends = if self.made(Mistake::EdgeTaper) { 1.0 } else { near_end(0, closest.a).min(near_end(1, closest.b)) };
        let weight = (sine / NEARLY_PARALLEL).min(1.0) * ends.min(1.0);
        let n = if closest.d == DVec3::ZERO { common } else { closest.d.normalize() };
        let distance = closest.d.length();
        let leaves = self.outward(one).map(|m| n.dot(m) >= 0.0);
        let enters = self.outward(two).map(|m| n.dot(m) <= 0.0);
        let holds: Vec<bool> = [leaves, enters].into_iter().flatten().collect();
        let at = [closest.a, closest.b];
        if holds.iter().all(|holds| *holds) {
            return Some(Line::new(n, weight * (reach - distance), at));
        }
        let passed = holds.iter().all(|holds| !holds) && distance < reach;
        passed.then(|| Line::new(-n, weight * (reach + distance), at))
    }

    /// The corners of a wall, and its middle.
    fn corners(&self, wall: Thing) -> (Vec<DVec3>, DVec3) {
        let corners: Vec<DVec3> = match wall {
            Thing::Block(block) => (0..8).map(|vertex| vertex_of(&self.blocks[block], vertex).0).collect(),
            Thing::Face(face) => face_corners(&self.faces[face]),
            Thing::Ball(_) | Thing::Bar(_) => Vec::new(),
        };
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        (corners, middle)
    }

    /// The overlap of a sphere anywhere with a wall; `None` without a contact line.
    fn overlap_with(&self, x: DVec3, radius: f64, wall: Thing) -> Option<f64> {
        let ball = Ball { x, radius, ..self.balls[0].clone() };
        match wall {
            Thing::Block(block) => Some(sphere_box(&ball, &self.blocks[block]).o),
            Thing::Face(face) => sphere_face(&ball, &self.faces[face]).map(|line| line.o),
            Thing::Ball(_) | Thing::Bar(_) => None,
        }
    }

    /// Contact line of a solid with a corner of a wall, whether or not it counts.
    pub(crate) fn line_of_corner(&self, ball: usize, wall: Thing, number: usize) -> Option<Line> {
        let Part::Solid(core) = self.parts[ball] else { return None };
        Some(self.solid_line(core, *self.corners(wall).0.get(number)?, 0.0))
    }

    /// The contacts of a solid with the corners of a wall.
    pub(crate) fn touch_corners(&self, ball: usize, wall: Thing, found: &mut Vec<(Pair, Line)>) {
        for number in 0..self.corners(wall).0.len() {
            let line = self.line_of_corner(ball, wall, number).filter(|line| line.o > 0.0);
            let line = line.filter(|line| self.corner_counts(ball, wall, number, line.n));
            found.extend(line.map(|line| (Pair { a: Thing::Ball(ball), b: wall, feature: Feature::Corner(number) }, line)));
        }
    }

    fn corner_counts(&self, ball: usize, wall: Thing, number: usize, n: DVec3) -> bool {
        let (corners, middle) = self.corners(wall);
        let radius = self.round_radius(ball);
        let (p, near) = (corners[number], AT_CORNER * radius);
        let q = p - radius * n;
        if self.made(Mistake::WallCorners) {
            return false;
        }
        if !self.overlap_with(q, radius, wall).is_some_and(|o| (-near..=near).contains(&o)) {
            return false;
        }
        let way = p - middle;
        let t = (way - way.dot(n) * n).normalize_or_zero();
        let order = |thing: Thing| match thing {
            Thing::Block(block) => (0, block),
            Thing::Face(face) => (1, face),
            Thing::Ball(_) | Thing::Bar(_) => (2, 0),
        };
        let hides = |other: Thing| {
            let at = |x: DVec3| self.overlap_with(x, radius, other);
            let in_front = at(q).is_some_and(|o| o > near || order(other) < order(wall) && o >= -near);
            in_front || at(q + radius * t).is_some_and(|o| o >= -near)
        };
        let walls = (0..self.blocks.len()).map(Thing::Block).chain((0..self.faces.len()).map(Thing::Face));
        !walls.filter(|&other| other != wall && self.may_touch(Thing::Ball(ball), other)).any(hides)
    }
}
