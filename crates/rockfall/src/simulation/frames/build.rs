//! Makes the bodies and colliders of the law `rigid` from a scene.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DQuat, DVec3, Vec3};

use super::loads::loads_of_spheres;
use super::{Owner, motions};
use crate::error::Result;
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Shape};
use crate::rigid::world::{Body, Collider, Kind, RigidWorld, Surface};
use crate::scene::{AnyForm, Body as Part, GrainKind, MaterialId, Scene, ShapeHull, WholeBody};

/// A world under construction, and who its bodies are in the scene.
pub(super) struct Builder<'a> {
    pub(super) scene: &'a Scene,
    pub(super) world: RigidWorld,
    pub(super) owners: Vec<Owner>,
    /// Where the coordinates of the world begin in those of the scene, in units.
    pub(super) base: DVec3,
    /// Where the origin of the body of each motion lies before the motion, in coordinates of the scene, in units.
    pub(super) origins: Vec<DVec3>,
    /// What each collider is in the scene.
    pub(super) parts: Vec<Part>,
    /// Numbers of the shapes that are known, by the bits of their sizes; of hulls, by their place in memory.
    shapes: HashMap<[u32; 8], u32>,
}

impl<'a> Builder<'a> {
    /// All bodies of a scene that [`check`](super::check::check) accepts: the world, the motions with their walls, then the loose spheres
    /// and the bodies that move as a whole, each in order of addition.
    pub(super) fn build(scene: &'a Scene, base: DVec3) -> Result<Self> {
        let world = RigidWorld { bodies: vec![Body::fixed(Kind::World, Pose::IDENTITY)], ..RigidWorld::default() };
        let owners = vec![Owner::World];
        let mut builder = Self { scene, world, owners, base, origins: Vec::new(), parts: Vec::new(), shapes: HashMap::new() };
        builder.world.gravity = scene.settings.gravity * scene.settings.gravity_direction;
        builder.world.least_to_come = builder.least_to_come();
        builder.world.periods = builder.periods();
        builder.surfaces();
        builder.motions()?;
        builder.walls()?;
        builder.repeat_walls();
        builder.spheres()?;
        for (number, body) in scene.whole_bodies().enumerate() {
            builder.body(number, &body)?;
        }
        builder.springs()?;
        builder.joints()?;
        builder.world.take_into_box();
        Ok(builder)
    }

    /// The least edge or diameter of what comes in through inlets.
    fn least_to_come(&self) -> Option<f32> {
        let of_shape = |shape: &crate::scene::Shape| {
            let spheres = shape.spheres.iter().map(|part| 2.0 * part.radius);
            let boxes = shape.boxes.iter().map(|part| 2.0 * part.core().half.min_element() as f32);
            let hulls = shape.hulls.iter().map(|part| Shape { core: Core::Hull(Arc::clone(&part.hull)), radius: 0.0 }.width());
            spheres.chain(boxes).chain(hulls).fold(f32::INFINITY, f32::min)
        };
        let of_kind = |(kind, _): &(GrainKind, f64)| match kind.shape {
            Some(shape) => self.scene.shape(shape).map_or(f32::INFINITY, of_shape),
            None => 2.0 * kind.radii.bounds(kind.by).0 as f32,
        };
        self.scene.inlets().iter().flat_map(|inlet| &inlet.kinds).map(of_kind).reduce(f32::min)
    }

    /// The constants of all pairs of materials.
    fn surfaces(&mut self) {
        let count = self.scene.materials().len() + 1;
        let settings = &self.scene.settings;
        let of = |one: usize, other: usize| {
            let pair = self.scene.pair_of_numbers(one as u16, other as u16);
            Surface {
                friction: pair.friction.unwrap_or(settings.coulomb_friction),
                restitution: pair.restitution.unwrap_or(settings.restitution),
            }
        };
        self.world.materials = count;
        self.world.surfaces = (0..count * count).map(|place| of(place / count, place % count)).collect();
    }

    /// A kinematic body for each motion, about the middle of its walls.
    fn motions(&mut self) -> Result<()> {
        let mut places = vec![Vec::new(); self.scene.motions().len() + 1];
        for cuboid in self.scene.boxes() {
            places[self.scene.body_number(cuboid.motion)? as usize].push(cuboid.frame().0);
        }
        for polygon in self.scene.polygons() {
            places[self.scene.body_number(polygon.motion)? as usize].push(motions::middle_of(polygon));
        }
        for (number, places) in places.into_iter().enumerate().skip(1) {
            self.origins.push(motions::middle(places.into_iter()));
            self.add(Body::fixed(Kind::Kinematic, Pose::IDENTITY), Owner::Motion(number - 1));
        }
        Ok(())
    }

    /// Loose spheres.
    fn spheres(&mut self) -> Result<()> {
        for (id, sphere) in self.scene.sphere_ids().zip(self.scene.spheres()) {
            if sphere.fixed || self.scene.moves_with_body(id) {
                continue;
            }
            let pose = Pose::new(self.local(sphere.centre().into()), sphere.orientation);
            let moments = Vec3::splat(sphere.inertia());
            let mut body = Body::loose(pose, sphere.mass, moments, glam::Quat::IDENTITY);
            (body.velocity, body.momentum, body.force) = (sphere.velocity, sphere.angular_momentum, sphere.force);
            body.spin = body.inverse_inertia * body.momentum;
            let shape = self.shape(Core::Point, sphere.radius);
            let number = self.add(body, Owner::Sphere(id));
            self.collider(Part::Sphere(id), number, shape, Pose::IDENTITY, (sphere.group, sphere.material))?;
            self.measure(number);
        }
        Ok(())
    }

    /// A body that moves as a whole, the `number`-th of the scene.
    fn body(&mut self, number: usize, whole: &WholeBody<'_>) -> Result<()> {
        let kinetics = whole.kinetics;
        let state = whole.state;
        let pose = Pose::new(self.local(state.position.wide()), state.orientation);
        let mut body = Body::loose(pose, kinetics.mass as f32, kinetics.moments.as_vec3(), kinetics.axes.as_quat());
        (body.velocity, body.momentum) = (state.velocity, state.momentum);
        body.spin = body.inverse_inertia * body.momentum;
        let own = self.scene.bodies().get(number).map_or([Vec3::ZERO; 2], |body| [body.force, body.torque]);
        let of_spheres = loads_of_spheres(self.scene, whole);
        (body.force, body.torque) = (own[0] + of_spheres[0], own[1] + of_spheres[1]);
        let number = self.add(body, Owner::Body(number));
        // Places from the centre of mass, in coordinates of the body.
        let (places, boxes): (Vec<DVec3>, &[_]) = match whole.form {
            AnyForm::Shape(_, shape) => {
                (shape.spheres.iter().map(|part| part.centre.as_dvec3() - kinetics.centre).collect(), &shape.boxes)
            }
            AnyForm::Implied(form) => (form.places.clone(), &[]),
        };
        let own = whole.spheres.iter().zip(&places);
        let ends = |id| whole.spheres.iter().position(|sphere| *sphere == id).unwrap_or_default();
        let mut covered = vec![false; places.len()];
        for id in whole.rods {
            let rod = self.scene.rod(*id)?;
            let [one, other] = [rod.end1, rod.end2].map(ends);
            for end in [one, other] {
                let sphere = self.scene.sphere(whole.spheres[end])?;
                // A capsule has the ball at its end.
                covered[end] |= sphere.radius <= rod.radius && (sphere.material, sphere.group) == (rod.material, rod.group);
            }
            let (half, place) = segment(places[one], places[other]);
            let shape = self.shape(Core::Segment { half }, rod.radius);
            self.collider(Part::Rod(*id), number, shape, place, (rod.group, rod.material))?;
        }
        for ((id, place), _) in own.zip(&covered).filter(|(_, covered)| !**covered) {
            let sphere = self.scene.sphere(*id)?;
            let shape = self.shape(Core::Point, sphere.radius);
            let place = Pose::new(place.as_vec3(), glam::Quat::IDENTITY);
            self.collider(Part::Sphere(*id), number, shape, place, (sphere.group, sphere.material))?;
        }
        // A box or a hull of a body goes by the name of the sphere that stands for it.
        let solids = &whole.spheres[places.len()..];
        let hulls: &[ShapeHull] = if let AnyForm::Shape(_, shape) = whole.form { &shape.hulls } else { &[] };
        for (part, solid) in boxes.iter().zip(solids) {
            let core = part.core();
            let shape = self.shape(Core::Box { half: core.half.as_vec3() }, 0.0);
            let place = Pose::new((core.centre - kinetics.centre).as_vec3(), core.turn.as_quat());
            self.collider(Part::Sphere(*solid), number, shape, place, (part.cuboid.group, part.cuboid.material))?;
        }
        for (part, id) in hulls.iter().zip(solids.iter().skip(boxes.len())) {
            let shape = self.shape(Core::Hull(Arc::clone(&part.hull)), 0.0);
            let place = Pose::new((part.centre.as_dvec3() - kinetics.centre).as_vec3(), glam::Quat::IDENTITY);
            self.collider(Part::Sphere(*id), number, shape, place, (part.group(), part.material()))?;
        }
        self.measure(number);
        Ok(())
    }

    /// A point of the scene in coordinates of the world.
    pub(super) fn local(&self, point: DVec3) -> Vec3 {
        (point - self.base).as_vec3()
    }

    fn add(&mut self, body: Body, owner: Owner) -> u32 {
        self.world.bodies.push(body);
        self.owners.push(owner);
        self.world.bodies.len() as u32 - 1
    }

    /// The number of a shape, which equal colliders share.
    pub(super) fn shape(&mut self, core: Core, radius: f32) -> u32 {
        let sizes: [f32; 6] = match &core {
            Core::Point | Core::HalfSpace | Core::Hull(_) => [0.0; 6],
            Core::Segment { half } => [*half, 0.0, 0.0, 0.0, 0.0, 0.0],
            Core::Face { u, v, .. } => [u.x, u.y, u.z, v.x, v.y, v.z],
            Core::Cone { half, radii: [low, high], .. } => [*half, *low, *high, 0.0, 0.0, 0.0],
            Core::Bowl { radius } => [*radius, 0.0, 0.0, 0.0, 0.0, 0.0],
            Core::Box { half } => [half.x, half.y, half.z, 0.0, 0.0, 0.0],
        };
        let kind = match &core {
            Core::Point => 0,
            Core::Segment { .. } => 1,
            Core::Face { one_sided, is_triangle, is_facet, .. } => {
                2 + u32::from(*one_sided) + 8 * u32::from(*is_triangle) + 16 * u32::from(*is_facet)
            }
            Core::Cone { inside, .. } => 7 + 32 * u32::from(*inside),
            Core::Bowl { .. } => 32,
            Core::Box { .. } => 4,
            Core::Hull(_) => 5,
            Core::HalfSpace => 6,
        };
        let [mut a, mut b, c, d, e, f] = sizes.map(f32::to_bits);
        if let Core::Hull(hull) = &core {
            let place = Arc::as_ptr(hull) as u64;
            (a, b) = (place as u32, (place >> 32) as u32);
        }
        let shapes = &mut self.world.shapes;
        *self.shapes.entry([kind, radius.to_bits(), a, b, c, d, e, f]).or_insert_with(|| {
            shapes.push(Shape { core, radius });
            shapes.len() as u32 - 1
        })
    }

    pub(super) fn collider(
        &mut self,
        part: Part,
        body: u32,
        shape: u32,
        place: Pose,
        (group, material): (u16, Option<MaterialId>),
    ) -> Result<&mut Collider> {
        let material = self.scene.material_number(material)?;
        self.parts.push(part);
        let group = self.scene.groups.words(group);
        self.world.colliders.push(Collider { body, shape, place, group, material, surface_velocity: Vec3::ZERO });
        let last = self.world.colliders.len() - 1;
        Ok(&mut self.world.colliders[last])
    }

    /// Sets the radius and the width of a body from its colliders.
    fn measure(&mut self, body: u32) {
        let own = self.world.colliders.iter().rev().take_while(|collider| collider.body == body);
        let shape = |collider: &Collider| &self.world.shapes[collider.shape as usize];
        let reach = |collider: &Collider| collider.place.position.length() + shape(collider).extent();
        let (radius, width) = own.fold((0.0_f32, f32::INFINITY), |(radius, width), collider| {
            (radius.max(reach(collider)), width.min(shape(collider).width()))
        });
        let body = &mut self.world.bodies[body as usize];
        (body.radius, body.width) = (radius, width);
    }
}

/// A segment between two points: half its length, and its place. Its own axis is y.
pub(super) fn segment(from: DVec3, to: DVec3) -> (f32, Pose) {
    let along = to - from;
    let turn = DQuat::from_rotation_arc(DVec3::Y, along.try_normalize().unwrap_or(DVec3::Y));
    ((0.5 * along.length()) as f32, Pose::new((0.5 * (from + to)).as_vec3(), turn.as_quat()))
}

/// Distances between the points at which worlds may begin, in units. Near the origin of the scene its coordinates are those of the world.
const GRID: f64 = 1024.0;

/// Where the coordinates of a world begin: a point of a coarse grid, next to the middle of all that moves. Places are in single precision,
/// so a body far from the origin would move in steps of the rounding of its place.
pub(super) fn base_of(scene: &Scene) -> DVec3 {
    let places = scene.spheres().iter().filter(|sphere| !sphere.fixed).map(|sphere| sphere.position.as_dvec3());
    let base = (motions::middle(places) / GRID).round() * GRID;
    if base.is_finite() { base } else { DVec3::ZERO }
}
