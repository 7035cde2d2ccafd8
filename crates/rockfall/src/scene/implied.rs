//! Implied bodies: capsules, and under the law `rigid` frames of rods, that move as rigid bodies (docs/physics section 1.6).

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3, Vec3};

use super::rigid::{BodyState, Frame};
use super::shape::capsule_along_x;
use super::{Handle, Kinetics, MassProperties, RigidBodyId, RodId, Scene, Shape, ShapeId, Sphere, SphereId};
use crate::disjoint::DisjointSets;
use crate::error::Result;
use crate::fine::Fine;
use crate::settings::{ContactLaw, Settings};

/// Most spheres of an implied body. The work to find out whether a network is rigid grows with the third power of their number.
const MOST_SPHERES: usize = 100;
/// Sweeps over the rods of a network that restore their lengths, and the relative error at which they end.
const SWEEPS: usize = 1_000;
const LENGTH_ERROR: f64 = 1e-6;
/// How far spheres may be off their places in a form, as a part of its size.
const OFF_PLACE: f64 = 1e-4;
/// The least cosine of the angle between a rod and the first axis of an orientation that fits it.
const FITS: f64 = 1.0 - 1e-6;
/// Elements of a matrix of unit vectors below this size count as 0.
const NEGLIGIBLE: f64 = 1e-6;

/// Where the spheres of an implied body are, from its centre of mass in its coordinates, and how it moves. Equal pairs of spheres share it.
#[derive(Debug)]
pub(crate) struct Form {
    pub(crate) places: Vec<DVec3>,
    pub(crate) kinetics: Kinetics,
}

/// Spheres and rods of the scene that move as a rigid body.
#[derive(Clone, Debug)]
pub(crate) struct ImpliedBody {
    pub(crate) spheres: Vec<SphereId>,
    pub(crate) rods: Vec<RodId>,
    pub(crate) form: Arc<Form>,
    pub(crate) state: BodyState,
}

/// A body that moves as a whole.
pub(crate) struct WholeBody<'a> {
    pub(crate) form: AnyForm<'a>,
    pub(crate) kinetics: &'a Kinetics,
    pub(crate) spheres: &'a [SphereId],
    pub(crate) rods: &'a [RodId],
    pub(crate) state: BodyState,
}

/// What a body that moves as a whole consists of.
#[derive(Clone, Copy)]
pub(crate) enum AnyForm<'a> {
    Shape(ShapeId, &'a Shape),
    Implied(&'a Arc<Form>),
}

/// Handles of all bodies that move as a whole, in the order of [`Scene::whole_bodies`].
#[derive(Debug)]
pub(crate) struct BodyHandles {
    pub(crate) declared: Vec<RigidBodyId>,
    pub(crate) implied: Vec<Handle<ImpliedBody>>,
}

impl BodyHandles {
    pub(crate) fn of(scene: &Scene) -> Self {
        Self { declared: scene.body_ids().collect(), implied: scene.implied.handles().collect() }
    }
}

/// Moving spheres that rods of fixed length join to nothing else, by their indices in ascending order.
struct Network {
    spheres: Vec<usize>,
    rods: Vec<usize>,
}

/// What the form of two spheres with a rod follows from: bits of their masses and radii, of the radius of the rod and of its
/// length, and the number of rods.
type PairKey = [u32; 7];

impl Scene {
    /// Finds the implied bodies. Those that are known stay as they are, and so does their state.
    pub(crate) fn imply_bodies(&mut self) {
        let networks = self.candidates();
        let id_of = |network: &Network| self.implied_of(self.spheres.handle_at(network.spheres[0]));
        let is_known = |network: &&Network| {
            id_of(network).and_then(|id| self.implied.get(id).ok()).is_some_and(|body| {
                body.spheres.iter().copied().eq(network.spheres.iter().map(|index| self.spheres.handle_at(*index)))
                    && body.rods.iter().copied().eq(network.rods.iter().map(|index| self.rods.handle_at(*index)))
            })
        };
        let (known, new): (Vec<_>, Vec<_>) = networks.iter().partition(is_known);
        let kept: HashSet<_> = known.into_iter().filter_map(id_of).collect();
        let bodies = self.formed(new);
        let ends = if bodies.is_empty() { Vec::new() } else { self.ends_at_spheres() };
        let turns: Vec<_> = ends.iter().map(|end| self.spheres.get(end.sphere).map(|sphere| sphere.orientation)).collect();
        let gone: Vec<_> = self.implied.handles().filter(|id| !kept.contains(id)).collect();
        // All of them are there.
        let _ = self.implied.remove(&gone);
        for body in bodies {
            let id = self.keep_implied(body);
            self.place_implied(id);
        }
        // A sphere has the orientation of its body from now on.
        for (end, turn) in ends.into_iter().zip(turns) {
            if turn.ok() != self.spheres.get(end.sphere).map(|sphere| sphere.orientation).ok() {
                self.put_end(end);
            }
        }
    }

    /// The implied bodies that a simulation of this scene begins with, if it has none yet.
    pub(crate) fn bodies_to_imply(&self) -> Vec<ImpliedBody> {
        self.formed(&self.candidates())
    }

    /// The networks that the settings let be bodies.
    fn candidates(&self) -> Vec<Network> {
        self.networks().into_iter().filter(|network| self.may_be_body(network)).collect()
    }

    /// The bodies that networks are.
    fn formed<'a>(&self, networks: impl IntoIterator<Item = &'a Network>) -> Vec<ImpliedBody> {
        let mut forms = HashMap::new();
        networks.into_iter().filter_map(|network| self.implied_body(network, &mut forms)).collect()
    }

    /// Whether the settings let a network be a body: under the law `rigid`, and a pair of spheres under a law with history
    /// without collisions.
    fn may_be_body(&self, network: &Network) -> bool {
        let Settings { contact_law, collisions, .. } = self.chosen_settings();
        contact_law == ContactLaw::Rigid || network.spheres.len() == 2 && contact_law.has_history() && !collisions
    }

    /// Adds an implied body whose spheres are where they should be.
    pub(crate) fn keep_implied(&mut self, body: ImpliedBody) -> Handle<ImpliedBody> {
        let (spheres, rods) = (body.spheres.clone(), body.rods.clone());
        let id = self.implied.add(body);
        self.implied_members.put(&spheres, &rods, id);
        id
    }

    /// Sets the state of an implied body. Its spheres follow.
    pub(crate) fn put_implied(&mut self, id: Handle<ImpliedBody>, state: BodyState) -> Result<()> {
        self.implied.get_mut(id)?.state = state;
        self.place_implied(id);
        Ok(())
    }

    /// Gives the spheres of an implied body the places and motions that follow from it.
    fn place_implied(&mut self, id: Handle<ImpliedBody>) {
        if !self.place_spheres_of(id) {
            // The spheres are finite by themselves, but not with the motion of the whole: it stops.
            if let Ok(ImpliedBody { state, .. }) = self.implied.get_mut(id) {
                (state.velocity, state.momentum) = (Vec3::ZERO, Vec3::ZERO);
            }
            self.place_spheres_of(id);
        }
    }

    /// Places the spheres of an implied body. Returns whether their motions are finite.
    fn place_spheres_of(&mut self, id: Handle<ImpliedBody>) -> bool {
        let Ok(ImpliedBody { spheres, form, state, .. }) = self.implied.get(id) else { return true };
        let (frame, mut finite) = (Frame::of(state, &form.kinetics), true);
        for (id, place) in spheres.iter().zip(&form.places) {
            if let Ok(sphere) = self.spheres.get_mut(*id) {
                frame.place(sphere, *place, state.orientation);
                finite &= sphere.velocity.is_finite() && sphere.angular_momentum.is_finite();
            }
        }
        finite
    }

    /// The implied body that a sphere is part of.
    pub(crate) fn implied_of(&self, id: SphereId) -> Option<Handle<ImpliedBody>> {
        self.implied_members.of_sphere(id).filter(|owner| self.implied.index(*owner).is_ok())
    }

    /// The implied body that a rod is part of.
    pub(crate) fn implied_of_rod(&self, id: RodId) -> Option<Handle<ImpliedBody>> {
        self.implied_members.of_rod(id).filter(|owner| self.implied.index(*owner).is_ok())
    }

    /// Makes spheres and what moves with them networks again, until implied bodies are found the next time.
    pub(crate) fn release_spheres(&mut self, ids: &[SphereId]) {
        let owners: HashSet<_> = ids.iter().filter_map(|id| self.implied_of(*id)).collect();
        // All of them are there.
        let _ = self.implied.remove(&Vec::from_iter(owners));
    }

    /// [`Scene::release_spheres`] for rods.
    pub(crate) fn release_rods(&mut self, ids: &[RodId]) {
        let owners: HashSet<_> = ids.iter().filter_map(|id| self.implied_of_rod(*id)).collect();
        // All of them are there.
        let _ = self.implied.remove(&Vec::from_iter(owners));
    }

    /// All bodies that move as a whole: the rigid bodies of the scene, then the implied ones.
    pub(crate) fn whole_bodies(&self) -> impl Iterator<Item = WholeBody<'_>> {
        let declared = self.bodies().iter().filter_map(|body| {
            let (shape, kinetics) = (self.shape(body.shape).ok()?, self.shape_mass(body.shape).ok()?);
            let form = AnyForm::Shape(body.shape, shape);
            Some(WholeBody { form, kinetics, spheres: body.spheres(), rods: body.rods(), state: body.state() })
        });
        let implied = self.implied.objects().iter().map(|body| WholeBody {
            form: AnyForm::Implied(&body.form),
            kinetics: &body.form.kinetics,
            spheres: &body.spheres,
            rods: &body.rods,
            state: body.state,
        });
        declared.chain(implied)
    }

    /// Whether a sphere moves with a rigid body or an implied one.
    pub(crate) fn moves_with_body(&self, id: SphereId) -> bool {
        self.body_of_sphere(id).is_some() || self.implied_of(id).is_some()
    }

    fn networks(&self) -> Vec<Network> {
        let index = |id: SphereId| self.spheres.index(id).unwrap_or_default();
        let all = self.rods().iter().enumerate().filter(|(_, rod)| rod.length.is_some());
        let rods: Vec<(usize, [usize; 2])> = all.map(|(number, rod)| (number, [rod.end1, rod.end2].map(index))).collect();
        if rods.is_empty() {
            return Vec::new();
        }
        // Rods to a rigid body hold a network as those to a fixed sphere do.
        let is_held =
            |sphere: usize| self.spheres()[sphere].fixed || self.body_of_sphere(self.spheres.handle_at(sphere)).is_some();
        let is_fixed = |sphere: &usize| is_held(*sphere);
        let mut sets = DisjointSets::new(self.spheres().len());
        rods.iter().filter(|(_, ends)| !ends.iter().any(is_fixed)).for_each(|(_, ends)| sets.join(*ends));
        let moving_end = |ends: [usize; 2]| ends.into_iter().find(|end| !is_fixed(end));
        let groups = sets.group(rods.iter().filter_map(|rod| Some((moving_end(rod.1)?, *rod))));
        let loose = groups.into_iter().filter(|group| !group.iter().flat_map(|(_, ends)| ends).any(is_fixed));
        let network = |group: Vec<(usize, [usize; 2])>| {
            let mut spheres: Vec<usize> = group.iter().flat_map(|(_, ends)| *ends).collect();
            spheres.sort_unstable();
            spheres.dedup();
            Network { spheres, rods: group.into_iter().map(|(number, _)| number).collect() }
        };
        loose.map(network).collect()
    }

    /// The body that a network is; `None` if it can change its shape.
    fn implied_body(&self, network: &Network, forms: &mut HashMap<PairKey, Arc<Form>>) -> Option<ImpliedBody> {
        let ends = self.places_of_ends(network);
        let count = network.spheres.len();
        if count > MOST_SPHERES || count > 2 && network.rods.len() < 3 * count - 6 {
            return None;
        }
        let points = self.straightened(network, &ends)?;
        if self.exceeds_period(network, &points) {
            return None;
        }
        if count > 2 && rank(&rigidity(&points, &ends)) < 3 * count - 6 {
            return None;
        }
        let spheres: Vec<SphereId> = network.spheres.iter().map(|index| self.spheres.handle_at(*index)).collect();
        let balls = Balls::of(self, &spheres, &points)?;
        let form = if count == 2 {
            match forms.entry(self.key_of_pair(network)) {
                Entry::Occupied(known) => known.get().clone(),
                Entry::Vacant(new) => new.insert(Arc::new(self.pair_form(network, &balls)?)).clone(),
            }
        } else {
            let back = balls.turn.unwrap_or(DQuat::IDENTITY).inverse();
            let (turn, places) = (DMat3::from_quat(back), balls.arms.iter().map(|arm| back * *arm).collect());
            Arc::new(Form { places, kinetics: kinetics(balls.mass, turn * balls.inertia * turn.transpose())? })
        };
        let state = balls.as_body(&form);
        let rods = network.rods.iter().map(|index| self.rods.handle_at(*index)).collect();
        Some(ImpliedBody { spheres, rods, form, state })
    }

    /// Takes over what was changed about spheres of implied bodies. Returns whether all of them still have their forms; otherwise
    /// bodies have to be formed anew.
    pub(crate) fn follow_spheres(&mut self, ids: &[SphereId]) -> bool {
        let owners: HashSet<_> = ids.iter().filter_map(|id| self.implied_of(*id)).collect();
        let states = owners.into_iter().map(|owner| Some((owner, self.state_of_spheres(owner)?)));
        let Some(states) = states.collect::<Option<Vec<_>>>() else {
            self.release_spheres(ids);
            return false;
        };
        for (owner, state) in states {
            if let Ok(body) = self.implied.get_mut(owner) {
                body.state = state;
            }
            self.place_implied(owner);
        }
        true
    }

    /// The state of an implied body that follows from its spheres; `None` if they do not have the places of its form.
    fn state_of_spheres(&self, id: Handle<ImpliedBody>) -> Option<BodyState> {
        let ImpliedBody { spheres, form, .. } = self.implied.get(id).ok()?;
        let points = spheres.iter().map(|id| Some(DVec3::from_array(self.sphere(*id).ok()?.centre())));
        let balls = Balls::of(self, spheres, &points.collect::<Option<Vec<_>>>()?)?;
        let state = balls.as_body(form);
        let turn = state.orientation.as_dquat();
        let size = form.places.iter().map(|place| place.length()).fold(0.0, f64::max);
        let mut pairs = form.places.iter().zip(&balls.arms);
        pairs.all(|(place, arm)| (turn * *place).distance(*arm) <= OFF_PLACE * size).then_some(state)
    }

    /// Whether a network is longer than half a period, so that it may touch its own image.
    fn exceeds_period(&self, network: &Network, points: &[DVec3]) -> bool {
        let radius = network.spheres.iter().map(|index| self.spheres()[*index].radius).fold(0.0, f32::max);
        let along = |axis: usize| {
            let places = points.iter().map(|point| point[axis]);
            places.clone().fold(f64::NEG_INFINITY, f64::max) - places.fold(f64::INFINITY, f64::min) + 2.0 * f64::from(radius)
        };
        let periods = self.periodic().into_iter().enumerate();
        periods.into_iter().any(|(axis, bounds)| bounds.is_some_and(|[from, to]| along(axis) > 0.5 * f64::from(to - from)))
    }

    /// For each rod of a network, the places of its ends in the list of spheres.
    fn places_of_ends(&self, network: &Network) -> Vec<[usize; 2]> {
        let place = |id: SphereId| {
            let index = self.spheres.index(id).unwrap_or_default();
            network.spheres.binary_search(&index).unwrap_or_default()
        };
        network.rods.iter().map(|number| [self.rods()[*number].end1, self.rods()[*number].end2].map(place)).collect()
    }

    /// The positions of the spheres after the lengths of the rods were restored; `None` if they contradict each other.
    fn straightened(&self, network: &Network, ends: &[[usize; 2]]) -> Option<Vec<DVec3>> {
        let spheres = network.spheres.iter().map(|index| &self.spheres()[*index]);
        let weights: Vec<f64> = spheres.clone().map(|sphere| 1.0 / f64::from(sphere.mass)).collect();
        let mut points: Vec<DVec3> = spheres.map(|sphere| DVec3::from_array(sphere.centre())).collect();
        for _ in 0..SWEEPS {
            let mut worst = 0.0_f64;
            for (number, [a, b]) in network.rods.iter().zip(ends) {
                let length = f64::from(self.rods()[*number].length?);
                let d = points[*b] - points[*a];
                let off = d.length() - length;
                worst = worst.max(off.abs() / length);
                let shift = off / (weights[*a] + weights[*b]) * d.try_normalize()?;
                points[*a] += weights[*a] * shift;
                points[*b] -= weights[*b] * shift;
            }
            if worst <= LENGTH_ERROR {
                return Some(points);
            }
        }
        None
    }

    fn key_of_pair(&self, network: &Network) -> PairKey {
        let [a, b] = [0, 1].map(|place: usize| &self.spheres()[network.spheres[place]]);
        let rod = &self.rods()[network.rods[0]];
        let [a_mass, b_mass, a_radius, b_radius, radius, length] =
            [a.mass, b.mass, a.radius, b.radius, rod.radius, rod.length.unwrap_or_default()].map(f32::to_bits);
        [a_mass, b_mass, a_radius, b_radius, radius, length, network.rods.len() as u32]
    }

    /// The form of two spheres. Its first axis is that of the rod.
    fn pair_form(&self, network: &Network, balls: &Balls) -> Option<Form> {
        let [a, b] = [0, 1].map(|place: usize| &self.spheres()[network.spheres[place]]);
        let rod = &self.rods()[network.rods[0]];
        let distance = balls.arms[1].distance(balls.arms[0]);
        let is_capsule = network.rods.len() == 1 && a.radius == b.radius && a.mass == b.mass && rod.radius == a.radius;
        let (along, across) = if is_capsule {
            let [along, across, ..] = capsule_along_x(balls.mass, distance, f64::from(a.radius)).inertia;
            (along, across)
        } else {
            let reduced = f64::from(a.mass) * f64::from(b.mass) / balls.mass;
            let along = f64::from(a.inertia()) + f64::from(b.inertia());
            (along, along + reduced * distance.powi(2))
        };
        let kinetics = kinetics(balls.mass, DMat3::from_diagonal(DVec3::new(along, across, across)))?;
        let share = f64::from(b.mass) / balls.mass;
        Some(Form { places: vec![-share * distance * DVec3::X, (1.0 - share) * distance * DVec3::X], kinetics })
    }
}

/// The spheres of a network as one body.
struct Balls {
    mass: f64,
    centre: DVec3,
    /// From the centre of mass to each sphere.
    arms: Vec<DVec3>,
    /// Their orientation, if all have the same one.
    turn: Option<DQuat>,
    velocity: DVec3,
    /// Inertia about the centre of mass, and angular momentum about it.
    inertia: DMat3,
    momentum: DVec3,
}

impl Balls {
    /// `None` if one of them is not in the scene.
    fn of(scene: &Scene, ids: &[SphereId], points: &[DVec3]) -> Option<Self> {
        let found: Vec<&Sphere> = ids.iter().map(|id| scene.sphere(*id).ok()).collect::<Option<_>>()?;
        let spheres = || found.iter().copied();
        let first = found.first()?.orientation;
        let turn = found.iter().all(|sphere| sphere.orientation == first).then(|| first.as_dquat().normalize());
        let mass: f64 = spheres().map(|sphere| f64::from(sphere.mass)).sum();
        let mean = |of: &dyn Fn(usize) -> DVec3| {
            spheres().enumerate().map(|(place, sphere)| f64::from(sphere.mass) / mass * of(place)).sum::<DVec3>()
        };
        let velocities: Vec<DVec3> = spheres().map(|sphere| sphere.velocity.as_dvec3()).collect();
        let (centre, velocity) = (mean(&|place| points[place]), mean(&|place| velocities[place]));
        let arms: Vec<DVec3> = points.iter().map(|point| *point - centre).collect();
        let (mut inertia, mut momentum) = (DMat3::ZERO, DVec3::ZERO);
        for ((sphere, arm), v) in spheres().zip(&arms).zip(&velocities) {
            let m = f64::from(sphere.mass);
            let outer = DMat3::from_cols(arm.x * *arm, arm.y * *arm, arm.z * *arm);
            let own = f64::from(sphere.inertia());
            inertia += DMat3::from_diagonal(DVec3::splat(m * arm.length_squared() + own)) - m * outer;
            momentum += m * arm.cross(*v - velocity) + sphere.angular_momentum.as_dvec3();
        }
        Some(Self { mass, centre, arms, turn, velocity, inertia, momentum })
    }

    /// The state of a body of this form. Its orientation is that of the spheres, if it fits; the first axis of a pair lies along its rod.
    fn as_body(&self, form: &Form) -> BodyState {
        let own = self.turn.unwrap_or(DQuat::IDENTITY);
        let orientation = match self.arms[..] {
            [one, other] => {
                let along = (other - one).normalize_or(DVec3::X);
                let from = if (own * DVec3::X).dot(along) >= FITS { own } else { DQuat::IDENTITY };
                DQuat::from_rotation_arc(from * DVec3::X, along) * from
            }
            _ => own,
        };
        let momentum = form.kinetics.tensor(orientation) * (self.inertia.inverse() * self.momentum);
        BodyState {
            position: Fine::at(self.centre.to_array()),
            velocity: self.velocity.as_vec3(),
            momentum: momentum.as_vec3(),
            orientation: orientation.normalize().as_quat(),
        }
    }
}

/// How a body with this inertia about its centre of mass moves; `None` if `f32` cannot hold it.
fn kinetics(mass: f64, inertia: DMat3) -> Option<Kinetics> {
    let [x, y, z] = [inertia.x_axis, inertia.y_axis, inertia.z_axis];
    let properties = MassProperties { mass, centre: [0.0; 3], inertia: [x.x, y.y, z.z, x.y, x.z, y.z] };
    properties.validate().ok()?;
    Some(Kinetics::of(&properties))
}

/// The matrix that maps velocities of spheres to the rates of change of the lengths of rods, a row for each rod.
fn rigidity(points: &[DVec3], ends: &[[usize; 2]]) -> Vec<Vec<f64>> {
    let row = |[a, b]: &[usize; 2]| {
        let mut row = vec![0.0; 3 * points.len()];
        let direction = (points[*b] - points[*a]).normalize_or_zero();
        row[3 * a..3 * a + 3].copy_from_slice(&(-direction).to_array());
        row[3 * b..3 * b + 3].copy_from_slice(&direction.to_array());
        row
    };
    ends.iter().map(row).collect()
}

/// The rank of a matrix, by Gaussian elimination with pivots.
fn rank(rows: &[Vec<f64>]) -> usize {
    let mut rows = rows.to_vec();
    let columns = rows.first().map_or(0, Vec::len);
    let mut rank = 0;
    for column in 0..columns {
        let size = |row: &usize| rows[*row][column].abs();
        let Some(pivot) = (rank..rows.len()).max_by(|a, b| size(a).total_cmp(&size(b))) else { break };
        if size(&pivot) <= NEGLIGIBLE {
            continue;
        }
        rows.swap(rank, pivot);
        let (done, rest) = rows.split_at_mut(rank + 1);
        let above = &done[rank];
        for row in rest.iter_mut().filter(|row| row[column] != 0.0) {
            let factor = row[column] / above[column];
            row.iter_mut().zip(above).for_each(|(element, other)| *element -= factor * other);
        }
        rank += 1;
    }
    rank
}

#[cfg(test)]
#[path = "implied_tests.rs"]
mod tests;
