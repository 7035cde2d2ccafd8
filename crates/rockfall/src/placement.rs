//! Checks where a scene places its bodies: bodies that overlap deeply or coincide, and bodies that fall for ever.

use std::collections::HashSet;
use std::fmt;

use rayon::prelude::*;

use crate::error::{Error, Result, non_finite};
use crate::model::muscles::MuscleClock;
use crate::physics::chain::touch;
use crate::physics::surface::visible_row;
use crate::report::short_number;
use crate::scene::{Anchor, Body, Handle, ImpliedBody, Scene, SphereId};
use crate::settings::{BroadPhase, Integrator};
use crate::simulation::frames::observe::overlaps_of_solids;
use crate::simulation::observe::{body, smaller_radius};
use crate::simulation::observed::{observe, view_and_lists};
use crate::user_laws::set::UserLaws;

/// Largest overlap of two bodies, in radii of the smaller one, that causes no warning.
pub const DEEP: f32 = 0.05;
/// Overlap of two spheres, as a share of the largest possible one, from which on their centres coincide.
const COINCIDE: f32 = 1.0 - 1e-5;

/// Problems of the initial positions of a scene.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Placement {
    /// The deepest overlap of two bodies, in radii of the smaller one; 0 when nothing overlaps.
    pub deepest: f32,
    /// Pairs of bodies that overlap by more than [`DEEP`], the deepest first.
    pub overlaps: Vec<Overlap>,
    /// Spheres that will fall for ever: one for each set of connected bodies. See [`Scene::falling`].
    pub falling: Vec<SphereId>,
}

/// Two bodies that overlap deeply.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Overlap {
    /// The bodies, in the order spheres, rods, boxes, polygons.
    pub bodies: [Body; 2],
    /// Depth of the overlap, in units.
    pub units: f32,
    /// Depth of the overlap, in radii of the smaller body.
    pub radii: f32,
    /// What the overlap is.
    pub what: Inside,
}

/// How two bodies overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Inside {
    /// The centres of two spheres coincide.
    Coincident,
    /// The centre of a sphere, or the axis of a rod, is inside a box.
    Box,
    /// The surfaces overlap.
    Surface,
}

/// What a joint is attached to.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum End {
    At(Anchor),
    /// A capsule or a frame of rods, by any of its spheres.
    Implied(Handle<ImpliedBody>),
}

impl Scene {
    /// Checks the initial positions: overlaps of more than 5 % of the smaller radius, and bodies that fall for ever.
    ///
    /// # Errors
    /// As for [`Simulation::new`](crate::Simulation::new), if the scene is too large.
    pub fn placement(&self) -> Result<Placement> {
        let mut found = Placement { falling: self.falling(), ..Placement::default() };
        if self.spheres().is_empty() {
            return Ok(found);
        }
        let objects = self.spheres().len() + self.rods().len() + self.boxes().len() + self.polygons().len();
        // The AABBs of a time step of almost 0 are the smallest, so they give the fewest pairs.
        let world = observe(
            self,
            1e-9,
            (Integrator::default(), BroadPhase::Auto.resolve(objects, true)),
            0,
            &MuscleClock::default(),
            &UserLaws::default(),
        )?;
        let (view, lists) = view_and_lists(&world);
        let of_mover = |mover: u32| {
            let own = visible_row(&view, &lists, mover).filter(move |entry| entry.id() > mover);
            let (view, scene) = (&view, self);
            own.filter_map(move |entry| {
                let touch = touch(view, mover, entry.id(), entry.feature())?;
                let radius = smaller_radius(view, mover, entry.id());
                let bodies = [mover, entry.id()].map(|id| body(scene, view, id));
                let what = scene.how(bodies, touch.overlap, radius);
                Some(Overlap { bodies, units: touch.overlap, radii: touch.overlap / radius, what })
            })
        };
        let mut overlaps: Vec<Overlap> = (0..world.movers()).into_par_iter().flat_map_iter(of_mover).collect();
        overlaps.retain(|overlap| !overlap.bodies.iter().any(|body| self.is_solid(*body)));
        let of_solids = overlaps_of_solids(self)?.into_iter();
        overlaps.extend(of_solids.map(|(bodies, units, radii)| Overlap { bodies, units, radii, what: Inside::Surface }));
        self.retain_unjoined(&mut overlaps);
        found.deepest = overlaps.iter().map(|overlap| overlap.radii).fold(0.0, f32::max);
        overlaps.retain(|overlap| overlap.radii > DEEP);
        // A stable sort keeps the order of addition among equals.
        overlaps.sort_by(|a, b| b.radii.total_cmp(&a.radii));
        found.overlaps = overlaps;
        Ok(found)
    }

    /// Whether a sphere stands for a box or a hull of a rigid body.
    pub(crate) fn is_solid(&self, body: Body) -> bool {
        match body {
            Body::Sphere(id) => self.box_of_sphere(id).is_some() || self.hull_of_sphere(id).is_some(),
            Body::Rod(_) | Body::Box(_) | Body::Polygon(_) => false,
        }
    }

    /// Removes overlaps of bodies that do not collide because of a joint.
    fn retain_unjoined(&self, overlaps: &mut Vec<Overlap>) {
        let apart = self.joints().iter().filter(|joint| !joint.collides).map(|joint| joint.anchors());
        let apart: Vec<[Anchor; 2]> = apart.filter(|ends| !ends.contains(&Anchor::World)).collect();
        if apart.is_empty() {
            return;
        }
        let mut scene = self.clone();
        scene.imply_bodies();
        let of_anchor = |anchor: Anchor| match anchor {
            Anchor::Sphere(id) => scene.end_of(Body::Sphere(id)),
            other => Some(End::At(other)),
        };
        let both = apart.iter().map(|ends| ends.map(of_anchor)).flat_map(|[a, b]| [[a, b], [b, a]]);
        let joined: HashSet<[Option<End>; 2]> = both.collect();
        overlaps.retain(|overlap| !joined.contains(&overlap.bodies.map(|body| scene.end_of(body))));
    }

    /// What a joint of a body is attached to. `None` for what joints cannot hold.
    fn end_of(&self, body: Body) -> Option<End> {
        match body {
            Body::Sphere(id) => {
                let implied = self.implied_of(id).map(End::Implied);
                Some(implied.unwrap_or_else(|| End::At(self.body_of_sphere(id).map_or(Anchor::Sphere(id), Anchor::Body))))
            }
            Body::Rod(id) => {
                let placed = self.body_of_rod(id).map(|id| End::At(Anchor::Body(id)));
                placed.or_else(|| self.implied_of_rod(id).map(End::Implied))
            }
            _ => None,
        }
    }

    /// A warning of bodies that overlap deeply at the start, as [`Scene::placement`] finds them, if there are some. Scenes of more than
    /// 200,000 objects are not searched: a run of them begins at once.
    pub fn overlap_concern(&self) -> Option<String> {
        const MOST: usize = 200_000;
        let counts = self.counts();
        if counts.spheres + counts.rods + counts.boxes + counts.polygons > MOST {
            return None;
        }
        let overlaps = self.placement().ok()?.overlaps;
        let others = match overlaps.len() {
            0 => return None,
            1 => String::new(),
            count => format!(", and {} more pairs overlap (see check)", count - 1),
        };
        Some(format!("{} at the start{others}", overlaps[0].describe(self)))
    }

    fn how(&self, bodies: [Body; 2], overlap: f32, radius: f32) -> Inside {
        match bodies {
            [Body::Sphere(a), Body::Sphere(b)] => {
                let sum = [a, b].map(|id| self.sphere(id).map_or(0.0, |sphere| sphere.radius)).iter().sum::<f32>();
                if overlap >= COINCIDE * sum { Inside::Coincident } else { Inside::Surface }
            }
            [_, Body::Box(_)] if overlap >= radius => Inside::Box,
            _ => Inside::Surface,
        }
    }

    /// The name of the sphere with an index.
    pub(crate) fn name_of_sphere(&self, index: usize) -> String {
        self.name_of(Body::Sphere(self.spheres.handle_at(index)))
    }

    /// The name of the spring with an index: the scene text has no other.
    pub(crate) fn name_of_spring(&self, index: usize) -> String {
        let [a, b] = [self.springs()[index].a, self.springs()[index].b].map(|id| self.name_of(Body::Sphere(id)));
        format!("the spring{} from {a} to {b}", self.called(self.springs.handle_at(index)))
    }

    /// The name of the tether with an index.
    pub(crate) fn name_of_tether(&self, index: usize) -> String {
        format!("the tether of {}", self.name_of(Body::Sphere(self.tethers()[index].sphere)))
    }

    /// The name of a body for a message: `sphere 7` for the sphere that the scene text calls 7; otherwise its index in order of
    /// addition, such as `sphere number 3`, `box number 0`. The name of an object follows: `sphere 7 ('left')`.
    pub fn name_of(&self, body: Body) -> String {
        let place = |index: Result<usize>| index.map_or_else(|_| "?".to_owned(), |index| index.to_string());
        match body {
            Body::Sphere(id) => {
                if let Some(body) = self.body_of_sphere(id) {
                    return format!("rigid body number {}{}", place(self.bodies.index(body)), self.called(body));
                }
                let capsule = || self.capsules().iter().position(|capsule| [capsule.end1, capsule.end2].contains(&id));
                let place = || match capsule() {
                    Some(capsule) => format!("capsule number {capsule}"),
                    None => format!("sphere number {}", place(self.spheres.index(id))),
                };
                self.reference(id).map_or_else(place, |reference| format!("sphere {reference}")) + &self.called(id)
            }
            Body::Rod(id) => format!("rod number {}{}", place(self.rods.index(id)), self.called(id)),
            Body::Box(id) => format!("box number {}{}", place(self.boxes.index(id)), self.called(id)),
            Body::Polygon(id) => format!("polygon number {}{}", place(self.polygons.index(id)), self.called(id)),
        }
    }
}

impl Error {
    /// The message, with the name that the scene text has for the sphere of [`Error::NonFinite`].
    pub fn describe(&self, scene: &Scene) -> String {
        match self {
            Self::NonFinite { sphere, step, stage } if *sphere < scene.spheres().len() => {
                non_finite(&scene.name_of_sphere(*sphere), *step, *stage, !scene.joints().is_empty())
            }
            error => error.to_string(),
        }
    }
}

impl Overlap {
    /// A message that names both bodies.
    pub fn describe(&self, scene: &Scene) -> String {
        let [a, b] = self.bodies.map(|body| scene.name_of(body));
        let Self { units, radii, what, .. } = self;
        let depth = Depth(*radii, *units);
        match what {
            Inside::Coincident => format!("{a} and {b} have the same centre"),
            Inside::Box => format!("{a} has its centre or axis inside {b}, {depth}"),
            Inside::Surface => format!("{a} and {b} overlap by {depth}"),
        }
    }
}

/// A depth in radii and in units.
struct Depth(f32, f32);

impl fmt::Display for Depth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [radii, units] = [self.0, self.1].map(|depth| short_number(depth.into(), 3));
        write!(f, "{radii} radii ({units} units)")
    }
}
