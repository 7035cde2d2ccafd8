//! Boxes and polygons between the camera and the bodies, like the near walls of a pit. They are translucent. A floor or a ramp on
//! which a body lies is not.

use std::collections::HashMap;

use rockfall::glam::Vec3;
use rockfall::{Look, Polygon, Scene, Surface};

use crate::block::Block;
use crate::draw::looks::look;
use crate::draw::summary::stage;
use crate::draw::surfaces::{Side, surfaces};
use crate::extent::{Extent, extent_of_polygon};
use crate::survey::Survey;
use crate::up::Up;

/// Number of lines of sight that are tested in a frame. In larger scenes only some of the bodies are tested.
const MOST_TESTS: usize = 4_000_000;
/// Number of points of the outline of a body that a polygon must not hide, and their distance from the centre, divided by the
/// radius. Polygons may be small parts of a wall, which would cover a part of a body.
const OUTLINE: usize = 8;
const OUTLINE_RADIUS: f32 = 0.9;
/// Height of the lower point of a body that has to be visible, above its lowest point and divided by its radius.
const FOOT: f32 = 0.08;
/// A box is a floor if its height, across its upper face, divided by the width of that face is less than this, or if more bodies lie
/// on it than it hides.
const FLOOR_HEIGHT: f32 = 0.25;
/// A polygon, or the upper face of a box, is a floor for a camera that sees it if its normal points upwards by at least this.
const FLOOR_NORMAL: f32 = 0.3;
/// A floor on which nothing lies is removed only if it hides more than this part of the bodies. It may hide some that fall past it.
/// A floor on which a body lies is never removed: the body would float.
const FLOOR_SHARE: f32 = 0.1;

/// The side of a surface of many polygons that the camera sees is removed as a whole if it hides more than this part of the bodies, like
/// the near side of a drum. One that hides fewer is a thing among the bodies, like a screw.
const SURFACE_SHARE: f32 = 0.7;

/// A translucent polygon casts its shadow if it is one of many that make up a surface, such as a bowl, whose shadow would
/// have a hole. It is one of many if it touches another one, and if its area is less than this part of that of all polygons.
const PART_OF_SURFACE: f32 = 0.125;
/// Distance up to which polygons touch, divided by the extent of one.
const TOUCHING: f32 = 0.01;
/// Number of polygons from which on all are parts of surfaces.
const MANY_POLYGONS: usize = 2000;

/// Number of frames for which a wall stays away, so that it does not flicker when bodies move behind it.
const HELD: u32 = 45;

/// A box or a polygon.
#[derive(Debug)]
struct Wall {
    block: Block,
    /// Number of bodies that lie on it.
    carried: usize,
}

/// The walls of a scene, and the points that they must not hide.
#[derive(Debug, Default)]
pub(crate) struct Walls {
    boxes: Vec<Wall>,
    polygons: Vec<(Polygon, Wall)>,
    /// Whether each polygon is one of many that make up a surface.
    parts: Vec<bool>,
    /// The surface that each polygon is part of.
    surfaces: Vec<usize>,
    /// Whether each box and each polygon is of glass. It hides nothing.
    glass: Vec<bool>,
    /// For how many calls each box and each polygon is translucent.
    held: Vec<u32>,
    /// The centre and radius of every body.
    balls: Vec<(Vec3, f32)>,
    /// The axis upwards in the last picture, on which depends what is a floor.
    up: Up,
}

impl Walls {
    /// Takes the boxes and polygons of a scene.
    pub(crate) fn set_scene(&mut self, scene: &Scene) {
        let wall = |block: Block| Wall { block, carried: 0 };
        self.boxes = scene.boxes().iter().map(|cuboid| wall(Block::of_box(cuboid))).collect();
        let stage = stage(scene);
        let polygons = scene.polygons().iter().map(|polygon| shown(polygon, stage));
        self.polygons = polygons.map(|polygon| (polygon, wall(Block::of_polygon(&polygon)))).collect();
        self.parts = parts_of_surfaces(scene.polygons());
        self.surfaces = surfaces(scene.polygons());
        self.held.clear();
    }

    /// Takes which boxes and polygons of the scene are of glass.
    pub(crate) fn set_glass(&mut self, scene: &Scene) {
        let looks = scene.box_ids().map(|id| look(scene, id)).chain(scene.polygon_ids().map(|id| look(scene, id)));
        self.glass = looks.map(|look| look == Some(Look::Glass)).collect();
    }

    /// The numbers of the polygons that are cones or balls.
    pub(crate) fn round(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.polygons).filter(|(_, (polygon, _))| polygon.surface.is_round()).map(|(number, _)| number)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.boxes.is_empty() && self.polygons.is_empty()
    }

    /// Takes the bodies that have to be visible.
    pub(crate) fn set_bodies(&mut self, survey: &Survey) {
        if self.is_empty() {
            return self.balls.clear();
        }
        let balls = survey.balls();
        let tests = 2 * self.boxes.len() + (2 + OUTLINE) * self.polygons.len();
        let stride = (tests * balls.len()).div_ceil(MOST_TESTS).max(1);
        // An odd stride does not always meet the same body or the same state.
        let stride = stride | 1;
        self.balls = balls.into_iter().step_by(stride).collect();
        self.count_carried();
    }

    fn count_carried(&mut self) {
        let up = self.up.vector();
        for wall in self.boxes.iter_mut().chain(self.polygons.iter_mut().map(|(_, wall)| wall)) {
            wall.carried = self.balls.iter().filter(|(place, radius)| wall.block.carries(*place, *radius, up)).count();
        }
    }

    /// Returns for each box, then for each polygon, 1 if it is drawn and 0 or 2 if it is translucent, because it hides a body. It
    /// still casts its shadow if that is 2. With `hold`, a wall that has hidden a body stays translucent for the next [`HELD`]
    /// calls.
    pub(crate) fn drawn(&mut self, eye: Vec3, up: Up, hold: bool) -> Vec<u32> {
        if up != self.up {
            self.up = up;
            self.count_carried();
        }
        let boxes = self.boxes.iter().map(|wall| self.is_before(wall, eye));
        let polygons = self.polygons_before(eye);
        let glass = self.glass.iter().copied().chain(std::iter::repeat(false));
        let hides: Vec<bool> = boxes.chain(polygons).zip(glass).map(|(hides, glass)| hides && !glass).collect();
        self.held.resize(hides.len(), 0);
        for (held, hides) in self.held.iter_mut().zip(hides) {
            *held = match hides {
                true => HELD,
                false if hold => held.saturating_sub(1),
                false => 0,
            };
        }
        let parts = self.parts.iter().map(|part| if *part { 2 } else { 0 });
        let hidden = std::iter::repeat_n(0, self.boxes.len()).chain(parts);
        self.held.iter().zip(hidden).map(|(held, hidden)| if *held == 0 { 1 } else { hidden }).collect()
    }

    fn is_before(&self, wall: &Wall, eye: Vec3) -> bool {
        let local = |point: Vec3| wall.block.local(point);
        let from = local(eye);
        if is_in_unit_cube(from) {
            // Everything is behind the faces of a box around the eye.
            return true;
        }
        let hides = |ball: &&(Vec3, f32)| {
            centre_and_foot(**ball, self.up.vector()).iter().any(|point| crosses_unit_cube(from, local(*point)))
        };
        let hidden = self.balls.iter().filter(hides).count();
        self.is_removed(hidden, wall.floor(eye, self.up.vector(), hidden))
    }

    /// Whether each polygon is removed: one of many that make up a surface with the side of the surface, another one alone.
    fn polygons_before(&self, eye: Vec3) -> Vec<bool> {
        let mut sides: HashMap<(usize, bool), Side> = HashMap::new();
        let mut found = Vec::with_capacity(self.polygons.len());
        for (number, (polygon, wall)) in self.polygons.iter().enumerate() {
            let normal = polygon.left.cross(polygon.right);
            let hidden = self.hidden_by(polygon, normal, eye);
            let floor = wall.floor(eye, self.up.vector(), hidden.len());
            let side = (self.surfaces[number], normal.dot(eye - polygon.corner) > 0.0);
            if self.parts[number] {
                let carried = if floor == Floor::Carries { wall.carried } else { 0 };
                sides.entry(side).or_default().add(self.balls.len(), &hidden, carried);
            }
            found.push((side, self.is_removed(hidden.len(), floor)));
        }
        let is_removed = |(number, (side, alone)): (usize, ((usize, bool), bool))| {
            if self.parts[number] { sides.get(&side).is_some_and(|side| side.hides(SURFACE_SHARE)) } else { alone }
        };
        found.into_iter().enumerate().map(is_removed).collect()
    }

    /// The numbers of the bodies that a polygon hides.
    fn hidden_by(&self, polygon: &Polygon, normal: Vec3, eye: Vec3) -> Vec<usize> {
        // The shader leaves out what of a cone or ball faces away.
        if polygon.surface.is_round() {
            return Vec::new();
        }
        let balls = self.balls.iter().enumerate();
        balls.filter(|(_, ball)| hides(polygon, normal, eye, self.up.vector(), **ball)).map(|(number, _)| number).collect()
    }

    fn is_removed(&self, hidden: usize, floor: Floor) -> bool {
        let share = hidden as f32 / self.balls.len().max(1) as f32;
        hidden > 0
            && match floor {
                Floor::None => true,
                Floor::Empty => share > FLOOR_SHARE,
                Floor::Carries => false,
            }
    }
}

/// Whether a wall is a floor or a ramp that the camera sees from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Floor {
    None,
    /// Nothing lies on it.
    Empty,
    Carries,
}

impl Wall {
    /// Whether the wall is a floor for an eye from which it hides this number of bodies.
    fn floor(&self, eye: Vec3, up: Vec3, hidden: usize) -> Floor {
        let top = self.block.top(up);
        if top.normal.dot(up) < FLOOR_NORMAL || top.normal.dot(eye - top.corner) <= 0.0 {
            return Floor::None;
        }
        let is_flat = top.height < FLOOR_HEIGHT * top.sides[0].min(top.sides[1]);
        // The upper face is larger than those on the sides.
        let is_broad = top.height < top.sides[0].min(top.sides[1]);
        match self.carried {
            0 if is_flat => Floor::Empty,
            0 => Floor::None,
            carried if is_broad || carried > hidden => Floor::Carries,
            _ => Floor::None,
        }
    }
}

/// The part of a plane that is drawn, as a parallelogram; other polygons as they are. The stage is the point near which planes are shown, and
/// half the edge of the square.
fn shown(polygon: &Polygon, (middle, size): (Vec3, f32)) -> Polygon {
    if polygon.surface != Surface::Plane {
        return *polygon;
    }
    let (left, right) = (polygon.left, polygon.right);
    let from_middle = polygon.corner - middle;
    let foot = middle + from_middle.project_onto(left.cross(right));
    Polygon::new(foot - size * (left + right), 2.0 * size * left, 2.0 * size * right)
}

/// Returns whether each polygon is one of many that make up a surface.
fn parts_of_surfaces(polygons: &[Polygon]) -> Vec<bool> {
    if polygons.len() > MANY_POLYGONS {
        return vec![true; polygons.len()];
    }
    let area = |polygon: &Polygon| polygon.left.cross(polygon.right).length();
    let all: f32 = polygons.iter().map(area).sum();
    let extents: Vec<Extent> = polygons.iter().map(extent_of_polygon).collect();
    let touches = |at: usize| {
        let room = extents[at].grown(TOUCHING * extents[at].size());
        extents.iter().enumerate().any(|(other, extent)| other != at && room.overlaps(*extent))
    };
    (0..polygons.len()).map(|at| area(&polygons[at]) < PART_OF_SURFACE * all && touches(at)).collect()
}

/// The centre of a body, and the point where it would touch the ground.
fn centre_and_foot((place, radius): (Vec3, f32), up: Vec3) -> [Vec3; 2] {
    [place, place - (1.0 - FOOT) * radius * up]
}

/// Whether a polygon hides the centre, the foot or a part of the outline of a ball.
fn hides(polygon: &Polygon, normal: Vec3, eye: Vec3, up: Vec3, ball: (Vec3, f32)) -> bool {
    let (place, radius) = ball;
    let [start, end] = [eye, place].map(|point| normal.dot(point - polygon.corner));
    if start * end > 0.0 && end.abs() > radius * normal.length() {
        // All of the ball is on this side of the plane.
        return false;
    }
    let (across, along) = (place - eye).normalize_or(Vec3::Z).any_orthonormal_pair();
    let outline = (0..OUTLINE).map(|point| {
        let (sin, cos) = (std::f32::consts::TAU * point as f32 / OUTLINE as f32).sin_cos();
        place + OUTLINE_RADIUS * radius * (cos * across + sin * along)
    });
    centre_and_foot(ball, up).into_iter().chain(outline).any(|point| crosses_polygon(polygon, eye, point))
}

/// Whether the line between two points goes through a polygon.
fn crosses_polygon(polygon: &Polygon, from: Vec3, to: Vec3) -> bool {
    let normal = polygon.left.cross(polygon.right);
    let [start, end] = [from, to].map(|point| normal.dot(point - polygon.corner));
    if start * end >= 0.0 {
        return false;
    }
    let point = from + start / (start - end) * (to - from) - polygon.corner;
    // The coordinates along the edges, from the areas of the triangles.
    let square = normal.length_squared();
    let [left, right] = [point.cross(polygon.right).dot(normal), polygon.left.cross(point).dot(normal)];
    let most = if polygon.surface == Surface::Triangle { square - left } else { square };
    (0.0..=square).contains(&left) && (0.0..=most).contains(&right)
}

fn is_in_unit_cube(point: Vec3) -> bool {
    point.cmpge(Vec3::ZERO).all() && point.cmple(Vec3::ONE).all()
}

/// Whether the line between two points goes through the unit cube; false if either point is in the cube.
fn crosses_unit_cube(from: Vec3, to: Vec3) -> bool {
    let line = to - from;
    if is_in_unit_cube(from) || is_in_unit_cube(to) {
        return false;
    }
    let (mut first, mut last) = (0.0_f32, 1.0_f32);
    for axis in 0..3 {
        let (start, along) = (from[axis], line[axis]);
        if along.abs() < 1e-12 {
            if !(0.0..=1.0).contains(&start) {
                return false;
            }
            continue;
        }
        let (one, two) = (-start / along, (1.0 - start) / along);
        first = first.max(one.min(two));
        last = last.min(one.max(two));
    }
    first < last
}

#[cfg(test)]
mod tests {
    use rockfall::{Cuboid, Sphere};

    use super::*;

    const EYE: Vec3 = Vec3::new(0.0, 1.0, 10.0);

    /// Which walls are drawn before ten balls that lie on the plane y = 0, and balls at `more` places.
    fn drawn(boxes: &[Cuboid], polygons: &[Polygon], more: &[Vec3]) -> Vec<u32> {
        let mut scene = Scene::new();
        for k in 0..10 {
            scene.add_sphere(Sphere::new([0.2 * k as f32 - 0.9, 0.1, 0.0], 0.1)).unwrap();
        }
        for place in more {
            scene.add_sphere(Sphere::new(*place, 0.1)).unwrap();
        }
        for cuboid in boxes {
            scene.add_box(*cuboid).unwrap();
        }
        for polygon in polygons {
            scene.add_polygon(*polygon).unwrap();
        }
        let mut walls = Walls::default();
        walls.set_scene(&scene);
        walls.set_bodies(&Survey::new(&scene));
        walls.drawn(EYE, Up::Y, false)
    }

    #[test]
    fn only_walls_in_front_of_the_bodies_are_removed() {
        let before = Cuboid::between([-5.0, 0.0, 3.0], [5.0, 2.0, 4.0]);
        let behind = Cuboid::between([-5.0, 0.0, -4.0], [5.0, 2.0, -3.0]);
        let floor = Cuboid::between([-50.0, -1.0, -50.0], [50.0, 0.0, 50.0]);
        let around_the_eye = Cuboid::between([-5.0, 0.0, 9.0], [5.0, 2.0, 11.0]);
        assert_eq!(drawn(&[before, behind, floor, around_the_eye], &[], &[]), [0, 1, 1, 0]);
    }

    #[test]
    fn a_wall_that_hides_a_single_body_or_its_foot_is_removed() {
        let narrow = Cuboid::between([-0.65, 0.0, 3.0], [-0.6, 2.0, 4.0]);
        assert_eq!(drawn(&[narrow], &[], &[]), [0]);
        // From the eye at (0, 1, 10), a wall of height 0.306 at z = 3 hides what is below 0.008 at z = 0.
        let low = Cuboid::between([-5.0, 0.0, 3.0], [5.0, 0.32, 3.1]);
        assert_eq!(drawn(&[low], &[], &[]), [0]);
        let lower = Cuboid::between([-5.0, 0.0, 3.0], [5.0, 0.30, 3.1]);
        assert_eq!(drawn(&[lower], &[], &[]), [1]);
    }

    #[test]
    fn a_wall_of_glass_is_not_removed() {
        let mut scene = Scene::new();
        scene.add_sphere(Sphere::new([0.0, 0.5, 0.0], 0.1)).unwrap();
        let pane = Polygon::new([-5.0, 0.0, 3.0], [10.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
        let [_, glass] = [pane, pane].map(|pane| scene.add_polygon(pane).unwrap());
        let wall = scene.add_box(Cuboid::between([-5.0, 0.0, 3.0], [5.0, 2.0, 4.0])).unwrap();
        scene.set_tag(glass, rockfall::Tag::new().look(Look::Glass)).unwrap();
        let mut walls = Walls::default();
        walls.set_scene(&scene);
        walls.set_bodies(&Survey::new(&scene));
        walls.set_glass(&scene);
        assert_eq!(walls.drawn(EYE, Up::Y, false), [0, 0, 1]);
        scene.set_tag(wall, rockfall::Tag::new().look(Look::Glass)).unwrap();
        walls.set_glass(&scene);
        assert_eq!(walls.drawn(EYE, Up::Y, false), [1, 0, 1]);
    }

    #[test]
    fn a_wall_comes_back_some_frames_after_the_body_has_left() {
        let scene = |x: f32| {
            let mut scene = Scene::new();
            scene.add_sphere(Sphere::new([x, 0.5, 0.0], 0.1)).unwrap();
            scene.add_box(Cuboid::between([-0.5, 0.0, 3.0], [0.5, 2.0, 4.0])).unwrap();
            scene
        };
        let mut walls = Walls::default();
        walls.set_scene(&scene(0.0));
        let mut drawn = |x: f32, hold: bool| {
            walls.set_bodies(&Survey::new(&scene(x)));
            walls.drawn(EYE, Up::Y, hold)
        };
        assert_eq!(drawn(0.0, true), [0]);
        assert!((1..HELD).all(|_| drawn(4.0, true) == [0]));
        assert_eq!(drawn(4.0, true), [1]);
        assert_eq!([drawn(0.0, false), drawn(4.0, false)], [[0], [1]]);
    }

    #[test]
    fn a_polygon_in_front_of_the_bodies_is_removed() {
        let before = Polygon::new([-5.0, 0.0, 3.0], [10.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
        let beside = Polygon::new([3.0, 0.0, 3.0], [10.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
        let floor = Polygon::new([-5.0, 0.0, -5.0], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0]);
        assert_eq!(drawn(&[], &[before, beside, floor], &[]), [0, 1, 1]);
    }

    /// The blade of a screw among the bodies stays whole, and the side of a drum before the bodies is removed as a whole.
    #[test]
    fn surfaces_of_many_polygons_are_removed_as_a_whole_or_not_at_all() {
        let strips = |x: f32, width: f32| -> Vec<Polygon> {
            let strip = |k: u8| Polygon::new([x, 0.1 * f32::from(k), 3.0], [width, 0.0, 0.0], [0.0, 0.1, 0.0]);
            (0..20).map(strip).collect()
        };
        assert_eq!(drawn(&[], &strips(-5.0, 10.0), &[]), [2; 20]);
        assert_eq!(drawn(&[], &strips(-0.1, 0.2), &[]), [1; 20]);
    }

    #[test]
    fn a_polygon_that_covers_a_part_of_a_body_is_removed() {
        // Beside the first ball, whose centre is at x = -0.9; a line of sight at z = 3 is at 0.7 times the x at z = 0.
        let beside = |x: f32| Polygon::new([x - 1.0, -1.0, 3.0], [0.0, 2.0, 0.0], [1.0, 0.0, 0.0]);
        assert_eq!(drawn(&[], &[beside(-0.66), beside(-0.71)], &[]), [0, 1]);
        assert_eq!(drawn(&[], &[flipped(beside(-0.66)), flipped(beside(-0.71))], &[]), [0, 1]);
    }

    #[test]
    fn a_polygon_on_which_the_bodies_lie_is_removed_only_if_seen_from_behind() {
        // An inclined plane that rises to the back, and one that rises to the front, whose back is seen.
        let plane = |rise: f32| Polygon::new([-5.0, -0.01 - 5.0 * rise, -5.0], [0.0, 10.0 * rise, 10.0], [10.0, 0.0, 0.0]);
        assert_eq!(drawn(&[], &[plane(-0.3)], &[]), [1]);
        assert_eq!(drawn(&[], &[plane(0.3)], &[]), [0]);
    }

    #[test]
    fn a_body_that_fell_past_a_polygon_does_not_remove_it() {
        let floor = Polygon::new([-5.0, 0.0, -5.0], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0]);
        let fallen = Vec3::new(0.0, -0.7, -6.0);
        assert_eq!(drawn(&[], &[floor, flipped(floor)], &[fallen]), [1, 0]);
    }

    fn flipped(polygon: Polygon) -> Polygon {
        Polygon::new(polygon.corner, polygon.right, polygon.left)
    }

    #[test]
    fn a_step_that_carries_bodies_is_not_removed_for_a_single_one_behind_it() {
        let step = Cuboid::between([-5.0, 0.0, 2.0], [5.0, 0.5, 2.5]);
        let behind = Vec3::new(0.0, 0.2, 1.0);
        let on_it: Vec<Vec3> = (0..10).map(|k| Vec3::new(k as f32, 0.6, 2.2)).collect();
        // The ten balls of the scene are behind it too, unless it is low.
        assert_eq!(drawn(&[step], &[], &on_it), [0]);
        let low = Cuboid::between([-5.0, -1.0, 2.0], [5.0, 0.0, 2.5]);
        let on_it: Vec<Vec3> = (0..10).map(|k| Vec3::new(k as f32, 0.1, 2.2)).collect();
        assert_eq!(drawn(&[low], &[], &[behind - 0.5 * Vec3::Y]), [0]);
        assert_eq!(drawn(&[low], &[], &[&on_it[..], &[behind - 0.5 * Vec3::Y]].concat()), [1]);
        // A body on a wall that hides two others does not keep it.
        let two = [behind - 0.5 * Vec3::Y, behind - 0.5 * Vec3::Y + 0.3 * Vec3::X];
        assert_eq!(drawn(&[low], &[], &[&on_it[..1], &two].concat()), [0]);
    }

    #[test]
    fn a_pane_that_is_not_drawn_casts_no_shadow_and_a_part_of_a_bowl_does() {
        let pane = |x: f32, width: f32| Polygon::new([x, 0.0, 3.0], [width, 0.0, 0.0], [0.0, 2.0, 0.0]);
        assert_eq!(drawn(&[], &[pane(-5.0, 10.0)], &[]), [0]);
        let strips: Vec<Polygon> = (0..20).map(|k| pane(-5.0 + 0.5 * k as f32, 0.5)).collect();
        assert!(drawn(&[], &strips, &[]).contains(&2));
        let apart: Vec<Polygon> = (0..20).map(|k| pane(-5.0 + 0.5 * k as f32, 0.4)).collect();
        assert!(!drawn(&[], &apart, &[]).contains(&2));
    }

    /// A ramp on which a ball rolls, above another one, hides what rolls on the lower one.
    #[test]
    fn a_ramp_or_a_floor_that_carries_a_body_is_never_removed() {
        let ramp = Cuboid::new([-2.0, 0.1, 1.0], [4.0, 1.0, 0.0], [-0.02, 0.08, 0.0], [0.0, 0.0, 3.0]);
        let beside = [Vec3::new(0.1, 0.81, 2.5)];
        let seen = |eye: Vec3, more: &[Vec3]| {
            let mut scene = Scene::new();
            let below = (0..10).map(|k| Vec3::new(0.1 * k as f32 - 0.5, 0.1, 0.5));
            for place in below.chain(more.iter().copied()) {
                scene.add_sphere(Sphere::new(place, 0.1)).unwrap();
            }
            scene.add_box(ramp).unwrap();
            let mut walls = Walls::default();
            walls.set_scene(&scene);
            walls.set_bodies(&Survey::new(&scene));
            walls.drawn(eye, Up::Y, false)
        };
        let above = Vec3::new(0.0, 9.0, 9.0);
        assert_eq!(seen(above, &[]), [0]);
        assert_eq!(seen(above, &beside), [1]);
        // From below, its upper face is not seen.
        assert_eq!(seen(Vec3::new(0.0, -1.0, 9.0), &[beside[0], Vec3::new(0.0, 3.0, 0.0)]), [0]);
    }

    /// The bodies of a scene with an inlet are those that are there, and not the corners of the room that they need.
    #[test]
    fn a_belt_that_carries_spheres_from_an_inlet_is_not_removed() {
        let text = "@inlet box=-1,5,-1,1,6,1 rate=9 radius=0.1\nB -2 -0.5 -2 4 0 0 0 0.5 0 0 0 4\nB -4 -9 -4 8 0 0 0 0.5 0 0 0 8\n\
                    S 1 0 0.1 0 0 0 0 0 0 0 1 0.1\nS 2 1 0.1 0 0 0 0 0 0 0 1 0.1\nS 3 0 -4 -1 0 0 0 0 0 0 1 0.1\n";
        let scene = Scene::parse(text, std::path::Path::new("a.txt")).unwrap().scene;
        let mut walls = Walls::default();
        walls.set_scene(&scene);
        walls.set_bodies(&Survey::new(&scene));
        assert_eq!(walls.drawn(Vec3::new(0.0, 9.0, 9.0), Up::Y, false), [1, 1]);
    }

    #[test]
    fn a_body_that_fell_off_the_floor_does_not_remove_it() {
        let floor = Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]);
        assert_eq!(drawn(&[floor], &[], &[Vec3::new(0.0, -0.7, -6.0)]), [1]);
        assert_eq!(drawn(&[floor], &[], &[Vec3::new(0.0, -90.0, -6.0)]), [1]);
    }
}
