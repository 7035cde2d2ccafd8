//! Constants of the contact laws with history, from materials and pairs (docs/physics section 4.11).

use std::sync::LazyLock;

use glam::Vec3;

use crate::error::{Error, Result, quoted};
use crate::laws::{Given, GrainLaw, Needs, grain_names};
use crate::scene::restitution::damping_for;
use crate::scene::{Body, CohesionModel, Inlet, Material, RigidBody, RollingModel, Scene, Shape, ShapeId};
use crate::settings::{ContactLaw, Integrator, Settings};

/// Ratio of rolling damping where a pair has none: that of Ai, Chen, Rotter and Ooi (2011).
const ROLLING_DAMPING: f32 = 0.3;
/// Least constant of JKR cohesion, in units^(1/3). With a smaller one, the overlap in units of the neck would overflow in f32.
const LEAST_NECK: f64 = 1e-15;

/// Damping for each restitution that was asked for. Finding it takes milliseconds.
#[derive(Default)]
pub(crate) struct Dampings(Vec<(f32, f32)>);

impl Dampings {
    /// 0 for a law with a damping of its own.
    fn of(&mut self, law: &dyn GrainLaw, restitution: f32) -> f32 {
        let Some(elastic) = law.unit_impact() else { return 0.0 };
        if let Some((_, known)) = self.0.iter().find(|(known, _)| *known == restitution) {
            return *known;
        }
        let damping = damping_for(elastic, restitution);
        self.0.push((restitution, damping));
        damping
    }
}

/// The name of a shape in brackets, if it has one.
fn called(shape: &Shape) -> String {
    shape.name.as_deref().map_or(String::new(), |name| format!(" ({})", quoted(name)))
}

impl Scene {
    /// Checks that the contact law of the scene has all the constants that it needs, and that the integrator suits it. A
    /// [`Simulation`](crate::Simulation) makes the same check.
    ///
    /// # Errors
    /// [`Error::Invalid`], which names the first object or pair of materials without a constant.
    pub fn check_contact_law(&self, integrator: Integrator) -> Result<()> {
        let law = self.contact_law();
        let refused = |value: String, expected: &'static str| Err(Error::Invalid { field: "contact_law", value, expected });
        self.check_joints()?;
        self.check_groups()?;
        self.check_shapes_of_law()?;
        let Some(grain) = law.grain() else { return Ok(()) };
        if integrator == Integrator::Rk4 {
            return refused(
                format!("{law} with the integrator rk4"),
                "the integrator symplectic-euler or velocity-verlet: the law keeps a tangential spring, which allows one evaluation of \
                 forces per step",
            );
        }
        let needs = grain.needs();
        if matches!(needs, Needs::Nothing) {
            return Ok(());
        }
        let moves = |id| self.sphere(id).is_ok_and(|sphere| !sphere.fixed);
        // For each object: its material, and whether it may move.
        let kinds = [
            self.spheres().iter().map(|sphere| (sphere.material, !sphere.fixed)).collect::<Vec<_>>(),
            self.rods().iter().map(|rod| (rod.material, moves(rod.end1) || moves(rod.end2))).collect(),
            self.boxes().iter().map(|cuboid| (cuboid.material, false)).collect(),
            self.polygons().iter().map(|polygon| (polygon.material, false)).collect(),
        ];
        let (mut used, mut moving) = (vec![0_usize; self.materials().len() + 1], vec![false; self.materials().len() + 1]);
        let name_of = |kind: usize, index: usize| {
            self.name_of(match kind {
                0 => Body::Sphere(self.spheres.handle_at(index)),
                1 => Body::Rod(self.rods.handle_at(index)),
                2 => Body::Box(self.boxes.handle_at(index)),
                _ => Body::Polygon(self.polygons.handle_at(index)),
            })
        };
        for (kind, objects) in kinds.iter().enumerate() {
            for (index, (material, moves)) in objects.iter().enumerate() {
                let number = usize::from(self.material_number(*material)?);
                if number == 0 {
                    return refused(
                        format!("{law} without a material for {}", name_of(kind, index)),
                        "a material for every object",
                    );
                }
                used[number] += 1;
                moving[number] |= moves;
            }
        }
        let may_touch = |one: u16, other: u16| {
            let [one, other] = [usize::from(one), usize::from(other)];
            (moving[one] || moving[other]) && (one != other || used[one] > 1)
        };
        let used: Vec<u16> = (1..used.len()).filter(|number| used[*number] > 0).map(|number| number as u16).collect();
        let name = |number: u16| &self.materials()[usize::from(number) - 1];
        for (place, one) in used.iter().enumerate() {
            let Material { name: one_name, .. } = name(*one);
            let lacks = |other: u16| grain.constants(&self.given(*one, other)).is_none();
            if let Needs::OfMaterials(expected) = needs
                && lacks(*one)
            {
                return refused(format!("{law} with the material {}", quoted(one_name)), expected);
            }
            for other in &used[place..] {
                if may_touch(*one, *other) {
                    self.check_cohesion(*one, *other)?;
                }
                if let Needs::OfPairs(expected) = needs
                    && may_touch(*one, *other)
                    && lacks(*other)
                {
                    let pair = format!("{} {}", quoted(one_name), quoted(&name(*other).name));
                    return refused(format!("{law} with the pair {pair}"), expected);
                }
            }
        }
        Ok(())
    }

    /// The shapes of the placed bodies and of the inlets.
    fn placed_shapes(&self) -> impl Iterator<Item = ShapeId> {
        self.bodies().iter().map(|body| body.shape).chain(self.inlets().iter().flat_map(Inlet::shapes))
    }

    /// Checks that the contact law moves the shapes of the placed bodies and of the inlets.
    fn check_shapes_of_law(&self) -> Result<()> {
        let law = self.contact_law();
        if law == ContactLaw::Rigid {
            return Ok(());
        }
        for id in self.placed_shapes() {
            let shape = self.shapes.get(id)?;
            let (with, expected) = match law {
                _ if !shape.hulls.is_empty() => ("a hull", "rigid: hulls need `set contact_law rigid`"),
                _ if !shape.boxes.is_empty() => ("a body with a box", "rigid: boxes that move need `set contact_law rigid`"),
                ContactLaw::Thesis => {
                    ("a rigid body", "auto or rigid, or a grain law such as linear: the law of the thesis has no rigid bodies")
                }
                _ => continue,
            };
            return Err(Error::Invalid {
                field: "contact_law",
                value: format!("{law} with {with}{}", called(shape)),
                expected,
            });
        }
        self.check_impulses_of_bodies()?;
        self.check_loads()
    }

    /// Checks that no setting asks for impulses on the rigid bodies of a scene: under a law of grains they have contact forces
    /// alone.
    fn check_impulses_of_bodies(&self) -> Result<()> {
        let Some(id) = self.placed_shapes().next() else { return Ok(()) };
        let settings = &self.settings;
        let off = "off (contact forces alone), or `set contact_law rigid`: under other laws rigid bodies have no impulses";
        let zero = "0 (contact forces alone), or `set contact_law rigid`: under other laws rigid bodies have no impulses";
        let asked = [
            ("collisions", settings.collisions, off),
            ("collision_friction", settings.collision_friction > 0.0, zero),
            ("continuous_collisions", settings.continuous_collisions, off),
        ];
        let Some((field, _, expected)) = asked.into_iter().find(|asked| asked.1) else { return Ok(()) };
        let (value, shape) = (settings.get(field).unwrap_or_default(), called(self.shapes.get(id)?));
        let value = format!("{value} under {} with a rigid body{shape}", self.contact_law());
        Err(Error::Invalid { field, value, expected })
    }

    /// Checks that the contact law knows external forces of placed bodies, if there are any.
    pub(crate) fn check_loads(&self) -> Result<()> {
        let law = self.contact_law();
        if law == ContactLaw::Rigid {
            return Ok(());
        }
        match self.bodies().iter().find(|body| body.force != Vec3::ZERO || body.torque != Vec3::ZERO) {
            Some(RigidBody { force, torque, .. }) => Err(Error::Invalid {
                field: "body.force",
                value: format!("{force} with the torque {torque} under {law}"),
                expected: "0 for both, or `set contact_law rigid`; other laws have external forces of spheres",
            }),
            None => Ok(()),
        }
    }

    /// Checks that the scene may have the model of cohesion of two materials.
    fn check_cohesion(&self, one: u16, other: u16) -> Result<()> {
        let Settings { contact_law: law, collisions, .. } = self.chosen_settings();
        let has_necks = law.grain().is_some_and(GrainLaw::has_necks);
        if !self.sticks_by_necks(one, other) || has_necks && !collisions {
            return Ok(());
        }
        static EXPECTED: LazyLock<String> = LazyLock::new(|| {
            let names = grain_names(GrainLaw::has_necks, "or");
            format!(
                "the contact law {names} with collisions off, or cohesion=dmt: a neck follows from the elastic contact, and \
                 impulses would separate the bodies without it"
            )
        });
        let [one, other] = [one, other].map(|number| quoted(&self.materials()[usize::from(number) - 1].name));
        let with = if has_necks { " and collisions on".to_owned() } else { format!(" and the contact law {law}") };
        Err(Error::Invalid {
            field: "pair.cohesion",
            value: format!("jkr for the pair {one} {other}{with}"),
            expected: &EXPECTED,
        })
    }

    /// Whether necks (JKR cohesion) may hold contacts together under the law of the scene.
    pub(crate) fn has_necks(&self) -> bool {
        self.contact_law().grain().is_some_and(GrainLaw::has_necks)
    }

    /// Whether two materials have cohesion with necks, JKR.
    fn sticks_by_necks(&self, one: u16, other: u16) -> bool {
        let pair = self.pair_of_numbers(one, other);
        pair.cohesion == Some(CohesionModel::Jkr) && pair.surface_energy.is_some_and(|gamma| gamma > 0.0)
    }

    /// k with k³ = pi gamma / (4 E*), in units^(1/3), of two materials with JKR cohesion. Contacts tear at the distance
    /// 3 k² R*^(1/3) (docs/physics section 4.13).
    pub(crate) fn neck_constant(&self, one: u16, other: u16) -> Option<f64> {
        let [young, _] = self.moduli(one, other).filter(|_| self.sticks_by_necks(one, other))?;
        let gamma = f64::from(self.pair_of_numbers(one, other).surface_energy?);
        let constant = (std::f64::consts::PI * gamma / (4.0 * f64::from(young))).cbrt();
        (constant > LEAST_NECK).then_some(constant)
    }

    /// The distance at which contacts with JKR cohesion tear, divided by the smallest radius of a sphere or rod: no contact is
    /// longer, in units of the radius of any of its objects. 0 in scenes without such cohesion.
    pub(crate) fn neck(&self) -> f64 {
        if !self.has_necks() {
            return 0.0;
        }
        let numbers = 1..=self.materials().len() as u16;
        let pairs = numbers.clone().flat_map(|one| numbers.clone().map(move |other| (one, other)));
        let greatest = pairs.filter_map(|(one, other)| self.neck_constant(one, other)).fold(0.0, f64::max);
        if greatest == 0.0 {
            return 0.0;
        }
        let radii = self.spheres().iter().map(|sphere| sphere.radius).chain(self.rods().iter().map(|rod| rod.radius));
        let smallest = radii.filter(|radius| *radius > 0.0).map(f64::from).fold(f64::INFINITY, f64::min);
        3.0 * greatest.powi(2) * smallest.powf(-2.0 / 3.0)
    }

    /// Constants of a pair of numbers of materials for the law of the scene: normal, tangential, damping, friction;
    /// rolling friction, rolling damping (negative for the model of constant torque), twisting friction, cohesion (see
    /// [`PAIR_WORDS`](crate::model::layout::PAIR_WORDS)). 0 where the law has no constants for the pair.
    pub(crate) fn law_constants(&self, one: u16, other: u16, dampings: &mut Dampings) -> [f32; 8] {
        let known = self.contact_law().grain().and_then(|law| Some((law, law.constants(&self.given(one, other))?)));
        let Some((law, [normal, tangential])) = known else {
            return [0.0; 8];
        };
        let pair = self.pair_of_numbers(one, other);
        let restitution = pair.restitution.unwrap_or(self.settings.restitution);
        let damping = dampings.of(law, restitution);
        let friction = pair.friction.unwrap_or(self.settings.coulomb_friction);
        let rolling_damping = match pair.rolling_model.unwrap_or_default() {
            RollingModel::SpringDashpot => pair.rolling_damping.unwrap_or(ROLLING_DAMPING),
            RollingModel::ConstantTorque => -1.0,
        };
        // DMT: 4 pi gamma R*.
        let of_dmt = || 4.0 * std::f32::consts::PI * pair.surface_energy.unwrap_or_default();
        let cohesion = self.neck_constant(one, other).map_or_else(of_dmt, |constant| -constant as f32);
        let [rolling, twisting] = [pair.rolling_friction, pair.twisting_friction].map(Option::unwrap_or_default);
        [normal, tangential, damping, friction, rolling, rolling_damping, twisting, cohesion]
    }

    /// Names of the materials.
    pub(crate) fn material_names(&self) -> Vec<&str> {
        self.materials().iter().map(|material| material.name.as_str()).collect()
    }

    /// What two materials give a law.
    pub(crate) fn given(&self, one: u16, other: u16) -> Given {
        let pair = self.pair_of_numbers(one, other);
        let (stiffness, characteristic_velocity) = (pair.stiffness, pair.characteristic_velocity);
        Given { stiffness, characteristic_velocity, moduli: self.moduli(one, other) }
    }

    /// E* and G* of two materials: 1/E* = (1 - nu_i^2)/E_i + (1 - nu_j^2)/E_j, 1/G* = (2 - nu_i)/G_i + (2 - nu_j)/G_j, with
    /// G = E / (2 (1 + nu)).
    pub(crate) fn moduli(&self, one: u16, other: u16) -> Option<[f32; 2]> {
        let of = |number: u16| {
            let material = self.materials().get(usize::from(number).checked_sub(1)?)?;
            let (young, poisson) = (f64::from(material.young?), f64::from(material.poisson?));
            Some([(1.0 - poisson * poisson) / young, (2.0 - poisson) * 2.0 * (1.0 + poisson) / young])
        };
        let ([normal, tangential], [other_normal, other_tangential]) = (of(one)?, of(other)?);
        Some([(1.0 / (normal + other_normal)) as f32, (1.0 / (tangential + other_tangential)) as f32])
    }
}
